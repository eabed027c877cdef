//! Flags of boundary-value problems: components of the states at both ends by name, and numbers of impacts.

use dalembert::describe::Description;
use dalembert_driver::{AnyModel, Refusal, Stage};

use crate::error::{self, CliError, counted};
use crate::progress::Stages;
use crate::{names, scalar};

/// Largest number of impacts.
const MOST_IMPACTS: usize = 1000;

/// Runs a search and shows its progress. `place` is the flag of the start; `refused` makes the error for a problem
/// without an answer.
///
/// # Errors
/// A start that is refused, a problem without an answer, a scene without variations.
pub fn sought<T, E>(
    (model, scene, place): (&dyn AnyModel, &str, &str),
    terminal: bool,
    search: impl FnOnce(&mut dyn FnMut(Stage)) -> Result<Option<Result<T, E>>, Refusal>,
    refused: impl FnOnce(&Description, &E) -> CliError,
) -> Result<T, CliError> {
    let mut stages = Stages::new(terminal);
    let result = search(&mut |stage| {
        stages.at(stage.done, stage.all, &format!("{} found", stage.found));
    });
    stages.finish();
    let description = model.description();
    let result = result.map_err(|refusal| CliError::Input {
        place: place.to_owned(),
        reason: error::refusal_text(description, &refusal),
    })?;
    match result {
        Some(found) => found.map_err(|reason| refused(description, &reason)),
        None => Err(CliError::Invariable {
            scene: scene.to_owned(),
        }),
    }
}

/// Reasons why a scan is not exhaustive, as text to append to other reasons.
pub fn doubts(unresolved: usize, given_up: usize) -> String {
    let mut text = String::new();
    if unresolved > 0 {
        let intervals = counted(unresolved, "interval");
        text += &format!("; {intervals} of the scan not resolved");
    }
    if given_up > 0 {
        let starts = counted(given_up, "start");
        text += &format!("; {starts} given up because their motions take too many steps");
    }
    text
}

/// The components that a flag gives by name, in the order of `accepted`; `None` for the others. `what` is the noun for
/// a component in messages.
///
/// # Errors
/// An unknown name, a value that is not a number, a component that is given again.
pub fn components<'a>(
    flag: &'static str,
    what: &'static str,
    accepted: impl Iterator<Item = &'a str> + Clone,
    texts: &[String],
) -> Result<Vec<Option<f64>>, CliError> {
    let mut components = vec![None; accepted.clone().count()];
    let changes = texts.iter().flat_map(|list| list.split(','));
    for text in changes.filter(|text| !text.trim().is_empty()) {
        let (name, value) = names::assignment(flag, text, "NAME=VALUE,..")?;
        let index = names::find(flag, what, name, accepted.clone())?;
        let number = scalar::parse(value)
            .map_err(|expected| CliError::value(format!("{flag} {name}"), value, expected))?;
        if components[index].replace(number).is_some() {
            return Err(CliError::value(flag, text, format!("every {what} once")));
        }
    }
    Ok(components)
}

/// Least and largest number of impacts.
///
/// # Errors
/// A text that is neither a number nor a range of numbers.
pub fn impacts(text: &str) -> Result<[usize; 2], CliError> {
    let refuse = || {
        CliError::value(
            "--impacts",
            text,
            "a number such as 2, or A..B with A not above B, such as 0..3; 1000 at most",
        )
    };
    let number = |text: &str| text.trim().parse::<usize>().map_err(|_| refuse());
    let range = match text.split_once("..") {
        Some((least, most)) => [number(least)?, number(most.trim_start_matches('='))?],
        None => [number(text)?; 2],
    };
    match range[0] <= range[1] && range[1] <= MOST_IMPACTS {
        true => Ok(range),
        false => Err(refuse()),
    }
}
