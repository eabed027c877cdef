//! Rows and counts of all shards of an ensemble, taken from their files.

use std::path::{Path, PathBuf};

use dalembert_driver::ensemble::density::Counts;
use dalembert_driver::ensemble::row::Columns;
use serde_json::{Map, Value};

use super::difference;
use super::journal::{self, Receiver};
use crate::error::CliError;

/// The flag, for messages.
const FLAG: &str = "--merge";

/// A shard in a file.
pub struct Part<'a> {
    path: &'a Path,
    index: u64,
    of: u64,
    first: u64,
    members: u64,
}

/// The shards in files, in the order of members. This reads metadata only, so that shards which do not fit are refused
/// before any output is opened.
///
/// # Errors
/// A file that cannot be read, or that belongs to another ensemble; members that are in no file, or in two.
pub fn parts<'a>(
    files: &'a [PathBuf],
    metadata: &Map<String, Value>,
    members: u64,
) -> Result<Vec<Part<'a>>, CliError> {
    let parts: Result<Vec<Part<'_>>, CliError> =
        files.iter().map(|path| part(path, metadata)).collect();
    let mut parts = parts?;
    parts.sort_by_key(|part| (part.first, part.members));
    let mut next = 0;
    for part in &parts {
        if part.first != next {
            return Err(uncovered(part.first.min(next)..part.first.max(next), part));
        }
        next += part.members;
    }
    match parts.last().filter(|_| next != members) {
        Some(last) => Err(uncovered(next..members, last)),
        None => Ok(parts),
    }
}

/// Passes the rows of all shards to `see`, in the order of members, and adds their counts.
///
/// # Errors
/// A file that cannot be read, that was altered or is not finished.
pub fn read(
    parts: &[Part<'_>],
    columns: &Columns,
    mut counts: Option<&mut Counts>,
    see: Receiver<'_>,
) -> Result<(), CliError> {
    for part in parts {
        let rows = (columns, part.first);
        let rows = journal::read_shard(FLAG, part.path, rows, counts.as_deref_mut(), see)?;
        if rows != part.members {
            return Err(CliError::Input {
                place: format!("{FLAG} {}", part.path.display()),
                reason: format!(
                    "the file holds {rows} of the {} members of its shard; finish it with --shard {}/{} --resume",
                    part.members, part.index, part.of
                ),
            });
        }
    }
    Ok(())
}

/// The shard that a file contains; the file must belong to this ensemble.
fn part<'a>(path: &'a Path, metadata: &Map<String, Value>) -> Result<Part<'a>, CliError> {
    let mut before = journal::metadata_of(FLAG, path)?;
    let shard = before.remove("shard").unwrap_or_default();
    let mut metadata = metadata.clone();
    metadata.remove("shard");
    let place = format!("{FLAG} {}", path.display());
    if let Some(difference) = difference::explain(&before, &metadata) {
        return Err(CliError::Input {
            place,
            reason: format!("the file is of another ensemble: {difference}"),
        });
    }
    let number = |key: &str| shard.get(key).and_then(Value::as_u64);
    let read = || {
        Some(Part {
            path,
            index: number("index")?,
            of: number("of")?,
            first: number("first")?,
            members: number("members")?,
        })
    };
    read().ok_or_else(|| CliError::Input {
        place,
        reason: "its metadata do not name a shard; run the shard again".to_owned(),
    })
}

/// The error for members that are in no file, or in two.
fn uncovered(members: std::ops::Range<u64>, part: &Part<'_>) -> CliError {
    CliError::Input {
        place: format!("{FLAG} {}", part.path.display()),
        reason: format!(
            "members {} to {} are in no file, or in two; name the file of every shard once",
            members.start,
            members.end.saturating_sub(1)
        ),
    }
}
