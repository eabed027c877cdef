//! A run in a few lines of text: the summary on the standard output and the title of a picture.

use std::io::{self, Write};

use dalembert::Outcome;
use dalembert::describe::Description;
use dalembert::law::Law;
use dalembert::policy::Rest;
use dalembert_driver::accuracy::Verified;
use dalembert_driver::{Ending, Settings};

use super::Finished;
use crate::names;
use crate::{outcome, scalar};

/// Remedy for a run whose impacts are not confirmed.
const SHORTER_STEPS: &str = "a smaller --tol, an earlier end, or --max-step H for shorter steps of the run and of its references";

/// Writes the summary.
pub fn write(output: &mut dyn Write, finished: &Finished<'_>) -> io::Result<()> {
    let Finished {
        ending, settings, ..
    } = finished;
    writeln!(output, "{}", title(finished))?;
    let description = finished.model.description();
    writeln!(output, "  outcome     {}", ended(description, ending))?;
    if !ending.reached {
        let rests = settings.policies.rest == Rest::Contact;
        for (title, text) in outcome::remarks(description, &ending.outcome, rests) {
            writeln!(output, "  {title:<10}  {text}")?;
        }
    }
    writeln!(output, "  impacts     {}", impacts(finished))?;
    if let (Some(first), Some(last)) = (ending.first.mode, ending.last.mode) {
        writeln!(
            output,
            "  mode        {first} at the start, {last} at the end"
        )?;
    }
    if !finished.model.description().is_first_order {
        writeln!(output, "  energy      {}", energy(ending))?;
    }
    writeln!(output, "  integrator  {}", integrator(ending, settings))?;
    if let Some(verified) = &finished.verified {
        writeln!(output, "  error       {}", error(verified))?;
        if let Verified::Doubted { .. } = verified {
            writeln!(output, "  try         {SHORTER_STEPS}")?;
        }
    }
    let counters: Vec<String> = outcome::counters(&ending.counters)
        .iter()
        .map(|(name, count)| format!("{name} {count}"))
        .collect();
    writeln!(output, "  counters    {}", counters.join(", "))
}

/// The outcome, its time and its details.
pub fn ended(description: &Description, ending: &Ending) -> String {
    let Ending { outcome, t, .. } = ending;
    format!(
        "{} at t = {}{}",
        outcome.kind(),
        scalar::full(*t),
        details(description, outcome)
    )
}

/// The measured error with the accuracy of the reference, or the reason why it is not verified.
fn error(verified: &Verified) -> String {
    match verified {
        Verified::Measured { error, floor } if error <= floor => {
            format!("at most {floor:.1e}, the accuracy of the reference")
        }
        Verified::Measured { error, floor } => {
            format!("{error:.1e} of the positions (accuracy of the reference: {floor:.1e})")
        }
        Verified::Doubted { reason, .. } => format!("not verified: {reason}"),
    }
}

/// The model and its scene.
pub fn title(finished: &Finished<'_>) -> String {
    names::titled(finished.model.description(), finished.scene)
}

/// The laws that act and the parameters that differ from their defaults, for a picture.
pub fn subtitle(finished: &Finished<'_>) -> String {
    let mut parts = laws(finished);
    let parameters = &finished.model.description().parameters;
    for (index, parameter) in parameters.iter().enumerate() {
        let value = finished.model.parameter(index);
        if parameter.default != Some(value) {
            parts.push(format!("{} = {value}", parameter.name));
        }
    }
    let ending = &finished.ending;
    let end = if ending.outcome.is_done() {
        String::new()
    } else {
        format!("{} at ", ending.outcome.kind())
    };
    parts.push(format!("{end}t = {}", rounded(ending.t)));
    parts.join(", ")
}

