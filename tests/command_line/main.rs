//! The command line from its arguments to its streams and exit status.

// Tests fail by panicking.
#![allow(clippy::unwrap_used)]

mod accuracy;
mod branch;
mod certify;
mod check;
mod curves;
mod derive;
mod ensemble;
mod errata;
mod eval;
mod files;
mod folder;
mod gallery;
mod hostile;
mod integrals;
mod list;
mod map;
mod pictures;
mod simulate;
mod stability;
mod systems;
mod tables;
mod verify;

use dalembert_cli::{Entry, Exit, Streams, run_with};
use serde_json::Value;

/// Result of a command line.
struct Done {
    exit: Exit,
    output: String,
    errors: String,
}

impl Done {
    /// The standard output as JSON.
    fn json(&self) -> Value {
        serde_json::from_str(&self.output)
            .unwrap_or_else(|error| panic!("{error} in {}", self.output))
    }
}

/// Runs a command line given as words, with this standard input.
fn run_on(input: &str, words: &[&str]) -> Done {
    run_over(systems::entries(), input, words)
}

/// Runs a command line over these models.
fn run_over(models: &[Entry], input: &str, words: &[&str]) -> Done {
    let (mut output, mut errors) = (Vec::new(), Vec::new());
    let mut streams = Streams {
        input: &mut input.as_bytes(),
        output: &mut output,
        errors: &mut errors,
        terminal: false,
    };
    let args = std::iter::once("dalembert").chain(words.iter().copied());
    let exit = run_with(args, models, &mut streams);
    let text = |bytes| String::from_utf8(bytes).unwrap();
    Done {
        exit,
        output: text(output),
        errors: text(errors),
    }
}

/// Runs a command line given as one text, split at white space.
fn run(line: &str) -> Done {
    run_on("", &line.split_whitespace().collect::<Vec<_>>())
}

/// Numbers of a JSON array.
fn numbers(value: &Value) -> Vec<f64> {
    value
        .as_array()
        .unwrap()
        .iter()
        .map(|number| number.as_f64().unwrap())
        .collect()
}
