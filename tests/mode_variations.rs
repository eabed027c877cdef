//! First variations of models with modes: differentials of transitions, differences of runs, limit cycles.

use core::ops::ControlFlow;

use dalembert::kernels::{Declared, Form};
use dalembert::variations::Undefined;
use dalembert::{Event, Observer, StateVector, System, Tangent};
use dalembert_cli::{Exit, Integrator};
use dalembert_stability::course::{Course, Driven, declared};
use dalembert_stability::text::{Large, Model, Text, set, shipped};
use dalembert_stability::varied::{Returns, Varied};
use dalembert_tests::command;
use dalembert_tests::differences::{self, Turns};
use dalembert_tests::reference::{number, numbers, read};
use serde_json::Value;

/// A field that is discontinuous at a plane.
static LAYERS: Text = Text::new(
    "Layers {
        const N = 3;
        coordinates { x; y; z; }
        parameters {
            /// The field before.
            f[N] = 0;
            /// The field after.
            g[N] = 0;
            /// The normal of the plane.
            n[N] = 0;
            /// 1 or -1: the side that the motion comes from.
            side = 1;
        }
        modes {
            before { field { dot(x) = f[1]; dot(y) = f[2]; dot(z) = f[3]; } }
            after { field { dot(x) = g[1]; dot(y) = g[2]; dot(z) = g[3]; } }
        }
        transitions { crossing: before -> after when side*(n[1]*x + n[2]*y + n[3]*z) <= 0; }
    }",
);

/// Modes with different numbers of coordinates and different surfaces, and resets between them that depend on time.
static MIXED: Text = Text::new(
    "Mixed {
        parameters { e in [0, 1] = 4/5; k > 0 = 1/2; c = 1/3; }
        modes {
            pair {
                coordinates { x; y; }
                lagrangian = (dot(x)^2 + (2 + sin(x))*dot(y)^2)/2 - k*(x - y)^2/2 - y/3;
                impacts {
                    floor: y >= -1/2 => newton(e);
                    mark: x >= -1/4 => reset { x = x; y = y + c/20; dot(x) = -k*dot(x); dot(y) = dot(y) + c*dot(x); };
                }
                initial { x = 0.3; y = 0.1; dot(x) = -1; dot(y) = -0.4; until = 5; }
            }
            single {
                coordinates { y; }
                lagrangian = dot(y)^2/2 - y;
                impacts { ground: y >= -1 => restitution(e); }
            }
        }
        transitions {
            dropped: pair -> single when x >= 1/2 => reset { y = y + c*x^2 + t/50; dot(y) = dot(x) - k*dot(y); };
            lifted: single -> pair when y - t/5 <= -7/4 => reset { x = -c/5; y = k*y; dot(x) = -dot(y); dot(y) = c*dot(y); };
        }
    }",
);

/// Modes in global form. Mass, potential and constraint change at a moving curve.
static MEDIUM: Text = Text::new(
    "Medium {
        coordinates { x; y; z; }
        parameters { m > 0 = 2; V = 1/5; a = 1/2; b = 1/3; }
        modes {
            thin {
                lagrangian = (dot(x)^2 + dot(y)^2 + dot(z)^2)/2;
                constraints { turn: (x + 2)*dot(y) - a*y*dot(x) = 0; }
            }
            dense {
                lagrangian = m/2*(dot(x)^2 + (1 + a*x^2)*dot(y)^2 + dot(z)^2) - V;
                constraints { turn: (x + 2)*dot(z) - b*y*dot(y) = 0; }
            }
        }
        transitions {
            enter: thin -> dense when x + b*y^2 - t/10 >= 0;
            leave: dense -> thin when x + b*y^2 - t/10 <= -2;
        }
    }",
);

/// Two modes in reduced form with different masses.
static REDUCED: Text = Text::new(
    "Reduced {
        coordinates { x; y; }
        parameters { m > 0 = 2; }
        constraints { slope: dot(y) - x*dot(x) = 0; }
        frame { u: d(x); }
        modes {
            thin { lagrangian = (dot(x)^2 + dot(y)^2)/2; }
            dense { lagrangian = m/2*(dot(x)^2 + dot(y)^2); }
        }
        transitions { enter: thin -> dense when x >= 0; }
    }",
);

