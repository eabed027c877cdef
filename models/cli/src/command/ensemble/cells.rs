//! A density as CSV, one row per cell.

use std::io::{self, Write};

use crate::table;
use dalembert_driver::ensemble::density::{Axis, Counts, Density};

/// Writes the middle of every cell, its number of states, and the density there: the fraction of all states in cells,
/// divided by the area of the cell.
///
/// # Errors
/// An I/O error of the stream.
pub fn write(output: &mut dyn Write, density: &Density, counts: &Counts) -> io::Result<()> {
    let total = counts.total();
    let all = total.iter().sum::<u64>() as f64;
    let [x, y] = &density.axes;
    table::write_rows(output, |writer| {
        writer.write_record([&x.name, &y.name, "count", "density"])?;
        for (cell, &count) in total.iter().enumerate() {
            let middle = |axis: &Axis, bin: usize| 0.5 * (axis.edge(bin) + axis.edge(bin + 1));
            let share = if count == 0 { 0.0 } else { count as f64 / all };
            writer.write_record([
                format!("{:?}", middle(x, cell % x.bins)),
                format!("{:?}", middle(y, cell / x.bins)),
                count.to_string(),
                format!("{:?}", share / density.cell_area()),
            ])?;
        }
        Ok(())
    })
}
