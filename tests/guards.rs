//! Conditions that hold in a small part of a step, and edges of charts that the motion crosses for a moment. Every
//! integrator finds them and their beginnings.

use dalembert::Outcome;
use dalembert_cli::Integrator;
use dalembert_stability::course::{Course, is_discrete, state};
use dalembert_stability::text::{Model, Text};

/// The first wall counts only in a window of time.
static WINDOW: Text = Text::new(
    "Window {
        coordinates { x; }
        parameters { width > 0 = 1e-4; far = 3; }
        lagrangian = dot(x)^2/2;
        impacts { wall: 1 - x >= 0 when t >= 2 when t <= 2 + width; end: far - x >= 0; }
    }",
);

/// The first wall counts above the height `2 - top`, near the top of the flight of a thrown body.
static LEDGE: Text = Text::new(
    "Ledge {
        coordinates { x; y; }
        parameters { top = 1e-8; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2 - y;
        impacts { wall: 1 - x >= 0 when y - 2 + top > 0; end: 5 - x >= 0; }
    }",
);

/// A wall whose condition holds near `x = 2` and is not a polynomial.
static PEAK: Text = Text::new(
    "Peak {
        coordinates { x; }
        parameters { s > 0 = 1e-3; }
        lagrangian = dot(x)^2/2;
        impacts { wall: 1 - x >= 0 when exp(-((x - 2)/s)^2) > 1/2; }
    }",
);

/// A gap that is negative for `1 < x < 2`, with a condition that holds for a moment in between.
static DIP: Text = Text::new(
    "Dip {
        coordinates { x; y; }
        parameters { late = 0; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2;
        impacts { wall: (x - 1)*(x - 2) >= 0 when x + late > 1.5 when x + late < 1.5001; }
    }",
);

/// A transition that counts only above the height `2 - top`.
static GATE: Text = Text::new(
    "Gate {
        coordinates { x; y; }
        parameters { top = 1e-8; }
        modes {
            outside { lagrangian = (dot(x)^2 + dot(y)^2)/2 - y; initial { until = 4; } }
            inside { lagrangian = dot(x)^2 + dot(y)^2; }
        }
        transitions {
            enter: outside -> inside when x >= 1 when y - 2 + top > 0;
            leave: inside -> outside when x <= 1;
        }
    }",
);

/// A chart with an edge at the top of the flight of a thrown body.
static ATTIC: Text = Text::new(
    "Attic {
        coordinates { x; y in (-10, 2); }
        parameters { wall = 10; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2 - y;
        impacts { end: wall - x >= 0; }
    }",
);

/// The chart of [`ATTIC`] without surfaces.
static OPEN_ATTIC: Text = Text::new(
    "OpenAttic {
        coordinates { x; y in (-10, 2); }
        lagrangian = (dot(x)^2 + dot(y)^2)/2 - y;
    }",
);

/// Long step of the integrators with a fixed step.
const STEP: f64 = 0.73;

/// Passes the ends of runs by every integrator at several tolerances to `check`.
fn ends(
    system: &Model,
    (q, qdot): (&[f64], &[f64]),
    until: f64,
    mut check: impl FnMut(&str, f64, Outcome),
) {
    let has_modes = !system.form().tables.modes.is_empty();
    for &integrator in Integrator::every() {
        if has_modes && is_discrete(integrator) {
            continue;
        }
        for tolerance in [1e-3, 1e-8, 1e-13] {
            let mut course =
                Course::from_state(system, state(system, q, qdot), until).tol(tolerance);
            if !integrator.is_adaptive() {
                course = course.step(STEP);
            }
            let run = course.observed(integrator, &mut ());
            let case = format!("{} {tolerance:e}", integrator.name());
            check(&case, run.t, run.outcome);
        }
    }
}

/// Checks that every run ends behind the first surface at this time.
fn assert_begins_behind(system: &Model, start: (&[f64], &[f64]), time: f64, error: f64) {
    ends(system, start, 6.0, |case, t, outcome| {
        let is_right = matches!(outcome, Outcome::BeginsBehind { surface: 0, gap } if gap < 0.0);
        assert!(
            is_right && (t - time).abs() <= error,
            "{case}: {outcome:?} at {t}, not {time}"
        );
    });
}

fn assert_done(system: &Model, start: (&[f64], &[f64]), until: f64) {
    ends(system, start, until, |case, t, outcome| {
        assert_eq!(outcome, Outcome::Done, "{case}: at {t}");
    });
}

