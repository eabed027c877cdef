//! Detection of instants between the ends of a step at which the constraint forms become dependent.
//!
//! A step evaluates rates at a few places only. A rank drop at one instant is invisible from there: on either side the
//! forms may be well independent. The test uses the plane that the forms span, with its orientation: the multivector
//! `eta^1 ^ .. ^ eta^M`. It is continuous along the motion and vanishes where the forms are dependent. If it vanishes
//! to odd order, it reverses its orientation, whatever rotation it performs besides. Two places between which it
//! reverses are bracketed until the change proves to be a smooth rotation, or until the places are neighbouring
//! numbers. If it vanishes to even order, it keeps its orientation, and a minimum of its size is searched for instead.

use crate::contract::{Constrained, RankDrop};
use crate::math::{abs, sqrt};

/// Places at which a step is examined. The values at three places show a minimum between two of them: neighbouring
/// distances differ by at most a factor of four.
const PLACES: [f64; 11] = [
    0.0,
    1.0 / 256.0,
    1.0 / 64.0,
    1.0 / 16.0,
    0.25,
    0.5,
    0.75,
    15.0 / 16.0,
    63.0 / 64.0,
    255.0 / 256.0,
    1.0,
];

/// A size that stays above this fraction of its values nearby has no zero between. For three places with distances 1
/// and 4, and a zero of second order half way along the longer one, the fraction is `(2/(2 + 1))^2`. A margin is added.
const DIP: f64 = 0.5;

/// Relative size that counts as zero.
const ZERO: f64 = 4.0 * f64::EPSILON;

/// A rotation that takes less than this fraction of the time counts as instantaneous, up to the rounding errors of
/// earlier steps.
const INSTANT: f64 = 512.0 * f64::EPSILON;

/// Number of steps of the search for a minimum, enough to reduce a bracket to neighbouring numbers.
const NARROWINGS: u32 = 80;

/// The plane of the forms at one place.
#[derive(Debug, Clone, Copy)]
struct Plane<const M: usize, const N: usize> {
    /// The place.
    theta: f64,
    /// The time there.
    t: f64,
    /// Number of forms.
    count: usize,
    /// Its orthonormal basis. A row that depends on the earlier ones is 0.
    basis: [[f64; N]; M],
    /// Length of each form after its components along the earlier ones are removed.
    lengths: [f64; M],
}

impl<const M: usize, const N: usize> Plane<M, N> {
    /// Computes the plane by the modified Gram-Schmidt method.
    fn of(theta: f64, t: f64, (mut forms, count): ([[f64; N]; M], usize)) -> Self {
        let mut lengths = [0.0; M];
        for a in 0..count {
            let (earlier, rest) = forms.split_at_mut(a);
            let form = &mut rest[0];
            for other in earlier.iter() {
                let product = inner(form, other);
                for (entry, other) in form.iter_mut().zip(other) {
                    *entry -= product * other;
                }
            }
            let length = sqrt(inner(form, form));
            lengths[a] = length;
            let inverse = if length > 0.0 { 1.0 / length } else { 0.0 };
            form.iter_mut().for_each(|entry| *entry *= inverse);
        }
        Self {
            theta,
            t,
            count,
            basis: forms,
            lengths,
        }
    }

    /// Cosine of the angle between the oriented planes: `det (Q_a Q_b^T)`.
    fn cosine(&self, other: &Self) -> f64 {
        let mut products = [[0.0; M]; M];
        for (row, vector) in products.iter_mut().zip(&self.basis[..self.count]) {
            for (entry, other) in row.iter_mut().zip(&other.basis[..self.count]) {
                *entry = inner(vector, other);
            }
        }
        determinant(products, self.count)
    }

    /// Ratio of the size of the multivector to its size at another place.
    fn size_beside(&self, other: &Self) -> f64 {
        let pairs = self.lengths[..self.count].iter().zip(other.lengths);
        pairs.map(|(length, other)| length / other).product()
    }
}

