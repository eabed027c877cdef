//! The point billiard. Its formulas cost so little that the cost of the code around them shows.

use dalembert_models::PointBilliard;

use super::number::{Number, parameters};

/// Motion in straight lines.
#[inline(always)]
pub fn rate<T: Number>(point: &PointBilliard, [_, _, p_x, p_y]: [T; 4]) -> [T; 4] {
    let [m] = parameters::<T, _>([point.m]);
    let (light, none) = (m.reciprocal(), T::of(0.0));
    [p_x * light, p_y * light, none, none]
}

/// Kinetic energy.
#[inline(always)]
pub fn energy<T: Number>(point: &PointBilliard, [_, _, p_x, p_y]: [T; 4]) -> T {
    let [m] = parameters::<T, _>([point.m]);
    ((p_x * p_x + p_y * p_y) / m).times(0.5)
}

/// Specular reflection at the ellipse, whose normal is `n` (not normalised).
#[inline(always)]
pub fn impact<T: Number>(point: &PointBilliard, [x, y, p_x, p_y]: [T; 4]) -> [T; 4] {
    let [a, b] = parameters::<T, _>([point.ta, point.tb]);
    let (n_x, n_y) = (x / (a * a), y / (b * b));
    let eps = (p_x * n_x + p_y * n_y).times(-2.0) / (n_x * n_x + n_y * n_y);
    [x, y, p_x + eps * n_x, p_y + eps * n_y]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::generated;
    use crate::hand::agreement::{assert_numbers_agree, assert_states_agree};
    use crate::hand::number::numbers;

    const POINT: PointBilliard = PointBilliard {
        m: 1.3,
        ta: 1.5,
        tb: 0.8,
    };

    #[test]
    fn the_point_by_hand_is_the_generated_one() {
        assert_states_agree(&POINT, generated::rate, |point, state| {
            rate(point, numbers(state)).into()
        });
        assert_numbers_agree(&POINT, generated::energy, |point, state| {
            energy(point, numbers(state))
        });
        assert_states_agree(
            &POINT,
            |point, state| generated::impact(point, 0, state),
            |point, state| impact(point, numbers(state)).into(),
        );
    }
}