#[test]
fn a_window_of_time_is_not_stepped_over() {
    for width in [1e-2, 1e-4, 1e-9] {
        let window = WINDOW.with([("width", width)]);
        assert_begins_behind(&window, (&[0.5], &[1.0]), 2.0, 4e-15);
        // In the window the point is still before the wall.
        assert_done(&window, (&[-1.5], &[1.0]), 2.25);
        assert_done(&window, (&[0.5], &[0.1]), 6.0);
    }
}

#[test]
fn an_impact_in_the_same_step_hides_no_window() {
    // The impact comes after the window, in the same step.
    let window = WINDOW.with([("far", 2.6)]);
    assert_begins_behind(&window, (&[0.5], &[1.0]), 2.0, 4e-15);
    let window = WINDOW.with([("far", 1.85)]);
    // The impact comes before the window, in which the point is at 1.2.
    assert_begins_behind(&window, (&[0.5], &[1.0]), 2.0, 4e-15);
    let window = WINDOW.with([("far", 1.2)]);
    assert_done(&window, (&[0.5], &[1.0]), 6.0);
}

#[test]
fn a_condition_that_holds_at_the_top_of_a_flight_is_found_where_it_begins() {
    for top in [1e-2_f64, 1e-6, 1e-10] {
        // The height is `2 - (t - 2)^2/2`.
        let begins = 2.0 - (2.0 * top).sqrt();
        let error = 1e-14 / top.sqrt();
        let start: (&[f64], &[f64]) = (&[0.0, 0.0], &[1.0, 2.0]);
        assert_begins_behind(&LEDGE.with([("top", top)]), start, begins, error);
        assert_begins_behind(&GATE.with([("top", top)]), start, begins, error);
        assert_done(&LEDGE.with([("top", -top)]), start, 4.0);
        assert_done(&GATE.with([("top", -top)]), start, 4.0);
    }
}

#[test]
fn conditions_of_no_finite_degree_are_enclosed() {
    for s in [0.3_f64, 1e-2, 1e-4, 1e-6] {
        let begins = 2.0 - s * 2.0_f64.ln().sqrt();
        assert_begins_behind(&PEAK.with([("s", s)]), (&[0.0], &[1.0]), begins, 1e-14);
    }
}

#[test]
fn a_gap_that_is_negative_inside_a_step_meets_its_condition_there() {
    assert_begins_behind(&DIP.model(), (&[0.0, 0.0], &[1.0, 0.0]), 1.5, 1e-14);
    assert_done(&DIP.with([("late", -1.0)]), (&[0.0, 0.0], &[1.0, 0.0]), 6.0);
}

#[test]
fn motion_along_the_edge_of_a_condition_is_not_behind_it() {
    // Along `y = 2` only rounding errors decide the condition.
    let along = Text::new(
        "Along {
            coordinates { x; y; }
            lagrangian = (dot(x)^2 + dot(y)^2)/2;
            impacts { wall: 1 - x >= 0 when y >= 2; }
        }",
    );
    let model = along.model();
    for &integrator in Integrator::every() {
        let start = state(&model, &[2.0, 2.0], &[1.0, 0.0]);
        let course = Course::from_state(&model, start, 1.0).step(0.1);
        let run = course.observed(integrator, &mut ());
        assert_eq!(run.outcome, Outcome::Done, "{integrator:?}");
        assert!(run.counters.event_evaluations < 1000, "{integrator:?}");
    }
}

#[test]
fn a_chart_that_is_left_for_a_moment_ends_there() {
    for top in [1e-2_f64, 1e-6, 1e-10] {
        // Without the edge, the flight reaches the height `2 + top` at the time 2.
        let left = 2.0 - (2.0 * top).sqrt();
        let error = 1e-14 / top.sqrt();
        let (outside, inside) = ([0.0, top], [0.0, -top]);
        for attic in [
            ATTIC.model(),
            OPEN_ATTIC.model(),
            ATTIC.with([("wall", 2.2)]),
        ] {
            let mut kind = |case: &str, t: f64, outcome: Outcome| {
                let is_right = outcome == Outcome::LeftChart { coordinate: 1 };
                assert!(
                    is_right && (t - left).abs() <= error,
                    "{case}: {outcome:?} at {t}, not {left}"
                );
            };
            ends(&attic, (&outside, &[1.0, 2.0]), 4.0, &mut kind);
            assert_done(&attic, (&inside, &[1.0, 2.0]), 4.0);
        }
    }
}

#[test]
fn an_impact_that_turns_the_motion_back_comes_before_the_edge_of_a_chart() {
    // The wall is met at the time 1. The rest of the step is not part of the motion.
    let turned = Text::new(
        "Turned {
            coordinates { y in (-10, 2); }
            lagrangian = dot(y)^2/2;
            impacts { roof: 1 - y >= 0; }
        }",
    );
    assert_done(&turned.model(), (&[0.0], &[1.0]), 4.0);
}
