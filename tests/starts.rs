//! Starts that a declaration leaves open: the report of `check`, and completion of positions by the constraints;
//! motions that continue with other parameters.

use dalembert::{Instance, Keep, Outcome, ParameterError, StateError, StateVector, System};
use dalembert_cli::{Exit, Integrator};
use dalembert_stability::course::{Course, Random, state, vector};
use dalembert_stability::text::{Model, Text};
use dalembert_tests::command::{self, Finished};

/// A wall that keeps `x` above 1. The start is not declared and is 0.
static BEHIND: Text = Text::new(
    "Behind {
        coordinates { x; y; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2;
        impacts { wall: x >= 1; }
    }",
);

/// The same wall, which counts only for `y > 1` and so not at the start.
static BESIDE: Text = Text::new(
    "Beside {
        coordinates { x; y; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2;
        impacts { wall: x >= 1 when y > 1; }
    }",
);

fn checked(model: &str) -> Finished {
    let models = [BEHIND.entry(), BESIDE.entry()];
    command::run(models.to_vec(), &["check", model], "")
}

#[test]
fn a_start_behind_a_wall_is_not_admissible() {
    let Finished { exit, output, .. } = checked("behind");
    assert_eq!(exit, Exit::Other, "{output}");
    let expected = "it lies behind the surface `wall`: its gap is -1";
    assert!(output.contains(expected), "{output}");
}

#[test]
fn a_start_beside_a_wall_is_admissible() {
    let Finished { exit, output, .. } = checked("beside");
    assert_eq!(exit, Exit::Reached, "{output}");
}

/// A pendulum in Cartesian coordinates, whose initial `x` follows from `y`.
static ROD: Text = Text::new(
    "Rod {
        coordinates { x; y; }
        parameters { l > 0 = 1; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2 - y;
        constraints { rod: x^2 + y^2 = l^2; }
        initial { y = -4/5; dot(y) = 3; }
    }",
);

/// Two links and a coupler between two fixed points at the distance 2. The loop closes in two ways.
static FOUR_BAR: Text = Text::new(
    "FourBar {
        coordinates { a: angle; b: angle; c: angle; }
        lagrangian = (dot(a)^2 + dot(b)^2 + dot(c)^2)/2 - sin(a)/4;
        constraints {
            across: cos(a) + 2*cos(b) - 3/2*cos(c) = 2;
            up: sin(a) + 2*sin(b) - 3/2*sin(c) = 0;
        }
        initial { a = 1; dot(a) = 1/2; }
    }",
);

/// A free particle with a transition at `x = 0` to motion on a ring of radius 1.
static CAUGHT: Text = Text::new(
    "Caught {
        modes {
            free {
                coordinates { x; y; }
                lagrangian = (dot(x)^2 + dot(y)^2)/2;
                initial { x = -1; y = y0; dot(x) = 1; until = 3; }
            }
            ring {
                coordinates { x; y; }
                lagrangian = (dot(x)^2 + dot(y)^2)/2;
                constraints { ring: x^2 + y^2 = 1; }
            }
        }
        parameters { y0 = 1; }
        transitions { caught: free -> ring when x >= 0; }
    }",
);

/// Positions at the completed declared start and at the end of the run, and its outcome.
fn start(system: &Model, end: f64) -> ([Vec<f64>; 2], Outcome) {
    let course = Course::declared(system, end).tol(1e-6);
    let start = *course.start();
    let run = course.observed(Integrator::Dop853, &mut ());
    let places = [start, run.state].map(|state| system.position(&state).as_ref().to_vec());
    (places, run.outcome)
}

