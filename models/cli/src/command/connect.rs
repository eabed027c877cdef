//! `connect`: motions between two configurations, as a summary, a table, a document and a picture.

mod document;
mod film;
mod spreadsheet;
mod summary;

use dalembert::describe::Description;
use dalembert_driver::{AnyModel, Boundary, Connected, Unjoined};

use crate::args::ConnectArgs;
use crate::entry::Entry;
use crate::error::{self, CliError};
use crate::exit::Exit;
use crate::plot::{Drawn, quantity};
use crate::sink::Sink;
use crate::state_input::build_model;
use crate::{Streams, ends, names, run_request};

/// A finished search: the request and its result.
struct Finished<'a> {
    model: &'a dyn AnyModel,
    scene: &'a str,
    seed: u64,
    boundary: Boundary,
    connected: Connected,
}

/// Carries out `connect`.
///
/// # Errors
/// Invalid flags, a configuration that is refused, a file that cannot be written. If no motion is found, the result is
/// not an error but [`Exit::Other`].
pub fn run(
    models: &[Entry],
    args: &ConnectArgs,
    streams: &mut Streams<'_>,
) -> Result<Exit, CliError> {
    run_request::check_outputs([&args.csv, &args.json, &args.plot])?;
    let model = build_model(models, &args.model)?;
    let boundary = boundary(model.as_ref(), args)?;
    quantity::check("--axes", args.axes.as_deref(), model.description())?;
    // The files are opened before the search, so that a path that cannot be written is reported at once.
    let csv = Sink::open_given("--csv", args.csv.as_deref())?;
    let json = Sink::open_given("--json", args.json.as_deref())?;
    let plot = Sink::open_given("--plot", args.plot.as_deref())?;
    let finished = find(model.as_ref(), args, boundary, streams.terminal)?;
    if let Some(sink) = csv {
        sink.write(streams, |output| spreadsheet::write(output, &finished))?;
    }
    if let Some(sink) = json {
        sink.write(streams, |output| document::write(output, &finished))?;
    }
    if let Some(sink) = plot {
        let svg = film::picture(&finished, args)?;
        sink.write(streams, |output| output.write_all(svg.as_bytes()))?;
    }
    if !run_request::uses_stdout([&args.csv, &args.json]) {
        summary::write(streams.output, &finished)?;
    }
    Ok(match finished.connected.connections.is_empty() {
        false => Exit::Reached,
        true => Exit::Other,
    })
}

/// The picture that `connect` writes with these flags.
///
/// # Errors
/// The errors of [`run`] except those of files.
pub fn draw(models: &[Entry], args: &ConnectArgs) -> Result<Drawn, CliError> {
    let model = build_model(models, &args.model)?;
    let boundary = boundary(model.as_ref(), args)?;
    quantity::check("--axes", args.axes.as_deref(), model.description())?;
    let finished = find(model.as_ref(), args, boundary, false)?;
    Ok(Drawn {
        svg: film::picture(&finished, args)?,
        outcome: summary::counted(&finished),
    })
}

/// Runs the search.
fn find<'a>(
    model: &'a dyn AnyModel,
    args: &'a ConnectArgs,
    boundary: Boundary,
    terminal: bool,
) -> Result<Finished<'a>, CliError> {
    let about = (model, args.model.scene.as_str(), "--from");
    let connected = ends::sought(
        about,
        terminal,
        |tell| model.connect(&boundary, tell),
        refused,
    )?;
    Ok(Finished {
        model,
        scene: &args.model.scene,
        seed: args.search.seed,
        boundary,
        connected,
    })
}

/// The error for a problem that is refused, in the model's names.
fn refused(description: &Description, unjoined: &Unjoined) -> CliError {
    let coordinates: Vec<&str> = names::coordinates(description).collect();
    let surface = |index: usize| names::surfaces(description).nth(index).unwrap_or_default();
    let (place, reason) = match unjoined {
        Unjoined::FirstOrder => ("MODEL", format!("{unjoined}; use simulate")),
        Unjoined::Unreduced => ("MODEL", format!("{unjoined}; `derive` says why")),
        &Unjoined::Count {
            equations,
            unknowns,
        } => {
            let given = error::counted(equations, "coordinate");
            let verb = if equations == 1 { "is" } else { "are" };
            let free = match unknowns {
                1 => "1 free component".to_owned(),
                several => format!("{several} free components"),
            };
            let list = coordinates.join(", ");
            let reason = format!(
                "{given} {verb} given, and the velocity at the start has {free}; name {unknowns} of {list}"
            );
            ("--to", reason)
        }
        &Unjoined::Behind {
            is_end,
            surface: index,
            gap,
        } => {
            let place = if is_end { "--to" } else { "--from" };
            (
                place,
                format!(
                    "the configuration lies behind `{}`: its gap is {gap}",
                    surface(index)
                ),
            )
        }
        &Unjoined::Level {
            constraint,
            difference,
        } => {
            let name = description.constraints[constraint].name;
            (
                "--to",
                format!("the constraint `{name}` keeps a value that differs by {difference} there"),
            )
        }
        Unjoined::Envelope { .. } => ("--envelope", unjoined.to_string()),
        Unjoined::End(error) => ("--to", error::state_text(description, error)),
        other => ("connect", other.to_string()),
    };
    CliError::Input {
        place: place.to_owned(),
        reason,
    }
}

/// The boundary value problem that the flags state.
fn boundary(model: &dyn AnyModel, args: &ConnectArgs) -> Result<Boundary, CliError> {
    let description = model.description();
    if !description.modes.is_empty() {
        return Err(CliError::Usage(
            "connect: motions that change between modes are not supported; declare the mode as a model of its own",
        ));
    }
    let impacts = ends::impacts(&args.search.impacts)?;
    if description.surfaces.is_empty() && impacts[1] > 0 {
        return Err(CliError::Usage(
            "--impacts: the model has no impact surfaces",
        ));
    }
    let coordinates = || names::coordinates(description);
    let to = ends::components("--to", "coordinate", coordinates(), &args.to)?;
    if to.iter().all(Option::is_none) {
        return Err(CliError::value(
            "--to",
            args.to.join(","),
            "a coordinate, NAME=VALUE",
        ));
    }
    let tolerance = args.series.tolerance()?;
    Ok(Boundary {
        from: start(model, args)?,
        to,
        time: args.time,
        impacts,
        tolerance,
        laws: run_request::laws(model, &args.series.law)?,
        policies: args.series.policies.policies(),
        directions: args.search.starts.map(|count| count as usize),
        seed: args.search.seed,
        kinetic: args.energy,
        envelope: args.envelope.map_or(0, |count| count as usize),
    })
}

/// The positions at the start: those of `--from`, and of the model's initial state. Constraints determine the others.
fn start(model: &dyn AnyModel, args: &ConnectArgs) -> Result<Vec<f64>, CliError> {
    let description = model.description();
    let mut start = model.initial();
    let coordinates = names::coordinates(description);
    let given = ends::components("--from", "coordinate", coordinates, &args.from)?;
    for (index, value) in given.into_iter().enumerate() {
        if let Some(value) = value {
            start.q[index] = value;
            start.placed[index] = true;
        }
    }
    let completed = model.complete_position(&start.q, &start.placed);
    completed.map_err(|error| CliError::state("--from", description, error))
}
