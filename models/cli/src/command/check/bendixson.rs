//! `check --bendixson`: decides the hypotheses of the Poincare-Bendixson theorem for planar hybrid systems where it can.

use std::io::{self, Write};

use dalembert_codegen::report::planar::{Cascade, Decided, Interval, Planar, planar, shown};
use dalembert_driver::AnyModel;
use serde_json::{Value, json};

use crate::Streams;
use crate::args::{CheckArgs, Format};
use crate::error::CliError;
use crate::exit::Exit;
use crate::json::{Document, number};
use crate::sink::{self, Sink};
use crate::state_input::set_parameter;

/// Carries out `check --bendixson`.
///
/// # Errors
/// A model without a text, a value of a parameter that is refused, an output that fails.
pub fn run(
    mut model: Box<dyn AnyModel>,
    args: &CheckArgs,
    json: Option<Sink>,
    streams: &mut Streams<'_>,
) -> Result<Exit, CliError> {
    for text in &args.set {
        set_parameter(model.as_mut(), text)?;
    }
    let description = model.description();
    if description.source.is_empty() {
        return Err(CliError::Usage(
            "--bendixson needs the text of the model, and this one has none",
        ));
    }
    let parameters = description.parameters.iter().enumerate();
    let parameters: Vec<(&str, f64)> = parameters
        .map(|(index, parameter)| (parameter.name, model.parameter(index)))
        .filter(|(_, value)| value.is_finite())
        .collect();
    let found = planar(&description.source, &parameters).map_err(|error| CliError::Input {
        place: description.name.to_owned(),
        reason: error.to_string(),
    })?;
    let modes: Vec<&str> = description.modes.iter().map(|mode| mode.name).collect();
    let document = |output: &mut dyn Write| write_json(output, description.name, &modes, &found);
    if !sink::write_document(json, streams, document)? {
        match args.format {
            Format::Text => write_text(streams.output, description.name, &modes, &found)?,
            Format::Json => document(streams.output)?,
        }
    }
    Ok(match found.concludes() {
        true => Exit::Reached,
        false => Exit::Other,
    })
}

const fn word(decided: &Decided) -> &'static str {
    match decided {
        Decided::Holds => "holds",
        Decided::Fails => "fails",
        Decided::Open => "open",
    }
}

fn write_text(
    output: &mut dyn Write,
    name: &str,
    modes: &[&str],
    found: &Planar,
) -> Result<(), CliError> {
    writeln!(
        output,
        "{name}: Poincare-Bendixson theorem for planar hybrid systems"
    )?;
    for hypothesis in &found.hypotheses {
        let (name, decided) = (hypothesis.name, word(&hypothesis.decided));
        writeln!(output, "  {name}  {decided:6}{}", hypothesis.statement)?;
        writeln!(output, "             {}", hypothesis.reason)?;
    }
    if let Some(cascade) = &found.cascade {
        write_cascade(output, modes, cascade)?;
    }
    let conclusion = match found.concludes() {
        true => "every motion of the set tends to a periodic orbit",
        false => "none: not all hypotheses are shown",
    };
    writeln!(output, "  conclusion   {conclusion}")?;
    if let (true, Some(cascade)) = (found.concludes(), &found.cascade) {
        writeln!(output, "  multiplier   {}", shown(cascade.multiplier))?;
        if let Some(energy) = cascade.energy {
            let place = mode_name(modes, cascade.steps[0].mode);
            let energy = shown(energy);
            writeln!(output, "  energy       {energy}, kinetic, on entry{place}")?;
        }
    }
    Ok(())
}

/// ` into MODE`; empty for a model without modes.
fn mode_name(modes: &[&str], mode: usize) -> String {
    modes
        .get(mode)
        .map_or(String::new(), |name| format!(" into {name}"))
}

fn write_cascade(
    output: &mut dyn Write,
    modes: &[&str],
    cascade: &Cascade,
) -> Result<(), CliError> {
    writeln!(
        output,
        "  (4.13)       kinetic energies on entry, from the largest R on"
    )?;
    for step in &cascade.steps {
        let mode = modes.get(step.mode).copied().unwrap_or("");
        let sign = match step.holds() {
            Some(true) => ">",
            Some(false) => "<=",
            None => "?",
        };
        writeln!(
            output,
            "    {mode:10} R = {}, P = {}, K = {}; behind {}: {} {sign} {}",
            shown(step.needed),
            shown(step.gained),
            shown(step.kept),
            step.surface,
            shown(step.reached),
            shown(step.next),
        )?;
    }
    Ok(())
}

fn ends(interval: Interval) -> Value {
    json!([number(interval.lo), number(interval.hi)])
}

fn write_json(
    output: &mut dyn Write,
    name: &str,
    modes: &[&str],
    found: &Planar,
) -> io::Result<()> {
    let mut document = Document::begin(output)?;
    document.field("model", name)?;
    document.rows(
        "hypotheses",
        found.hypotheses.iter().map(|it| {
            json!({
                "name": it.name,
                "statement": it.statement,
                "verdict": word(&it.decided),
                "reason": it.reason,
            })
        }),
    )?;
    let cascade = found.cascade.as_ref().map(|cascade| {
        let steps = cascade.steps.iter().map(|step| {
            json!({
                "mode": modes.get(step.mode),
                "surface": step.surface,
                "entry": ends(step.places[0]),
                "exit": ends(step.places[1]),
                "R": ends(step.needed),
                "P": ends(step.gained),
                "K": ends(step.kept),
                "reached": ends(step.reached),
                "needed": ends(step.next),
                "holds": step.holds(),
            })
        });
        json!({
            "steps": steps.collect::<Vec<_>>(),
            "multiplier": ends(cascade.multiplier),
            "energy": cascade.energy.map(ends),
        })
    });
    document.field("cascade", cascade)?;
    document.field("concludes", found.concludes())?;
    document.end()
}
