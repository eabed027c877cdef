//! Starts on the surface of a transition without a rate, and switches that accumulate.

use dalembert::{Outcome, StateVector, System};
use dalembert_cli::Integrator;
use dalembert_cli::suite::Setting;
use dalembert_stability::course::{Course, state};
use dalembert_stability::text::Text;

/// A mode that is valid for `x >= 0`, one that is valid for `x <= 0`, and a count of the transitions. `$motion` is that of both.
macro_rules! sides {
    ($motion:literal) => {
        Text::new(concat!(
            "Sides { coordinates { x; n; } modes { right { ",
            $motion,
            " } left { ",
            $motion,
            " } } transitions { go: right -> left when x <= 0 => reset { n = n + 1; }; ",
            "back: left -> right when x >= 0 => reset { n = n + 1; }; } }"
        ))
    };
}

/// A motion that switches at the distances `a`, each set to a multiple of itself.
macro_rules! switched {
    ($first:literal, $second:literal) => {
        Text::new(concat!(
            "Switched { coordinates { x; a; } modes { fall { field { dot(x) = -1; dot(a) = 0; } } ",
            "rise { field { dot(x) = 1; dot(a) = 0; } } } transitions { ",
            "f: fall -> rise when x <= 0 => reset { x = -a; a = ",
            $first,
            "*a; }; g: rise -> fall when x >= 0 => reset { x = a; a = ",
            $second,
            "*a; }; } }"
        ))
    };
}

/// Motions that begin at `x = 0` with rate 0 and go to the left, with their time and their number of transitions.
static LEAVING: [(Text, f64, f64); 4] = [
    // x = -t^2/2
    (
        sides!("lagrangian = (dot(x)^2 + dot(n)^2)/2 - x;"),
        2.0,
        1.0,
    ),
    // x = -t^2
    (sides!("field { dot(x) = -2*t; dot(n) = 0; }"), 2.0, 1.0),
    // x = -t^3 + t^4
    (
        sides!("field { dot(x) = -3*t^2 + 4*t^3; dot(n) = 0; }"),
        0.9,
        1.0,
    ),
    (
        sides!("field { dot(x) = -3*t^2 + 4*t^3; dot(n) = 0; }"),
        2.0,
        2.0,
    ),
];

#[test]
fn a_motion_that_leaves_a_surface_without_a_rate_changes_the_mode() {
    for (index, (text, until, right)) in LEAVING.iter().enumerate() {
        let model = text.model();
        let start = state(&model, &[0.0, 0.0], &[0.0, 0.0]);
        for integrator in [Integrator::Taylor, Integrator::Dop853, Integrator::Gauss6] {
            let run = Course::from_state(&model, start, *until).observed(integrator, &mut ());
            let case = format!("{index}, {}", integrator.name());
            assert_eq!(run.outcome, Outcome::Done, "{case}");
            let n = model.position(&run.state).as_slice()[1];
            assert_eq!(n, *right, "{case}");
        }
    }
}

/// A mode that is entered on a floor, with what is done where it is entered. The floor sets the motion back.
macro_rules! entered {
    ($law:literal) => {
        Text::new(concat!(
            "Entered { coordinates { x; y; } modes { a { field { dot(x) = 1; dot(y) = 0; } } ",
            "b { field { dot(x) = 1; dot(y) = -1; } impacts { floor: y >= 0 => reset { y = 1/2; }; } } } ",
            "transitions { f: a -> b when x >= 0",
            $law,
            "; } }"
        ))
    };
}

static ENTERED: [(Text, f64); 3] = [
    (entered!(" => reset { y = 0; }"), 5.0),
    (entered!(" => reset { y = 1e-18; }"), 5.0),
    (entered!(""), 0.0),
];

#[test]
fn a_mode_that_is_entered_on_a_floor_begins_with_its_reset() {
    for (index, (text, y)) in ENTERED.iter().enumerate() {
        let model = text.model();
        let start = state(&model, &[-1.0, *y], &[0.0, 0.0]);
        for integrator in [Integrator::Taylor, Integrator::Dop853, Integrator::Gauss6] {
            let run = Course::from_state(&model, start, 2.75).observed(integrator, &mut ());
            let case = format!("{index}, {}", integrator.name());
            assert_eq!(run.outcome, Outcome::Done, "{case}");
            // Transition and floor at 1, then the floor every half.
            assert_eq!(run.counters.impacts, 5, "{case}");
            let y = model.position(&run.state).as_slice()[1];
            assert!((y - 0.25).abs() < 1e-13, "{case}: {y}");
        }
    }
}

/// A reset and a transition at one time.
macro_rules! at_one_time {
    ($x:literal) => {
        Text::new(concat!(
            "Both { coordinates { x; y; } modes { a { field { dot(x) = -1; dot(y) = 1; } ",
            "impacts { s: x >= 0 => reset { x = ",
            $x,
            "; }; } } b { field { dot(x) = 1; dot(y) = 1; } } } transitions { f: a -> b when y >= 1; } }"
        ))
    };
}

/// The order matters only if the reset leads away from `x = 0`.
static AT_ONE_TIME: [(Text, bool); 2] = [(at_one_time!("1/2"), true), (at_one_time!("0"), false)];

#[test]
fn a_reset_and_a_transition_at_one_time_are_ambiguous_if_their_order_matters() {
    for (text, is_ambiguous) in &AT_ONE_TIME {
        let model = text.model();
        let start = state(&model, &[1.0, 0.0], &[0.0, 0.0]);
        for integrator in [Integrator::Taylor, Integrator::Dop853] {
            let end = Course::from_state(&model, start, 1.5).run(Setting::free(integrator));
            let found = matches!(end.outcome, Outcome::Ambiguous { .. });
            assert_eq!(found, *is_ambiguous, "{:?}", end.outcome);
        }
    }
}

/// Motions that switch at ever shorter distances, with the times at which these accumulate.
static SWITCHED: [(Text, &[f64], f64); 3] = [
    (switched!("0.5", "0.5"), &[1.0, 0.5], 2.0),
    (switched!("0.1", "1.1"), &[1.0, 1.0], 1.0 + 1.1 / 0.89),
    // Each way leads to the next one, in the other mode or by a reset.
    (
        Text::new(
            "Mixed { coordinates { x; y; l; } modes { a { field { dot(x) = -1; dot(y) = -1; dot(l) = 0; } }
            b { field { dot(x) = -1; dot(y) = -1; dot(l) = 0; } impacts { s: y >= 0 => reset { y = 5; x = l; l = l/2; }; } } }
            transitions { f: a -> b when x <= 0 => reset { x = 5; y = l; l = l/2; };
            g: b -> a when x <= 0 => reset { x = l; y = 5; l = l/2; }; } }",
        ),
        &[1.0, 5.0, 1.0],
        3.0,
    ),
];

#[test]
fn switches_that_accumulate_do_not_trap_the_motion() {
    for (text, q, right) in &SWITCHED {
        let model = text.model();
        let start = state(&model, q, &[0.0; 3][..q.len()]);
        for integrator in [Integrator::Taylor, Integrator::Dop853, Integrator::Gauss6] {
            let end = Course::from_state(&model, start, 5.0).run(Setting::free(integrator));
            let case = format!(
                "{right}, {}: {:?} at {}",
                integrator.name(),
                end.outcome,
                end.t
            );
            assert!(matches!(end.outcome, Outcome::Zeno { .. }), "{case}");
            assert!((end.t - right).abs() < 1e-13, "{case}");
        }
    }
}
