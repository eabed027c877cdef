//! Extremals as one JSON document.

use std::io::{self, Write};

use dalembert_driver::{Extremal, Moment, SecondOrder};
use serde_json::{Value, json};

use super::Finished;
use super::summary::verdict;
use crate::json::{Document, named, number};
use crate::names;

/// Writes the document.
pub(super) fn write(output: &mut dyn Write, finished: &Finished<'_>) -> io::Result<()> {
    let mut document = Document::of_model(output, finished.model, finished.scene)?;
    write_task(&mut document, finished)?;
    document.field("search", search(finished))?;
    let rows = finished.controlled.extremals.iter();
    document.rows("extremals", rows.map(|it| extremal(finished, it)))?;
    document.end()
}

/// Writes the request.
pub(super) fn write_task(document: &mut Document<'_>, finished: &Finished<'_>) -> io::Result<()> {
    let task = &finished.task;
    document.field("from", named(finished.states(), &task.from))?;
    let to = finished.states().zip(&task.to);
    let to = to.filter_map(|(name, to)| to.map(|to| (name.to_owned(), number(to))));
    document.field("to", Value::Object(to.collect()))?;
    document.field("time", number(task.time))?;
    document.field("impacts", task.impacts.to_vec())?;
    document.field("tol", number(finished.tol))?;
    document.field("seed", task.seed)
}

/// The extent of the search.
pub(super) fn search(finished: &Finished<'_>) -> Value {
    let controlled = &finished.controlled;
    json!({
        "unknowns": finished.task.from.len(),
        "directions": controlled.directions,
        "runs": controlled.runs,
        "bounded": controlled.is_bounded,
        "unresolved": controlled.unresolved,
        "given_up": controlled.given_up,
        "rounding": number(controlled.rounding),
        "exhaustive": false,
    })
}

/// An extremal.
pub(super) fn extremal(finished: &Finished<'_>, extremal: &Extremal) -> Value {
    let surface = |index: usize| names::surfaces(finished.description()).nth(index);
    let impacts = extremal.kicks.iter().map(|kick| {
        json!({
            "t": number(kick.before.t),
            "surface": surface(kick.surface),
            "before": moment(finished, &kick.before),
            "after": moment(finished, &kick.after),
        })
    });
    let near = match extremal.second_order {
        SecondOrder::Fails { t } => number(t),
        SecondOrder::Minimum | SecondOrder::Open => Value::Null,
    };
    json!({
        "cost": number(extremal.cost),
        "terminal": number(extremal.terminal),
        "start": moment(finished, &extremal.first),
        "end": moment(finished, &extremal.last),
        "impacts": impacts.collect::<Vec<_>>(),
        "residual": number(extremal.residual),
        "second_order": { "verdict": verdict(extremal).0, "t": near },
    })
}

fn moment(finished: &Finished<'_>, moment: &Moment) -> Value {
    json!({
        "state": named(finished.states(), &moment.state),
        "costate": named(finished.states(), &moment.costate),
        "inputs": named(finished.inputs(), &moment.inputs),
        "hamiltonian": number(moment.hamiltonian),
    })
}
