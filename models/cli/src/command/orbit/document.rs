//! An orbit as one JSON document.

use std::io::{self, Write};

use dalembert_driver::Point;
use serde_json::{Map, Value, json};

use super::Finished;
use super::summary::components;
use crate::json::{Document, matrix, named, number, vector};
use crate::outcome;

/// Writes the document.
pub(super) fn write(output: &mut dyn Write, finished: &Finished<'_>) -> io::Result<()> {
    let (model, search) = (finished.model, &finished.search);
    let description = model.description();
    let values: Vec<f64> = (0..description.parameters.len())
        .map(|index| model.parameter(index))
        .collect();
    let names = description
        .parameters
        .iter()
        .map(|parameter| parameter.name);
    let mut document = Document::begin(output)?;
    document.field("model", description.name)?;
    document.field("scene", finished.scene)?;
    document.field("parameters", named(names, &values))?;
    document.field("surface", description.surfaces[search.surface].name)?;
    document.field("returns", search.returns)?;
    document.field("tol", number(search.tolerance.relative()))?;
    let found = match &finished.result {
        Err(missed) => {
            let mut outcome = Map::new();
            let (kind, details) = outcome::missed(description, missed);
            outcome.insert("kind".to_owned(), kind.into());
            outcome.extend(
                details
                    .into_iter()
                    .map(|(name, value)| (name.to_owned(), value)),
            );
            document.field("outcome", outcome)?;
            return document.end();
        }
        Ok(found) => found,
    };
    document.field("outcome", json!({ "kind": "done" }))?;
    document.field("period", number(found.period))?;
    document.field("before", state(&found.before))?;
    document.field("after", state(&found.after))?;
    document.field("residual", number(found.residual))?;
    document.field("iterations", found.iterations)?;
    document.field("components", components(description))?;
    document.rows(
        "directions",
        found.directions.iter().map(|direction| vector(direction)),
    )?;
    let derivative = matrix(found.directions.len(), &found.derivative);
    document.field("derivative", derivative)?;
    let multipliers = found.multipliers.iter().map(
        |&[re, im]| json!({ "re": number(re), "im": number(im), "modulus": number(re.hypot(im)) }),
    );
    document.rows("multipliers", multipliers)?;
    document.end()
}

fn state(point: &Point) -> Value {
    json!({
        "q": vector(&point.q),
        "qdot": vector(&point.qdot),
        "p": vector(&point.p),
        "energy": number(point.energy),
    })
}
