//! Inputs that the caller supplies, and the work of forces along a run.

use dalembert::impacts::Impacts;
use dalembert::integrate::Chosen;
use dalembert::projection::Projection;
use dalembert::{
    Actuated, Described, Dop853, Effect, EventLog, Gauss6, Instance, Observer, Outcome, Powered,
    Run, Simulation, Steered, Stepper, System, Tolerance, VectorField, Work,
};
use dalembert_cli::{Exit, Integrator};
use dalembert_codegen::compile;
use dalembert_stability::course::Course;
use dalembert_stability::text::{Model, Text};
use dalembert_tests::command::{self, Finished};
use dalembert_tests::interpreted::compare_motion;
use dalembert_tests::numeric::assert_near;

dalembert::model! {
    /// A cart on a spring with a damper, pushed by a motor.
    pub Cart {
        coordinates { x; }
        parameters { m > 0 = 2; k > 0 = 3; c >= 0 = 1/4; }
        inputs {
            /// The force of the motor.
            u;
        }
        let push = u*(1 + x^2/10);
        lagrangian = m/2*dot(x)^2 - k/2*x^2;
        forces { drag: -c*dot(x)*d(x); motor: push*d(x); }
        impacts { wall: x <= 3/4; }
        outputs { force: push; }
        claims { not conserved: energy; }
        scenes { free: motor; }
    }
}

dalembert::model! {
    /// A sleigh on a moving belt, steered and pushed, with a Lagrangian that depends on time.
    #[global]
    pub Tug {
        coordinates { x; y; theta: angle; }
        parameters { m > 0 = 2; I > 0 = 1/2; belt = 1/3; c = 1/5; }
        inputs { thrust[2]; steer; }
        lagrangian = m/2*(dot(x)^2 + dot(y)^2) + I*(1 + t/10)/2*dot(theta)^2 - sin(t)*x/4;
        constraints { blade: sin(theta)*d(x) - cos(theta)*d(y) + belt*d(t) = 0; }
        forces {
            push: thrust[1]*cos(theta)*d(x) + thrust[2]*sin(theta)*d(y);
            rudder: steer*d(theta);
            drag: -c*(dot(x)*d(x) + dot(y)*d(y));
        }
    }
}

dalembert::model! {
    /// A leaking tank with an inflow.
    pub Tank {
        coordinates { level; }
        parameters { leak > 0 = 1/2; }
        inputs { inflow; }
        field { dot(level) = inflow - leak*level; }
    }
}

fn tolerance() -> Tolerance {
    Tolerance::new(1e-13).expect("a tolerance")
}

/// The cart, loaded from its text.
static CART: Text = Text::new(Cart::DESCRIPTION.source.value());

type State = <Cart as VectorField>::State;

/// Type of all input functions of the cart, so that its runs are compiled once.
type Steering = fn(f64, &State) -> [f64; 1];

/// Effects of a cart without walls.
const NO_WALLS: Option<Impacts<Steered<Cart, Steering>>> = None;

/// A run that is compiled once for all integrators and observers.
fn run<S: System>(
    system: &S,
    stepper: &mut impl Stepper<S>,
    effects: impl Effect<S>,
    (start, until): (S::State, f64),
    mut observer: &mut dyn Observer<S>,
) -> Run<S::State> {
    Simulation::new(system, Chosen::new(stepper), effects)
        .run(0.0, start, until, &mut observer)
        .expect("a run")
}

/// A run of a system without impacts.
fn steered<S: System>(system: &S, start: S::State, until: f64) -> Run<S::State> {
    run(
        system,
        &mut Dop853::new(tolerance()),
        (),
        (start, until),
        &mut (),
    )
}

/// The loaded cart with this input and without damping.
fn held(u: f64) -> Model {
    let mut cart = CART.with([("c", 0.0)]);
    // The index of an input follows those of the parameters.
    cart.set_parameter(Cart::DESCRIPTION.parameters.len(), u);
    cart
}

fn at_rest(cart: &Cart, x: f64) -> State {
    cart.state(0.0, &[x].into(), &[0.0].into())
        .expect("a state")
}

#[test]
fn an_input_is_held_at_zero_until_it_is_set() {
    let cart = Cart::default();
    assert_eq!((cart.u, Cart::INPUTS), (0.0, &["u"][..]));
    assert_eq!(Cart::DESCRIPTION.parameters.len(), 3);
    let pushed = Cart { u: 1.5, ..cart };
    let (mut free, mut driven) = (at_rest(&cart, 0.5), at_rest(&cart, 0.5));
    cart.rate(0.0, &at_rest(&cart, 0.5), &mut free)
        .expect("a rate");
    pushed
        .rate(0.0, &at_rest(&cart, 0.5), &mut driven)
        .expect("a rate");
    assert_near("force", &[driven[1] - free[1]], &[1.5 * 1.025], 1e-15);
}

