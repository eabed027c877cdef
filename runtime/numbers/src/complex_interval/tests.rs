//! Complex intervals against complex arithmetic.

use super::*;
use crate::interval::tests::{Complex, FUNCTIONS, Sample};

#[test]
fn values_off_the_axis_lie_in_their_rectangles() {
    let mut bounded = 0;
    for function in FUNCTIONS {
        for Sample { from, to } in function.stretches() {
            let real = Interval::between(from, to);
            for height in [0.0, 1e-3, 0.1, 0.7, 2.0] {
                let found = (function.complex_interval)(ComplexInterval::varying(real, height));
                bounded += u32::from(height > 0.0 && found.magnitude() < f64::INFINITY);
                for (k, l) in (0..=8).flat_map(|k| (0..=4).map(move |l| (k, l))) {
                    let x = from + (to - from) * f64::from(k) / 8.0;
                    let y = height * (f64::from(l) / 2.0 - 1.0);
                    let value =
                        (function.complex)(Complex::new(x.clamp(from.min(to), from.max(to)), y));
                    let rounding = 1e-14 * (1.0 + value.magnitude());
                    let is_inside = found
                        .real
                        .widened(rounding)
                        .contains(Interval::point(value.real()))
                        && value.imaginary().abs() <= found.height + rounding;
                    assert!(
                        is_inside || found == ComplexInterval::ANYTHING,
                        "{} at {x} + i {y}: {value:?} is not in {found:?}",
                        function.name
                    );
                }
            }
        }
    }
    assert!(bounded > 10_000, "{bounded} rectangles have bounds");
}

#[test]
fn polynomials_have_their_degree() {
    let x = ComplexInterval::varying(Interval::new(-1.0, 2.0), 0.5);
    let two = ComplexInterval::of(2.0);
    assert_eq!((two * x + two).degree(), Some(1));
    assert_eq!((x.square() * x - x / two).degree(), Some(3));
    assert_eq!(two.sqrt().degree(), Some(0));
    assert_eq!((two / (x + two + two)).degree(), None);
    assert_eq!(x.sin().degree(), None);
}

#[test]
fn singular_functions_have_no_bounds() {
    let about = |middle: f64| ComplexInterval::varying(Interval::point(middle).widened(1.0), 1.0);
    for singular in [
        about(0.5).sqrt(),
        about(0.5).ln(),
        about(-0.5).log1p(),
        ComplexInterval::of(1.0) / about(0.5),
        about(0.5).abs(),
        about(0.5).asin(),
        about(0.0).atan(),
        about(0.0).max(ComplexInterval::ZERO),
    ] {
        assert_eq!(singular.magnitude(), f64::INFINITY);
    }
}
