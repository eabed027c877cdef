//! Accumulations in which the energy grows: the limit of their times, and what model it is extrapolated by.
//!
//! Flights `f_n` between impacts on one surface shrink geometrically, `f_n ~ r^n`, as between walls that add a share of
//! the speed, or algebraically, `f_n ~ c/(n + a)^2`, as between walls that close in. The model is the one that tells
//! a flight in between better from the first and the last; what is left of the flights is `f r/(1 - r)`, or
//! `sqrt(c f)` with `1/sqrt(c)` the mean growth of `1/sqrt(f_n)`.

use crate::math;
use crate::state::StateVector;

/// Flights shorter than this many units in the last place of the time are too short to tell the next ones: where they hardly
/// shrink from one to the next, and where they do.
const RESOLVED: [f64; 2] = [4096.0 * f64::EPSILON, 8.0 * f64::EPSILON];

/// Part of the flight before that the next is less than where flights are said to shrink from one to the next.
const QUICK: f64 = 0.875;

/// Rounding of a flight, in parts of the time.
const ROUNDED: f64 = 4.0 * f64::EPSILON;

/// Part of the first flight that the last must be less than.
const SHRUNK: f64 = 1.0 / 1024.0;

/// Flights that must have shrunk in a row before the first is kept.
const FIRST: f64 = 3.0;

/// Part of the energy that it must have grown by.
const GROWN: f64 = 1.0 / (1 << 20) as f64;

/// Per surface, flights that shrink in a row: how many, three of them, and the energy at the first.
#[derive(Debug, Clone, Copy)]
pub(super) struct Growth<V> {
    counts: V,
    firsts: V,
    /// The last flight whose number is a power of two, and the one before.
    marks: [V; 2],
    energies: V,
}

/// A flight of a series.
#[derive(Debug, Clone, Copy)]
struct Flight {
    number: f64,
    length: f64,
}

impl<V: StateVector> Growth<V> {
    pub(super) fn none(like: &V) -> Self {
        let zeros = like.zeroed();
        Self {
            counts: zeros,
            firsts: zeros,
            marks: [zeros; 2],
            energies: zeros,
        }
    }

    /// No flight has ended on this surface.
    pub(super) fn forget(&mut self, surface: usize) {
        self.counts.as_mut_slice()[surface] = 0.0;
    }

    /// Takes in a flight that ends at `t`, and the one before. Returns the time of accumulation, if flights have become
    /// too short to be told while the energy grew. `energy` is that of the motion, or what takes its place.
    pub(super) fn add(
        &mut self,
        surface: usize,
        t: f64,
        [before, flight]: [f64; 2],
        energy: impl FnOnce() -> f64,
    ) -> Option<f64> {
        let count = &mut self.counts.as_mut_slice()[surface];
        // Times are rounded: flights may seem to grow by that much.
        let shrinks = flight <= before + ROUNDED * t.abs();
        if !shrinks {
            *count = 0.0;
            return None;
        }
        *count += 1.0;
        let count = *count;
        if (count as u64).is_power_of_two() {
            let last = self.marks[0].as_slice()[surface];
            self.marks[1].as_mut_slice()[surface] = last;
            self.marks[0].as_mut_slice()[surface] = flight;
        }
        if count == FIRST {
            self.firsts.as_mut_slice()[surface] = flight;
            self.energies.as_mut_slice()[surface] = energy();
            return None;
        }
        let first = self.firsts.as_slice()[surface];
        let resolved = RESOLVED[usize::from(flight < QUICK * before)] * t.abs();
        if count > FIRST && flight <= resolved && flight < SHRUNK * first {
            let grown = energy();
            let first = self.energies.as_slice()[surface];
            let is_growth = grown - first > GROWN * grown.abs().max(first.abs());
            return is_growth.then(|| t + self.rest(surface, before, flight));
        }
        None
    }

    /// The time that all further flights take.
    fn rest(&self, surface: usize, before: f64, flight: f64) -> f64 {
        let count = self.counts.as_slice()[surface];
        let first = Flight {
            number: FIRST,
            length: self.firsts.as_slice()[surface],
        };
        let last = Flight {
            number: count,
            length: flight,
        };
        // The mark that is nearer to the middle: the last power of two is within a half of the end.
        let power = power_of_two_to(count);
        let middle = Flight {
            number: 0.5 * power,
            length: self.marks[1].as_slice()[surface],
        };
        if middle.number > FIRST && algebraic_fits(first, middle, last) {
            let growth = (inverse_root(last.length) - inverse_root(first.length))
                / (last.number - first.number);
            return math::sqrt(flight) / growth;
        }
        let ratio = flight / before;
        flight * ratio / (1.0 - ratio)
    }
}

/// The largest power of two that is not larger.
fn power_of_two_to(count: f64) -> f64 {
    let mut power = 1.0;
    while 2.0 * power <= count {
        power *= 2.0;
    }
    power
}

fn inverse_root(x: f64) -> f64 {
    1.0 / math::sqrt(x)
}

/// Whether `1/sqrt(f)` is nearer to a line than `ln f` is.
fn algebraic_fits(first: Flight, middle: Flight, last: Flight) -> bool {
    let share = (middle.number - first.number) / (last.number - first.number);
    let between = |value: fn(f64) -> f64| {
        let (low, high) = (value(first.length), value(last.length));
        ((value(middle.length) - low) / (high - low) - share).abs()
    };
    between(inverse_root) < between(math::ln)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// When flights end that shrink as `length` says.
    fn end(length: impl Fn(u32) -> f64) -> Option<f64> {
        let mut growth = Growth::none(&nalgebra::SVector::<f64, 1>::zeros());
        let (mut t, mut before) = (0.0, f64::INFINITY);
        for n in 1..20_000_000 {
            let flight = length(n);
            t += flight;
            let found = growth.add(0, t, [before, flight], || f64::from(n));
            if found.is_some() {
                return found;
            }
            before = flight;
        }
        None
    }

    #[test]
    fn limits_of_geometric_flights_are_found() {
        let geometric = end(|n| 0.8_f64.powi(n.cast_signed())).expect("an end");
        assert!((geometric - 4.0).abs() < 1e-13, "{geometric}");
    }

    #[test]
    #[cfg_attr(
        miri,
        ignore = "so many flights take an hour where each operation is watched"
    )]
    fn limits_of_algebraic_flights_are_found() {
        let algebraic = end(|n| 1.0 / (f64::from(n) * f64::from(n + 1))).expect("an end");
        assert!((algebraic - 1.0).abs() < 1e-9, "{algebraic}");
    }

    #[test]
    fn flights_that_grow_again_do_not_accumulate() {
        let cusp = |n: u32| {
            let n = f64::from(n) - 1e3;
            1e-20 + n * n
        };
        let mut growth = Growth::none(&nalgebra::SVector::<f64, 1>::zeros());
        for n in 1..2000 {
            let flights = [cusp(n - 1), cusp(n)];
            assert_eq!(growth.add(0, 1e9, flights, || 1.0), None);
        }
    }
}
