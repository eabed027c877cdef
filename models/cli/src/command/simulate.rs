//! `simulate`: a run from a state to its end, as a summary, a table, a document and a picture.

mod certify;
mod document;
pub mod summary;

use dalembert_driver::accuracy::Verified;
use dalembert_driver::{AnyModel, Ending, Grid, Origin, Settings};

use crate::args::SimulateArgs;
use crate::entry::Entry;
use crate::error::CliError;
use crate::exit::Exit;
use crate::expression;
use crate::input_table::{self, InputTable};
use crate::plot::trace::{Source, Trace};
use crate::plot::{self, Drawn, Picture, quantity};
use crate::progress::Progress;
use crate::record::{Keep, Record, Recorder, Wanted};
use crate::sink::Sink;
use crate::state_input::{build_run, initial_state};
use crate::table::RunTable;
use crate::{Streams, run_request};

/// A finished run: its request and its results.
pub(crate) struct Finished<'a> {
    pub model: &'a dyn AnyModel,
    pub scene: &'a str,
    pub settings: Settings,
    /// Inputs that change.
    pub inputs: Option<InputTable>,
    pub record: Record,
    pub ending: Ending,
    /// Its measured error, if requested.
    pub verified: Option<Verified>,
}

/// Settings, start, inputs and picture of a run.
#[derive(Clone)]
pub struct Prepared {
    pub settings: Settings,
    pub origin: Origin,
    /// Inputs that change.
    pub inputs: Option<InputTable>,
    /// The quantities that the picture shows, if a picture is requested.
    pub source: Option<Source>,
}

/// Carries out `simulate`.
///
/// # Errors
/// Invalid flags, a state that is refused, a file that cannot be written. No outcome of the run is an error: it is an
/// [`Exit`].
pub fn run(
    models: &[Entry],
    args: &SimulateArgs,
    streams: &mut Streams<'_>,
) -> Result<Exit, CliError> {
    let models = &*expression::with_outputs(models, &args.run.model.model, &args.output)?;
    if args.certify.certify {
        return certify::run(models, args, streams);
    }
    run_request::check_outputs([&args.csv, &args.json, &args.html, &args.plot])?;
    let model = build_run(models, &args.run)?;
    let prepared = prepare(model.as_ref(), args)?;
    // Opened before the run, so that a path that cannot be written is reported at once.
    let csv = Sink::open_given("--csv", args.csv.as_deref())?;
    let json = Sink::open_given("--json", args.json.as_deref())?;
    let plot = Sink::open_given("--plot", args.plot.as_deref())?;
    let html = Sink::open_given("--html", args.html.as_deref())?;

    let (finished, rows) =
        write_as_it_goes(model.as_ref(), prepared, args, csv, json.as_ref(), streams)?;
    for warning in &finished.ending.warnings {
        writeln!(streams.errors, "warning: {warning}")?;
    }
    if let Some((sink, rows)) = json.zip(rows) {
        sink.write(streams, |output| document::write(output, &finished, &rows))?;
    }
    if let Some(sink) = plot {
        let svg = picture(&finished, args)?;
        sink.write(streams, |output| output.write_all(svg.as_bytes()))?;
    }
    if let Some(sink) = html {
        let page = page(&finished, args);
        sink.write(streams, |output| output.write_all(page.as_bytes()))?;
    }
    if !run_request::uses_stdout([&args.csv, &args.json]) {
        summary::write(streams.output, &finished)?;
    }
    let is_doubted = matches!(finished.verified, Some(Verified::Doubted { .. }));
    Ok(match finished.ending.reached && !is_doubted {
        true => Exit::Reached,
        false => Exit::Other,
    })
}

/// Makes the run. The table is written during the run; the rows of the JSON document are kept until its end.
fn write_as_it_goes<'a>(
    model: &'a dyn AnyModel,
    prepared: Prepared,
    args: &'a SimulateArgs,
    csv: Option<Sink>,
    json: Option<&Sink>,
    streams: &mut Streams<'_>,
) -> Result<(Finished<'a>, Option<document::Rows<'a>>), CliError> {
    let description = model.description();
    let output = &mut *streams.output;
    let mut table = csv.map(|sink| RunTable::new(description, sink.stream(output)));
    let mut rows = json.map(|sink| document::Rows::new(description, sink.path()));
    let mut keeps: Vec<&mut dyn Keep> = Vec::new();
    keeps.extend(table.as_mut().map(|table| table as &mut dyn Keep));
    keeps.extend(rows.as_mut().map(|rows| rows as &mut dyn Keep));
    let finished = finish(model, prepared, args, keeps, streams.terminal)?;
    if let Some(table) = table {
        table.finish()?;
    }
    Ok((finished, rows))
}

/// The picture that `simulate` writes with these flags.
///
/// # Errors
/// The errors of [`run`] except those of files.
pub fn draw(models: &[Entry], args: &SimulateArgs) -> Result<Drawn, CliError> {
    let models = &*expression::with_outputs(models, &args.run.model.model, &args.output)?;
    let model = build_run(models, &args.run)?;
    let prepared = prepare(model.as_ref(), args)?;
    let finished = finish(model.as_ref(), prepared, args, Vec::new(), false)?;
    Ok(Drawn {
        svg: picture(&finished, args)?,
        outcome: summary::ended(model.description(), &finished.ending),
    })
}

