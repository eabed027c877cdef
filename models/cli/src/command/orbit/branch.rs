//! `orbit --continue`: a branch of periodic orbits over a parameter, as a table, as a document and as a picture. With a
//! second parameter, also the curves of its bifurcations in the plane of both.

mod curves;
mod document;
mod spreadsheet;
mod summary;

use dalembert_driver::{AnyModel, Branch, BranchEnd, Continuation, Extent, Member};

use super::Finished;
use crate::args::OrbitArgs;
use crate::entry::Entry;
use crate::error::CliError;
use crate::exit::Exit;
use crate::plot::branch::{Chart, Ordinate};
use crate::plot::{self, Drawn, quantity};
use crate::progress::Points;
use crate::sink::{Sink, is_stdout};
use crate::state_input::{build_model, initial_state};
use crate::{Streams, names, outcome, run_request, scalar};

/// A finished continuation.
struct Followed<'a> {
    finished: Finished<'a, Branch>,
    request: Continuation,
}

/// Carries out `orbit --continue`.
///
/// # Errors
/// The errors of [`run`](super::run).
pub fn run(
    models: &[Entry],
    args: &OrbitArgs,
    range: &str,
    streams: &mut Streams<'_>,
) -> Result<Exit, CliError> {
    let flags = &args.branch;
    run_request::check_outputs([&flags.csv, &args.json, &flags.plot])?;
    let open = || {
        Ok([
            Sink::open_given("--csv", flags.csv.as_deref())?,
            Sink::open_given("--json", args.json.as_deref())?,
            Sink::open_given("--plot", flags.plot.as_deref())?,
        ])
    };
    let terminal = streams.terminal;
    follow(
        models,
        args,
        range,
        terminal,
        open,
        |sinks, followed, ordinate| write(args, sinks, followed, ordinate, streams),
    )
}

/// Writes the files of `--csv`, `--json` and `--plot`, and the summary unless the table or the document is the standard
/// output.
fn write(
    args: &OrbitArgs,
    [csv, json, plot]: [Option<Sink>; 3],
    followed: &Followed<'_>,
    ordinate: Option<Ordinate>,
    streams: &mut Streams<'_>,
) -> Result<Exit, CliError> {
    let branch = followed.finished.result.as_ref().ok();
    if let (Some(sink), Some(branch)) = (csv, branch) {
        sink.write(streams, |output| {
            spreadsheet::write(output, followed, branch)
        })?;
    }
    if let Some(sink) = json {
        sink.write(streams, |output| document::write(output, followed))?;
    }
    if let (Some(sink), Some(branch)) = (plot, branch) {
        let svg = picture(followed, branch, ordinate);
        let svg = svg.map_err(|reason| CliError::picture(&args.branch.plot, reason))?;
        sink.write(streams, |output| output.write_all(svg.as_bytes()))?;
    }
    // Without a branch no table is written, so the summary with the reason may go to the standard output.
    let table = args.branch.csv.as_deref().filter(|_| branch.is_some());
    let mut outputs = [table, args.json.as_deref()].into_iter().flatten();
    if !outputs.any(is_stdout) {
        summary::write(streams.output, followed)?;
    }
    Ok(match branch {
        Some(branch) if !branch.points.is_empty() => Exit::Reached,
        _ => Exit::Other,
    })
}

/// The picture of a branch, without any file.
///
/// # Errors
/// The errors of [`run`], and a branch without points.
pub fn draw(models: &[Entry], args: &OrbitArgs) -> Result<Drawn, CliError> {
    let Some(range) = &args.branch.range else {
        return Err(CliError::Usage("--plot needs --continue NAME=A..B"));
    };
    follow(
        models,
        args,
        range,
        false,
        || Ok(()),
        |(), followed, ordinate| {
            let description = followed.finished.model.description();
            let svg = match &followed.finished.result {
                Ok(branch) => picture(followed, branch, ordinate),
                Err(missed) => Err(outcome::missed(description, missed).0.to_owned()),
            };
            Ok(Drawn {
                svg: svg.map_err(|reason| CliError::picture(&args.branch.plot, reason))?,
                outcome: summary::bifurcations(followed),
            })
        },
    )
}

