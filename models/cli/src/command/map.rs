//! `map`: runs a grid of cells, classifies the end of each run, and writes rows, a summary and a picture.

mod document;
mod summary;

use std::path::PathBuf;
use std::time::{Duration, Instant};

use dalembert::law::Law;
use dalembert_driver::ensemble::row::INPUT;
use dalembert_driver::ensemble::runner::{End, Shared};
use dalembert_driver::ensemble::{Members, Quantity};
use dalembert_driver::{AnyModel, Component, Search, Settings};
use serde_json::{Map, Value, json};

use crate::args::MapArgs;
use crate::ensemble::common::Flags;
use crate::ensemble::members::{self, Shard};
use crate::ensemble::metadata::metadata;
use crate::ensemble::output::Table;
use crate::entry::Entry;
use crate::error::CliError;
use crate::exit::Exit;
use crate::expression::{self, Expression};
use crate::json::number;
use crate::map::request::{Colours, Components, Request, Returns, Watched};
use crate::map::{self, Plan, Sums};
use crate::plot::Drawn;
use crate::plot::map::{Axis, Chart};
use crate::sink::{Sink, is_stdout};
use crate::state_input::{build_model, find_model};
use crate::{Streams, names, plot, run_request};

/// Largest number of values along an axis.
const MOST: u64 = 4000;

/// Longest time of one return in the computation of a Lyapunov exponent, without `--until` and unless the `until` of
/// the model is longer.
const HORIZON: f64 = 3600.0;

/// A finished map: its request and its results.
struct Finished<'a> {
    model: &'a dyn AnyModel,
    settings: &'a Settings,
    metadata: &'a Map<String, Value>,
    request: &'a Request,
    axes: &'a [Axis],
    sums: Sums,
    /// Number of cells taken over from an earlier run.
    kept: u64,
    threads: u64,
    elapsed: Duration,
}

/// Carries out `map`.
///
/// # Errors
/// Invalid flags, an expression with names that the model does not have, a file that cannot be written or continued. A
/// cell whose start is refused is not an error but an [`Exit`].
pub fn run(models: &[Entry], args: &MapArgs, streams: &mut Streams<'_>) -> Result<Exit, CliError> {
    check_flags(args)?;
    // Opened before the runs, so that a path that cannot be written is reported at once.
    let open = || {
        let json = Sink::open_given("--json", args.json.as_deref())?;
        Ok((json, Sink::open_given("--plot", args.plot.as_deref())?))
    };
    make(
        models,
        args,
        streams,
        open,
        |(json, plot), finished, streams| {
            if let Some(sink) = json {
                sink.write(streams, |output| document::write(output, finished))?;
            }
            if let Some(sink) = plot {
                let svg = draw_finished(finished).map_err(|reason| CliError::Plot {
                    flag: "--plot",
                    path: sink.path(),
                    reason,
                })?;
                sink.write(streams, |output| output.write_all(svg.as_bytes()))?;
            }
            let outputs = [&args.rows.csv, &args.json];
            if !outputs.into_iter().flatten().any(|path| is_stdout(path)) {
                summary::write(streams.output, finished)?;
            }
            Ok(match finished.sums.refused {
                0 => Exit::Reached,
                _ => Exit::Other,
            })
        },
    )
}

/// The picture of a map, without any file.
///
/// # Errors
/// The errors of [`run`].
pub fn draw(models: &[Entry], args: &MapArgs) -> Result<Drawn, CliError> {
    let mut streams = Streams {
        input: &mut std::io::empty(),
        output: &mut std::io::sink(),
        errors: &mut std::io::sink(),
        terminal: false,
    };
    make(
        models,
        args,
        &mut streams,
        || Ok(()),
        |(), finished, _| {
            let svg = draw_finished(finished);
            Ok(Drawn {
                svg: svg.map_err(|reason| CliError::picture(&args.plot, reason))?,
                outcome: summary::classes(finished),
            })
        },
    )
}

