//! Motions that slide along the surface between two modes.

use core::ops::ControlFlow;

use dalembert::{Hold, Instance, Observer, Outcome, StateVector, System};
use dalembert_cli::Integrator;
use dalembert_stability::course::{Course, is_discrete, state};
use dalembert_stability::text::Text;

/// A field with two sides. Below `y = -1` the left side leads away from the line `x = 0`.
static LEAVING: Text = Text::new(
    "Leaving {
        coordinates { x; y; }
        modes {
            right { field { dot(x) = -1; dot(y) = -1; } }
            left { field { dot(x) = 1 + y; dot(y) = -1; } }
        }
        transitions {
            leftward: right -> left when x <= 0;
            rightward: left -> right when x >= 0;
        }
    }",
);

/// Times at which sliding begins and ends.
struct Slides(Vec<(f64, bool)>);

impl<Sys: System> Observer<Sys> for Slides {
    fn hold(&mut self, hold: &Hold<Sys::State>) -> ControlFlow<()> {
        self.0.push((hold.t, hold.begins));
        ControlFlow::Continue(())
    }
}

/// The motion slides down the line until one side leads away from it, and continues on that side.
#[test]
fn a_slide_ends_where_one_side_leads_away() {
    let field = LEAVING.model();
    let state = state(&field, &[0.5, 0.5], &[0.0; 2]);
    let mut slides = Slides(Vec::new());
    let run = Course::from_state(&field, state, 3.0)
        .tol(1e-13)
        .observed(Integrator::Taylor, &mut slides);
    assert_eq!((run.outcome, run.counters.impacts), (Outcome::Done, 1));
    let times = slides.0;
    assert_eq!(times.len(), 2);
    assert!((times[0].0 - 0.5).abs() < 1e-14 && times[0].1);
    assert!((times[1].0 - 1.5).abs() < 1e-13 && !times[1].1, "{times:?}");
    assert_eq!(field.mode(&run.state), 1, "the left one");
    // The motion is x = -(t - 1.5)^2/2, y = 1/2 - t.
    let q = field.position(&run.state);
    let q = q.as_slice();
    assert!(
        (q[0] + 1.125).abs() < 1e-12 && (q[1] + 2.5).abs() < 1e-13,
        "{q:?}"
    );
}

/// An oscillator with dry friction and a force, all of which are proportional to `mu`.
static RUBBED: Text = Text::new(
    "Rubbed {
        coordinates { x; v; }
        parameters { mu > 0 = 1; }
        modes {
            forward { field { dot(x) = v; dot(v) = 0.9*mu*cos(t) - mu - x; } }
            backward { field { dot(x) = v; dot(v) = 0.9*mu*cos(t) + mu - x; } }
        }
        transitions { stop: forward -> backward when v <= 0; go: backward -> forward when v >= 0; }
    }",
);

/// Across the surface, rates of 1e20 cancel. What is left by rounding is no reason for short steps.
#[test]
fn a_slide_of_large_numbers_takes_as_many_steps() {
    let integrators = [
        Integrator::Taylor,
        Integrator::Dop853,
        Integrator::Dopri5,
        Integrator::Gauss6,
    ];
    for integrator in integrators {
        let mut counts = Vec::new();
        for size in [1.0, 1e9, 1e12, 1e20] {
            let mut rubbed = RUBBED.model();
            rubbed.set_parameter(0, size);
            let start = state(&rubbed, &[0.0, 0.5 * size], &[0.0; 2]);
            let course = Course::from_state(&rubbed, start, 12.0)
                .tol(1e-10)
                .step(1e-2);
            let run = course.observed(integrator, &mut ());
            assert_eq!(
                run.outcome,
                Outcome::Done,
                "{}, {size:e}",
                integrator.name()
            );
            let q = rubbed.position(&run.state);
            let [x, v] = [q.as_slice()[0] / size, q.as_slice()[1] / size];
            assert!(
                (x - 0.133_138_283_5).abs() < 1e-6 && v.abs() < 1e-9,
                "{x}, {v}"
            );
            counts.push(run.counters.accepted);
        }
        let most = counts.iter().max();
        assert!(
            most <= Some(&(3 * counts[0])),
            "{}: {counts:?}",
            integrator.name()
        );
    }
}

