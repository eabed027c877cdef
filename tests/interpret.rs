//! Compares loaded code with the interpreter of the program, and expressions with finite differences of the Lagrangian
//! and of constraints.

use dalembert::describe::Description;
use dalembert::{Described, Instance, StateVector, System, VectorField};
use dalembert_codegen::model::Model;
use dalembert_codegen::program::{Lowered, interpret::interpret, verify::verify};
use dalembert_codegen::{compile, mechanics, spec};
use dalembert_expr::SymbolId;
use dalembert_stability::course::vector;
use dalembert_stability::text::{Large, Text};
use dalembert_tests::interpreted::{compare_motion, compare_report, input};
use dalembert_tests::sampling::{Random, every_system, states};

type State = <Large as VectorField>::State;

/// A model with its derivation and its programs, compiled from the source text.
fn derive(source: &str) -> (Model, mechanics::Derivation, Lowered) {
    let compiled = compile(source.parse().expect("tokens")).expect("a model");
    (compiled.model, compiled.derivation, compiled.programs)
}

/// Loaded code equals the interpreter to the bit, since it does the same operations in the same order. Emitted code
/// does too (`tests/erased`).
#[test]
fn loaded_code_is_what_the_interpreter_executes() {
    let mut states = 0;
    for system in every_system() {
        let (_, _, programs) = derive(&system.description().source);
        states += compare_motion(system, &programs.main);
        let global = system.global().expect("the global form");
        states += compare_motion(&global, programs.global());
        compare_report(&global, programs.global());
    }
    assert!(states >= 100);
}

dalembert::model! {
    /// Every function of the language, one output each.
    pub EveryFunction {
        coordinates { x; y; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2;
        outputs {
            of_sqrt: sqrt(x); of_atan2: atan2(y, x); of_sin: sin(x); of_cos: cos(y); of_tan: tan(x); of_asin: asin(x);
            of_acos: acos(x); of_atan: atan(x); of_exp: exp(x); of_ln: ln(x); of_log1p: log1p(y); of_sinh: sinh(x); of_cosh: cosh(x);
            of_tanh: tanh(x); of_asinh: asinh(x); of_abs: abs(y);
        }
    }
}

#[test]
fn every_function_is_emitted_as_it_is_interpreted() {
    let source = EveryFunction::DESCRIPTION.source.value();
    for name in spec::FUNCTIONS {
        let entry = format!("of_{name}");
        assert!(
            EveryFunction::DESCRIPTION.outputs.contains(&entry.as_str()),
            "write `{entry}: {name}(x);` above"
        );
    }
    let system = EveryFunction::default();
    let state = system
        .state(0.0, &[0.4, -0.3].into(), &[0.0, 0.0].into())
        .expect("a state");
    let mut emitted = [f64::NAN; spec::FUNCTIONS.len()];
    system
        .outputs(0.0, &state, &mut emitted)
        .expect("the outputs");
    let (_, _, programs) = derive(source);
    let outputs = programs.main.outputs.expect("outputs");
    let interpreted = interpret(&outputs, &input(&system, 0.0, &state)).expect("the outputs");
    assert_eq!(emitted.as_slice(), interpreted);
}

/// High powers of sums that are scaled to values near 1.
static BUMPS: Text = Text::new(
    "Bumps {
        coordinates { x; }
        let y = 2 + x;
        lagrangian = dot(x)^2/2;
        outputs {
            of_300: ((1.7 + cos(x))/2.7)^300; of_1000: 10*((1.001 + cos(x))/2.001)^1000; of_root: ((1.7 + cos(x))/2.7)^(601/2);
            inverse: ((1.7 - cos(x))/0.7)^(-500); two: x*((3 + x)/2.7)^400*((3 - x)/3.3)^350 - 1;
            shared: ((2 + x)/2.5)^900*y^2 + ((2 + x)/2.5)^900*x*y; of_1200: ((2 + cos(x))/3)^1200;
        }
    }",
);

/// The powers without their scale factors may exceed the range of `f64`. The values do not.
#[test]
fn high_powers_of_scaled_sums_keep_their_values() {
    let system = BUMPS.model();
    for x in [0.0_f64, 0.1, -0.3, 0.55] {
        let state = system
            .state(0.0, &vector(&[x]), &vector(&[0.0]))
            .expect("a state");
        let mut outputs = [f64::NAN; 7];
        system.outputs(0.0, &state, &mut outputs).expect("outputs");
        let shared = ((2.0 + x) / 2.5).powi(900);
        let expected = [
            ((1.7 + x.cos()) / 2.7).powi(300),
            10.0 * ((1.001 + x.cos()) / 2.001).powi(1000),
            ((1.7 + x.cos()) / 2.7).powf(300.5),
            ((1.7 - x.cos()) / 0.7).powi(-500),
            x * ((3.0 + x) / 2.7).powi(400) * ((3.0 - x) / 3.3).powi(350) - 1.0,
            shared * (2.0 + x).powi(2) + shared * x * (2.0 + x),
            ((2.0 + x.cos()) / 3.0).powi(1200),
        ];
        for (value, expected) in outputs.into_iter().zip(expected) {
            assert!(
                (value - expected).abs() <= 1e-11 * expected.abs(),
                "{x}: {outputs:?}, {expected:e}"
            );
        }
    }
}

