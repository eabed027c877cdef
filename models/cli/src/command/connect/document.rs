//! Motions between two configurations as one JSON document.

use std::io::{self, Write};

use dalembert::describe::Description;
use dalembert_driver::{Conjugate, Connection, Point};
use serde_json::{Value, json};

use super::Finished;
use crate::json::{Document, named, number, vector};
use crate::names;

/// Writes the document.
pub(super) fn write(output: &mut dyn Write, finished: &Finished<'_>) -> io::Result<()> {
    let (model, boundary) = (finished.model, &finished.boundary);
    let (description, connected) = (model.description(), &finished.connected);
    let mut document = Document::of_model(output, model, finished.scene)?;
    document.field(
        "from",
        named(names::coordinates(description), &boundary.from),
    )?;
    let to = names::coordinates(description).zip(&boundary.to);
    let to = to.filter_map(|(name, to)| to.map(|to| (name.to_owned(), number(to))));
    document.field("to", Value::Object(to.collect()))?;
    document.field("time", number(boundary.time))?;
    document.field("impacts", boundary.impacts.to_vec())?;
    document.field("tol", number(boundary.tolerance.relative()))?;
    document.field("seed", finished.seed)?;
    let search = json!({
        "unknowns": connected.unknowns,
        "directions": connected.directions,
        "runs": connected.runs,
        "kinetic_energy": number(connected.kinetic),
        "bounded": connected.is_bounded,
        "unresolved": connected.unresolved,
        "given_up": connected.given_up,
        "exhaustive": false,
    });
    document.field("search", search)?;
    let rows = connected.connections.iter();
    document.rows(
        "motions",
        rows.map(|connection| motion(description, connection)),
    )?;
    if boundary.envelope > 0 {
        let points = connected.envelope.iter();
        document.rows("envelope", points.map(conjugate))?;
    }
    document.end()
}

fn motion(description: &Description, connection: &Connection) -> Value {
    let surface = |index: usize| names::surfaces(description).nth(index);
    let impacts = connection.bounces.iter().map(|bounce| {
        json!({
            "t": number(bounce.t),
            "surface": surface(bounce.surface),
            "q": vector(&bounce.before.q),
            "qdot_minus": vector(&bounce.before.qdot),
            "qdot_plus": vector(&bounce.after.qdot),
        })
    });
    let points = connection.conjugate.iter().map(conjugate);
    json!({
        "action": number(connection.action),
        "start": state(&connection.first),
        "end": state(&connection.last),
        "impacts": impacts.collect::<Vec<_>>(),
        "residual": number(connection.residual),
        "conjugate": points.collect::<Vec<_>>(),
        "determinant": number(connection.determinant),
        "isolated": connection.is_isolated,
        "family": connection.family,
    })
}

fn conjugate(it: &Conjugate) -> Value {
    json!({ "t": number(it.t), "q": vector(&it.at.q), "impacts": it.impacts })
}

fn state(point: &Point) -> Value {
    json!({
        "q": vector(&point.q),
        "qdot": vector(&point.qdot),
        "p": vector(&point.p),
        "energy": number(point.energy),
    })
}
