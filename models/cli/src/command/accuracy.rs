//! `accuracy`: the cost of accuracy, as a text table, as CSV, as JSON and as a work-precision diagram.

mod document;
mod spreadsheet;

use std::io::{self, Write};
use std::time::Duration;

use dalembert_driver::accuracy::{FINEST, NoChoice, Plan, Sample, Study};
use dalembert_driver::course::IntegratorChoice;
use dalembert_driver::{AnyModel, Integrator, Origin, Settings};

use crate::args::AccuracyArgs;
use crate::entry::Entry;
use crate::error::CliError;
use crate::exit::Exit;
use crate::names;
use crate::plot::{Drawn, work};
use crate::progress::Steps;
use crate::sink::Sink;
use crate::state_input::{build_run, initial_state};
use crate::{Streams, run_request};

/// A finished study, with the model and the settings that its files name.
struct Finished<'a> {
    model: &'a dyn AnyModel,
    scene: &'a str,
    settings: Settings,
    study: Study,
    wanted: Option<f64>,
}

/// The picture that `accuracy` writes with these flags.
///
/// # Errors
/// The errors of [`run`] except those of files.
pub fn draw(models: &[Entry], args: &AccuracyArgs) -> Result<Drawn, CliError> {
    let model = build_run(models, &args.run)?;
    let finished = measure(model.as_ref(), prepare(model.as_ref(), args)?, args, false)?;
    Ok(Drawn {
        svg: finished.picture(args)?,
        outcome: finished.study.outcome.kind().to_owned(),
    })
}

/// Carries out `accuracy`.
///
/// # Errors
/// Invalid flags, a state that is refused, a file that cannot be written. If no integrator reaches the wanted error, or
/// if the reference is not confirmed, the result is an [`Exit`] and not an error.
pub fn run(
    models: &[Entry],
    args: &AccuracyArgs,
    streams: &mut Streams<'_>,
) -> Result<Exit, CliError> {
    run_request::check_outputs([&args.csv, &args.json, &args.plot])?;
    let model = build_run(models, &args.run)?;
    let prepared = prepare(model.as_ref(), args)?;
    let csv = Sink::open_given("--csv", args.csv.as_deref())?;
    let json = Sink::open_given("--json", args.json.as_deref())?;
    let plot = Sink::open_given("--plot", args.plot.as_deref())?;

    let finished = measure(model.as_ref(), prepared, args, streams.terminal)?;
    if let Some(sink) = json {
        sink.write(streams, |output| document::write(output, &finished))?;
    }
    if let Some(sink) = csv {
        sink.write(streams, |output| {
            spreadsheet::write(output, &finished.study)
        })?;
    }
    if let Some(sink) = plot {
        let svg = finished.picture(args)?;
        sink.write(streams, |output| output.write_all(svg.as_bytes()))?;
    }
    if !run_request::uses_stdout([&args.csv, &args.json]) {
        write(streams.output, &finished)?;
    }
    let is_answered = !matches!(finished.choice(), Some(Err(_)));
    Ok(match is_answered && finished.study.doubt.is_none() {
        true => Exit::Reached,
        false => Exit::Other,
    })
}

/// Makes settings and start, and refuses invalid requests before the runs.
fn prepare(model: &dyn AnyModel, args: &AccuracyArgs) -> Result<(Settings, Origin), CliError> {
    let finest = (IntegratorChoice::Given(Integrator::Taylor), FINEST[0]);
    let settings = run_request::settings(model, &args.run, None, finest)?;
    Ok((settings, initial_state(model, &args.run.state)?))
}

/// Makes the runs.
fn measure<'a>(
    model: &'a dyn AnyModel,
    (settings, origin): (Settings, Origin),
    args: &'a AccuracyArgs,
    terminal: bool,
) -> Result<Finished<'a>, CliError> {
    let plan = plan(args, settings.until);
    let cases = plan.integrators.len() * plan.tolerances.len();
    let mut progress = Steps::new(cases + plan.rounds as usize + 1, terminal);
    let study = model
        .study(&origin, &settings, &plan, &mut |what| {
            progress.begin(what);
            progress.aside(|| {});
        })
        .map_err(|refusal| CliError::refused(model, &refusal))?;
    progress.finish();
    Ok(Finished {
        model,
        scene: &args.run.model.scene,
        settings,
        study,
        wanted: args.wanted,
    })
}

fn plan(args: &AccuracyArgs, until: f64) -> Plan {
    let everything = Plan::new(until);
    Plan {
        integrators: match args.integrator.is_empty() {
            true => everything.integrators,
            false => args.integrator.clone(),
        },
        rounds: args.rounds,
        budget: duration(args.budget),
        patience: duration(args.patience.unwrap_or(args.budget / 100.0)),
        ..everything
    }
}

/// A number of seconds; the longest duration if it is too large for one.
fn duration(seconds: f64) -> Duration {
    Duration::try_from_secs_f64(seconds).unwrap_or(Duration::MAX)
}

