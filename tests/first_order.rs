//! First-order systems: `field` in place of a Lagrangian.

use dalembert::{
    Described, Dla2, Dop853, DormandPrince5, Fault, Gauss4, Gauss6, Impacting, Outcome, Rk4, Scene,
    Simulation, StateVector, Stepper, System, Taylor, Tolerance, VectorField,
};

use dalembert_cli::{Exit, models};
use dalembert_codegen::compile;
use dalembert_codegen::program::{Form, Function, Input, interpret::interpret};
use dalembert_models::DimensionlessWalker;
use dalembert_tests::command::{self, Finished};
use serde_json::Value;

dalembert::model! {
    /// A rotor that is driven and damped: `x' = -x/tau + cos(t)`, `phi' = omega`.
    pub Driven {
        coordinates { x; phi: angle; }
        parameters { tau > 0 = 1/2; omega = 3; }
        field { dot(x) = -x/tau + cos(t); dot(phi) = omega + sin(phi)/10; }
        initial { x = 1; phi = 1/4; until = 3; }
        outputs { speed: dot(phi); }
    }
}

dalembert::model! {
    /// Predator and prey; the first integral is that of Volterra.
    pub Prey {
        coordinates { x in (0, 1000); y in (0, 1000); }
        parameters { a > 0 = 2/3; b > 0 = 4/3; c > 0 = 1; k > 0 = 1; }
        field { dot(x) = a*x - b*x*y; dot(y) = k*x*y - c*y; }
        initial { x = 1; y = 1/2; until = 20; }
        claims {
            conserved: k*x - c*ln(x) + b*y - a*ln(y);
            not conserved: x + y;
        }
    }
}

dalembert::model! {
    /// A counter that starts again at 1, and a clock of how often.
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

/// The state at the end of a run by an integrator.
fn run<Step: Stepper<Driven>>(system: &Driven, stepper: Step) -> [f64; 2] {
    let start = system.state(0.0, &[1.0, 0.25].into(), &[0.0; 2].into());
    let mut simulation = Simulation::new(system, stepper, ());
    let run = simulation.run(0.0, start.expect("a state"), 3.0, &mut ());
    let run = run.expect("a start");
    assert_eq!(run.outcome, Outcome::Done);
    run.state.into()
}

#[test]
fn integrators_follow_the_field() {
    let system = Driven::default();
    let tolerance = Tolerance::new(1e-12).expect("a tolerance");
    // x = A exp(-t/tau) + (tau cos t + tau^2 sin t)/(1 + tau^2), and tan((phi)/2) in closed form for constant rates.
    let (t, tau) = (3.0_f64, 0.5_f64);
    let steady = |t: f64| (tau * t.cos() + tau * tau * t.sin()) / (1.0 + tau * tau);
    let x = (1.0 - steady(0.0)) * (-t / tau).exp() + steady(t);
    // With u = tan(phi/2): u' = (omega (1 + u^2) + u/5)/2.
    let (omega, half) = (3.0_f64, 0.1_f64);
    let root = (omega * omega - half * half).sqrt();
    let angle = |u: f64| ((omega * u + half) / root).atan();
    let turned = angle((0.125_f64).tan()) + 0.5 * root * t;
    let turns = (turned / core::f64::consts::PI + 0.5).floor();
    let phi = 2.0 * (((root * turned.tan() - half) / omega).atan() + turns * core::f64::consts::PI);
    let close = |[own_x, own_phi]: [f64; 2], error: f64, name: &str| {
        assert!((own_x - x).abs() <= error, "{name}: x {own_x} for {x}");
        assert!(
            (own_phi - phi).abs() <= error,
            "{name}: phi {own_phi} for {phi}"
        );
    };
    close(run(&system, Taylor::new(tolerance)), 1e-11, "taylor");
    close(run(&system, Dop853::new(tolerance)), 1e-11, "dop853");
    close(
        run(&system, DormandPrince5::new(tolerance)),
        1e-10,
        "dopri5",
    );
    let step = 1e-3;
    close(
        run(&system, Gauss6::new(tolerance).with_step(step)),
        1e-11,
        "gauss6",
    );
    close(
        run(&system, Gauss4::new(tolerance).with_step(step)),
        1e-10,
        "gauss4",
    );
    close(
        run(&system, Rk4::new(tolerance).with_step(step)),
        1e-10,
        "rk4",
    );
}

#[test]
fn the_state_is_the_position() {
    let system = Driven::default();
    let state = system
        .state(0.0, &[1.0, 0.25].into(), &[7.0; 2].into())
        .expect("a state");
    assert_eq!(state.as_slice(), [1.0, 0.25]);
    let mut rate = state;
    system.rate(0.5, &state, &mut rate).expect("a rate");
    let expected = [-2.0 + 0.5_f64.cos(), 3.0 + 0.25_f64.sin() / 10.0];
    for (own, expected) in rate.as_slice().iter().zip(expected) {
        assert!((own - expected).abs() <= 4.0 * f64::EPSILON);
    }
    assert_eq!(system.velocity(0.5, &state), Ok(rate));
}

/// Emitted rates, gaps and resets are what the interpreter computes, to the bit.
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
        let own = [jump.position.as_slice(), jump.velocity.as_slice()].concat();
        assert_eq!(after, own);
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
    let system = Driven::default();
    let state = [1.0, 0.25].into();
    assert_eq!(system.energy(0.0, &state), Err(Fault::FirstOrder));
    assert_eq!(system.momentum(0.0, &state), Err(Fault::FirstOrder));
    assert_eq!(
        system.state_from_momenta(0.0, &state, &state),
        Err(Fault::FirstOrder)
    );
    let tolerance = Tolerance::new(1e-8).expect("a tolerance");
    let stepper = Dla2::new(tolerance).with_step(1e-2);
    let run = Simulation::new(&system, stepper, ()).run(0.0, state, 1.0, &mut ());
    assert_eq!(run.expect("a start").outcome, Outcome::FirstOrder);
}