/// Makes the map and passes it to `finish`. `open` opens files once the flags are checked.
fn make<F, T>(
    models: &[Entry],
    args: &MapArgs,
    streams: &mut Streams<'_>,
    open: impl FnOnce() -> Result<F, CliError>,
    finish: impl FnOnce(F, &Finished<'_>, &mut Streams<'_>) -> Result<T, CliError>,
) -> Result<T, CliError> {
    let model = build_model(models, &args.run.model)?;
    let model = model.as_ref();
    let members = members::varied(&args.vary, None, None, model.description())?;
    let axes = axes(model, args, &members)?;
    members::check_start(&members, model, &args.run.state)?;
    let request = request(model, args, &members)?;
    let counted = args.course.impacts.or(args.returns);
    let settings = run_request::course_to(model, &args.run, &args.course, counted)?;
    let extended = extended(models, args, &request)?;
    check_states(&extended, args, &request)?;
    let starts = request.starts.iter();
    let starts: Vec<(Component, usize)> = starts
        .map(|(component, watched)| (*component, watched.output))
        .collect();
    let flags = Flags {
        models: &extended,
        run: &args.run,
    };
    let shared = Shared {
        common: &flags,
        off_constraint: args.run.state.off_constraint,
        settings: &settings,
        end: End::of(args.run.until, counted),
        members: &members,
        density: None,
        starts: &starts,
    };
    let mut metadata = metadata(model, &args.run, &shared, Shard::WHOLE)?;
    metadata.insert("map".to_owned(), asked(model, args, &request));
    let columns = map::columns(&request, &members);
    let plan = Plan {
        shared,
        request: &request,
        threads: args.rows.thread_count(),
        table: Table {
            columns: &columns,
            metadata: &metadata,
            first: 0,
        },
        is_drawn: args.plot.is_some(),
    };
    let files = open()?;
    let begun = Instant::now();
    let (sums, kept) = args.rows.write(&plan.table, streams.output, |rows| {
        map::execute(&plan, rows, streams.terminal)
    })?;
    let finished = Finished {
        model,
        settings: &settings,
        metadata: &metadata,
        request: &request,
        axes: &axes,
        sums,
        kept,
        threads: plan.threads,
        elapsed: begun.elapsed(),
    };
    finish(files, &finished, streams)
}

/// Refuses incompatible flags, before any other step.
fn check_flags(args: &MapArgs) -> Result<(), CliError> {
    run_request::check_plot(args.plot.as_deref())?;
    let outputs = [&args.rows.csv, &args.rows.parquet, &args.json, &args.plot];
    let given: Vec<&PathBuf> = outputs.into_iter().flatten().collect();
    let twice = |(index, path): (usize, &&PathBuf)| given[..index].contains(path);
    if given.iter().enumerate().any(twice) {
        return Err(CliError::Usage(
            "--csv, --parquet, --json and --plot need different files (`-` can be used once)",
        ));
    }
    args.rows.check()?;
    if args.class == "lyapunov" && args.lyapunov.is_none() {
        return Err(CliError::Usage(
            "--class lyapunov needs --lyapunov N, the number of further returns",
        ));
    }
    if args.class == "returns" && args.returns.is_none() {
        return Err(CliError::Usage("--class returns needs --returns N"));
    }
    if !args.run.input.is_empty() {
        let text = "--input: a map leaves inputs at 0; give them a law by --feedback, or declare a parameter in place of an input that cells vary";
        return Err(CliError::Usage(text));
    }
    Ok(())
}

/// The axes of the map.
fn axes(model: &dyn AnyModel, args: &MapArgs, members: &Members) -> Result<Vec<Axis>, CliError> {
    if members.names().len() > 2 {
        return Err(CliError::Usage("--vary: a map has one axis or two"));
    }
    let named = members.names().iter().zip(members.quantities());
    let spaced = members::spaced(members).into_iter().zip(&args.vary);
    let mut axes = Vec::new();
    for ((name, quantity), (spaced, text)) in named.zip(spaced) {
        let refuse = |expected: &str| CliError::value("--vary", text, expected);
        let Some((ends, count)) = spaced else {
            return Err(refuse("NAME=A..B:COUNT: an axis has equally spaced values"));
        };
        if !(2..=MOST).contains(&count) {
            return Err(refuse("a count from 2 to 4000"));
        }
        if ends[0] >= ends[1] || ends.iter().any(|end| !end.is_finite()) {
            return Err(refuse("A..B with A below B"));
        }
        if model.description().is_first_order && matches!(quantity, Quantity::Velocity(_)) {
            return Err(refuse(
                "a coordinate or a parameter: the rates of a first-order system follow from them",
            ));
        }
        axes.push(Axis {
            name: name.clone(),
            quantity: *quantity,
            ends,
            count: count as usize,
        });
    }
    Ok(axes)
}

