//! The double pendulum: Hamilton's equations as in textbooks, with the metric inverted by hand.

use dalembert_models::DoublePendulum;

use super::number::{Number, parameters};

/// Sine and cosine of `theta1 - theta2` from those of the angles.
#[inline(always)]
fn difference<T: Number>((sin1, cos1): (T, T), (sin2, cos2): (T, T)) -> (T, T) {
    (sin1 * cos2 - cos1 * sin2, cos1 * cos2 + sin1 * sin2)
}

/// The parameters, in the order of their declaration.
#[inline(always)]
fn rods<T: Number>(pendulum: &DoublePendulum) -> [T; 5] {
    let DoublePendulum { m1, m2, l1, l2, g } = *pendulum;
    parameters([m1, m2, l1, l2, g])
}

/// The angular velocities. The metric has the determinant `(l1 l2)^2 m2 (m1 + m2 sin^2)`.
#[inline(always)]
fn velocities<T: Number>(
    [m1, m2, l1, l2, _]: [T; 5],
    (sin, cos): (T, T),
    [p1, p2]: [T; 2],
) -> (T, T) {
    let scale = (l1 * l2 * (m1 + m2 * sin * sin)).reciprocal();
    let first = (l2 * p1 - l1 * p2 * cos) / l1;
    let second = ((m1 + m2) * l1 * p2 - m2 * l2 * p1 * cos) / (m2 * l2);
    (scale * first, scale * second)
}

/// Hamilton's equations.
#[inline(always)]
pub fn rate<T: Number>(pendulum: &DoublePendulum, [theta1, theta2, p1, p2]: [T; 4]) -> [T; 4] {
    let [m1, m2, l1, l2, g] = rods::<T>(pendulum);
    let (first, second) = (theta1.sin_cos(), theta2.sin_cos());
    let (sin, cos) = difference(first, second);
    let (omega1, omega2) = velocities([m1, m2, l1, l2, g], (sin, cos), [p1, p2]);
    let coupling = m2 * l1 * l2 * omega1 * omega2 * sin;
    [
        omega1,
        omega2,
        -coupling - (m1 + m2) * g * l1 * first.0,
        coupling - m2 * g * l2 * second.0,
    ]
}

/// Kinetic and potential energy.
#[inline(always)]
pub fn energy<T: Number>(pendulum: &DoublePendulum, [theta1, theta2, p1, p2]: [T; 4]) -> T {
    let [m1, m2, l1, l2, g] = rods::<T>(pendulum);
    let (first, second) = (theta1.sin_cos(), theta2.sin_cos());
    let angle = difference(first, second);
    let (omega1, omega2) = velocities([m1, m2, l1, l2, g], angle, [p1, p2]);
    let height = (m1 + m2) * l1 * first.1 + m2 * l2 * second.1;
    (p1 * omega1 + p2 * omega2).times(0.5) - g * height
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::generated;
    use crate::hand::agreement::{assert_numbers_agree, assert_states_agree};
    use crate::hand::number::numbers;

    const PENDULUM: DoublePendulum = DoublePendulum {
        m1: 1.3,
        m2: 0.6,
        l1: 0.8,
        l2: 1.7,
        g: 9.81,
    };

    #[test]
    fn the_double_pendulum_by_hand_is_the_generated_one() {
        assert_states_agree(&PENDULUM, generated::rate, |pendulum, state| {
            rate(pendulum, numbers(state)).into()
        });
        assert_numbers_agree(&PENDULUM, generated::energy, |pendulum, state| {
            energy(pendulum, numbers(state))
        });
    }
}