/// Two fields that lead to the line `x = 0` from both sides, along which transitions count up to `y = 1`.
static BOUNDED: Text = Text::new(
    "Bounded {
        coordinates { x; y; }
        modes {
            right { field { dot(x) = -1; dot(y) = 1; } }
            left { field { dot(x) = 1; dot(y) = 1; } }
        }
        transitions {
            go: right -> left when x <= 0 when y < 1;
            back: left -> right when x >= 0 when y < 1;
        }
    }",
);

/// The motion goes on in the mode of the state, through the line.
#[test]
fn a_slide_ends_where_its_transitions_no_longer_count() {
    let field = BOUNDED.model();
    for &integrator in [Integrator::Taylor, Integrator::Dop853, Integrator::Rk4].iter() {
        let state = state(&field, &[0.5, 0.0], &[0.0; 2]);
        let mut slides = Slides(Vec::new());
        let course = Course::from_state(&field, state, 3.0).tol(1e-12).step(1e-2);
        let run = course.observed(integrator, &mut slides);
        assert_eq!(run.outcome, Outcome::Done);
        let times = slides.0;
        let is_seen = matches!(times[..], [(begin, true), (end, false)]
            if (begin - 0.5).abs() < 1e-9 && (end - 1.0).abs() < 1e-9);
        assert!(is_seen, "{}: {times:?}", integrator.name());
        let q = field.position(&run.state);
        let q = q.as_slice();
        assert!(
            (q[0].abs() - 2.0).abs() < 1e-9 && (q[1] - 3.0).abs() < 1e-9,
            "{q:?}"
        );
    }
}

/// The two fields that lead to the line `x = 0` from both sides, with surfaces of the right mode across the line. The
/// motion slides from `t = 1/2` on, at the mean rate `3/4` of `y`.
fn sliding(surfaces: &str, transitions: &str) -> Text {
    let away = match transitions.contains("away") {
        true => "away { field { dot(x) = 0; dot(y) = -1; } }",
        false => "",
    };
    let text = format!(
        "Between {{
            coordinates {{ x; y; }}
            modes {{
                right {{ {surfaces} field {{ dot(x) = -1; dot(y) = 1/2; }} }}
                left {{ field {{ dot(x) = 1; dot(y) = 1; }} }}
                {away}
            }}
            transitions {{ {transitions} }}
        }}"
    );
    Text::new(text.leak())
}