/// Asserts that the force `f = dL/dq + F` of the derivation, without the applied force `F`, equals finite differences
/// of the Lagrangian.
fn assert_force_is_differenced(system: &Large) {
    let Description { name, source, .. } = system.description();
    let (model, derivation, _) = derive(source);
    for state in states(system, 3, 2) {
        let t = 0.4;
        let qdot = system.velocity(t, &state).expect("a velocity");
        for (k, coordinate) in model.coordinates.iter().enumerate() {
            let lagrangian = |shift: f64| {
                let value = |symbol: SymbolId| {
                    let shift = if symbol == coordinate.q { shift } else { 0.0 };
                    value_of(&model, system, t, &state, &qdot, symbol) + shift
                };
                model.pool.eval(&[model.lagrangian.whole], &value)[0]
            };
            let value = |symbol| value_of(&model, system, t, &state, &qdot, symbol);
            let applied: f64 = model
                .forces
                .iter()
                .map(|force| model.pool.eval(&[force.form[k]], &value)[0])
                .sum();
            let force = model.pool.eval(&[derivation.field.force[k]], &value)[0] - applied;
            let h = 1e-5;
            let difference = (lagrangian(h) - lagrangian(-h)) / (2.0 * h);
            let scale = lagrangian(0.0).abs().max(1.0);
            assert!((force - difference).abs() < 1e-8 * scale, "{name}: {k}");
        }
    }
}

fn value_of(
    model: &Model,
    system: &Large,
    t: f64,
    state: &State,
    qdot: &State,
    symbol: SymbolId,
) -> f64 {
    if symbol == model.time {
        return t;
    }
    for (i, coordinate) in model.coordinates.iter().enumerate() {
        if symbol == coordinate.q {
            return state.as_slice()[i];
        }
        if symbol == coordinate.qdot {
            return qdot.as_slice()[i];
        }
    }
    model
        .parameters
        .iter()
        .position(|parameter| parameter.symbol == symbol)
        .map_or(f64::NAN, |k| system.parameter(k))
}

#[test]
fn forces_are_derivatives_of_the_lagrangian() {
    every_system().iter().for_each(assert_force_is_differenced);
}

#[test]
fn programs_are_well_formed() {
    for system in every_system() {
        let Description { name, source, .. } = system.description();
        let (_, _, programs) = derive(source);
        let functions = programs.main.functions().into_iter();
        for function in functions.chain(programs.global().functions()) {
            assert_eq!(verify(function), Ok(()), "{name}");
        }
    }
}

/// Asserts that the motion keeps the residual of every constraint, even if it is not 0: `d/dt (eta(qdot) + eta_0) = 0`,
/// by finite differences of the residual along the rate. Returns the number of constraints.
fn assert_constraints_are_kept(system: &Large) -> usize {
    let Description { name, source, .. } = system.description();
    let (model, derivation, _) = derive(source);
    let system = system.global().expect("the global form");
    let mut random = Random::new(3);
    for constraint in &derivation.constraints {
        let zero = system.zero_vector();
        let (q, qdot) = (random.like(&zero, 0.1, 1.4), random.like(&zero, -1.0, 1.0));
        let t = 0.3;
        let state = system.state_unchecked(t, &q, &qdot).expect("a state");
        let mut rate = system.zero_state();
        system.rate(t, &state, &mut rate).expect("a rate");
        let residual = |h: f64| {
            let mut moved = state;
            for (x, v) in moved.as_mut_slice().iter_mut().zip(rate.as_slice()) {
                *x += h * v;
            }
            let qdot = system.velocity(t + h, &moved).expect("a velocity");
            let value = |symbol| value_of(&model, &system, t + h, &moved, &qdot, symbol);
            model.pool.eval(&[constraint.residual], &value)[0]
        };
        let h = 1e-5;
        let derivative = (residual(h) - residual(-h)) / (2.0 * h);
        assert!(derivative.abs() < 1e-7, "{name}: {derivative:e}");
    }
    derivation.constraints.len()
}

#[test]
fn the_field_keeps_the_constraints_everywhere() {
    let kept: usize = every_system().iter().map(assert_constraints_are_kept).sum();
    assert!(kept >= 15);
}
