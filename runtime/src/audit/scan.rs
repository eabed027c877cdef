//! Scan of one gap along a step: bisection into pieces on which an enclosure decides its sign.

use super::motion::Motion;
use crate::contract::Impacting;
use crate::numbers::{Bent, Interval, Rated, TaylorModel};

/// Maximum number of halvings of a step; shorter pieces are not divided.
const DEPTH: u32 = 44;

/// Maximum number of pieces of a step.
const PIECES: u32 = 1 << 14;

/// Relative rounding error assumed for the arguments of conditions.
const ROUNDING: f64 = 32.0 * f64::EPSILON;

/// Fractions of a piece at which conditions without an enclosure are sampled.
const SAMPLES: [f64; 3] = [0.25, 0.5, 0.75];

/// One gap along a step.
pub(super) struct Scan<'a, Sys: Impacting> {
    pub(super) system: &'a Sys,
    pub(super) motion: &'a Motion<Sys::State>,
    pub(super) surface: usize,
    /// True if the gap may be negative: then only crossings from positive to negative count.
    pub(super) is_passable: bool,
    /// Largest negative gap that the rounding errors of the earlier motion can cause.
    pub(super) slack: f64,
}

/// The sign of a gap on a piece, outside of the band of its rounding error.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Sign {
    Positive,
    NotNegative,
    Negative,
    Unclear,
}

/// Allowance for the rounding error of a gap: twice the width of its enclosure at one state. This width is the effect
/// of the rounding of the state.
pub(super) fn floor(gap: Interval) -> f64 {
    2.0 * gap.width()
}

/// Values and rates as a [`Bent`], without bounds of second derivatives.
pub(super) fn bent(Rated { value, rate }: Rated) -> Bent {
    Bent {
        value,
        rate,
        ..Bent::ANYTHING
    }
}

impl<Sys: Impacting> Scan<'_, Sys> {
    /// Enclosure of the gap and of its rate on a piece.
    pub(super) fn along(&self, piece: [f64; 2]) -> Rated {
        let component = |i: usize| bent(self.motion.component(i, piece));
        let time = bent(self.motion.time(piece));
        let Bent { value, rate, .. } = self.system.gap_about(self.surface, time, &component);
        Rated { value, rate }
    }

    /// The gap at a fraction of the step.
    pub(super) fn at(&self, part: f64) -> Interval {
        self.along([part, part]).value
    }

    /// Proves that the gap does not fall through 0 between the start of the step and the fraction `part` of it.
    ///
    /// # Errors
    /// The smallest fraction at which the gap may fall.
    pub(super) fn exclude_falls(&self, part: f64) -> Result<(), f64> {
        let start = self.at(0.0);
        let mut is_above = start.lo > self.slack.max(floor(start));
        let (mut index, mut depth) = (0_u64, 0);
        for _ in 0..PIECES {
            let piece = piece(part, index, depth);
            let sign = self.sign(piece);
            let may_be_negative = matches!(sign, Sign::Negative | Sign::Unclear);
            let matters = is_above || !self.is_passable;
            let counts = match may_be_negative && matters {
                true => self.counts_on(piece),
                false => Some(false),
            };
            let is_unclear = counts.is_none() || (sign == Sign::Unclear && counts == Some(true));
            if is_unclear && depth < DEPTH {
                (index, depth) = (2 * index, depth + 1);
                continue;
            }
            if counts != Some(false) {
                return Err(piece[0]);
            }
            is_above = match sign {
                Sign::Positive => true,
                Sign::Negative => false,
                Sign::NotNegative | Sign::Unclear => is_above,
            };
            index += 1;
            while index % 2 == 0 && depth > 0 {
                (index, depth) = (index / 2, depth - 1);
            }
            if depth == 0 {
                return Ok(());
            }
        }
        Err(piece(part, index, depth)[0])
    }

    /// The sign on a piece, from the enclosure on the piece and from those at both ends, extended by the enclosure of
    /// the rate.
    fn sign(&self, [from, to]: [f64; 2]) -> Sign {
        let Rated { value, rate } = self.along([from, to]);
        // For an impassable surface a positive gap suffices, however small it is.
        if value.lo > 0.0 && !self.is_passable {
            return Sign::NotNegative;
        }
        let ends = [from, to].map(|part| self.at(part));
        let width = Interval::new(0.0, (to - from) * (1.0 + f64::EPSILON));
        let (forwards, backwards) = (ends[0] + rate * width, ends[1] - rate * width);
        let lowest = value.lo.max(forwards.lo).max(backwards.lo);
        let highest = value.hi.min(forwards.hi).min(backwards.hi);
        let rounding = self.slack.max(floor(ends[0])).max(floor(ends[1]));
        match rounding.is_finite() {
            true if lowest > rounding => Sign::Positive,
            true if lowest >= -rounding => Sign::NotNegative,
            true if highest < -rounding => Sign::Negative,
            _ => Sign::Unclear,
        }
    }

    /// True if the surface counts somewhere on a piece in spite of rounding errors; `None` if that is not certain.
    /// Conditions without an enclosure are sampled.
    fn counts_on(&self, piece: [f64; 2]) -> Option<bool> {
        if !self.system.has_conditions(self.surface) {
            return Some(self.counts_at_samples(piece));
        }
        let along = |i: usize| TaylorModel::steady(self.motion.component(i, piece).value);
        let time = TaylorModel::steady(self.motion.time(piece).value);
        let about = |value: Interval| {
            let reach = ROUNDING * value.magnitude();
            TaylorModel::steady(Interval::point(value.middle()).widened(reach))
        };
        let rounded = |i: usize| about(self.motion.component(i, piece).value);
        let moment = about(self.motion.time(piece).value);
        self.system
            .counts_along(self.surface, (time, &along), (moment, &rounded))
    }

    fn counts_at_samples(&self, [from, to]: [f64; 2]) -> bool {
        SAMPLES.into_iter().any(|sample| {
            let part = from + sample * (to - from);
            let (t, state) = (self.motion.time_at(part), self.motion.state(part));
            self.system.surface_active(self.surface, t, &state)
        })
    }
}

/// The ends of a piece.
fn piece(part: f64, index: u64, depth: u32) -> [f64; 2] {
    let count = (1_u64 << depth) as f64;
    [index, index + 1].map(|end| match end as f64 == count {
        true => part,
        false => part * (end as f64 / count),
    })
}
