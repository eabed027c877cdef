//! Power series of motions: emitted series compared with interpreted ones, with functions, and with closed forms.

use dalembert::jet::{Jets, LENGTH};
use dalembert::math::larger;
use dalembert::numbers::Row;
use dalembert::{
    Described, Instance, Outcome, StateVector, System, Taylor, TaylorField, Tolerance,
};
use dalembert_cli::Integrator;
use dalembert_codegen::program::jet::degree::Degree;
use dalembert_codegen::program::jet::{Jet, Recurrence, interpret};
use dalembert_codegen::program::{Input, Program};
use dalembert_codegen::{compile, spec};
use dalembert_stability::course::{Course, state};
use dalembert_stability::text::{Model, Text};
use dalembert_tests::sampling::{every_system, states};

fn program(source: &str) -> Program {
    compile(source.parse().expect("tokens"))
        .expect("a model")
        .programs
        .main
}

/// The inputs of a rate at a state of a system.
fn input<'a, S: Instance>(
    system: &'a S,
    t: f64,
    state: &'a S::State,
) -> impl Fn(Input) -> f64 + 'a {
    let n = system.coordinate_count();
    move |input| match input {
        Input::Time => t,
        Input::Parameter(k) => system.parameter(k),
        other => other.component(n).map_or(f64::NAN, |i| state.as_slice()[i]),
    }
}

/// Emitted coefficients at a state by orders: those of the components, then those of the gaps.
fn expand<S: TaylorField>(
    system: &S,
    t: f64,
    (unit, order): (f64, usize),
    state: S::State,
) -> Vec<Vec<f64>> {
    let parameters = system.parameters();
    let mut coefficients = [S::Row::<f64>::zeros(system.state_len()); LENGTH];
    coefficients[0]
        .as_mut_slice()
        .copy_from_slice(state.as_slice());
    let mut firsts = S::Firsts::<f64>::zeros(system.firsts_len());
    system
        .begin(&parameters, t, &coefficients[0], &mut firsts)
        .expect("a rate");
    let mut gaps = [S::Gaps::<f64>::zeros(system.series_gap_count()); LENGTH];
    let mut jets = S::Jets::<f64>::ZERO;
    system.advance(
        &parameters,
        unit,
        order,
        &firsts,
        &mut coefficients,
        &mut gaps,
        &mut jets,
    );
    let rows = coefficients.iter().zip(&gaps);
    rows.map(|(state, gaps)| [state.as_slice(), gaps.as_slice()].concat())
        .collect()
}

/// Asserts that coefficients agree with those of the interpreter to 1e-5 of the largest coefficient of their order,
/// since the terms of gaps may cancel. The first coefficient is the rate up to rounding errors, since constant factors
/// are multiplied in another order. Returns the relative errors of all coefficients that are above rounding errors.
fn assert_is_interpreted<S: Instance + TaylorField>(
    system: &S,
    jet: &Jet,
    state: S::State,
) -> Vec<f64> {
    let name = system.description().name;
    let (t, unit, order) = (0.25, 0.125, 12);
    let emitted = expand(system, t, (unit, order), state);
    let at = input(system, t, &state);
    let interpreted =
        interpret::motion(jet, &at, (unit, order), state.as_slice()).expect("an expansion");
    let mut rate = state;
    system.rate(t, &state, &mut rate).expect("a rate");
    let largest = |values: &mut dyn Iterator<Item = f64>| values.fold(0.0, larger);
    let rounding =
        16.0 * f64::EPSILON * largest(&mut rate.as_slice().iter().map(|component| component.abs()));
    for (coefficient, rate) in emitted[1].iter().zip(rate.as_slice()) {
        let missed = (coefficient - unit * rate).abs();
        assert!(
            missed <= unit * rounding,
            "{name}: {coefficient} for {}",
            unit * rate
        );
    }
    assert_eq!(emitted[0].len(), interpreted.len(), "{name}");
    let mut errors = Vec::new();
    for k in 0..=order {
        let size = largest(&mut interpreted.iter().map(|component| component[k].abs()));
        // Where exact terms cancel, rounding errors remain. They are relative to the coefficients of order 1.
        let rounding =
            f64::EPSILON * largest(&mut interpreted.iter().map(|component| component[1].abs()));
        let pairs = emitted[k].iter().zip(&interpreted);
        let error = largest(&mut pairs.map(|(emitted, component)| (emitted - component[k]).abs()));
        assert!(
            error <= 1e-5 * size + rounding,
            "{name}: order {k}: {error:e} of {size:e}"
        );
        assert!(size.is_finite(), "{name}: order {k}");
        for (emitted, component) in emitted[k].iter().zip(&interpreted) {
            let value = component[k];
            if value.abs() > 16.0 * rounding {
                errors.push(((emitted - value) / value).abs());
            }
        }
    }
    errors
}

