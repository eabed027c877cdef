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
    let (model, task) = (finished.model, &finished.task);
    let controlled = &finished.controlled;
    let mut document = Document::of_model(output, model, finished.scene)?;
    document.field("from", named(finished.states(), &task.from))?;
    let to = finished.states().zip(&task.to);
    let to = to.filter_map(|(name, to)| to.map(|to| (name.to_owned(), number(to))));
    document.field("to", Value::Object(to.collect()))?;
    document.field("time", number(task.time))?;
    document.field("impacts", task.impacts.to_vec())?;
    document.field("tol", number(finished.tol))?;
    document.field("seed", task.seed)?;
    let search = json!({
        "unknowns": task.from.len(),
        "directions": controlled.directions,
        "runs": controlled.runs,
        "bounded": controlled.is_bounded,
        "unresolved": controlled.unresolved,
        "given_up": controlled.given_up,
        "exhaustive": false,
    });
    document.field("search", search)?;
    let rows = controlled.extremals.iter();
    document.rows("extremals", rows.map(|it| extremal(finished, it)))?;
    document.end()
}

fn extremal(finished: &Finished<'_>, extremal: &Extremal) -> Value {
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
