//! `control`: extremals of a model with a cost, as a summary, tables, a document and a picture.

mod document;
mod dynamic;
mod film;
mod spreadsheet;
mod summary;
mod sweep;

use dalembert::Tolerance;
use dalembert::describe::Description;
use dalembert_driver::{
    AnyModel, Controlled, Extremal, Form, Integrator, Settings, Task, Unsought,
};

use crate::args::{ClaimsArgs, ControlArgs, FeedbackArgs, ModelArgs};
use crate::entry::Entry;
use crate::error::CliError;
use crate::exit::Exit;
use crate::plot::{Drawn, quantity};
use crate::sink::Sink;
use crate::state_input::{build_model, find_model};
use crate::{Streams, ends, names, run_request};

/// A finished search: the request and its result.
struct Finished<'a> {
    /// The first-order model of the extremals.
    model: &'a dyn AnyModel,
    scene: &'a str,
    tol: f64,
    task: Task,
    controlled: Controlled,
}

impl Finished<'_> {
    fn description(&self) -> &Description {
        self.model.description()
    }

    /// The names of the state's components.
    fn states(&self) -> impl Iterator<Item = &'static str> + Clone {
        names::coordinates(self.description()).take(self.task.from.len())
    }

    /// The names of the inputs, which are the first outputs of the model of extremals; H* follows them.
    fn inputs(&self) -> impl Iterator<Item = &'static str> + Clone {
        let states = self.task.from.len();
        let outputs = &self.description().outputs;
        let twice = outputs.len() - 2 - states - states * states;
        outputs.iter().copied().take(twice / 2)
    }

    /// The settings with which a run of the search is repeated.
    fn settings(&self) -> Settings {
        let form = Form::choose(self.description(), None, false);
        Settings {
            form: form.unwrap_or(Form::Global),
            integrator: Integrator::Taylor,
            tol: self.tol,
            step: None,
            max_step: None,
            steps: None,
            until: self.task.time,
            impacts: None,
            laws: Vec::new(),
            policies: dalembert::Policies::default(),
            projection: None,
        }
    }
}

/// Carries out `control`, also with --dp or --vary.
///
/// # Errors
/// Invalid flags, a model without a maximum principle, a state that is refused, a file that cannot be written. If no
/// extremal is found, the result is not an error but [`Exit::Other`].
pub fn run(
    models: &[Entry],
    args: &ControlArgs,
    streams: &mut Streams<'_>,
) -> Result<Exit, CliError> {
    run_request::check_outputs([&args.csv, &args.json, &args.inputs, &args.plot])?;
    if args.dynamic.is_wanted() {
        return dynamic::run(models, args, streams);
    }
    if args.vary.is_some() {
        return sweep::run(models, args, streams);
    }
    let model = model_of_extremals(models, args)?;
    let task = task(model.as_ref(), args)?;
    quantity::check("--axes", args.axes.as_deref(), model.description())?;
    // The files are opened before the search, so that a path that cannot be written is reported at once.
    let csv = Sink::open_given("--csv", args.csv.as_deref())?;
    let json = Sink::open_given("--json", args.json.as_deref())?;
    let inputs = Sink::open_given("--inputs", args.inputs.as_deref())?;
    let plot = Sink::open_given("--plot", args.plot.as_deref())?;
    let finished = find(model.as_ref(), args, task, streams.terminal)?;
    if let Some(sink) = csv {
        sink.write(streams, |output| spreadsheet::write(output, &finished))?;
    }
    if let Some(sink) = json {
        sink.write(streams, |output| document::write(output, &finished))?;
    }
    if let Some(sink) = inputs {
        let rows = film::rows(&finished, args.samples)?;
        sink.write(streams, |output| {
            spreadsheet::write_motion(output, &finished, &rows)
        })?;
    }
    if let Some(sink) = plot {
        let svg = film::picture(&finished, args)?;
        sink.write(streams, |output| output.write_all(svg.as_bytes()))?;
    }
    if !run_request::uses_stdout([&args.csv, &args.json, &args.inputs]) {
        summary::write(streams.output, &finished)?;
    }
    Ok(match finished.controlled.extremals.is_empty() {
        false => Exit::Reached,
        true => Exit::Other,
    })
}

/// The picture that `control` writes with these flags.
///
/// # Errors
/// The errors of [`run`] except those of files.
pub fn draw(models: &[Entry], args: &ControlArgs) -> Result<Drawn, CliError> {
    if args.dynamic.is_wanted() {
        return dynamic::draw(models, args);
    }
    if args.vary.is_some() {
        return sweep::draw(models, args);
    }
    let model = model_of_extremals(models, args)?;
    let task = task(model.as_ref(), args)?;
    quantity::check("--axes", args.axes.as_deref(), model.description())?;
    let finished = find(model.as_ref(), args, task, false)?;
    Ok(Drawn {
        svg: film::picture(&finished, args)?,
        outcome: summary::counted(finished.controlled.extremals.iter()),
    })
}

/// The first-order model of the extremals, with the parameters of the flags.
fn model_of_extremals(models: &[Entry], args: &ControlArgs) -> Result<Box<dyn AnyModel>, CliError> {
    build(&entries(models, args)?, args, None)
}

/// The first-order model of the extremals.
fn entries(models: &[Entry], args: &ControlArgs) -> Result<Vec<Entry>, CliError> {
    let (entry, part) = declared(models, args)?;
    let description = entry.description();
    let loaded = dalembert_jit::load_control(description.name, &description.source, part);
    let loaded = loaded.map_err(CliError::Declaration)?;
    let extremals: Vec<Entry> = loaded.iter().map(Entry::loaded).collect();
    extremals.iter().try_for_each(Entry::check_size)?;
    Ok(extremals)
}

