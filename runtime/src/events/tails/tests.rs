//! Bounds of truncation errors against series in closed form.

use super::*;
use crate::math;
use crate::numbers::Numbers;
use nalgebra::SVector;

type One = SVector<f64, 1>;

/// A gap of one position: values, bounds and Taylor coefficients.
struct Known {
    name: &'static str,
    value: fn(f64) -> f64,
    bounds: fn(ComplexInterval) -> ComplexInterval,
    /// Coefficient `k` of the Taylor series about a place.
    coefficient: fn(f64, usize) -> f64,
    /// Range of the starts of steps.
    range: [f64; 2],
}

fn of(number: f64) -> ComplexInterval {
    <ComplexInterval as Numbers>::of(number)
}

fn binomial(exponent: f64, k: usize) -> f64 {
    (0..k).fold(1.0, |product, i| {
        product * (exponent - i as f64) / (i as f64 + 1.0)
    })
}

fn factorial(k: usize) -> f64 {
    (1..=k).fold(1.0, |product, i| product * i as f64)
}

const KNOWN: [Known; 5] = [
    Known {
        name: "sine",
        value: |x| x.sin() - 0.3,
        bounds: |x| Numbers::sin(x) - of(0.3),
        coefficient: |x, k| {
            let turn = x + k as f64 * core::f64::consts::FRAC_PI_2;
            turn.sin() / factorial(k) - if k == 0 { 0.3 } else { 0.0 }
        },
        range: [-40.0, 40.0],
    },
    Known {
        name: "distance",
        value: |x| x.sqrt() - 1.0,
        bounds: |x| Numbers::sqrt(x) - of(1.0),
        coefficient: |x, k| {
            let power = binomial(0.5, k) * x.powf(0.5 - k as f64);
            power - if k == 0 { 1.0 } else { 0.0 }
        },
        range: [0.5, 9.0],
    },
    Known {
        name: "quotient",
        value: |x| 1.0 / x,
        bounds: |x| of(1.0) / x,
        coefficient: |x, k| (-1.0_f64).powi(k as i32) * x.powi(-(k as i32) - 1),
        range: [0.3, 4.0],
    },
    Known {
        name: "bump",
        value: |x| 2.0 - x.exp(),
        bounds: |x| of(2.0) - Numbers::exp(x),
        coefficient: |x, k| (if k == 0 { 2.0 } else { 0.0 }) - x.exp() / factorial(k),
        range: [-3.0, 3.0],
    },
    Known {
        name: "cube",
        value: |x| x * x * x - x,
        bounds: |x| x * x * x - x,
        coefficient: |x, k| match k {
            0 => x * x * x - x,
            1 => 3.0 * x * x - 1.0,
            2 => 3.0 * x,
            3 => 1.0,
            _ => 0.0,
        },
        range: [-2.0, 2.0],
    },
];

/// Largest difference between the gap along `x + way z` and its truncated series, and the sum of the absolute values of
/// the terms.
fn truncated(known: &Known, [x, way]: [f64; 2], order: usize) -> (f64, f64) {
    let terms = |part: f64| {
        (0..=order).map(move |k| (known.coefficient)(x, k) * (way * part).powi(k as i32))
    };
    let parts = (0..=16).map(|k| f64::from(k) / 16.0);
    let missed = parts.map(|part| {
        let sum: f64 = terms(part).sum();
        (sum - (known.value)(x + way * part)).abs()
    });
    let size = terms(1.0).map(f64::abs).sum();
    (missed.fold(0.0, f64::max), size)
}

#[test]
fn missing_terms_are_within_their_bounds() {
    for known in &KNOWN {
        let mut tails = Tails::new(1, &One::zeros(), &One::zeros());
        let gap = |_: ComplexInterval, component: &dyn Fn(usize) -> ComplexInterval| {
            (known.bounds)(component(0))
        };
        let (mut bounded, mut close) = (0, 0);
        // Steps of many lengths from many places, in the order of a motion back and forth.
        for k in 0..600_u32 {
            let share = math::sin(0.37 * f64::from(k));
            let [low, high] = known.range;
            let x = 0.5 * (low + high) + 0.5 * (high - low) * share;
            let way = 0.002 * f64::from(1 + k % 97) * (high - low) / (1.0 + f64::from(k % 7));
            let order = 6 + (k as usize) % 20;
            let mut terms = [One::zeros(); LENGTH];
            (terms[0], terms[1]) = (One::new(x), One::new(way));
            let path = Path::of(&terms[..=order], 1.0);
            tails.count();
            tails.follow(&path);
            let (missed, size) = truncated(known, [x, way], order);
            if tails.skips(0) {
                continue;
            }
            let Some(tail) = tails.of(0, (order, size), (&gap, &path), &mut 0) else {
                continue;
            };
            let rounding = 64.0 * f64::EPSILON * size;
            assert!(
                missed <= tail.value + tail.floor + rounding,
                "{} from {x} by {way} to order {order}: {missed:e} of {tail:?}",
                known.name
            );
            bounded += 1;
            close += u32::from(tail.value <= 1e-6 * size);
        }
        assert!(
            bounded > 60 && close > 20,
            "{}: {bounded}, {close}",
            known.name
        );
    }
}

#[test]
fn a_polynomial_that_is_whole_lacks_nothing() {
    let mut tails = Tails::new(1, &One::zeros(), &One::zeros());
    let gap = |_: ComplexInterval, component: &dyn Fn(usize) -> ComplexInterval| {
        component(0).square() - of(1.0)
    };
    let mut terms = [One::zeros(); 5];
    (terms[0], terms[1], terms[2]) = (One::new(2.0), One::new(0.1), One::new(0.02));
    let path = Path::of(&terms, 1.0);
    tails.follow(&path);
    let tail = tails.of(0, (4, 3.0), (&gap, &path), &mut 0);
    assert!(tail.is_some_and(|tail| tail.value < 1e-12), "{tail:?}");
    let tail = tails.of(0, (3, 3.0), (&gap, &path), &mut 0);
    assert!(tail.is_none_or(|tail| tail.value > 1e-9), "{tail:?}");
}
