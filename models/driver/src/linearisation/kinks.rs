//! Places where the derivatives of the rates jump. Differences between states on both sides find them, at many distances.

use dalembert::Instance;
use dalembert::contract::Variational;
use dalembert::math::larger;

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

/// Components across whose values the derivatives of the rates jump.
pub(super) fn kinks<S: Instance + Variational>(
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
