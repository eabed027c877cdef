//! A ball that bounces on a floor.
//!
//! Facts: with restitution `e` from rest at height `x0` the n-th impact is at
//! `sqrt(2 x0/g) (1 + 2 (e + .. + e^{n-1}))`, and the impacts accumulate where that series ends.
//! Source: W. Clark, thesis, Example IX.9.

dalembert::model_file!("src/bouncing_ball.dal");

#[cfg(test)]
mod tests {
    use super::*;
    use dalembert::{System, VectorField};

    #[test]
    fn falls_with_the_acceleration_of_gravity() {
        let ball = BouncingBall { m: 2.0, g: 9.81 };
        let state = ball.state(0.0, &[1.0].into(), &[0.5].into()).unwrap();
        let mut rate = state;
        ball.rate(0.0, &state, &mut rate).unwrap();
        assert_eq!(rate.as_slice(), [0.5, -2.0 * 9.81]);
    }
}
