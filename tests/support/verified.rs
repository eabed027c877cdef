//! Verdicts with independent checks by finite differences. If `exp(G)` is an invariant density, the derivative of `G`
//! along a field of D has a certain value, the demand of the field. Demands are compared with the mean curvature and
//! with the divergence of the motion, densities with this divergence, and obstructions with brackets.

use dalembert_codegen::claims::find_obstruction;
use dalembert_codegen::model::Coordinate;

use crate::curvature::Curved;
use crate::divergence::{Flow, State};
use crate::verdict::{Decided, Existence};

/// A state with coordinates between 0.37 and 1.2, inside the charts of the models of these tests.
fn state(n: usize, independent: usize, attempt: usize) -> State {
    let number = |i: usize| 0.37 + ((5 * i + 3 * attempt) % 11) as f64 * 0.083;
    State {
        t: 0.2 + 0.3 * attempt as f64,
        q: (0..n).map(number).collect(),
        v: (0..independent).map(|i| number(i + 4) - 0.8).collect(),
    }
}

/// The verdict on a model, after independent checks of demands, density and obstruction.
///
/// # Panics
/// If a check fails.
pub fn verified(source: &str) -> Existence {
    let decided = Decided::of(source);
    let n = decided.model.coordinates.len();
    for attempt in 0..4 {
        let state = state(n, n - decided.model.constraints.len(), attempt);
        let flow = Flow::at(&decided, &state);
        let (demand, divergence) = (flow.demand(&state), flow.divergence(&state, &|_, _| 1.0));
        let size = f64::max(demand.abs(), 1.0);
        assert!(
            (demand + divergence).abs() < 1e-8 * size,
            "{source}\n{demand} for {divergence}"
        );
        if decided.potential().is_some() {
            let density = |state: &State| flow.density(state);
            let divergence = flow.divergence(&state, &|_, state| density(state));
            assert!(divergence.abs() < 1e-8 * size, "{source}\n{divergence}");
        }
    }
    if !decided.problem.has_drift(&decided.model.pool) {
        check_curvature(&decided, source);
    }
    decided.existence()
}

/// Compares the demands of a frame with the mean curvature, and the obstruction with brackets.
fn check_curvature(decided: &Decided, source: &str) {
    let (model, parameters) = (&decided.model, decided.defaults());
    let n = model.coordinates.len();
    let state = state(n, n - model.constraints.len(), 1);
    let flow = Flow::at(decided, &state);
    let curved = Curved::new(model, &decided.derivation, &parameters, flow.dependent());
    let geometry = flow.geometry(&state);
    for (field, demand) in geometry.frame.iter().zip(&geometry.demands) {
        let other = curved.theta(&state.q, field);
        let size = f64::max(demand.abs(), 1.0);
        assert!(
            (demand - other).abs() < 1e-7 * size,
            "{source}\n{demand} for {other}"
        );
    }
    let local = &decided.exactness().local;
    if local.exists {
        return;
    }
    let found = find_obstruction(model, &decided.problem, local).expect("an obstruction");
    let values = |coordinate: &Coordinate| {
        let found = found
            .sample
            .values
            .iter()
            .find(|(name, _)| *name == coordinate.name.display);
        // The sample lacks coordinates that nothing depends on.
        found.map_or(0.5, |(_, value)| *value)
    };
    let q: Vec<f64> = model.coordinates.iter().map(values).collect();
    let dependent = local.dependent();
    let curved = Curved::new(model, &decided.derivation, &parameters, dependent);
    let mut pair = curved.bracket(&q, &found.bracket);
    for (element, coefficient) in &found.relation {
        for (entry, other) in pair.iter_mut().zip(curved.bracket(&q, element)) {
            *entry -= coefficient * other;
        }
    }
    let delta = pair.pop().expect("a demand");
    assert!(
        (delta - found.delta).abs() < 1e-3 * found.scale,
        "{source}\n{delta} for {found:?}"
    );
    assert!(
        pair.iter()
            .all(|entry| entry.abs() < 1e-3 * found.scale.max(1.0)),
        "{source}\n{pair:?}"
    );
}
