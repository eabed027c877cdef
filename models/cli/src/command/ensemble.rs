//! `ensemble`: many members of one scene, as rows, as a summary and as a density.

mod cells;
mod document;
mod summary;

use std::path::{Path, PathBuf};
use std::thread::available_parallelism;
use std::time::{Duration, Instant};

use dalembert_driver::{AnyModel, Beginning, Rates, Settings};
use serde_json::{Map, Value};

use crate::args::EnsembleArgs;
use crate::ensemble::Quantity;
use crate::ensemble::density::{Checkpoint, Counts, Density, Wish, convergence};
use crate::ensemble::members::{Members, Shard};
use crate::ensemble::metadata::metadata;
use crate::ensemble::{self, Columns, Plan, Rows, Shared, Summary, Tally, journal, listed, pilot};
use crate::entry::Entry;
use crate::error::CliError;
use crate::exit::Exit;
use crate::sink::{Sink, is_stdout};
use crate::state_input::{self, build_model};
use crate::{Streams, plot, run_request};

/// A finished ensemble, with the data that its files name.
struct Finished<'a> {
    model: &'a dyn AnyModel,
    settings: &'a Settings,
    metadata: &'a Map<String, Value>,
    tally: Tally,
    /// The density, its counts, and their convergence.
    density: Option<(&'a Density, Counts, Vec<Checkpoint>)>,
    /// Number of members taken over from an earlier run.
    kept: u64,
    threads: u64,
    elapsed: Duration,
}

/// Carries out `ensemble`.
///
/// # Errors
/// Invalid flags, a file that cannot be written or continued. A member that does not reach its end is not an error but
/// an [`Exit`].
pub fn run(
    models: &[Entry],
    args: &EnsembleArgs,
    streams: &mut Streams<'_>,
) -> Result<Exit, CliError> {
    check_flags(args)?;
    if !args.run.input.is_empty() {
        let text = "--input: an ensemble leaves inputs at 0; declare a parameter for what its members vary";
        return Err(CliError::Usage(text));
    }
    let model = build_model(models, &args.run.model)?;
    let model = model.as_ref();
    let settings = run_request::course(model, &args.run, &args.course)?;
    let members = members(model, args, streams)?;
    let shard = args
        .shard
        .as_deref()
        .map_or(Ok(Shard::WHOLE), Shard::parse)?;
    let mut shared = Shared {
        models,
        run: &args.run,
        settings: &settings,
        members: &members,
        density: None,
    };
    let density = density(model, args, shared)?;
    shared.density = density.as_ref();
    let metadata = metadata(model, &shared, shard)?;
    let columns = Columns::of(model.description(), &members);
    let plan = Plan {
        shared,
        range: shard.range(members.count()),
        threads: threads(args),
        metadata: &metadata,
        columns: &columns,
    };
    // Opened before the runs, so that a path that cannot be written is reported at once.
    let cells = Sink::open_given("--cells", args.cells.as_deref())?;
    let json = Sink::open_given("--json", args.json.as_deref())?;
    let plot = Sink::open_given("--plot", args.plot.as_deref())?;

    let begun = Instant::now();
    let Summary {
        tally,
        counts,
        kept,
    } = execute(args, &plan, streams)?;
    let finished = Finished {
        model,
        settings: &settings,
        metadata: &metadata,
        tally,
        density: density.as_ref().zip(counts).map(|(density, counts)| {
            let checkpoints = convergence(&counts);
            (density, counts, checkpoints)
        }),
        kept,
        threads: plan.threads,
        elapsed: begun.elapsed(),
    };
    write_files(args, &finished, [json, cells, plot], streams)?;
    Ok(match finished.tally.strayed {
        0 => Exit::Reached,
        _ => Exit::Other,
    })
}

/// Runs the members and writes their rows.
fn execute(
    args: &EnsembleArgs,
    plan: &Plan<'_>,
    streams: &mut Streams<'_>,
) -> Result<Summary, CliError> {
    let file = row_file(args);
    let rows = match (&args.csv, &file) {
        (Some(path), _) if is_stdout(path) => Rows::Stream(&mut *streams.output),
        (_, Some((flag, path))) => Rows::File {
            flag,
            path,
            resume: args.resume,
        },
        _ => Rows::Nowhere,
    };
    let summary = ensemble::execute(plan, rows, streams.terminal)?;
    if let (Some(parquet), Some((flag, path))) = (&args.parquet, &file) {
        write_parquet(parquet, path, plan)?;
        if args.csv.is_none() {
            journal::discard(path).map_err(|source| CliError::File {
                flag,
                path: path.clone(),
                source,
            })?;
        }
    }
    Ok(summary)
}

