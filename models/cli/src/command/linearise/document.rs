//! Linearised equations as one JSON document.

use std::io::{self, Write};

use dalembert_driver::{AnyModel, Linearisation, Stride, Tendency};
use serde_json::{Value, json};

use super::{Finished, text};
use crate::json::{Document, named, number, vector};

/// Writes the document.
pub(super) fn write(output: &mut dyn Write, finished: &Finished<'_>) -> io::Result<()> {
    let model = finished.model;
    let description = model.description();
    let mut document = Document::of_model(output, model, finished.scene)?;
    document.field("mode", finished.mode)?;
    match &finished.found {
        Ok(found) => {
            document.field("outcome", json!({ "kind": "done" }))?;
            write_found(&mut document, model, found)?;
        }
        Err(reason) => {
            let text = text(description, reason);
            let outcome = json!({ "kind": reason.kind(), "reason": text });
            document.field("outcome", outcome)?;
        }
    }
    document.end()
}

fn write_found(
    document: &mut Document<'_>,
    model: &dyn AnyModel,
    found: &Linearisation,
) -> io::Result<()> {
    let components = || found.components.iter().map(String::as_str);
    let outputs = found.output_names.iter().copied();
    document.field("t", number(found.t))?;
    document.field("state", named(components(), &found.state))?;
    document.field("rates", named(components(), &found.rates))?;
    document.field(
        "inputs",
        named(model.inputs().iter().copied(), &found.inputs),
    )?;
    document.field("outputs", named(outputs, &found.outputs))?;
    let trim = found.steps.map(|steps| json!({ "steps": steps }));
    document.field("trim", trim)?;
    document.field("equilibrium", found.is_equilibrium())?;
    for (name, rows) in [
        ("A", &found.a),
        ("B", &found.b),
        ("C", &found.c),
        ("D", &found.d),
    ] {
        document.field(name, matrix(rows))?;
    }
    let eigenvalues = found.eigenvalues.as_ref();
    let eigenvalues: Option<Vec<Value>> =
        eigenvalues.map(|all| all.iter().map(|pair| vector(pair)).collect());
    document.field("eigenvalues", eigenvalues)?;
    let stability = found.tendency().map(|tendency| match tendency {
        Tendency::Stable => "stable",
        Tendency::Unstable(_) => "unstable",
        Tendency::Neutral(_) | Tendency::Kinked | Tendency::OfOneTime => "undecided",
    });
    document.field("stability", stability)?;
    document.rows("samples", found.strides.iter().map(stride))
}

fn stride(it: &Stride) -> Value {
    json!({
        "t": number(it.t),
        "until": number(it.until),
        "state": vector(&it.state),
        "next": vector(&it.next),
        "impacts": it.impacts,
        "Phi": matrix(&it.phi),
        "Gamma": matrix(&it.gamma),
    })
}

fn matrix(rows: &[Vec<f64>]) -> Value {
    rows.iter().map(|row| vector(row)).collect()
}
