//! A bead on a family of similar ellipses: one integrable constraint.
//!
//! Facts: the speed is constant, and so is `x^2/A^2 + y^2/B^2`; the invariant density is `m^{11}`.
//! Source: W. Clark, thesis, section 5.3.

dalembert::model_file!("src/holonomic_bead_on_ellipses.dal");

#[cfg(test)]
mod tests {
    use super::*;
    use dalembert::{Constrained, Dop853, Scene, Simulation, System, Tolerance};

    #[test]
    fn the_bead_stays_on_its_ellipse_at_constant_speed() {
        let bead = HolonomicBeadOnEllipses::default();
        let state = bead
            .state(0.0, &[0.0, 1.0].into(), &[1.0, 0.0].into())
            .unwrap();
        let stepper = Dop853::new(Tolerance::new(1e-10).unwrap());
        let run = Simulation::new(&bead, stepper, bead.effects())
            .run(0.0, state, 100.0, &mut ())
            .unwrap();
        let level = bead.levels(100.0, &bead.position(&run.state))[0];
        assert!((level - 1.0).abs() < 1e-14, "{level}");
        assert!((bead.energy(100.0, &run.state).unwrap() - 0.5).abs() < 1e-8);
    }
}
