//! Places where the derivatives of the rates may jump. Enclosures of the derivatives in small boxes about the state show that
//! they do not. Where there are none, or where long formulas keep them wide, differences between states on both sides find jumps,
//! at many distances.

use dalembert::Instance;
use dalembert::contract::Variational;
use dalembert::math::larger;
use dalembert::numbers::{Interval, Rated};
use dalembert::state::StateVector;

use super::largest;
use super::sample::Plant;

/// Distances of the states between which a jump of the derivatives is looked for: these powers of [`DECADE`], as fractions of
/// the component, or of 1.
const DECADES: u32 = 13;
const DECADE: f64 = 0.1;

/// Value of a component that may be the rounding error of 0.
const ROUNDED: f64 = 1e-13;

/// Smallest jump, as a fraction of the largest derivative.
const JUMP: f64 = 1e-6;

/// Ratio of the jumps of a smooth function at distances with the ratio [`DECADE`].
const FALL: core::ops::Range<f64> = 1e-4..0.3;

/// Sizes of the boxes, as fractions of a component; of 1 if it is 0.
const BOXES: [f64; 7] = [1e-6, 1e-9, 1e-12, 4e-16, 1e-24, 1e-50, 1e-150];

/// Least size of a box about a component that is not 0, as a fraction of it.
const LEAST: f64 = 2.0 * f64::EPSILON;

/// Width of the enclosure of a derivative below which it does not jump: as a fraction of the derivative, and, for rounding errors,
/// of the largest derivative of the same rate, and of all rates.
const NARROW: f64 = 1e-9;
const NOISE: f64 = 1e-11;
const ROUNDING: f64 = 64.0 * f64::EPSILON;

/// Width, as a fraction of that in the first box, of an enclosure that narrows with the box; and the largest width, as a fraction
/// of the largest derivative of the same rate, at which this shows that the derivative does not jump. Long formulas widen
/// enclosures.
const FALLEN: f64 = 1e-2;
const WIDEST: f64 = 1e-5;

/// Components across whose values the derivatives of the rates jump, or are not shown to be continuous.
pub(super) fn kinks<S: Instance + Variational>(
    plant: &Plant<'_, S>,
    at: (&[f64], &[f64]),
) -> Vec<usize> {
    let enclosed = enclosed(plant, at);
    let is_known = |index: &usize| enclosed.get(*index).copied().flatten();
    let sampled = match (0..at.0.len()).all(|index| is_known(&index).is_some()) {
        true => Vec::new(),
        false => sampled(plant, at),
    };
    let is_kinked = |index: &usize| is_known(index).unwrap_or_else(|| sampled.contains(index));
    (0..at.0.len()).filter(is_kinked).collect()
}

/// For each component, true if the enclosure of some derivative stays wide as the box about the state shrinks, false if all become
/// narrow; `None` if they are not narrow enough to tell, or if there are none.
fn enclosed<S: Instance + Variational>(
    plant: &Plant<'_, S>,
    (state, inputs): (&[f64], &[f64]),
) -> Vec<Option<bool>> {
    let Some((system, whole)) = plant.with_inputs(state, inputs) else {
        return Vec::new();
    };
    // Derivatives of all rates with respect to a component, in a box of this size.
    let slopes = |index: usize, size: f64| {
        let component = |i: usize| {
            let value = whole.as_slice()[i];
            let radius = match value {
                0.0 => size,
                value => value.abs() * larger(size, LEAST),
            };
            Rated {
                value: Interval::point(value).widened(radius),
                rate: Interval::point(f64::from(u8::from(i == index))),
            }
        };
        let mut slopes = Vec::new();
        let mut note = |_: usize, rate: Rated| slopes.push(rate.rate);
        let time = Rated::steady(Interval::point(plant.t));
        let found = system.rates_along(time, &component, &mut note);
        found.is_ok().then_some(slopes)
    };
    let columns: Vec<Vec<Slope>> = (0..state.len())
        .map(|index| Slope::narrowest(BOXES.iter().map(|&size| slopes(index, size))))
        .collect();
    // Positions and velocities have different units.
    let n = system.coordinate_count();
    let largest_in = |index: usize, row: Option<usize>| {
        let others = columns.iter().enumerate();
        let alike = others.filter(|(other, _)| (*other < n) == (index < n));
        let entries = alike.flat_map(|(_, column)| column.iter().enumerate());
        let entries = entries.filter(|(at, _)| row.is_none_or(|row| row == *at));
        entries.fold(0.0, |most, (_, slope)| larger(most, slope.value))
    };
    let is_kinked = |(index, column): (usize, &Vec<Slope>)| {
        let rows = column.iter().enumerate();
        let jumps: Vec<Option<bool>> = rows
            .map(|(row, slope)| slope.jumps([Some(row), None].map(|row| largest_in(index, row))))
            .collect();
        match jumps.contains(&Some(true)) {
            true => Some(true),
            false if jumps.is_empty() || jumps.contains(&None) => None,
            false => Some(false),
        }
    };
    columns.iter().enumerate().map(is_kinked).collect()
}

