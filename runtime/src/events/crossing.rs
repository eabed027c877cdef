//! Signs of a polynomial from its Bernstein coefficients. The coefficients bound the polynomial (convex hull), and the
//! number of their sign changes bounds the number of roots (Descartes). A coefficient smaller than the error of the
//! polynomial has no certain sign.

/// Number of coefficients.
pub(crate) const COUNT: usize = 9;

/// Conversion of power coefficients to Bernstein coefficients. Row `k`, column `j - 1` is `C(j, k) / C(8, k)`: the
/// weight of power coefficient `k` in Bernstein coefficient `j`. Bernstein coefficient 0 equals power coefficient 0 and
/// has no column.
pub(crate) const FROM_POWERS: [[f64; COUNT - 1]; COUNT] = {
    let mut table = [[0.0; COUNT - 1]; COUNT];
    let mut j = 1;
    while j < COUNT {
        let (mut k, mut ratio) = (0, 1.0);
        while k <= j {
            table[k][j - 1] = ratio;
            ratio *= (j - k) as f64 / (COUNT - 1 - k) as f64;
            k += 1;
        }
        j += 1;
    }
    table
};

/// Signs of a function on an interval.
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
    /// Not decided.
    Unclear,
}

/// Signs from at most 32 Bernstein coefficients. A coefficient with an absolute value of at most `doubt` is uncertain.
///
/// A single uncertain coefficient between a positive and a negative one hides no further root. Any other uncertain
/// coefficient may hide roots.
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

#[cfg(test)]
mod tests {
    use super::*;

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
}
