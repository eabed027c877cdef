//! A mass on a spring.
//!
//! Facts: `x = x0 cos(w t) + (v0/w) sin(w t)` with `w = sqrt(k/m)`; the energy is constant.

dalembert::model_file!("src/harmonic_oscillator.dal");

#[cfg(test)]
mod tests {
    use super::*;
    use dalembert::{Dop853, Simulation, System, Tolerance};

    #[test]
    fn follows_the_cosine() {
        let oscillator = HarmonicOscillator { m: 2.0, k: 8.0 };
        let state = oscillator.state(0.0, &[1.0].into(), &[0.0].into()).unwrap();
        let stepper = Dop853::new(Tolerance::new(1e-12).unwrap());
        let run = Simulation::new(&oscillator, stepper, ())
            .run(0.0, state, 10.0, &mut ())
            .unwrap();
        assert!((run.state[0] - 20.0_f64.cos()).abs() < 1e-10);
    }
}
