//! A point in a strip whose walls give it speed: impacts accumulate although no volume is lost.
//!
//! Facts: an impact multiplies volume by `al^2 be`, 1 for the declared parameters. From `x = 0` with speed `v0` the n-th impact
//! comes at `(1/v0) (1 + 1/al + .. + 1/al^(n-1))`; they accumulate at `al/(v0 (al - 1))`, where the speed is infinite.
//! Source: W. Clark and A. Bloch, Examples 4 and 5; `al > 1`, where Example 4 prints `al > 0`.

dalembert::model_file!("src/super_elastic_strip.dal");

#[cfg(test)]
mod tests {
    use super::*;
    use dalembert::{EventLog, Outcome, Scene, Simulation, System, Taylor, Tolerance};

    #[test]
    fn impacts_come_in_a_geometric_series() {
        let strip = SuperElasticStrip::default();
        let state = strip
            .state(0.0, &[0.0, 0.0].into(), &[1.0, 1.0].into())
            .unwrap();
        let stepper = Taylor::new(Tolerance::new(1e-12).unwrap());
        let mut log = EventLog::<_, 17>::new();
        let run = Simulation::new(&strip, stepper, strip.effects())
            .run(0.0, state, 4.9, &mut log)
            .unwrap();
        assert_eq!((run.outcome, run.counters.impacts), (Outcome::Done, 17));
        let mut t = 0.0;
        for (n, event) in log.iter().enumerate() {
            t += strip.al.powi(-(n as i32));
            assert!((event.t - t).abs() < 1e-13 * t, "{n}: {} for {t}", event.t);
        }
    }
}
