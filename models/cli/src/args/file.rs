//! Flags of `new`, `watch` and `build`, the commands for files with declarations.

use std::path::PathBuf;

use clap::Args;

use super::SimulateArgs;

pub const NEW_EXAMPLES: &str = "Examples:
  dalembert new pendulum                  writes pendulum.dal
  dalembert new pendulum --crate          writes the crate pendulum/, with the declaration in src/pendulum.dal";

pub const WATCH_EXAMPLES: &str =
    "Mistakes in the file are shown until they are mended. Ctrl-C ends the command.

Examples:
  dalembert watch pendulum.dal
  dalembert watch pendulum.dal --until 20 --plot pendulum.svg";

pub const BUILD_EXAMPLES: &str =
    "The crate has the command line over its models, with their functions inlined where it is built with
`--features inlined`.

Examples:
  dalembert build pendulum.dal            writes the crate pendulum/
  dalembert build pendulum.dal --to fast && cargo run --release --manifest-path fast/Cargo.toml -- list";

/// `new`
#[derive(Debug, Args)]
pub struct NewArgs {
    /// Name of the model in small letters, digits and `_`, with a folder in front of it or without.
    pub name: PathBuf,
    /// Write a crate that compiles the declaration.
    #[arg(long = "crate")]
    pub with_crate: bool,
    /// Folder of the library that the crate depends on; without it, the one that this command was built from.
    #[arg(long, value_name = "FOLDER", requires = "with_crate")]
    pub library: Option<PathBuf>,
}

/// `watch`
#[derive(Debug, Args)]
pub struct WatchArgs {
    #[command(flatten)]
    pub simulate: SimulateArgs,
    /// End after so many runs.
    #[arg(long, value_name = "N")]
    pub runs: Option<u64>,
}

/// `build`
#[derive(Debug, Args)]
pub struct BuildArgs {
    /// File with one declaration or several.
    #[arg(value_name = "FILE")]
    pub file: PathBuf,
    /// Folder of the crate, which must not exist yet or be empty; without it, the name of the file without its ending.
    #[arg(long, value_name = "FOLDER")]
    pub to: Option<PathBuf>,
    /// Folder of the library that the crate depends on; without it, the one that this command was built from.
    #[arg(long, value_name = "FOLDER")]
    pub library: Option<PathBuf>,
}