/// Asserts that most coefficients agree to ten digits. Cancellation costs more digits in a few.
#[track_caller]
fn assert_rounded(name: &str, mut errors: Vec<f64>) {
    errors.sort_by(f64::total_cmp);
    let median = errors[errors.len() / 2];
    assert!(median < 1e-10, "{name}: {median:e}");
}

#[test]
fn coefficients_are_what_the_interpreter_computes() {
    let mut compared = 0;
    for system in every_system() {
        let program = program(&system.description().source);
        let mut errors = Vec::new();
        for state in states(system, 5, 1) {
            errors.extend(assert_is_interpreted(system, &program.jet, state));
            compared += 1;
        }
        assert_rounded(system.description().name, errors);
    }
    assert!(compared >= 100);
}

dalembert::model! {
    /// Forces with every function of the language.
    pub EveryForce {
        coordinates { x; y; }
        parameters { c = 0.3; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2;
        forces {
            odd: (sin(x) + tan(c*x) + asin(x)/2 + atan(x*y) + sinh(x) + tanh(y) + asinh(x*y) + sqrt(x + 1) + abs(y))*d(x);
            even: (cos(y) + acos(y)/2 + exp(-x) + ln(1 + x^2) + log1p(x*y) + cosh(y) + atan2(y, x + 1) + (2 + x)^(2/3)
                + (1 + t)/(1 + x*y) + c/(2 + x) + t^2*x)*d(y);
        }
    }
}

#[test]
fn every_function_is_expanded_as_it_is_interpreted() {
    let system = EveryForce::default();
    let program = program(EveryForce::DESCRIPTION.source.value());
    let state = system
        .state(0.25, &[0.4, -0.3].into(), &[0.5, 0.7].into())
        .expect("a state");
    let errors = assert_is_interpreted(&system, &program.jet, state);
    assert_rounded("EveryForce", errors);
    for name in spec::FUNCTIONS {
        assert!(
            EveryForce::DESCRIPTION
                .source
                .contains(&format!("{name} ("))
                || EveryForce::DESCRIPTION.source.contains(&format!("{name}(")),
            "{name}"
        );
    }
}

/// The value at `s` of the polynomial with these coefficients.
fn sum(coefficients: &[f64], s: f64) -> f64 {
    coefficients.iter().rev().fold(0.0, |sum, c| sum * s + c)
}

/// The sum of the series of a function along `x(s)`, `y(s)` is the function of the sums.
#[test]
fn series_of_functions_sum_up_to_their_values() {
    const X: [f64; 4] = [0.4, 0.3, -0.2, 0.1];
    const Y: [f64; 3] = [-0.3, 0.5, 0.25];
    type Function = fn(f64, f64) -> f64;
    let cases: [(&str, Function); 24] = [
        ("sqrt(x)", |x, _| x.sqrt()),
        ("sin(x)", |x, _| x.sin()),
        ("cos(y)", |_, y| y.cos()),
        ("sin(x)*cos(x)", |x, _| x.sin() * x.cos()),
        ("tan(x)", |x, _| x.tan()),
        ("asin(x)", |x, _| x.asin()),
        ("acos(y)", |_, y| y.acos()),
        ("atan(x)", |x, _| x.atan()),
        ("exp(x)", |x, _| x.exp()),
        ("ln(x)", |x, _| x.ln()),
        ("log1p(x)", |x, _| x.ln_1p()),
        ("sinh(x)", |x, _| x.sinh()),
        ("cosh(y)", |_, y| y.cosh()),
        ("tanh(x)", |x, _| x.tanh()),
        ("asinh(x)", |x, _| x.asinh()),
        ("abs(y)", |_, y| y.abs()),
        ("atan2(y, x)", |x, y| y.atan2(x)),
        ("x^(2/3)", |x, _| x.powf(2.0 / 3.0)),
        ("x^(-5/3)", |x, _| x.powf(-5.0 / 3.0)),
        ("x*y/(1 + y^2)", |x, y| x * y / (1.0 + y * y)),
        ("pi/x - y/pi", |x, y| {
            core::f64::consts::PI / x - y / core::f64::consts::PI
        }),
        ("x^2*y^3", |x, y| x * x * y * y * y),
        ("atan2(1, x)", |x, _| 1_f64.atan2(x)),
        ("exp(y)/(exp(y) + sqrt(x))", |x, y| {
            y.exp() / (y.exp() + x.sqrt())
        }),
    ];
    for (expression, function) in cases {
        let source = format!(
            "P {{ coordinates {{ x; y; }} lagrangian = dot(x)^2 + dot(y)^2; outputs {{ o: {expression}; }} }}"
        );
        let outputs = program(&source).outputs.expect("outputs");
        let degrees = [Degree::AtMost(3), Degree::AtMost(2)];
        for components in [degrees, [Degree::Endless; 2]] {
            let jet = Jet::of(&[&outputs], &components, |input| {
                input.component(2).filter(|i| *i < 2)
            });
            let at = |input: Input| match input {
                Input::Coordinate(0) => X[0],
                Input::Coordinate(1) => Y[0],
                _ => f64::NAN,
            };
            let component = |i: usize, k: usize| {
                let series: &[f64] = if i == 0 { &X } else { &Y };
                series.get(k).copied().unwrap_or(0.0)
            };
            let series = interpret::along(&jet, &at, (1.0, 30), &component).expect("no guard");
            for s in [-0.1, 0.05, 0.1] {
                let (actual, expected) = (sum(&series[0], s), function(sum(&X, s), sum(&Y, s)));
                let error = (actual - expected).abs() / expected.abs().max(1.0);
                assert!(
                    error < 1e-14,
                    "{expression} at {s}: {actual} for {expected}"
                );
            }
        }
    }
}

/// Components that are polynomials in time have series that end. The generator finds their degrees.
#[test]
fn structure_makes_series_end() {
    let source = "
        P {
            coordinates { x; y; phi: angle; }
            lagrangian = dot(x)^2/2 + dot(phi)^2/2 + dot(y)^2/2;
            forces { turning: cos(phi)*d(x); pull: t*d(y); }
        }";
    let jet = program(source).jet;
    let degree = |input: Input| {
        let op = dalembert_codegen::program::Op::Input(input);
        let index = jet.function.ops.iter().position(|other| *other == op);
        index.map(|index| jet.degrees[index])
    };
    assert_eq!(degree(Input::Coordinate(2)), Some(Degree::AtMost(1)));
    assert_eq!(degree(Input::Momentum(2)), Some(Degree::AtMost(0)));
    assert_eq!(degree(Input::Momentum(1)), Some(Degree::AtMost(2)));
    assert_eq!(degree(Input::Momentum(0)), Some(Degree::Endless));
    let constant = |i: usize| jet.recurrences[i] == Recurrence::Constant;
    assert!(
        (0..jet.recurrences.len()).all(|i| constant(i) == (jet.degrees[i] == Degree::AtMost(0)))
    );
}

/// `x = 1/cosh(t)` solves `x'' = x - 2 x^3`.
static SOLITON: Text = Text::new(
    "Soliton {
        coordinates { x; }
        lagrangian = dot(x)^2/2 + x^2/2 - x^4/2;
    }",
);

