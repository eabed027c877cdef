//! `control --vary`: the extremals for every value of a parameter or of a component of the start.

mod document;
mod picture;
mod spreadsheet;
mod summary;

use dalembert_driver::ensemble::Quantity;
use dalembert_driver::{AnyModel, Controlled, Extremal, Task};

use super::{Finished, build, controlled, entries, task};
use crate::args::ControlArgs;
use crate::ensemble::members;
use crate::ensemble::pool::{Division, in_order};
use crate::entry::Entry;
use crate::error::CliError;
use crate::exit::Exit;
use crate::plot::Drawn;
use crate::progress::Count;
use crate::sink::Sink;
use crate::{Streams, run_request};

/// Largest number of values.
const MOST: u64 = 100_000;

/// The searches for all values.
struct Sweep<'a> {
    /// The first-order model of the extremals. It has the parameters of the flags except that of `--vary`.
    model: &'a dyn AnyModel,
    scene: &'a str,
    name: String,
    quantity: Quantity,
    members: Vec<Member<'a>>,
}

/// The search for one value.
struct Member<'a> {
    value: f64,
    /// The search, or the reason why there is none.
    found: Result<Finished<'a>, String>,
}

impl Sweep<'_> {
    /// The members whose search was made.
    fn made(&self) -> impl Iterator<Item = (f64, &Finished<'_>)> + Clone {
        let members = self.members.iter();
        members.filter_map(|member| Some((member.value, member.found.as_ref().ok()?)))
    }

    /// Range of the requested numbers of impacts.
    fn impacts(&self) -> std::ops::RangeInclusive<usize> {
        let mut asked = self.made().map(|(_, finished)| finished.task.impacts);
        let [least, most] = asked.next().unwrap_or([0, 0]);
        least..=most
    }

    /// The extremals for all values.
    fn extremals(&self) -> impl Iterator<Item = &Extremal> {
        self.made()
            .flat_map(|(_, finished)| &finished.controlled.extremals)
    }

    /// The counts of extremals by number of impacts.
    fn counted(&self) -> String {
        super::summary::counted(self.extremals())
    }
}

/// The extremal of least cost with this number of impacts.
fn cheapest<'a>(finished: &'a Finished<'_>, impacts: usize) -> Option<&'a Extremal> {
    // The extremals are sorted by cost.
    let mut extremals = finished.controlled.extremals.iter();
    extremals.find(|extremal| extremal.kicks.len() == impacts)
}

/// Carries out `control --vary`.
///
/// # Errors
/// The errors of `control`. Errors at single values are part of the results, unless every value has an error.
pub(super) fn run(
    models: &[Entry],
    args: &ControlArgs,
    streams: &mut Streams<'_>,
) -> Result<Exit, CliError> {
    let entries = entries(models, args)?;
    let model = build(&entries, args, None)?;
    let axis = varied(model.as_ref(), args)?;
    // Opened before the search, so that a path that cannot be written is reported at once.
    let csv = Sink::open_given("--csv", args.csv.as_deref())?;
    let json = Sink::open_given("--json", args.json.as_deref())?;
    let plot = Sink::open_given("--plot", args.plot.as_deref())?;
    let sweep = search(&entries, args, model.as_ref(), axis, streams.terminal)?;
    if let Some(sink) = csv {
        sink.write(streams, |output| spreadsheet::write(output, &sweep))?;
    }
    if let Some(sink) = json {
        sink.write(streams, |output| document::write(output, &sweep))?;
    }
    if let Some(sink) = plot {
        let svg = picture::draw(&sweep, args)?;
        sink.write(streams, |output| output.write_all(svg.as_bytes()))?;
    }
    if !run_request::uses_stdout([&args.csv, &args.json]) {
        summary::write(streams.output, &sweep)?;
    }
    Ok(match sweep.extremals().next() {
        None => Exit::Other,
        Some(_) => Exit::Reached,
    })
}

