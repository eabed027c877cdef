//! The emitted motion of a system on D, in positions and independent velocities.

use dalembert::math::larger;
use dalembert::{Described, StateVector};

use crate::volume::difference;

/// A system with the indices of its independent velocities.
#[derive(Debug)]
pub struct Flow<'s, S> {
    /// The system.
    pub system: &'s S,
    /// The independent velocities, in increasing order.
    pub independent: &'s [usize],
}

impl<S: Described> Flow<'_, S> {
    /// The positions and all velocities at `(q, v_ind)`.
    ///
    /// # Panics
    /// If the constraints do not determine the other velocities.
    pub fn velocities(&self, t: f64, at: &[f64]) -> [S::Vector; 2] {
        let (positions, velocities) = at.split_at(S::DESCRIPTION.coordinates.len());
        let [mut q, mut qdot, mut named] = [S::Vector::zeros(S::Vector::CAPACITY); 3];
        q.as_mut_slice().copy_from_slice(positions);
        for (&i, &v) in self.independent.iter().zip(velocities) {
            qdot.as_mut_slice()[i] = v;
            named.as_mut_slice()[i] = 1.0;
        }
        let completed = self.system.complete_velocity(t, &q, &qdot, &named);
        [q, completed.expect("velocities that follow")]
    }

    /// The rates of `(q, v_ind)`. The accelerations are derivatives, along the emitted vector field, of the velocities
    /// that emitted code computes from the state.
    ///
    /// # Panics
    /// At singular states.
    pub fn motion(&self, t: f64, at: &[f64]) -> Vec<f64> {
        let [q, qdot] = self.velocities(t, at);
        let state = self.system.state_unchecked(t, &q, &qdot).expect("a state");
        let mut rate = S::State::zeros(S::State::CAPACITY);
        self.system.rate(t, &state, &mut rate).expect("a rate");
        // The larger the rate, the shorter the time over which differences are taken.
        let size = rate
            .as_slice()
            .iter()
            .fold(1.0, |size: f64, value| larger(size, value.abs()));
        let velocity = |shift: f64, i: usize| {
            let mut moved = state;
            let components = moved.as_mut_slice().iter_mut().zip(rate.as_slice());
            components.for_each(|(component, rate)| *component += shift * rate);
            let velocity = self.system.velocity(t + shift, &moved);
            velocity.expect("a velocity").as_slice()[i]
        };
        let acceleration = |&i: &usize| size * difference(|shift| velocity(shift / size, i));
        let accelerations = self.independent.iter().map(acceleration);
        qdot.as_slice()
            .iter()
            .copied()
            .chain(accelerations)
            .collect()
    }
}
