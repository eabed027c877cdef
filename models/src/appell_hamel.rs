//! The machine of Appell and Hamel: a point whose speed along the ground is a multiple of its speed of falling.
//!
//! Facts: it keeps its direction along the ground, and its speed `u` there changes at the constant rate
//! `g k/(k^2 + 1)`, growing while it falls; where it is at rest the constraint has no gradient, and no motion follows from
//! it. Source: G. Hamel, *Theoretische Mechanik* (1949); W. Clark, thesis, Remark V.6 for the rule.

dalembert::model_file!("src/appell_hamel.dal");

#[cfg(test)]
mod tests {
    use super::*;
    use dalembert::{Dop853, Scene, Simulation, System, Tolerance};

    #[test]
    fn it_falls_along_a_straight_line_with_constant_acceleration() {
        let machine = AppellHamel::default();
        let qdot = [0.6, -0.8, -0.5].into();
        let state = machine.state(0.0, &[0.0; 3].into(), &qdot).unwrap();
        let stepper = Dop853::new(Tolerance::new(1e-13).unwrap());
        let run = Simulation::new(&machine, stepper, machine.effects())
            .run(0.0, state, 4.0, &mut ())
            .unwrap();
        let way = 4.0 + 0.5 * machine.g * machine.k / (machine.k * machine.k + 1.0) * 16.0;
        let expected = [0.6 * way, -0.8 * way, -0.5 * way];
        for (actual, expected) in run.state.iter().zip(expected) {
            assert!((actual - expected).abs() < 1e-11);
        }
    }
}