fn inner<const N: usize>(a: &[f64; N], b: &[f64; N]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Determinant of the first `count` rows and columns, by Gaussian elimination with partial pivoting.
fn determinant<const M: usize>(mut rows: [[f64; M]; M], count: usize) -> f64 {
    let mut product = 1.0;
    for k in 0..count {
        let size = |row: usize| abs(rows[row][k]);
        let largest = (k..count).max_by(|&a, &b| size(a).total_cmp(&size(b)));
        let pivot = largest.unwrap_or(k);
        if pivot != k {
            rows.swap(pivot, k);
            product = -product;
        }
        let pivot_row = rows[k];
        product *= pivot_row[k];
        if pivot_row[k] == 0.0 {
            return 0.0;
        }
        for row in &mut rows[k + 1..count] {
            let factor = row[k] / pivot_row[k];
            for (entry, element) in row.iter_mut().zip(&pivot_row) {
                *entry -= factor * element;
            }
        }
    }
    product
}

/// Implementation of [`System::rank_drop`](crate::System::rank_drop) for a system with up to M constraints and up to N
/// coordinates.
pub fn rank_drop<S: Constrained, const M: usize, const N: usize>(
    system: &S,
    motion: impl Fn(f64) -> (f64, S::State),
    reach: f64,
) -> Option<RankDrop> {
    let plane = |theta: f64| {
        let (t, state) = motion(theta);
        let (count, columns) = (system.constraint_count(), system.coordinate_count());
        let mut forms = [[0.0; N]; M];
        let mut affine = system.zero_multipliers();
        let q = system.position(&state);
        let written = &mut forms.as_flattened_mut()[..count * columns];
        system.constraint_forms(t, &q, written, &mut affine);
        Plane::of(theta, t, (apart(forms, columns), count))
    };
    first_drop::<M, N>(plane, reach)
}

/// Splits consecutive rows of `columns` numbers into separate rows.
fn apart<const M: usize, const N: usize>(forms: [[f64; N]; M], columns: usize) -> [[f64; N]; M] {
    let mut rows = [[0.0; N]; M];
    for (row, written) in rows
        .iter_mut()
        .zip(forms.as_flattened().chunks_exact(columns))
    {
        row[..columns].copy_from_slice(written);
    }
    rows
}

/// The first drop of the rank among places up to `reach`.
fn first_drop<const M: usize, const N: usize>(
    plane: impl Fn(f64) -> Plane<M, N>,
    reach: f64,
) -> Option<RankDrop> {
    let first = plane(0.0);
    let named = |at: Plane<M, N>, theta: f64| {
        let end = plane(reach);
        let length = |a: usize| at.lengths[a] / first.lengths[a].max(end.lengths[a]);
        let least = (0..at.count).min_by(|&a, &b| length(a).total_cmp(&length(b)));
        RankDrop {
            theta,
            constraint: least.unwrap_or(0),
        }
    };
    let size = |theta: f64| plane(theta).size_beside(&first);
    let mut last = first;
    // Places with their sizes: the last but one, and the last.
    let (mut earlier, mut before) = (None, (0.0, 1.0));
    for (k, place) in PLACES.into_iter().enumerate().skip(1) {
        let next = plane(place * reach);
        let here = (next.theta, next.size_beside(&first));
        let turn = turned_round(&plane, last, next);
        let touch = earlier
            .and_then(|earlier| dip(k, [earlier, before, here]))
            .and_then(|bracket| vanishing(&size, bracket));
        (earlier, before) = (Some(before), here);
        match (turn, touch) {
            (Some(turn), Some(touch)) if touch <= turn[0].theta => {
                return Some(named(plane(touch), touch));
            }
            (Some([before, after]), _) => return Some(named(after, before.theta)),
            (None, Some(touch)) => return Some(named(plane(touch), touch)),
            (None, None) => last = next,
        }
    }
    None
}

/// Neighbouring places between which the plane reverses, if it reverses at one instant.
fn turned_round<const M: usize, const N: usize>(
    plane: &impl Fn(f64) -> Plane<M, N>,
    mut before: Plane<M, N>,
    mut after: Plane<M, N>,
) -> Option<[Plane<M, N>; 2]> {
    let turns = before.cosine(&after) <= 0.0;
    if !turns {
        return None;
    }
    loop {
        let middle = 0.5 * (before.theta + after.theta);
        if middle <= before.theta || middle >= after.theta {
            return Some([before, after]);
        }
        let middle = plane(middle);
        // NOTE: if the forms are dependent to the last digit, the basis is 0, or noise that may be perpendicular to
        // both sides.
        if before.cosine(&middle) <= 0.0 {
            after = middle;
        } else if middle.cosine(&after) <= 0.0 {
            before = middle;
        } else {
            let is_instant = after.t - before.t <= INSTANT * abs(before.t).max(abs(after.t));
            return is_instant.then_some([before, after]);
        }
    }
}

/// Bracket of a possible zero of the size, from three successive places with the sizes there: around the middle place,
/// or next to an end of the step. `k` is the index of the last place.
fn dip(k: usize, [a, b, c]: [(f64, f64); 3]) -> Option<[f64; 2]> {
    let falls = |least: f64, most: f64| least < DIP * most;
    if b.1 <= a.1 && b.1 <= c.1 && falls(b.1, a.1.max(c.1)) {
        return Some([a.0, c.0]);
    }
    if k == 2 && a.1 <= b.1 && falls(a.1, c.1) {
        return Some([a.0, b.0]);
    }
    let is_last = k + 1 == PLACES.len();
    (is_last && c.1 <= b.1 && falls(c.1, a.1)).then_some([b.0, c.0])
}

/// Place of a zero of the size between these two places, by golden-section search; `None` unless the minimum is
/// negligible relative to the sizes there.
fn vanishing(size: &impl Fn(f64) -> f64, [mut low, mut high]: [f64; 2]) -> Option<f64> {
    const GOLDEN: f64 = 0.618_033_988_749_894_9;
    let most = size(low).max(size(high));
    let inside = |low: f64, high: f64, part: f64| {
        let theta = low + part * (high - low);
        (theta, size(theta))
    };
    let mut left = inside(low, high, 1.0 - GOLDEN);
    let mut right = inside(low, high, GOLDEN);
    for _ in 0..NARROWINGS {
        if left.1 <= right.1 {
            (high, right) = (right.0, left);
            left = inside(low, high, 1.0 - GOLDEN);
        } else {
            (low, left) = (left.0, right);
            right = inside(low, high, GOLDEN);
        }
    }
    let least = [left.1, right.1, size(low), size(high)]
        .into_iter()
        .fold(f64::INFINITY, f64::min);
    (least <= ZERO * most).then_some(low)
}