/// One text per law: `elastic` if all surfaces share it, else `floor: elastic`.
fn laws(finished: &Finished<'_>) -> Vec<String> {
    let surfaces = &finished.model.description().surfaces;
    let text =
        |law: &Option<Law>| law.map_or_else(|| "no impacts".to_owned(), |law| law.to_string());
    let laws: Vec<String> = finished.ending.laws.iter().map(text).collect();
    match laws.first() {
        Some(first) if laws.iter().all(|law| law == first) => vec![first.clone()],
        _ => surfaces
            .iter()
            .zip(&laws)
            .map(|(surface, law)| format!("{}: {law}", surface.name))
            .collect(),
    }
}

/// Number of surfaces up to which those without impacts are listed.
const FEW: usize = 8;

/// The number of impacts, and the numbers on each surface.
pub(crate) fn on_each<'n>(
    names: impl Iterator<Item = &'n str>,
    counts: impl ExactSizeIterator<Item = u64> + Clone,
) -> String {
    let (total, are_few) = (counts.clone().sum::<u64>(), counts.len() <= FEW);
    let each = names.zip(counts).filter(|(_, count)| are_few || *count > 0);
    let each: Vec<String> = each
        .map(|(name, count)| format!("{name} {count}"))
        .collect();
    match each.is_empty() {
        true => total.to_string(),
        false => format!("{total} ({})", each.join(", ")),
    }
}

fn impacts(finished: &Finished<'_>) -> String {
    let tally = &finished.record.tally;
    let surfaces = &finished.model.description().surfaces;
    if surfaces.is_empty() {
        return "none: the model has no surfaces".to_owned();
    }
    let counts = (0..surfaces.len()).map(|index| tally.on(index));
    let mut text = on_each(names::surfaces(finished.model.description()), counts);
    for (count, kind) in [
        (tally.grazing, "grazing"),
        (tally.simultaneous, "simultaneous"),
    ] {
        if count > 0 {
            text += &format!(", {count} {kind}");
        }
    }
    match tally.contacts {
        0 => {}
        1 => text += ", held by a surface once",
        count => text += &format!(", held by surfaces {count} times"),
    }
    text
}

/// The integrator, with the parameters that determine its steps.
fn integrator(ending: &Ending, settings: &Settings) -> String {
    let name = format!(
        "{}, {} form",
        settings.integrator.name(),
        settings.form.name()
    );
    let tol = settings.tol;
    match (ending.step, settings.step) {
        (None, _) => match settings.max_step {
            None => format!("{name}, tol {tol:e}"),
            Some(longest) => format!("{name}, tol {tol:e}, no step above {longest}"),
        },
        (Some(step), Some(_)) => format!("{name}, step {step}"),
        (Some(step), None) => {
            format!("{name}, step {step} (from tol {tol:e}; set it with --step)")
        }
    }
}

fn energy(ending: &Ending) -> String {
    let (first, last) = (ending.first.energy, ending.last.energy);
    let change = last - first;
    let relative = relative_change(change / first.abs());
    format!("{first:?} at the start, {last:?} at the end (change {change:.1e}{relative})")
}

/// A change of the energy relative to its value at the start. Empty if that value is small against the change: it then
/// depends on the zero of the potential.
pub(in crate::command) fn relative_change(relative: f64) -> String {
    match relative.abs() <= 1.0 {
        true => format!(", relative to the start {relative:.1e}"),
        false => String::new(),
    }
}

fn details(description: &Description, outcome: &Outcome) -> String {
    let parts: Vec<String> = outcome::details(description, outcome)
        .iter()
        .map(|(name, value)| format!("{name} {value}"))
        .collect();
    if parts.is_empty() {
        String::new()
    } else {
        format!(" ({})", parts.join(", "))
    }
}

/// Six significant digits, without trailing zeros.
fn rounded(value: f64) -> f64 {
    format!("{value:.5e}").parse().unwrap_or(value)
}

#[cfg(test)]
mod tests {
    use super::relative_change;

    #[test]
    fn changes_are_relative_to_energies_that_are_not_near_zero() {
        assert_eq!(relative_change(-0.98), ", relative to the start -9.8e-1");
        for ratio in [5.1e3, f64::NEG_INFINITY, f64::NAN] {
            assert_eq!(relative_change(ratio), "");
        }
    }
}
