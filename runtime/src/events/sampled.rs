//! Values and rates of a function on a stretch, estimated from samples: for functions that are known at points only.
//!
//! Nine samples at Chebyshev-Lobatto points give an interpolant of degree 8, whose Bernstein coefficients bound it and its rate
//! (convex hull). What the interpolant misses is estimated by its last two Chebyshev coefficients. This is no enclosure: what is
//! narrower than the distance of two samples may be missed.
//!
//! NOTE: gaps are enclosed ([`super::path`]). The forces of surfaces that hold the motion are not known over intervals.

use core::f64::consts::FRAC_1_SQRT_2;

use crate::numbers::{Interval, Rated};

/// Number of samples.
pub(crate) const SAMPLES: usize = 9;

/// `(1 - cos(j pi / 8)) / 2`: where in the unit interval the samples lie.
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

/// From samples to the Bernstein coefficients 1 to 4. Coefficients 0 and 8 are the end samples, 5 to 7 follow by
/// reflection.
const TO_BERNSTEIN: [[f64; SAMPLES]; 4] = [
    [
        -4.375,
        6.568535592272045,
        -1.7071067811865475,
        0.8099572022108875,
        -0.5,
        0.3616156730429224,
        -0.2928932188134525,
        0.259891532474145,
        -0.125,
    ],
    [
        9.75,
        -18.25275486114713,
        14.22828282092095,
        -7.581239029125371,
        4.857142857142857,
        -3.570028757024018,
        2.914574321936191,
        -2.5959773527034806,
        1.25,
    ],
    [
        -12.767857142857142,
        25.51152560426028,
        -25.112909700267398,
        23.09799209414256,
        -17.071428571428573,
        13.306068923678326,
        -11.172804585446888,
        10.084413377918832,
        -4.875,
    ],
    [
        10.214285714285714,
        -20.91764997160261,
        22.4,
        -24.7966357426831,
        27.2,
        -24.7966357426831,
        22.4,
        -20.91764997160261,
        10.214285714285714,
    ],
];

/// `cos(7 j pi / 8)`: the Chebyshev polynomial of degree 7 at the samples.
const SEVENTH: [f64; SAMPLES] = [
    1.0,
    -0.9238795325112867,
    FRAC_1_SQRT_2,
    -0.3826834323650898,
    0.0,
    0.3826834323650898,
    -FRAC_1_SQRT_2,
    0.9238795325112867,
    -1.0,
];

/// Rounding of the conversion relative to the largest sample: the largest row sum of the table is 184, and each
/// product is rounded.
const ROUNDING: f64 = 2.0 * 184.0 * f64::EPSILON;

/// How much steeper than large what the interpolant misses may be: twice the square of its degree.
const STEEPER: f64 = 128.0;

/// All values and rates of a function with these samples on a stretch of this width, estimated.
pub(crate) fn along(samples: &[f64; SAMPLES], width: f64) -> Rated {
    let (coefficients, doubt) = (bernstein(samples), doubt(samples));
    if doubt == f64::INFINITY {
        return Rated {
            value: Interval::WHOLE,
            rate: Interval::WHOLE,
        };
    }
    let hull = |range: Interval, value: f64| range.hull(Interval::point(value));
    let value = coefficients
        .iter()
        .copied()
        .fold(Interval::point(coefficients[0]), hull);
    let slopes = coefficients
        .windows(2)
        .map(|pair| (SAMPLES - 1) as f64 * (pair[1] - pair[0]) / width);
    let first = (SAMPLES - 1) as f64 * (coefficients[1] - coefficients[0]) / width;
    Rated {
        value: value.widened(doubt),
        rate: slopes
            .fold(Interval::point(first), hull)
            .widened(STEEPER * doubt / width),
    }
}

/// Where the samples of a stretch lie, exact at both ends.
pub(crate) fn nodes([left, right]: [f64; 2]) -> [f64; SAMPLES] {
    NODES.map(|node| match node >= 1.0 {
        true => right,
        false => left + (right - left) * node,
    })
}

/// Bernstein coefficients of the interpolant.
fn bernstein(samples: &[f64; SAMPLES]) -> [f64; SAMPLES] {
    let mut coefficients = *samples;
    for (row, weights) in TO_BERNSTEIN.iter().enumerate() {
        let (mut forward, mut backward) = (0.0, 0.0);
        for j in 0..SAMPLES {
            forward += weights[j] * samples[j];
            backward += weights[j] * samples[SAMPLES - 1 - j];
        }
        coefficients[row + 1] = forward;
        coefficients[SAMPLES - 2 - row] = backward;
    }
    coefficients
}

/// Below this a coefficient has no certain sign: the last two Chebyshev coefficients, and rounding. Infinite or NaN
/// samples give doubt that nothing exceeds.
fn doubt(samples: &[f64; SAMPLES]) -> f64 {
    let (mut seventh, mut eighth, mut largest) = (0.0, 0.0, 0.0_f64);
    for j in 0..SAMPLES {
        let weight = if j == 0 || j == SAMPLES - 1 { 0.5 } else { 1.0 };
        seventh += weight * SEVENTH[j] * samples[j];
        eighth += if j % 2 == 0 {
            weight * samples[j]
        } else {
            -weight * samples[j]
        };
        largest = largest.max(samples[j].abs());
    }
    let doubt = 0.25 * seventh.abs() + 0.125 * eighth.abs() + ROUNDING * largest;
    if doubt.is_nan() { f64::INFINITY } else { doubt }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn conversion_reproduces_polynomials_of_degree_eight() {
        let samples = NODES.map(|x| x * x * x * x * x * x * x * x - 0.5 * x * x * x + 2.0);
        let coefficients = bernstein(&samples);
        for step in 0..=20 {
            let x = f64::from(step) / 20.0;
            let mut row = coefficients;
            for level in 1..SAMPLES {
                for i in 0..SAMPLES - level {
                    row[i] = (1.0 - x) * row[i] + x * row[i + 1];
                }
            }
            let exact = x * x * x * x * x * x * x * x - 0.5 * x * x * x + 2.0;
            assert!(
                (row[0] - exact).abs() < 2.5 * ROUNDING,
                "{}",
                row[0] - exact
            );
        }
    }

    #[test]
    fn what_is_smooth_lies_in_its_estimate() {
        let at = |x: f64| (3.0 * x).sin() + x * x;
        for ends in [[0.0, 1.0], [0.3, 0.4], [0.2, 0.7]] {
            let found = along(&nodes(ends).map(at), ends[1] - ends[0]);
            for k in 0..=32 {
                let x = ends[0] + (ends[1] - ends[0]) * f64::from(k) / 32.0;
                assert!(found.value.contains(Interval::point(at(x))));
                let slope = 3.0 * (3.0 * x).cos() + 2.0 * x;
                assert!(
                    found.rate.contains(Interval::point(slope)),
                    "{x}: {found:?}"
                );
            }
        }
        assert!(along(&[f64::NAN; SAMPLES], 1.0).value.is_whole());
    }
}
