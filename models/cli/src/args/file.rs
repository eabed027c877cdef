//! Flags of `new`, `watch`, `build` and `export`, the commands for files with declarations and with code.

use std::path::PathBuf;

use clap::Args;

use super::{ClaimsArgs, FeedbackArgs, SimulateArgs};

pub const NEW_EXAMPLES: &str = "The command writes pendulum.dal. With --crate it writes the crate pendulum/, with the declaration in \
src/pendulum.dal.

More examples:
  dalembert new pendulum --crate";

pub const WATCH_EXAMPLES: &str =
    "Mistakes in the file are shown until they are corrected. Ctrl-C ends the command.

More examples:
  dalembert watch pendulum.dal --until 20 --plot pendulum.svg";

pub const BUILD_EXAMPLES: &str =
    "The crate is a command line over the models of the file. The example writes it to the folder pendulum/. Built \
with `--features inlined`, it inlines the functions of the models.

More examples:
  dalembert build pendulum.dal --to fast
  cargo run --release --manifest-path fast/Cargo.toml -- list";

pub const EXPORT_EXAMPLES: &str =
    "The header is C99, allocates nothing and calls nothing but math.h. It has the rate, velocity, energy, gaps and \
impacts of the model as functions of time, state and parameters. For a model with modes, it has those functions \
of each mode.

More examples:
  dalembert export bouncing_ball --c -
  dalembert export rolling_disk --scene free --c free.h";

/// `new`
#[derive(Debug, Args)]
pub struct NewArgs {
    /// Name of the model in small letters, digits and `_`. A folder may precede it: `models/pendulum`.
    pub name: PathBuf,
    /// Write a crate that compiles the declaration.
    #[arg(long = "crate")]
    pub with_crate: bool,
    /// Folder of the library that the crate depends on. Default: the one from which this command was built.
    #[arg(long, value_name = "FOLDER", requires = "with_crate")]
    pub library: Option<PathBuf>,
}

/// `watch`
#[derive(Debug, Args)]
pub struct WatchArgs {
    #[command(flatten)]
    pub simulate: SimulateArgs,
    /// End after this many runs.
    #[arg(long, value_name = "N")]
    pub runs: Option<u64>,
}

/// `build`
#[derive(Debug, Args)]
pub struct BuildArgs {
    /// File with one declaration or several.
    #[arg(value_name = "FILE")]
    pub file: PathBuf,
    /// Folder of the crate, which must be new or empty. Default: the name of the file without its extension.
    #[arg(long, value_name = "FOLDER")]
    pub to: Option<PathBuf>,
    /// Folder of the library that the crate depends on. Default: the one from which this command was built.
    #[arg(long, value_name = "FOLDER")]
    pub library: Option<PathBuf>,
}

/// `export`
#[derive(Debug, Args)]
pub struct ExportArgs {
    /// Name of the model, as `list` prints it, or a file with its declaration: `disk.dal`, `systems.dal:disk`, `-`.
    pub model: String,
    /// Scene, a selection of forces and surfaces. `list --format json` prints the scenes.
    #[arg(long, value_name = "SCENE", default_value = "all")]
    pub scene: String,
    /// Feedback laws of inputs.
    #[command(flatten)]
    pub feedback: FeedbackArgs,
    /// Claims.
    #[command(flatten)]
    pub claims: ClaimsArgs,
    /// Write a C header. `-` is the standard output.
    #[arg(long, value_name = "FILE")]
    pub c: PathBuf,
}
