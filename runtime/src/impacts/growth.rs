//! Accumulations of impacts in which the energy grows, and the extrapolation of their time.
//!
//! Flights `f_n` between impacts on one surface shrink geometrically, `f_n ~ r^n`, for example between walls that add a
//! fraction of the speed, or algebraically, `f_n ~ c/(n + a)^2`, for example between walls that approach each other.
//! The law used is the one that better predicts an intermediate flight from the first and the last. After the last
//! flight `f`, the remaining flights take `f r/(1 - r)` in total if they are geometric, and `sqrt(c f)` if they are
//! algebraic, where `1/sqrt(c)` is the mean growth of `1/sqrt(f_n)` per flight.

use crate::math;
use crate::per_surface::PerSurface;
use crate::state::StateVector;

/// Length of a flight, relative to the time, below which it does not determine the next ones. The first value is for
/// flights that shrink slowly, the second for flights that shrink fast.
const RESOLVED: [f64; 2] = [4096.0 * f64::EPSILON, 8.0 * f64::EPSILON];

/// Ratio of successive flights below which they count as shrinking fast.
const QUICK: f64 = 0.875;

/// Rounding of a flight, relative to the time.
const ROUNDED: f64 = 4.0 * f64::EPSILON;

/// Ratio of the last flight to the first below which flights count as accumulating.
const SHRUNK: f64 = 1.0 / 1024.0;

/// Number of flights that must have shrunk in a row before the first is kept.
const FIRST: u64 = 3;

/// Ratio of the last gap rate to the first below which a motion comes to rest on the surface, whatever energy it gains
/// along it. The rates of hops shrink as their flights do.
const SLOWED: f64 = 1.0 / 32.0;

/// Least relative growth of the energy.
const GROWN: f64 = 1.0 / (1 << 20) as f64;

/// Growth of the energy over the later half of the flights from which on it has no limit, also where gap rates shrink.
const MANIFOLD: f64 = 16.0;

/// Per surface, flights that shrink in a row.
#[derive(Debug, Clone, Copy)]
pub(super) struct Growth<G: StateVector>(PerSurface<Series, G>);

/// Successive shrinking flights on one surface.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Series {
    /// Number of the last flight.
    count: u64,
    /// The flight of number [`FIRST`], and the gap rate after it.
    first: Option<(Flight, f64)>,
    /// The last three flights whose numbers are powers of two, the latest first.
    marks: [Option<Flight>; 3],
}

/// A flight of a series.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Flight {
    number: u64,
    length: f64,
    /// The energy after it, if there is one. Known for the first flight and the marks.
    energy: Option<f64>,
}

impl<G: StateVector> Growth<G> {
    /// Data before the first flight, for as many surfaces as `like` has components.
    pub(super) fn none(like: &G) -> Self {
        Self(PerSurface::all(like, Series::ENDLESS))
    }

    /// Discards the flights on this surface.
    pub(super) fn forget(&mut self, surface: usize) {
        self.0[surface] = Series::ENDLESS;
    }

    /// Records a flight that ends at `t`, after a flight of length `before` on the same surface. `rate` is the gap rate
    /// after the impact, `energy` the energy of the motion or a substitute. Returns the time of accumulation if flights
    /// have become too short to be resolved while the energy grew.
    pub(super) fn add(
        &mut self,
        surface: usize,
        t: f64,
        (before, length): (Option<f64>, f64),
        rate: f64,
        energy: impl Fn() -> Option<f64>,
    ) -> Option<f64> {
        self.0[surface].add(t, (before, length), rate, energy)
    }

    /// True if the energy has grown many times over the later half of the flights on this surface.
    pub(super) fn has_no_limit(&self, surface: usize, energy: impl Fn() -> Option<f64>) -> bool {
        let series = &self.0[surface];
        let are_enough = series.count > 2 * FIRST;
        are_enough
            && series
                .earlier()
                .is_some_and(|earlier| multiplies(earlier.energy, energy()))
    }
}

impl Series {
    /// Series without flights.
    const NONE: Self = Self {
        count: 0,
        first: None,
        marks: [None; 3],
    };

    /// Series in which the time before the first impact counts as a flight longer than all others.
    const ENDLESS: Self = Self {
        count: 1,
        ..Self::NONE
    };

    /// Records a flight on this surface; see [`Growth::add`].
    fn add(
        &mut self,
        t: f64,
        (before, length): (Option<f64>, f64),
        rate: f64,
        energy: impl Fn() -> Option<f64>,
    ) -> Option<f64> {
        // Times are rounded, so that flights may seem to grow.
        let shrinks = before.is_none_or(|before| length <= before + ROUNDED * t.abs());
        if !shrinks {
            *self = Self::NONE;
            return None;
        }
        let last = self.count(length, &energy);
        if last.number == FIRST {
            if length <= ROUNDED * t.abs() / SHRUNK {
                // Rounding of times decides which flights seem to shrink.
                *self = Self::NONE;
                return None;
            }
            let energy = energy();
            self.first = Some((Flight { energy, ..last }, rate));
            return None;
        }
        let ((first, first_rate), before) = self.first.zip(before)?;
        let resolved = RESOLVED[usize::from(length < QUICK * before)] * t.abs();
        if length <= resolved && length < SHRUNK * first.length && rate > SLOWED * first_rate {
            let energy = energy();
            let grows_on = self.grows_on(Flight { energy, ..last });
            return grows_on.then(|| t + self.rest(first, before, last));
        }
        None
    }

