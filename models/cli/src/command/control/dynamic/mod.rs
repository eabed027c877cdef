//! `control --dp`: dynamic programming on a grid, as a summary, tables, a document and a picture.

mod document;
mod path;
mod picture;
mod problem;
mod solution;
mod spreadsheet;
mod summary;

use crate::args::ControlArgs;
use crate::entry::Entry;
use crate::error::CliError;
use crate::exit::Exit;
use crate::plot::Drawn;
use crate::sink::Sink;
use crate::{Streams, run_request};
use path::Path;
use problem::Problem;
use solution::Solution;

/// A solved problem with its paths.
struct Finished {
    problem: Problem,
    solution: Solution,
    paths: Vec<Path>,
}

/// Carries out `control --dp`.
///
/// # Errors
/// Invalid flags, a model whose state or inputs do not fit a grid, a file that cannot be written. A path that leaves
/// the grid is not an error but [`Exit::Other`].
pub fn run(
    models: &[Entry],
    args: &ControlArgs,
    streams: &mut Streams<'_>,
) -> Result<Exit, CliError> {
    let problem = Problem::of(models, args)?;
    picture::check(&problem, args)?;
    // The files are opened before the work, so that a path that cannot be written is reported at once.
    let csv = Sink::open_given("--csv", args.csv.as_deref())?;
    let json = Sink::open_given("--json", args.json.as_deref())?;
    let inputs = Sink::open_given("--inputs", args.inputs.as_deref())?;
    let plot = Sink::open_given("--plot", args.plot.as_deref())?;
    let mut finished = solve(problem, args, streams.terminal)?;
    for path in &mut finished.paths {
        path.compare(models, args)?;
    }
    if let Some(sink) = csv {
        sink.write(streams, |output| spreadsheet::write(output, &finished))?;
    }
    if let Some(sink) = json {
        sink.write(streams, |output| document::write(output, &finished))?;
    }
    if let Some(sink) = inputs {
        sink.write(streams, |output| spreadsheet::write_path(output, &finished))?;
    }
    if let Some(sink) = plot {
        let svg = picture::draw(&finished, args)?;
        sink.write(streams, |output| output.write_all(svg.as_bytes()))?;
    }
    if !run_request::uses_stdout([&args.csv, &args.json, &args.inputs]) {
        summary::write(streams.output, &finished)?;
    }
    Ok(
        match finished.paths.iter().all(|path| path.left.is_none()) {
            true => Exit::Reached,
            false => Exit::Other,
        },
    )
}

/// The picture that `control --dp` writes with these flags.
///
/// # Errors
/// The errors of [`run`] except those of files.
pub fn draw(models: &[Entry], args: &ControlArgs) -> Result<Drawn, CliError> {
    let problem = Problem::of(models, args)?;
    picture::check(&problem, args)?;
    let finished = solve(problem, args, false)?;
    Ok(Drawn {
        svg: picture::draw(&finished, args)?,
        outcome: summary::outcome(&finished),
    })
}

fn solve(problem: Problem, args: &ControlArgs, terminal: bool) -> Result<Finished, CliError> {
    let solution = Solution::of(&problem, args.dynamic.at, terminal)?;
    let starts = problem.starts(args)?;
    let paths = starts
        .into_iter()
        .map(|from| Path::follow(&problem, &solution, from));
    Ok(Finished {
        paths: paths.collect::<Result<_, CliError>>()?,
        problem,
        solution,
    })
}
