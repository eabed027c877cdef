//! The Chaplygin sleigh on an elliptical table, a billiard with both tips of the blade.
//!
//! Facts: with `K = I + m a^2` the free sleigh has `v = V tanh(s t + c)`, `omega = sqrt(2E/K) sech(s t + c)`,
//! `V = sqrt(2E/m)`, `s = a m V/K`: it always ends with its centre of mass ahead.
//! Source: W. Clark, thesis, section 7.5; W. Clark and A. Bloch, section 8.1.

dalembert::model_file!("src/chaplygin_sleigh.dal");

#[cfg(test)]
mod tests {
    use super::*;
    use dalembert::{Dop853, Simulation, System, Tolerance};

    #[test]
    fn the_free_sleigh_follows_tanh_and_sech() {
        let sleigh = ChaplyginSleigh {
            m: 1.3,
            I: 0.7,
            a: 0.4,
            ..ChaplyginSleigh::default()
        };
        let (v0, w0) = (-1.0, 0.5);
        let state = sleigh
            .state(0.0, &[0.0; 3].into(), &[v0, 0.0, w0].into())
            .unwrap();
        let stepper = Dop853::new(Tolerance::new(1e-13).unwrap());
        let run = Simulation::new(&sleigh, stepper, ())
            .run(0.0, state, 20.0, &mut ())
            .unwrap();
        let qdot = sleigh.velocity(20.0, &run.state).unwrap();
        let theta = run.state[2];
        let speed = qdot[0] * theta.cos() + qdot[1] * theta.sin();
        assert!((speed - 1.0837967441759566).abs() < 1e-10, "{speed}");
        assert!((qdot[2] - 5.255241495e-05).abs() < 1e-12, "{}", qdot[2]);
    }
}
