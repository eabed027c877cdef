//! Resets that follow each other: at shrinking intervals, many at one time, and in accumulations.

use dalembert::Outcome;
use dalembert_cli::suite::Setting;
use dalembert_cli::{Exit, Integrator};
use dalembert_stability::course::{Course, state};
use dalembert_stability::text::Text;
use dalembert_tests::command;
use serde_json::Value;

/// Integrators of every kind.
const INTEGRATORS: [Integrator; 4] = [
    Integrator::Taylor,
    Integrator::Dop853,
    Integrator::Dopri5,
    Integrator::Gauss6,
];

/// An oscillator that turns back behind a surface with a reset. The gap falls through 0 once per turn, wherever steps end.
#[test]
fn a_surface_behind_which_the_motion_turns_is_met_once_per_turn() {
    macro_rules! oscillator {
        ($gap:literal) => {
            Text::new(concat!(
                "Oscillator { coordinates { x; } parameters { w = 1; } lagrangian = (dot(x)^2 - w^2*x^2)/2; ",
                "impacts { counter: ",
                $gap,
                " => reset { }; } }"
            ))
        };
    }
    let texts = [
        oscillator!("x <= 0"),
        oscillator!("x + x^3 <= 0"),
        oscillator!("x^3 + 2*x <= 0"),
        oscillator!("sinh(x) <= 0"),
        oscillator!("atan(x) <= 0"),
        oscillator!("x*exp(x) <= 0"),
        oscillator!("x/sqrt(1 + x^2) <= 0"),
    ];
    for (index, text) in texts.iter().enumerate() {
        for (k, speed) in [2.8, 1.0, 0.3].into_iter().enumerate() {
            let w = 1.0 + 0.9 * k as f64;
            let oscillator = text.with([("w", w)]);
            // `x = -cos(w t) + speed/w sin(w t)` rises through 0 where `w t = atan(w/speed)`, and a turn later.
            let turn = core::f64::consts::TAU / w;
            let first = (w / speed).atan() / w;
            for until in (1..40).map(|part| 0.137 * turn * f64::from(part)) {
                let right = ((until - first) / turn).floor() + 1.0;
                let adaptive = Integrator::every().iter().filter(|it| it.is_adaptive());
                for (&integrator, tol) in adaptive.flat_map(|it| [(it, 1e-6), (it, 1e-10)]) {
                    let course = Course::new(&oscillator, &[-1.0], &[speed], until);
                    let run = course.tol(tol).observed(integrator, &mut ());
                    let case = format!("{index}, {w}, {until}, {}, {tol}", integrator.name());
                    assert_eq!(run.outcome, Outcome::Done, "{case}");
                    assert_eq!(run.counters.impacts as f64, right, "{case}");
                }
            }
        }
    }
}

/// A ball whose speed is halved by a reset, as `newton(1/2)` does.
static HALVED: Text = Text::new(
    "Halved {
        coordinates { x; }
        lagrangian = dot(x)^2/2 - x;
        impacts { floor: x >= 0 => reset { dot(x) = -dot(x)/2; }; }
    }",
);

#[test]
fn resets_that_accumulate_end_the_run_there() {
    let halved = HALVED.model();
    for integrator in [Integrator::Taylor, Integrator::Dop853, Integrator::Dopri5] {
        for k in 0..60 {
            let x = 0.2 + 0.05 * f64::from(k);
            let course = Course::new(&halved, &[x], &[0.0], 30.0);
            let end = course.run(Setting::free(integrator));
            let case = format!("{}, {x}: {:?} at {}", integrator.name(), end.outcome, end.t);
            assert!(matches!(end.outcome, Outcome::Zeno { .. }), "{case}");
            // The first fall takes `sqrt(2 x)`, and each flight half of the one before.
            assert!(
                (end.t - 3.0 * (2.0 * x).sqrt()).abs() < 1e-12 * end.t,
                "{case}"
            );
        }
    }
}

/// A motion that is set back by distances that shrink by the factor `r`, from `x = 1/2` and then from 1. The resets accumulate
/// at `1/2 + 1/(1 - r)`.
static SET_BACK: Text = Text::new(
    "SetBack {
        coordinates { x; y; }
        parameters { r in [0, 1] = 1/2; }
        field { dot(x) = -1; dot(y) = 0; }
        impacts { end: x >= 0 => reset { x = y; y = r*y; }; }
    }",
);

