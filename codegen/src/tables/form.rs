//! Tables of a form: sizes, conditions and laws.

use dalembert_numbers::law::Law;
use dalembert_numbers::tables::{self, Chart, Condition, Dimensions, Level, Surface, Tables, Work};
use dalembert_numbers::{Held, Kernel};

use super::{FormOf, constant, description, name, table};
use crate::mechanics::kinks;
use crate::model::{self, Topology};
use crate::program::jet::degree::Degree;
use crate::program::{Form, Function, Input, Op};

impl FormOf<'_> {
    /// The tables of the form.
    pub fn tables(&self) -> Tables {
        let Self { model, program, .. } = *self;
        let constrained = program.constrained.as_ref();
        Tables {
            form: match program.form {
                Form::Global => tables::Form::Global,
                Form::Reduced => tables::Form::Reduced,
                Form::FirstOrder => tables::Form::FirstOrder,
            },
            dimensions: self.dimensions(),
            parameters: description::parameters(model),
            charts: table(self.charts()),
            conserves_energy: self.conserves_energy(),
            can_be_narrow: program.can_be_narrow,
            can_lose_rank: constrained.is_some_and(|constraints| constraints.can_lose_rank),
            depends_on_time: self.depends_on_time(),
            drifts: self.drifts(),
            is_linear: !model.is_nonlinear(),
            varies: self.varies(),
            levels: table(self.declared_levels()),
            surfaces: table((0..model.surfaces.len()).map(|index| self.surface(index))),
            density_reference: self.density_reference(),
            modes: Held::Static(&[]),
        }
    }

    fn density_reference(&self) -> Option<Held<[f64]>> {
        let (reference, _) = self.program.volume.as_ref()?.gradient.as_ref()?;
        Some(table(reference.iter().copied()))
    }

    fn dimensions(&self) -> Dimensions {
        Dimensions {
            state: self.state_dimension(),
            coordinates: self.dimension(),
            motion: self.motion_dimension(),
            constraints: self.model.constraints.len(),
            levels: self.levels(),
            surfaces: self.model.surfaces.len(),
            parameters: self.model.parameters.len(),
        }
    }

    /// The functions of the form with their names. The velocity comes first.
    pub fn kernels(&self) -> Vec<(Kernel, &Function)> {
        let mut kernels = self.program.kernels();
        let has_impulses = !self.model.is_nonlinear();
        kernels.retain(|(kernel, _)| has_impulses || !is_of_impulses(*kernel));
        kernels
    }

    /// Number of integrable constraints whose function (level) is known.
    pub fn levels(&self) -> usize {
        let constrained = self.program.constrained.as_ref();
        constrained.map_or(0, |constraints| constraints.levels.outputs.len())
    }

    /// Number of outputs of the largest kernel that computes several quantities at once.
    pub fn room(&self) -> usize {
        let kernels = self.program.kernels().into_iter();
        let several = kernels.filter(|(kernel, _)| {
            matches!(
                kernel,
                Kernel::Residuals
                    | Kernel::Forms
                    | Kernel::ConstrainedVelocity
                    | Kernel::Conditions(_)
                    | Kernel::Blow(_)
                    | Kernel::Contact(_)
                    | Kernel::Reset(_)
                    | Kernel::Initial
                    | Kernel::Entry(_)
            )
        });
        let counts = several.map(|(_, function)| function.outputs.len());
        // NOTE: callers request blows and contacts even for models without them.
        let least = 5 + self.motion_dimension();
        counts.max().unwrap_or(0).max(least)
    }

    /// True if rounding and truncation errors make states drift off the constraints and runs project them back. A state
    /// reduced to D can only drift off the level sets of integrable constraints.
    pub fn drifts(&self) -> bool {
        let is_constrained = self.program.constrained.is_some();
        let drifts = is_constrained && (self.program.form == Form::Global || self.levels() > 0);
        drifts && self.model.extras.projection
    }

    /// True if time occurs in a function that determines the motion.
    fn depends_on_time(&self) -> bool {
        let reads_time = |function: &Function| {
            let mut ops = function.ops.iter();
            ops.any(|op| matches!(op, Op::Input(Input::Time)))
        };
        let mut kernels = self.program.kernels().into_iter();
        kernels.any(|(kernel, function)| is_of_motion(kernel) && reads_time(function))
    }

    /// True if runs of the form have variations (derivatives of the motion).
    pub fn varies(&self) -> bool {
        self.model.extras.variations && !self.is_wrapped()
    }

    /// Work of the Taylor expansions of the motion.
    pub fn work(&self) -> Work {
        let jet = &self.program.jet;
        let values = jet.function.cost.multiplications_alike();
        Work {
            values: u32::try_from(values).unwrap_or(u32::MAX),
            // NOTE: the conversion saturates.
            sums: jet.sums().ceil() as u32,
            degree: match jet.degree(self.state_dimension()) {
                Degree::AtMost(degree) => Some(degree),
                Degree::Endless => None,
            },
        }
    }

    fn charts(&self) -> impl Iterator<Item = Chart> {
        let coordinates = self.model.coordinates.iter().enumerate();
        coordinates.filter_map(|(coordinate, declared)| {
            let Topology::Interval { low, high } = declared.topology else {
                return None;
            };
            let ends = [low, high].map(|end| constant(self.model, end));
            Some(Chart { coordinate, ends })
        })
    }

    /// True if a system with surfaces is known to conserve energy between impacts: it has no forces and no constraints,
    /// and its Lagrangian does not depend on time or inputs.
    fn conserves_energy(&self) -> bool {
        let model = self.model;
        let lagrangian = model.lagrangian.whole;
        let is_free =
            model.forces.is_empty() && model.constraints.is_empty() && !model.is_first_order();
        let is_steady = !model.pool.depends_on(lagrangian, model.time)
            && model
                .inputs()
                .all(|(_, input)| !model.pool.depends_on(lagrangian, input.symbol));
        self.program.impacting.is_some() && is_free && is_steady
    }

    /// The constraint of each level. Empty unless a constraint is holonomic as declared: its level is then 0.
    fn declared_levels(&self) -> impl Iterator<Item = Level> {
        let functions = self.program.constrained.as_ref();
        let are_declared = functions.is_some_and(|constraints| constraints.level_scales.is_some());
        let constraints = self.model.constraints.iter().enumerate();
        let levels =
            constraints.filter(move |(_, declared)| are_declared && declared.level.is_some());
        levels.map(|(constraint, declared)| Level {
            constraint,
            is_zero: declared.is_of_positions,
        })
    }

    pub(super) fn surface(&self, index: usize) -> Surface {
        let surface = &self.model.surfaces[index];
        let law = law(surface.law);
        let coefficient = || name(format!("restitution at {}", surface.name.display));
        let others = surface.beside.others();
        let impacting = self.program.impacting.as_ref();
        Surface {
            law,
            coefficient: law.coefficient().map(|_| coefficient()),
            conditions: conditions(&surface.conditions),
            others: table(others.iter().map(|list| conditions(list))),
            beside: match &surface.beside {
                model::Beside::Independent => tables::Beside::Independent,
                model::Beside::Otherwise(_) => tables::Beside::Otherwise,
                model::Beside::Last(_) => tables::Beside::Last,
            },
            kinks: kinks(&self.model.pool, surface.gap).len(),
            takes: impacting.map_or(0, |impacting| coordinates_of(&impacting.gap_alone[index])),
            keeps_gap: self.model.keeps_gap(surface),
        }
    }
}

