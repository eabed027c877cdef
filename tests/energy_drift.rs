//! Energy and constraint residuals of the rolling disk over 10 000 elastic impacts.

use core::ops::ControlFlow;

use dalembert::math::larger;
use dalembert::{Constrained, Observer, Outcome, Segment, System, VectorField};
use dalembert_cli::Integrator;
use dalembert_stability::course::{Course, state};
use dalembert_stability::text::{Model, shipped, value};

const IMPACTS: u64 = 10_000;

/// Tolerance, and the median of the relative energy errors after 10 000 impacts from the five starts below. Measured
/// with a handwritten DOP853 in velocities for this system (C, gcc 12, `-O3`).
const BY_HAND: [(f64, f64); 3] = [(1e-8, 1.6e-13), (1e-10, 9.0e-14), (1e-12, 1.0e-13)];

/// The largest constraint residual at the ends of steps, relative to its natural scale.
struct Residual<'a> {
    disk: &'a Model,
    worst: f64,
}

impl Observer<Model> for Residual<'_> {
    fn step(&mut self, segment: &mut Segment<'_, State>) -> ControlFlow<()> {
        let state = segment.end();
        let (q, qdot) = (self.disk.position(state), self.disk.velocity(0.0, state));
        let (residuals, scales) = self.disk.residuals(0.0, &q, &qdot.expect("a velocity"));
        for (residual, scale) in residuals.as_ref().iter().zip(scales.as_ref()) {
            self.worst = larger(self.worst, residual.abs() / scale);
        }
        ControlFlow::Continue(())
    }
}

type State = <Model as VectorField>::State;

/// The disk in the middle of the table, rolling and turning.
fn rolling(disk: &Model, roll: f64) -> State {
    let (phi, radius) = (core::f64::consts::FRAC_PI_2, value(disk, "R"));
    let qdot = [
        radius * phi.cos() * roll,
        radius * phi.sin() * roll,
        roll,
        0.2,
    ];
    state(disk, &[0.0, 0.0, 0.0, phi], &qdot)
}

/// Relative energy error and largest residual after 10 000 impacts.
fn drift(roll: f64, tol: f64) -> (f64, f64) {
    let disk = shipped("rolling_disk").model();
    let state = rolling(&disk, roll);
    let before = disk.energy(0.0, &state).expect("an energy");
    let mut residual = Residual {
        disk: &disk,
        worst: 0.0,
    };
    let run = Course::from_state(&disk, state, 1e7)
        .tol(tol)
        .impacts(IMPACTS)
        .observed(Integrator::Dop853, &mut residual);
    assert_eq!(
        (run.outcome, run.counters.impacts),
        (Outcome::ImpactBudget, IMPACTS)
    );
    let after = disk.energy(run.t, &run.state).expect("an energy");
    (((after - before) / before).abs(), residual.worst)
}

#[test]
fn energy_drifts_no_more_than_by_hand_and_constraints_hold() {
    for (tol, by_hand) in BY_HAND {
        let runs = [8.0, 9.0, 10.0, 11.0, 12.0].map(|roll| drift(roll, tol));
        let mut errors = runs.map(|(error, _)| error);
        errors.sort_by(f64::total_cmp);
        let residual = runs.iter().map(|(_, residual)| *residual).fold(0.0, larger);
        println!(
            "tol {tol:e}: median {:.1e} (by hand {by_hand:.1e}), all {errors:?}, residual {residual:.1e}",
            errors[2]
        );
        assert!(
            errors[2] <= 2.0 * by_hand,
            "tol {tol:e}: {:e} against {by_hand:e}",
            errors[2]
        );
        assert!(residual < 1e-12, "tol {tol:e}: residual {residual:e}");
    }
}
