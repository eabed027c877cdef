//! The dalembert command line over any list of models.
//!
//! The shipped `dalembert` binary is this crate over the texts of the shipped models. Another crate gets the same
//! commands for its models:
//!
//! ```no_run
//! dalembert::model! {
//!     /// A ball that bounces on a floor.
//!     pub Ball {
//!         coordinates { x; }
//!         lagrangian = dot(x)^2/2 - x;
//!         impacts { floor: x >= 0; }
//!         initial { x = 1; until = 10; }
//!     }
//! }
//!
//! fn main() -> std::process::ExitCode {
//!     dalembert_cli::run(dalembert_cli::models![Ball])
//! }
//! ```
//!
//! Exit status: 0 the requested end was reached, 1 any other outcome (output is still written), 2 bad flags or
//! input. The standard output holds results only, the standard error messages only.

#![forbid(unsafe_code)]

mod args;
mod catalogue;
mod command;
mod ends;
mod ensemble;
mod entry;
pub mod errata;
mod error;
mod exit;
mod expression;
mod feedback;
pub mod gallery;
mod input_table;
mod json;
mod map;
mod model_file;
mod names;
mod outcome;
mod plot;
mod progress;
mod record;
mod run_request;
mod scalar;
mod sink;
mod spool;
mod state_input;
pub mod suite;
mod symbols;
mod table;

use std::ffi::OsString;
use std::io::{self, IsTerminal, Read, Write};
use std::process::ExitCode;

use clap::Parser;
use clap::error::{ContextKind, ErrorKind};

use args::{Command, CommandLine};
pub use catalogue::Catalogue;
pub use dalembert_driver::Integrator;
pub use entry::Entry;
use error::CliError;
pub use exit::Exit;

/// Streams of a command.
pub struct Streams<'a> {
    /// The standard input.
    pub input: &'a mut dyn Read,
    /// The standard output: results.
    pub output: &'a mut dyn Write,
    /// The standard error: messages.
    pub errors: &'a mut dyn Write,
    /// True to show progress on the standard error of the process.
    pub terminal: bool,
}

/// Runs the command line of this process over a list of models, as made by [`models!`].
#[must_use]
pub fn run(models: Vec<Entry>) -> ExitCode {
    Catalogue::of(models).run()
}

/// Runs one command line, program name included, over a list of models, with the caller's streams.
pub fn run_with<A>(
    args: impl IntoIterator<Item = A>,
    models: &[Entry],
    streams: &mut Streams<'_>,
) -> Exit
where
    A: Into<OsString> + Clone,
{
    Catalogue::of(models.to_vec()).run_with(args, streams)
}

impl Catalogue {
    /// Runs the command line of this process.
    #[must_use]
    pub fn run(&self) -> ExitCode {
        let mut streams = Streams {
            input: &mut io::stdin().lock(),
            output: &mut io::stdout(),
            errors: &mut io::stderr(),
            terminal: io::stderr().is_terminal(),
        };
        self.run_with(std::env::args_os(), &mut streams).into()
    }

    /// Runs one command line, program name included, with the caller's streams.
    pub fn run_with<A>(&self, args: impl IntoIterator<Item = A>, streams: &mut Streams<'_>) -> Exit
    where
        A: Into<OsString> + Clone,
    {
        let done = match CommandLine::try_parse_from(args) {
            Ok(mut line) => with_files(&mut line, self, streams),
            Err(error) => explain(error, streams),
        };
        let done = done.and_then(|exit| Ok(streams.output.flush().map(|()| exit)?));
        done.unwrap_or_else(|error| match error {
            // A reader that closes its end early, such as `head`, needs no message.
            CliError::Stream(source) if source.kind() == io::ErrorKind::BrokenPipe => Exit::Other,
            error => {
                // If the standard error fails, no stream is left for a report.
                let _ = writeln!(streams.errors, "error: {error}");
                Exit::Refused
            }
        })
    }
}

/// Carries out a command. If its model is in a file, the file is read first.
fn with_files(
    line: &mut CommandLine,
    catalogue: &Catalogue,
    streams: &mut Streams<'_>,
) -> Result<Exit, CliError> {
    line.command.check_files()?;
    if let Some(selection) = line.command.selection()
        && let Some(models) = model_file::selected(selection, catalogue.models(), streams.input)?
    {
        return dispatch(&mut line.command, &catalogue.with_models(models), streams);
    }
    dispatch(&mut line.command, catalogue, streams)
}

fn dispatch(
    command: &mut Command,
    catalogue: &Catalogue,
    streams: &mut Streams<'_>,
) -> Result<Exit, CliError> {
    let models = catalogue.models();
    match command {
        Command::List(args) => command::list::run(models, args, streams),
        Command::Derive(args) => command::derive::run(models, args, streams),
        Command::Check(args) => command::check::run(models, args, streams),
        Command::Simulate(args) => command::simulate::run(models, args, streams),
        Command::Ensemble(args) => command::ensemble::run(models, args, streams),
        Command::Map(args) => command::map::run(models, args, streams),
        Command::Accuracy(args) => command::accuracy::run(models, args, streams),
        Command::Orbit(args) => command::orbit::run(models, args, streams),
        Command::Connect(args) => command::connect::run(models, args, streams),
        Command::Linearise(args) => command::linearise::run(models, args, streams),
        Command::Control(args) => command::control::run(models, args, streams),
        Command::Eval(args) => command::eval::run(models, args, streams),
        Command::Watch(args) => command::watch::run(catalogue, args, streams),
        Command::New(args) => command::new::run(args, streams),
        Command::Build(args) => command::build::run(args, streams),
        Command::Export(args) => command::export::run(models, args, streams),
        Command::Gallery(args) => command::gallery::run(catalogue, args, streams),
        Command::Errata(args) => command::errata::run(catalogue, args, streams),
        Command::Stability(args) => command::stability::run(catalogue.suite(), args, streams),
    }
}

/// Writes help to the standard output; any other error of `clap` is a refusal.
fn explain(mut error: clap::Error, streams: &mut Streams<'_>) -> Result<Exit, CliError> {
    if error.kind() == ErrorKind::UnknownArgument {
        // Removes the tip to pass an unknown flag as a value, because no argument takes such a value.
        error.remove(ContextKind::Suggested);
    }
    let text = error.to_string();
    if error.use_stderr() {
        // If the standard error fails, no stream is left for a report.
        let _ = write!(streams.errors, "{text}");
        Ok(Exit::Refused)
    } else {
        write!(streams.output, "{text}")?;
        Ok(Exit::Reached)
    }
}