#[test]
fn equations_of_positions_are_solved_and_kept() {
    for l in [1.0, 1.25, 7.0] {
        let rod = ROD.with([("l", l)]);
        let ([begin, end], outcome) = start(&rod, 200.0);
        assert_eq!(outcome, Outcome::Done);
        assert_eq!(begin[1], -0.8);
        assert!(begin[0] > 0.0, "of two places the one to the right");
        for q in [begin, end] {
            assert!(
                (q[0].hypot(q[1]) - l).abs() < 1e-12,
                "{q:?} for a rod of {l}"
            );
        }
    }
    let bars = FOUR_BAR.model();
    let ([begin, end], outcome) = start(&bars, 200.0);
    assert_eq!(outcome, Outcome::Done);
    for q in [&begin, &end] {
        let across = q[0].cos() + 2.0 * q[1].cos() - 1.5 * q[2].cos();
        let up = q[0].sin() + 2.0 * q[1].sin() - 1.5 * q[2].sin();
        assert!((across - 2.0).abs() < 1e-12 && up.abs() < 1e-12, "{q:?}");
    }
    assert_eq!(begin[0], 1.0);
}

#[test]
fn places_off_the_equations_are_refused() {
    let rod = ROD.with([("l", 0.5)]);
    let start = rod.initial();
    let refused = Err(StateError::OffPosition {
        constraint: 0,
        residual: 0.8 * 0.8 - 0.25,
        scale: 0.8 * 0.8 + 0.25,
    });
    assert_eq!(rod.complete_position(0.0, &start.q, &start.placed), refused);
    let refused = rod.state(0.0, &vector(&[0.5, 1e-3]), &vector(&[0.0, 0.0]));
    assert!(
        matches!(refused, Err(StateError::OffPosition { constraint: 0, .. })),
        "{refused:?}"
    );
    let near = rod.state_projected(0.0, &vector(&[0.5, 1e-3]), &vector(&[1.0, 1.0]));
    let q = rod.position(&near.expect("a state"));
    let q = q.as_ref();
    assert!((q[0].hypot(q[1]) - 0.5).abs() < 1e-15 && (q[1] - 1e-3).abs() < 1e-6);
}

#[test]
fn a_mode_is_not_entered_off_its_equations() {
    let caught = CAUGHT.model();
    assert_eq!(start(&caught, 3.0).1, Outcome::Done);
    let beside = CAUGHT.with([("y0", 0.5)]);
    let expected = Outcome::ResetOffConstraint {
        surface: 0,
        constraint: 0,
    };
    assert_eq!(start(&beside, 3.0).1, expected);
}

#[test]
fn the_command_line_solves_for_positions_or_refuses_them() {
    let run = |line: &str| command::line(vec![ROD.entry()], line, "");
    let Finished { exit, output, .. } = run("check rod");
    assert_eq!(exit, Exit::Reached, "{output}");
    let Finished { output, .. } = run("simulate rod --until 0.1 --csv - --initial y=0.6");
    assert!(output.contains("\n0.0,0.8,0.6,"), "{output}");
    let off = "simulate rod --until 1 --initial x=0.8,y=-0.8";
    let Finished { exit, errors, .. } = run(off);
    assert_ne!(exit, Exit::Reached);
    let expected = "--initial: the positions violate the constraint `rod`: its sides differ by 2.8";
    assert!(errors.contains(expected), "{errors}");
    let Finished { exit, errors, .. } = run(&format!("{off} --off-constraint project"));
    assert_eq!(exit, Exit::Reached, "{errors}");
    let Finished { exit, errors, .. } = run(&format!("{off} --off-constraint keep"));
    assert_eq!(exit, Exit::Reached, "{errors}");
    let given = "simulate rod --until 1 --q 0.8,-0.8 --qdot 1,1";
    let Finished { errors, .. } = run(given);
    assert!(errors.contains("the positions violate"), "{errors}");
}

/// A skate with its blade off its centre of mass, in the state (q, u).
static SKATE: Text = Text::new(
    "Skate {
        coordinates { x; y; theta: angle; }
        parameters { m > 0 = 1; J > 0 = 1; a = 1/2; }
        let c = sin(theta)*dot(x) - cos(theta)*dot(y);
        lagrangian = m/2*(dot(x)^2 + dot(y)^2) + J/2*dot(theta)^2;
        constraints { blade: c = a*dot(theta); }
    }",
);

