//! A run as one JSON document.

use std::io::{self, Write};
use std::path::PathBuf;

use dalembert::describe::Description;
use dalembert_driver::accuracy::Verified;
use dalembert_driver::{Contact, Impact, Point};
use serde_json::{Map, Value, json};

use super::Finished;
use crate::error::CliError;
use crate::json::{Document, named, number, vector};
use crate::outcome;
use crate::record::Keep;
use crate::spool::Spool;

/// Samples, impacts and contacts for a document, kept until the run has ended.
pub struct Rows<'a> {
    description: &'a Description,
    /// The file of the document, for error messages.
    path: PathBuf,
    events: Spool,
    contacts: Spool,
    samples: Spool,
}

impl<'a> Rows<'a> {
    /// No rows, for the document in this file.
    pub fn new(description: &'a Description, path: PathBuf) -> Self {
        Self {
            description,
            path,
            events: Spool::new(),
            contacts: Spool::new(),
            samples: Spool::new(),
        }
    }
}

impl Keep for Rows<'_> {
    fn sample(&mut self, t: f64, point: &Point) -> io::Result<()> {
        self.samples.push(&sample(self.description, t, point))
    }

    fn impact(&mut self, impact: &Impact) -> io::Result<()> {
        self.events.push(&event(self.description, impact))
    }

    fn contact(&mut self, contact: &Contact) -> io::Result<()> {
        self.contacts.push(&hold(self.description, contact))
    }

    fn failed(&self, source: io::Error) -> CliError {
        CliError::File {
            flag: "--json: a temporary file for",
            path: self.path.clone(),
            source,
        }
    }
}

/// Writes the document.
pub fn write(output: &mut dyn Write, finished: &Finished<'_>, rows: &Rows) -> io::Result<()> {
    let Finished {
        model,
        scene,
        settings,
        ending,
        verified,
        ..
    } = finished;
    let description = model.description();
    let mut document = Document::of_model(output, *model, scene)?;
    if !model.inputs().is_empty() {
        let table = finished.inputs.as_ref();
        let is_held = |index: &usize| table.is_none_or(|table| !table.has(*index));
        let held: Vec<usize> = (0..model.inputs().len()).filter(is_held).collect();
        let names = held.iter().map(|&index| model.inputs()[index]);
        let held = held
            .iter()
            .map(|index| model.parameter(description.parameters.len() + index));
        document.field("inputs", named(names, &held.collect::<Vec<f64>>()))?;
    }
    document.field("form", settings.form.name())?;
    document.field("integrator", settings.integrator.name())?;
    document.field("tol", number(settings.tol))?;
    if let Some(step) = ending.step {
        document.field("step", number(step))?;
    }
    if let Some(max_step) = settings.max_step {
        document.field("max_step", number(max_step))?;
    }
    document.field("outcome", ended(finished))?;
    if let Some(verified) = verified {
        document.field("error", error(verified))?;
    }
    document.spooled("events", &rows.events)?;
    document.spooled("contacts", &rows.contacts)?;
    document.spooled("samples", &rows.samples)?;
    let counters = outcome::counters(&ending.counters).into_iter();
    let counters = counters.map(|(name, count)| (name.to_owned(), Value::from(count)));
    document.field("counters", counters.collect::<Map<_, _>>())?;
    document.field("warnings", ending.warnings.clone())?;
    document.end()
}

/// The measured error, or the reason why it is not verified.
fn error(verified: &Verified) -> Value {
    match verified {
        Verified::Measured { error, floor } => json!({
            "verified": true,
            "measured": number(*error),
            "floor": number(*floor),
            "ends_as_reference": true,
        }),
        Verified::Doubted { reason, agrees } => json!({
            "verified": false,
            "reason": reason,
            "measured": null,
            "floor": null,
            "ends_as_reference": agrees,
        }),
    }
}

/// The end of the run: its `kind` and `t`, details of the kind, and the last state.
fn ended(finished: &Finished<'_>) -> Value {
    let ending = &finished.ending;
    let mut ended = Map::new();
    ended.insert("kind".to_owned(), ending.outcome.kind().into());
    ended.insert("t".to_owned(), number(ending.t));
    let details = outcome::details(finished.model.description(), &ending.outcome);
    ended.extend(
        details
            .into_iter()
            .map(|(name, value)| (name.to_owned(), value)),
    );
    if let Some(mode) = ending.last.mode {
        ended.insert("mode".to_owned(), mode.into());
    }
    ended.insert("q".to_owned(), vector(&ending.last.q));
    ended.insert("qdot".to_owned(), vector(&ending.last.qdot));
    Value::Object(ended)
}

fn event(description: &Description, impact: &Impact) -> Value {
    let mut event = json!({
        "t": number(impact.t),
        "surface": description.surfaces.get(impact.surface).map(|surface| surface.name),
        "q": vector(&impact.after.q),
        "qdot_minus": vector(&impact.before.qdot),
        "qdot_plus": vector(&impact.after.qdot),
        "energy": number(impact.after.energy),
    });
    if let (Some(before), Some(after)) = (impact.before.mode, impact.after.mode) {
        event["mode_minus"] = before.into();
        event["mode_plus"] = after.into();
    }
    if impact.graze {
        event["graze"] = true.into();
    }
    // A reset changed the positions.
    if impact.before.q != impact.after.q {
        event["q_minus"] = vector(&impact.before.q);
    }
    event
}

/// An event at which a surface begins or ceases to hold the motion.
fn hold(description: &Description, contact: &Contact) -> Value {
    json!({
        "t": number(contact.t),
        "surface": description.surfaces.get(contact.surface).map(|surface| surface.name),
        "begins": contact.begins,
        "accumulates_at": contact.accumulation.map(number),
        "q": vector(&contact.at.q),
        "qdot": vector(&contact.at.qdot),
    })
}

fn sample(description: &Description, t: f64, point: &Point) -> Value {
    let mut sample = json!({
        "t": number(t),
        "q": vector(&point.q),
        "qdot": vector(&point.qdot),
        "p": vector(&point.p),
        "energy": number(point.energy),
        "outputs": named(description.outputs.iter().copied(), &point.outputs),
    });
    if let Some(mode) = point.mode {
        sample["mode"] = mode.into();
    }
    sample
}
