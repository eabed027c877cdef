//! The command line, run inside the process.

use std::io::Cursor;

use dalembert_cli::{Entry, Exit, Streams};

/// Result of one command line.
#[derive(Debug)]
pub struct Finished {
    /// The exit.
    pub exit: Exit,
    /// The standard output.
    pub output: String,
    /// The standard error.
    pub errors: String,
}

/// Every model that tests know: the shipped ones and those of [`crate::systems`].
pub fn models() -> Vec<Entry> {
    let mut models = dalembert_command::all();
    models.extend(crate::systems::all());
    models
}

/// Runs `dalembert` over [`models`] with these arguments and this standard input.
pub fn dalembert(arguments: &[&str], input: &str) -> Finished {
    run(models(), arguments, input)
}

/// Runs `dalembert` over these models with the arguments of a line, separated by white space.
pub fn line(models: Vec<Entry>, line: &str, input: &str) -> Finished {
    run(models, &Vec::from_iter(line.split_whitespace()), input)
}

/// Runs `dalembert` over these models with these arguments and this standard input.
pub fn run(models: Vec<Entry>, arguments: &[&str], input: &str) -> Finished {
    let (mut output, mut errors) = (Vec::new(), Vec::new());
    let mut streams = Streams {
        input: &mut Cursor::new(input),
        output: &mut output,
        errors: &mut errors,
        terminal: false,
    };
    let words = ["dalembert"].iter().chain(arguments);
    let exit = dalembert_cli::run_with(words, &models, &mut streams);
    Finished {
        exit,
        output: String::from_utf8_lossy(&output).into_owned(),
        errors: String::from_utf8_lossy(&errors).into_owned(),
    }
}
