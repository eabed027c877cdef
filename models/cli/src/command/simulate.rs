//! `simulate`: a run from a state to its end, kept as a summary, a table, a document and a picture.

mod document;
mod summary;

use crate::accuracy::Verified;
use crate::args::SimulateArgs;
use crate::driver::{Ending, Settings};
use crate::entry::{AnyModel, Entry, Origin};
use crate::error::CliError;
use crate::exit::Exit;
use crate::plot::{self, Picture, trace::Trace};
use crate::progress::Progress;
use crate::record::{Grid, Recorder, Wanted};
use crate::sink::Sink;
use crate::state_input::{build_model, initial_state};
use crate::{Streams, run_request, table};

/// A run that has ended, with what the files say of it.
pub(crate) struct Finished<'a> {
    pub model: &'a dyn AnyModel,
    pub scene: &'a str,
    pub settings: &'a Settings,
    pub record: Recorder,
    pub ending: Ending,
    /// Its measured error, if that was asked for.
    pub verified: Option<Verified>,
}

/// Carries out `simulate`.
///
/// # Errors
/// Bad flags, a state that is refused, a file that cannot be written. Any outcome of the run itself is not an
/// error but an [`Exit`].
pub fn run(
    models: &[Entry],
    args: &SimulateArgs,
    streams: &mut Streams<'_>,
) -> Result<Exit, CliError> {
    run_request::check_outputs([&args.csv, &args.json, &args.plot])?;
    let model = build_model(models, &args.run.model)?;
    let settings = run_request::course(model.as_ref(), &args.run, &args.course)?;
    let origin = initial_state(model.as_ref(), &args.run.state)?;
    // Opened before the run: a path that cannot be written is better known at once.
    let csv = Sink::open_given("--csv", args.csv.as_deref())?;
    let json = Sink::open_given("--json", args.json.as_deref())?;
    let plot = Sink::open_given("--plot", args.plot.as_deref())?;

    let (record, ending) = carry_out(model.as_ref(), &origin, &settings, args, streams.terminal)?;
    let verified = match args.verify {
        true => Some(verify(model.as_ref(), &origin, &settings, &ending)?),
        false => None,
    };
    let finished = Finished {
        model: model.as_ref(),
        scene: &args.run.model.scene,
        settings: &settings,
        record,
        ending,
        verified,
    };

    let description = model.description();
    if let Some(sink) = json {
        sink.write(streams, |output| document::write(output, &finished))?;
    }
    if let Some(sink) = csv {
        let (samples, impacts) = (&finished.record.samples, &finished.record.impacts);
        sink.write(streams, |output| {
            table::write(output, &description, samples, impacts)
        })?;
    }
    if let Some(sink) = plot {
        let svg = picture(&finished).map_err(|reason| CliError::Plot {
            flag: "--plot",
            path: sink.path(),
            reason,
        })?;
        sink.write(streams, |output| output.write_all(svg.as_bytes()))?;
    }
    if !run_request::uses_stdout([&args.csv, &args.json]) {
        summary::write(streams.output, &finished)?;
    }
    Ok(if finished.ending.reached {
        Exit::Reached
    } else {
        Exit::Other
    })
}

/// Measures the error of a run up to where it ended.
fn verify(
    model: &dyn AnyModel,
    origin: &Origin,
    settings: &Settings,
    ending: &Ending,
) -> Result<Verified, CliError> {
    let until = match settings.impacts {
        // The horizon is far beyond the last impact that was asked for; positions are compared on the way to it, and
        // a little later, where other runs may have it.
        Some(_) => ending.t * 1.01,
        None => settings.until,
    };
    let settings = Settings {
        until,
        ..settings.clone()
    };
    model.verify(origin, &settings).map_err(CliError::Start)
}

/// Makes the run. Where the end time is not known beforehand the same run is made twice, first to find the end
/// and then to sample it: runs are deterministic, and nothing has to be kept that is not asked for.
fn carry_out(
    model: &dyn AnyModel,
    origin: &Origin,
    settings: &Settings,
    args: &SimulateArgs,
    terminal: bool,
) -> Result<(Recorder, Ending), CliError> {
    let sampled = args.csv.is_some() || args.json.is_some();
    let progress = || Progress::new(settings.until, terminal);
    let mut grid = Grid {
        end: settings.until,
        count: if sampled { args.samples } else { 0 },
    };
    if sampled && settings.impacts.is_some() && args.run.until.is_none() {
        let nothing = Wanted {
            grid: Grid { count: 0, ..grid },
            impacts: false,
            trace: None,
        };
        let mut recorder = Recorder::new(nothing, progress());
        grid.end = model
            .simulate(origin, settings, &mut recorder)
            .map_err(CliError::Start)?
            .t;
    }
    if grid.end == 0.0 {
        grid.count = grid.count.min(1);
    }
    let trace = args
        .plot
        .is_some()
        .then(|| Trace::new(model.description().view.is_some()));
    let wanted = Wanted {
        grid,
        impacts: sampled || trace.is_some(),
        trace,
    };
    let mut recorder = Recorder::new(wanted, progress());
    let ending = model
        .simulate(origin, settings, &mut recorder)
        .map_err(CliError::Start)?;
    recorder.finish(ending.t, &ending.last);
    Ok((recorder, ending))
}

/// The run's picture as SVG.
fn picture(finished: &Finished<'_>) -> Result<String, String> {
    let Some(trace) = &finished.record.trace else {
        return Ok(String::new());
    };
    plot::draw(&Picture {
        model: finished.model,
        title: summary::title(finished),
        subtitle: summary::subtitle(finished),
        trace,
        impacts: &finished.record.impacts,
        first: &finished.ending.first,
        last: (finished.ending.t, &finished.ending.last),
    })
}
