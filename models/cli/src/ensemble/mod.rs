//! Ensembles: many members of one scene, each with its own start or parameters.
//!
//! | file | |
//! |---|---|
//! | `vary`, `random`, `members`, `listed` | the start of each member, as a function of its index |
//! | `runner` | runs one member and makes its row, also after a refusal or a panic |
//! | `pool` | runs members on threads and returns the rows in order |
//! | `row`, `output`, `journal`, `parquet` | the rows, where they go, the file they are appended to and continued from, the same as Parquet |
//! | `tally`, `density` | sums over all members |
//! | `metadata` | data that identify an ensemble |
//!
//! A row depends on its member alone, and sums are formed in the order of members or in integers. Files therefore do
//! not depend on threads, and the concatenated rows of all shards are those of the whole ensemble.

pub mod density;
mod fingerprint;
pub mod journal;
pub mod listed;
pub mod members;
pub mod metadata;
pub mod output;
#[cfg(feature = "parquet")]
pub mod parquet;
pub mod pilot;
pub mod pool;
mod random;
pub mod row;
pub mod runner;
mod tally;
pub mod vary;

use std::ops::Range;

use dalembert_driver::Settings;

pub use row::Columns;
pub use runner::Shared;
pub use tally::Tally;
pub use vary::Quantity;

use crate::error::CliError;
use crate::progress::Count;
use density::{Counts, Density};
use output::{Output, Rows, Table};
use pool::Division;
use row::csv_line;
use runner::{Done, Runner};

/// Largest number of members in a block of a thread.
const BLOCK: u64 = 64;

/// Largest number of visits of the members in a block.
const VISITS: u64 = 1 << 16;

/// Plan of an ensemble.
pub struct Plan<'a> {
    /// Data common to all members.
    pub shared: Shared<'a>,
    /// The members of the shard.
    pub range: Range<u64>,
    /// Number of threads.
    pub threads: u64,
    /// The table of the rows.
    pub table: Table<'a>,
}

/// Results over all members.
pub struct Summary {
    /// Sums over the rows.
    pub tally: Tally,
    /// Counts of the density.
    pub counts: Option<Counts>,
    /// Number of members taken over from an earlier run.
    pub kept: u64,
}

/// True if an outcome is the requested end.
pub fn is_reached(outcome: &str, settings: &Settings) -> bool {
    outcome == "done" || (outcome == "impact_budget" && settings.impacts.is_some())
}

/// Runs the members.
///
/// # Errors
/// A file that cannot be written, that another run is writing, or that belongs to another ensemble. Failures of a
/// member are in its row, not errors.
pub fn execute(plan: &Plan<'_>, rows: Rows<'_>, terminal: bool) -> Result<Summary, CliError> {
    let Plan { shared, range, .. } = plan;
    let reached = |outcome: &str| is_reached(outcome, shared.settings);
    let (mut summary, mut output) = begin(plan, rows)?;
    let left = range.start + summary.kept..range.end;
    let mut progress = Count::new(left.end - left.start, terminal);
    pool::in_order(
        left.clone(),
        Division::new(left.end - left.start, plan.threads, block(shared.density)),
        || Runner::new(*shared),
        |runner, members| match runner {
            Ok(runner) => runner.run(members).into_iter().map(Ok).collect(),
            Err(error) => {
                let refuse = |_| Err(CliError::Start(error.to_string()));
                members.map(refuse).collect()
            }
        },
        |first, block| {
            let mut lines = Vec::new();
            let mut members = first - range.start;
            for done in block {
                let Done { row, visits } = done?;
                summary.tally.add(&row, reached);
                if let (Some(counts), Some(visits)) = (&mut summary.counts, &visits) {
                    counts.add(range.start + members, visits);
                }
                lines.append(&mut csv_line(&row));
                members += 1;
                progress.done(summary.tally.strayed);
            }
            output.append(&lines, members, summary.counts.as_ref())
        },
    )?;
    progress.finish();
    output.finish(range.end - range.start, summary.counts.as_ref())?;
    Ok(summary)
}

/// Number of members in a block: their visits are held in memory.
fn block(density: Option<&Density>) -> u64 {
    density.map_or(BLOCK, |density| {
        (VISITS / density.samples.max(1)).clamp(1, BLOCK)
    })
}

/// Opens the destination of the rows, and takes over the rows of an earlier run.
fn begin<'a>(plan: &Plan<'_>, rows: Rows<'a>) -> Result<(Summary, Output<'a>), CliError> {
    let shared = &plan.shared;
    let nothing = || Summary {
        tally: Tally::new(plan.table.columns),
        counts: shared.density.map(Counts::new),
        kept: 0,
    };
    let mut summary = nothing();
    let Summary { tally, counts, .. } = &mut summary;
    let mut see = |row: &_| tally.add(row, |outcome| is_reached(outcome, shared.settings));
    let (output, kept) = Output::begin(rows, &plan.table, counts.as_mut(), &mut see)?;
    match kept {
        0 => Ok((nothing(), output)),
        kept => Ok((Summary { kept, ..summary }, output)),
    }
}
