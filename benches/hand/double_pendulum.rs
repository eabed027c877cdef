//! The double pendulum: Hamilton's equations of the textbooks, with the metric inverted by hand.

use dalembert_models::DoublePendulum;

use crate::State;

type PendulumState = State<DoublePendulum>;

/// Sine and cosine of `theta1 - theta2` from those of the angles.
#[inline(always)]
fn difference((sin1, cos1): (f64, f64), (sin2, cos2): (f64, f64)) -> (f64, f64) {
    (sin1 * cos2 - cos1 * sin2, cos1 * cos2 + sin1 * sin2)
}

/// The angular velocities; the determinant is `(l1 l2)^2 m2 (m1 + m2 sin^2)`.
#[inline(always)]
fn velocities(pendulum: &DoublePendulum, (sin, cos): (f64, f64), p1: f64, p2: f64) -> (f64, f64) {
    let DoublePendulum { m1, m2, l1, l2, .. } = *pendulum;
    let scale = 1.0 / (l1 * l2 * (m1 + m2 * sin * sin));
    let first = (l2 * p1 - l1 * p2 * cos) / l1;
    let second = ((m1 + m2) * l1 * p2 - m2 * l2 * p1 * cos) / (m2 * l2);
    (scale * first, scale * second)
}

/// Hamilton's equations.
#[inline]
pub fn rate(pendulum: &DoublePendulum, state: &PendulumState) -> PendulumState {
    let [theta1, theta2, p1, p2]: [f64; 4] = (*state).into();
    let DoublePendulum { m1, m2, l1, l2, g } = *pendulum;
    let (first, second) = (theta1.sin_cos(), theta2.sin_cos());
    let (sin, cos) = difference(first, second);
    let (omega1, omega2) = velocities(pendulum, (sin, cos), p1, p2);
    let coupling = m2 * l1 * l2 * omega1 * omega2 * sin;
    [
        omega1,
        omega2,
        -coupling - (m1 + m2) * g * l1 * first.0,
        coupling - m2 * g * l2 * second.0,
    ]
    .into()
}

/// Kinetic and potential energy.
#[inline]
pub fn energy(pendulum: &DoublePendulum, state: &PendulumState) -> f64 {
    let [theta1, theta2, p1, p2]: [f64; 4] = (*state).into();
    let DoublePendulum { m1, m2, l1, l2, g } = *pendulum;
    let (first, second) = (theta1.sin_cos(), theta2.sin_cos());
    let (omega1, omega2) = velocities(pendulum, difference(first, second), p1, p2);
    let height = (m1 + m2) * l1 * first.1 + m2 * l2 * second.1;
    0.5 * (p1 * omega1 + p2 * omega2) - g * height
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::generated;
    use crate::hand::agreement::{assert_numbers_agree, assert_states_agree};

    const PENDULUM: DoublePendulum = DoublePendulum {
        m1: 1.3,
        m2: 0.6,
        l1: 0.8,
        l2: 1.7,
        g: 9.81,
    };

    #[test]
    fn the_double_pendulum_by_hand_is_the_generated_one() {
        assert_states_agree(&PENDULUM, generated::rate, rate);
        assert_numbers_agree(&PENDULUM, generated::energy, energy);
    }
}
