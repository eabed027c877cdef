//! The point billiard: next to no work, so that what surrounds the formulas shows.

use dalembert_models::PointBilliard;

use crate::State;

type PointState = State<PointBilliard>;

/// Straight lines.
#[inline]
pub fn rate(point: &PointBilliard, state: &PointState) -> PointState {
    let [_, _, p_x, p_y]: [f64; 4] = (*state).into();
    let light = 1.0 / point.m;
    [p_x * light, p_y * light, 0.0, 0.0].into()
}

/// Kinetic energy.
#[inline]
pub fn energy(point: &PointBilliard, state: &PointState) -> f64 {
    let [_, _, p_x, p_y]: [f64; 4] = (*state).into();
    0.5 * (p_x * p_x + p_y * p_y) / point.m
}

/// Specular reflection at the normal `n` of the ellipse.
#[inline]
pub fn impact(point: &PointBilliard, state: &PointState) -> PointState {
    let [x, y, p_x, p_y]: [f64; 4] = (*state).into();
    let (n_x, n_y) = (x / (point.ta * point.ta), y / (point.tb * point.tb));
    let eps = -2.0 * (p_x * n_x + p_y * n_y) / (n_x * n_x + n_y * n_y);
    [x, y, p_x + eps * n_x, p_y + eps * n_y].into()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::generated;
    use crate::hand::agreement::{assert_numbers_agree, assert_states_agree};

    const POINT: PointBilliard = PointBilliard {
        m: 1.3,
        ta: 1.5,
        tb: 0.8,
    };

    #[test]
    fn the_point_by_hand_is_the_generated_one() {
        assert_states_agree(&POINT, generated::rate, rate);
        assert_numbers_agree(&POINT, generated::energy, energy);
        assert_states_agree(
            &POINT,
            |point, state| generated::impact(point, 0, state),
            impact,
        );
    }
}
