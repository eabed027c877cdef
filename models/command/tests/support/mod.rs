//! Runs the shipped command inside a test.

use dalembert_cli::{Exit, Streams};

/// A command that has ended.
pub struct Done {
    /// The status.
    pub exit: Exit,
    /// The standard output.
    pub output: String,
    /// The standard error.
    pub errors: String,
}

/// Runs a command line with this standard input. Words are separated by spaces; single quotes enclose a word with spaces.
pub fn run_on(input: &str, line: &str) -> Done {
    let (mut output, mut errors) = (Vec::new(), Vec::new());
    let mut streams = Streams {
        input: &mut input.as_bytes(),
        output: &mut output,
        errors: &mut errors,
        terminal: false,
    };
    let words = ["dalembert".to_owned()].into_iter().chain(words(line));
    let exit = dalembert_command::catalogue().run_with(words, &mut streams);
    let text = |bytes| String::from_utf8(bytes).expect("text");
    Done {
        exit,
        output: text(output),
        errors: text(errors),
    }
}

fn words(line: &str) -> Vec<String> {
    let mut words = Vec::new();
    for (place, part) in line.split('\'').enumerate() {
        match place % 2 {
            0 => words.extend(part.split_whitespace().map(str::to_owned)),
            _ => words.push(part.to_owned()),
        }
    }
    words
}