#[test]
fn shrinking_ways_to_a_surface_end_the_run() {
    for integrator in [Integrator::Taylor, Integrator::Dop853, Integrator::Dopri5] {
        for r in [0.1, 0.5, 0.7, 0.9] {
            let set_back = SET_BACK.with([("r", r)]);
            let course = Course::from_state(&set_back, state(&set_back, &[0.5, 1.0], &[]), 30.0);
            let end = course.run(Setting::free(integrator));
            let case = format!("{}, {r}: {:?} at {}", integrator.name(), end.outcome, end.t);
            assert!(matches!(end.outcome, Outcome::Zeno { .. }), "{case}");
            assert!((end.t - 0.5 - 1.0 / (1.0 - r)).abs() < 1e-12, "{case}");
        }
    }
}

/// A model whose impacts come at shorter and shorter intervals, set the motion back to where the gap has no rate, or throw it up
/// by less than rounding once. They do not accumulate.
struct Counter {
    text: Text,
    start: [&'static [f64]; 2],
    until: f64,
    impacts: u64,
}

static COUNTERS: [Counter; 9] = [
    Counter {
        text: Text::new(
            "Chirp { coordinates { x; n; } field { dot(x) = 1; dot(n) = 0; }
            impacts { s: sin(x^2) >= 0 => reset { n = n + 1; }; } }",
        ),
        start: [&[0.1, 0.0], &[]],
        until: 8.0,
        impacts: 10,
    },
    Counter {
        text: Text::new(
            "Thin { coordinates { x; n; } field { dot(x) = cos(t); dot(n) = 0; } impacts {
            a: x <= 0.1 => reset { n = n + 1; }; b: x <= 0.644 => reset { n = n + 1; };
            c: x <= 0.913 => reset { n = n + 1; }; s: (1000*(x - 0.9928))^2 >= 1 => reset { n = n + 1; }; } }",
        ),
        start: [&[0.0, 0.0], &[]],
        until: 3.0,
        impacts: 5,
    },
    Counter {
        text: Text::new(
            "Kicked { coordinates { x; n; } lagrangian = (dot(x)^2 + dot(n)^2)/2;
            impacts { s: sin(x^2) >= 0 => reset { dot(n) = dot(n) + 1; }; } }",
        ),
        start: [&[0.1, 0.0], &[1.0, 0.0]],
        until: 8.0,
        impacts: 10,
    },
    Counter {
        text: Text::new(
            "SetToRest { coordinates { x; } field { dot(x) = 1; }
            impacts { s: x^2 <= 1 => reset { x = x - 1; }; } }",
        ),
        start: [&[0.0], &[]],
        until: 7.5,
        impacts: 7,
    },
    Counter {
        text: Text::new(
            "OneTinyHop { coordinates { x; v; a; b; } field { dot(x) = v; dot(v) = -1; dot(a) = 0; dot(b) = 0; }
            impacts { s: x >= 0 => reset { x = 0; v = a; a = b; b = a; }; } }",
        ),
        start: [&[0.5, 0.0, 1.0, 1e-8], &[]],
        until: 10.0,
        impacts: 9,
    },
    Counter {
        text: Text::new(
            "FirstHopIsTiny { coordinates { x; n; } lagrangian = (dot(x)^2 + dot(n)^2)/2 - x;
            impacts { s: x >= 0 => reset { dot(x) = 1e-9 + n; n = n + 1; }; } }",
        ),
        start: [&[0.5, 0.0], &[0.0, 0.0]],
        until: 6.0,
        impacts: 3,
    },
    Counter {
        text: Text::new(
            "TinyHops { coordinates { x; v; n; } field { dot(x) = v; dot(v) = -1; dot(n) = 0; }
            impacts { s: x >= 0 => reset { v = 1e-8 + n*(n - 1)*(n - 2)/6; n = n + 1; }; } }",
        ),
        start: [&[0.3, 0.0, 0.0], &[]],
        until: 2.0,
        impacts: 4,
    },
    Counter {
        text: Text::new(
            "TinierHops { coordinates { x; n; } lagrangian = (dot(x)^2 + dot(n)^2)/2 - x;
            impacts { s: x >= 0 => reset { dot(x) = 1e-9 + n*(n - 1)*(n - 2)/6; n = n + 1; }; } }",
        ),
        start: [&[0.3, 0.0], &[0.0, 0.0]],
        until: 2.0,
        impacts: 4,
    },
    Counter {
        text: Text::new(
            "NoTime { coordinates { x; v; a; b; c; } field { dot(x) = v; dot(v) = -1; dot(a) = 0; dot(b) = 0; dot(c) = 0; }
            impacts { s: x >= 0 => reset { x = 0; v = a; a = b; b = c; }; } }",
        ),
        start: [&[0.5, 0.0, 1.0, 1e-20, 1.0], &[]],
        until: 4.5,
        impacts: 3,
    },
];

