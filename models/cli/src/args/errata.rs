//! The flags of `errata`.

use std::path::PathBuf;

use clap::Args;

/// The end of `errata --help`.
pub const EXAMPLES: &str = "A printed value is the formula as the source prints it, evaluated at the state of the command below it. The \
right value is derived from the Lagrangian, the constraints and the gaps of the model. The book explains the \
sources on the page Errata. Exit status: 0 every printed value differs from the right one, 1 some value could \
not be computed or agrees.

More examples:
  dalembert errata --json -";

/// `errata`
#[derive(Debug, Args)]
pub struct ErrataArgs {
    /// Write the errata as one JSON document. `-` is the standard output.
    #[arg(long, value_name = "FILE")]
    pub json: Option<PathBuf>,
}