#[test]
fn resets_act_on_positions() {
    let system = Sawtooth::default();
    let tolerance = Tolerance::new(1e-10).expect("a tolerance");
    let start = [0.0, 0.0, 0.0].into();
    let mut taylor = Simulation::new(&system, Taylor::new(tolerance), system.effects());
    let run = taylor.run(0.0, start, 2.5, &mut ()).expect("a start");
    assert_eq!((run.outcome, run.counters.impacts), (Outcome::Done, 2));
    let expected = [0.5, 2.5 / 3.0, 2.0];
    for (own, expected) in run.state.as_slice().iter().zip(expected) {
        assert!((own - expected).abs() <= 1e-14, "{own} for {expected}");
    }
    let free = sawtooth::Free(system);
    let mut dop853 = Simulation::new(&free, Dop853::new(tolerance), ());
    let run = dop853.run(0.0, start, 2.5, &mut ()).expect("a start");
    assert_eq!((run.outcome, run.counters.impacts), (Outcome::Done, 0));
    assert!((run.state[0] - 2.5).abs() <= 1e-14);
}

#[test]
fn integrals_are_kept() {
    let system = Prey::default();
    let integral = |[x, y]: [f64; 2]| x - x.ln() + 4.0 / 3.0 * y - 2.0 / 3.0 * y.ln();
    let tolerance = Tolerance::new(1e-12).expect("a tolerance");
    let start = [1.0, 0.5];
    let mut simulation = Simulation::new(&system, Taylor::new(tolerance), ());
    let run = simulation
        .run(0.0, start.into(), 20.0, &mut ())
        .expect("a start");
    assert_eq!(run.outcome, Outcome::Done);
    let drift = integral(run.state.into()) - integral(start);
    assert!(drift.abs() <= 1e-11, "{drift:e}");
}

/// The command line over these models, with an input: exit, output, errors.
fn command(line: &str, given: &str) -> Finished {
    command::line(models![Driven, Prey, Sawtooth], line, given)
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