/// The motion is the limit of fast switches, so that surfaces of both modes act on it: whichever side it comes from,
/// and in either order of declaration.
#[test]
fn a_sliding_motion_meets_the_surfaces_of_both_modes() {
    let [go, back, leave] = [
        "go: right -> left when x <= 0;",
        "back: left -> right when x >= 0;",
        "leave: right -> away when y >= 1;",
    ];
    // It starts at `y = 0`: the side it comes from determines the rate until it slides.
    let met = |rate: f64| 0.5 + (1.0 - 0.5 * rate) / 0.75;
    for (x, rate) in [(0.5, 0.5), (-0.5, 1.0)] {
        for integrator in [Integrator::Taylor, Integrator::Dop853, Integrator::Rk4] {
            let name = integrator.name();
            let run = |text: &Text, until: f64| {
                let mut field = text.model();
                if x < 0.0 {
                    field.set_mode(1);
                }
                let state = state(&field, &[x, 0.0], &[0.0; 2]);
                let course = Course::from_state(&field, state, until)
                    .tol(1e-12)
                    .step(1.0 / 128.0);
                let run = course.observed(integrator, &mut ());
                (
                    run.outcome,
                    run.t,
                    field.mode(&run.state),
                    field.position(&run.state),
                )
            };
            let text = sliding("impacts { top: y <= 1 => stop; }", &[go, back].concat());
            let (outcome, t, ..) = run(&text, 4.0);
            assert!(
                matches!(outcome, Outcome::StoppedAt { .. }),
                "{name}, {x}: {outcome:?}"
            );
            assert!((t - met(rate)).abs() < 1e-13, "{name}, {x}: {t}");
            for order in [[go, back, leave], [leave, go, back]] {
                let (outcome, _, mode, q) = run(&sliding("", &order.concat()), met(rate) + 0.5);
                assert_eq!(
                    (outcome, mode),
                    (Outcome::Done, 2),
                    "{name}, {x}, {order:?}"
                );
                assert!(
                    (q.as_slice()[1] - 0.5).abs() < 1e-13,
                    "{name}, {x}, {order:?}"
                );
            }
            // It slides on from below, 3/4 in the rest of the time.
            let reset = "impacts { top: y <= 1 => reset { y = -1; }; }";
            let (outcome, _, _, q) = run(&sliding(reset, &[go, back].concat()), met(rate) + 1.0);
            assert_eq!(outcome, Outcome::Done, "{name}, {x}");
            let end = q.as_slice();
            assert!(
                end[0].abs() < 1e-13 && (end[1] + 0.25).abs() < 1e-13,
                "{name}, {x}: {end:?}"
            );
        }
    }
}

/// A surface that holds the motion when the mode changes, or that the motion meets after that, leaves mode and position as
/// they are. Nothing acts along `x`.
#[test]
fn surfaces_hold_the_motion_in_the_present_mode() {
    let both: &[f64] = &[1.0 / 8.0, 2.0];
    for (b, floors, end, heights) in [
        ("(dot(x)^2 + dot(y)^2)/2 - y", "common", 4.0, both),
        ("(dot(x)^2 + 4*dot(y)^2)/2 - y", "common", 4.0, &both[..1]),
        ("(dot(x)^2 + dot(y)^2)/2 - y", "own", 4.0, both),
        (
            "(dot(x)^2 + dot(y)^2)/2 - y + (x - 1)/4",
            "common",
            4.0 + 9.0 / 8.0,
            both,
        ),
    ] {
        let floor = |name: &str| format!("impacts {{ {name}: y >= 0 => impact_plastic; }}");
        let [common, first, second] = match floors {
            "common" => [floor("floor"), String::new(), String::new()],
            _ => [String::new(), floor("one"), floor("two")],
        };
        let text = format!(
            "Held {{
                coordinates {{ x; y; }}
                {common}
                modes {{
                    a {{ {first} lagrangian = (dot(x)^2 + dot(y)^2)/2 - y; }}
                    b {{ {second} lagrangian = {b}; }}
                }}
                transitions {{ ab: a -> b when x >= 1; }}
            }}"
        );
        let text = Text::new(text.leak());
        let system = text.model();
        // It falls onto the floor before the change, and after it.
        for &height in heights {
            let state = state(&system, &[0.0, height], &[1.0, 0.0]);
            for &integrator in Integrator::every() {
                let name = integrator.name();
                if is_discrete(integrator) {
                    continue;
                }
                let course = Course::from_state(&system, state, 4.0).resting();
                let run = course.tol(1e-11).observed(integrator, &mut ());
                assert_eq!((run.outcome, run.t), (Outcome::Done, 4.0), "{name}, {b}");
                assert_eq!(system.mode(&run.state), 1, "{name}, {b}");
                let q = system.position(&run.state);
                let q = q.as_slice();
                assert!(
                    (q[0] - end).abs() < 1e-10 && q[1].abs() < 1e-10,
                    "{name}, {b}, {height}: {q:?}"
                );
            }
        }
    }
}