/// The narrowest enclosure of a derivative among those in several boxes.
#[derive(Debug, Clone, Copy)]
struct Slope {
    /// Absolute value of its middle.
    value: f64,
    width: f64,
    /// Width in the first box.
    first: f64,
}

impl Slope {
    /// One per rate. Empty if there is no enclosure in any box.
    fn narrowest(boxes: impl Iterator<Item = Option<Vec<Interval>>>) -> Vec<Self> {
        let mut all: Vec<Self> = Vec::new();
        for found in boxes.flatten() {
            if all.is_empty() {
                all = found
                    .iter()
                    .map(|slope| Self {
                        value: slope.middle().abs(),
                        width: f64::INFINITY,
                        first: slope.width(),
                    })
                    .collect();
            }
            for (slope, found) in all.iter_mut().zip(&found) {
                if found.width() < slope.width {
                    (slope.value, slope.width) = (found.middle().abs(), found.width());
                }
            }
        }
        all
    }

    /// False if the derivative does not jump, true if its enclosure does not narrow with the box; `None` if it narrows but stays
    /// wide. `largest` is the largest derivative of the same rate with respect to a component of
    /// the same kind, and `of_all` that of all rates.
    fn jumps(&self, [largest, of_all]: [f64; 2]) -> Option<bool> {
        // NaN fails the comparisons.
        let noise = larger(NOISE * largest, ROUNDING * of_all);
        let is_narrow = self.width <= larger(NARROW * self.value, noise);
        let has_fallen = self.width <= FALLEN * self.first;
        match (is_narrow, has_fallen) {
            _ if !self.width.is_finite() => Some(true),
            (true, _) => Some(false),
            (_, true) if largest == 0.0 || self.width <= WIDEST * largest => Some(false),
            (_, true) => None,
            _ => Some(true),
        }
    }
}

/// Components across whose values the derivatives of the rates jump, from samples.
fn sampled<S: Instance + Variational>(
    plant: &Plant<'_, S>,
    (state, inputs): (&[f64], &[f64]),
) -> Vec<usize> {
    let is_kinked_at = |index: usize, size: f64| {
        let slopes = |shift: f64| {
            let mut beside = state.to_vec();
            beside[index] += shift;
            let sample = plant.at(&beside, inputs).ok()?;
            Some(sample.by_rates)
        };
        let jumps = |k: u32| {
            let distance = size * DECADE.powi(k as i32);
            let pair = [slopes(distance)?, slopes(-distance)?];
            Some(pair[0].iter().zip(&pair[1]).map(Jump::of_row).collect())
        };
        let jumps: Vec<Vec<Jump>> = (1..=DECADES)
            .map(|k| jumps(k).unwrap_or_default())
            .collect();
        let of_row = |row: usize| -> Vec<Jump> {
            let jumps = jumps.iter().map(|rows| rows.get(row).copied());
            jumps.map(Option::unwrap_or_default).collect()
        };
        let rows = jumps.iter().map(Vec::len).max().unwrap_or(0);
        (0..rows).any(|row| stays(&of_row(row)))
    };
    let is_kinked = |index: &usize| match state[*index].abs() {
        0.0 => is_kinked_at(*index, 1.0),
        // A search for an equilibrium ends beside a kink at 0, by a rounding error.
        value if value < ROUNDED => is_kinked_at(*index, 1.0) || is_kinked_at(*index, value),
        value => is_kinked_at(*index, value),
    };
    (0..state.len()).filter(is_kinked).collect()
}

/// A difference between derivatives on both sides.
#[derive(Debug, Clone, Copy)]
struct Jump {
    size: f64,
    /// The size relative to the largest derivative in the row, on both sides. Where a smooth row is 0, it stays, and the size falls.
    relative: f64,
}

impl Default for Jump {
    fn default() -> Self {
        Self {
            size: f64::NAN,
            relative: f64::NAN,
        }
    }
}

impl Jump {
    /// The largest difference between two rows.
    fn of_row((above, below): (&Vec<f64>, &Vec<f64>)) -> Self {
        let all = largest(above.iter().chain(below));
        let apart = above
            .iter()
            .zip(below)
            .map(|(above, below)| (above - below).abs());
        let size = apart.fold(0.0, larger);
        let relative = match all {
            0.0 => 0.0,
            all => size / all,
        };
        Self { size, relative }
    }

    fn is_visible(&self) -> bool {
        self.relative > JUMP
    }
}

/// True if a jump, at distances that fall by a factor of ten each, is the same for at least two of them in a row, and does
/// not fall with the distance afterwards. A smooth function that varies over a short distance has a jump that stays and then
/// falls; the jump at a kink stays until rounding hides it.
fn stays(jumps: &[Jump]) -> bool {
    let ratio = |pair: &[Jump]| pair[1].size / pair[0].size;
    let is_level = |pair: &[Jump]| pair[0].is_visible() && (0.5..=2.0).contains(&ratio(pair));
    let falls = |pair: &[Jump]| pair[0].is_visible() && FALL.contains(&ratio(pair));
    let Some(last) = jumps.windows(2).rposition(is_level) else {
        return false;
    };
    let after: Vec<bool> = jumps[last + 1..].windows(2).map(falls).collect();
    !after.windows(2).any(|pair| pair[0] && pair[1])
}
