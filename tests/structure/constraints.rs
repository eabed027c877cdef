//! Integrators of the discrete Lagrange-d'Alembert principle keep states on D to rounding errors at the ends of steps,
//! even in the global form, in which states can leave D.

use core::ops::ControlFlow;

use dalembert::erased::Bounded;
use dalembert::integrate::Chosen;
use dalembert::math::larger;
use dalembert::{
    Constrained, Dla2, Dla4, Gauss4, Instance, Observer, Outcome, Segment, Simulation, StateVector,
    Stepper, System, Tolerance, VectorField,
};
use dalembert_stability::text::Large;
use dalembert_tests::sampling::{states, system};

type State = <Large as VectorField>::State;

/// A few units in the last place; the effect `Projection` begins to act at `2^-44 = 6e-14`.
const ROUNDING: f64 = 1e-14;

/// The largest residual at the ends of steps, and the largest sum of the absolute terms of a residual.
struct Residual<'a> {
    system: &'a Large,
    worst: f64,
    size: f64,
}

impl Observer<Large> for Residual<'_> {
    fn step(&mut self, segment: &mut Segment<'_, State>) -> ControlFlow<()> {
        let (t, q) = (segment.t_end(), self.system.position(segment.end()));
        // At the edge of a chart the velocity may not exist.
        let Ok(qdot) = self.system.velocity(t, segment.end()) else {
            return ControlFlow::Continue(());
        };
        let (residuals, scales) = self.system.residuals(t, &q, &qdot);
        for (residual, scale) in residuals.as_slice().iter().zip(scales.as_slice()) {
            self.worst = larger(self.worst, residual.abs());
            self.size = larger(self.size, *scale);
        }
        ControlFlow::Continue(())
    }
}

/// The largest residual of a run without projection, relative to the largest sum of absolute terms.
fn residual(system: &Large, state: State, mut stepper: impl Stepper<Large>, until: f64) -> f64 {
    let mut residual = Residual {
        system,
        worst: 0.0,
        size: 0.0,
    };
    let run = Simulation::new(system, Chosen::new(&mut stepper), ())
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

/// Checks the global form of a system.
fn check(name: &str, until: f64) {
    let system = &system(name).global().expect("the global form");
    let tolerance = Tolerance::new(1e-9).expect("a tolerance");
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
    // These include affine and time-dependent constraints, forces, velocity-linear terms and variable metrics.
    check("chaplygin_sleigh", 100.0);
    check("rolling_disk", 100.0);
    check("ball_on_rotating_table", 5.0);
    check("rolling_ball_euler", 5.0);
    // The motion of the affine sleigh blows up soon after this time.
    check("affine_sleigh", 0.4);
    check("magnetic_disk", 100.0);
    check("damped_sleigh", 100.0);
    check("rheonomic", 10.0);
    check("falling_disk", 3.0);
    check("routh_sphere", 5.0);
    check("integrable_bead", 100.0);
}

#[test]
fn other_methods_leave_the_constraints_by_their_error() {
    let sleigh = system("chaplygin_sleigh")
        .global()
        .expect("the global form");
    let state = states(&sleigh, 1, 11)[0];
    let stepper = Gauss4::new(Tolerance::new(1e-9).expect("a tolerance")).with_step(0.5);
    assert!(residual(&sleigh, state, stepper, 100.0) > 1e-8);
}

#[test]
fn levels_of_quadratic_constraints_hold_to_rounding() {
    let bead = system("integrable_bead").global().expect("the global form");
    let state = states(&bead, 1, 3)[0];
    let mut stepper = Dla2::new(Tolerance::new(1e-9).expect("a tolerance")).with_step(0.05);
    let run = Simulation::new(&bead, Chosen::new(&mut stepper), ())
        .run(0.0, state, 500.0, &mut ())
        .expect("a start");
    let level = |t: f64, state| bead.levels(t, &bead.position(state)).as_slice()[0];
    assert!((level(run.t, &run.state) - level(0.0, &state)).abs() < 1e-12);
}

#[test]
fn a_start_off_the_constraints_is_brought_to_them() {
    let sleigh = system("chaplygin_sleigh")
        .global()
        .expect("the global form");
    let state = sleigh
        .state_unchecked(0.0, &Bounded::of(&[0.0; 3]), &Bounded::of(&[1.0, 0.5, 0.3]))
        .expect("a state");
    let stepper = Dla2::new(Tolerance::new(1e-9).expect("a tolerance")).with_step(0.01);
    assert!(residual(&sleigh, state, stepper, 10.0) < ROUNDING);
}
