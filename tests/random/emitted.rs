//! Emitted code of random declarations equals the interpreter, to the bit.
//!
//! `tests/random/models.rs` has the drawn declarations. `ACCEPT=1` in the environment draws them anew.

use std::fmt::Write;
use std::path::Path;

use dalembert::Described;
use dalembert_tests::golden;
use dalembert_tests::interpreted::{compare_motion, compare_report};
use proptest::prelude::*;
use proptest::strategy::ValueTree;
use proptest::test_runner::{Config, RngSeed, TestRunner};

use super::declaration::Declaration;
use super::interpreted::compiled;
use super::models;

/// Number of drawn models.
const COUNT: usize = 12;

/// Accepted declarations from a fixed seed.
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
        .filter(|declaration| compiled(declaration).is_ok())
        .take(COUNT)
        .collect()
}

fn source() -> String {
    let mut text = String::from(
        "//! Declarations drawn at random by `tests/random/emitted.rs`; `ACCEPT=1` draws them anew.\n",
    );
    for (k, declaration) in drawn().iter().enumerate() {
        let declared = declaration.named(&format!("Random{k}"));
        let compiled = dalembert_codegen::compile(declared.parse().expect("tokens"));
        let global = compiled.expect("a model").programs.global;
        let attribute = global.map_or("", |_| "#[global]\n    ");
        let body = declared.replace('\n', "\n    ");
        write!(text, "\ndalembert::model! {{\n    {attribute}{body}\n}}\n").expect("a text");
    }
    text
}

#[test]
fn the_declarations_are_those_that_are_drawn() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("random/models.rs");
    golden::compare_file(&path, &source());
}

/// Compares emitted functions of a model with the interpreter at random states: the motion in both forms, and the
/// reported quantities.
fn check<S: Described>(system: &S) {
    let tokens = S::DESCRIPTION.source.parse().expect("tokens");
    let compiled = dalembert_codegen::compile(tokens).expect("a model");
    let (main, global) = (&compiled.programs.main, compiled.programs.global());
    compare_motion(system, main);
    let system = system.global().expect("the global form");
    compare_motion(&system, global);
    compare_report(&system, global);
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