/// Follows the branch and passes it to `finish`. `open` opens files once the flags are checked.
fn follow<F, T>(
    models: &[Entry],
    args: &OrbitArgs,
    range: &str,
    terminal: bool,
    open: impl FnOnce() -> Result<F, CliError>,
    finish: impl FnOnce(F, &Followed<'_>, Option<Ordinate>) -> Result<T, CliError>,
) -> Result<T, CliError> {
    let model = build_model(models, &args.model)?;
    let model = model.as_ref();
    let request = request(model, args, range)?;
    let ordinate = args
        .branch
        .axis
        .as_deref()
        .map(|name| ordinate(model, name));
    let ordinate = ordinate.transpose()?;
    let search = super::search(model, args)?;
    let origin = initial_state(model, &args.state)?;
    let files = open()?;
    let name = |extent: &Extent| model.description().parameters[extent.parameter].name;
    let mut progress = Points::new(terminal);
    let result = model.branch(&origin, &search, &request, &mut |member: &Member| {
        let (extent, value) = match (&request.across, member.second) {
            (Some(across), Some(second)) => (across, second),
            _ => (&request.extent, member.parameter),
        };
        let [first, last] = extent.range;
        progress.at(name(extent), value, (value - first) / (last - first));
    });
    progress.finish();
    let finished = super::finished(model, args, (&origin, search), result)?;
    finish(files, &Followed { finished, request }, ordinate)
}

fn request(model: &dyn AnyModel, args: &OrbitArgs, range: &str) -> Result<Continuation, CliError> {
    const ACROSS: &str = "--across";
    let flags = &args.branch;
    let extent = extent(model, "--continue", range)?;
    let across = flags.across.as_deref();
    let across = across.map(|range| self::extent(model, ACROSS, range));
    let across = across.transpose()?;
    if let (Some(other), Some(range)) = (&across, &flags.across)
        && other.parameter == extent.parameter
    {
        return Err(CliError::value(
            ACROSS,
            range,
            "a parameter other than that of --continue",
        ));
    }
    Ok(Continuation {
        extent,
        across,
        points: flags.points,
    })
}

/// A parameter and its range, from the value of a flag.
fn extent(model: &dyn AnyModel, flag: &'static str, text: &str) -> Result<Extent, CliError> {
    let (name, range) = names::assignment(flag, text, "NAME=A..B")?;
    let parameters = &model.description().parameters;
    let accepted = parameters.iter().map(|parameter| parameter.name);
    let parameter = names::find(flag, "parameter", name, accepted)?;
    let refuse = |expected: &str| CliError::value(flag, text, expected);
    let (first, last) = range.split_once("..").ok_or_else(|| refuse("NAME=A..B"))?;
    let end =
        |text: &str| scalar::parse(text).map_err(|expected| CliError::value(flag, text, expected));
    let range = [end(first)?, end(last)?];
    if range[0] == range[1] || !(range[1] - range[0]).is_finite() {
        return Err(refuse("NAME=A..B with two different ends"));
    }
    Ok(Extent { parameter, range })
}

fn ordinate(model: &dyn AnyModel, name: &str) -> Result<Ordinate, CliError> {
    let found = quantity::parse_one("--axis", name, &["period"], model.description())?;
    Ok(found.map_or(Ordinate::Period, Ordinate::Before))
}

fn picture(
    followed: &Followed<'_>,
    branch: &Branch,
    ordinate: Option<Ordinate>,
) -> Result<String, String> {
    let description = followed.finished.model.description();
    if let Some(across) = &followed.request.across {
        return curves::draw(followed, branch, across);
    }
    plot::branch::draw(&Chart {
        title: &super::summary::title(&followed.finished),
        subtitle: &format!("section {}", super::summary::section(&followed.finished)),
        parameter: followed.name(),
        range: followed.request.extent.range,
        ordinate: ordinate.unwrap_or_else(|| Ordinate::first(branch, description)),
        description,
        branch,
        ends: [0, 1].map(|side| reason(followed, &branch.ends[side])),
    })
}

impl Followed<'_> {
    /// The name of the second parameter.
    fn across(&self) -> Option<&'static str> {
        let across = self.request.across.as_ref()?;
        Some(self.finished.model.description().parameters[across.parameter].name)
    }

    /// The name of the parameter.
    fn name(&self) -> &'static str {
        self.finished.model.description().parameters[self.request.extent.parameter].name
    }
}

/// Explains in words why a branch ends.
fn reason(followed: &Followed<'_>, end: &BranchEnd) -> String {
    let description = followed.finished.model.description();
    match end {
        BranchEnd::Range => "the end of the range".to_owned(),
        BranchEnd::Grazing { surface } => {
            let name = names::surfaces(description).nth(*surface);
            format!("the orbit grazes `{}`", name.unwrap_or_default())
        }
        BranchEnd::Equilibrium { parameter } => {
            // The extrapolated value has nine digits of the range.
            let digits = 9.0 - followed.request.extent.width().log10().floor();
            let digits = digits.clamp(0.0, 300.0) as usize;
            let is_zero = parameter.abs() < 0.5 * 0.1_f64.powi(digits as i32);
            let parameter = if is_zero { 0.0 } else { *parameter };
            let name = followed.name();
            format!(
                "the orbit shrinks to an equilibrium: a Hopf bifurcation at {name} = {parameter:.digits$}"
            )
        }
        BranchEnd::Closed => "the branch is closed".to_owned(),
        BranchEnd::Parameter(error) => error.to_string(),
        BranchEnd::Missed(error) => {
            let told = outcome::remarks_on_orbit(description, error).into_iter();
            told.map(|(_, text)| text).next().unwrap_or_default()
        }
        BranchEnd::NotKnown => {
            "the stability of the next point is not known: multipliers are not finite".to_owned()
        }
        BranchEnd::Resonance => "a strong resonance: the multipliers meet at 1 or -1".to_owned(),
        BranchEnd::NotConverged => {
            "Newton's method does not converge at the smallest step".to_owned()
        }
        BranchEnd::Points => "the number of steps in --points".to_owned(),
        BranchEnd::Turned => "the branch turns back before it".to_owned(),
    }
}
