//! D under the discrete Lagrange-d'Alembert principle: kept to rounding at the ends of steps, in the global form that
//! could leave it.

use core::ops::ControlFlow;

use dalembert::{
    Constrained, Described, Dla2, Dla4, Gauss4, Instance, Lagrangian, Observer, Outcome, Segment,
    Simulation, StateVector, Stepper, System, Tolerance,
};
use dalembert_models::{BallOnRotatingTable, ChaplyginSleigh, RollingBallEuler, RollingDisk};
use dalembert_tests::sampling::states;
use dalembert_tests::systems::{
    AffineSleigh, DampedSleigh, FallingDisk, IntegrableBead, MagneticDisk, Rheonomic, RouthSphere,
};

/// A few units in the last place; the effect `Projection` begins to act at `2^-44 = 6e-14`.
const ROUNDING: f64 = 1e-14;

/// The largest residual at the ends of steps, and the largest sum of absolute terms of one.
struct Residual<'a, S> {
    system: &'a S,
    worst: f64,
    size: f64,
}

impl<S: Constrained> Observer<S> for Residual<'_, S> {
    fn step(&mut self, segment: &mut Segment<'_, S::State>) -> ControlFlow<()> {
        let (t, q) = (segment.t_end(), self.system.position(segment.end()));
        // At the end of a chart there may be no velocity.
        let Ok(qdot) = self.system.velocity(t, segment.end()) else {
            return ControlFlow::Continue(());
        };
        let (residuals, scales) = self.system.residuals(t, &q, &qdot);
        for (residual, scale) in residuals.as_slice().iter().zip(scales.as_slice()) {
            self.worst = self.worst.max(residual.abs());
            self.size = self.size.max(*scale);
        }
        ControlFlow::Continue(())
    }
}

/// The largest residual of a run without projection, as a part of the largest sum of absolute terms.
fn residual<S: Constrained, Step: Stepper<S>>(
    system: &S,
    state: S::State,
    stepper: Step,
    until: f64,
) -> f64 {
    let mut residual = Residual {
        system,
        worst: 0.0,
        size: 0.0,
    };
    let run = Simulation::new(system, stepper, ())
        .run(0.0, state, until, &mut residual)
        .expect("a start");
    assert!(
        matches!(run.outcome, Outcome::Done | Outcome::LeftChart { .. }),
        "{}",
        run.outcome
    );
    assert!(run.counters.accepted >= 20);
    residual.worst / residual.size
}

fn check<S: Described + Constrained + Lagrangian>(system: &S, until: f64) {
    let tolerance = Tolerance::new(1e-9).expect("a tolerance");
    let name = S::DESCRIPTION.name;
    for state in states(system, 3, 11) {
        let second = Dla2::new(tolerance).with_step(0.01);
        let fourth = Dla4::new(tolerance).with_step(0.02);
        let kept = [
            residual(system, state, second, until),
            residual(system, state, fourth, until),
        ];
        println!("{name}: {kept:?}");
        assert!(
            kept.iter().all(|&residual| residual < ROUNDING),
            "{name}: {kept:?}"
        );
    }
}

#[test]
fn constraints_hold_to_rounding_at_the_ends_of_steps() {
    // Affine, time dependent, with forces, velocity-linear terms and metrics that depend on positions among them.
    check(&ChaplyginSleigh::default().global(), 1000.0);
    check(&RollingDisk::default().global(), 1000.0);
    check(&BallOnRotatingTable::default().global(), 5.0);
    check(&RollingBallEuler::default().global(), 5.0);
    // Soon after this its motion blows up.
    check(&AffineSleigh::default().global(), 0.4);
    check(&MagneticDisk::default().global(), 100.0);
    check(&DampedSleigh::default().global(), 100.0);
    check(&Rheonomic::default().global(), 10.0);
    check(&FallingDisk::default().global(), 3.0);
    check(&RouthSphere::default().global(), 5.0);
    check(&IntegrableBead::default().global(), 100.0);
}

#[test]
fn other_methods_leave_the_constraints_by_their_error() {
    let sleigh = ChaplyginSleigh::default().global();
    let state = states(&sleigh, 1, 11)[0];
    let stepper = Gauss4::new(Tolerance::new(1e-9).expect("a tolerance")).with_step(0.5);
    assert!(residual(&sleigh, state, stepper, 100.0) > 1e-8);
}

#[test]
fn levels_of_quadratic_constraints_hold_to_rounding() {
    let bead = IntegrableBead::default().global();
    let state = states(&bead, 1, 3)[0];
    let stepper = Dla2::new(Tolerance::new(1e-9).expect("a tolerance")).with_step(0.05);
    let run = Simulation::new(&bead, stepper, ())
        .run(0.0, state, 500.0, &mut ())
        .expect("a start");
    let level = |t: f64, state| bead.levels(t, &bead.position(state))[0];
    assert!((level(run.t, &run.state) - level(0.0, &state)).abs() < 1e-12);
}

#[test]
fn a_start_off_the_constraints_is_brought_to_them() {
    let sleigh = ChaplyginSleigh::default().global();
    let state = sleigh
        .state_unchecked(0.0, &[0.0; 3].into(), &[1.0, 0.5, 0.3].into())
        .expect("a state");
    let stepper = Dla2::new(Tolerance::new(1e-9).expect("a tolerance")).with_step(0.01);
    assert!(residual(&sleigh, state, stepper, 10.0) < ROUNDING);
}
