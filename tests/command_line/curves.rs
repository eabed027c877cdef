//! Bifurcation curves over two parameters, compared with closed forms.

use super::folder::Folder;
use super::tables::{column, numbers_of};
use super::*;

/// A clock that maps a point of the plane at every tick, with folds, flips and Neimark-Sacker bifurcations.
const SQUARE: &str = "
    Square {
        coordinates { x; y; tau; }
        parameters { a = 0.5; b = 0.3; }
        field { dot(x) = 0; dot(y) = 0; dot(tau) = 1; }
        impacts { tick: tau <= 1 => reset { x = y; y = a - x^2 - b*y; tau = 0; }; }
        initial { x = 0.3; y = 0.3; until = 10; }
    }";

/// Fixed points on the paraboloid `x^2 + r^2 + s = 1`.
const DOME: &str = "
    Dome {
        coordinates { x; tau; }
        parameters { r = 0; s = 0; }
        field { dot(x) = 0; dot(tau) = 1; }
        impacts { tick: tau <= 1 => reset { x = x + (1 - x^2 - r^2 - s)/4; tau = 0; }; }
        initial { x = 0.9; until = 10; }
    }";

/// Mathieu's equation as a first-order system.
const MATHIEU: &str = "
    Mathieu {
        coordinates { x; v; phi; }
        parameters { delta = 0.6; eps = 0.2; }
        field { dot(x) = v; dot(v) = -(delta + eps*cos(phi))*x; dot(phi) = 1; }
        impacts { period: phi <= pi => reset { phi = -pi; }; }
        initial { until = 60; }
    }";

/// An arc of height `r*s` between two ticks, a ceiling at the height 1, and a flip at `s = 2.1 - r`.
const ARC: &str = "
    Arc {
        coordinates { y; z; tau; }
        parameters { r = 0.5; s = 0.5; }
        field { dot(y) = 4*r*s*(1 - 2*tau); dot(z) = 0; dot(tau) = 1; }
        impacts {
            ceiling: y <= 1 => reset { };
            tick: tau <= 1 => reset { y = y/2; z = z*(1.1 - r - s); tau = 0; };
        }
        initial { until = 10; }
    }";

fn follow(text: &str, flags: &str) -> Done {
    let line = format!("orbit - {flags}");
    run_on(text, &line.split_whitespace().collect::<Vec<_>>())
}

/// The curves in the JSON document.
fn curves(text: &str, flags: &str) -> Vec<Value> {
    let done = follow(text, &format!("{flags} --json -"));
    assert_eq!((done.exit, done.errors.as_str()), (Exit::Reached, ""));
    done.json()["curves"].as_array().unwrap().clone()
}

/// The only curve of one kind.
fn only<'a>(curves: &'a [Value], kind: &str) -> &'a Value {
    let mut found = curves.iter().filter(|curve| curve["bifurcation"] == kind);
    let only = found
        .next()
        .unwrap_or_else(|| panic!("{kind} in {curves:?}"));
    assert!(found.next().is_none(), "{kind}");
    only
}

/// The points of a curve in the plane of the parameters.
fn places(curve: &Value) -> Vec<[f64; 2]> {
    let points = curve["points"].as_array().unwrap().iter();
    let place = |point: &Value| ["parameter", "second"].map(|key| point[key].as_f64().unwrap());
    points.map(place).collect()
}

/// Asserts that the points of a curve satisfy an equation up to `bound`.
fn assert_on(curve: &Value, bound: f64, equation: impl Fn([f64; 2]) -> f64) {
    let places = places(curve);
    assert!(places.len() > 5, "{places:?}");
    for place in places {
        let value = equation(place);
        assert!(value.abs() < bound, "{value:e} at {place:?}");
    }
}

fn ends(curve: &Value) -> Vec<&str> {
    let ends = curve["ends"].as_array().unwrap().iter();
    ends.map(|end| end["kind"].as_str().unwrap()).collect()
}

#[test]
fn folds_flips_and_circles_of_a_map_of_the_plane() {
    let flags = "--surface tick --continue a=-2..3 --across b=-0.8..0.8";
    let curves = curves(SQUARE, flags);
    assert_eq!(curves.len(), 3);
    let fold = only(&curves, "fold");
    assert_on(fold, 1e-10, |[a, b]| a + (1.0 + b).powi(2) / 4.0);
    let flip = only(&curves, "flip");
    assert_on(flip, 1e-10, |[a, b]| {
        a - (b - 1.0).powi(2) / 4.0 - b.mul_add(b, -1.0) / 2.0
    });
    let circle = only(&curves, "neimark_sacker");
    assert_on(circle, 1e-10, |[a, b]| a - 0.75 - b / 2.0);
    for curve in [fold, flip, circle] {
        let places = places(curve);
        assert_eq!(ends(curve), ["range", "range"]);
        assert_eq!([places[0][1], places[places.len() - 1][1]], [-0.8, 0.8]);
    }
}

#[test]
fn a_circle_ends_at_a_strong_resonance() {
    let curves = curves(SQUARE, "--surface tick --continue a=-2..3 --across b=3..-3");
    let circle = only(&curves, "neimark_sacker");
    assert_eq!(ends(circle), ["resonance", "resonance"]);
    let places = places(circle);
    let [first, last] = [places[0], places[places.len() - 1]];
    // Both multipliers are -1 at `b = 2`, and 1 at `b = -2`.
    for (place, [a, b]) in [(first, [1.75, 2.0]), (last, [-0.25, -2.0])] {
        assert!((place[0] - a).abs() < 1e-2, "{place:?}");
        assert!((place[1] - b).abs() < 1e-2, "{place:?}");
    }
}

