//! First-order systems: `field` in place of a Lagrangian.

use dalembert::{Described, Fault, Impacting, Outcome, StateVector, System, VectorField};
use dalembert_cli::suite::Setting;
use dalembert_cli::{Exit, Integrator};
use dalembert_codegen::compile;
use dalembert_codegen::program::{Form, Function, Input, interpret::interpret};
use dalembert_models::DimensionlessWalker;
use dalembert_stability::course::{Course, is_discrete, state, vector};
use dalembert_stability::text::Text;
use dalembert_tests::command::{self, Finished};
use serde_json::Value;

/// A driven and damped coordinate, `x' = -x/tau + cos(t)`, and a rotor, `phi' = omega + sin(phi)/10`.
static DRIVEN: Text = Text::new(
    "Driven {
        coordinates { x; phi: angle; }
        parameters { tau > 0 = 1/2; omega = 3; }
        field { dot(x) = -x/tau + cos(t); dot(phi) = omega + sin(phi)/10; }
        initial { x = 1; phi = 1/4; until = 3; }
        outputs { speed: dot(phi); }
    }",
);

/// Predator and prey, with Volterra's first integral.
static PREY: Text = Text::new(
    "Prey {
        coordinates { x in (0, 1000); y in (0, 1000); }
        parameters { a > 0 = 2/3; b > 0 = 4/3; c > 0 = 1; k > 0 = 1; }
        field { dot(x) = a*x - b*x*y; dot(y) = k*x*y - c*y; }
        initial { x = 1; y = 1/2; until = 20; }
        claims {
            conserved: k*x - c*ln(x) + b*y - a*ln(y);
            not conserved: x + y;
        }
    }",
);

dalembert::model! {
    /// Two coordinates that grow, and a counter. When the first coordinate reaches 1, it restarts at 0 and is counted.
    pub Sawtooth {
        const N = 2;
        coordinates { s[N]; turns; }
        parameters { rate[N] = [1, 1/3]; }
        field { dot(s[i in 1..=N]) = rate[i]; dot(turns) = 0; }
        impacts { full: 1 - s[1] >= 0 => reset { s[1] = s[1] - 1; turns = turns + 1; }; }
        initial { until = 5/2; }
        claims { conserved under full: s[1] + turns; conserved: turns; }
        scenes { free; }
    }
}

static SAWTOOTH: Text = Text::new(Sawtooth::DESCRIPTION.source.value());

#[test]
fn integrators_follow_the_field() {
    let system = DRIVEN.model();
    // x = A exp(-t/tau) + (tau cos t + tau^2 sin t)/(1 + tau^2), and tan(phi/2) has a closed form.
    let (t, tau) = (3.0_f64, 0.5_f64);
    let steady = |t: f64| (tau * t.cos() + tau * tau * t.sin()) / (1.0 + tau * tau);
    let x = (1.0 - steady(0.0)) * (-t / tau).exp() + steady(t);
    // u = tan(phi/2) satisfies u' = (omega (1 + u^2) + u/5)/2.
    let (omega, half) = (3.0_f64, 0.1_f64);
    let root = (omega * omega - half * half).sqrt();
    let angle = |u: f64| ((omega * u + half) / root).atan();
    let turned = angle((0.125_f64).tan()) + 0.5 * root * t;
    let turns = (turned / core::f64::consts::PI + 0.5).floor();
    let phi = 2.0 * (((root * turned.tan() - half) / omega).atan() + turns * core::f64::consts::PI);
    for &integrator in Integrator::every() {
        if is_discrete(integrator) {
            continue;
        }
        let mut course = Course::new(&system, &[1.0, 0.25], &[0.0; 2], 3.0);
        if !integrator.is_adaptive() {
            course = course.step(1e-3);
        }
        let run = course.observed(integrator, &mut ());
        let name = integrator.name();
        assert_eq!(run.outcome, Outcome::Done, "{name}");
        let is_high = integrator.order().is_none_or(|order| order > 5);
        let error = if is_high { 1e-11 } else { 1e-10 };
        for (found, expected) in run.state.as_slice().iter().zip([x, phi]) {
            assert!(
                (found - expected).abs() <= error,
                "{name}: {found} for {expected}"
            );
        }
    }
}

