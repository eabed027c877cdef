//! Models of functions along paths against values of the functions.

use super::*;
use crate::interval::tests::{FUNCTIONS, Sample};

/// Two paths between two numbers: a straight line and a parabola.
fn paths(from: f64, to: f64) -> [TaylorModel; 2] {
    let (middle, half) = (0.5 * (from + to), 0.5 * (to - from));
    let exact = |powers: [f64; 4]| TaylorModel {
        error: 8.0 * f64::EPSILON * (middle.abs() + half.abs()),
        ..TaylorModel::exact(powers)
    };
    [
        exact([middle, half, 0.0, 0.0]),
        exact([middle - 0.25 * half, half, 0.25 * half, 0.0]),
    ]
}

fn cubic(model: &TaylorModel, s: f64) -> f64 {
    let horner = |sum: f64, power: &f64| sum * s + power;
    model.powers.iter().rev().fold(0.0, horner)
}

#[test]
fn functions_along_paths_stay_by_their_cubics() {
    for function in FUNCTIONS {
        for Sample { from, to } in function.stretches() {
            for path in paths(from, to) {
                let found = (function.model)(path);
                let value = |s: f64| {
                    let x = cubic(&path, s).clamp(from.min(to), from.max(to));
                    (function.plain)(x)
                };
                let remainder = |s: f64| value(s) - cubic(&found, s);
                for k in 0..=16 {
                    let s = f64::from(k) / 8.0 - 1.0;
                    let name = function.name;
                    let (here, before) = (remainder(s), remainder(s - 0.125));
                    assert!(
                        here.abs() <= found.error,
                        "{name} from {from} to {to}: {here:e} of {found:?}"
                    );
                    assert!(found.range().contains(Interval::point(value(s))));
                    let slack = 1e-12 * (1.0 + cubic(&found, s).abs());
                    assert!(
                        k == 0 || (here - before).abs() <= 0.125 * found.slope + slack,
                        "{name} from {from} to {to}: {:e} of {found:?}",
                        (here - before) / 0.125
                    );
                }
            }
        }
    }
}

#[test]
fn errors_fall_with_the_fourth_power_of_the_stretch() {
    let smooth = |width: f64| {
        let x = TaylorModel::exact([0.7, width, 0.0, 0.0]);
        let y = TaylorModel::exact([0.3, width, width * width, 0.0]);
        let distance = (x.square() + y.square()).sqrt() / x;
        (distance + x.sin() * y.exp() - x.powf(1.5).atan()).error
    };
    let ratio = smooth(0.1) / smooth(0.05);
    assert!(ratio > 14.0, "{ratio}");
    assert!(smooth(0.05) < 1e-3, "{}", smooth(0.05));
}

#[test]
fn distances_through_the_origin_have_values() {
    let x = TaylorModel::exact([0.0, 1.0, 0.0, 0.0]);
    let distance = (x.square() + TaylorModel::of(0.0).square()).sqrt();
    let range = distance.range();
    assert!(range.lo >= 0.0 && range.hi < 1.1, "{range:?}");
}

#[test]
fn a_long_flight_past_a_disk_is_one_stretch() {
    // Along x = 0.7 + 9 s, y = 1.3 + 4 s the least distance from the origin is 8.9/sqrt(97).
    let x = TaylorModel::exact([0.7, 9.0, 0.0, 0.0]);
    let y = TaylorModel::exact([1.3, 4.0, 0.0, 0.0]);
    let distance = (x.square() + y.square()).sqrt();
    let range = distance.range();
    assert!(range.lo > 0.9036 && range.lo < 0.9037, "{range:?}");
    assert!(range.hi > 11.05 && range.hi < 11.06, "{range:?}");
    let gap = (distance - TaylorModel::of(0.9)) * TaylorModel::of(2.0);
    assert!(gap.range().lo > 0.006 && (-gap).range().hi < -0.006);
    assert!((gap.square() + x * TaylorModel::of(1e-9)).range().lo > 3e-5);
}

#[test]
fn parabolas_have_their_exact_range() {
    for first in [-3.0, -1.0, 0.0, 0.5, 2.0, 4.0] {
        for second in [-2.0, -0.5, 0.0, 0.25, 1.0] {
            let model = TaylorModel::exact([0.3, first, second, 0.0]);
            let values = (0..=2000).map(|k| cubic(&model, f64::from(k) / 1000.0 - 1.0));
            let (mut least, mut most) = (f64::INFINITY, f64::NEG_INFINITY);
            for value in values {
                (least, most) = (least.min(value), most.max(value));
            }
            let range = model.range();
            assert!(range.contains(Interval::new(least, most)));
            assert!(range.width() < most - least + 1e-5, "{model:?} {range:?}");
        }
    }
}

#[test]
fn a_function_that_may_have_no_value_has_the_whole_line() {
    let stretch = |lo: f64, hi: f64| paths(lo, hi)[0];
    let is_vague = |model: TaylorModel| model.error.is_nan() || model.error > 1e9;
    for outside in [
        stretch(-0.1, 0.2).sqrt(),
        stretch(-0.1, 0.2).ln(),
        stretch(-1.1, -0.8).log1p(),
        stretch(0.9, 1.1).asin(),
        stretch(0.9, 1.1).acos(),
        stretch(1.5, 1.6).tan(),
        TaylorModel::of(1.0) / stretch(-1.0, 1.0),
        TaylorModel::ANYTHING.sin() * TaylorModel::ANYTHING,
    ] {
        assert!(is_vague(outside), "{outside:?}");
        assert!(is_vague(TaylorModel::ZERO * outside));
        assert!((outside - TaylorModel::of(1.0)).range().is_whole());
    }
}
