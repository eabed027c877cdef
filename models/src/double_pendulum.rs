//! A planar double pendulum: two point masses on two rods, absolute angles from the downward vertical.
//!
//! Facts: the energy is constant; small oscillations of equal masses on equal rods have the frequencies
//! `sqrt((2 -+ sqrt 2) g/l)`.

dalembert::model_file!("src/double_pendulum.dal");

#[cfg(test)]
mod tests {
    use super::*;
    use dalembert::{System, VectorField};

    /// The upright plane pendulum's textbook equations at a state worked by hand: both rods horizontal.
    #[test]
    fn horizontal_rods_at_rest_fall_as_a_beam_on_a_pivot() {
        let pendulum = DoublePendulum::default();
        let quarter = core::f64::consts::FRAC_PI_2;
        let state = pendulum
            .state(0.0, &[quarter, quarter].into(), &[0.0, 0.0].into())
            .unwrap();
        let mut rate = state;
        pendulum.rate(0.0, &state, &mut rate).unwrap();
        // pdot = dL/dq: the torques -(m1 + m2) g l1 and -m2 g l2.
        assert!((rate[2] + 2.0 * 9.81).abs() < 1e-14);
        assert!((rate[3] + 9.81).abs() < 1e-14);
    }
}
