//! `watch`: runs a model of a file again whenever the file is saved.

use std::path::Path;
use std::thread;
use std::time::{Duration, SystemTime};

use crate::args::WatchArgs;
use crate::catalogue::Catalogue;
use crate::command::simulate;
use crate::error::CliError;
use crate::exit::Exit;
use crate::{Streams, model_file};

/// Time between two checks of the file.
const PAUSE: Duration = Duration::from_millis(100);

/// Carries out `watch`.
///
/// # Errors
/// A model that is not in a file, streams that fail. Other errors are printed, and the file remains watched.
pub fn run(
    catalogue: &Catalogue,
    args: &mut WatchArgs,
    streams: &mut Streams<'_>,
) -> Result<Exit, CliError> {
    let given = args.simulate.run.model.model.clone();
    let Some(file) = model_file::path(&given) else {
        let expected =
            "a file with a declaration, such as `disk.dal`; `dalembert new disk` writes one";
        return Err(CliError::value("MODEL", given, expected));
    };
    for run in 1.. {
        let seen = Stamp::of(file);
        args.simulate.run.model.model.clone_from(&given);
        let exit = match simulate_once(catalogue, args, streams) {
            Err(CliError::Stream(error)) => return Err(CliError::Stream(error)),
            Err(error) => {
                writeln!(streams.errors, "error: {error}")?;
                Exit::Refused
            }
            Ok(exit) => exit,
        };
        streams.output.flush()?;
        if args.runs.is_some_and(|runs| run >= runs) {
            return Ok(exit);
        }
        writeln!(streams.errors, "waiting for a change of {}", file.display())?;
        seen.wait_for_another(file);
    }
    Ok(Exit::Reached)
}

fn simulate_once(
    catalogue: &Catalogue,
    args: &mut WatchArgs,
    streams: &mut Streams<'_>,
) -> Result<Exit, CliError> {
    let selection = args.simulate.run.model.selection();
    let added = model_file::selected(selection, catalogue.models(), streams.input)?;
    let models = added.as_deref().unwrap_or(catalogue.models());
    simulate::run(models, &args.simulate, streams)
}

/// Modification time and length of a file; `None` if they cannot be read, as for a file that does not exist.
#[derive(Debug, PartialEq, Eq)]
struct Stamp(Option<(SystemTime, u64)>);

impl Stamp {
    fn of(file: &Path) -> Self {
        let seen = file
            .metadata()
            .and_then(|data| Ok((data.modified()?, data.len())));
        Self(seen.ok())
    }

    /// Waits until the file exists with a stamp that differs from this one.
    fn wait_for_another(&self, file: &Path) {
        loop {
            thread::sleep(PAUSE);
            let seen = Self::of(file);
            if seen.0.is_some() && seen != *self {
                return;
            }
        }
    }
}
