//! Two wheels joined by a rod. A state on the constraint distribution consists of the coordinates and the rates of the
//! angles.

use dalembert_models::TwoWheelsRod;

use super::number::{Number, parameters};

/// The rate: both angular velocities are constant.
#[inline(always)]
pub fn rate<T: Number>(wheels: &TwoWheelsRod, [_, _, _, _, first, second]: [T; 6]) -> [T; 6] {
    let [r1, r2] = parameters::<T, _>([wheels.r1, wheels.r2]);
    let none = T::of(0.0);
    [r1 * first, r2 * second, first, second, none, none]
}

/// Kinetic energy.
#[inline(always)]
pub fn energy<T: Number>(wheels: &TwoWheelsRod, [_, _, _, _, first, second]: [T; 6]) -> T {
    let [r1, r2, one] = parameters::<T, _>([wheels.r1, wheels.r2, 1.0]);
    ((one + r1 * r1) * (first * first) + (one + r2 * r2) * (second * second)).times(0.5)
}

/// Elastic impact at the shortest or longest rod: it reverses the rate of the distance between the wheels.
#[inline(always)]
pub fn impact<T: Number>(
    wheels: &TwoWheelsRod,
    [x1, x2, theta1, theta2, first, second]: [T; 6],
) -> [T; 6] {
    let [r1, r2, one] = parameters::<T, _>([wheels.r1, wheels.r2, 1.0]);
    let (n1, n2) = (r1 / (one + r1 * r1), r2 / (one + r2 * r2));
    let eps = (r2 * second - r1 * first).times(-2.0) / (r1 * n1 + r2 * n2);
    [x1, x2, theta1, theta2, first - eps * n1, second + eps * n2]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::generated;
    use crate::hand::agreement::{assert_numbers_agree, assert_states_agree};
    use crate::hand::number::numbers;

    const WHEELS: TwoWheelsRod = TwoWheelsRod {
        r1: 0.6,
        r2: 1.3,
        a: 1.2,
        b: 2.5,
    };

    #[test]
    fn the_wheels_by_hand_are_the_generated_ones() {
        assert_states_agree(&WHEELS, generated::rate, |wheels, state| {
            rate(wheels, numbers(state)).into()
        });
        assert_numbers_agree(&WHEELS, generated::energy, |wheels, state| {
            energy(wheels, numbers(state))
        });
        for end in 0..2 {
            assert_states_agree(
                &WHEELS,
                |wheels, state| generated::impact(wheels, end, state),
                |wheels, state| impact(wheels, numbers(state)).into(),
            );
        }
    }
}
