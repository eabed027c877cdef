//! Text summary of the extremals over a varied quantity, with a table of least costs.

use std::io::{self, Write};

use super::super::summary::{end, title};
use super::{Sweep, cheapest};
use crate::error;

/// Writes the summary.
pub(super) fn write(output: &mut dyn Write, sweep: &Sweep<'_>) -> io::Result<()> {
    if let Some((_, finished)) = sweep.made().next() {
        writeln!(output, "{}", title(finished))?;
    }
    writeln!(output, "  {}", subtitle(sweep))?;
    let runs: u64 = sweep
        .made()
        .map(|(_, finished)| finished.controlled.runs)
        .sum();
    writeln!(
        output,
        "  search      {}",
        error::counted(runs as usize, "run")
    )?;
    writeln!(
        output,
        "  coverage    scans sample costates, so extremals may be missed"
    )?;
    writeln!(output, "  values      {}", sweep.members.len())?;
    writeln!(output, "  found       {}", sweep.counted())?;
    writeln!(output)?;
    writeln!(output, "  least costs by number of impacts")?;
    write!(output, "  {:>24}", sweep.name)?;
    for impacts in sweep.impacts() {
        write!(output, "  {:>24}", error::counted(impacts, "impact"))?;
    }
    writeln!(output)?;
    for member in &sweep.members {
        write!(output, "  {:>24}", format!("{:?}", member.value))?;
        match &member.found {
            Ok(finished) => {
                for impacts in sweep.impacts() {
                    let cost = cheapest(finished, impacts).map(|extremal| extremal.cost);
                    let cost = cost.map_or_else(|| "-".to_owned(), |cost| format!("{cost:?}"));
                    write!(output, "  {cost:>24}")?;
                }
                writeln!(output)?;
            }
            Err(reason) => writeln!(output, "  {reason}")?,
        }
    }
    Ok(())
}

/// The fixed components of the start, the end, and the range of the varied quantity.
pub(super) fn subtitle(sweep: &Sweep<'_>) -> String {
    let values = || sweep.members.iter().map(|member| member.value);
    let [least, most] = values().fold(
        [f64::INFINITY, f64::NEG_INFINITY],
        |[least, most], value| [f64::min(least, value), f64::max(most, value)],
    );
    let varied = format!("{} from {least:?} to {most:?}", sweep.name);
    match sweep.made().next() {
        None => varied,
        Some((_, finished)) => {
            let fixed = finished.states().zip(&finished.task.from);
            let fixed = fixed.filter(|(name, _)| *name != sweep.name);
            let fixed: Vec<String> = fixed
                .map(|(name, value)| format!("{name} = {value:?}"))
                .collect();
            format!("from {} to {}, {varied}", fixed.join(", "), end(finished))
        }
    }
}