/// True for kernels of impulses and of the discrete Lagrange-d'Alembert principle. They do not exist for constraints
/// that are not linear in the velocities.
fn is_of_impulses(kernel: Kernel) -> bool {
    matches!(
        kernel,
        Kernel::Blow(_) | Kernel::Contact(_) | Kernel::ReactionForce | Kernel::ConstrainedVelocity
    )
}

/// True for kernels that determine the motion and its events.
fn is_of_motion(kernel: Kernel) -> bool {
    matches!(
        kernel,
        Kernel::Rate
            | Kernel::Gaps
            | Kernel::Conditions(_)
            | Kernel::Coefficient(_)
            | Kernel::Blow(_)
            | Kernel::Contact(_)
            | Kernel::Reset(_)
            | Kernel::Entry(_)
            | Kernel::Focus(_)
            | Kernel::Trace(_)
    )
}

/// The law in the tables. Its coefficient, if it has one, is 0.
fn law(declared: model::Law) -> Law {
    match declared {
        model::Law::Elastic => Law::Elastic,
        model::Law::Restitution(_) => Law::Restitution(0.0),
        model::Law::Newton(_) => Law::Newton(0.0),
        model::Law::NonholonomicPlastic => Law::NonholonomicPlastic,
        model::Law::ImpactPlastic => Law::ImpactPlastic,
        model::Law::TotallyPlastic => Law::TotallyPlastic,
        model::Law::Reset => Law::Reset,
        model::Law::Stop => Law::Stop,
        model::Law::Transition => Law::Transition,
    }
}

fn conditions(declared: &[model::Condition]) -> Held<[Condition]> {
    table(declared.iter().map(|condition| Condition {
        is_closed: condition.is_closed,
    }))
}

/// Bit mask of the coordinates that a function reads. Coordinates with index 63 and above share the last bit.
fn coordinates_of(function: &Function) -> u64 {
    let taken = function.ops.iter().filter_map(|op| match op {
        Op::Input(Input::Coordinate(i)) => Some(1_u64 << i.min(&63)),
        _ => None,
    });
    taken.fold(0, |all, bit| all | bit)
}
