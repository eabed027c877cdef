//! Sums over Taylor coefficients, called by generated code.

use crate::numbers::Numbers;
pub use crate::numbers::{INVERSES, LENGTH};
pub use dalembert_numbers::tables::Work;

/// Storage for the coefficients of several series.
///
/// # Examples
///
/// ```
/// use dalembert::jet::Jets;
///
/// // Three coefficients of each of two series.
/// assert_eq!(<[[f64; 2]; 3] as Jets>::ZERO, [[0.0; 2]; 3]);
/// ```
pub trait Jets: Copy {
    /// Storage with all coefficients zero.
    const ZERO: Self;
}

impl Jets for () {
    const ZERO: Self = ();
}

/// Storage for the series of several modes, of which one is computed at a time.
impl<A: Jets, B: Jets> Jets for (A, B) {
    const ZERO: Self = (A::ZERO, B::ZERO);
}

impl<L: Numbers, const W: usize, const H: usize> Jets for [[L; W]; H] {
    const ZERO: Self = [[L::ZERO; W]; H];
}

/// `sum a_j b_(k-j)` for `j` in `1..k`, for `W` pairs of series at once. Row `j` holds coefficient `j` of all series,
/// those of the `a` from index `a` on, those of the `b` from index `b` on. Row `k - 1`, the newest, is passed
/// separately: reading it back from memory that has just been written would delay the sum.
#[inline(always)]
pub fn middles<L: Numbers, const W: usize, const P: usize>(
    rows: &[[L; P]; LENGTH],
    (a, newest_a): (usize, &[L; W]),
    (b, newest_b): (usize, &[L; W]),
    k: usize,
) -> [L; W] {
    let k = k.clamp(1, LENGTH - 1);
    let mut sums = [L::ZERO; W];
    if k < 2 {
        return sums;
    }
    let between = &rows[2..k.max(3) - 1];
    for (x, y) in between.iter().zip(between.iter().rev()) {
        for i in 0..W {
            sums[i] = x[a + i].mul_add(y[b + i], sums[i]);
        }
    }
    // The newest coefficients come last: the sum need not wait for them.
    let first = &rows[1];
    for i in 0..W {
        sums[i] = first[a + i].mul_add(newest_b[i], sums[i]);
    }
    if k > 2 {
        for i in 0..W {
            sums[i] = newest_a[i].mul_add(first[b + i], sums[i]);
        }
    }
    sums
}

/// Half of `sum a_j a_(k-j)` for `j` in `1..k`, each product once, for `W` series at once as in [`middles`].
#[inline(always)]
pub fn halves<L: Numbers, const W: usize, const P: usize>(
    rows: &[[L; P]; LENGTH],
    (a, newest): (usize, &[L; W]),
    k: usize,
) -> [L; W] {
    let k = k.clamp(1, LENGTH - 1);
    let mut sums = [L::ZERO; W];
    if k < 2 {
        return sums;
    }
    let pairs = (k - 1) / 2;
    if k.is_multiple_of(2) {
        let centre = &rows[k / 2];
        for i in 0..W {
            sums[i] = L::of(0.5) * centre[a + i] * centre[a + i];
        }
    }
    if k > 2 {
        let (left, right) = (&rows[2..=pairs.max(1)], &rows[k - pairs..k - 1]);
        for (x, y) in left.iter().rev().zip(right) {
            for i in 0..W {
                sums[i] = x[a + i].mul_add(y[a + i], sums[i]);
            }
        }
        let first = &rows[1];
        for i in 0..W {
            sums[i] = first[a + i].mul_add(newest[i], sums[i]);
        }
    }
    sums
}

/// Stores the newest coefficients in a row, from index `place` on.
#[inline(always)]
pub fn keep<L: Numbers, const W: usize, const P: usize>(
    row: &mut [L; P],
    place: usize,
    newest: &[L; W],
) {
    row[place..place + W].copy_from_slice(newest);
}

