//! The flags of commands that write a row for each of many runs.

use std::path::PathBuf;

use clap::Args;

/// Threads, and the files of the rows.
#[derive(Debug, Args)]
pub struct RowsArgs {
    /// Number of threads. Default: the number that the machine runs in parallel.
    #[arg(long, value_name = "N", allow_hyphen_values = true, value_parser = clap::value_parser!(u16).range(1..))]
    pub threads: Option<u16>,
    /// Write a row for every run as soon as it is done. `-` is the standard output. An existing file keeps its rows
    /// until the new rows are complete. Until then the new rows are in FILE.new.
    #[arg(long, value_name = "FILE")]
    pub csv: Option<PathBuf>,
    /// Write the same rows as Parquet after the last run (needs a build with the feature `parquet`).
    #[arg(long, value_name = "FILE")]
    pub parquet: Option<PathBuf>,
    /// Continue interrupted files of --csv or --parquet. Without this flag, all runs are made.
    #[arg(long)]
    pub resume: bool,
}

impl RowsArgs {
    /// Number of threads.
    pub fn thread_count(&self) -> u64 {
        super::thread_count(self.threads)
    }
}
