//! `ensemble`: runs many members of one scene and writes rows, a summary and a density.

mod cells;
mod document;
mod summary;

use std::path::PathBuf;
use std::time::{Duration, Instant};

use dalembert_driver::ensemble::density::{Checkpoint, Counts, Density, convergence};
use dalembert_driver::ensemble::row::Columns;
use dalembert_driver::ensemble::runner::{End, Shared};
use dalembert_driver::ensemble::{Members, Tally, pilot};
use dalembert_driver::{AnyModel, Settings};
use serde_json::{Map, Value};

use crate::args::EnsembleArgs;
use crate::ensemble::common::Flags;
use crate::ensemble::members::{self, Shard};
use crate::ensemble::metadata::metadata;
use crate::ensemble::output::Table;
use crate::ensemble::statistics::Statistics;
use crate::ensemble::{self, Plan, Summary, density, listed, merge};
use crate::entry::Entry;
use crate::error::CliError;
use crate::exit::Exit;
use crate::expression;
use crate::sink::{Sink, is_stdout};
use crate::state_input::build_model;
use crate::{Streams, plot, run_request};

/// A finished ensemble: its request and its results.
struct Finished<'a> {
    model: &'a dyn AnyModel,
    settings: &'a Settings,
    metadata: &'a Map<String, Value>,
    tally: Tally,
    statistics: Statistics,
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
        let text = "--input: an ensemble leaves inputs at 0; give them a law by --feedback, or declare a parameter in place of an input that members vary";
        return Err(CliError::Usage(text));
    }
    let models = &*expression::with_outputs(models, &args.run.model.model, &args.output)?;
    let model = build_model(models, &args.run.model)?;
    let model = model.as_ref();
    let settings = run_request::course(model, &args.run, &args.course)?;
    let members = read_members(model, args, streams)?;
    let shard = args
        .shard
        .as_deref()
        .map_or(Ok(Shard::WHOLE), Shard::parse)?;
    let flags = Flags {
        models,
        run: &args.run,
    };
    let mut shared = Shared {
        common: &flags,
        off_constraint: args.run.state.off_constraint,
        settings: &settings,
        end: End::of(args.run.until, settings.impacts),
        members: &members,
        density: None,
        starts: &[],
    };
    let density = measured(model, args, shared)?;
    shared.density = density.as_ref();
    let metadata = metadata(model, &args.run, &shared, shard)?;
    let columns = Columns::of(model.description(), &members);
    let range = shard.range(members.count());
    let merged = merge::parts(&args.merge, &metadata, members.count())?;
    let plan = Plan {
        shared,
        range: range.clone(),
        threads: args.rows.thread_count(),
        table: Table {
            columns: &columns,
            metadata: &metadata,
            first: range.start,
        },
        merged: &merged,
    };
    // Opened before the runs, so that a path that cannot be written is reported at once.
    let cells = Sink::open_given("--cells", args.cells.as_deref())?;
    let json = Sink::open_given("--json", args.json.as_deref())?;
    let plot = Sink::open_given("--plot", args.plot.as_deref())?;

    let begun = Instant::now();
    let Summary {
        tally,
        statistics,
        counts,
        kept,
    } = args.rows.write(&plan.table, streams.output, |rows| {
        ensemble::execute(&plan, rows, streams.terminal)
    })?;
    let members = tally.members;
    let finished = Finished {
        model,
        settings: &settings,
        metadata: &metadata,
        tally,
        statistics,
        density: density.as_ref().zip(counts).map(|(density, counts)| {
            let checkpoints = convergence(&counts, density, members);
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

/// Writes the files and the summary of the whole ensemble.
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
    let outputs = [&args.rows.csv, &args.json, &args.cells];
    if outputs.into_iter().flatten().any(|path| is_stdout(path)) {
        return Ok(());
    }
    Ok(summary::write(streams.output, finished)?)
}

/// Refuses incompatible flags, before any other step.
fn check_flags(args: &EnsembleArgs) -> Result<(), CliError> {
    run_request::check_plot(args.plot.as_deref())?;
    let outputs = [
        &args.rows.csv,
        &args.rows.parquet,
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
    args.rows.check()?;
    if !args.merge.is_empty() && given.iter().any(|path| args.merge.contains(path)) {
        return Err(CliError::Usage(
            "--merge: a file of a shard cannot be an output too; give another name to --csv",
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

fn read_members(
    model: &dyn AnyModel,
    args: &EnsembleArgs,
    streams: &mut Streams<'_>,
) -> Result<Members, CliError> {
    let description = model.description();
    let members = match &args.from {
        Some(path) => {
            let start = listed::Start {
                mode: model.present_mode(),
                depends_on_time: model.depends_on_time(),
            };
            listed::read(path, streams.input, description, start)?
        }
        None => members::varied(&args.vary, args.members, args.random, description)?,
    };
    members::check_start(&members, model, &args.run.state)?;
    Ok(members)
}

fn measured(
    model: &dyn AnyModel,
    args: &EnsembleArgs,
    shared: Shared<'_>,
) -> Result<Option<Density>, CliError> {
    let Some(text) = &args.density else {
        return Ok(None);
    };
    let axes = density::parse(text, model.description())?;
    let density = pilot::density(axes, shared, [args.every, args.discard]);
    match density.map_err(CliError::Start)? {
        None => Err(CliError::Usage(
            "--density: a run ends before the first counted state; make --every or --discard smaller, or --until later",
        )),
        density => Ok(density),
    }
}
