//! Maps: grids of runs, each run with the class of its end.
//!
//! | file | |
//! |---|---|
//! | `request` | the request for every run |
//! | `cell` | the run of a cell, which is watched at its returns, and its result |
//! | `orbits` | detection of returns that repeat, and the numbers of the orbits |
//! | `table` | the columns, and the row of a cell |
//! | `sums` | classes, orbits and the data of the picture, from the rows |
//!
//! Members, threads and files are those of [`ensemble`](crate::ensemble). Orbits are numbered in the order of the
//! cells. Therefore the numbers do not depend on threads, and an interrupted map recovers them from its rows.

mod cell;
mod orbits;
pub mod request;
mod sums;
mod table;

use crate::ensemble::output::{Output, Rows, Table};
use crate::ensemble::pool::{self, Division};
use crate::error::CliError;
use crate::progress::Count;
use dalembert_driver::ensemble::row::csv_line;
use dalembert_driver::ensemble::runner::{Runner, Shared};
pub use orbits::Orbit;
use request::Request;
pub use sums::{Cells, Sums};
pub use table::{columns, end, output};

/// Largest number of cells that a thread takes at once.
const BLOCK: u64 = 64;

/// Plan of a map.
pub struct Plan<'a> {
    /// Data common to all cells.
    pub shared: Shared<'a>,
    /// The request for every run.
    pub request: &'a Request,
    /// Number of threads.
    pub threads: u64,
    /// The table of the rows.
    pub table: Table<'a>,
    /// True to keep the data of the picture.
    pub is_drawn: bool,
}

/// Runs the cells; returns their sums, and the number of cells taken over from an earlier run.
///
/// # Errors
/// A file that cannot be written, that another run is writing, or that belongs to another map. Failures of a cell are
/// in its row, not errors.
pub fn execute(plan: &Plan<'_>, rows: Rows<'_>, terminal: bool) -> Result<(Sums, u64), CliError> {
    let Plan {
        shared, request, ..
    } = plan;
    let nothing = || Sums::new(plan.table.columns, request, plan.is_drawn);
    let mut sums = nothing();
    let begun = Output::begin(rows, &plan.table, None, &mut |row| sums.add(row));
    let (mut output, kept) = begun?;
    if kept == 0 {
        sums = nothing();
    }
    let count = shared.members.count();
    let mut progress = Count::new(count - kept, terminal);
    pool::in_order(
        kept..count,
        Division::new(count - kept, plan.threads, BLOCK),
        || Runner::new(*shared),
        |runner, members| match runner {
            Ok(runner) => members
                .map(|member| Ok(cell::run(runner, request, member)))
                .collect(),
            Err(error) => {
                let refuse = |_| Err(CliError::Start(error.clone()));
                members.map(refuse).collect()
            }
        },
        |first, block| {
            let mut lines = Vec::new();
            let end = first + block.len() as u64;
            for (member, cell) in (first..).zip(block) {
                let row = table::row(shared.members, member, &cell?, request, &sums.orbits);
                sums.add(&row);
                lines.append(&mut csv_line(&row));
                progress.done(sums.refused);
            }
            output.append(&lines, end, None)
        },
    )?;
    progress.finish();
    output.finish(count, None)?;
    Ok((sums, kept))
}