/// The model of the extremals with the parameters of the flags; `set` is one further assignment.
fn build(
    extremals: &[Entry],
    args: &ControlArgs,
    set: Option<String>,
) -> Result<Box<dyn AnyModel>, CliError> {
    let args = ModelArgs {
        model: extremals.first().map_or("", Entry::name).to_owned(),
        scene: "all".to_owned(),
        set: args.model.set.iter().cloned().chain(set).collect(),
        feedback: FeedbackArgs::default(),
        claims: ClaimsArgs::default(),
        mode: None,
    };
    build_model(extremals, &args)
}

/// The declared model, and its scene if one is selected.
fn declared<'a>(
    models: &'a [Entry],
    args: &'a ControlArgs,
) -> Result<(&'a Entry, Option<&'a str>), CliError> {
    let entry = find_model(models, &args.model.model)?;
    if !entry.description().modes.is_empty() || args.model.mode.is_some() {
        return Err(CliError::Usage("control: a model with modes has no `cost`"));
    }
    let scene = names::find("--scene", "scene", &args.model.scene, entry.scenes())?;
    Ok((entry, (scene > 0).then_some(args.model.scene.as_str())))
}

/// The first-order model of state, held inputs and cost.
struct Held {
    entry: Entry,
    /// Number of inputs.
    inputs: usize,
    /// True if the motions over a step do not depend on its start time.
    is_autonomous: bool,
}

fn held(models: &[Entry], args: &ControlArgs) -> Result<Held, CliError> {
    let (entry, part) = declared(models, args)?;
    let description = entry.description();
    let loaded = dalembert_jit::load_held(description.name, &description.source, part);
    let loaded = loaded.map_err(CliError::Declaration)?;
    let held = loaded.iter().map(|held| Held {
        entry: Entry::loaded(&held.loaded),
        inputs: held.inputs,
        is_autonomous: held.is_autonomous,
    });
    let mut named = held.filter(|held| held.entry.name() == description.name);
    named
        .next()
        .ok_or(CliError::Usage("control: the model is not in its text"))
}

/// The extremal of least cost from a state, or the reason why none is known.
///
/// # Errors
/// Invalid flags.
fn cheapest(
    models: &[Entry],
    args: &ControlArgs,
    from: [f64; 2],
) -> Result<Result<Extremal, String>, CliError> {
    let model = match model_of_extremals(models, args) {
        Ok(model) => model,
        Err(CliError::Declaration(_)) => {
            return Ok(Err("the maximum principle is not derived".to_owned()));
        }
        Err(error) => return Err(error),
    };
    let mut task = task(model.as_ref(), args)?;
    task.from = from.to_vec();
    Ok(match find(model.as_ref(), args, task, false) {
        Ok(finished) => {
            let first = finished.controlled.extremals.into_iter().next();
            first.ok_or_else(|| "no extremal with these numbers of impacts was found".to_owned())
        }
        Err(error) => Err(error.to_string()),
    })
}

/// The optimal control problem that the flags state.
fn task(model: &dyn AnyModel, args: &ControlArgs) -> Result<Task, CliError> {
    let description = model.description();
    let count = (description.coordinates.len() - 1) / 2;
    let states = names::coordinates(description).take(count);
    let impacts = ends::impacts(&args.search.impacts)?;
    if description.surfaces.is_empty() && impacts[1] > 0 {
        return Err(CliError::Usage(
            "--impacts: the model has no impact surfaces",
        ));
    }
    let declared = model.initial();
    let given = ends::components("--initial", "component", states.clone(), &args.initial)?;
    let from = given.into_iter().zip(&declared.q);
    let until = args.until.or(declared.until).filter(|time| *time > 0.0);
    let tolerance = Tolerance::new(args.tol)
        .map_err(|error| CliError::value("--tol", args.tol.to_string(), error.to_string()))?;
    Ok(Task {
        from: from
            .map(|(given, declared)| given.unwrap_or(*declared))
            .collect(),
        to: ends::components("--end", "component", states, &args.end)?,
        time: until.ok_or(CliError::Usage(
            "--until is needed: the model declares no `until`",
        ))?,
        impacts,
        tolerance,
        directions: args.search.starts.map(|count| count as usize),
        seed: args.search.seed,
    })
}

/// Runs the search.
fn find<'a>(
    model: &'a dyn AnyModel,
    args: &'a ControlArgs,
    task: Task,
    terminal: bool,
) -> Result<Finished<'a>, CliError> {
    let controlled = controlled(model, args, &task, terminal)?;
    Ok(Finished {
        model,
        scene: &args.model.scene,
        tol: args.tol,
        task,
        controlled,
    })
}

fn controlled(
    model: &dyn AnyModel,
    args: &ControlArgs,
    task: &Task,
    terminal: bool,
) -> Result<Controlled, CliError> {
    let about = (model, args.model.scene.as_str(), "--initial");
    ends::sought(about, terminal, |tell| model.control(task, tell), refused)
}

/// The error for a problem that is refused, in the model's names.
fn refused(description: &Description, unsought: &Unsought) -> CliError {
    let (place, reason) = match unsought {
        Unsought::Behind {
            is_end,
            surface,
            gap,
        } => {
            let place = if *is_end { "--end" } else { "--initial" };
            let name = names::surfaces(description).nth(*surface);
            let name = name.unwrap_or_default();
            (
                place,
                format!("the state lies behind `{name}`: its gap is {gap}"),
            )
        }
        other => ("control", other.to_string()),
    };
    CliError::Input {
        place: place.to_owned(),
        reason,
    }
}
