//! Ensembles: many members of one scene, each with its own start or parameters.
//!
//! | file | |
//! |---|---|
//! | `vary`, `members`, `listed`, `density` | members and densities from flags and tables |
//! | `common` | the model and the start that members share, from flags |
//! | `pool` | runs members on threads and returns the rows in order |
//! | `output` | the destination of the rows |
//! | `journal`, `line` | the file to which rows are appended and from which an interrupted run continues, and the parser of its lines |
//! | `beside` | the file of rows and the files beside it, replaced and removed together |
//! | `difference` | flags that a file was made with, where they differ from those of a request |
//! | `parquet` | the rows as Parquet |
//! | `merge` | rows and counts from the files of shards |
//! | `statistics` | mean, spread and extremes over all members |
//! | `metadata` | metadata that identify an ensemble |
//!
//! The types of members, rows and sums are in [`dalembert_driver::ensemble`].

mod beside;
pub mod common;
pub mod density;
mod difference;
mod fingerprint;
pub mod journal;
mod line;
pub mod listed;
pub mod members;
pub mod merge;
pub mod metadata;
pub mod output;
#[cfg(feature = "parquet")]
pub mod parquet;
pub mod pool;
pub mod statistics;
pub mod vary;

use std::ops::Range;

use dalembert_driver::ensemble::density::{Counts, Density};
use dalembert_driver::ensemble::row::{Row, csv_line};
use dalembert_driver::ensemble::runner::{Done, Runner, Shared};
use dalembert_driver::ensemble::{Tally, is_reached};

use crate::error::CliError;
use crate::progress::Count;
use merge::Part;
use output::{Output, Rows, Table};
use pool::Division;
use statistics::Statistics;

/// Largest number of members in a block of a thread.
const BLOCK: u64 = 64;

/// Largest number of density samples of the members in a block.
const VISITS: u64 = 1 << 16;

/// Bytes of merged rows that are written at once.
const LINES: usize = 1 << 20;

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
    /// Shards to take the rows from, in place of runs.
    pub merged: &'a [Part<'a>],
}

/// Results over all members.
pub struct Summary {
    /// Sums over the rows.
    pub tally: Tally,
    /// Statistics of the energy and the outputs.
    pub statistics: Statistics,
    /// Counts of the density.
    pub counts: Option<Counts>,
    /// Number of members taken over from an earlier run.
    pub kept: u64,
}

impl Summary {
    /// Adds a row. `reached` is true for outcomes that are the requested end.
    fn add(&mut self, row: &Row, reached: impl Fn(&str) -> bool) {
        self.tally.add(row, reached);
        self.statistics.add(row);
    }
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
    if !plan.merged.is_empty()
        && let Err(error) = merge(plan, &mut summary, &mut output)
    {
        output.abandon();
        return Err(error);
    }
    let left = range.start + summary.kept..range.end;
    let mut progress = Count::new(left.end - left.start, terminal);
    pool::in_order(
        left.clone(),
        Division::new(left.end - left.start, plan.threads, block(shared.density)),
        || Runner::new(*shared),
        |runner, members| match runner {
            Ok(runner) => runner.run(members).into_iter().map(Ok).collect(),
            Err(error) => {
                let refuse = |_| Err(CliError::Start(error.clone()));
                members.map(refuse).collect()
            }
        },
        |first, block| {
            let mut lines = Vec::new();
            let mut members = first - range.start;
            for done in block {
                let Done { row, visits } = done?;
                summary.add(&row, reached);
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

/// Takes the rows of all members from the files of shards.
fn merge(plan: &Plan<'_>, summary: &mut Summary, output: &mut Output<'_>) -> Result<(), CliError> {
    let (shared, members) = (&plan.shared, plan.range.end);
    let Summary {
        tally,
        statistics,
        counts,
        kept,
    } = summary;
    let table = &plan.table;
    let mut lines = Vec::new();
    merge::read(
        plan.merged,
        table.columns,
        counts.as_mut(),
        &mut |line, row| {
            tally.add(row, |outcome| is_reached(outcome, shared.settings));
            statistics.add(row);
            *kept += 1;
            lines.extend_from_slice(line);
            if lines.len() < LINES && *kept < members {
                return Ok(());
            }
            // NOTE: the counts are complete only after the last shard; `finish` saves them.
            let written = output.append(&lines, *kept, None);
            lines.clear();
            written
        },
    )
}

/// Number of members in a block; it is limited because their density samples are held in memory.
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
        statistics: Statistics::new(plan.table.columns),
        counts: shared.density.map(Counts::new),
        kept: 0,
    };
    let mut summary = nothing();
    let Summary {
        tally,
        statistics,
        counts,
        ..
    } = &mut summary;
    let mut see = |row: &Row| {
        tally.add(row, |outcome| is_reached(outcome, shared.settings));
        statistics.add(row);
    };
    let (output, kept) = Output::begin(rows, &plan.table, counts.as_mut(), &mut see)?;
    match kept {
        0 => Ok((nothing(), output)),
        kept => Ok((Summary { kept, ..summary }, output)),
    }
}
