//! Reach of a series: the longest step at whose end the last terms are negligible relative to the first ones.

use crate::jet::LENGTH;

/// Number of leading terms that determine the size of a series.
const LEADING: usize = 4;

/// Factor by which a step shrinks until its last terms are small enough.
const SHRINK: f64 = 0.75;

/// Largest step, in units of time of its expansion. All powers of it stay far from overflow.
pub(crate) const LONGEST: f64 = 1024.0;

/// Largest of the tried steps, up to `wished` units of time, at whose end the last two terms of every series are at
/// most `last` times the largest of the first ones. `None` if the series must be computed in a shorter unit. `sizes`
/// has one row per order.
pub(crate) fn reach<const K: usize>(
    sizes: &[[f64; K]; LENGTH],
    order: usize,
    wished: f64,
    last: f64,
) -> Option<f64> {
    let mut theta = wished.min(LONGEST);
    while (0..K).any(|k| !is_small(|j| sizes[j][k], order, theta, last)) {
        theta *= SHRINK;
        if theta < 1.0 / LONGEST {
            return None;
        }
    }
    Some(theta)
}

/// True if the last two terms of a series are at most `last` times the largest of its first ones.
fn is_small(size: impl Fn(usize) -> f64, order: usize, theta: f64, last: f64) -> bool {
    let mut power = 1.0;
    let mut leading = 0.0;
    for j in 0..=order {
        let term = size(j) * power;
        if j < LEADING.min(order - 1) {
            leading = f64::max(leading, term);
        } else if j + 1 >= order && term > last * leading && leading > 0.0 {
            return false;
        }
        power *= theta;
    }
    true
}
