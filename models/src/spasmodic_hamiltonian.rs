//! A Hamiltonian whose motion escapes in finite time, between two walls: energy and volume are kept, and yet impacts
//! accumulate.
//!
//! `H = p_x (1 + x^2) + p_y^2 x/2` is degenerate, no Lagrangian has it: its field is declared.
//!
//! Facts: from `x = 0`, `x = tan(t)`; the n-th impact comes at `acos(exp(-(n - y0)/p_y))`, and they accumulate at `pi/2`.
//! Source: W. Clark and A. Bloch, Example 6; its walls are `y = 0` and `y = 1`, where `S = {0, 1} x R` is printed.

dalembert::model_file!("src/spasmodic_hamiltonian.dal");

#[cfg(test)]
mod tests {
    use super::*;
    use dalembert::{EventLog, Outcome, Scene, Simulation, System, Taylor, Tolerance};

    #[test]
    fn impacts_come_as_the_motion_escapes() {
        let system = SpasmodicHamiltonian::default();
        let state = system
            .state(0.0, &[0.0, 0.5, 1.0, 1.0].into(), &[0.0; 4].into())
            .unwrap();
        let stepper = Taylor::new(Tolerance::new(1e-14).unwrap());
        let mut log = EventLog::<_, 8>::new();
        let run = Simulation::new(&system, stepper, system.effects())
            .run(0.0, state, 1.57, &mut log)
            .unwrap();
        assert_eq!((run.outcome, run.counters.impacts), (Outcome::Done, 7));
        for (n, event) in log.iter().enumerate() {
            let t = (-(n as f64 + 0.5)).exp().acos();
            assert!((event.t - t).abs() < 1e-12, "{n}: {} for {t}", event.t);
        }
    }
}