#[test]
fn the_state_is_the_position() {
    let system = DRIVEN.model();
    let state = state(&system, &[1.0, 0.25], &[7.0; 2]);
    assert_eq!(state.as_slice(), [1.0, 0.25]);
    let mut rate = state;
    system.rate(0.5, &state, &mut rate).expect("a rate");
    let expected = [-2.0 + 0.5_f64.cos(), 3.0 + 0.25_f64.sin() / 10.0];
    for (found, expected) in rate.as_slice().iter().zip(expected) {
        assert!((found - expected).abs() <= 4.0 * f64::EPSILON);
    }
    assert_eq!(system.velocity(0.5, &state), Ok(rate));
}

/// Emitted rates, gaps and resets equal those of the interpreter, to the bit.
fn assert_emitted_is_interpreted<S>(system: &S, state: S::State)
where
    S: Described + Impacting,
{
    let compiled = compile(S::DESCRIPTION.source.parse().expect("tokens")).expect("a model");
    let program = &compiled.programs.main;
    assert_eq!(program.form, Form::FirstOrder);
    let t = 0.75;
    let input = |input: Input| match input {
        Input::Time => t,
        Input::Coordinate(i) => state.as_slice()[i],
        Input::Parameter(k) => system.parameter(k),
        other => panic!("{other:?} of a first-order system"),
    };
    let interpreted = |function: &Function| interpret(function, &input).expect("values");
    let mut rate = state;
    system.rate(t, &state, &mut rate).expect("a rate");
    assert_eq!(interpreted(&program.rate), rate.as_slice());
    let functions = program.impacting.as_ref().expect("surfaces");
    assert_eq!(
        interpreted(&functions.gaps),
        system.gaps(t, &state).as_slice()
    );
    let rates = system.gap_rates(t, &state).expect("gap rates");
    assert_eq!(interpreted(&functions.gap_rates), rates.as_slice());
    for (s, reset) in functions.resets.iter().enumerate() {
        let after = interpreted(reset.as_ref().expect("a reset"));
        let jump = system
            .reset(s, t, &state)
            .expect("values")
            .expect("a reset");
        let expected = [jump.position.as_slice(), jump.velocity.as_slice()].concat();
        assert_eq!(after, expected);
    }
}

#[test]
fn what_is_emitted_is_what_was_lowered() {
    assert_emitted_is_interpreted(&Sawtooth::default(), [0.3, 0.2, 4.0].into());
    let walker = DimensionlessWalker::default();
    assert_emitted_is_interpreted(&walker, [0.3, -0.7, 1.1].into());
}

#[test]
fn mechanics_is_refused() {
    let system = DRIVEN.model();
    let state = vector(&[1.0, 0.25]);
    assert_eq!(system.energy(0.0, &state), Err(Fault::FirstOrder));
    assert_eq!(system.momentum(0.0, &state), Err(Fault::FirstOrder));
    assert_eq!(
        system.state_from_momenta(0.0, &state, &state),
        Err(Fault::FirstOrder)
    );
    for integrator in [Integrator::Dla2, Integrator::Dla4] {
        let run = Course::from_state(&system, state, 1.0)
            .tol(1e-8)
            .step(1e-2)
            .observed(integrator, &mut ());
        assert_eq!(run.outcome, Outcome::FirstOrder);
    }
}

#[test]
fn resets_act_on_positions() {
    let system = SAWTOOTH.model();
    let start = [0.0, 0.0, 0.0];
    let run = Course::new(&system, &start, &start, 2.5)
        .tol(1e-10)
        .observed(Integrator::Taylor, &mut ());
    assert_eq!((run.outcome, run.counters.impacts), (Outcome::Done, 2));
    let expected = [0.5, 2.5 / 3.0, 2.0];
    for (found, expected) in run.state.as_slice().iter().zip(expected) {
        assert!((found - expected).abs() <= 1e-14, "{found} for {expected}");
    }
    let free = SAWTOOTH.scene("free");
    let run = Course::new(&free, &start, &start, 2.5)
        .tol(1e-10)
        .observed(Integrator::Dop853, &mut ());
    assert_eq!((run.outcome, run.counters.impacts), (Outcome::Done, 0));
    assert!((run.state.as_slice()[0] - 2.5).abs() <= 1e-14);
}

#[test]
fn integrals_are_kept() {
    let system = PREY.model();
    let integral =
        |place: &[f64]| place[0] - place[0].ln() + 4.0 / 3.0 * place[1] - 2.0 / 3.0 * place[1].ln();
    let start = [1.0, 0.5];
    let run = Course::new(&system, &start, &[0.0; 2], 20.0).observed(Integrator::Taylor, &mut ());
    assert_eq!(run.outcome, Outcome::Done);
    let drift = integral(run.state.as_slice()) - integral(&start);
    assert!(drift.abs() <= 1e-11, "{drift:e}");
}

