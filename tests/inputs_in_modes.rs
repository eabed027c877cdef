//! Inputs of a model with modes: all modes share them.

use dalembert::{
    Actuated, Described, Dop853, Impacts, Outcome, Run, Simulation, System, Tolerance, VectorField,
};
use dalembert_cli::Exit;
use dalembert_codegen::spec::Declaration;
use dalembert_codegen::{compile_modes, read};
use dalembert_stability::text::Text;
use dalembert_tests::command::{self, Finished};
use dalembert_tests::numeric::assert_near;

dalembert::model! {
    /// A sledge with a motor that runs from ice onto gravel and against a wall.
    pub Sledge {
        coordinates { x; }
        parameters { m > 0 = 2; c > 0 = 1/4; }
        inputs {
            /// The force of the motor.
            u;
        }
        lagrangian = m/2*dot(x)^2;
        impacts { wall: x <= 2; }
        modes {
            ice { forces { motor: u*d(x); } }
            gravel { forces { motor: u*d(x); drag: -c*dot(x)*d(x); } }
        }
        transitions { enter: ice -> gravel when x >= 1; }
        outputs { force: u; }
        initial { x = 0; dot(x) = 1; until = 1.5; }
    }
}

static SLEDGE: Text = Text::new(Sledge::DESCRIPTION.source.value());

type State = <Sledge as VectorField>::State;

fn start(x: f64, v: f64) -> State {
    let sledge = Sledge::default();
    sledge
        .state(0.0, &[x].into(), &[v].into())
        .expect("a state")
}

/// A run with all impacts and transitions.
fn run<S: dalembert::contract::Impacting>(system: &S, from: S::State, until: f64) -> Run<S::State> {
    let stepper = Dop853::new(Tolerance::new(1e-13).expect("a tolerance"));
    let run = Simulation::new(system, stepper, Impacts::declared(system))
        .run(0.0, from, until, &mut ())
        .expect("a run");
    assert_eq!(run.outcome, Outcome::Done);
    run
}

/// Position and velocity under a constant force, from `x = 0` with the velocity 1.
fn constant(u: f64, t: f64) -> [f64; 2] {
    let Sledge { m, c, .. } = Sledge::default();
    let entered = m / u * ((1.0 + 2.0 * u / m).sqrt() - 1.0);
    let (v, later) = (1.0 + u / m * entered, t - entered);
    let decay = (-c / m * later).exp();
    let x = 1.0 + u / c * later + m / c * (v - u / c) * (1.0 - decay);
    [x, u / c + (v - u / c) * decay]
}

#[test]
fn a_held_input_acts_in_every_mode() {
    let mut sledge = Sledge::default();
    sledge.set_inputs(&[0.3]);
    assert_eq!((sledge.u, Sledge::INPUTS), (0.3, &["u"][..]));
    let end = run(&sledge, start(0.0, 1.0), 1.5);
    let [x, v] = constant(0.3, 1.5);
    assert_near("x", &[end.state[0]], &[x], 1e-12);
    assert_near("v", &[end.state[1] / sledge.m], &[v], 1e-12);
}

/// `u = -m v` makes the speed fall as `exp(-t)` on ice, and as `exp(-(1 + c/m) t)` on gravel. An input function finds
/// the mode in the last component of the state.
#[test]
fn feedback_acts_in_every_mode() {
    let sledge = Sledge::default();
    let rate = 1.0 + sledge.c / sledge.m;
    let entered = 2.0_f64.ln();
    let until = entered + 0.5;
    let expected = 0.5 * (-rate * 0.5).exp();
    let steered = sledge.with_inputs(|_, state| [-state[1]]);
    let end = run(&steered, start(0.5, 1.0), until);
    assert_near("v", &[end.state[1] / sledge.m], &[expected], 1e-12);
    // With feedback only on ice, half of the speed is lost before the gravel. On the gravel only drag acts.
    let on_ice = sledge.with_inputs(|_, state| [if state[2] == 0.0 { -state[1] } else { 0.0 }]);
    let end = run(&on_ice, start(0.5, 1.0), until);
    let expected = 0.5 * (-sledge.c / sledge.m * 0.5).exp();
    assert_near("v", &[end.state[1] / sledge.m], &[expected], 1e-12);
}

fn command(arguments: &[&str], input: &str) -> serde_json::Value {
    let Finished {
        exit,
        output,
        errors,
    } = command::run(vec![SLEDGE.entry()], arguments, input);
    assert_eq!(exit, Exit::Reached, "{errors}");
    serde_json::from_str(&output).expect("JSON")
}

fn last(document: &serde_json::Value) -> [f64; 2] {
    let samples = document["samples"].as_array().expect("samples");
    let last = samples.last().expect("a sample");
    ["q", "qdot"].map(|key| last[key][0].as_f64().expect("a number"))
}

#[test]
fn the_command_line_holds_inputs_and_reads_tables_of_them() {
    for integrator in ["dop853", "taylor"] {
        let line = ["simulate", "sledge", "--integrator", integrator];
        let held = command(
            &[&line[..], &["--input", "u=0.3", "--json", "-"]].concat(),
            "",
        );
        assert_eq!(held["inputs"], serde_json::json!({ "u": 0.3 }));
        assert_near("held", &last(&held), &constant(0.3, 1.5), 1e-8);
    }
    let folder = std::env::temp_dir().join(format!("dalembert-sledge-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder");
    let table = folder.join("inputs.csv");
    std::fs::write(&table, "t,u\n0,0.3\n2,0.3\n").expect("a table");
    let path = table.display().to_string();
    let driven = command(
        &["simulate", "sledge", "--inputs", &path, "--json", "-"],
        "",
    );
    std::fs::remove_dir_all(&folder).expect("a folder");
    assert_near("table", &last(&driven), &constant(0.3, 1.5), 1e-8);
}

#[test]
fn inputs_decide_no_transition() {
    let refused = |modes: &str| {
        let text = format!(
            "P {{ coordinates {{ x; }} inputs {{ u; }} lagrangian = dot(x)^2/2; {modes} }}"
        );
        let declared = read(text.parse().expect("tokens"));
        let errors = match declared {
            Ok(Declaration::Modes(modes)) => compile_modes(&modes).expect_err("a refusal"),
            Ok(_) => panic!("a model with modes"),
            Err(errors) => errors,
        };
        let messages = errors.iter().map(|error| error.message().to_owned());
        messages.collect::<String>()
    };
    let acts = "an input acts in `forces`, and in the rates of a `field`";
    let two = "modes { a { } b { } }";
    for transition in [
        "go: a -> b when x >= u;",
        "go: a -> b when x >= 0 => reset { dot(x) = u; };",
    ] {
        let text = refused(&format!("{two} transitions {{ {transition} }}"));
        assert!(text.contains(acts), "{transition}: {text}");
    }
    let text = refused("modes { a { claims { density: exact; } } b { } }");
    assert!(text.contains("`u` may depend on the state"), "{text}");
    let text = refused("modes { a { inputs { w; } } }");
    assert!(
        text.contains("`inputs` belongs outside of `modes`"),
        "{text}"
    );
}
