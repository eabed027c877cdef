//! An orbit as one JSON document.

use std::io::{self, Write};

use dalembert::OrbitError;
use dalembert_driver::{Found, Point, Symmetries};
use serde_json::{Map, Value, json};

use super::Finished;
use super::summary::components;
use crate::json::{Document, matrix, number, vector};
use crate::outcome;

/// Writes the document.
pub(super) fn write(output: &mut dyn Write, finished: &Finished<'_, Found>) -> io::Result<()> {
    let mut document = begin(output, finished)?;
    let found = match &finished.result {
        Err(missed) => return end_missed(document, finished, missed),
        Ok(found) => found,
    };
    document.field("outcome", json!({ "kind": "done" }))?;
    document.field("period", number(found.period))?;
    document.field("before", state(&found.before))?;
    document.field("after", state(&found.after))?;
    if let Some(symmetries) = &finished.search.modulo {
        document.field("modulo", modulo(symmetries, &found.element))?;
    }
    document.field("residual", number(found.residual))?;
    document.field("iterations", found.iterations)?;
    let names = components(finished.model.description());
    document.field("components", names)?;
    document.rows(
        "directions",
        found.directions.iter().map(|direction| vector(direction)),
    )?;
    let derivative = matrix(found.directions.len(), &found.derivative);
    document.field("derivative", derivative)?;
    document.rows("multipliers", found.multipliers.iter().map(multiplier))?;
    document.end()
}

/// Opens the document of a search and writes the request.
pub(super) fn begin<'a, T>(
    output: &'a mut dyn Write,
    finished: &Finished<'_, T>,
) -> io::Result<Document<'a>> {
    let (model, search) = (finished.model, &finished.search);
    let description = model.description();
    let mut document = Document::of_model(output, model, finished.scene)?;
    document.field("surface", description.surfaces[search.surface].name)?;
    document.field("returns", search.returns)?;
    document.field("tol", number(search.tolerance.relative()))?;
    Ok(document)
}

/// Writes the reason why no orbit was found, and closes the document.
pub(super) fn end_missed<T>(
    mut document: Document<'_>,
    finished: &Finished<'_, T>,
    missed: &OrbitError,
) -> io::Result<()> {
    let mut outcome = Map::new();
    let (kind, details) = outcome::missed(finished.model.description(), missed);
    outcome.insert("kind".to_owned(), kind.into());
    let details = details.into_iter();
    outcome.extend(details.map(|(name, value)| (name.to_owned(), value)));
    if let Some(drift) = &finished.drift {
        let changes = drift.changes.iter();
        let changes = changes.map(|(name, change)| (name.clone(), number(*change)));
        outcome.insert("drift".to_owned(), Map::from_iter(changes).into());
        outcome.insert("modulo".to_owned(), drift.fields.clone().into());
    }
    document.field("outcome", outcome)?;
    document.end()
}

/// The symmetries up to which an orbit closes.
fn modulo(symmetries: &Symmetries, element: &[f64]) -> Value {
    let pairs = symmetries.generators().iter().zip(element);
    let told = pairs.map(|(field, factor)| {
        json!({
            "field": field.name,
            "advance": number(*factor),
            "conserves_momentum": field.keeps_momentum,
        })
    });
    told.collect()
}

/// A multiplier.
pub(super) fn multiplier(&[re, im]: &[f64; 2]) -> Value {
    json!({ "re": number(re), "im": number(im), "modulus": number(re.hypot(im)) })
}

/// A state.
pub(super) fn state(point: &Point) -> Value {
    json!({
        "q": vector(&point.q),
        "qdot": vector(&point.qdot),
        "p": vector(&point.p),
        "energy": number(point.energy),
    })
}
