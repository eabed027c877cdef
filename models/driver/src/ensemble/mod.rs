//! Ensembles: many members of one scene, each with its own start or parameters.
//!
//! | file | job |
//! |---|---|
//! | `values`, `random`, `members` | the start of each member, as a function of its index |
//! | `runner` | runs members and makes their rows, also after a refusal or a panic |
//! | `row` | the columns of the rows, and rows as lines of CSV |
//! | `parquet` | rows as Parquet, if the feature is on |
//! | `density` | states of all members, counted in cells |
//! | `pilot` | ranges of a density without given ranges |
//! | `tally`, `exact` | sums over all members |
//!
//! A row depends on its member alone. Sums are integers, exact, or formed in the order of members. Therefore no result
//! depends on the division of members among threads, shards or machines.

pub mod density;
pub mod exact;
mod members;
#[cfg(feature = "parquet")]
pub mod parquet;
pub mod pilot;
pub(crate) mod random;
pub mod row;
pub mod runner;
mod tally;
mod values;

pub use members::{Members, Source};
pub use tally::Tally;
pub use values::{Draw, Quantity, Values};

use crate::run::Settings;

/// True if an outcome is the requested end.
pub fn is_reached(outcome: &str, settings: &Settings) -> bool {
    outcome == "done" || (outcome == "impact_budget" && settings.impacts.is_some())
}