fn soliton_at(t: f64) -> [f64; 2] {
    let x = 1.0 / t.cosh();
    [x, -x * t.tanh()]
}

/// A run of the soliton from one time of its motion to another.
fn soliton(model: &Model, from: f64, until: f64) -> Course<'_, Model> {
    let [x, v] = soliton_at(from);
    Course::from_state(model, state(model, &[x], &[v]), until).at(from)
}

/// The error after `count` equal steps with series of this order.
fn error(order: usize, count: u32) -> f64 {
    let run = soliton(&SOLITON.model(), -1.0, 1.0)
        .tol(1e3)
        .order(order)
        .step(2.0 / f64::from(count))
        .observed(Integrator::Taylor, &mut ());
    assert_eq!(run.counters.accepted, u64::from(count));
    let pairs = run.state.as_ref().iter().zip(soliton_at(1.0));
    pairs
        .map(|(found, expected)| (found - expected).abs())
        .fold(0.0, larger)
}

#[test]
fn series_converge_at_their_order() {
    for (order, count) in [(4, 40), (7, 20), (10, 12)] {
        let observed = (error(order, count) / error(order, 2 * count)).log2();
        let nominal = order as f64;
        assert!(
            (observed - nominal).abs() <= 0.1 * nominal,
            "{observed} for {nominal}"
        );
    }
}

/// Stored orders with the least work, and stored counters of a run.
#[test]
fn orders_and_work_are_as_stored() {
    let expected = [
        (1e-3, 11, 6),
        (1e-6, 14, 8),
        (1e-9, 17, 10),
        (1e-12, 20, 11),
        (1e-15, 24, 11),
        (1e-18, 26, 13),
    ];
    for (tol, order, steps) in expected {
        let model = SOLITON.model();
        let stepper = Taylor::<Model>::new(Tolerance::new(tol).expect("a tolerance"));
        assert_eq!(stepper.order_for(&model), order, "{tol:e}");
        let run = soliton(&model, 0.0, 5.0)
            .tol(tol)
            .observed(Integrator::Taylor, &mut ());
        let counters = run.counters;
        let error = (run.state.as_ref()[0] - soliton_at(5.0)[0]).abs();
        println!("tol {tol:e}: {counters:?}, error {error:.1e}");
        assert!(error < 200.0 * tol.max(1e-16), "{tol:e}: {error:e}");
        assert_eq!(
            (
                counters.expansions,
                counters.coefficients,
                counters.accepted
            ),
            (steps, steps * order as u64, steps),
            "{tol:e}"
        );
        // The rate is evaluated at the start of the run and at the end of every step.
        assert_eq!(
            (counters.rate_evaluations, counters.rejected),
            (steps + 1, 0),
            "{tol:e}"
        );
    }
}

