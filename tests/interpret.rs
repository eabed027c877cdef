//! Three routes to the same numbers: emitted code, the program's interpreter, and derivatives of the Lagrangian by
//! differences.

use dalembert::erased::Erased;
use dalembert::{Described, Instance, Scene, StateVector, System, VectorField};
use dalembert_codegen::model::Model;
use dalembert_codegen::program::{Lowered, interpret::interpret, verify::verify};
use dalembert_codegen::{compile, mechanics, spec};
use dalembert_expr::SymbolId;
use dalembert_tests::command::models;
use dalembert_tests::interpreted::{compare_motion, compare_report, input};
use dalembert_tests::sampling::{Visitor, states, visit_all};

/// Names of what is visited.
struct Names(Vec<&'static str>);

impl Visitor for Names {
    fn visit<S: Described + Scene>(&mut self, _: S) {
        self.0.push(S::DESCRIPTION.name);
    }
}

#[test]
fn every_model_of_the_command_line_is_visited() {
    let mut visited = Names(Vec::new());
    visit_all(&mut visited);
    // First-order systems have no mechanics to visit, and modes are models of their own; both have tests of their own.
    let known: Vec<_> = models()
        .iter()
        .map(|entry| entry.description())
        .filter(|description| !description.is_first_order && description.modes.is_empty())
        .map(|description| description.name)
        .collect();
    assert_eq!(visited.0, known);
}

/// A model derived again from its own source text.
fn derive(source: &str) -> (Model, mechanics::Derivation, Lowered) {
    let compiled = compile(source.parse().expect("tokens")).expect("a model");
    (compiled.model, compiled.derivation, compiled.programs)
}

/// Emitted code does what the interpreter does, to the bit, inlined and behind pointers: the same operations in the same order.
struct EmittedIsInterpreted(usize);

impl Visitor for EmittedIsInterpreted {
    fn visit<S: Described + Scene>(&mut self, system: S) {
        let (_, _, programs) = derive(S::DESCRIPTION.source);
        self.0 += compare_motion(&system, &programs.main);
        self.0 += compare_motion(&system.global(), programs.global());
        let form = S::FORM.expect("a form");
        let erased = Erased::<32>::of(form).expect("room");
        compare_motion(&erased, &programs.main);
        compare_motion(&erased.global(), programs.global());
        compare_report(&erased.global(), programs.global());
    }
}

#[test]
fn emitted_code_is_what_the_interpreter_executes() {
    let mut visitor = EmittedIsInterpreted(0);
    visit_all(&mut visitor);
    assert!(visitor.0 >= 100);
}

dalembert::model! {
    /// Every function of the language, one output each.
    pub EveryFunction {
        coordinates { x; y; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2;
        outputs {
            of_sqrt: sqrt(x); of_atan2: atan2(y, x); of_sin: sin(x); of_cos: cos(y); of_tan: tan(x); of_asin: asin(x);
            of_acos: acos(x); of_atan: atan(x); of_exp: exp(x); of_ln: ln(x); of_sinh: sinh(x); of_cosh: cosh(x);
            of_tanh: tanh(x); of_abs: abs(y);
        }
    }
}

#[test]
fn every_function_is_emitted_as_it_is_interpreted() {
    let source = EveryFunction::DESCRIPTION.source;
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

/// The force `f = dL/dq + F` in the program against central differences of L, which is evaluated as an expression.
struct ForceIsDifferenced;

impl Visitor for ForceIsDifferenced {
    fn visit<S: Described + Scene>(&mut self, system: S) {
        let (model, derivation, _) = derive(S::DESCRIPTION.source);
        for state in states(&system, 3, 2) {
            let t = 0.4;
            let qdot = system.velocity(t, &state).expect("a velocity");
            for (k, coordinate) in model.coordinates.iter().enumerate() {
                let lagrangian = |shift: f64| {
                    let value = |symbol: SymbolId| {
                        let shift = if symbol == coordinate.q { shift } else { 0.0 };
                        value_of(&model, &system, t, &state, &qdot, symbol) + shift
                    };
                    model.pool.eval(&[model.lagrangian.whole], &value)[0]
                };
                let value = |symbol| value_of(&model, &system, t, &state, &qdot, symbol);
                let applied: f64 = model
                    .forces
                    .iter()
                    .map(|force| model.pool.eval(&[force.form[k]], &value)[0])
                    .sum();
                let force = model.pool.eval(&[derivation.field.force[k]], &value)[0] - applied;
                let h = 1e-5;
                let difference = (lagrangian(h) - lagrangian(-h)) / (2.0 * h);
                let scale = lagrangian(0.0).abs().max(1.0);
                assert!(
                    (force - difference).abs() < 1e-8 * scale,
                    "{}: {k}",
                    S::DESCRIPTION.name
                );
            }
        }
    }
}

fn value_of<S: Instance>(
    model: &Model,
    system: &S,
    t: f64,
    state: &S::State,
    qdot: &S::Vector,
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
    visit_all(&mut ForceIsDifferenced);
}

/// Every function is well formed.
struct WellFormed;

impl Visitor for WellFormed {
    fn visit<S: Described + Scene>(&mut self, _: S) {
        let (_, _, programs) = derive(S::DESCRIPTION.source);
        let functions = programs.main.functions().into_iter();
        for function in functions.chain(programs.global().functions()) {
            assert_eq!(verify(function), Ok(()), "{}", S::DESCRIPTION.name);
        }
    }
}

#[test]
fn programs_are_well_formed() {
    visit_all(&mut WellFormed);
}

/// The field keeps the value of every constraint, on it and off it: `d/dt (eta(qdot) + eta_0) = 0`, by differences
/// of the residual expression along the emitted rate.
#[test]
fn the_field_keeps_the_constraints_everywhere() {
    struct Kept(usize);
    impl Visitor for Kept {
        fn visit<S: Described + Scene>(&mut self, system: S) {
            let (model, derivation, _) = derive(S::DESCRIPTION.source);
            let system = system.global();
            let mut random = dalembert_tests::sampling::Random::new(3);
            for constraint in &derivation.constraints {
                let (q, qdot) = (
                    random.vector::<S::Vector>(0.1, 1.4),
                    random.vector::<S::Vector>(-1.0, 1.0),
                );
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
                assert!(
                    derivative.abs() < 1e-7,
                    "{}: {derivative:e}",
                    S::DESCRIPTION.name
                );
                self.0 += 1;
            }
        }
    }
    let mut kept = Kept(0);
    visit_all(&mut kept);
    assert!(kept.0 >= 15);
}