/// Fields that both lead to a moving curve. The motion slides along it and leaves it into the left mode.
static SLIDER: Text = Text::new(
    "Slider {
        coordinates { x; y; }
        parameters { a = 1/2; b = 1/3; c = 3/2; k = 2/5; w = 1/20; }
        modes {
            right { field { dot(x) = -1 - b*x + k*y*t; dot(y) = 1 + b*x*y + sin(t)/4; } }
            left { field { dot(x) = c - y; dot(y) = 1/2 + x^2 + k*cos(y); } }
        }
        transitions {
            leftward: right -> left when x <= a*y^2/4 + w*t;
            rightward: left -> right when x >= a*y^2/4 + w*t;
        }
    }",
);

/// Two transitions at one time on a moving curve: the constraint of the mode `rough` turns the motion back, so that it
/// leaves this mode at once.
static THROWN: Text = Text::new(
    "Thrown {
        coordinates { x; y; z; }
        parameters { r = 1/2; c = 3/10; w = 1/10; a = 1/5; }
        lagrangian = (dot(x)^2 + dot(y)^2 + (1 + a*x^2)*dot(z)^2)/2 + a*y*x/4;
        modes { smooth { } rough { constraints { roll: dot(x) + a*y*dot(y) = r*dot(z); } } }
        transitions {
            enter: smooth -> rough when x >= c*y^2 + w*t;
            leave: rough -> smooth when x <= c*y^2 + w*t;
        }
    }",
);

/// A state of the first mode. Missing values are 0.
fn state<S: Driven>(system: &S, q: &[f64], qdot: &[f64]) -> S::State {
    let [mut position, mut velocity] = [system.zero_vector(); 2];
    position.as_mut_slice()[..q.len()].copy_from_slice(q);
    velocity.as_mut_slice()[..qdot.len()].copy_from_slice(qdot);
    system.state(0.0, &position, &velocity).expect("a state")
}

/// Records the surfaces of all events.
struct Surfaces(Vec<usize>);

impl<Sys: System> Observer<Sys> for Surfaces {
    fn event(&mut self, event: &Event<Sys::State>) -> ControlFlow<()> {
        self.0.push(event.surface);
        ControlFlow::Continue(())
    }
}

/// A run without projection, so that states may leave the constraints.
fn course<'a, S: Driven>(system: &'a S, start: S::State, until: f64) -> Course<'a, S> {
    Course::from_state(system, start, until)
        .tol(1e-15)
        .projection(false)
}

/// The end of a run of [`course`].
fn end<S: Driven>(system: &S, start: S::State, until: f64, seen: &mut dyn Observer<S>) -> S::State {
    let run = course(system, start, until).observed(Integrator::Taylor, seen);
    assert!(run.outcome.is_done(), "{}", run.outcome);
    run.state
}

#[test]
fn a_crossing_has_the_differential_of_the_reference() {
    let file = read("zeno_and_filippov");
    let cases = file["filippov"].as_array().expect("cases");
    assert_eq!(cases.len(), 2);
    for case in cases {
        let [f, n, g] = ["f", "dh", "g"].map(|name| numbers(&case[name]));
        let rate: f64 = f.iter().zip(&n).map(|(f, n)| f * n).sum();
        let mut layers = LAYERS.with([("side", -rate.signum())]);
        for (name, values) in [("f", &f), ("g", &g), ("n", &n)] {
            for (k, value) in values.iter().enumerate() {
                set(&mut layers, &format!("{name}.{}", k + 1), *value);
            }
        }
        let start: Vec<f64> = f.iter().map(|f| -f / 2.0).collect();
        let start = state(&layers, &start, &[]);
        let mut columns: Vec<Tangent<Model>> = (0..3).map(Tangent::of_component).collect();
        let (run, derived) = course(&layers, start, 1.0).vary(Integrator::Taylor, &mut columns);
        assert!(run.outcome.is_done(), "{}", run.outcome);
        let crossed = run.counters.impacts;
        assert_eq!((crossed, layers.mode(&run.state)), (1, 1));
        derived.expect("derivatives");
        let rows = case["augmented_differential"].as_array().expect("rows");
        assert_eq!(rows.len(), 3);
        for (i, row) in rows.iter().enumerate() {
            let row = numbers(row);
            assert_eq!(row.len(), columns.len());
            for (column, expected) in columns.iter().zip(row) {
                assert!(
                    (column.state.as_slice()[i] - expected).abs() < 1e-14,
                    "{column:?}"
                );
            }
        }
        for column in &columns {
            assert_eq!(column.state.as_slice()[3], 0.0);
        }
        let [a, b, c] = [0, 1, 2].map(|k| columns[k].state.as_slice());
        let minor = |i: usize, j: usize| b[i] * c[j] - b[j] * c[i];
        let jacobian = a[0] * minor(1, 2) + a[1] * minor(2, 0) + a[2] * minor(0, 1);
        let expected = number(&case["hybrid_jacobian"]);
        assert!((jacobian - expected).abs() < 1e-14, "{jacobian}");
    }
}