impl Finished<'_> {
    fn title(&self) -> String {
        let model = names::titled(self.model.description(), self.scene);
        format!("Cost of accuracy: {model}")
    }

    fn subtitle(&self) -> String {
        let Study { until, floor, .. } = self.study;
        let form = self.settings.form.name();
        let reference = match self.study.doubt {
            None => {
                format!("accuracy of the reference: {floor:.1e}; rings: the fastest of a decade")
            }
            Some(_) => "reference not confirmed".to_owned(),
        };
        format!("{form} form, until t = {until}; {reference}")
    }

    /// The diagram.
    fn picture(&self, args: &AccuracyArgs) -> Result<String, CliError> {
        work::draw(&self.title(), &self.subtitle(), &self.study)
            .map_err(|reason| CliError::picture(&args.plot, reason))
    }

    /// The integrators that `auto` chooses, by tolerance.
    fn automatic(&self) -> Vec<(Integrator, f64)> {
        let work = self.model.work(self.settings.form);
        let tolerances = Plan::new(self.study.until).tolerances.into_iter();
        tolerances
            .filter_map(|tol| Some((Integrator::automatic(tol, work).ok()?, tol)))
            .collect()
    }

    /// The fastest case for the wanted error, if one is wanted.
    fn choice(&self) -> Option<Result<&Sample, NoChoice>> {
        self.wanted.map(|wanted| self.study.choose(wanted))
    }
}

/// Writes the table and the recommendation.
fn write(output: &mut dyn Write, finished: &Finished<'_>) -> io::Result<()> {
    let study = &finished.study;
    writeln!(output, "{}", finished.title())?;
    if let Some(doubt) = &study.doubt {
        return writeln!(
            output,
            "nothing is measured, because the impacts of the reference are not confirmed: {doubt}\ntry --max-step H for shorter steps"
        );
    }
    writeln!(
        output,
        "{} form, until t = {}; reference: {} after {} impacts, accuracy {:.1e}",
        finished.settings.form.name(),
        study.until,
        study.outcome.kind(),
        study.impacts,
        study.floor
    )?;
    writeln!(
        output,
        "times with the model's functions {}",
        finished.model.code().name()
    )?;
    writeln!(
        output,
        "\n{:8} {:>6} {:>10} {:>9} {:>9} {:>8} {:>9} {:>12}",
        "", "tol", "error", "rates", "steps", "impacts", "work", "us per unit"
    )?;
    let cheapest = study.cheapest();
    for sample in &study.samples {
        let is_cheapest = cheapest.iter().any(|(_, best)| *best == sample);
        writeln!(
            output,
            "{:8} {:>6} {:>10} {:>9} {:>9} {:>8} {:>9} {:>12.3}{}{}",
            sample.integrator.name(),
            format!("{:e}", sample.tol),
            format!("{:.1e}", sample.error),
            evaluations(sample),
            sample.counters.accepted,
            sample.counters.impacts,
            format!("{:.1e}", sample.work),
            sample.microseconds,
            if is_cheapest { "  *" } else { "" },
            if sample.agrees {
                String::new()
            } else {
                format!("  {}", sample.outcome.kind())
            },
        )?;
    }
    writeln!(
        output,
        "\n*  the fastest case for an error below a power of ten; the one with less work if two times differ by less than 5 %"
    )?;
    writeln!(
        output,
        "work: counted operations in multiplications, without the search for impacts"
    )?;
    writeln!(
        output,
        "--integrator auto: {}",
        ranges(&finished.automatic()).join(", ")
    )?;
    for (integrator, reason) in &study.absent {
        writeln!(output, "{}: {reason}", integrator.name())?;
    }
    match finished.choice() {
        None => Ok(()),
        Some(Ok(best)) => writeln!(output, "\n{}", answer(finished, best)),
        Some(Err(reason)) => writeln!(output, "\n{reason}"),
    }
}

/// Integrators by tolerance, as ranges of tolerances with the same integrator.
fn ranges(chosen: &[(Integrator, f64)]) -> Vec<String> {
    let ranges = chosen.chunk_by(|(a, _), (b, _)| a == b);
    let told = ranges.map(|range| match *range {
        [(integrator, loose), .., (_, tight)] => {
            format!("{} from {loose:e} to {tight:e}", integrator.name())
        }
        [(integrator, tol)] => format!("{} at {tol:e}", integrator.name()),
        [] => String::new(),
    });
    told.collect()
}

/// The recommendation: the fastest case for the wanted error.
fn answer(finished: &Finished<'_>, best: &Sample) -> String {
    format!(
        "for an error of {:e}: --integrator {} --tol {:e} (measured error {:.1e}, {:.3} us per unit of time on this machine)",
        finished.wanted.unwrap_or(f64::NAN),
        best.integrator.name(),
        best.tol,
        best.error,
        best.microseconds
    )
}

/// Number of evaluations of the rate; for Taylor series, number of coefficients.
fn evaluations(sample: &Sample) -> u64 {
    match sample.integrator {
        Integrator::Taylor => sample.counters.coefficients,
        _ => sample.counters.rate_evaluations,
    }
}
