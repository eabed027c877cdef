//! The verdict on a run: its measured error, or why nothing is known of it.
//!
//! The run is made again, bit by bit the same, and the reference twice. All of them are audited, and all have to meet the same
//! surfaces in the same order: no error is given where an impact may have been missed, be it by all of them.

use super::{Model, Settings, audited, reference};
use crate::refusal::Refusal;
use crate::run::Ending;

/// The verdict on a run.
#[derive(Debug, Clone, PartialEq)]
pub enum Verified {
    /// The error was measured.
    Measured {
        /// The largest error of a position, as a share.
        error: f64,
        /// How far the reference is known.
        floor: f64,
    },
    /// Nothing.
    Doubted {
        /// Why, in words.
        reason: String,
        /// True if the reference meets the same surfaces and ends alike.
        agrees: bool,
    },
}

/// Makes a run again that ended so, and measures its error.
///
/// # Errors
/// Why the run does not begin.
pub(crate) fn verify<M: Model>(
    model: &M,
    state: &M::State,
    settings: &Settings,
    ending: &Ending,
) -> Result<Verified, Refusal> {
    let until = match settings.impacts {
        // The horizon is far beyond the last impact that was asked for; positions are compared on the way to it, and
        // a little later, where other runs may have it.
        Some(_) => ending.t * 1.01,
        None => settings.until,
    };
    let base = Settings {
        until,
        ..settings.clone()
    };
    let reference = reference(model, state, &base)?;
    let track = audited(model, state, settings, until)?;
    let is_same = track.is_run_of(ending);
    let reason = (!is_same)
        .then(|| "the same run, made again, ends otherwise".to_owned())
        .or_else(|| track.doubt())
        .or_else(|| reference.doubt.clone())
        .or_else(|| track.difference_from(&reference.track, ["the run", "the reference"]));
    Ok(match reason {
        None => Verified::Measured {
            error: track.distance(&reference.track),
            floor: reference.floor,
        },
        Some(reason) => Verified::Doubted {
            reason,
            agrees: track.ends_as(&reference.track),
        },
    })
}
