//! A point on a plane in which a disk is replaced by the half of a sphere that stands on it, seen from above: a metric that
//! changes at a circle.
//!
//! Facts: outside motions are straight lines, inside great circles; at the circle the momentum along it stays, and the energy.
//! Source: W. Clark and A. Bloch, Example 3, with the metric `1 + x^2/(1 - x^2 - y^2)` that the sphere has.

dalembert::model_file!("src/sphere_in_plane.dal");

#[cfg(test)]
mod tests {
    use super::*;
    use dalembert::{Dop853, Outcome, Scene, Simulation, System, Tolerance};

    #[test]
    fn angular_momentum_and_energy_are_kept_across_the_circle() {
        let point = SphereInPlane::default();
        let state = point
            .state(0.0, &[-1.0, 0.2].into(), &[1.0, 0.1].into())
            .unwrap();
        let stepper = Dop853::new(Tolerance::new(1e-13).unwrap());
        let run = Simulation::new(&point, stepper, point.effects())
            .run(0.0, state, 3.0, &mut ())
            .unwrap();
        assert_eq!((run.outcome, run.counters.impacts), (Outcome::Done, 2));
        let turning = |t: f64, state: &_| {
            let (q, p) = (point.position(state), point.momentum(t, state).unwrap());
            q[0] * p[1] - q[1] * p[0]
        };
        assert!((turning(3.0, &run.state) - turning(0.0, &state)).abs() < 1e-12);
        let energy = point.energy(3.0, &run.state).unwrap();
        let drift = energy - point.energy(0.0, &state).unwrap();
        assert!(drift.abs() < 1e-12, "{drift:e}");
    }
}
