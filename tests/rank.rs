//! Constraints whose rank drops at one instant of the motion. For every step size the run ends there and nowhere else.

use core::f64::consts::FRAC_PI_2;

use dalembert::{Event, EventLog, Instance, Outcome, Run, StateVector, System, VectorField};
use dalembert_cli::Integrator;
use dalembert_stability::course::{Course, is_discrete, vector};
use dalembert_stability::text::{Large, Model, Text, shipped};
use dalembert_tests::sampling::every_system;

/// The second form depends on the first at `y = 0`.
static CROSSED: Text = Text::new(
    "Crossed {
        coordinates { x; y; z; }
        parameters { wall = 10; }
        lagrangian = (dot(x)^2 + dot(y)^2 + dot(z)^2)/2;
        constraints { first: d(x) = 0; second: d(x) + y*d(z) = 0; }
        impacts { end: wall - y >= 0; }
    }",
);

/// The second form depends on the first at `y = 0`, to second order.
static TOUCHED: Text = Text::new(
    "Touched {
        coordinates { x; y; z; }
        lagrangian = (dot(x)^2 + dot(y)^2 + dot(z)^2)/2;
        constraints { first: d(x) = 0; second: d(x) + y^2*d(z) = 0; }
    }",
);

/// The second form depends on the first at two nearby positions.
static TWICE: Text = Text::new(
    "Twice {
        coordinates { x; y; z; }
        parameters { apart = 1e-3; }
        lagrangian = (dot(x)^2 + dot(y)^2 + dot(z)^2)/2;
        constraints { first: d(x) = 0; second: d(x) + y*(y - apart)*d(z) = 0; }
    }",
);

/// The second form depends on the first, or nearly, at the tip of a narrow peak.
static NEEDLE: Text = Text::new(
    "Needle {
        coordinates { x; y; z; }
        parameters { s > 0 = 1e-2; left = 0; }
        lagrangian = (dot(x)^2 + dot(y)^2 + dot(z)^2)/2;
        constraints { first: d(x) = 0; second: d(x) + (1 + left - exp(-(y/s)^2))*d(z) = 0; }
    }",
);

/// The second form depends on the first at `cos(theta) = 0`.
static UPRIGHT: Text = Text::new(
    "Upright {
        coordinates { x; y; z; theta: angle; }
        lagrangian = (dot(x)^2 + dot(y)^2 + dot(z)^2 + dot(theta)^2)/2 - x*y/3;
        constraints { first: d(x) - y*d(y) = 0; second: cos(theta)*d(z) + d(x) - y*d(y) = 0; }
    }",
);

/// The second form depends on the first at `t = 1`.
static TIMED: Text = Text::new(
    "Timed {
        coordinates { x; y; z; }
        lagrangian = (dot(x)^2 + dot(y)^2 + dot(z)^2)/2 - y;
        constraints { first: d(x) = 0; second: d(x) + (1 - t)*d(z) = 0; }
    }",
);

/// One form, which vanishes only at the origin and turns fast near it.
static CENTRED: Text = Text::new(
    "Centred {
        coordinates { x; y; z; w; }
        lagrangian = (dot(x)^2 + dot(y)^2 + dot(z)^2 + dot(w)^2)/2;
        constraints { only: x*d(z) + y*d(w) = 0; }
    }",
);

/// Forms that are nearly dependent everywhere if `delta` is small.
static NEARLY_DEPENDENT: Text = Text::new(
    "NearlyDependent {
        coordinates { x; y; z; w; }
        parameters { delta = 1; }
        lagrangian = (dot(x)^2 + dot(y)^2 + dot(z)^2 + dot(w)^2)/2 - x*z;
        constraints {
            first: dot(z) - y*dot(x) = 0;
            second: dot(z) - y*dot(x) + delta*(dot(w) - x*dot(y)) = 0;
        }
    }",
);

/// A bead on a circle, whose form turns with it and never vanishes.
static RING: Text = Text::new(
    "Ring {
        coordinates { x; y; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2;
        constraints { ring: (x*d(x) + y*d(y))*(1 + x^2) = 0; }
    }",
);

/// A free mode below `y = -1/2`, and above it a mode whose forms become dependent at `y = 0`.
static ENTERED: Text = Text::new(
    "Entered {
        coordinates { x; y; z; }
        lagrangian = (dot(x)^2 + dot(y)^2 + dot(z)^2)/2;
        modes {
            free { initial { y = -1; dot(y) = 1; until = 2; } }
            bound { constraints { first: d(x) = 0; second: d(x) + y*d(z) = 0; } }
        }
        transitions { enter: free -> bound when y + 1/2 >= 0; }
    }",
);

type State = <Model as VectorField>::State;

/// Events of a run.
type Log = EventLog<State, 4>;

struct Start<'a> {
    system: &'a Model,
    state: State,
    until: f64,
}

const STEPS: [f64; 6] = [f64::INFINITY, 3.0, 0.5, 0.37, 0.1, 1.0 / 64.0];

