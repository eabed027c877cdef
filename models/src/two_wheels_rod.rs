//! Two wheels on parallel axles, joined by a rod that slides between two stops.
//!
//! Facts: both rolling constraints are integrable (`x - r theta` is constant); an elastic stop exchanges
//! momentum between the wheels. Source: J. Cortes and A. Vinogradov, section 6.4.

dalembert::model_file!("src/two_wheels_rod.dal");

#[cfg(test)]
mod tests {
    use super::*;
    use dalembert::{Dop853, Scene, Simulation, System, Tolerance};

    #[test]
    fn wheels_do_not_slip_across_impacts() {
        let wheels = TwoWheelsRod::default();
        let state = wheels
            .state(
                0.0,
                &[0.0, 2.0, 0.0, 0.0].into(),
                &[0.5, -0.25, 1.0, -0.25].into(),
            )
            .unwrap();
        let stepper = Dop853::new(Tolerance::new(1e-12).unwrap());
        let run = Simulation::new(&wheels, stepper, wheels.effects())
            .run(0.0, state, 50.0, &mut ())
            .unwrap();
        assert!(run.counters.impacts > 10);
        assert!((run.state[0] - wheels.r1 * run.state[2]).abs() < 1e-12);
        assert!((run.state[1] - 2.0 - wheels.r2 * run.state[3]).abs() < 1e-12);
    }
}