/// A mass that takes up a load at x = 1.
static LOADED: Text = Text::new(
    "Loaded {
        coordinates { x; }
        parameters { m > 0 = 1; load > 0 = 3; }
        modes {
            free { lagrangian = m/2*dot(x)^2; initial { dot(x) = 2; until = 3; } }
            both { lagrangian = (m + load)/2*dot(x)^2; }
        }
        transitions { taken: free -> both when x >= 1 => reset { dot(x) = dot(x); }; }
    }",
);

#[test]
fn what_stays_is_said_where_parameters_change() {
    let light = SKATE.model();
    let heavy = SKATE.with([("m", 4.0), ("J", 2.0), ("a", 0.5)]);
    let (u, w, a) = (2.0, 1.0, 0.5);
    let (sin, cos) = 0.3_f64.sin_cos();
    let qdot = [u * cos + a * w * sin, u * sin - a * w * cos, w];
    let state = state(&light, &[0.0, 0.0, 0.3], &qdot);
    let as_fast = heavy
        .carried(&light, 0.0, &state, Keep::Velocities)
        .expect("a state");
    let velocity = heavy.velocity(0.0, &as_fast).expect("a state");
    let pairs = velocity.as_ref().iter().zip(qdot);
    assert!(
        pairs
            .into_iter()
            .all(|(found, given)| (found - given).abs() < 1e-15)
    );
    let as_heavy = heavy
        .carried(&light, 0.0, &state, Keep::Momenta)
        .expect("a state");
    // The momentum along the blade is kept. The mass is four times as large, so the speed is a quarter.
    let slower = heavy.velocity(0.0, &as_heavy).expect("a state");
    let slower = slower.as_ref();
    let along = slower[0] * 0.3_f64.cos() + slower[1] * 0.3_f64.sin();
    assert!((along - 0.5).abs() < 1e-15, "{along}");
    let turned = SKATE.with([("a", 0.25)]);
    let refused = turned.carried(&light, 0.0, &state, Keep::Velocities);
    assert!(
        matches!(
            refused,
            Err(StateError::OffConstraint { constraint: 0, .. })
        ),
        "{refused:?}"
    );
    let hollow = SKATE.with([("m", -1.0)]);
    let refused = hollow.carried(&light, 0.0, &state, Keep::Momenta);
    assert!(
        matches!(
            refused,
            Err(StateError::Parameter(ParameterError { name: "m", .. }))
        ),
        "{refused:?}"
    );
}

#[test]
fn a_motion_is_carried_on_in_the_mode_that_it_is_in() {
    let system = LOADED.model();
    let run = Course::new(&system, &[0.0], &[2.0], 3.0)
        .tol(1e-9)
        .observed(Integrator::Dop853, &mut ());
    let both = 1;
    assert_eq!(system.mode(&run.state), both);
    let heavier = LOADED.with([("load", 7.0)]);
    let carried = heavier
        .carried(&system, 3.0, &run.state, Keep::Momenta)
        .expect("a state");
    assert_eq!(heavier.mode(&carried), both);
    let velocity = heavier.velocity(3.0, &carried).expect("a state");
    assert_eq!(velocity.as_ref()[0], 1.0);
}