    /// Counts a flight that shrank.
    fn count(&mut self, length: f64, energy: impl Fn() -> Option<f64>) -> Flight {
        self.count += 1;
        let mut last = Flight {
            number: self.count,
            length,
            energy: None,
        };
        if last.number.is_power_of_two() {
            last.energy = energy();
            self.marks = [Some(last), self.marks[0], self.marks[1]];
        }
        last
    }

    /// A flight of the earlier half, with its energy.
    fn earlier(&self) -> Option<Flight> {
        let first = self.first.map(|(first, _)| first);
        self.marks[1].filter(|mark| mark.number > FIRST).or(first)
    }

    /// True if the energy has grown, lately at least as much per flight as before. Otherwise it tends to a limit.
    fn grows_on(&self, last: Flight) -> bool {
        let first = self.first.map(|(first, _)| first);
        let marks = self.marks.iter().flatten();
        let mut earlier = marks
            .filter(|mark| mark.number > FIRST && mark.number < last.number)
            .copied()
            .chain(first);
        let Some(middle) = earlier.next() else {
            return false;
        };
        let first = earlier.next().unwrap_or(middle);
        let slopes = [(first, middle), (middle, last)].map(|(from, to)| to.energy_since(from));
        has_grown(first.energy, last.energy)
            && match slopes {
                [Some(before), Some(lately)] => lately >= before,
                [None, Some(lately)] => lately > 0.0,
                _ => false,
            }
    }

    /// Total time of all further flights.
    fn rest(&self, first: Flight, before: f64, last: Flight) -> f64 {
        // The second mark is nearer to the middle, because the last power of two exceeds half of the count.
        if let Some(middle) = self.marks[1]
            && middle.number > FIRST
            && algebraic_fits(first, middle, last)
        {
            let growth = (inverse_root(last.length) - inverse_root(first.length))
                / last.flights_since(first);
            return math::sqrt(last.length) / growth;
        }
        let ratio = last.length / before;
        last.length * ratio / (1.0 - ratio)
    }
}

impl Flight {
    /// Number of flights from an earlier one to this.
    fn flights_since(self, earlier: Self) -> f64 {
        (self.number - earlier.number) as f64
    }

    /// Growth of the energy per flight since an earlier one; `None` for the same flight or without energies.
    fn energy_since(self, earlier: Self) -> Option<f64> {
        let (before, after) = earlier.energy.zip(self.energy)?;
        (self.number > earlier.number).then(|| (after - before) / self.flights_since(earlier))
    }
}

/// True if the energy has grown; false if it is unknown.
fn has_grown(first: Option<f64>, last: Option<f64>) -> bool {
    first
        .zip(last)
        .is_some_and(|(first, last)| last - first > GROWN * last.abs().max(first.abs()))
}

/// True if the magnitude of the energy has grown many times; false if it is unknown.
fn multiplies(first: Option<f64>, last: Option<f64>) -> bool {
    first
        .zip(last)
        .is_some_and(|(first, last)| last > MANIFOLD * first.abs())
}

fn inverse_root(x: f64) -> f64 {
    1.0 / math::sqrt(x)
}

/// True if `1/sqrt(f)` is closer to a linear function than `ln f` is.
fn algebraic_fits(first: Flight, middle: Flight, last: Flight) -> bool {
    let share = middle.flights_since(first) / last.flights_since(first);
    let between = |value: fn(f64) -> f64| {
        let (low, high) = (value(first.length), value(last.length));
        ((value(middle.length) - low) / (high - low) - share).abs()
    };
    between(inverse_root) < between(math::ln)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Extrapolated time of accumulation of flights of lengths `length(n)`.
    fn end(length: impl Fn(u32) -> f64) -> Option<f64> {
        let mut growth = Growth::none(&nalgebra::SVector::<f64, 1>::zeros());
        let (mut t, mut before) = (0.0, None);
        for n in 1..20_000_000 {
            let flight = length(n);
            t += flight;
            let energy = || Some(f64::from(n) * f64::from(n));
            let found = growth.add(0, t, (before, flight), 1.0, energy);
            if found.is_some() {
                return found;
            }
            before = Some(flight);
        }
        None
    }

    #[test]
    fn limits_of_geometric_flights_are_found() {
        let geometric = end(|n| 0.8_f64.powi(n.cast_signed())).expect("an end");
        assert!((geometric - 4.0).abs() < 1e-13, "{geometric}");
    }

    #[test]
    #[cfg_attr(miri, ignore = "so many flights take an hour under miri")]
    fn limits_of_algebraic_flights_are_found() {
        let algebraic = end(|n| 1.0 / (f64::from(n) * f64::from(n + 1))).expect("an end");
        assert!((algebraic - 1.0).abs() < 1e-9, "{algebraic}");
    }

    #[test]
    fn an_energy_with_a_limit_does_not_grow_on() {
        for kept in [0.3, 0.9, 0.99] {
            let mut growth = Growth::none(&nalgebra::SVector::<f64, 1>::zeros());
            let (mut t, mut before) = (0.0, None);
            for n in 1..400 {
                let flight = 0.9_f64.powi(n);
                t += flight;
                let energy = || Some(2.0 - f64::powi(kept, n));
                assert_eq!(growth.add(0, t, (before, flight), 1.0, energy), None);
                before = Some(flight);
            }
        }
    }

    #[test]
    fn flights_that_grow_again_do_not_accumulate() {
        let cusp = |n: u32| {
            let n = f64::from(n) - 1e3;
            1e-20 + n * n
        };
        let mut growth = Growth::none(&nalgebra::SVector::<f64, 1>::zeros());
        for n in 1..2000 {
            let flights = (Some(cusp(n - 1)), cusp(n));
            assert_eq!(growth.add(0, 1e9, flights, 1.0, || Some(1.0)), None);
        }
    }
}
