//! Verification of a run: its measured error, or the reason why the error cannot be measured.
//!
//! The run is repeated bit for bit, and the reference is run twice. All three are audited, and all must meet the same
//! surfaces in the same order: no error is reported if an impact may have been missed, even by all of them.

use super::{Model, Settings, audited, reference};
use crate::refusal::Refusal;
use crate::run::Ending;

/// Result of a verification.
#[derive(Debug, Clone, PartialEq)]
pub enum Verified {
    /// The error was measured.
    Measured {
        /// The largest relative error of a position or of the end time.
        error: f64,
        /// Accuracy of the reference.
        floor: f64,
    },
    /// The error could not be measured.
    Doubted {
        /// The reason, in words.
        reason: String,
        /// True if the reference meets the same surfaces and ends for the same reason.
        agrees: bool,
    },
}

/// Accuracy of a reference from which on nothing can be measured with it.
const LOST: f64 = 1e-2;

/// Repeats the run with this ending, and measures its error.
///
/// # Errors
/// [`Refusal`] if the run or the reference does not start.
pub(crate) fn verify<M: Model>(
    model: &M,
    state: &M::State,
    settings: &Settings,
    ending: &Ending,
) -> Result<Verified, Refusal> {
    let until = match settings.impacts {
        // The end time of the settings lies far beyond the last requested impact. Positions are compared up to a time
        // slightly after that impact, because it may come later in other runs.
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
    let lost = || {
        format!(
            "rounding grows along this motion, so that references differ by {:.1e}; verify a shorter run",
            reference.floor
        )
    };
    let reason = (!is_same)
        .then(|| "the run is not reproducible: the same settings give another end".to_owned())
        .or_else(|| track.doubt("the run"))
        .or_else(|| reference.doubt.clone())
        .or_else(|| track.difference_from(&reference.track, ["the run", "the reference"]))
        .or_else(|| (reference.floor > LOST).then(lost));
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