/// With `u = sin(w t)/(1 + x^2/10)` the cart is a linear oscillator with a closed form.
#[test]
fn inputs_are_functions_of_time_and_state() {
    const W: f64 = 0.7;
    let cart = Cart {
        c: 0.0,
        ..Cart::default()
    };
    let steering: Steering = |t, state| [(W * t).sin() / (1.0 + state[0] * state[0] / 10.0)];
    let steered = cart.with_inputs(steering);
    let natural = (cart.k / cart.m).sqrt();
    let size = 1.0 / (cart.k - cart.m * W * W);
    let position = |t: f64| size * ((W * t).sin() - W / natural * (natural * t).sin());
    let start = (at_rest(&cart, 0.0), 7.0);
    let mut steps = Dop853::new(tolerance());
    let end = run(&steered, &mut steps, NO_WALLS, start, &mut ());
    assert_near("x", &[end.state[0]], &[position(7.0)], 1e-12);
    let mut steps = Gauss6::new(tolerance());
    let end = run(&steered, &mut steps, NO_WALLS, start, &mut ());
    assert_near("x", &[end.state[0]], &[position(7.0)], 1e-8);
}

#[test]
fn a_held_input_is_a_constant_for_every_integrator() {
    let cart = Cart {
        u: -3.0,
        c: 0.0,
        ..Cart::default()
    };
    let steering: Steering = |_, _| [1.0];
    let mut steps = Dop853::new(tolerance());
    let start = (at_rest(&cart, 0.1), 3.0);
    let steered = run(
        &cart.with_inputs(steering),
        &mut steps,
        NO_WALLS,
        start,
        &mut (),
    );
    let loaded = held(1.0);
    for &integrator in Integrator::every() {
        let course = Course::new(&loaded, &[0.1], &[0.0], 3.0).tol(1e-13).alone();
        let course = match integrator.is_adaptive() {
            true => course,
            false => course.step(1e-3),
        };
        let run = course.observed(integrator, &mut ());
        assert_eq!(run.outcome, Outcome::Done, "{integrator:?}");
        // `Dla2` has order 2 and larger errors.
        let bound = match integrator {
            Integrator::Dla2 => 1e-6,
            _ => 1e-12,
        };
        let (found, expected) = (run.state.as_ref(), steered.state.as_slice());
        assert_near(integrator.name(), found, expected, bound);
    }
}

#[test]
fn the_energy_between_impacts_is_the_work_by_cause() {
    let cart = Cart::default();
    assert_eq!(Cart::POWERS, ["drag", "motor"]);
    let start = cart
        .state(0.0, &[0.7].into(), &[1.0].into())
        .expect("a state");
    let steering: Steering = |t, state| [(2.0 * t).cos() - state[1] / 4.0];
    let steered = cart.with_inputs(steering);
    let mut watch = (Work::of(&steered), EventLog::<_, 64>::new());
    let walls = Some(Impacts::declared(&steered));
    let mut steps = Dop853::new(tolerance());
    let run = run(&steered, &mut steps, walls, (start, 20.0), &mut watch);
    assert_eq!(run.outcome, Outcome::Done);
    assert!(run.counters.impacts >= 1);
    let energy = |state| cart.energy(0.0, state).expect("an energy");
    let gained = energy(&run.state) - energy(&start);
    let (work, _) = &watch;
    assert!(
        work.fault().is_none() && work.done()[0] < -0.1,
        "{:?}",
        work.done()
    );
    assert_near("balance", &[gained], &[work.total()], 1e-11);
}

#[test]
fn constraints_and_time_do_work_too() {
    let tug = Tug::default();
    let expected = ["push", "rudder", "drag", "constraints", "time"];
    assert_eq!(
        (Tug::POWERS, Tug::INPUTS),
        (&expected[..], &["thrust.1", "thrust.2", "steer"][..])
    );
    let q = [0.1, -0.2, 0.4].into();
    let start = tug
        .state_projected(0.0, &q, &[0.6, 0.1, 0.3].into())
        .expect("a state");
    let steered =
        tug.with_inputs(|t, state| [t.sin(), 0.5 - state[1] / 9.0, (3.0 * t).cos() / 4.0]);
    let mut work = Work::of(&steered);
    let mut steps = Dop853::new(tolerance());
    let run = self::run(&steered, &mut steps, (), (start, 5.0), &mut work);
    let energy = |t, state| tug.energy(t, state).expect("an energy");
    let gained = energy(5.0, &run.state) - energy(0.0, &start);
    assert!(
        work.done().iter().all(|part| part.abs() > 1e-3),
        "{:?}",
        work.done()
    );
    assert_near("balance", &[gained], &[work.total()], 1e-11);
    let global = tug.global().expect("the global form");
    let qdot = tug.velocity(0.0, &start).expect("a velocity");
    let start = global.state(0.0, &q, &qdot).expect("a state");
    let steered =
        global.with_inputs(|t, state| [t.sin(), 0.5 - state[1] / 9.0, (3.0 * t).cos() / 4.0]);
    let mut both = Work::of(&steered);
    let mut steps = Dop853::new(tolerance());
    let projection = (Projection::new(),);
    self::run(&steered, &mut steps, projection, (start, 5.0), &mut both);
    assert_near(
        "forms",
        both.done().as_slice(),
        work.done().as_slice(),
        1e-10,
    );
}