/// Two bodies at the distance `r` that collide under their attraction, and an oscillator `x` with dry friction, whose
/// force jumps where the velocity changes its sign.
static ROUGH: Text = Text::new(
    "Rough {
        coordinates { r; x; }
        parameters { mu >= 0 = 0.1; }
        lagrangian = dot(r)^2/2 + dot(x)^2/2 + 1/r - x^2/2;
        forces { dry: -mu*dot(x)/abs(dot(x))*d(x); }
    }",
);

/// The coefficients of a series do not show that the force jumps, but the step ends there.
#[test]
fn steps_do_not_pass_over_jumps_of_the_force() {
    let rough = ROUGH.model();
    let end = |tol: f64| {
        let state = state(&rough, &[100.0, 1.0], &[0.0, 0.3]);
        let run = Course::from_state(&rough, state, 2.0)
            .tol(tol)
            .observed(Integrator::Taylor, &mut ());
        assert!(run.counters.rejected > 0);
        (run.state.as_ref()[1], run.counters)
    };
    // On each side of the jump the motion oscillates about -mu or mu.
    let mu: f64 = 0.1;
    let radius = (1.1_f64 * 1.1 + 0.09).sqrt();
    let turn = (0.3_f64 / 1.1).atan();
    let expected = mu + (radius - 2.0 * mu) * (2.0 - turn).cos();
    let (x, counters) = end(1e-12);
    assert!((x - expected).abs() < 1e-9, "{x} for {expected}");
    assert!(counters.accepted < 60, "{counters:?}");
}

#[test]
fn collapse_and_blow_up_are_named_where_they_happen() {
    let rough = ROUGH.with([("mu", 0.0)]);
    let state = state(&rough, &[1.0, 0.5], &[0.0, 0.3]);
    let run = Course::from_state(&rough, state, 2.0).observed(Integrator::Taylor, &mut ());
    assert!(
        matches!(
            run.outcome,
            Outcome::StepUnderflow { .. } | Outcome::NonFinite { .. }
        ),
        "{}",
        run.outcome
    );
    assert!((run.t - 1.110_720_734_539_592).abs() <= 1e-8, "{}", run.t);
    assert!(run.state.is_finite());
}

static OSCILLATOR: Text = Text::new(
    "Oscillator {
        coordinates { x; }
        parameters { k > 0 = 1; }
        lagrangian = dot(x)^2/2 - k*x^2/2;
    }",
);

/// Extreme units of time, near the limits of the exponent range, do not change the steps.
#[test]
fn steps_do_not_depend_on_units_of_time() {
    let steps = |power: i32| {
        let frequency = 2_f64.powi(power);
        let oscillator = OSCILLATOR.with([("k", frequency * frequency)]);
        let state = state(&oscillator, &[1.0], &[frequency]);
        // The scale of a velocity is 1 in any units.
        let run = Course::from_state(&oscillator, state, 10.0 / frequency)
            .tols(1e-12, 1e-300)
            .observed(Integrator::Taylor, &mut ());
        let x = run.state.as_ref()[0];
        assert!((x - 10_f64.cos() - 10_f64.sin()).abs() < 1e-10);
        run.counters.accepted
    };
    assert_eq!(steps(0), steps(400));
    assert_eq!(steps(0), steps(-400));
}

/// Repeated runs agree to the bit, and agree with DOP853 within its errors.
#[test]
fn runs_repeat_and_agree_with_another_method() {
    for system in every_system() {
        let name = system.description().name;
        for state in states(system, 2, 7) {
            let run = |integrator| {
                Course::from_state(system, state, 0.5)
                    .tol(1e-14)
                    .alone()
                    .observed(integrator, &mut ())
            };
            let [one, again, other] =
                [Integrator::Taylor, Integrator::Taylor, Integrator::Dop853].map(run);
            assert_eq!((one.t, one.state), (again.t, again.state), "{name}");
            assert_eq!(one.outcome, other.outcome, "{name}");
            let (one, other) = (one.state.as_ref(), other.state.as_ref());
            let size = one.iter().fold(1.0_f64, |a, b| larger(a, b.abs()));
            for (a, b) in one.iter().zip(other) {
                assert!((a - b).abs() < 1e-11 * size, "{name}: {a} and {b}");
            }
        }
    }
}
