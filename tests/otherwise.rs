//! Several surfaces with the same gap. Each state with gap 0 belongs to one of them, or the run ends and names one.

use dalembert::{EventLog, Impacting, Instance, Outcome, System, VectorField};
use dalembert_cli::Integrator;
use dalembert_stability::course::{Course, state, vector};
use dalembert_stability::text::{Model, Text, mode};

/// The tent map, without a transition for the height 1/2.
static OPEN_TENT: Text = Text::new(
    "OpenTent {
        coordinates { x; y; }
        field { dot(x) = 1; dot(y) = 0; }
        modes {
            first { initial { y = 1/8; until = 40; } }
            lower { }
            upper { }
        }
        transitions {
            down: first -> lower when x >= 1 when y < 1/2 => reset { x = 0; y = 2*y; };
            up: first -> upper when 2*x >= 2 when y > 1/2 => reset { x = 0; y = 2*(1 - y); };
            from_lower: lower -> first when x >= 1 => reset { x = 0; };
            from_upper: upper -> first when x >= 1 => reset { x = 0; };
        }
    }",
);

/// The tent map, with an `otherwise` transition for all remaining heights.
static CLOSED_TENT: Text = Text::new(
    "ClosedTent {
        coordinates { x; y; }
        field { dot(x) = 1; dot(y) = 0; }
        modes {
            first { initial { y = 1/8; until = 40; } }
            lower { }
            upper { }
        }
        transitions {
            down: first -> lower when x >= 1 when y < 1/2 when y > -3 => reset { x = 0; y = 2*y; };
            up: first -> upper when x >= 1 otherwise => reset { x = 0; y = 2*(1 - y); };
            from_lower: lower -> first when x >= 1 => reset { x = 0; };
            from_upper: upper -> first when x >= 1 => reset { x = 0; };
        }
    }",
);

/// A wall that reflects for `y > 0`, stops the normal motion in a spot, and halves the normal speed elsewhere.
static PATCHED: Text = Text::new(
    "Patched {
        coordinates { x; y; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2;
        impacts {
            soft: x >= 0 when y > 0;
            spot: x >= 0 when y < -1 when y > -2 => totally_plastic;
            hard: x >= 0 otherwise => newton(1/2);
        }
        initial { x = 1; dot(x) = -1; until = 2; }
    }",
);

/// A run to the declared end, with steps of this length if the integrator is of fixed step.
fn run_of(
    system: &Model,
    (integrator, step): (Integrator, f64),
    q: [f64; 2],
    qdot: [f64; 2],
) -> (f64, Outcome, <Model as VectorField>::State) {
    let until = system.initial().until.expect("an end");
    let run = Course::from_state(system, state(system, &q, &qdot), until)
        .tol(1e-10)
        .step(step)
        .observed(integrator, &mut ());
    (run.t, run.outcome, run.state)
}

const DOP853: (Integrator, f64) = (Integrator::Dop853, f64::INFINITY);

#[test]
fn a_state_that_no_transition_takes_ends_the_run() {
    let tent = OPEN_TENT.model();
    // The run names `up`, the last surface of this gap.
    let untaken = Outcome::Untaken { surface: 1 };
    // The heights are 1/8, 1/4 and 1/2. Two modes are passed for each height.
    for stepper in [
        DOP853,
        (Integrator::Taylor, f64::INFINITY),
        (Integrator::Rk4, 0.0625),
    ] {
        let (t, outcome, state) = run_of(&tent, stepper, [0.0, 0.125], [0.0; 2]);
        assert_eq!(outcome, untaken);
        assert!((t - 5.0).abs() < 1e-12, "{t}");
        assert!((state.as_ref()[0] - 1.0).abs() < 1e-12, "{state:?}");
    }
    assert_eq!(untaken.kind(), "untaken");
    // The motion from 2/7 never reaches 1/2.
    let (_, outcome, _) = run_of(&tent, DOP853, [0.0, 2.0 / 7.0], [0.0; 2]);
    assert_eq!(outcome, Outcome::Done);
    // A system made of one mode reports the same outcome.
    let alone = mode(&tent, 0);
    let state = state(&alone, &[0.0, 0.5], &[0.0; 2]);
    let run = Course::from_state(&alone, state, 4.0)
        .tol(1e-10)
        .observed(Integrator::Dop853, &mut ());
    assert!(
        matches!(run.outcome, Outcome::Untaken { .. }),
        "{:?}",
        run.outcome
    );
}

#[test]
fn otherwise_takes_what_is_left() {
    let tent = CLOSED_TENT.model();
    let (_, outcome, last) = run_of(&tent, DOP853, [0.0, 0.125], [0.0; 2]);
    assert_eq!(outcome, Outcome::Done);
    let at = last.as_ref();
    assert!(at[0] <= 1.0 && at[1] == 0.0, "{at:?}");
    // `up` takes heights below -3 as well: 2*(1 + 4) = 10, then 2*(1 - 10) = -18.
    let mut log = EventLog::<_, 8>::new();
    let run = Course::from_state(&tent, state(&tent, &[0.0, -4.0], &[0.0; 2]), 3.5)
        .tol(1e-10)
        .observed(Integrator::Dop853, &mut log);
    assert_eq!(run.outcome, Outcome::Done);
    let up = 1;
    assert_eq!(log.iter().filter(|event| event.surface == up).count(), 2);
    assert_eq!(run.state.as_ref()[1], -18.0);
}

#[test]
fn otherwise_divides_a_wall() {
    let wall = PATCHED.model();
    let cases = [
        (0.5, 1.0),
        (0.0, 0.5),
        (-1.0, 0.5),
        (-1.5, 0.0),
        (-2.0, 0.5),
        (-9.0, 0.5),
    ];
    for (y, speed) in cases {
        let [(_, outcome, state), (_, _, gauss)] = [DOP853, (Integrator::Gauss4, 0.125)]
            .map(|method| run_of(&wall, method, [1.0, y], [-1.0, 0.0]));
        let gauss = gauss.as_ref();
        if speed > 0.0 {
            assert_eq!(outcome, Outcome::Done, "y = {y}");
            assert!((gauss[2] - speed).abs() < 1e-12, "{gauss:?} at y = {y}");
        }
        let velocity = wall.velocity(0.0, &state).expect("a state");
        assert!(
            (velocity.as_ref()[0] - speed).abs() < 1e-12,
            "{velocity:?} at y = {y}"
        );
        let at = wall
            .state_unchecked(0.0, &vector(&[0.0, y]), &vector(&[-1.0, 0.0]))
            .expect("a state");
        let counting = (0..3)
            .filter(|&surface| wall.surface_active(surface, 0.0, &at))
            .count();
        assert_eq!(counting, 1, "y = {y}");
    }
}