/// The picture of `control --vary`.
///
/// # Errors
/// The errors of [`run`] except those of files.
pub(super) fn draw(models: &[Entry], args: &ControlArgs) -> Result<Drawn, CliError> {
    let entries = entries(models, args)?;
    let model = build(&entries, args, None)?;
    let axis = varied(model.as_ref(), args)?;
    let sweep = search(&entries, args, model.as_ref(), axis, false)?;
    Ok(Drawn {
        svg: picture::draw(&sweep, args)?,
        outcome: sweep.counted(),
    })
}

/// Name of the varied quantity, the quantity, and its values in order.
fn varied(
    model: &dyn AnyModel,
    args: &ControlArgs,
) -> Result<(String, Quantity, Vec<f64>), CliError> {
    let description = model.description();
    let texts: Vec<String> = args.vary.iter().cloned().collect();
    let members = members::varied(&texts, None, None, description)?;
    let states = (description.coordinates.len() - 1) / 2;
    let (name, quantity) = (&members.names()[0], members.quantities()[0]);
    let refuse = |expected: &str| CliError::value("--vary", &texts[0], expected);
    let given = match quantity {
        Quantity::Position(index) if index < states => &args.initial,
        Quantity::Parameter(_) => &args.model.set,
        _ => {
            return Err(refuse(
                "a parameter or a component of the state at the start",
            ));
        }
    };
    let parts = given.iter().flat_map(|text| text.split(','));
    let mut names = parts.filter_map(|text| text.split('=').next());
    if names.any(|given| crate::names::column(given) == *name) {
        return Err(refuse("a quantity that no other flag gives"));
    }
    if members.count() > MOST {
        return Err(refuse("at most 100000 values"));
    }
    let values = (0..members.count()).map(|member| members.values(member)[0]);
    Ok((name.clone(), quantity, values.collect()))
}

/// Makes the searches on several threads. The results do not depend on the number of threads.
fn search<'a>(
    entries: &[Entry],
    args: &'a ControlArgs,
    model: &'a dyn AnyModel,
    (name, quantity, values): (String, Quantity, Vec<f64>),
    terminal: bool,
) -> Result<Sweep<'a>, CliError> {
    let count = values.len() as u64;
    let mut progress = Count::new(count, terminal);
    let mut members = Vec::with_capacity(values.len());
    let (mut first_error, mut without) = (None, 0);
    in_order(
        0..count,
        Division {
            threads: args.dynamic.thread_count().min(count.max(1)),
            block: 1,
        },
        || (),
        |(), block| {
            block
                .map(|index| one(entries, args, (&name, quantity, values[index as usize])))
                .collect()
        },
        |first, results| {
            for (result, &value) in results.into_iter().zip(&values[first as usize..]) {
                let found = match result {
                    Ok((task, controlled)) => {
                        without += u64::from(controlled.extremals.is_empty());
                        Ok(Finished {
                            model,
                            scene: &args.model.scene,
                            tol: args.tol,
                            task,
                            controlled,
                        })
                    }
                    Err(error) => {
                        without += 1;
                        let text = error.to_string();
                        first_error.get_or_insert(error);
                        Err(text)
                    }
                };
                members.push(Member { value, found });
                progress.done(without);
            }
            Ok::<(), CliError>(())
        },
    )?;
    progress.finish();
    match first_error {
        Some(error) if members.iter().all(|member| member.found.is_err()) => Err(error),
        _ => Ok(Sweep {
            model,
            scene: &args.model.scene,
            name,
            quantity,
            members,
        }),
    }
}

/// The search for one value.
fn one(
    entries: &[Entry],
    args: &ControlArgs,
    (name, quantity, value): (&str, Quantity, f64),
) -> Result<(Task, Controlled), CliError> {
    let set = matches!(quantity, Quantity::Parameter(_)).then(|| format!("{name}={value:?}"));
    let model = build(entries, args, set)?;
    let mut task = task(model.as_ref(), args)?;
    if let Quantity::Position(index) = quantity {
        task.from[index] = value;
    }
    let controlled = controlled(model.as_ref(), args, &task, false)?;
    Ok((task, controlled))
}