#[test]
fn a_field_and_a_scene_take_inputs() {
    let tank = Tank::default().with_inputs(|t, state| [1.0 + t - state[0] / 2.0]);
    let run = steered(&tank, [0.0].into(), 3.0);
    // The level satisfies `ydot = 1 + t - y`, with the solution `y = t`.
    assert_near("level", run.state.as_slice(), &[3.0], 1e-12);
    let free = cart::Free(Cart {
        u: 1.0,
        k: 1e-300,
        ..Cart::default()
    });
    let pushed = free.with_inputs(|_, state| [2.0 / (1.0 + state[0] * state[0] / 10.0)]);
    let start = free
        .state(0.0, &[0.0].into(), &[0.0].into())
        .expect("a state");
    let run = steered(&pushed, start, 2.0);
    assert_near("x", &[run.state[0]], &[2.0], 1e-12);
}

#[test]
fn emitted_code_is_what_the_interpreter_executes_with_inputs() {
    let cart = Cart {
        u: 0.3,
        ..Cart::default()
    };
    let compiled = compile(Cart::DESCRIPTION.source.parse().expect("tokens")).expect("a model");
    assert!(compare_motion(&cart, &compiled.programs.main) > 0);
}

/// Runs the command line over the models of this file.
fn command(arguments: &[&str], input: &str) -> Finished {
    command::run(vec![CART.entry()], arguments, input)
}

#[test]
fn the_command_line_holds_inputs() {
    let run = |input: &str| {
        let arguments = [
            "simulate", "cart", "--until", "1", "--json", "-", "--set", "c=0", "--input", input,
        ];
        command(&arguments, "")
    };
    let Finished {
        exit,
        output,
        errors,
    } = run("u=0.5");
    assert_eq!(exit, Exit::Reached, "{errors}");
    let document: serde_json::Value = serde_json::from_str(&output).expect("JSON");
    assert_eq!(document["inputs"], serde_json::json!({ "u": 0.5 }));
    let samples = document["samples"].as_array().expect("samples");
    let last = &samples.last().expect("a sample")["q"][0];
    let cart = held(0.5);
    let expected = Course::new(&cart, &[0.0], &[0.0], 1.0)
        .tol(1e-13)
        .alone()
        .observed(Integrator::Dop853, &mut ());
    assert_near(
        "x",
        &[last.as_f64().expect("a number")],
        &expected.state.as_ref()[..1],
        1e-8,
    );
    for (input, expected) in [
        ("u=sin(t)", "a constant number, such as 0.5"),
        ("v=1", "unknown input"),
        ("u", "--input"),
    ] {
        let Finished { exit, errors, .. } = run(input);
        assert_eq!(exit, Exit::Refused, "{input}");
        assert!(errors.contains(expected), "{input}: {errors}");
    }
    let Finished { exit, errors, .. } = command(
        &["ensemble", "cart", "--vary", "k=1:2:3", "--input", "u=1"],
        "",
    );
    assert_eq!(exit, Exit::Refused);
    assert!(
        errors.contains("an ensemble leaves inputs at 0"),
        "{errors}"
    );
}

#[test]
fn states_to_evaluate_have_inputs() {
    let given = r#"[{"q": [0.5], "qdot": [0], "inputs": [2]}, {"q": [0.5], "qdot": [0]}]"#;
    let Finished {
        exit,
        output,
        errors,
    } = command(&["eval", "cart"], given);
    assert_eq!(exit, Exit::Reached, "{errors}");
    let rows: serde_json::Value = serde_json::from_str(&output).expect("JSON");
    let force = |row: usize| rows[row]["pdot"][0].as_f64().expect("a number");
    assert_near(
        "force",
        &[force(0), force(1)],
        &[2.0 * 1.025 - 1.5, -1.5],
        1e-14,
    );
    let given = r#"[{"q": [0.5], "qdot": [0], "inputs": [2, 3]}]"#;
    let Finished { exit, errors, .. } = command(&["eval", "cart"], given);
    assert!(
        exit == Exit::Refused && errors.contains("inputs"),
        "{errors}"
    );
}

