//! The flags of `gallery`.

use std::path::PathBuf;

use clap::Args;

/// The end of `gallery --help`.
pub const EXAMPLES: &str = "Writes index.html, which needs no other file, each picture as NAME.svg, and manifest.json with the command, the \
outcome and the time of each picture. Two runs write the same bytes, except for manifest.json and diagrams of \
measured times. Exit status: 0 every picture was made, 1 some picture was not.

More examples:
  dalembert gallery pictures
  dalembert gallery pictures rolling_disk chaplygin_sleigh --quick
  dalembert gallery pictures --animations
  dalembert gallery --list
  dalembert gallery . --picture rolling_disk-motion-path";

/// `gallery`
#[derive(Debug, Args)]
pub struct GalleryArgs {
    /// Output folder. It is created if it does not exist.
    #[arg(value_name = "OUT", required_unless_present = "list")]
    pub out: Option<PathBuf>,
    /// Draw only figures of these models.
    #[arg(value_name = "MODEL")]
    pub models: Vec<String>,
    /// Draw only this picture, without a page. May be repeated.
    #[arg(long, value_name = "NAME", conflicts_with = "models")]
    pub picture: Vec<String>,
    /// Print the names and titles of the pictures without drawing them.
    #[arg(long)]
    pub list: bool,
    /// For each picture of `simulate`, write a page NAME.html that plays its run. The page of the gallery lists these
    /// pages.
    #[arg(long)]
    pub animations: bool,
    /// Draw densities from shorter runs, and leave out diagrams of measured times.
    #[arg(long)]
    pub quick: bool,
}
