//! The functions of a program, each with its name in the runtime.

use dalembert_numbers::Kernel;

use super::{Constrained, Form, Function, Impacting, Program};

impl Program {
    /// Every function with its name, except the power series. Functions without a meaning for a first-order system,
    /// such as the energy, are left out there.
    pub fn kernels(&self) -> Vec<(Kernel, &Function)> {
        // The velocity comes first, because other functions use it.
        let mut kernels = vec![
            (Kernel::Velocity, &self.velocity),
            (Kernel::Rate, &self.rate),
            (Kernel::Scale, &self.scale),
            (Kernel::Initial, &self.initial),
            (Kernel::Geometry, &self.geometry.function),
        ];
        if self.form != Form::FirstOrder {
            kernels.extend([(Kernel::Energy, &self.energy), (Kernel::Force, &self.force)]);
            match &self.reduced {
                None => kernels.push((Kernel::Motion, &self.momentum)),
                Some(reduced) => kernels.extend([
                    (Kernel::Momentum, &reduced.momentum),
                    (Kernel::Motion, &reduced.quasi),
                    (Kernel::NearestMomenta, &reduced.nearest_momenta),
                    (Kernel::Nearest, &reduced.nearest_velocities),
                ]),
            }
        }
        let declared = [
            (Kernel::Outputs, &self.outputs),
            (Kernel::ViewPath, &self.view_path),
            (Kernel::ViewRegion, &self.view_region),
            (Kernel::Until, &self.until),
        ];
        kernels.extend(
            declared.into_iter().filter_map(|(kernel, function)| {
                function.as_ref().map(|function| (kernel, function))
            }),
        );
        if let Some(constrained) = &self.constrained {
            constrained.add_kernels(&mut kernels);
        }
        if let Some(impacting) = &self.impacting {
            impacting.add_kernels(self.form, &mut kernels);
        }
        if let Some(density) = &self.density {
            kernels.push((Kernel::Divergence, &density.divergence));
            kernels.push((Kernel::DensityForm, &density.form));
        }
        if let Some(volume) = &self.volume {
            kernels.push((Kernel::LogDensity, &volume.log_density));
            kernels.push((Kernel::LogVolume, &volume.log_volume));
            let gradient = volume.gradient.as_ref();
            kernels.extend(gradient.map(|(_, function)| (Kernel::DensityGradient, function)));
        }
        kernels.extend(
            self.powers
                .as_ref()
                .map(|powers| (Kernel::Powers, &powers.function)),
        );
        kernels
    }
}

impl Constrained {
    fn add_kernels<'a>(&'a self, kernels: &mut Vec<(Kernel, &'a Function)>) {
        kernels.extend([
            (Kernel::Multipliers, &self.multipliers),
            (Kernel::Residuals, &self.residuals),
            (Kernel::Forms, &self.forms),
            (Kernel::Levels, &self.levels),
            (Kernel::LevelCorrection, &self.level_correction),
            (Kernel::ReactionForce, &self.reaction_force),
            (Kernel::ConstrainedVelocity, &self.constrained_velocity),
        ]);
        kernels.extend(
            self.level_scales
                .as_ref()
                .map(|scales| (Kernel::LevelScales, scales)),
        );
        if let Some(back) = &self.return_to_constraints {
            kernels.push((Kernel::Nearest, &back.nearest));
            kernels.push((Kernel::Restore, &back.restore));
        }
    }
}

impl Impacting {
    fn add_kernels<'a>(&'a self, form: Form, kernels: &mut Vec<(Kernel, &'a Function)>) {
        kernels.push((Kernel::Gaps, &self.gaps));
        kernels.push((Kernel::GapRates, &self.gap_rates));
        let each = |functions: &'a [Function], kernel: fn(usize) -> Kernel| {
            let functions = functions.iter().enumerate();
            functions.map(move |(s, function)| (kernel(s), function))
        };
        kernels.extend(each(&self.gap_alone, Kernel::Gap));
        if form != Form::FirstOrder {
            kernels.push((Kernel::GapAccelerations, &self.gap_accelerations));
            kernels.push((Kernel::GapResponses, &self.gap_responses));
            kernels.extend(each(&self.contacts, Kernel::Contact));
        }
        let some = |functions: &'a [Option<Function>], kernel: fn(usize) -> Kernel| {
            let functions = functions.iter().enumerate();
            functions.filter_map(move |(s, function)| Some((kernel(s), function.as_ref()?)))
        };
        kernels.extend(some(&self.conditions, Kernel::Conditions));
        kernels.extend(some(&self.coefficients, Kernel::Coefficient));
        if form != Form::FirstOrder {
            kernels.extend(some(&self.blows, Kernel::Blow));
        }
        kernels.extend(some(&self.resets, Kernel::Reset));
        kernels.extend(some(&self.entries, Kernel::Entry));
        kernels.extend(some(&self.focuses, Kernel::Focus));
        kernels.extend(some(&self.traces, Kernel::Trace));
    }
}
