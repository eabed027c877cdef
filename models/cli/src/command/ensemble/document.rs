//! An ensemble as one JSON document: metadata, totals and density.

use std::io::{self, Write};

use serde_json::{Map, Value, json};

use super::Finished;
use crate::ensemble::metadata::measured;
use crate::json::{Document, number};
use crate::names;
use dalembert_driver::ensemble::density::{Checkpoint, Counts, Density};

/// Writes the document: the metadata of the ensemble, then the results.
///
/// # Errors
/// An I/O error of the stream.
pub fn write(output: &mut dyn Write, finished: &Finished<'_>) -> io::Result<()> {
    let tally = &finished.tally;
    let mut document = Document::begin(output)?;
    for (key, value) in finished
        .metadata
        .iter()
        .filter(|(key, _)| *key != "density")
    {
        document.field(key, value.clone())?;
    }
    let outcomes = tally.outcomes.iter();
    let outcomes = outcomes.map(|(kind, &count)| (kind.clone(), Value::from(count)));
    document.field("outcomes", outcomes.collect::<Map<_, _>>())?;
    let description = finished.model.description();
    let impacts = names::surfaces(description).zip(&tally.impacts);
    let impacts = impacts.map(|(surface, &count)| (surface.to_owned(), Value::from(count)));
    document.field("impacts_on", impacts.collect::<Map<_, _>>())?;
    document.field("statistics", statistics(finished))?;
    document.field("energy_change", number(tally.energy_change))?;
    document.field("energy_change_relative", number(tally.relative_change))?;
    let strayed = tally
        .first_strayed
        .iter()
        .map(|it| json!({ "member": it.member, "outcome": it.outcome, "reason": it.reason }));
    document.field("not_reached", tally.strayed)?;
    document.rows("first_not_reached", strayed)?;
    if let Some((density, counts, checkpoints)) = &finished.density {
        write_density(&mut document, density, counts, checkpoints)?;
    }
    document.end()
}

/// Statistics of the energy and the outputs, by column.
fn statistics(finished: &Finished<'_>) -> Map<String, Value> {
    let columns = finished.statistics.iter();
    let told = columns.map(|(name, sum)| {
        let statistics = json!({
            "count": sum.count,
            "mean": number(sum.mean()),
            "std": number(sum.deviation()),
            "least": number(sum.least),
            "greatest": number(sum.greatest),
        });
        (name.to_owned(), statistics)
    });
    told.collect()
}

/// Writes the density. Each row of counts is a row of the grid; the first row has the lowest values of the second
/// quantity.
fn write_density(
    document: &mut Document<'_>,
    density: &Density,
    counts: &Counts,
    checkpoints: &[Checkpoint],
) -> io::Result<()> {
    document.field("density", measured(density))?;
    let total = counts.total();
    document.field("density_states", total.iter().sum::<u64>())?;
    document.field("density_outside", counts.outside())?;
    let rows = checkpoints.iter().map(|it| {
        json!({
            "part": number(it.part),
            "states": it.samples,
            "halves_of_time": number(it.over_time),
            "halves_of_members": number(it.over_members),
            "independent": number(it.independent),
        })
    });
    document.rows("convergence", rows)?;
    let rows = total.chunks(density.axes[0].bins);
    document.rows("counts", rows.map(|row| Value::from(row.to_vec())))
}
