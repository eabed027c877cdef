//! Lowering of a derivation to the program: one function per item of the contract.

use super::jet::{Jet, degree};
use super::recipes::{constrained, declared, geometry, impact, motion, powers, reduced, volume};
use super::{Density, Form, Function, Input, Program};
use crate::claims::Volume;
use crate::mechanics::Derivation;
use crate::model::Model;

/// Largest number of gaps that have power series. Of more surfaces, most are far away in most steps, and a bound shows it
/// for less than the series cost.
const GAPS: usize = 8;

/// The programs of a model.
#[derive(Debug)]
pub struct Lowered {
    /// The form in which the model is run: reduced to D where a frame was found or declared, first-order where a field was
    /// declared, else global.
    pub main: Program,
    /// The global form, where `main` is reduced.
    pub global: Option<Program>,
}

impl Lowered {
    /// The program in global form.
    pub fn global(&self) -> &Program {
        self.global.as_ref().unwrap_or(&self.main)
    }

    /// Number of operations of the longest function.
    pub fn longest(&self) -> usize {
        self.main.longest().max(self.global().longest())
    }
}

/// Lowers everything that a model declares, and the invariant volume that was found for it.
pub fn lower(model: &Model, derivation: &Derivation, found: Option<&Volume>) -> Lowered {
    if model.is_first_order() {
        return Lowered {
            main: lower_form(model, derivation, None, Form::FirstOrder),
            global: None,
        };
    }
    let global = lower_form(model, derivation, found, Form::Global);
    match derivation.frame {
        Ok(_) => Lowered {
            main: lower_form(model, derivation, found, Form::Reduced),
            global: Some(global),
        },
        Err(_) => Lowered {
            main: global,
            global: None,
        },
    }
}

fn lower_form(
    model: &Model,
    derivation: &Derivation,
    found: Option<&Volume>,
    form: Form,
) -> Program {
    let rate = motion::rate(model, derivation, form);
    let component = |input: Input| input.component(model.coordinates.len());
    let components = degree::of_components(&rate, component);
    let impacting = impact::impacting(model, derivation, form);
    // Gaps that are not analytic have no series from which to find their zeros.
    let gaps = impacting.iter().map(|functions| &functions.gaps);
    let gaps = gaps.filter(|gaps| {
        gaps.outputs.len() <= GAPS && Jet::of(&[gaps], &components, component).is_analytic()
    });
    let functions: Vec<&Function> = core::iter::once(&rate).chain(gaps).collect();
    Program {
        form,
        jet: Jet::of(&functions, &components, component),
        rate,
        can_be_narrow: derivation.can_be_narrow,
        scale: motion::scale(model, derivation, form),
        velocity: motion::velocity(model, derivation, form),
        momentum: motion::momentum(model, derivation),
        energy: motion::energy(model, derivation, form),
        force: motion::force(model, derivation),
        reduced: match form {
            Form::Global | Form::FirstOrder => None,
            Form::Reduced => reduced::reduced(model, derivation),
        },
        geometry: match form {
            Form::Global => geometry::geometry(model, derivation, found),
            Form::Reduced => geometry::reduced_geometry(model, derivation),
            Form::FirstOrder => geometry::first_order_geometry(model, derivation),
        },
        constrained: constrained::constrained(model, derivation, form),
        impacting,
        density: model.extras.volume.then(|| Density {
            divergence: geometry::divergence(model, derivation, form),
            form: geometry::density_form(model, derivation),
        }),
        volume: found.map(|found| volume::invariant_volume(model, derivation, found)),
        powers: powers::powers(model, derivation, form),
        outputs: declared::outputs(model, derivation, form),
        view_path: model
            .view
            .as_ref()
            .map(|view| declared::position_function(model, derivation, &view.path)),
        view_region: model
            .view
            .as_ref()
            .and_then(|view| view.region)
            .map(|region| declared::position_function(model, derivation, &[region])),
        initial: declared::initial(model, derivation),
        until: model
            .initial
            .until
            .map(|until| declared::position_function(model, derivation, &[until])),
    }
}