/// `sum a_j b_(k-j)` for `j` in `1..=k`, where `a_j` vanishes beyond `degree`, for the series at two indices of the
/// rows.
#[inline(always)]
pub fn short<L: Numbers, const P: usize>(
    rows: &[[L; P]; LENGTH],
    a: usize,
    b: usize,
    k: usize,
    degree: usize,
) -> L {
    let mut sum = rows[1][a] * rows[k - 1][b];
    for j in 2..=degree {
        if j <= k {
            sum = sum + rows[j][a] * rows[k - j][b];
        }
    }
    sum
}

/// `sum a_j b_(k-j)` for `j` in `1..k`, in the order of additions of [`middles`].
// NOTE: not inlined, for functions with too many sums to inline each.
#[inline(never)]
pub fn shared_middle<L: Numbers>(a: &[L; LENGTH], b: &[L; LENGTH], k: usize) -> L {
    let k = k.clamp(1, LENGTH - 1);
    let mut sum = L::ZERO;
    if k < 2 {
        return sum;
    }
    let between = 2..k.max(3) - 1;
    for (x, y) in a[between.clone()].iter().zip(b[between].iter().rev()) {
        sum = x.mul_add(*y, sum);
    }
    sum = a[1].mul_add(b[k - 1], sum);
    match k > 2 {
        true => a[k - 1].mul_add(b[1], sum),
        false => sum,
    }
}

/// Half of `sum a_j a_(k-j)` for `j` in `1..k`: each product once, in the order of additions of [`halves`].
#[inline]
pub fn half<L: Numbers>(a: &[L; LENGTH], k: usize) -> L {
    let k = k.clamp(1, LENGTH - 1);
    let mut sum = match k.is_multiple_of(2) {
        true => L::of(0.5) * a[k / 2] * a[k / 2],
        false => L::ZERO,
    };
    if k > 2 {
        let pairs = (k - 1) / 2;
        let (left, right) = (&a[2..=pairs.max(1)], &a[k - pairs..k - 1]);
        for (x, y) in left.iter().rev().zip(right) {
            sum = x.mul_add(*y, sum);
        }
        sum = a[1].mul_add(a[k - 1], sum);
    }
    sum
}

/// `sum a_j b_(k-j)` for `j` in `1..=k`, where `a_j` vanishes beyond `degree`, in the order of additions of [`short`].
#[inline(always)]
pub fn shared_short<L: Numbers>(a: &[L; LENGTH], b: &[L; LENGTH], k: usize, degree: usize) -> L {
    let mut sum = a[1] * b[k - 1];
    for j in 2..=degree {
        if j <= k {
            sum = sum + a[j] * b[k - j];
        }
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sums_are_those_of_their_definitions() {
        let (mut a, mut b) = ([0.0; LENGTH], [0.0; LENGTH]);
        for j in 0..LENGTH {
            (a[j], b[j]) = (1.0 + j as f64, 2.0 - (j * j) as f64);
        }
        let mut rows = [[0.0; 4]; LENGTH];
        for j in 0..LENGTH {
            rows[j] = [b[j], a[j], b[j], a[j]];
        }
        for k in 1..LENGTH {
            let sum = |x: &[f64], y: &[f64], from: usize, to: usize| -> f64 {
                (from..to).map(|j| x[j] * y[k - j]).sum()
            };
            assert_eq!(shared_middle(&a, &b, k), sum(&a, &b, 1, k));
            assert_eq!(2.0 * half(&a, k), sum(&a, &a, 1, k));
            assert_eq!(shared_short(&a, &b, k, 3), sum(&a, &b, 1, (k + 1).min(4)));
            assert_eq!(short(&rows, 1, 2, k, 3), sum(&a, &b, 1, (k + 1).min(4)));
            let newest = |place: usize| [rows[k - 1][place], rows[k - 1][place + 1]];
            let both = middles(&rows, (0, &newest(0)), (2, &newest(2)), k);
            assert_eq!(both, [sum(&b, &b, 1, k), sum(&a, &a, 1, k)]);
            let [of_a, of_b] = halves(&rows, (1, &newest(1)), k);
            assert_eq!(
                [2.0 * of_a, 2.0 * of_b],
                [sum(&a, &a, 1, k), sum(&b, &b, 1, k)]
            );
        }
    }
}