impl<'a> Start<'a> {
    fn new(system: &'a Model, q: &[f64], qdot: &[f64], until: f64) -> Self {
        let state = system.state_projected(0.0, &vector(q), &vector(qdot));
        Self {
            system,
            state: state.expect("a state"),
            until,
        }
    }

    /// Runs with every integrator except those of the discrete principle, and with every step size.
    fn every(&self, judge: impl Fn(&str, Run<State>, &Log)) {
        self.run(false, judge);
    }

    /// Runs with the integrators of the discrete principle.
    fn discrete(&self, judge: impl Fn(&str, Run<State>, &Log)) {
        self.run(true, judge);
    }

    fn run(&self, discrete: bool, judge: impl Fn(&str, Run<State>, &Log)) {
        for step in STEPS {
            for &integrator in Integrator::every() {
                if is_discrete(integrator) != discrete {
                    continue;
                }
                let mut log = Log::new();
                let run = Course::from_state(self.system, self.state, self.until)
                    .tol(1e-10)
                    .step(step)
                    .steps(100_000)
                    .observed(integrator, &mut log);
                let name = integrator.name();
                judge(&format!("{name} with steps of {step}"), run, &log);
            }
        }
    }
}

/// Asserts that the run ended where this constraint depends on the others, with a component of its state near a value.
#[track_caller]
fn assert_drop<S: StateVector>(
    case: &str,
    run: &Run<S>,
    constraint: usize,
    at: (usize, f64),
    bound: f64,
) {
    let found = run.outcome;
    let is_drop =
        matches!(found, Outcome::SingularConstraint { constraint: c, .. } if c == constraint);
    assert!(is_drop, "{case}: {found:?} at t = {}", run.t);
    let off = run.state.as_slice()[at.0] - at.1;
    assert!(off.abs() <= bound, "{case}: off by {off:e}");
}

#[test]
fn a_drop_is_found_between_the_ends_of_steps() {
    let system = CROSSED.model();
    for v in [1.0, 0.3, 7.0] {
        let start = Start::new(&system, &[0.0, -1.0, 0.0], &[0.0, v, 0.0], 4.0);
        let judge = |case: &str, run: Run<_>, _: &Log| {
            assert_drop(case, &run, 1, (1, 0.0), 1e-12);
            assert!((run.t - 1.0 / v).abs() < 1e-11, "{case}: {}", run.t);
        };
        start.every(judge);
        start.discrete(judge);
    }
}

#[test]
fn a_drop_next_to_the_start_is_found() {
    for y in [-1e-3, -1e-8, -1e-15] {
        let system = CROSSED.model();
        Start::new(&system, &[0.0, y, 0.0], &[0.0, 1.0, 0.0], 2.0).every(|case, run, _| {
            assert_drop(case, &run, 1, (1, 0.0), 1e-12);
        });
    }
}

#[test]
fn a_drop_of_even_order_is_found() {
    Start::new(&TOUCHED.model(), &[0.0, -1.0, 0.0], &[0.0, 1.0, 0.0], 2.0).every(|case, run, _| {
        // Nearer than this the forms are dependent up to rounding errors: `y^2 < 4 * 2^-52`.
        assert_drop(case, &run, 1, (1, 0.0), 3e-8);
    });
}

#[test]
fn drops_beside_each_other_are_found() {
    for apart in [0.3, 1e-2, 1e-3] {
        let system = TWICE.with([("apart", apart)]);
        Start::new(&system, &[0.0, -1.0, 0.0], &[0.0, 1.0, 0.0], 3.0).every(|case, run, _| {
            assert_drop(case, &run, 1, (1, 0.0), 1e-12);
        });
    }
}

#[test]
fn a_drop_at_the_tip_of_a_needle_is_found() {
    for s in [0.1, 1e-2, 1e-3] {
        let system = NEEDLE.with([("s", s)]);
        let start = Start::new(&system, &[0.0, -0.7, 0.0], &[0.0, 1.0, 0.0], 2.0);
        start.every(|case, run, _| assert_drop(case, &run, 1, (1, 0.0), 3e-8 * s + 1e-15));
        let system = NEEDLE.with([("s", s), ("left", 1e-4)]);
        let start = Start::new(&system, &[0.0, -0.7, 0.0], &[0.0, 1.0, 0.0], 2.0);
        start.every(|case, run, _| assert_eq!(run.outcome, Outcome::Done, "{case}"));
    }
}

#[test]
fn a_drop_by_an_angle_is_found() {
    let system = UPRIGHT.model();
    let start = Start::new(&system, &[0.1, 0.4, 0.0, 0.2], &[0.2, 0.5, 0.0, 0.9], 3.0);
    start.every(|case, run, _| assert_drop(case, &run, 1, (3, FRAC_PI_2), 1e-9));
}

#[test]
fn a_drop_at_a_time_is_found() {
    let system = TIMED.model();
    let start = Start::new(&system, &[0.0; 3], &[0.0, 1.0, 0.0], 4.0);
    start.every(|case, run, _| {
        assert_drop(case, &run, 1, (0, 0.0), 1e-9);
        assert!((run.t - 1.0).abs() < 1e-12, "{case}: {}", run.t);
    });
}

