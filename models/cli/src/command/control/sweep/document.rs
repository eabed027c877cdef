//! Extremals over a varied quantity as one JSON document.

use std::io::{self, Write};

use dalembert_driver::ensemble::Quantity;
use serde_json::{Value, json};

use super::super::document::{extremal, search, write_task};
use super::{Member, Sweep};
use crate::json::{Document, number};

/// Writes the document. The parameters and the start are those of the first value that was not refused.
pub(super) fn write(output: &mut dyn Write, sweep: &Sweep<'_>) -> io::Result<()> {
    let mut document = Document::of_model(output, sweep.model, sweep.scene)?;
    if let Some((_, finished)) = sweep.made().next() {
        write_task(&mut document, finished)?;
    }
    let kind = match sweep.quantity {
        Quantity::Parameter(_) => "parameter",
        Quantity::Position(_) | Quantity::Velocity(_) => "start",
    };
    document.field("varied", json!({ "name": sweep.name, "kind": kind }))?;
    document.rows("members", sweep.members.iter().map(member))?;
    document.end()
}

fn member(member: &Member<'_>) -> Value {
    match &member.found {
        Ok(finished) => {
            let extremals = finished.controlled.extremals.iter();
            let extremals: Vec<Value> = extremals.map(|it| extremal(finished, it)).collect();
            json!({
                "value": number(member.value),
                "refused": null,
                "search": search(finished),
                "extremals": extremals,
            })
        }
        Err(reason) => json!({
            "value": number(member.value),
            "refused": reason,
            "search": null,
            "extremals": [],
        }),
    }
}
