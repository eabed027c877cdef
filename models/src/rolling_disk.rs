//! The vertical rolling disk on an elliptical table, a billiard with both edges of the disk.
//!
//! Facts: between impacts `dot(theta)` and `dot(phi)` are constant and the point of contact runs on a circle of
//! radius `|R dot(theta)/dot(phi)|`; on a circular table they alternate between two pairs of values.
//! Source: W. Clark, thesis, section 6.4 (Figures 6.2 to 6.4: `ta = tb = 0.2` and `ta = 0.15`).

dalembert::model_file!("src/rolling_disk.dal");

#[cfg(test)]
mod tests {
    use super::*;
    use dalembert::{Dop853, Simulation, System, Tolerance};

    #[test]
    fn the_contact_point_runs_on_a_circle() {
        let disk = RollingDisk::default();
        let (roll, turn) = (10.0, 2.0);
        let qdot = [0.0, disk.R * roll, roll, turn].into();
        let start = core::f64::consts::FRAC_PI_2;
        let state = disk
            .state(0.0, &[0.0, 0.0, 0.0, start].into(), &qdot)
            .unwrap();
        let stepper = Dop853::new(Tolerance::new(1e-13).unwrap());
        let run = Simulation::new(&disk, stepper, ())
            .run(0.0, state, 3.0, &mut ())
            .unwrap();
        let (radius, phi) = (disk.R * roll / turn, start + 3.0 * turn);
        assert!((run.state[0] - radius * (phi.sin() - start.sin())).abs() < 1e-12);
        assert!((run.state[1] + radius * (phi.cos() - start.cos())).abs() < 1e-12);
    }
}
