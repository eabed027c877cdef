//! `orbit`: a periodic orbit of a section and its Floquet multipliers, or a branch of such orbits.

pub mod branch;
mod document;
mod modulo;
mod summary;

use dalembert::OrbitError;
use dalembert_driver::{AnyModel, OffConstraint, Origin, Refusal, Search};

use modulo::Drift;

use crate::args::OrbitArgs;
use crate::entry::Entry;
use crate::error::CliError;
use crate::exit::Exit;
use crate::sink::{Sink, is_stdout};
use crate::state_input::{build_model, initial_state};
use crate::{Streams, names, run_request};

/// Longest time of an orbit, without `--until` and unless the model's `until` is longer.
const HORIZON: f64 = 3600.0;

/// A finished search: the request and its result. `T` is an orbit or a branch of orbits.
struct Finished<'a, T> {
    model: &'a dyn AnyModel,
    scene: &'a str,
    search: Search,
    result: Result<T, OrbitError>,
    /// Coordinates that drift, if no orbit was found because of them.
    drift: Option<Drift>,
}

/// Carries out `orbit`.
///
/// # Errors
/// Invalid flags, a scene without variations, a state that is refused, a file that cannot be written. If no orbit is
/// found, the result is not an error but [`Exit::Other`].
pub fn run(
    models: &[Entry],
    args: &OrbitArgs,
    streams: &mut Streams<'_>,
) -> Result<Exit, CliError> {
    if let Some(range) = &args.branch.range {
        return branch::run(models, args, range, streams);
    }
    let model = build_model(models, &args.model)?;
    let search = search(model.as_ref(), args)?;
    let origin = initial_state(model.as_ref(), &args.state)?;
    let json = Sink::open_given("--json", args.json.as_deref())?;
    let result = model.orbit(&origin, &search);
    let finished = finished(model.as_ref(), args, (&origin, search), result)?;
    if let Some(sink) = json {
        sink.write(streams, |output| document::write(output, &finished))?;
    }
    if !args.json.as_deref().is_some_and(is_stdout) {
        summary::write(streams.output, &finished)?;
    }
    Ok(exit(&finished))
}

/// Combines a search with the result of the driver.
fn finished<'a, T>(
    model: &'a dyn AnyModel,
    args: &'a OrbitArgs,
    (origin, search): (&Origin, Search),
    result: Result<Option<Result<T, OrbitError>>, Refusal>,
) -> Result<Finished<'a, T>, CliError> {
    let result = result.map_err(|refusal| CliError::refused(model, &refusal))?;
    let result = result.ok_or_else(|| invariable(args))?;
    let missed = result.as_ref().err();
    Ok(Finished {
        model,
        scene: &args.model.scene,
        drift: missed.and_then(|missed| modulo::drift(model, args, origin, &search, missed)),
        search,
        result,
    })
}

/// The exit status of a search.
const fn exit<T>(finished: &Finished<'_, T>) -> Exit {
    match finished.result {
        Ok(_) => Exit::Reached,
        Err(_) => Exit::Other,
    }
}

/// The error that explains why there are no variations.
fn invariable(args: &OrbitArgs) -> CliError {
    match args.model.scene.as_str() {
        "all" => CliError::Usage("orbit: the runs of this system have no derivatives"),
        scene => CliError::Invariable {
            scene: scene.to_owned(),
        },
    }
}

fn search(model: &dyn AnyModel, args: &OrbitArgs) -> Result<Search, CliError> {
    let description = model.description();
    if description.surfaces.is_empty() {
        return Err(CliError::Usage(
            "--surface: the model has no impact surfaces",
        ));
    }
    if args.state.off_constraint == OffConstraint::Keep {
        return Err(CliError::Usage(
            "--off-constraint keep: orbits are sought on the constraints; use error or project",
        ));
    }
    let surfaces = names::surfaces(description);
    let surface = names::find("--surface", "surface", &args.surface, surfaces)?;
    let until = model.initial().until.unwrap_or(0.0);
    let horizon = args.until.unwrap_or(until.max(HORIZON));
    let tolerance = args.series.tolerance()?;
    Ok(Search {
        surface,
        returns: args.period,
        horizon,
        tolerance,
        laws: run_request::laws(model, &args.series.law)?,
        policies: args.series.policies.policies(),
        modulo: modulo::group(model, args)?,
    })
}
