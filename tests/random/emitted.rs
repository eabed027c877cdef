//! Emitted code of random declarations is what the interpreter executes, to the bit.
//!
//! `tests/random/models.rs` holds declarations that were drawn once; `ACCEPT=1` draws them anew.

use std::fmt::Write;
use std::path::Path;

use dalembert::Described;
use dalembert_codegen::program::{Function, Input, interpret::interpret};
use dalembert_tests::golden;
use dalembert_tests::numeric::Numeric;
use dalembert_tests::sampling::Random;
use proptest::prelude::*;
use proptest::strategy::ValueTree;
use proptest::test_runner::{Config, RngSeed, TestRunner};

use super::declaration::Declaration;
use super::interpreted::compiled;
use super::models;

/// How many models are drawn.
const COUNT: usize = 12;

/// Declarations that are not refused, from a fixed seed.
fn drawn() -> Vec<Declaration> {
    let config = Config {
        rng_seed: RngSeed::Fixed(28),
        ..Config::default()
    };
    let mut runner = TestRunner::new(config);
    let any = Declaration::any(4);
    let endless =
        std::iter::repeat_with(|| any.new_tree(&mut runner).expect("a declaration").current());
    endless
        .filter(|own| compiled(own).is_ok())
        .take(COUNT)
        .collect()
}

fn source() -> String {
    let mut text = String::from(
        "//! Declarations drawn at random by `tests/random/emitted.rs`; `ACCEPT=1` draws them anew.\n",
    );
    for (k, declaration) in drawn().iter().enumerate() {
        let body = declaration
            .named(&format!("Random{k}"))
            .replace('\n', "\n    ");
        write!(text, "\ndalembert::model! {{\n    {body}\n}}\n").expect("a text");
    }
    text
}

#[test]
fn the_declarations_are_those_that_are_drawn() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("random/models.rs");
    golden::compare_file(&path, &source());
}

/// Compares everything that is emitted for a model at random states.
fn check<S: Described>(system: &S) {
    let name = S::DESCRIPTION.name;
    let tokens = S::DESCRIPTION.source.parse().expect("tokens");
    let programs = dalembert_codegen::compile(tokens)
        .expect("a model")
        .programs;
    let program = programs.global();
    let n = S::DESCRIPTION.coordinates.len();
    let mut random = Random::new(n as u64);
    for _ in 0..20 {
        let mut numbers = |count| {
            (0..count)
                .map(|_| random.within(-1.0, 1.0))
                .collect::<Vec<f64>>()
        };
        let (t, q, qdot) = (numbers(1)[0], numbers(n), numbers(n));
        let state = Numeric::state(system, t, &q, &qdot);
        let at = system.snapshot(t, &state);
        let run = |function: &Function| {
            let input = |input| match input {
                Input::Time => t,
                Input::Coordinate(i) => at.q[i],
                Input::Velocity(i) => at.qdot[i],
                Input::Momentum(i) => at.p[i],
                Input::Parameter(k) => system.parameter(k),
                Input::Excess(_)
                | Input::Multiplier(_)
                | Input::Quasi(_)
                | Input::MotionRate(_) => f64::NAN,
            };
            interpret(function, &input).expect("a value")
        };
        assert_eq!(
            Numeric::rate(system, t, &state),
            run(&program.rate),
            "{name}: rate"
        );
        assert_eq!(at.energy, run(&program.energy)[0], "{name}: energy");
        let report = system.report(t, &state);
        let mut expected = run(&program.geometry.function).into_iter();
        for group in &program.geometry.groups {
            let values: Vec<f64> = expected.by_ref().take(group.shape.count()).collect();
            let emitted = report.0.get(&group.name);
            assert_eq!(emitted, Some(&values), "{name}: {}", group.name);
        }
    }
}

macro_rules! check_all {
    ($($model:ident)*) => { $(check(&models::$model::default());)* };
}

#[test]
fn random_models_are_emitted_as_they_are_interpreted() {
    check_all! {
        Random0 Random1 Random2 Random3 Random4 Random5 Random6 Random7 Random8 Random9 Random10 Random11
    }
}