/// Compares derivatives of a run with differences of runs. The derivatives are taken with respect to the first `used`
/// components of the start and to all parameters. All runs have the same number of transitions and impacts, at least
/// `passed`.
fn check_differences<S: Varied>(system: &S, start: S::State, used: usize, until: f64, passed: u64) {
    let impacts = differences::check_differences(system, start, used, |system, start| {
        course(system, start, until)
    });
    assert!(
        impacts >= passed,
        "{}: {impacts}",
        system.description().name
    );
}

fn check_declared<S: Varied>(system: &S, used: usize, until: f64, passed: u64) {
    check_differences(system, declared(system), used, until, passed);
}

/// A shipped model.
fn large(name: &str) -> Large {
    shipped(name).sized()
}

#[test]
fn declared_states_have_their_derivatives() {
    check_declared(&large("rimless_wheel_five"), 2, 9.0, 2);
    check_declared(&large("rimless_wheel_ten"), 2, 4.0, 4);
    let squares = shipped("tent_map").model();
    check_differences(&squares, state(&squares, &[0.0, 0.34], &[]), 2, 2.5, 2);
    let mixed = MIXED.model();
    let mut seen = Surfaces(Vec::new());
    end(&mixed, declared(&mixed), 6.5, &mut seen);
    seen.0.sort_unstable();
    seen.0.dedup();
    assert_eq!(seen.0, [0, 1, 2, 3, 4]);
    check_declared(&mixed, 4, 6.5, 5);
}

#[test]
fn constraints_that_change_have_their_derivatives() {
    let ball = large("smooth_and_rough_plane");
    check_declared(&ball, 10, 2.5, 1);
    let q = [-1.0, 0.2, 0.3, 1.2, 0.4];
    let start = state(&ball, &q, &[1.0, 0.5, -8.0, 0.4, 0.2]);
    check_differences(&ball, start, 10, 2.5, 1);
    // The rough side throws the spinning ball back: there are two transitions at one time.
    let start = state(&ball, &q, &[1.0, 0.5, 8.0, 0.4, 0.2]);
    check_differences(&ball, start, 10, 2.5, 2);
    let thrown = THROWN.model();
    let start = state(&thrown, &[-0.3, 0.2, 0.1], &[1.0, 0.3, -6.0]);
    check_differences(&thrown, start, 6, 3.0, 2);
    check_declared(&large("ball_on_switching_table"), 8, 12.0, 1);
    check_declared(&large("two_wheels_arrested"), 6, 3.0, 1);
}

#[test]
fn refraction_has_its_derivative() {
    let particle = shipped("refracted_particle");
    check_declared(&particle.model(), 4, 3.0, 1);
    // With too little energy the particle is reflected.
    check_declared(&particle.with([("V2", 2.0)]), 4, 3.0, 1);
    check_declared(&shipped("sphere_in_plane").model(), 4, 2.0, 2);
    let medium = MEDIUM.model();
    let thin = &medium.tables().modes[0].tables;
    assert!(thin.form == Form::Global && thin.dimensions.constraints > 0);
    let start = state(&medium, &[-1.0, 0.5, 0.0], &[1.0, 0.25, 0.25]);
    check_differences(&medium, start, 6, 2.0, 1);
}