#[test]
fn a_form_that_vanishes_is_told_from_one_that_turns_fast() {
    let system = CENTRED.model();
    let start = |miss: f64| {
        Start::new(
            &system,
            &[-0.6, -0.8 + miss, 0.0, 0.0],
            &[0.6, 0.8, 0.0, 0.0],
            2.0,
        )
    };
    start(0.0).every(|case, run, _| assert_drop(case, &run, 0, (0, 0.0), 1e-9));
    for miss in [1e-3, 1e-7, 1e-11] {
        start(miss)
            .every(|case, run, _| assert_eq!(run.outcome, Outcome::Done, "{case}, {miss:e}"));
    }
}

#[test]
fn forms_that_are_small_or_turn_are_no_drop() {
    for delta in [1.0, 1e-3, 1e-6, 1e-9] {
        let (x, y) = (0.7, -0.4);
        let system = NEARLY_DEPENDENT.with([("delta", delta)]);
        let qdot = [0.3, 0.9, y * 0.3, x * 0.9];
        Start::new(&system, &[x, y, 0.2, 0.1], &qdot, 2.0).every(|case, run, _| {
            // If the forms nearly coincide, the equations of the longest steps of the Gauss methods cannot be solved.
            let is_unsolved = matches!(run.outcome, Outcome::NotConverged { .. });
            assert!(
                run.outcome == Outcome::Done || is_unsolved && case.starts_with("gauss"),
                "{case}, {delta:e}: {:?}",
                run.outcome
            );
        });
    }
    Start::new(&RING.model(), &[1.0, 0.0], &[0.0, 1.0], 20.0)
        .every(|case, run, _| assert_eq!(run.outcome, Outcome::Done, "{case}"));
}

#[test]
fn what_comes_first_ends_the_step() {
    // A wall before the drop reverses the motion.
    let system = CROSSED.with([("wall", -1e-6)]);
    Start::new(&system, &[0.0, -1.0, 0.0], &[0.0, 1.0, 0.0], 3.0).every(|case, run, log| {
        assert_eq!(run.outcome, Outcome::Done, "{case}");
        assert_eq!(log.iter().count(), 1, "{case}");
    });
    // The drop comes before the wall.
    let system = CROSSED.with([("wall", 1e-6)]);
    Start::new(&system, &[0.0, -1.0, 0.0], &[0.0, 1.0, 0.0], 3.0).every(|case, run, log| {
        assert_drop(case, &run, 1, (1, 0.0), 1e-12);
        let none: Vec<&Event<_>> = log.iter().collect();
        assert!(none.is_empty(), "{case}");
    });
    // An earlier wall sends the motion into the drop.
    let system = CROSSED.with([("wall", 3.0)]);
    Start::new(&system, &[0.0, 1.0, 0.0], &[0.0, 1.0, 0.0], 9.0).every(|case, run, log| {
        assert_drop(case, &run, 1, (1, 0.0), 1e-12);
        assert_eq!(log.iter().count(), 1, "{case}");
    });
}

#[test]
fn a_drop_in_a_mode_is_found() {
    let system = ENTERED.model();
    let (q, qdot) = ([0.0, -1.0, 0.0], [0.0, 1.0, 0.0]);
    Start::new(&system, &q, &qdot, 2.0).every(|case, run, _| {
        assert_drop(case, &run, 1, (1, 0.0), 1e-12);
    });
}

#[test]
fn a_start_where_the_rank_has_dropped_goes_nowhere() {
    let system = CROSSED.model();
    let (q, qdot) = ([0.0; 3], [0.0, 1.0, 0.0]);
    assert!(
        system
            .state_projected(0.0, &vector(&q), &vector(&qdot))
            .is_err()
    );
    let state = system
        .state_unchecked(0.0, &vector(&q), &vector(&qdot))
        .expect("a state");
    let start = Start {
        system: &system,
        state,
        until: 1.0,
    };
    start.every(|case, run, _| {
        assert_drop(case, &run, 1, (1, 0.0), 0.0);
        assert_eq!(run.counters.accepted, 0, "{case}");
    });
}

#[test]
fn no_shipped_model_is_watched() {
    // The shipped models that `every_system` leaves out.
    let texts = dalembert_command::TEXTS.iter();
    let is_left_out = |text: &&Text| {
        let description = text.description();
        description.is_first_order || !description.modes.is_empty()
    };
    let others = texts.map(|(name, _)| shipped(name)).filter(is_left_out);
    let others: Vec<Large> = others.map(Text::sized).collect();
    assert!(others.len() >= 10);
    let systems = || every_system().iter().chain(&others);
    let watched = systems().filter(|system| system.can_lose_rank());
    let names: Vec<&str> = watched.map(|system| system.description().name).collect();
    assert!(systems().count() > 30);
    // The forms of this system are dependent where `(2 + x^2) (1 + y^2) - y sin(theta)` vanishes, which is nowhere.
    assert_eq!(names, ["mixed_disk"]);
}