/// A blade along `y`, where `cos(theta)` is the rounding of 0: no sideways velocity is the rounding of an infinite one.
#[test]
fn a_velocity_is_not_divided_by_the_rounding_of_zero() {
    static BLADE: Text = Text::new(
        "Blade {
            coordinates { x; y; theta: angle; }
            lagrangian = (dot(x)^2 + dot(y)^2 + dot(theta)^2)/2;
            constraints { edge: sin(theta)*d(x) - cos(theta)*d(y) = 0; }
        }",
    );
    let blade = BLADE.model();
    let quarter = core::f64::consts::FRAC_PI_2;
    let completed = |given: [f64; 3], named: [f64; 3]| {
        let q = vector(&[0.0, 0.0, quarter]);
        blade.complete_velocity(0.0, &q, &vector(&given), &vector(&named))
    };
    let sideways = completed([1.0, 0.0, 0.0], [1.0, 0.0, 0.0]);
    assert!(
        matches!(sideways, Err(StateError::OffConstraint { .. })),
        "{sideways:?}"
    );
    let along = completed([0.0, 1.0, 0.0], [0.0, 1.0, 0.0]).expect("a velocity");
    let [x, y] = [0, 1].map(|i| along.as_slice()[i]);
    assert!(x.abs() < 1e-15 && y == 1.0, "{along:?}");
}

/// A point at the distance `s` from a wall, which it reaches at the time 1.
static NEAR: Text = Text::new(
    "Near {
        coordinates { x; }
        parameters { s > 0 = 1; }
        lagrangian = dot(x)^2/2;
        impacts { wall: x >= 0 => stop; }
        initial { x = s; dot(x) = -s; }
    }",
);

/// A motion that is set back by the distance `s` whenever it has covered it, at the times 1, 2 and 3.
static SET_BACK: Text = Text::new(
    "SetBack {
        coordinates { x; }
        parameters { s > 0 = 1; }
        field { dot(x) = -s; }
        impacts { end: x >= 0 => reset { x = s; }; }
        initial { x = s; }
    }",
);

#[test]
fn a_start_at_any_distance_from_a_wall_is_not_on_it() {
    for s in [1e-200, 1e-30, 1e-16, 5e-15, 1e-9, 1.0] {
        for &integrator in Integrator::every() {
            let name = integrator.name();
            let near = NEAR.with([("s", s)]);
            let run = Course::declared(&near, 3.0)
                .step(0.01)
                .observed(integrator, &mut ());
            let stopped = matches!(run.outcome, Outcome::StoppedAt { .. });
            assert!(stopped, "{name}, {s:e}: {:?}", run.outcome);
            assert!((run.t - 1.0).abs() < 1e-14, "{name}, {s:e}: {}", run.t);
            // Discrete Lagrangians have no first order.
            if name.starts_with("dla") {
                continue;
            }
            let set_back = SET_BACK.with([("s", s)]);
            let run = Course::declared(&set_back, 3.5)
                .step(0.01)
                .observed(integrator, &mut ());
            assert_eq!(run.outcome, Outcome::Done, "{name}, {s:e}");
            assert_eq!(run.counters.impacts, 3, "{name}, {s:e}");
            let end = run.state.as_slice()[0];
            assert!((end / s - 0.5).abs() < 1e-12, "{name}, {s:e}: {end:e}");
        }
    }
}

/// Two bodies that touch and move together.
static TOGETHER: Text = Text::new(
    "Together {
        coordinates { a; b; }
        parameters { m > 0 = 1; n > 0 = 1; v = 1; }
        lagrangian = m*dot(a)^2/2 + n*dot(b)^2/2;
        impacts { s: b >= a => stop; }
        initial { dot(a) = v; dot(b) = v; }
    }",
);

#[test]
fn bodies_of_equal_velocity_do_not_collide() {
    let mut random = Random::new(71);
    for _ in 0..60 {
        let [m, n, v] = [(); 3].map(|()| random.between(0.1, 10.0));
        let together = TOGETHER.with([("m", m), ("n", n), ("v", v)]);
        // Methods that solve equations in each step leave errors above rounding.
        let explicit = [Integrator::Taylor, Integrator::Dop853, Integrator::Dopri5];
        for integrator in explicit {
            let course = Course::declared(&together, 5.0).step(0.1);
            let run = course.observed(integrator, &mut ());
            let case = format!("{}: {m}, {n}, {v}", integrator.name());
            assert_eq!(run.outcome, Outcome::Done, "{case}");
        }
    }
}
