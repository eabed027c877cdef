//! `simulate`: a run from a state to its end, kept as a summary, a table, a document and a picture.

mod document;
mod request;
mod summary;

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
use crate::{Streams, table};

/// A run that has ended, with what the files say of it.
pub(crate) struct Finished<'a> {
    pub model: &'a dyn AnyModel,
    pub scene: &'a str,
    pub settings: &'a Settings,
    pub record: Recorder,
    pub ending: Ending,
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
    request::check_outputs(args)?;
    let model = build_model(models, &args.model)?;
    let settings = request::settings(model.as_ref(), args)?;
    let origin = initial_state(model.as_ref(), &args.state)?;
    // Opened before the run: a path that cannot be written is better known at once.
    let [csv, json, plot] = [
        ("--csv", &args.csv),
        ("--json", &args.json),
        ("--plot", &args.plot),
    ]
    .map(|(flag, path)| {
        path.as_deref()
            .map(|path| Sink::open(flag, path))
            .transpose()
    });
    let (csv, json, plot) = (csv?, json?, plot?);

    let (record, ending) = carry_out(model.as_ref(), &origin, &settings, args, streams.terminal)?;
    let finished = Finished {
        model: model.as_ref(),
        scene: &args.model.scene,
        settings: &settings,
        record,
        ending,
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
    if !request::uses_stdout(args) {
        summary::write(streams.output, &finished)?;
    }
    Ok(if finished.ending.reached {
        Exit::Reached
    } else {
        Exit::Other
    })
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
    if sampled && settings.impacts.is_some() && args.until.is_none() {
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
