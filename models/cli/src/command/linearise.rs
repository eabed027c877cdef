//! `linearise`: the linearised equations at a state or an equilibrium, as text and as a document.

mod document;
mod summary;

use dalembert::describe::Description;
use dalembert_driver::{
    AnyModel, Linearisation, Place, Refusal, Sampling, Trim, Unlinear, components, outcome, words,
};

use crate::args::LineariseArgs;
use crate::entry::Entry;
use crate::error::{self, CliError};
use crate::exit::Exit;
use crate::sink::{Sink, is_stdout};
use crate::state_input::{build_model, initial_state, set_input};
use crate::{Streams, names, run_request};

/// A model and its linearisation, or the reason why it has none.
struct Finished<'a> {
    model: &'a dyn AnyModel,
    scene: &'a str,
    /// The linearised mode, for a model with modes.
    mode: Option<&'static str>,
    found: Result<Linearisation, Unlinear>,
}

/// Carries out `linearise`.
///
/// # Errors
/// Invalid flags, a state that is refused, a file that cannot be written. Equations without a derivative, and an
/// equilibrium that is not found, are not errors but [`Exit::Other`].
pub fn run(
    models: &[Entry],
    args: &LineariseArgs,
    streams: &mut Streams<'_>,
) -> Result<Exit, CliError> {
    let mut model = build_model(models, &args.model)?;
    for text in &args.input {
        set_input(model.as_mut(), text)?;
    }
    // The linearised equations are those of one mode.
    let mode = model.present_mode();
    let model = model.mode_alone().unwrap_or(model);
    let model = model.as_ref();
    let place = Place {
        t: args.at,
        trim: trim(model, args)?,
        sampling: sampling(model, args)?,
    };
    let origin = initial_state(model, &args.state)?;
    let json = Sink::open_given("--json", args.json.as_deref())?;
    let description = model.description();
    let result = model
        .linearise(&origin, &place)
        .map_err(|refusal| match refusal {
            Refusal::Large(_) => CliError::refused(model, &refusal),
            _ => CliError::Input {
                place: "--initial".to_owned(),
                reason: error::refusal_text(description, &refusal),
            },
        })?;
    let found = match result {
        Some(Err(reason @ (Unlinear::Modes | Unlinear::Unreduced))) => {
            return Err(CliError::Input {
                place: "MODEL".to_owned(),
                reason: text(description, &reason),
            });
        }
        Some(found) => found,
        None => {
            return Err(CliError::Invariable {
                scene: args.model.scene.clone(),
            });
        }
    };
    let finished = Finished {
        model,
        scene: &args.model.scene,
        mode,
        found,
    };
    if let Some(sink) = json {
        sink.write(streams, |output| document::write(output, &finished))?;
    }
    if !args.json.as_deref().is_some_and(is_stdout) {
        summary::write(streams.output, &finished)?;
    }
    Ok(match finished.found {
        Ok(_) => Exit::Reached,
        Err(_) => Exit::Other,
    })
}

/// The search for an equilibrium that the flags ask for.
fn trim(model: &dyn AnyModel, args: &LineariseArgs) -> Result<Option<Trim>, CliError> {
    let Some(free) = &args.trim else {
        return Ok(None);
    };
    let description = model.description();
    let state = components(description);
    let inputs = model.inputs().iter().copied();
    let all: Vec<&str> = state.iter().map(String::as_str).chain(inputs).collect();
    let indices = |flag: &str, what: &'static str, text: &str, all: &[&str]| {
        let listed = text.split(',').map(str::trim);
        listed
            .filter(|name| !name.is_empty())
            .map(|name| names::find(flag, what, name, all.iter().copied()))
            .collect::<Result<Vec<usize>, _>>()
    };
    let moving = args.moving.as_deref().unwrap_or_default();
    Ok(Some(Trim {
        free: indices("--trim", "component or input", free, &all)?,
        moving: indices("--moving", "component", moving, &all[..state.len()])?,
    }))
}

/// The sampled motion that the flags ask for.
fn sampling(model: &dyn AnyModel, args: &LineariseArgs) -> Result<Option<Sampling>, CliError> {
    let laws = run_request::laws(model, &args.series.law)?;
    let tolerance = args.series.tolerance()?;
    Ok(args.every.map(|every| Sampling {
        every,
        count: args.samples,
        tolerance,
        laws,
        policies: args.series.policies.policies(),
    }))
}

/// The reason in words, with the names of the model.
fn text(description: &Description, reason: &Unlinear) -> String {
    match reason {
        Unlinear::Fault(fault) => format!("{reason}: {}", words::fault_text(description, fault)),
        Unlinear::NoEquilibrium { component, rate } => format!(
            "no equilibrium was found: the rate of {} stays at {rate:.3e}; try --moving, another start, or more free components",
            components(description)[*component]
        ),
        Unlinear::Ended { t, outcome } => {
            let explanation = outcome::explanation(description, outcome);
            let explanation = explanation.unwrap_or_else(|| outcome.to_string());
            format!("the sampled motion ends at t = {t}: {explanation}")
        }
        Unlinear::Undefined(undefined) => {
            format!("the sampled motion has no derivative: {undefined}")
        }
        other => other.to_string(),
    }
}
