//! Ensembles: many members of one scene, each with its own start or parameters.
//!
//! | file | |
//! |---|---|
//! | `vary`, `random`, `members`, `listed` | what each member starts with, by its index alone |
//! | `runner` | runs one member and makes a row of it, whatever happens |
//! | `pool` | runs them on threads and gives the rows back in order |
//! | `row`, `journal`, `parquet` | the rows, the file they are appended to and continued from, the same as Parquet |
//! | `tally`, `density` | what is known of all together |
//! | `metadata` | what tells an ensemble from another |
//!
//! A row depends on its member alone, and everything that is summed is summed in order of members or in whole numbers:
//! no file depends on threads, and the rows of shards, one after the other, are those of the whole.

pub mod density;
mod fingerprint;
pub mod journal;
pub mod listed;
pub mod members;
pub mod metadata;
#[cfg(feature = "parquet")]
pub mod parquet;
pub mod pilot;
mod pool;
mod random;
mod row;
mod runner;
mod tally;
mod vary;

use std::io::Write;
use std::ops::Range;
use std::path::Path;

use dalembert_driver::Settings;
use serde_json::{Map, Value};

pub use row::Columns;
pub use runner::Shared;
pub use tally::Tally;
pub use vary::Quantity;

use crate::error::CliError;
use crate::progress::Count;
use density::{Counts, Density};
use journal::Journal;
use pool::Division;
use row::csv_line;
use runner::{Done, Runner};

/// The most members that a thread takes at one time.
const BLOCK: u64 = 64;

/// The most visits that the members a thread takes at one time may have.
const VISITS: u64 = 1 << 16;

/// What is to be run.
pub struct Plan<'a> {
    /// What all members share.
    pub shared: Shared<'a>,
    /// Those of the shard.
    pub range: Range<u64>,
    /// Threads.
    pub threads: u64,
    /// What tells the ensemble from others.
    pub metadata: &'a Map<String, Value>,
    /// The columns of its rows.
    pub columns: &'a Columns,
}

/// Where rows go.
pub enum Rows<'a> {
    /// Nowhere.
    Nowhere,
    /// To a stream.
    Stream(&'a mut dyn Write),
    /// To a file, named by a flag.
    File {
        /// The flag.
        flag: &'static str,
        /// The file.
        path: &'a Path,
        /// Whether to go on with what is there.
        resume: bool,
    },
}

/// What is known once all members are run.
pub struct Summary {
    /// Of the rows.
    pub tally: Tally,
    /// Of the density.
    pub counts: Option<Counts>,
    /// Members that an earlier run left.
    pub kept: u64,
}

/// Whether an outcome is the end that was asked for.
pub fn is_reached(outcome: &str, settings: &Settings) -> bool {
    outcome == "done" || (outcome == "impact_budget" && settings.impacts.is_some())
}

/// Runs the members.
///
/// # Errors
/// A file that cannot be written, that another run is writing, or that is of another ensemble. Whatever happens to a member is in its row.
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
            match &mut output {
                Output::Nowhere => Ok(()),
                Output::Stream(stream) => Ok(stream.write_all(&lines)?),
                Output::Journal(journal) => {
                    journal.append(&lines, members, summary.counts.as_ref())
                }
            }
        },
    )?;
    progress.finish();
    if let Output::Journal(journal) = output {
        journal.finish(range.end - range.start, summary.counts.as_ref())?;
    }
    Ok(summary)
}

/// How many members a thread takes at one time: what they visit is held in memory.
fn block(density: Option<&Density>) -> u64 {
    density.map_or(BLOCK, |density| {
        (VISITS / density.samples.max(1)).clamp(1, BLOCK)
    })
}

/// Where rows go, open.
enum Output<'a> {
    Nowhere,
    Stream(&'a mut dyn Write),
    Journal(Journal),
}

/// Opens what rows go to, and takes over what an earlier run left.
fn begin<'a>(plan: &Plan<'_>, rows: Rows<'a>) -> Result<(Summary, Output<'a>), CliError> {
    let Plan {
        shared,
        range,
        metadata,
        columns,
        ..
    } = plan;
    let nothing = || Summary {
        tally: Tally::new(columns),
        counts: shared.density.map(Counts::new),
        kept: 0,
    };
    let mut summary = nothing();
    let output = match rows {
        Rows::Nowhere => Output::Nowhere,
        Rows::Stream(stream) => {
            stream.write_all(&columns.header())?;
            Output::Stream(stream)
        }
        Rows::File { flag, path, resume } => {
            let mut journal = Journal::open(flag, path)?;
            if resume {
                let Summary { tally, counts, .. } = &mut summary;
                let mut see =
                    |row: &_| tally.add(row, |outcome| is_reached(outcome, shared.settings));
                let begun = (range.start, counts.as_mut());
                if let Some(kept) = journal.resume(columns, metadata, begun, &mut see)? {
                    summary.kept = kept;
                    return Ok((summary, Output::Journal(journal)));
                }
                summary = nothing();
            }
            journal.begin(columns, metadata)?;
            Output::Journal(journal)
        }
    };
    Ok((summary, output))
}