/// Runs a command line over these models with this standard input.
fn command(line: &str, given: &str) -> Finished {
    let models = [DRIVEN.entry(), PREY.entry(), SAWTOOTH.entry()];
    command::line(models.to_vec(), line, given)
}

#[test]
fn the_command_line_shows_no_mechanics() {
    let Finished {
        exit,
        output,
        errors,
    } = command("simulate driven --csv -", "");
    assert_eq!(exit, Exit::Reached, "{errors}");
    let header = output.lines().next().expect("a header");
    assert_eq!(header, "t,x,phi,x_dot,phi_dot,speed,event");
    let Finished { exit, errors, .. } = command("simulate driven", "");
    assert_eq!(exit, Exit::Reached);
    assert!(!errors.contains("energy"), "{errors}");
    let Finished {
        exit,
        output,
        errors,
    } = command("simulate sawtooth --json -", "");
    assert_eq!(exit, Exit::Reached, "{errors}");
    let run: Value = serde_json::from_str(&output).expect("JSON");
    assert_eq!(run["events"][0]["energy"], Value::Null);
    let first = run["events"][0]["t"].as_f64().expect("a time");
    assert!((first - 1.0).abs() <= 2.0 * f64::EPSILON, "{first}");
    let Finished {
        exit,
        output,
        errors,
    } = command("derive prey", "");
    assert_eq!(exit, Exit::Reached, "{errors}");
    assert!(
        output.contains("dot(x) = ") && !output.contains("Lagrangian"),
        "{output}"
    );
}

#[test]
fn states_of_the_command_line_are_positions() {
    let Finished {
        exit,
        output,
        errors,
    } = command("eval sawtooth", r#"[{"q": [1, 0.5, 3], "t": 2}]"#);
    assert_eq!(exit, Exit::Reached, "{errors}");
    let states: Value = serde_json::from_str(&output).expect("JSON");
    assert_eq!(states[0]["qdot"], serde_json::json!([1.0, 1.0 / 3.0, 0.0]));
    assert_eq!(states[0]["p"], Value::Null);
    let full = &states[0]["impacts"]["full"];
    assert_eq!(
        (&full["gap"], &full["gap_rate"]),
        (&Value::from(0.0), &Value::from(-1.0))
    );
    assert_eq!(
        full["laws"]["reset"]["q_plus"],
        serde_json::json!([0.0, 0.5, 4.0])
    );
    let refused = [
        (
            "simulate driven --q 1,2 --qdot 1,2",
            "a first-order system has rates that follow from --q alone",
        ),
        (
            "simulate driven --initial x_dot=1",
            "unknown coordinate or velocity `x_dot`",
        ),
        (
            "simulate driven --axes t,energy --plot x.svg",
            "unknown quantity `energy`",
        ),
    ];
    for (line, message) in refused {
        let Finished { exit, errors, .. } = command(line, "");
        assert_eq!(exit, Exit::Refused, "{line}: {errors}");
        assert!(errors.contains(message), "{line}: {errors}");
    }
    let Finished { exit, errors, .. } =
        command("eval driven", r#"[{"q": [1, 0.5], "qdot": [1, 0.5]}]"#);
    assert!(
        exit == Exit::Refused && errors.contains("unknown key `qdot`"),
        "{errors}"
    );
}

/// A motion reaches `x = 0`, where its rate has an infinite slope, at `t = 1`.
#[test]
fn a_motion_to_an_infinite_slope_ends_soon() {
    static SINK: Text =
        Text::new("Sink { coordinates { x; } field { dot(x) = -sqrt(abs(x) + x); } }");
    let sink = SINK.model();
    for &integrator in Integrator::every().iter().filter(|it| !is_discrete(**it)) {
        let course = Course::new(&sink, &[0.5], &[0.0], 5.0)
            .tol(1e-10)
            .step(1e-2);
        let end = course.run(Setting::free(integrator));
        let case = format!("{}: {:?}", integrator.name(), end.outcome);
        let evaluations = end.counters.rate_evaluations;
        assert!(evaluations < 1_000_000, "{case} after {evaluations}");
        assert!(end.q[0].abs() < 1e-6, "{case}: {}", end.q[0]);
    }
}
