//! Known facts about the shipped models, in closed form or from their sources, hold for their runs.

mod billiards;
mod fields;
mod forces;
mod rolling;
mod walkers;

use dalembert::erased::Erased;
use dalembert::{Instance, Run, VectorField};
use dalembert_cli::Integrator;
use dalembert_stability::course::{Course, Driven, state};

/// A run from these positions and velocities, which satisfy the constraints.
fn course<'a, M: Driven>(model: &'a M, q: &[f64], qdot: &[f64], until: f64) -> Course<'a, M> {
    Course::from_state(model, state(model, q, qdot), until)
}

/// End of a run by [`Integrator::Dop853`].
fn end<M: Driven>(course: Course<'_, M>) -> Run<<M as VectorField>::State> {
    course.observed(Integrator::Dop853, &mut ())
}

/// The index of the mode of this name.
fn mode_number<const C: usize>(model: &Erased<'_, C>, name: &str) -> usize {
    let mut modes = model.description().modes.iter();
    let place = modes.position(|mode| mode.name == name);
    place.unwrap_or_else(|| panic!("no mode `{name}`"))
}