#[test]
fn refraction_of_reduced_modes_has_no_derivative() {
    let reduced = REDUCED.model();
    let start = state(&reduced, &[-1.0, 0.0], &[1.0, -1.0]);
    let mut columns = [Tangent::of_component(0)];
    let (run, derived) = course(&reduced, start, 2.0).vary(Integrator::Taylor, &mut columns);
    assert!(run.outcome.is_done(), "{}", run.outcome);
    let Err(Undefined::Refracted { t, surface: 0 }) = derived else {
        panic!("the Lagrangian of a reduced mode changes")
    };
    assert!(t > 0.5 && t < 2.0);
}

#[test]
fn sliding_has_its_derivative() {
    check_declared(&shipped("filippov_field").model(), 2, 3.0, 1);
    // The sliding motion ends in the left mode, whichever mode it started in.
    let slider = SLIDER.model();
    for (mode, x) in [(0, 0.5), (1, -0.5)] {
        let mut start = state(&slider, &[x, 0.1], &[]);
        start.as_mut_slice()[2] = f64::from(mode);
        for (until, turns) in [(1.0, [1, 0]), (3.0, [1, 1])] {
            let mut seen = Turns::default();
            let last = end(&slider, start, until, &mut seen);
            assert_eq!(seen.0, turns, "from {x} until {until}: {last:?}");
            assert!(turns[1] == 0 || slider.mode(&last) == 1);
            check_differences(&slider, start, 2, until, 1);
        }
    }
}

/// Compares the limit cycle of a wheel, found from its declared start, with stored values.
fn check_wheel(wheel: &Large, stored: &Value) {
    let cycle = &stored["limit_cycle_xi_true"];
    let step = &cycle["steps"][0];
    let section = Returns::new(wheel, 0, 1e3);
    let first = section
        .arrive(&declared(wheel), &mut [])
        .expect("an arrival");
    let orbit = section.periodic(&first.before).expect("a cycle");
    let close = |found: f64, name: &str, stored: &Value| {
        let error = (found - number(stored)).abs();
        assert!(error < 1e-11, "{name}: {found}, by {error:e}");
    };
    close(orbit.point.time, "period", &cycle["period"]);
    let before = orbit.point.before;
    close(before.as_slice()[0], "angle", &step["end_angle"]);
    let rate = wheel.velocity(0.0, &before).expect("a velocity");
    close(rate.as_slice()[0], "rate", &step["end_rate"]);
    assert_eq!((orbit.dimension, wheel.mode(&before)), (1, 0));
    assert_eq!(wheel.mode(&orbit.point.after), 1);
    // Neither the angle nor the mode is a direction of the section.
    let direction = orbit.directions[0];
    assert_eq!(
        (direction.as_slice()[0], direction.as_slice()[2]),
        (0.0, 0.0)
    );
    let expected = number(&cycle["multiplier_of_x_dot^2"]);
    let [multiplier, imaginary] = orbit.multipliers.iter().next().expect("one");
    // The multiplier is computed from numbers of size 1 and has their rounding errors, even if it is small.
    let error = (multiplier - expected).abs();
    assert!(
        error < 4e-15 && imaginary == 0.0,
        "{multiplier:e} for {expected:e}, by {error:e}"
    );
}

#[test]
fn wheels_have_the_stored_cycles_and_multipliers() {
    let file = read("rimless_wheels");
    check_wheel(&large("rimless_wheel_five"), &file["wheels"][0]);
    check_wheel(&large("rimless_wheel_ten"), &file["wheels"][1]);
}

#[test]
fn the_command_finds_the_cycle_of_a_wheel() {
    let line = "orbit rimless_wheel_five --surface step1 --json -";
    let finished = command::line(dalembert_command::all(), line, "");
    let text = finished.output;
    assert_eq!(
        (finished.exit, finished.errors.as_str()),
        (Exit::Reached, ""),
        "{text}"
    );
    let document: Value = serde_json::from_str(&text).expect("JSON");
    let cycle = &read("rimless_wheels")["wheels"][0]["limit_cycle_xi_true"];
    let period = document["period"].as_f64().expect("a period");
    assert!((period - number(&cycle["period"])).abs() < 1e-11);
    let multiplier = document["multipliers"][0]["re"].as_f64().expect("a number");
    let expected = number(&cycle["multiplier_of_x_dot^2"]);
    assert!((multiplier / expected - 1.0).abs() < 1e-9, "{text}");
}