#[test]
fn passages_at_shrinking_intervals_and_far_resets_do_not_accumulate() {
    for counter in &COUNTERS {
        let model = counter.text.large([]);
        let [q, qdot] = counter.start;
        for integrator in INTEGRATORS {
            let course = Course::from_state(&model, state(&model, q, qdot), counter.until);
            let end = course.run(Setting::free(integrator));
            let case = format!("{}, {}", counter.impacts, integrator.name());
            assert_eq!(end.outcome, Outcome::Done, "{case}");
            assert_eq!(end.counters.impacts, counter.impacts, "{case}");
        }
    }
}

#[test]
fn many_surfaces_at_one_time_are_no_accumulation() {
    let many = "Many { coordinates { x; n; } field { dot(x) = 1; dot(n) = 0; }
        impacts { s[i in 1..=120]: (x - 1)*(x + i) <= 0 => reset { n = n + 1; }; } initial { x = 0; until = 3; } }";
    let run = command::line(Vec::new(), "simulate - --json -", many);
    assert_eq!(run.exit, Exit::Reached, "{}", run.errors);
    let run: Value = serde_json::from_str(&run.output).expect("JSON");
    assert_eq!(run["outcome"]["q"][1], 120.0);
}

/// A model whose resets accumulate, with its start and the time of the accumulation.
struct Accumulating {
    text: Text,
    start: &'static [f64],
    right: f64,
    /// Bound of the error of this time. Ways that take less than 64 units in the last place of the time are left out, if they are
    /// many. Hops whose height is below rounding last up to the root of that.
    bound: f64,
    /// True if speeds grow.
    grows: bool,
}

