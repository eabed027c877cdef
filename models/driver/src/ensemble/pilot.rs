//! Default ranges of a density, from short runs of a few members. They depend on the whole ensemble, not on the shard.

use super::density::{Axis, Density, count_samples};
use super::runner::{End, Runner, Shared};
use crate::grid::padded;
use crate::run::{Contact, Impact, Piece, Settings, Watch};

/// Number of members that are run.
const MEMBERS: u64 = 16;

/// Number of samples of each member.
const SAMPLES: f64 = 256.0;

/// Margin beyond the visited range, as a fraction of it.
const ROOM: f64 = 0.05;

/// The density over these axes, with all ranges set; `None` if the end time lies before the first counted state.
///
/// # Errors
/// An error of the model of the members.
pub fn density(
    mut axes: [Axis; 2],
    shared: Shared<'_>,
    [every, discard]: [f64; 2],
) -> Result<Option<Density>, String> {
    let until = shared.settings.until;
    let samples = count_samples(discard, every, until);
    if samples == 0 {
        return Ok(None);
    }
    if axes.iter().any(|axis| axis.range[0].is_nan()) {
        let settings = Settings {
            until: until.min(discard + SAMPLES * every),
            ..shared.settings.clone()
        };
        let shared = Shared {
            settings: &settings,
            end: End::Requested,
            ..shared
        };
        let ranges = visited(shared, &axes, discard)?;
        for (axis, range) in axes.iter_mut().zip(ranges) {
            if axis.range[0].is_nan() {
                axis.range = range;
            }
        }
    }
    Ok(Some(Density {
        axes,
        every,
        discard,
        samples,
    }))
}

/// The ranges of the axes' quantities, over members from the whole ensemble.
fn visited(shared: Shared<'_>, axes: &[Axis; 2], discard: f64) -> Result<[[f64; 2]; 2], String> {
    let mut seen = Seen {
        axes,
        discard,
        extremes: [Vec::new(), Vec::new()],
    };
    let mut runner = Runner::new(shared)?;
    let count = shared.members.count();
    let some = MEMBERS.min(count);
    for index in 0..some {
        let member = u128::from(index) * u128::from(count) / u128::from(some);
        // The outcome does not matter here: the member's row reports it.
        let _ = runner.watched(member as u64, &mut seen);
    }
    Ok(seen
        .extremes
        .map(|values| rounded(padded(values.into_iter(), ROOM))))
}

/// A slightly larger range whose ends have few digits.
fn rounded([low, high]: [f64; 2]) -> [f64; 2] {
    let decade = (high - low).log10().floor() as i32 - 1;
    // Quotients of integers round to the nearest decimals; products with 0.01 do not.
    let (digit, part) = (10f64.powi(decade.max(0)), 10f64.powi((-decade).max(0)));
    [
        (low / digit * part).floor() * digit / part,
        (high / digit * part).ceil() * digit / part,
    ]
}

/// Records the least and the greatest value of each axis over the ends of steps.
struct Seen<'a> {
    axes: &'a [Axis; 2],
    discard: f64,
    /// Empty, or both extremes of each axis.
    extremes: [Vec<f64>; 2],
}

impl Watch for Seen<'_> {
    fn step(&mut self, piece: &dyn Piece) {
        let (_, end) = piece.span();
        if end < self.discard {
            return;
        }
        let point = piece.at(end);
        for (axis, extremes) in self.axes.iter().zip(&mut self.extremes) {
            let value = axis.shown.value(&point);
            if value.is_finite() {
                let low = extremes.first().map_or(value, |low| low.min(value));
                let high = extremes.last().map_or(value, |high| high.max(value));
                *extremes = vec![low, high];
            }
        }
    }

    fn hears(&mut self, _impact: &Impact<()>) -> bool {
        false
    }

    fn impact(&mut self, _impact: Impact) {}

    fn contact(&mut self, _contact: Contact) {}
}

#[cfg(test)]
mod tests {
    use super::rounded;

    #[test]
    fn ranges_get_ends_of_few_digits() {
        assert_eq!(rounded([-0.15973, 0.16056]), [-0.16, 0.17]);
        assert_eq!(rounded([9.0, 1234.5]), [0.0, 1300.0]);
        assert_eq!(rounded([1.0, 2.0]), [1.0, 2.0]);
    }
}
