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

/// Smallest jump, as a fraction of the largest derivative.
const JUMP: f64 = 1e-6;

/// Ratio of the jumps of a smooth function at distances with the ratio [`DECADE`].
const FALL: core::ops::Range<f64> = 1e-4..0.3;

/// Components across whose values the derivatives of the rates jump.
pub(super) fn kinks<S: Instance + Variational>(
    plant: &Plant<'_, S>,
    (state, inputs): (&[f64], &[f64]),
) -> Vec<usize> {
    let is_kinked = |index: &usize| {
        let slopes = |shift: f64| {
            let mut beside = state.to_vec();
            beside[*index] += shift;
            let sample = plant.at(&beside, inputs).ok()?;
            Some(sample.by_rates)
        };
        let size = match state[*index] {
            0.0 => 1.0,
            value => value.abs(),
        };
        let jump = |k: u32| {
            let distance = size * DECADE.powi(k as i32);
            jump(&slopes(distance)?, &slopes(-distance)?)
        };
        let jumps: Vec<f64> = (1..=DECADES).map(|k| jump(k).unwrap_or(f64::NAN)).collect();
        stays(&jumps)
    };
    (0..state.len()).filter(is_kinked).collect()
}

/// The largest difference between rows of derivatives on both sides, relative to the largest derivative in its row.
fn jump(above: &[Vec<f64>], below: &[Vec<f64>]) -> Option<f64> {
    let of_row = |(above, below): (&Vec<f64>, &Vec<f64>)| {
        let size = largest(above.iter().chain(below));
        let apart = above
            .iter()
            .zip(below)
            .map(|(above, below)| (above - below).abs());
        match size {
            0.0 => 0.0,
            size => apart.fold(0.0, larger) / size,
        }
    };
    let rows = above.iter().zip(below).map(of_row);
    let found = rows.fold(0.0, larger);
    found.is_finite().then_some(found)
}

/// True if a jump, at distances that fall by a factor of ten each, is the same for at least two of them in a row, and does
/// not fall with the distance afterwards. A smooth function that varies over a short distance has a jump that stays and then
/// falls; the jump at a kink stays until rounding hides it.
fn stays(jumps: &[f64]) -> bool {
    let is_level = |pair: &[f64]| pair[0] > JUMP && (0.5..=2.0).contains(&(pair[1] / pair[0]));
    let falls = |pair: &[f64]| pair[0] > JUMP && FALL.contains(&(pair[1] / pair[0]));
    let Some(last) = jumps.windows(2).rposition(is_level) else {
        return false;
    };
    let after: Vec<bool> = jumps[last + 1..].windows(2).map(falls).collect();
    !after.windows(2).any(|pair| pair[0] && pair[1])
}