/// Reads the settings, the start, the inputs and the request for a picture, and refuses invalid ones before the run.
///
/// # Errors
/// Invalid flags, a state that is refused.
pub fn prepare(model: &dyn AnyModel, args: &SimulateArgs) -> Result<Prepared, CliError> {
    let description = model.description();
    let is_drawn = args.plot.is_some() || args.html.is_some();
    let source = match &args.axes {
        _ if !is_drawn => None,
        Some(axes) => Some(Source::Quantities(quantity::parse(
            "--axes",
            axes,
            description,
        )?)),
        None if description.view.is_some() => Some(Source::View),
        None => Some(Source::Coordinates),
    };
    let mut course = args.course.clone();
    if args.inputs.is_some() {
        course.integrator = course.integrator.with_changing_inputs();
    }
    Ok(Prepared {
        settings: run_request::course(model, &args.run, &course)?,
        origin: initial_state(model, &args.run.state)?,
        inputs: input_table::given(args.inputs.as_deref(), args.between, model)?,
        source,
    })
}

/// Makes the run, and measures its error if requested.
fn finish<'a>(
    model: &'a dyn AnyModel,
    prepared: Prepared,
    args: &'a SimulateArgs,
    keeps: Vec<&mut dyn Keep>,
    terminal: bool,
) -> Result<Finished<'a>, CliError> {
    let (record, ending) = carry_out(model, &prepared, args, keeps, terminal)?;
    let Prepared {
        settings,
        origin,
        inputs,
        ..
    } = prepared;
    let verified = match args.verify {
        true => Some(
            model
                .verify(&origin, &settings, &ending)
                .map_err(|refusal| CliError::refused(model, &refusal))?,
        ),
        false => None,
    };
    Ok(Finished {
        model,
        scene: &args.run.model.scene,
        settings,
        inputs,
        record,
        ending,
        verified,
    })
}

/// Makes the run. If the end time is not known beforehand, the run is made twice: first to find the end, then to sample
/// it. Both runs are the same, because runs are deterministic.
fn carry_out(
    model: &dyn AnyModel,
    Prepared {
        settings,
        origin,
        inputs,
        source,
    }: &Prepared,
    args: &SimulateArgs,
    keeps: Vec<&mut dyn Keep>,
    terminal: bool,
) -> Result<(Record, Ending), CliError> {
    let simulate = |recorder: &mut Recorder<'_>| match inputs {
        Some(table) => table.simulate(model, origin, settings, recorder),
        None => model
            .simulate(origin, settings, recorder)
            .map_err(|refusal| CliError::refused(model, &refusal)),
    };
    let sampled = !keeps.is_empty();
    let progress = || Progress::new(settings.until, terminal);
    let mut grid = Grid {
        end: settings.until,
        count: if sampled { args.samples } else { 0 },
    };
    if sampled && settings.impacts.is_some() && args.run.until.is_none() {
        let nothing = Wanted {
            grid: Grid { count: 0, ..grid },
            trace: None,
            keeps: Vec::new(),
        };
        let mut recorder = Recorder::new(nothing, progress());
        grid.end = simulate(&mut recorder)?.t;
    }
    if grid.end == 0.0 {
        grid.count = grid.count.min(1);
    }
    let wanted = Wanted {
        grid,
        trace: source.clone().map(Trace::of),
        keeps,
    };
    let mut recorder = Recorder::new(wanted, progress());
    let ending = simulate(&mut recorder)?;
    let record = recorder.finish(ending.t, &ending.last)?;
    Ok((record, ending))
}

/// The page that plays the run of these flags.
///
/// # Errors
/// The errors of [`run`] except those of files.
pub fn play(models: &[Entry], args: &SimulateArgs) -> Result<String, CliError> {
    let models = &*expression::with_outputs(models, &args.run.model.model, &args.output)?;
    let model = build_run(models, &args.run)?;
    let prepared = prepare(model.as_ref(), args)?;
    let finished = finish(model.as_ref(), prepared, args, Vec::new(), false)?;
    Ok(page(&finished, args))
}

/// The page that plays the run.
fn page(finished: &Finished<'_>, args: &SimulateArgs) -> String {
    let drawn = drawing(finished, args);
    drawn.map_or_else(String::new, |drawn| {
        plot::player::page(&drawn, args.duration)
    })
}

/// The run's picture as SVG.
fn picture(finished: &Finished<'_>, args: &SimulateArgs) -> Result<String, CliError> {
    let Some(drawn) = drawing(finished, args) else {
        return Ok(String::new());
    };
    plot::draw(&drawn).map_err(|reason| CliError::picture(&args.plot, reason))
}

/// The content of the run's picture; `None` if no picture was requested.
fn drawing<'a>(finished: &'a Finished<'_>, args: &SimulateArgs) -> Option<Picture<'a>> {
    Some(Picture {
        model: finished.model,
        title: summary::title(finished),
        subtitle: summary::subtitle(finished),
        width: f64::from(args.plot_width),
        trace: finished.record.trace.as_ref()?,
        impacts: &finished.record.impacts,
        first: &finished.ending.first,
        last: (finished.ending.t, &finished.ending.last),
    })
}