/// Writes the files about the whole ensemble.
fn write_files(
    args: &EnsembleArgs,
    finished: &Finished<'_>,
    [json, cells, plot]: [Option<Sink>; 3],
    streams: &mut Streams<'_>,
) -> Result<(), CliError> {
    if let Some(sink) = json {
        sink.write(streams, |output| document::write(output, finished))?;
    }
    if let Some((density, counts, checkpoints)) = &finished.density {
        if let Some(sink) = cells {
            sink.write(streams, |output| cells::write(output, density, counts))?;
        }
        if let Some(sink) = plot {
            let words = (
                summary::title(finished),
                summary::caption(finished, checkpoints),
            );
            let svg = plot::density::draw(density, &counts.total(), (&words.0, &words.1));
            let svg = svg.map_err(|reason| CliError::Plot {
                flag: "--plot",
                path: sink.path(),
                reason,
            })?;
            sink.write(streams, |output| output.write_all(svg.as_bytes()))?;
        }
    }
    let outputs = [&args.csv, &args.json, &args.cells];
    if outputs.into_iter().flatten().any(|path| is_stdout(path)) {
        return Ok(());
    }
    Ok(summary::write(streams.output, finished)?)
}

/// Refuses incompatible flags, before any other step.
fn check_flags(args: &EnsembleArgs) -> Result<(), CliError> {
    run_request::check_plot(args.plot.as_deref())?;
    let outputs = [
        &args.csv,
        &args.parquet,
        &args.json,
        &args.cells,
        &args.plot,
    ];
    let given: Vec<&PathBuf> = outputs.into_iter().flatten().collect();
    let twice = |(index, path): (usize, &&PathBuf)| given[..index].contains(path);
    if given.iter().enumerate().any(twice) {
        return Err(CliError::Usage(
            "--csv, --parquet, --json, --cells and --plot need different files (`-` can be used once)",
        ));
    }
    let streamed = args.csv.as_deref().is_some_and(is_stdout);
    if args.parquet.as_deref().is_some_and(is_stdout) {
        return Err(CliError::Usage("--parquet needs a file"));
    }
    if streamed && args.parquet.is_some() {
        return Err(CliError::Usage(
            "--csv - and --parquet: Parquet is made from the rows of a file; give a file to --csv",
        ));
    }
    if args.resume && row_file(args).is_none() {
        return Err(CliError::Usage(
            "--resume continues the file of --csv or --parquet: give one of them",
        ));
    }
    if args.parquet.is_some() && !cfg!(feature = "parquet") {
        return Err(CliError::Usage(
            "--parquet: this program was built without Parquet; build it with `--features parquet`",
        ));
    }
    let timed = args.course.impacts.is_none() || args.run.until.is_some();
    if args.density.is_some() && !timed {
        return Err(CliError::Usage(
            "--density needs a known end time: give --until with --impacts",
        ));
    }
    Ok(())
}

/// The file to which rows are appended: that of `--csv`, or a file next to that of `--parquet` during the run.
fn row_file(args: &EnsembleArgs) -> Option<(&'static str, PathBuf)> {
    match (&args.csv, &args.parquet) {
        (Some(csv), _) => (!is_stdout(csv)).then(|| ("--csv", csv.clone())),
        (None, Some(parquet)) => {
            let mut name = parquet.clone().into_os_string();
            name.push(".rows.csv");
            Some(("--parquet", PathBuf::from(name)))
        }
        (None, None) => None,
    }
}

fn members(
    model: &dyn AnyModel,
    args: &EnsembleArgs,
    streams: &mut Streams<'_>,
) -> Result<Members, CliError> {
    let description = model.description();
    let members = match &args.from {
        Some(path) => listed::read(path, streams.input, description)?,
        None => Members::varied(&args.vary, args.members, args.random, description)?,
    };
    let moved = |quantity: &Quantity| matches!(quantity, Quantity::Velocity(_));
    let given = state_input::beginning(model, &args.run.state)?;
    match given {
        Beginning::Given {
            rates: Rates::Momenta(_),
            ..
        } if members.quantities().iter().any(moved) => Err(CliError::Usage(
            "--p gives momenta, and velocities are varied: give --qdot",
        )),
        _ => Ok(members),
    }
}

fn density(
    model: &dyn AnyModel,
    args: &EnsembleArgs,
    shared: Shared<'_>,
) -> Result<Option<Density>, CliError> {
    let Some(text) = &args.density else {
        return Ok(None);
    };
    let wish = Wish::parse(text, model.description())?;
    pilot::density(wish, shared, [args.every, args.discard]).map(Some)
}

fn threads(args: &EnsembleArgs) -> u64 {
    match args.threads {
        Some(threads) => u64::from(threads),
        None => available_parallelism().map_or(1, |threads| threads.get() as u64),
    }
}

#[cfg(feature = "parquet")]
fn write_parquet(path: &Path, rows: &Path, plan: &Plan<'_>) -> Result<(), CliError> {
    let first = plan.range.start;
    ensemble::parquet::write(path, rows, plan.columns, plan.metadata, first).map_err(|error| {
        CliError::File {
            flag: "--parquet",
            path: path.to_owned(),
            source: std::io::Error::other(error),
        }
    })
}

/// NOTE: [`check_flags`] has refused the flag.
#[cfg(not(feature = "parquet"))]
fn write_parquet(_path: &Path, _rows: &Path, _plan: &Plan<'_>) -> Result<(), CliError> {
    Ok(())
}
