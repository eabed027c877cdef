//! A Taylor model of a function on a stretch, estimated from samples, for functions that are known at points only.
//!
//! Nine samples at Chebyshev-Lobatto points give an interpolant of degree 8. Its Chebyshev terms of degree 4 and higher
//! form the remainder, and its last two coefficients estimate the interpolation error. This is not an enclosure:
//! features narrower than the distance of two samples may be missed.
//!
//! NOTE: gaps are enclosed instead ([`super::path`]). Contact forces of surfaces that hold the motion are sampled,
//! because they are not available over intervals.

use core::f64::consts::FRAC_1_SQRT_2;

use crate::numbers::TaylorModel;

/// Number of samples.
pub(crate) const SAMPLES: usize = 9;

/// Places of the samples in the unit interval: `(1 - cos(j pi / 8)) / 2`.
pub(crate) const NODES: [f64; SAMPLES] = [
    0.0,
    0.038060233744356624,
    0.14644660940672624,
    0.30865828381745514,
    0.5,
    0.6913417161825449,
    0.8535533905932737,
    0.9619397662556434,
    1.0,
];

/// `cos(j pi / 8)` over a full turn.
const COSINES: [f64; 16] = {
    const FIRST: [f64; 5] = [
        1.0,
        0.923_879_532_511_286_7,
        FRAC_1_SQRT_2,
        0.382_683_432_365_089_8,
        0.0,
    ];
    let mut cosines = [0.0; 16];
    let mut j = 0;
    while j < 16 {
        let turned = if j > 8 { 16 - j } else { j };
        cosines[j] = match turned > 4 {
            true => -FIRST[8 - turned],
            false => FIRST[turned],
        };
        j += 1;
    }
    cosines
};

/// Rounding of the coefficients relative to the largest sample.
const ROUNDING: f64 = 64.0 * f64::EPSILON;

/// Ratio of slope to size of the interpolation error: twice the square of the degree.
const STEEPER: f64 = 128.0;

/// Estimated model of a function with these samples on a stretch. Infinite or NaN samples give an infinite error.
pub(crate) fn along(samples: &[f64; SAMPLES]) -> TaylorModel {
    let a = chebyshev(samples);
    let largest = samples
        .iter()
        .fold(0.0, |most: f64, sample| match sample.abs() {
            size if size <= most => most,
            size => size,
        });
    let doubt = a[7].abs() + a[8].abs() + ROUNDING * largest;
    if doubt.is_nan() || doubt == f64::INFINITY {
        return TaylorModel::ANYTHING;
    }
    let (mut error, mut slope) = (doubt, STEEPER * doubt);
    for (k, coefficient) in a.iter().enumerate().skip(4) {
        error += coefficient.abs();
        slope += (k * k) as f64 * coefficient.abs();
    }
    TaylorModel {
        error,
        slope,
        ..TaylorModel::exact([a[0] - a[2], a[1] - 3.0 * a[3], 2.0 * a[2], 4.0 * a[3]])
    }
}

/// Places of the samples of a stretch, exact at both ends.
pub(crate) fn nodes([left, right]: [f64; 2]) -> [f64; SAMPLES] {
    NODES.map(|node| match node >= 1.0 {
        true => right,
        false => left + (right - left) * node,
    })
}

/// Chebyshev coefficients of the interpolant.
fn chebyshev(samples: &[f64; SAMPLES]) -> [f64; SAMPLES] {
    const LAST: usize = SAMPLES - 1;
    core::array::from_fn(|k| {
        let mut sum = 0.0;
        for (j, sample) in samples.iter().enumerate() {
            let weight = if j == 0 || j == LAST { 0.5 } else { 1.0 };
            sum += weight * COSINES[k * j % COSINES.len()] * sample;
        }
        // Samples go from -1 to 1, against the order of the nodes `cos(j pi / 8)`.
        let sign = if k % 2 == 0 { 1.0 } else { -1.0 };
        let share = if k == 0 || k == LAST { 0.125 } else { 0.25 };
        sign * share * sum
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numbers::Interval;

    #[test]
    fn coefficients_reproduce_polynomials_of_degree_eight() {
        let at = |x: f64| x.powi(8) - 0.5 * x * x * x + 2.0;
        let a = chebyshev(&NODES.map(|node| at(2.0 * node - 1.0)));
        for step in 0..=20 {
            let x = f64::from(step) / 10.0 - 1.0;
            let (mut before, mut here) = (1.0, x);
            let mut sum = a[0];
            for coefficient in &a[1..] {
                sum += coefficient * here;
                (before, here) = (here, 2.0 * x * here - before);
            }
            assert!((sum - at(x)).abs() < 1e-14, "{}", sum - at(x));
        }
    }

    #[test]
    fn what_is_smooth_lies_in_its_estimate() {
        let at = |x: f64| (3.0 * x).sin() + x * x;
        for ends in [[0.0, 1.0], [0.3, 0.4], [0.2, 0.7]] {
            let found = along(&nodes(ends).map(at));
            for k in 0..=32 {
                let part = f64::from(k) / 32.0;
                let x = ends[0] + (ends[1] - ends[0]) * part;
                let horner = |sum: f64, power: &f64| sum * (2.0 * part - 1.0) + power;
                let cubic = found.powers.iter().rev().fold(0.0, horner);
                assert!((at(x) - cubic).abs() <= found.error, "{x}: {found:?}");
                let slope = (3.0 * (3.0 * x).cos() + 2.0 * x) * 0.5 * (ends[1] - ends[0]);
                assert!(
                    found.rates().contains(Interval::point(slope)),
                    "{x}: {found:?}"
                );
            }
        }
        assert!(along(&[f64::NAN; SAMPLES]).range().is_whole());
    }
}
