//! The destination of rows: nowhere, a stream, or a file from which an interrupted run continues.

use std::io::Write;
use std::path::{Path, PathBuf};

use dalembert_driver::ensemble::density::Counts;
use dalembert_driver::ensemble::row::{Columns, Row};
use serde_json::{Map, Value};

use super::beside::{self, beside};
use super::journal::Journal;
use crate::args::RowsArgs;
use crate::error::CliError;
use crate::sink::is_stdout;

/// The table of the rows.
#[derive(Clone, Copy)]
pub struct Table<'a> {
    /// Its columns.
    pub columns: &'a Columns,
    /// Metadata that identify the runs.
    pub metadata: &'a Map<String, Value>,
    /// The member of its first row.
    pub first: u64,
}

/// Destination of the rows.
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
        /// True to continue an existing file.
        resume: bool,
    },
}

/// Open destination of the rows.
pub enum Output<'a> {
    /// Nowhere.
    Nowhere,
    /// To a stream.
    Stream(&'a mut dyn Write),
    /// To a file.
    Journal(Journal),
}

impl<'a> Output<'a> {
    /// Opens the destination, passes the rows of an earlier run to `see`, and returns their number. If the number is 0,
    /// the caller must discard everything that `see` and `counts` have received.
    ///
    /// # Errors
    /// A file that cannot be written, that another run is writing, or that belongs to other runs.
    pub fn begin(
        rows: Rows<'a>,
        table: &Table<'_>,
        counts: Option<&mut Counts>,
        see: &mut dyn FnMut(&Row),
    ) -> Result<(Self, u64), CliError> {
        let Table {
            columns,
            metadata,
            first,
        } = *table;
        let output = match rows {
            Rows::Nowhere => Self::Nowhere,
            Rows::Stream(stream) => {
                stream.write_all(&columns.header())?;
                Self::Stream(stream)
            }
            Rows::File { flag, path, resume } => {
                let mut journal = Journal::open(flag, path)?;
                if resume
                    && let Some(kept) = journal.resume(columns, metadata, (first, counts), see)?
                {
                    return Ok((Self::Journal(journal), kept));
                }
                journal.begin(columns, metadata)?;
                Self::Journal(journal)
            }
        };
        Ok((output, 0))
    }

    /// Appends lines. `members` is the number of members whose rows are written and counted afterwards.
    ///
    /// # Errors
    /// An I/O error of the destination.
    pub fn append(
        &mut self,
        lines: &[u8],
        members: u64,
        counts: Option<&Counts>,
    ) -> Result<(), CliError> {
        match self {
            Self::Nowhere => Ok(()),
            Self::Stream(stream) => Ok(stream.write_all(lines)?),
            Self::Journal(journal) => journal.append(lines, members, counts),
        }
    }

    /// Completes the destination.
    ///
    /// # Errors
    /// An I/O error of the destination.
    pub fn finish(self, members: u64, counts: Option<&Counts>) -> Result<(), CliError> {
        match self {
            Self::Journal(journal) => journal.finish(members, counts),
            Self::Nowhere | Self::Stream(_) => Ok(()),
        }
    }

    /// Removes the file of rows that this run started.
    pub fn abandon(self) {
        if let Self::Journal(journal) = self {
            journal.abandon();
        }
    }
}

impl RowsArgs {
    /// The file to which rows are appended: that of `--csv`, else a temporary file next to that of `--parquet`.
    pub fn file(&self) -> Option<(&'static str, PathBuf)> {
        match (&self.csv, &self.parquet) {
            (Some(csv), _) => (!is_stdout(csv)).then(|| ("--csv", csv.clone())),
            (None, Some(parquet)) => Some(("--parquet", beside(parquet, ".rows.csv"))),
            (None, None) => None,
        }
    }

    /// Refuses incompatible flags.
    ///
    /// # Errors
    /// [`CliError::Usage`].
    pub fn check(&self) -> Result<(), CliError> {
        let streamed = self.csv.as_deref().is_some_and(is_stdout);
        if self.parquet.as_deref().is_some_and(is_stdout) {
            return Err(CliError::Usage("--parquet needs a file"));
        }
        if streamed && self.parquet.is_some() {
            return Err(CliError::Usage(
                "--csv - and --parquet: Parquet is made from the rows of a file; give a file to --csv",
            ));
        }
        if self.resume && self.file().is_none() {
            return Err(CliError::Usage(
                "--resume continues the file of --csv or --parquet: give one of them",
            ));
        }
        if self.parquet.is_some() && !cfg!(feature = "parquet") {
            return Err(CliError::Usage(
                "--parquet: this program was built without Parquet; build it with `--features parquet`",
            ));
        }
        Ok(())
    }

    /// Calls `make` with the destination of the rows, then writes the rows as Parquet if requested.
    ///
    /// # Errors
    /// The error of the function, or a file that cannot be written.
    pub fn write<T>(
        &self,
        table: &Table<'_>,
        stream: &mut dyn Write,
        make: impl FnOnce(Rows<'_>) -> Result<T, CliError>,
    ) -> Result<T, CliError> {
        let file = self.file();
        let rows = match (&self.csv, &file) {
            (Some(path), _) if is_stdout(path) => Rows::Stream(stream),
            (_, Some((flag, path))) => Rows::File {
                flag,
                path,
                resume: self.resume,
            },
            _ => Rows::Nowhere,
        };
        let made = make(rows)?;
        if let (Some(parquet), Some((flag, path))) = (&self.parquet, &file) {
            write_parquet(parquet, path, table)?;
            if self.csv.is_none() {
                beside::discard(path).map_err(|source| CliError::File {
                    flag,
                    path: path.clone(),
                    source,
                })?;
            }
        }
        Ok(made)
    }
}

/// Writes a new file, and puts it in the place of an existing one when it is complete.
#[cfg(feature = "parquet")]
fn write_parquet(path: &Path, rows: &Path, table: &Table<'_>) -> Result<(), CliError> {
    let new = beside(path, beside::NEW);
    let written = super::parquet::write(&new, rows, table.columns, table.metadata, table.first);
    let written = written.map_err(std::io::Error::other);
    let renamed = written.and_then(|()| std::fs::rename(&new, path));
    renamed.map_err(|source| CliError::File {
        flag: "--parquet",
        path: path.to_owned(),
        source,
    })
}

/// NOTE: never called, because [`RowsArgs::check`] refuses the flag in a build without Parquet.
#[cfg(not(feature = "parquet"))]
fn write_parquet(_path: &Path, _rows: &Path, _table: &Table<'_>) -> Result<(), CliError> {
    Ok(())
}
