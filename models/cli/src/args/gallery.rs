//! The flags of `gallery`.

use std::path::PathBuf;

use clap::Args;

/// The end of `gallery --help`.
pub const EXAMPLES: &str = "Writes index.html, which needs no other file, each picture as NAME.svg, and manifest.json: what
was drawn by which command, how the run ended, how long it took. But for manifest.json and
diagrams of measured times two runs write the same bytes. Exit status: 0 every picture was made,
1 some could not be.

Examples:
  dalembert gallery pictures
  dalembert gallery pictures rolling_disk chaplygin_sleigh --quick
  dalembert gallery --list
  dalembert gallery . --picture rolling_disk-motion-path";

/// `gallery`
#[derive(Debug, Args)]
pub struct GalleryArgs {
    /// The folder to write to; it is made if it does not exist.
    #[arg(value_name = "OUT", required_unless_present = "list")]
    pub out: Option<PathBuf>,
    /// Only figures of these models, by their names as `list` prints them.
    #[arg(value_name = "MODEL")]
    pub models: Vec<String>,
    /// Only this picture, without a page; may be repeated.
    #[arg(long, value_name = "NAME", conflicts_with = "models")]
    pub picture: Vec<String>,
    /// Print the names of the pictures and what they show, and draw nothing.
    #[arg(long)]
    pub list: bool,
    /// Shorter runs for densities, and no diagrams of measured times.
    #[arg(long)]
    pub quick: bool,
}
