//! Certified runs of models loaded from their texts. They are compiled here, once for all tests.

use core::ops::ControlFlow;

use dalembert::System;
use dalembert::certified::{
    CertifiedFlow, CertifiedImpact, CertifiedOrbit, CertifiedRun, CertifiedSection, Lost, NotProved,
};
use dalembert_stability::course::vector;
use dalembert_stability::text::Model;

/// The state with these positions and velocities.
///
/// # Panics
/// If the system refuses them.
pub fn state<S: System>(system: &S, q: &[f64], qdot: &[f64]) -> S::State {
    let state = system.state_unchecked(0.0, &vector(q), &vector(qdot));
    state.expect("a state")
}

/// Follows a certified run to a time, or until `see` breaks after an impact.
///
/// # Errors
/// Those of [`CertifiedRun::run`].
pub fn follow(
    run: &mut CertifiedRun<'_, Model>,
    until: f64,
    see: &mut dyn FnMut(&CertifiedImpact<Model>) -> ControlFlow<()>,
) -> Result<(), Lost> {
    run.run(until, see)
}

/// Follows a certified motion without impacts to a time.
///
/// # Errors
/// Those of [`CertifiedFlow::run`].
pub fn flow(flow: &mut CertifiedFlow<'_, Model>, until: f64) -> Result<(), Lost> {
    flow.run(until)
}

/// Proves that a periodic orbit exists near a state.
///
/// # Errors
/// Those of [`CertifiedSection::periodic`].
pub fn periodic(
    section: &CertifiedSection<'_, Model>,
    near: &[f64],
    radius: f64,
) -> Result<CertifiedOrbit<Model>, NotProved> {
    section.periodic(&vector(near), radius)
}
