//! A particle that is kept at constant speed while gravity turns it.
//!
//! Facts: with the direction `(cos(a), sin(a))`, `adot = -(g/v) cos(a)`, so that `sin(a) = -tanh(g t/v + C)`: every motion ends
//! falling straight down. The constraint is not linear in the velocities; its force is a multiple of the velocity itself (Chetaev's
//! rule). Source: W. Clark, thesis, Remark V.6.

dalembert::model_file!("src/constant_speed.dal");

#[cfg(test)]
mod tests {
    use super::*;
    use dalembert::{Instance, Scene, Simulation, System, Taylor, Tolerance};

    #[test]
    fn the_direction_falls_as_a_hyperbolic_tangent() {
        let particle = ConstantSpeed::default();
        let start = particle.initial();
        let qdot = particle
            .complete_velocity(0.0, &start.q, &start.qdot, &start.named)
            .unwrap();
        assert!((qdot[1] - 1.6).abs() < 1e-15, "the one that is not named");
        let state = particle.state(0.0, &start.q, &qdot).unwrap();
        let stepper = Taylor::new(Tolerance::new(1e-13).unwrap());
        let run = Simulation::new(&particle, stepper, particle.effects())
            .run(0.0, state, 3.0, &mut ())
            .unwrap();
        let (g, v) = (particle.g, particle.v);
        let (from, to) = ((-0.8_f64).atanh(), (-0.8_f64).atanh() + 3.0 * g / v);
        let height = -v * v / g * (to.cosh() / from.cosh()).ln();
        let along = v * v / g * (to.sinh().atan() - from.sinh().atan());
        assert!((run.state[0] - along).abs() < 1e-11);
        assert!((run.state[1] - height).abs() < 1e-11);
    }
}
