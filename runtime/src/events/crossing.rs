//! Signs of a function between its samples, by the Bernstein coefficients of its interpolant.
//!
//! Nine samples at Chebyshev-Lobatto points give an interpolant of degree 8, one more than the dense output of the
//! highest order here. Its Bernstein coefficients bound it (convex hull), and their sign changes bound its roots
//! (Descartes). What the interpolant misses is estimated by its last two Chebyshev coefficients; a coefficient
//! that small has no certain sign.

use core::f64::consts::FRAC_1_SQRT_2;

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

/// From powers to Bernstein coefficients: `C(j, k) / C(8, k)` of power `k` in coefficient `j`. Row `k` is that of a power,
/// and begins with coefficient 1: coefficient 0 is power 0.
pub(crate) const FROM_POWERS: [[f64; SAMPLES - 1]; SAMPLES] = {
    let mut table = [[0.0; SAMPLES - 1]; SAMPLES];
    let mut j = 1;
    while j < SAMPLES {
        let (mut k, mut ratio) = (0, 1.0);
        while k <= j {
            table[k][j - 1] = ratio;
            ratio *= (j - k) as f64 / (SAMPLES - 1 - k) as f64;
            k += 1;
        }
        j += 1;
    }
    table
};

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

/// What the samples show of the function between them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Signs {
    /// Positive throughout.
    Positive,
    /// Negative throughout.
    Negative,
    /// One root, from positive to negative.
    Falls,
    /// One root, from negative to positive.
    Rises,
    /// Cannot be told from these samples.
    Unclear,
}

/// Reads the signs of a function from its samples at [`NODES`].
pub(crate) fn signs(samples: &[f64; SAMPLES]) -> Signs {
    read(&bernstein(samples), doubt(samples))
}

/// Reads signs from Bernstein coefficients, at most 32; those within the doubt have none.
///
/// One uncertain coefficient where the sign changes hides no root; any other may hide two.
#[inline(always)]
pub(crate) fn read(coefficients: &[f64], doubt: f64) -> Signs {
    // One bit per coefficient, the first one lowest.
    let (mut above, mut below) = (0_u32, 0_u32);
    for (place, &coefficient) in coefficients.iter().enumerate() {
        above |= u32::from(coefficient > doubt) << place;
        below |= u32::from(coefficient < -doubt) << place;
    }
    let count = coefficients.len() as u32;
    let changes_once = |first: u32, last: u32| {
        let ahead = first.trailing_ones();
        let behind = (last << (u32::BITS - count)).leading_ones();
        ahead > 0 && behind > 0 && ahead + behind + 1 >= count
    };
    match (above, below) {
        (_, 0) if above.trailing_ones() == count => Signs::Positive,
        (0, _) if below.trailing_ones() == count => Signs::Negative,
        _ if changes_once(above, below) => Signs::Falls,
        _ if changes_once(below, above) => Signs::Rises,
        _ => Signs::Unclear,
    }
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

/// Where the single probe of [`clear`] lies: off the middle, so that a step of two periods does not fool it.
pub(crate) const PROBE: f64 = 0.4142135623730951;

/// Whether a function keeps one sign over the unit interval, told cheaply from its values and slopes at both ends
/// and one value at [`PROBE`]. `false` means only that this is not enough to tell.
///
/// The cubic through the ends is corrected to a quartic by the probe; the quartic's Bernstein coefficients must
/// clear the size of that correction. A start value of exactly 0 stands for a surface just left: the root there is
/// divided out by leaving its coefficient aside.
#[inline]
pub(crate) fn clear(values: [f64; 2], slopes: [f64; 2], probe: f64) -> bool {
    let [v0, v1] = values;
    let (b1, b2) = (v0 + slopes[0] / 3.0, v1 - slopes[1] / 3.0);
    const S: f64 = 1.0 - PROBE;
    let cubic =
        S * S * S * v0 + 3.0 * S * PROBE * (S * b1 + PROBE * b2) + PROBE * PROBE * PROBE * v1;
    let quartic = (probe - cubic) / (PROBE * PROBE * S * S);
    // Means, not sums: these may be beyond the range where gaps are near its end.
    let coefficients = [
        0.25 * v0 + 0.75 * b1,
        0.5 * b1 + 0.5 * b2 + quartic / 6.0,
        0.75 * b2 + 0.25 * v1,
        v1,
    ];
    let (mut least, mut largest) = (v1, v1);
    for value in coefficients {
        least = least.min(value);
        largest = largest.max(value);
    }
    if v0 != 0.0 {
        least = least.min(v0);
        largest = largest.max(v0);
    }
    // A quartic theta^2 (1 - theta)^2 is at most 1/16; four times as much is left to what is no quartic: loose steps may hold
    // most of a turn, of which one probe shows little.
    let doubt = quartic.abs() / 4.0 + ROUNDING * least.abs().max(largest.abs());
    least > doubt || largest < -doubt
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(function: impl Fn(f64) -> f64) -> Signs {
        signs(&NODES.map(function))
    }

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
    fn signs_are_read_and_never_guessed() {
        assert_eq!(read(|x| 1.0 + x), Signs::Positive);
        assert_eq!(read(|x| -1.0 - x * x), Signs::Negative);
        assert_eq!(read(|x| 0.3 - x), Signs::Falls);
        assert_eq!(read(|x| x - 0.3), Signs::Rises);
        assert_eq!(read(|x| (x - 0.4) * (x - 0.5)), Signs::Unclear);
        assert_eq!(read(|x| 1.0 + (40.0 * x).sin()), Signs::Unclear);
        assert_eq!(read(|_| f64::NAN), Signs::Unclear);
    }

    #[test]
    fn uncertain_coefficients_are_passed_over_only_where_they_hide_no_root() {
        let read = |coefficients: &[f64]| super::read(coefficients, 0.5);
        assert_eq!(read(&[1.0, 2.0, 1.0]), Signs::Positive);
        assert_eq!(read(&[-1.0, -2.0]), Signs::Negative);
        assert_eq!(read(&[1.0, 0.1, -1.0, -1.0]), Signs::Falls);
        assert_eq!(read(&[-1.0, -1.0, 0.0, 1.0]), Signs::Rises);
        let unclear: [&[f64]; 7] = [
            &[1.0, 0.1, 1.0],
            &[1.0, 0.1, -0.1, -1.0],
            &[1.0, 0.1, 1.0, -1.0],
            &[1.0, -1.0, 1.0],
            &[0.1, -1.0],
            &[1.0, 0.1],
            &[1.0, f64::NAN, 1.0],
        ];
        for coefficients in unclear {
            assert_eq!(read(coefficients), Signs::Unclear, "{coefficients:?}");
        }
    }

    #[test]
    fn cheap_test_sees_a_dip_between_positive_ends() {
        let dip = |depth: f64| {
            let f = |x: f64| (x - 0.5) * (x - 0.5) * 4.0 - depth;
            clear([f(0.0), f(1.0)], [-4.0, 4.0], f(PROBE))
        };
        assert!(!dip(1e-3));
        assert!(clear([1.0, 2.0], [1.0, 1.0], 1.0 + PROBE));
        // Just left with rate 1, and falling back before the end or not.
        assert!(clear([0.0, 0.5], [1.0, 0.0], PROBE - 0.5 * PROBE * PROBE));
        assert!(!clear(
            [0.0, -0.5],
            [1.0, -2.0],
            PROBE - 1.5 * PROBE * PROBE
        ));
    }
}