/// The request for every run. Expressions become outputs, numbered after those that the model declares.
fn request(model: &dyn AnyModel, args: &MapArgs, members: &Members) -> Result<Request, CliError> {
    let description = model.description();
    let mut output = description.outputs.len()..;
    let mut watched = |expression: Expression| Watched {
        expression,
        output: output.next().unwrap_or(usize::MAX),
    };
    let mut starts = Vec::new();
    for text in &args.start {
        let (component, expression) = started(model, text, members)?;
        if starts.iter().any(|(other, _)| *other == component) {
            return Err(CliError::value("--start", text, "every name once"));
        }
        starts.push((component, watched(expression)));
    }
    let fail = args.fail.as_deref().map(failing).transpose()?;
    let fail = fail.map(&mut watched);
    let colours = match args.class.as_str() {
        "end" => Colours::End,
        "returns" => Colours::Returns,
        "lyapunov" => Colours::Exponent,
        text => Colours::Value(watched(shown(text)?)),
    };
    let outputs = expression::named_outputs(&args.output)?.into_iter();
    let outputs: Vec<(String, Watched)> = outputs
        .map(|(name, expression)| (name, watched(expression)))
        .collect();
    let mut contours = Vec::new();
    for text in &args.contour {
        contours.push(watched(line(text)?));
    }
    let is_parameter = |quantity: &Quantity| matches!(quantity, Quantity::Parameter(_));
    let components = Components::of(description, args)?;
    let plane = args.axes.as_deref();
    let plane = plane.map(|text| plane_of(text, members, &components, &outputs));
    Ok(Request {
        returns: returns(model, args)?,
        starts,
        fail,
        colours,
        outputs,
        contours,
        plane: plane.transpose()?,
        components,
        is_bifurcating: members.quantities().iter().any(is_parameter),
    })
}

/// The columns of the axes of `--axes`.
fn plane_of(
    text: &str,
    members: &Members,
    components: &Components,
    outputs: &[(String, Watched)],
) -> Result<[String; 2], CliError> {
    let (names, columns): (Vec<String>, Vec<String>) = (members.names().iter())
        .map(|name| (name.as_str(), format!("{INPUT}{name}")))
        .chain(
            outputs
                .iter()
                .map(|(name, _)| (name.as_str(), map::output(name))),
        )
        .chain(
            components
                .names
                .iter()
                .map(|name| (name.as_str(), map::end(name))),
        )
        .chain([("t", "t".to_owned())])
        .flat_map(|(name, column)| [(name.to_owned(), column.clone()), (column.clone(), column)])
        .unzip();
    let [x, y] = *text.split(',').map(str::trim).collect::<Vec<_>>() else {
        return Err(CliError::value("--axes", text, "two quantities: X,Y"));
    };
    let column = |name: &str| -> Result<String, CliError> {
        let place = names::find("--axes", "quantity", name, names.iter().map(String::as_str))?;
        Ok(columns[place].clone())
    };
    Ok([column(x)?, column(y)?])
}

/// The component and the expression of `--start`.
fn started(
    model: &dyn AnyModel,
    text: &str,
    members: &Members,
) -> Result<(Component, Expression), CliError> {
    let (name, expression) = Expression::parse("--start", text)?.assigned()?;
    let component = Component::find(model, &name);
    let component = component.map_err(|unknown| CliError::Unknown {
        place: "--start".to_owned(),
        unknown,
    })?;
    let varied = match component {
        Component::Position(index) => Quantity::Position(index),
        Component::Velocity(index) => Quantity::Velocity(index),
    };
    match members.quantities().contains(&varied) {
        true => Err(CliError::value(
            "--start",
            text,
            "a name that --vary does not vary",
        )),
        false => Ok((component, expression)),
    }
}

/// The expression of `--fail`.
fn failing(text: &str) -> Result<Expression, CliError> {
    let expression = Expression::parse("--fail", text)?;
    match expression.is_inequality() {
        true => Ok(expression),
        false => Err(CliError::value(
            "--fail",
            text,
            "a comparison by >, >=, < or <=, such as theta > pi/2",
        )),
    }
}

/// The expression of `--class`.
fn shown(text: &str) -> Result<Expression, CliError> {
    let expression = Expression::parse("--class", text)?;
    match expression.is_equation() {
        false => Ok(expression),
        true => Err(CliError::value(
            "--class",
            text,
            "a number such as x + y, or a comparison by >, >=, < or <=",
        )),
    }
}

/// The expression of `--contour`.
fn line(text: &str) -> Result<Expression, CliError> {
    let expression = Expression::parse("--contour", text)?;
    match expression.is_inequality() {
        false => Ok(expression),
        true => Err(CliError::value(
            "--contour",
            text,
            "an equation such as y = 2*x, or an expression that is 0 on the line",
        )),
    }
}

