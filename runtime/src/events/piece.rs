//! Signs of a gap on a piece of a stretch, from its Taylor model on the stretch.
//!
//! On a piece the cubic has four Bernstein coefficients, which bound it (convex hull); their differences bound its
//! rate. The slope of the remainder bounds the change of the remainder along the piece.

use super::crossing::Signs;
use crate::numbers::{Interval, TaylorModel};

/// Bound for the rounding error of a coefficient, relative to the sum of the absolute values of all terms.
const ROUNDING: f64 = 16.0 * f64::EPSILON;

/// The gap on a piece.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Piece {
    /// Bernstein coefficients of the cubic.
    hull: [f64; 4],
    /// Bound of the remainder.
    error: f64,
    /// Bound of the change of the remainder between the ends.
    drift: f64,
    /// Values lie in it, also where the remainder allows others.
    known: Interval,
}

impl Piece {
    /// The gap on `[from, to]`, with its model on `[first, last]`.
    #[inline]
    pub(crate) fn of(model: &TaylorModel, [first, last]: [f64; 2], [from, to]: [f64; 2]) -> Self {
        let scale = 2.0 / (last - first);
        let [u, v] = match from == first && to == last {
            true => [-1.0, 1.0],
            false => [(from - first) * scale - 1.0, 1.0 - (last - to) * scale],
        };
        let [a, b, c, d] = model.powers;
        let value = |s: f64| a + s * (b + s * (c + s * d));
        let way = (v - u) / 3.0;
        let rise = |s: f64| way * (b + s * (2.0 * c + s * 3.0 * d));
        let (start, end) = (value(u), value(v));
        let size = a.abs() + b.abs() + c.abs() + d.abs();
        let rounding = ROUNDING * size;
        Self {
            hull: [start, start + rise(u), end - rise(v), end],
            error: model.error + rounding,
            drift: (v - u) * model.slope + 2.0 * rounding,
            // A model with an unbounded error may stand for a function without values.
            known: match model.error < f64::INFINITY && !model.bounds.is_whole() {
                true => model.bounds.widened(rounding),
                false => Interval::WHOLE,
            },
        }
    }

    /// The piece with the remainder set to zero.
    pub(crate) fn without_remainder(self) -> Self {
        Self {
            error: 0.0,
            drift: 0.0,
            known: Interval::WHOLE,
            ..self
        }
    }

    /// True if the gap is finite and its remainder is below this size.
    pub(crate) fn is_sharper_than(&self, size: f64) -> bool {
        let sum = self.hull.iter().fold(0.0, |sum, value| sum + value);
        sum.is_finite() && self.error < size
    }

    /// Values of the cubic at both ends.
    pub(crate) fn ends(&self) -> [f64; 2] {
        [self.hull[0], self.hull[3]]
    }

    /// Lower and upper bound of the values.
    pub(crate) fn bounds(&self) -> [f64; 2] {
        self.reach(self.hull, self.error)
    }

    fn reach(&self, values: [f64; 4], error: f64) -> [f64; 2] {
        let lowest = values.into_iter().fold(f64::INFINITY, f64::min);
        let highest = values.into_iter().fold(f64::NEG_INFINITY, f64::max);
        let (lowest, highest) = (lowest - error, highest + error);
        match (lowest.max(self.known.lo), highest.min(self.known.hi)) {
            // Written so that NaN fails the comparison.
            (lowest, highest) if lowest <= highest => [lowest, highest],
            _ => [f64::NEG_INFINITY, f64::INFINITY],
        }
    }

    /// Lower and upper bound of the values of a gap that is `first` at the start.
    pub(crate) fn bounds_from(&self, first: f64) -> [f64; 2] {
        let ahead = self.reach(
            self.hull.map(|value| first + (value - self.hull[0])),
            self.drift,
        );
        let within = self.bounds();
        [ahead[0].max(within[0]), ahead[1].min(within[1])]
    }

    /// Signs of the gap from its enclosure, without values at the ends. `Unclear` if the enclosure contains 0 at an
    /// end.
    #[inline]
    pub(crate) fn signs(&self) -> Signs {
        let (hull, error) = (&self.hull, self.error);
        if self.known.lo > 0.0 || hull.iter().all(|&value| value > error) {
            return Signs::Positive;
        }
        if self.known.hi < 0.0 || hull.iter().all(|&value| value < -error) {
            return Signs::Negative;
        }
        let falls = hull[0] > error && hull[3] < -error && self.is_falling();
        let rises = hull[0] < -error && hull[3] > error && self.is_rising();
        match (falls, rises) {
            (true, _) => Signs::Falls,
            (_, true) => Signs::Rises,
            _ => Signs::Unclear,
        }
    }

    #[inline(always)]
    fn is_falling(&self) -> bool {
        self.hull
            .windows(2)
            .all(|pair| 3.0 * (pair[1] - pair[0]) < -self.drift)
    }

