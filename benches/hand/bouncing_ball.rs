//! The bouncing ball.

use dalembert_models::BouncingBall;

use super::number::{Number, parameters};

/// Rate of the state in free fall.
#[inline(always)]
pub fn rate<T: Number>(ball: &BouncingBall, [_, p]: [T; 2]) -> [T; 2] {
    let [m, g] = parameters::<T, _>([ball.m, ball.g]);
    [p / m, -(m * g)]
}

/// Kinetic and potential energy.
#[inline(always)]
pub fn energy<T: Number>(ball: &BouncingBall, [x, p]: [T; 2]) -> T {
    let [m, g] = parameters::<T, _>([ball.m, ball.g]);
    (p * p / m).times(0.5) + m * g * x
}

/// State after an elastic impact: the momentum is reversed.
#[inline(always)]
pub fn impact<T: Number>(_: &BouncingBall, [x, p]: [T; 2]) -> [T; 2] {
    [x, -p]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::generated;
    use crate::hand::agreement::{assert_numbers_agree, assert_states_agree};
    use crate::hand::number::numbers;

    const BALL: BouncingBall = BouncingBall { m: 1.3, g: 9.81 };

    #[test]
    fn the_ball_by_hand_is_the_generated_one() {
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
    }
}
