//! The generated functions with the signatures of the handwritten ones: from a state to the result.
//!
//! Every function panics if the model returns a fault. No state that is compared or timed leads to one.

use dalembert::{Impacting, System, VectorField};

use crate::State;

/// The rate of a state.
#[inline(always)]
pub fn rate<S: VectorField>(system: &S, state: &State<S>) -> State<S> {
    let mut rate = system.zero_state();
    system
        .rate(0.0, state, &mut rate)
        .expect("no fault at this state");
    rate
}

/// The energy of a state.
#[inline(always)]
pub fn energy<S: System>(system: &S, state: &State<S>) -> f64 {
    system.energy(0.0, state).expect("no fault at this state")
}

/// The state after an impact on a surface by its declared law.
#[inline(always)]
pub fn impact<S: Impacting>(system: &S, surface: usize, state: &State<S>) -> State<S> {
    let blow = system
        .blow(surface, 0.0, state)
        .expect("no fault at this state");
    let mut after = *state;
    system.kick(&mut after, blow.size, &blow.direction);
    after
}