    #[inline(always)]
    fn is_rising(&self) -> bool {
        self.hull
            .windows(2)
            .all(|pair| 3.0 * (pair[1] - pair[0]) > self.drift)
    }

    /// Signs of a gap after its zero at the start.
    ///
    /// Division by this zero leaves a quadratic, whose coefficients must exceed the slope of the remainder.
    #[inline]
    pub(crate) fn signs_from_zero(&self) -> Signs {
        let [start, a, b, c] = self.hull;
        let quadratic = [3.0 * (a - start), 1.5 * (b - start), c - start];
        match (
            quadratic.iter().all(|&value| value > self.drift),
            quadratic.iter().all(|&value| value < -self.drift),
        ) {
            (true, _) => Signs::Positive,
            (_, true) => Signs::Negative,
            _ => Signs::Unclear,
        }
    }

    /// Signs of a gap with these values at its ends.
    #[inline]
    pub(crate) fn signs_between(&self, [first, last]: [f64; 2]) -> Signs {
        if first >= 0.0 && last >= 0.0 && first + last > 0.0 {
            return match self.is_monotone() || self.stays_above(first, last) {
                true => Signs::Positive,
                false => Signs::Unclear,
            };
        }
        if first < 0.0 && last < 0.0 {
            return match self.is_monotone() || self.mirrored().stays_above(-first, -last) {
                true => Signs::Negative,
                false => Signs::Unclear,
            };
        }
        match first >= 0.0 {
            true if self.is_falling() => Signs::Falls,
            false if self.is_rising() => Signs::Rises,
            _ => Signs::Unclear,
        }
    }

    fn is_monotone(&self) -> bool {
        self.is_falling() || self.is_rising()
    }

    fn mirrored(self) -> Self {
        Self {
            hull: self.hull.map(|value| -value),
            known: -self.known,
            ..self
        }
    }

    /// True if a gap with these nonnegative values at its ends is positive inside, by the bound of its change from one
    /// of the ends.
    fn stays_above(&self, first: f64, last: f64) -> bool {
        const THIRDS: [f64; 3] = [1.0 / 3.0, 2.0 / 3.0, 1.0];
        let [start, a, b, end] = self.hull;
        let is_held = |value: f64, changes: [f64; 3]| {
            let mut changes = changes.into_iter().zip(THIRDS);
            changes.all(|(change, part)| value + change > part * self.drift)
        };
        is_held(first, [a - start, b - start, end - start])
            || is_held(last, [b - end, a - end, start - end])
    }

    /// Estimate of the fall of a gap after its zero at the start, as a fraction of the piece: the zero of the
    /// quadratic that remains after division by that zero.
    pub(crate) fn fall_from_zero(&self) -> Option<f64> {
        let [start, a, b, c] = self.hull;
        let [first, middle, last] = [3.0 * (a - start), 1.5 * (b - start), c - start];
        // `first + 2 (middle - first) x + bend x^2`
        let (half, bend) = (middle - first, first - 2.0 * middle + last);
        let root = crate::math::sqrt((half * half - bend * first).max(0.0));
        // This form of the quotient avoids cancellation.
        let part = match half <= 0.0 {
            true => first / (root - half),
            false => -(half + root) / bend,
        };
        (part > 0.0 && part < 1.0).then_some(part)
    }

    /// Estimate of the fall of a gap that is positive at the start and negative at the end.
    pub(crate) fn first_fall(&self) -> Option<f64> {
        (self.hull[0] > 0.0 && self.hull[3] < 0.0).then(|| self.fall())
    }

    /// Estimate of the zero of a cubic that falls once, as a fraction of the piece.
    pub(crate) fn fall(&self) -> f64 {
        let [start, a, b, end] = self.hull;
        let value = |x: f64| {
            let y = 1.0 - x;
            y * y * (y * start + 3.0 * x * a) + x * x * (3.0 * y * b + x * end)
        };
        let (mut before, mut after) = ([0.0, start], [1.0, end]);
        // Two steps to the zero of the parabola through the ends and the middle. They are accurate enough for a cubic
        // with small curvature.
        for _ in 0..2 {
            let middle = 0.5 * (before[0] + after[0]);
            let (low, mid, high) = (before[1], value(middle), after[1]);
            let (slope, bend) = (high - low, high - 2.0 * mid + low);
            let root = crate::math::sqrt((slope * slope - 8.0 * bend * mid).max(0.0));
            let part = -4.0 * mid / (slope - root);
            let x = middle + 0.5 * part * (after[0] - before[0]);
            if !(x > before[0] && x < after[0]) {
                return middle;
            }
            let found = value(x);
            match found >= 0.0 {
                true => before = [x, found],
                false => after = [x, found],
            }
            if found.abs() <= self.error {
                return x;
            }
        }
        match before[1] - after[1] > 0.0 {
            true => before[0] + before[1] / (before[1] - after[1]) * (after[0] - before[0]),
            false => 0.5 * (before[0] + after[0]),
        }
    }
}