/// The messages of a refused model.
fn refused(declarations: &str) -> String {
    let model = format!("P {{ coordinates {{ x; y; }} inputs {{ u; }} {declarations} }}");
    let errors = compile(model.parse().expect("tokens")).expect_err("a refusal");
    errors
        .iter()
        .map(|error| error.message().to_owned())
        .collect()
}

#[test]
fn inputs_act_in_forces_and_rates_alone() {
    let acts = "an input acts in `forces`, and in the rates of a `field`";
    let natural = "lagrangian = dot(x)^2/2 + dot(y)^2/2;";
    for declarations in [
        "lagrangian = dot(x)^2/2 + dot(y)^2/2 - u*x;".to_owned(),
        format!("{natural} constraints {{ c: dot(x) = u; }}"),
        format!("{natural} constraints {{ c: d(x) - u*d(y) = 0; }}"),
        format!("{natural} impacts {{ w: x >= u; }}"),
        format!("{natural} impacts {{ w: x >= 0 when u > 0; }}"),
        format!("{natural} impacts {{ w: x >= 0 => reset {{ dot(x) = u; }}; }}"),
        format!("{natural} frame {{ a: d(x) + u*d(y); b: d(y); }}"),
        format!("{natural} forces {{ f: u*d(x); }} claims {{ conserved: u + y; }}"),
        format!("{natural} let hidden = 2*u; constraints {{ c: dot(x) = hidden; }}"),
    ] {
        let text = refused(&declarations);
        assert!(text.contains(acts), "{declarations}: {text}");
    }
    let text = refused(&format!("{natural} initial {{ x = u; }}"));
    assert!(
        text.contains("an initial value depends on parameters only"),
        "{text}"
    );
    let text = refused(&format!("{natural} claims {{ density: exact; }}"));
    assert!(text.contains("`u` may depend on the state"), "{text}");
    let push = "forces { push: u*d(x); }";
    let text = refused(&format!("{natural} {push} scenes {{ a: push, volume; }}"));
    assert!(text.contains("no volume is known with inputs"), "{text}");
}

dalembert::model! {
    /// A particle that an input drives in proportion to its velocity.
    pub Pumped {
        coordinates { x; y; }
        inputs { u; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2;
        forces { motor: u*dot(x)*d(x); }
    }
}

#[test]
fn the_divergence_beside_inputs_is_that_of_held_ones() {
    let mut pumped = Pumped::default();
    let state = pumped
        .state(0.0, &[0.1, 0.2].into(), &[0.3, 0.4].into())
        .expect("a state");
    for u in [0.0, 3.0, -1.5] {
        pumped.u = u;
        let divergence = dalembert::contract::Divergence::divergence(&pumped, 0.0, &state);
        assert_eq!(divergence, Ok(u));
    }
}

/// In a scene without the motor, nothing depends on its input.
#[test]
fn scenes_without_an_input_have_densities() {
    let model = |scene: &str, claim: &str| {
        format!(
            "P {{ coordinates {{ x; y; }} inputs {{ u; }} lagrangian = dot(x)^2/2 + dot(y)^2/2;
             forces {{ motor: u*dot(x)*d(x); drag: -dot(y)*d(y); }}
             scenes {{ {scene}; }} claims for a {{ {claim} }} }}"
        )
    };
    let compile = |scene: &str, claim: &str| compile(model(scene, claim).parse().expect("tokens"));
    assert!(compile("a", "density: exact;").is_ok());
    assert!(compile("a: volume", "density: exact;").is_ok());
    assert!(compile("a: drag", "density: none;").is_ok());
    assert!(compile("a: motor", "density: exact;").is_err());
    assert!(compile("a: motor, volume", "conserved: dot(y);").is_err());
}

#[test]
fn what_holds_for_all_inputs_is_proved() {
    let model = |claim: &str| {
        format!(
            "P {{ coordinates {{ x; y; }} inputs {{ u; }} lagrangian = dot(x)^2/2 + dot(y)^2/2;
             forces {{ f: u*dot(x)*d(x); }} claims {{ {claim} }} }}"
        )
    };
    let compile = |claim: &str| compile(model(claim).parse().expect("tokens"));
    assert!(compile("conserved: dot(y); not conserved: energy;").is_ok());
    assert!(compile("conserved: dot(x);").is_err());
}
