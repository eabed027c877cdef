//! Errata of the sources of the models, for the command `errata`.
//!
//! An [`Erratum`] may have a [`Check`]: a command line whose JSON output contains the right value, and a function that
//! reads this value and evaluates the printed formula at the same state.

use serde_json::Value;

/// A misprint of a source.
#[derive(Debug, Clone, Copy)]
pub struct Erratum {
    /// Source and place: `[C] (4.7)`.
    pub place: &'static str,
    /// The printed statement.
    pub printed: &'static str,
    /// The right statement.
    pub right: &'static str,
    /// A value that shows the difference; `None` if no command computes one.
    pub check: Option<Check>,
}

/// The computation of a value that a misprint changes.
#[derive(Debug, Clone, Copy)]
pub struct Check {
    /// The quantity.
    pub quantity: &'static str,
    /// A command line without the name of the program; its output is JSON.
    pub command: &'static str,
    /// The standard input of the command.
    pub input: &'static str,
    /// The relation between the values and the output.
    pub how: &'static str,
    /// The printed and the right value, from the output of the command; `None` if the output lacks them.
    pub values: fn(&Value) -> Option<[f64; 2]>,
}

impl Check {
    /// The computation as a line for a shell.
    pub fn line(&self) -> String {
        match self.input {
            "" => format!("dalembert {}", self.command),
            input => format!("echo '{input}' | dalembert {}", self.command),
        }
    }
}