static ACCUMULATING: [Accumulating; 10] = [
    // Ways of length 1, 1/32, 1/4, 1/128, ..
    Accumulating {
        text: Text::new(
            "Cycle { coordinates { x; a; b; } field { dot(x) = -1; dot(a) = 0; dot(b) = 0; }
            impacts { s: x >= 0 => reset { x = a; a = b; b = a/4; }; } }",
        ),
        start: &[1.0, 1.0, 0.03125],
        right: 2.375,
        bound: 1e-11,
        grows: false,
    },
    Accumulating {
        text: Text::new(
            "Slow { coordinates { x; l; } field { dot(x) = -1; dot(l) = 0; }
            impacts { s: x >= 0 => reset { x = l; l = 0.99*l; }; } }",
        ),
        start: &[1.0, 1.0],
        right: 101.0,
        bound: 2e-10,
        grows: false,
    },
    Accumulating {
        text: Text::new(
            "Upper { coordinates { x; l; } field { dot(x) = 1; dot(l) = 0; }
            impacts { s: x <= 3 => reset { x = 3 - l; l = 0.95*l; }; } }",
        ),
        start: &[2.0, 1.0],
        right: 21.0,
        bound: 1e-11,
        grows: false,
    },
    // The walls throw the motion to each other.
    Accumulating {
        text: Text::new(
            "InTurn { coordinates { x; u; a; } field { dot(x) = u; dot(u) = 0; dot(a) = 0; } impacts {
            f: x >= 0 => reset { x = 1 - a; u = 1; a = a/4; }; g: x <= 1 => reset { x = a; u = -1; a = a/4; }; } }",
        ),
        start: &[1.0, -1.0, 0.5],
        right: 5.0 / 3.0,
        bound: 1e-11,
        grows: false,
    },
    // Every second speed falls by a quarter.
    Accumulating {
        text: Text::new(
            "Uneven { coordinates { x; v; a; b; } field { dot(x) = v; dot(v) = -1; dot(a) = 0; dot(b) = 0; }
            impacts { s: x >= 0 => reset { x = 0; v = a; a = b; b = 0.75*a; }; } }",
        ),
        start: &[0.5, 0.0, 1.0, 0.125],
        right: 10.0,
        bound: 1e-11,
        grows: false,
    },
    Accumulating {
        text: Text::new(
            "Faster { coordinates { x; u; a; } field { dot(x) = u; dot(u) = 0; dot(a) = 0; } impacts {
            f: x >= 0 => reset { x = 0; u = 1/a; a = a/2; }; g: x <= 1 => reset { x = 1; u = -1/a; a = a/2; }; } }",
        ),
        start: &[1.0, -1.0, 0.5],
        right: 2.0,
        bound: 1e-11,
        grows: true,
    },
    Accumulating {
        text: Text::new(
            "MuchFaster { coordinates { x; u; a; } field { dot(x) = u; dot(u) = 0; dot(a) = 0; } impacts {
            f: x >= 0 => reset { x = 0; u = 1/a; a = a/10; }; g: x <= 1 => reset { x = 1; u = -1/a; a = a/10; }; } }",
        ),
        start: &[1.0, -1.0, 0.5],
        right: 14.0 / 9.0,
        bound: 1e-11,
        grows: true,
    },
    // On a floor whose height is no double.
    Accumulating {
        text: Text::new(
            "OffZero { coordinates { x; v; a; b; } field { dot(x) = v; dot(v) = -1; dot(a) = 0; dot(b) = 0; }
            impacts { s: x >= 3/10 => reset { x = 3/10; v = a; a = b; b = a/2; }; } }",
        ),
        start: &[0.8, 0.0, 1.0, 0.25],
        right: 6.0,
        bound: 3e-8,
        grows: false,
    },
    // On a slope along which the motion drifts, and in a cycle of three.
    Accumulating {
        text: Text::new(
            "Slope { coordinates { x; y; v; a; b; }
            field { dot(x) = 0.6*v - 0.8; dot(y) = 0.8*v + 0.6; dot(v) = -1; dot(a) = 0; dot(b) = 0; }
            impacts { s: 0.6*x + 0.8*y >= 0.3 => reset { v = a; a = b; b = a/2; }; } }",
        ),
        start: &[0.78, 1.04, 0.0, 1.0, 0.25],
        right: 5.0 + core::f64::consts::SQRT_2,
        bound: 5e-7,
        grows: false,
    },
    Accumulating {
        text: Text::new(
            "OfThree { coordinates { x; v; a; b; c; } field { dot(x) = v; dot(v) = -1; dot(a) = 0; dot(b) = 0; dot(c) = 0; }
            impacts { s: x >= 1/3 => reset { v = a; a = b; b = c; c = a/2; }; } }",
        ),
        start: &[1.0 / 3.0 + 0.5, 0.0, 1.0, 0.25, 0.5],
        right: 1.0 + 2.0 * 1.75 / 0.5,
        bound: 3e-8,
        grows: false,
    },
];

#[test]
fn resets_accumulate_whatever_the_order_of_their_ways() {
    for (index, case) in ACCUMULATING.iter().enumerate() {
        let model = case.text.large([]);
        for integrator in INTEGRATORS {
            let course = Course::from_state(&model, state(&model, case.start, &[]), 1000.0);
            let end = course.run(Setting::free(integrator));
            let told = format!(
                "{index}, {}: {:?} at {}",
                integrator.name(),
                end.outcome,
                end.t
            );
            let is_right = match end.outcome {
                Outcome::Zeno { .. } => !case.grows,
                Outcome::Spasmodic { .. } => case.grows,
                _ => false,
            };
            assert!(is_right, "{told}");
            assert!((end.t - case.right).abs() < case.bound, "{told}");
        }
    }
}