#[test]
fn a_curve_ends_where_the_first_parameter_leaves_its_range() {
    let curves = curves(
        SQUARE,
        "--surface tick --continue a=0.2..1 --across b=-1.9..1.9",
    );
    let circle = only(&curves, "neimark_sacker");
    assert_eq!(ends(circle), ["range", "range"]);
    let places = places(circle);
    let [first, last] = [places[0], places[places.len() - 1]];
    assert_eq!([first[0], last[0]], [0.2, 1.0]);
    assert!((first[1] + 1.1).abs() < 1e-10 && (last[1] - 0.5).abs() < 1e-10);
}

#[test]
fn bifurcations_on_one_curve_give_it_once() {
    let curves = curves(DOME, "--surface tick --continue r=-2..2 --across s=-1..2");
    assert_eq!(curves.len(), 1);
    assert_on(&curves[0], 1e-10, |[r, s]| r * r + s - 1.0);
    let places = places(&curves[0]);
    let [first, last] = [places[0], places[places.len() - 1]];
    assert_eq!([first[1], last[1]], [-1.0, -1.0]);
    assert!((first[0] + last[0]).abs() < 1e-10);
}

/// The boundaries of the first tongue are a quarter of the characteristic values `b_1` and `a_1` at `q = 2 eps`,
/// computed by bisection of the three-term recurrence with 40 digits.
#[test]
fn the_first_tongue_of_mathieus_equation() {
    let flags = "--surface period --continue delta=-0.2..0.6 --across eps=0.1..0.5";
    let curves = curves(MATHIEU, flags);
    let flips: Vec<&Value> = curves
        .iter()
        .filter(|it| it["bifurcation"] == "flip")
        .collect();
    assert_eq!(flips.len(), 2);
    let known = [
        [0.198_780_967_020_965, -0.027_562_204_248_023],
        [0.298_718_514_801_115, 0.464_777_018_128_590],
    ];
    for (flip, [first, last]) in flips.into_iter().zip(known) {
        let places = places(flip);
        let found = [places[0], places[places.len() - 1]];
        for (place, [delta, eps]) in found.into_iter().zip([[first, 0.1], [last, 0.5]]) {
            assert_eq!(place[1], eps);
            assert!((place[0] - delta).abs() < 1e-10, "{place:?} for {delta}");
        }
    }
}

#[test]
fn a_curve_ends_where_the_orbit_grazes() {
    let curves = curves(ARC, "--surface tick --continue r=0.2..4 --across s=0.1..3");
    let flip = only(&curves, "flip");
    assert_on(flip, 1e-10, |[r, s]| r + s - 2.1);
    assert_eq!(ends(flip), ["range", "grazing"]);
    // On the flip, `r*s = 1` at `s = (2.1 - sqrt(0.41))/2`.
    let graze = places(flip).pop().unwrap()[1];
    assert!((graze - 0.729_843_788_1).abs() < 1e-4, "{graze}");
}

#[test]
fn files_tell_the_same_curves() {
    let folder = Folder::new("curves");
    let [csv, json, svg] = ["c.csv", "c.json", "c.svg"].map(|name| folder.path(name));
    let flags = format!(
        "--surface tick --continue a=-2..3 --across b=-0.8..0.8 --csv {csv} --json {json} --plot {svg}"
    );
    let done = follow(SQUARE, &flags);
    assert_eq!((done.exit, done.errors.as_str()), (Exit::Reached, ""));
    let table = folder.read("c.csv");
    let document: Value = serde_json::from_str(&folder.read("c.json")).unwrap();
    let curves = document["curves"].as_array().unwrap();
    let all: Vec<[f64; 2]> = curves.iter().flat_map(places).collect();
    let columns = ["in.a", "in.b"].map(|name| numbers_of(&table, name));
    assert_eq!(all.iter().map(|at| at[0]).collect::<Vec<f64>>(), columns[0]);
    assert_eq!(all.iter().map(|at| at[1]).collect::<Vec<f64>>(), columns[1]);
    let numbers = column(&table, "curve");
    assert_eq!([&numbers[0], &numbers[numbers.len() - 1]], ["1", "3"]);
    assert_eq!(document["across"]["parameter"], "b");
    let svg = folder.read("c.svg");
    for word in ["fold", "flip", "Neimark-Sacker", "section tick, 1 return"] {
        assert!(svg.contains(word), "{word}");
    }
    for line in [
        "across       b from -0.8 to 0.8",
        "curve 1",
        "end        a = ",
    ] {
        assert!(done.output.contains(line), "{line} in {}", done.output);
    }
}

#[test]
fn unusable_flags_are_refused() {
    let refused = |flags: &str, part: &str| {
        let done = follow(SQUARE, &format!("--surface tick {flags}"));
        assert_eq!(done.exit, Exit::Refused, "{flags}: {}", done.output);
        assert!(done.errors.contains(part), "{flags}: {}", done.errors);
    };
    refused("--across b=0..1", "--continue");
    refused(
        "--continue a=0..1 --across a=0..1",
        "other than that of --continue",
    );
    refused(
        "--continue a=0..1 --across c=0..1",
        "--across: unknown parameter `c`",
    );
    refused("--continue a=0..1 --across b=1", "expected NAME=A..B");
    refused("--continue a=0..1 --across b=1..1", "two different ends");
    let axis = "--continue a=0..1 --across b=0..1 --plot c.svg --axis x";
    refused(axis, "--axis");
    // A branch without bifurcations has no curves.
    let done = follow(
        SQUARE,
        "--surface tick --continue a=0.5..0.6 --across b=0..0.1 --json -",
    );
    assert_eq!(done.exit, Exit::Reached);
    assert_eq!(done.json()["curves"], serde_json::json!([]));
}
