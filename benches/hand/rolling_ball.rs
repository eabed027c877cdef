//! The rolling ball on a table at rest or on a rotating one. A state on the constraint distribution consists of the
//! position, the Euler angles and the angular velocity in space.

use dalembert_models::{BallOnRotatingTable, RollingBallEuler};

use super::number::{Number, parameters};

/// Rates of the Euler angles.
#[inline(always)]
fn angle_rates<T: Number>(theta: T, psi: T, [w_x, w_y, w_z]: [T; 3]) -> [T; 3] {
    let ((sin_theta, cos_theta), (sin_psi, cos_psi)) = (theta.sin_cos(), psi.sin_cos());
    let phi_dot = (sin_psi * w_x - cos_psi * w_y) / sin_theta;
    let theta_dot = cos_psi * w_x + sin_psi * w_y;
    [phi_dot, theta_dot, w_z - cos_theta * phi_dot]
}

/// The rate on a table at rest: the angular velocity is constant.
#[inline(always)]
pub fn rate<T: Number>(
    ball: &RollingBallEuler,
    [_, _, _, theta, psi, w_x, w_y, w_z]: [T; 8],
) -> [T; 8] {
    let [r] = parameters::<T, _>([ball.r]);
    let [phi_dot, theta_dot, psi_dot] = angle_rates(theta, psi, [w_x, w_y, w_z]);
    let none = T::of(0.0);
    [
        r * w_y,
        -(r * w_x),
        phi_dot,
        theta_dot,
        psi_dot,
        none,
        none,
        none,
    ]
}

/// Kinetic energy.
#[inline(always)]
pub fn energy<T: Number>(ball: &RollingBallEuler, [_, _, _, _, _, w_x, w_y, w_z]: [T; 8]) -> T {
    let [r, k] = parameters::<T, _>([ball.r, ball.k]);
    let gyration = k * k;
    ((gyration + r * r) * (w_x * w_x + w_y * w_y) + gyration * (w_z * w_z)).times(0.5)
}

/// Elastic impact: the velocity `r (w_y, -w_x)` of the centre is reflected at the rim.
#[inline(always)]
pub fn impact<T: Number>(
    ball: &RollingBallEuler,
    [x, y, phi, theta, psi, w_x, w_y, w_z]: [T; 8],
) -> [T; 8] {
    let [a, b] = parameters::<T, _>([ball.ta, ball.tb]);
    let (n_x, n_y) = (x / (a * a), y / (b * b));
    let eps = (n_x * w_y - n_y * w_x).times(-2.0) / (n_x * n_x + n_y * n_y);
    [x, y, phi, theta, psi, w_x - eps * n_y, w_y + eps * n_x, w_z]
}

/// The rate on the rotating table, where the angular acceleration is proportional to the velocity of the centre.
#[inline(always)]
pub fn rate_on_table<T: Number>(
    ball: &BallOnRotatingTable,
    [x, y, _, theta, psi, w_x, w_y, w_z]: [T; 8],
) -> [T; 8] {
    let [r, k, turning] = parameters::<T, _>([ball.r, ball.k, ball.Om]);
    let [phi_dot, theta_dot, psi_dot] = angle_rates(theta, psi, [w_x, w_y, w_z]);
    let (x_dot, y_dot) = (r * w_y - turning * y, turning * x - r * w_x);
    let drag = r * turning / (k * k + r * r);
    [
        x_dot,
        y_dot,
        phi_dot,
        theta_dot,
        psi_dot,
        drag * x_dot,
        drag * y_dot,
        T::of(0.0),
    ]
}

/// Kinetic energy on the rotating table.
#[inline(always)]
pub fn energy_on_table<T: Number>(
    ball: &BallOnRotatingTable,
    [x, y, _, _, _, w_x, w_y, w_z]: [T; 8],
) -> T {
    let [r, k, turning] = parameters::<T, _>([ball.r, ball.k, ball.Om]);
    let (x_dot, y_dot) = (r * w_y - turning * y, turning * x - r * w_x);
    (x_dot * x_dot + y_dot * y_dot + k * k * (w_x * w_x + w_y * w_y + w_z * w_z)).times(0.5)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::generated;
    use crate::hand::agreement::{assert_numbers_agree, assert_states_agree};
    use crate::hand::number::numbers;

    const BALL: RollingBallEuler = RollingBallEuler {
        r: 0.7,
        k: 0.4,
        ta: 1.5,
        tb: 0.8,
    };
    const ON_TABLE: BallOnRotatingTable = BallOnRotatingTable {
        r: 0.7,
        k: 0.4,
        Om: 0.6,
    };

    #[test]
    fn the_balls_by_hand_are_the_generated_ones() {
        assert_states_agree(&BALL, generated::rate, |ball, state| {
            rate(ball, numbers(state)).into()
        });
        assert_numbers_agree(&BALL, generated::energy, |ball, state| {
            energy(ball, numbers(state))
        });
        assert_states_agree(
            &BALL,
            |ball, state| generated::impact(ball, 0, state),
            |ball, state| impact(ball, numbers(state)).into(),
        );
        assert_states_agree(&ON_TABLE, generated::rate, |ball, state| {
            rate_on_table(ball, numbers(state)).into()
        });
        assert_numbers_agree(&ON_TABLE, generated::energy, |ball, state| {
            energy_on_table(ball, numbers(state))
        });
    }
}
