//! Certified motion as one JSON document. A range is an array of its two ends, written so that they parse to the same
//! doubles.

use std::io::{self, Write};

use dalembert::numbers::Interval;
use dalembert_driver::Strike;
use serde_json::{Map, Value, json};

use super::{Enclosed, report};
use crate::json::{Document, named, vector};

/// Writes the document.
pub(super) fn write(output: &mut dyn Write, enclosed: &Enclosed<'_>) -> io::Result<()> {
    let Enclosed {
        model,
        scene,
        request,
        within,
        strikes,
        certified,
    } = enclosed;
    let description = model.description();
    let values: Vec<f64> = (0..description.parameters.len())
        .map(|index| model.parameter(index))
        .collect();
    let parameters = description
        .parameters
        .iter()
        .map(|parameter| parameter.name);
    let within = within
        .iter()
        .map(|(name, ends)| (name.clone(), vector(ends)));
    let event = |strike: &Strike| {
        let mut event = json!({
            "t": range(strike.time),
            "surface": report::surface(description, strike.surface),
            "q_minus": ranges(&strike.before.q),
            "qdot_minus": ranges(&strike.before.qdot),
            "q_plus": ranges(&strike.after.q),
            "qdot_plus": ranges(&strike.after.qdot),
        });
        if let (Some(before), Some(after)) = (strike.before.mode, strike.after.mode) {
            event["mode_minus"] = before.into();
            event["mode_plus"] = after.into();
        }
        event
    };
    let mut outcome = Map::new();
    let kind = match certified.lost {
        None => "certified",
        Some(_) => "lost",
    };
    outcome.insert("kind".to_owned(), kind.into());
    outcome.insert("t".to_owned(), certified.t.into());
    if let Some(lost) = certified.lost {
        let (kind, surface) = report::kind(lost.reason);
        outcome.insert("reason".to_owned(), kind.into());
        if let Some(index) = surface {
            let name = report::surface(description, index);
            outcome.insert("surface".to_owned(), name.into());
        }
        let text = report::reason(description, lost.reason);
        outcome.insert("text".to_owned(), text.into());
    }
    if let Some(mode) = certified.last.mode {
        outcome.insert("mode".to_owned(), mode.into());
    }
    outcome.insert("q".to_owned(), ranges(&certified.last.q));
    outcome.insert("qdot".to_owned(), ranges(&certified.last.qdot));

    let mut document = Document::begin(output)?;
    document.field("model", description.name)?;
    document.field("scene", *scene)?;
    document.field("parameters", named(parameters, &values))?;
    document.field("within", within.collect::<Map<_, _>>())?;
    document.field("form", request.form.name())?;
    document.field("outcome", outcome)?;
    document.rows("events", strikes.iter().map(event))?;
    document.field("steps", certified.steps)?;
    document.end()
}

/// A range; `null` for a coordinate that the mode does not have.
fn range(range: Interval) -> Value {
    match range.lo.is_nan() {
        true => Value::Null,
        false => vector(&[range.lo, range.hi]),
    }
}

fn ranges(all: &[Interval]) -> Value {
    all.iter().copied().map(range).collect()
}
