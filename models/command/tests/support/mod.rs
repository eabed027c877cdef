//! The shipped command inside of a test.

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

/// Runs a command line, its words separated by blanks, with this standard input.
pub fn run_on(input: &str, line: &str) -> Done {
    run_words(input, line.split_whitespace())
}

/// Runs the command of these words, with this standard input.
pub fn run_words<'a>(input: &str, words: impl Iterator<Item = &'a str>) -> Done {
    let (mut output, mut errors) = (Vec::new(), Vec::new());
    let mut streams = Streams {
        input: &mut input.as_bytes(),
        output: &mut output,
        errors: &mut errors,
        terminal: false,
    };
    let words = ["dalembert"].into_iter().chain(words);
    let exit = dalembert_command::catalogue().run_with(words, &mut streams);
    let text = |bytes| String::from_utf8(bytes).expect("text");
    Done {
        exit,
        output: text(output),
        errors: text(errors),
    }
}
