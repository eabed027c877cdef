//! From a derivation to the program: one function per item of the contract.

use super::jet::{Jet, degree};
use super::recipes::{constrained, declared, geometry, impact, motion, volume};
use super::{Input, Program};
use crate::claims::Volume;
use crate::mechanics::Derivation;
use crate::model::Model;

/// Lowers everything that a model declares, and the invariant volume that was found for it.
pub fn lower(model: &Model, derivation: &Derivation, found: Option<&Volume>) -> Program {
    let rate = motion::rate(model, derivation);
    let component = |input: Input| input.component(model.coordinates.len());
    let components = degree::of_components(&rate, component);
    Program {
        jet: Jet::of(&rate, &components, component),
        rate,
        scale: motion::scale(model, derivation),
        velocity: motion::velocity(model, derivation),
        momentum: motion::momentum(model, derivation),
        energy: motion::energy(model, derivation),
        geometry: geometry::geometry(model, derivation, found),
        constrained: constrained::constrained(model, derivation),
        impacting: impact::impacting(model, derivation, |gaps| {
            Jet::of(gaps, &components, component)
        }),
        divergence: geometry::divergence(model, derivation),
        density_form: geometry::density_form(model, derivation),
        volume: found.map(|found| volume::invariant_volume(model, derivation, found)),
        outputs: declared::outputs(model, derivation),
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