fn returns(model: &dyn AnyModel, args: &MapArgs) -> Result<Option<Returns>, CliError> {
    let Some(count) = args.returns else {
        return Ok(None);
    };
    let description = model.description();
    let surfaces = names::surfaces(description);
    let surface = match (&args.surface, description.surfaces.len()) {
        (_, 0) => {
            return Err(CliError::Usage(
                "--returns: the model has no impact surfaces",
            ));
        }
        (Some(name), _) => names::find("--surface", "surface", name, surfaces)?,
        (None, 1) => 0,
        (None, _) => {
            return Err(CliError::Usage(
                "--returns: the model has several surfaces; choose one with --surface",
            ));
        }
    };
    let laws = run_request::laws(model, &args.run.law)?;
    let chosen = laws.iter().rev().find(|(index, _)| *index == surface);
    let law = chosen.map(|(_, law)| *law).or(model.law(surface));
    if law == Some(Law::Stop) {
        return Err(CliError::Usage(
            "--returns: the motion ends at the surface, which has the law `stop`; count the returns to another one",
        ));
    }
    let until = model.initial().until.unwrap_or(0.0);
    let tolerance = dalembert::Tolerance::new(args.course.tol);
    let refuse = |error: &dyn std::fmt::Display| {
        CliError::value("--tol", args.course.tol.to_string(), error.to_string())
    };
    let search = |returns: u32| -> Result<Search, CliError> {
        Ok(Search {
            surface,
            returns,
            horizon: args.run.until.unwrap_or(until.max(HORIZON)),
            tolerance: tolerance.map_err(|error| refuse(&error))?,
            laws: laws.clone(),
            policies: args.run.policies.policies(),
            modulo: None,
        })
    };
    Ok(Some(Returns {
        count,
        surface,
        period: args.period as usize,
        exponent: args.lyapunov.map(search).transpose()?,
    }))
}

/// All models; or, if flags contain expressions, only the model of the map with the expressions as additional outputs.
fn extended(models: &[Entry], args: &MapArgs, request: &Request) -> Result<Vec<Entry>, CliError> {
    let value = match &request.colours {
        Colours::Value(watched) => Some(watched),
        Colours::End | Colours::Returns | Colours::Exponent => None,
    };
    let starts = request.starts.iter().map(|(_, watched)| watched);
    let watched = starts
        .chain(&request.fail)
        .chain(value)
        .chain(request.outputs.iter().map(|(_, watched)| watched))
        .chain(&request.contours);
    let expressions: Vec<&Expression> = watched.map(|it| &it.expression).collect();
    if expressions.is_empty() {
        return Ok(models.to_vec());
    }
    let entry = find_model(models, &args.run.model.model)?;
    Ok(vec![expression::add_to(entry, &expressions)?])
}

/// Refuses integrals along a run in expressions that are evaluated at a single state.
fn check_states(models: &[Entry], args: &MapArgs, request: &Request) -> Result<(), CliError> {
    let model = find_model(models, &args.run.model.model)?;
    let integrals = &model.description().integrals;
    let starts = request
        .starts
        .iter()
        .map(|(_, watched)| ("--start", watched));
    let lines = request
        .contours
        .iter()
        .map(|watched| ("--contour", watched));
    match starts
        .chain(lines)
        .find(|(_, watched)| integrals.contains(&watched.output))
    {
        None => Ok(()),
        Some((flag, watched)) => Err(CliError::value(
            flag,
            watched.expression.text(),
            "an expression of the start: an integral exists only along a run",
        )),
    }
}

/// The map that the flags ask for, as JSON for the metadata of files.
fn asked(model: &dyn AnyModel, args: &MapArgs, request: &Request) -> Value {
    let description = model.description();
    let returns = request.returns.as_ref();
    json!({
        "returns": args.returns,
        "surface": returns.and_then(|it| names::surfaces(description).nth(it.surface)),
        "start": args.start,
        "fail": args.fail,
        "class": args.class,
        "outputs": args.output,
        "contours": args.contour,
        "period": args.period,
        "near": number(args.nearness()),
        "ignore": args.ignore,
        "lyapunov": args.lyapunov,
    })
}

/// Draws a finished map.
fn draw_finished(finished: &Finished<'_>) -> Result<String, String> {
    let cells = finished.sums.drawn.as_ref();
    plot::map::draw(&Chart {
        title: &summary::title(finished),
        subtitle: &summary::caption(finished),
        axes: finished.axes,
        request: finished.request,
        sums: &finished.sums,
        cells: cells.ok_or_else(|| "nothing was kept to draw".to_owned())?,
    })
}
