//! Branches of periodic orbits: bifurcations, ends and multipliers known in closed form, and refused flags.

use std::f64::consts::TAU;
use std::fs;

use dalembert_driver::BranchEnd;

use super::folder::Folder;
use super::tables::{column, numbers_of};
use super::*;

/// The logistic map: a clock ticks once per unit of time, and each tick applies the map.
const LOGISTIC: &str = "
    Logistic {
        coordinates { x; tau; }
        parameters { r = 2.5; idle > 0 = 1; }
        field { dot(x) = 0; dot(tau) = 1; }
        impacts { tick: tau <= 1 => reset { x = r*x*(1 - x); tau = 0; }; }
        initial { x = 0.6; until = 10; }
        outputs { square: x^2; }
    }";

/// A parabola of fixed points, with a fold at `r = 0` and a flip at `r = 1`.
const PARABOLA: &str = "
    Parabola {
        coordinates { x; tau; }
        parameters { r = 0.5; }
        field { dot(x) = 0; dot(tau) = 1; }
        impacts { tick: tau <= 1 => reset { x = x + r - x^2; tau = 0; }; }
        initial { x = 0.7; until = 10; }
    }";

/// The delayed logistic map. Its fixed point has a Neimark-Sacker bifurcation at `r = 2`.
const DELAYED: &str = "
    Delayed {
        coordinates { x; y; tau; }
        parameters { r = 1.8; }
        field { dot(x) = 0; dot(y) = 0; dot(tau) = 1; }
        impacts { tick: tau <= 1 => reset { x = r*x*(1 - y); y = x; tau = 0; }; }
        initial { x = 0.44; y = 0.44; until = 10; }
    }";

/// Fixed points on the circle `x^2 + r^2 = 1`.
const CIRCLE: &str = "
    Circle {
        coordinates { x; tau; }
        parameters { r = 0; }
        field { dot(x) = 0; dot(tau) = 1; }
        impacts { tick: tau <= 1 => reset { x = x + (1 - x^2 - r^2)/4; tau = 0; }; }
        initial { x = 0.9; until = 10; }
    }";

/// A pitchfork bifurcation at `r = 1`: the fixed point 0 becomes unstable, and two stable ones appear.
const PITCHFORK: &str = "
    Pitchfork {
        coordinates { x; tau; }
        parameters { r = 1.5; }
        field { dot(x) = 0; dot(tau) = 1; }
        impacts { tick: tau <= 1 => reset { x = r*x - x^3; tau = 0; }; }
        initial { x = 0.7; until = 10; }
    }";

/// The Henon map. Its fixed point has a flip at `a = 3 (1 - b)^2/4` and a fold at `a = -(1 - b)^2/4`.
const HENON: &str = "
    Henon {
        coordinates { x; y; tau; }
        parameters { a = 0.2; b = 0.3; }
        field { dot(x) = 0; dot(y) = 0; dot(tau) = 1; }
        impacts { tick: tau <= 1 => reset { x = 1 - a*x^2 + y; y = b*x; tau = 0; }; }
        initial { x = 0.8; y = 0.2; until = 10; }
    }";

/// A linear map with the multipliers `+-i k (1 + sqrt(2))` and `+-i k (sqrt(2) - 1)`.
const LINEAR: &str = "
    Linear {
        coordinates { x; y; z; w; tau; }
        parameters { k = 0.3; }
        field { dot(x) = 0; dot(y) = 0; dot(z) = 0; dot(w) = 0; dot(tau) = 1; }
        impacts {
            tick: tau <= 1 => reset {
                tau = 0; x = k*(2*y + z); y = -k*(2*x + w); z = -k*x; w = k*y;
            };
        }
        initial { x = 0.1; until = 10; }
    }";

/// Circles of radius `sqrt(r/c)` around an equilibrium, which they reach at `r = 0`.
const HOPF: &str = "
    Hopf {
        coordinates { x; y; }
        parameters { r = 0.5; c = 1; }
        let growth = r - c*(x^2 + y^2);
        field { dot(x) = x*growth - y; dot(y) = y*growth + x; }
        impacts { line: y >= 0 => reset { }; }
        initial { x = -0.7; y = 0.001; until = 50; }
    }";

/// A motion that rises by `r` and falls between two ticks, below a ceiling at height 1.
const ARC: &str = "
    Arc {
        coordinates { y; tau; }
        parameters { r = 0.5; }
        field { dot(y) = 4*r*(1 - 2*tau); dot(tau) = 1; }
        impacts { ceiling: y <= 1 => reset { }; tick: tau <= 1 => reset { y = y/2; tau = 0; }; }
        initial { until = 10; }
    }";

/// A driven oscillator with a stop.
const STOP: &str = "
    Stop {
        coordinates { x; v; phi: angle; }
        parameters { stop = 2; w = 1.6; rho = 0.8; }
        field { dot(x) = v; dot(v) = cos(phi) - x; dot(phi) = w; }
        impacts { wall: x <= stop => reset { v = -rho*v; }; }
        initial { x = 2; v = -5; phi = 2.7; until = 100; }
    }";

/// Fixed points on a spiral with two arms: `x/r = tan(237 rho)` with the radius `rho = sqrt(x^2 + r^2)`. Neighbouring
/// sheets are `pi/237` apart.
const SPIRAL: &str = "
    Spiral {
        coordinates { x; tau; }
        parameters { r = 0; }
        let turn = 237*sqrt(x^2 + r^2);
        field { dot(x) = 0; dot(tau) = 1; }
        impacts { tick: tau <= 1 => reset { x = x - 0.002*(x*cos(turn) - r*sin(turn)); tau = 0; }; }
        initial { x = 0.6; until = 10; }
    }";

/// Runs `orbit --continue` over a model.
fn follow(text: &str, flags: &str) -> Done {
    let line = format!("orbit - {flags}");
    run_on(text, &line.split_whitespace().collect::<Vec<_>>())
}

/// The rows of a branch.
fn rows(text: &str, flags: &str) -> String {
    let done = follow(text, &format!("{flags} --csv -"));
    assert_eq!((done.exit, done.errors.as_str()), (Exit::Reached, ""));
    done.output
}

/// The bifurcations of a table: kind and parameter.
fn bifurcations(table: &str, parameter: &str) -> Vec<(String, f64)> {
    let kinds = column(table, "bifurcation").into_iter();
    let pairs = kinds.zip(numbers_of(table, &format!("in.{parameter}")));
    pairs.filter(|(kind, _)| !kind.is_empty()).collect()
}

fn assert_near(found: f64, expected: f64, bound: f64) {
    assert!((found - expected).abs() < bound, "{found} for {expected}");
}

/// Asserts kinds and parameters of all bifurcations.
fn assert_bifurcations(table: &str, parameter: &str, expected: &[(&str, f64)], bound: f64) {
    let found = bifurcations(table, parameter);
    let kinds: Vec<&str> = found.iter().map(|(kind, _)| kind.as_str()).collect();
    let known: Vec<&str> = expected.iter().map(|(kind, _)| *kind).collect();
    assert_eq!(kinds, known, "{found:?}");
    for ((_, found), (_, expected)) in found.iter().zip(expected) {
        assert_near(*found, *expected, bound);
    }
}

/// Asserts the first and the last value of the parameter in a table.
fn assert_ends(table: &str, parameter: &str, ends: [f64; 2]) {
    let values = numbers_of(table, &format!("in.{parameter}"));
    assert_eq!([values[0], values[values.len() - 1]], ends);
}

#[test]
fn a_flip_and_a_crossing_of_the_logistic_map() {
    let table = rows(LOGISTIC, "--surface tick --continue r=0.5..3.5");
    assert_ends(&table, "r", [0.5, 3.5]);
    let expected = [("branch_point", 1.0), ("flip", 3.0)];
    assert_bifurcations(&table, "r", &expected, 1e-9);
    let values = numbers_of(&table, "in.r").into_iter();
    let points = numbers_of(&table, "before.x");
    let multipliers = numbers_of(&table, "multiplier.1.re");
    let stabilities = column(&table, "stability");
    for (index, r) in values.enumerate() {
        assert_near(points[index], 1.0 - 1.0 / r, 1e-9);
        assert_near(multipliers[index], 2.0 - r, 1e-9);
        let expected = match (r - 2.0).abs() {
            distance if (distance - 1.0).abs() < 1e-9 => "neutral",
            distance if distance < 1.0 => "stable",
            _ => "unstable",
        };
        assert_eq!(stabilities[index], expected, "{r}");
    }
    assert_eq!(numbers_of(&table, "period"), vec![1.0; points.len()]);
}

#[test]
fn multipliers_at_bifurcations_lie_on_the_circle_to_rounding() {
    for (index, b) in [-0.5, -0.066, 0.066, 0.3, 0.35, 0.6]
        .into_iter()
        .enumerate()
    {
        let square = f64::powi(1.0 - b, 2);
        // The steps of the continuation depend on its range.
        let to = square * (0.9 + 0.03 * index as f64);
        let flags = format!(
            "--surface tick --set b={b} --continue a={}..{to}",
            -0.3 * square
        );
        let table = rows(HENON, &flags);
        let flips: Vec<f64> = bifurcations(&table, "a")
            .into_iter()
            .filter(|(kind, _)| kind == "flip")
            .map(|(_, a)| a)
            .collect();
        assert_eq!(flips.len(), 1, "{flips:?}");
        assert_near(flips[0], 0.75 * square, 1e-13);
    }
    let table = rows(LINEAR, "--surface tick --continue k=0.1..0.8");
    let expected = [("neimark_sacker", 2f64.sqrt() - 1.0)];
    assert_bifurcations(&table, "k", &expected, 1e-13);
}

/// Neighbouring points of an equilibrium close to rounding, and are no orbits.
#[test]
fn a_branch_ends_where_its_orbit_becomes_an_equilibrium() {
    for (c, start) in [
        (1.0, "0.5"),
        (-1.0, "-0.5"),
        (25.0, "0.3"),
        (-0.04, "-0.02"),
    ] {
        let flags =
            format!("--surface line --set r={start},c={c} --initial x=-0.7 --continue r=-1..1");
        let document = follow(HOPF, &format!("{flags} --json -")).json();
        let ends = document["ends"].as_array().unwrap();
        let end = &ends[usize::from(c < 0.0)];
        assert_eq!(end["kind"], "equilibrium", "{document}");
        let place = end["reason"].as_str().unwrap().rsplit(' ').next().unwrap();
        assert_near(place.parse().unwrap(), 0.0, 1e-9);
        assert_eq!(document["bifurcations"].as_array().unwrap().len(), 0);
        for point in document["points"].as_array().unwrap() {
            let r = point["parameter"].as_f64().unwrap();
            let x = point["before"]["q"][0].as_f64().unwrap();
            assert_near(c * x * x / r, 1.0, 1e-6);
        }
    }
}

#[test]
fn a_branch_from_exactly_the_crossing_meets_it_once() {
    let flags = "--surface tick --set r=1 --initial x=0 --continue r=0.5..1.5";
    let table = rows(LOGISTIC, flags);
    assert_bifurcations(&table, "r", &[("branch_point", 1.0)], 1e-9);
    assert_ends(&table, "r", [0.5, 1.5]);
}

#[test]
fn orbits_of_two_returns_double_their_period_too() {
    let flags = "--surface tick --period 2 --set r=3.2 --initial x=0.51 --continue r=3.1..3.5";
    let table = rows(LOGISTIC, flags);
    assert_bifurcations(&table, "r", &[("flip", 1.0 + 6f64.sqrt())], 1e-9);
    assert_ends(&table, "r", [3.1, 3.5]);
    assert_near(numbers_of(&table, "period")[0], 2.0, 1e-12);
}

#[test]
fn a_branch_goes_on_behind_its_fold() {
    for (range, ends) in [("1.2..-0.5", [1.2; 2]), ("-0.5..1.2", [1.2; 2])] {
        let table = rows(PARABOLA, &format!("--surface tick --continue r={range}"));
        assert_ends(&table, "r", ends);
        let found = bifurcations(&table, "r");
        let mut kinds: Vec<&str> = found.iter().map(|(kind, _)| kind.as_str()).collect();
        kinds.sort_unstable();
        assert_eq!(kinds, ["flip", "fold"]);
        for (kind, r) in &found {
            assert_near(*r, if kind == "fold" { 0.0 } else { 1.0 }, 1e-9);
        }
        let (values, points) = (numbers_of(&table, "in.r"), numbers_of(&table, "before.x"));
        for (r, x) in values.iter().zip(&points) {
            assert_near(x * x, *r, 1e-12);
        }
        assert!(points[0] * points[points.len() - 1] < 0.0);
    }
}

#[test]
fn a_pair_of_multipliers_passes_the_circle() {
    let table = rows(DELAYED, "--surface tick --continue r=1.5..2.2");
    assert_bifurcations(&table, "r", &[("neimark_sacker", 2.0)], 1e-9);
    let kinds = column(&table, "bifurcation");
    let place = kinds.iter().position(|kind| !kind.is_empty()).unwrap();
    let part = |name: &str| numbers_of(&table, &format!("multiplier.1.{name}"))[place];
    assert_near(part("re"), 0.5, 1e-9);
    assert_near(part("im").abs(), 0.75f64.sqrt(), 1e-9);
}

#[test]
fn a_closed_branch_is_followed_once() {
    let done = follow(CIRCLE, "--surface tick --continue r=-2..2 --json -");
    let document = done.json();
    let ends = document["ends"].as_array().unwrap();
    assert_eq!(
        (&ends[0]["kind"], &ends[1]["kind"]),
        (&"closed".into(), &"closed".into())
    );
    let folds = document["bifurcations"].as_array().unwrap();
    let folds: Vec<f64> = folds
        .iter()
        .map(|it| it["parameter"].as_f64().unwrap())
        .collect();
    assert_eq!(folds.len(), 2);
    assert_near(folds[0].abs(), 1.0, 1e-9);
    assert_near(folds[0] + folds[1], 0.0, 1e-9);
}

#[test]
fn sheets_that_lie_close_together_are_not_confused() {
    let table = rows(SPIRAL, "--surface tick --continue r=-2..2 --points 400");
    let folds = bifurcations(&table, "r");
    assert!(folds.len() > 15, "{folds:?}");
    for pair in folds.windows(2) {
        let [(first, at), (second, next)] = pair else {
            panic!("{pair:?}")
        };
        assert_eq!([first, second], ["fold", "fold"]);
        // Consecutive folds are half a turn of the spiral apart.
        assert!(at * next < 0.0, "{at} and {next}");
        assert_near(
            (next.abs() - at.abs()).abs(),
            core::f64::consts::PI / 237.0,
            1e-6,
        );
    }
}

#[test]
fn a_pitchfork_is_one_branch_point() {
    let table = rows(PITCHFORK, "--surface tick --continue r=0.5..1.5");
    assert_ends(&table, "r", [1.5, 1.5]);
    let found = bifurcations(&table, "r");
    assert_eq!(found.len(), 1, "{found:?}");
    assert_eq!(found[0].0, "branch_point");
    assert_near(found[0].1, 1.0, 1e-6);
}

#[test]
fn a_parameter_that_does_not_matter_changes_nothing() {
    let table = rows(LOGISTIC, "--surface tick --continue idle=0.5..4");
    assert_ends(&table, "idle", [0.5, 4.0]);
    assert_eq!(bifurcations(&table, "idle"), []);
    for (x, multiplier) in numbers_of(&table, "before.x")
        .iter()
        .zip(numbers_of(&table, "multiplier.1.re"))
    {
        assert_near(*x, 0.6, 1e-14);
        assert_near(multiplier, -0.5, 1e-13);
    }
}

#[test]
fn a_branch_begins_at_the_nearest_end_of_a_range_beyond_its_start() {
    let table = rows(LOGISTIC, "--surface tick --continue r=2.9..2.7");
    assert_ends(&table, "r", [2.9, 2.7]);
    let done = follow(PARABOLA, "--surface tick --continue r=-2..-1 --json -");
    assert_eq!(done.exit, Exit::Other);
    let document = done.json();
    assert_eq!(document["outcome"]["kind"], "out_of_reach");
    assert_eq!(document["ends"][0]["kind"], "turned");
    assert_eq!(document["points"].as_array().unwrap().len(), 0);
}

#[test]
fn a_branch_ends_where_its_orbit_grazes_a_surface() {
    let done = follow(ARC, "--surface tick --continue r=0.2..2 --json -");
    assert_eq!(done.exit, Exit::Reached, "{}", done.errors);
    let document = done.json();
    let ends = document["ends"].as_array().unwrap();
    assert_eq!(ends[0]["kind"], "range");
    assert_eq!(ends[0]["parameter"], 0.2);
    assert_eq!(
        (&ends[1]["kind"], &ends[1]["surface"]),
        (&"grazing".into(), &"ceiling".into())
    );
    assert_near(ends[1]["parameter"].as_f64().unwrap(), 1.0, 1e-6);
}

#[test]
fn a_branch_ends_where_its_parameter_may_not_go() {
    let done = follow(LOGISTIC, "--surface tick --continue idle=2..-1");
    assert_eq!(done.exit, Exit::Reached);
    assert!(
        done.output.contains("parameter `idle` is"),
        "{}",
        done.output
    );
    let first = done.output.lines().find(|line| line.contains("first end"));
    assert!(first.unwrap().contains("idle = 2: the end of the range"));
}

/// Orbits with one impact per period of the force. Let `G = 1/(1 - w^2)`, `t = tan(pi/w)`, `k = w (1 + e)/(t (1 - e))`,
/// and let `phi` be the phase at the impact. The stop is then at `d = G (cos phi + k sin phi)`, and the impact has the
/// speed `-2 G w sin(phi)/(1 - e)`. There is a fold at `d = |G| sqrt(1 + k^2)` and a grazing impact at `d = |G|`.
#[test]
fn the_driven_oscillator_folds_and_grazes_where_formulas_say() {
    let (w, e) = (1.6, 0.8);
    let g: f64 = 1.0 / (1.0 - w * w);
    let k = w * (1.0 + e) / ((0.5 * TAU / w).tan() * (1.0 - e));
    let done = follow(STOP, "--surface wall --continue stop=0.1..5 --json -");
    assert_eq!(done.exit, Exit::Reached, "{}", done.errors);
    let document = done.json();
    let found = document["bifurcations"].as_array().unwrap();
    let folds: Vec<&Value> = found
        .iter()
        .filter(|it| it["bifurcation"] == "fold")
        .collect();
    assert_eq!(folds.len(), 1, "{found:?}");
    let fold = g.abs() * (1.0 + k * k).sqrt();
    assert_near(folds[0]["parameter"].as_f64().unwrap(), fold, 1e-9);
    let grazes = |end: &&Value| end["kind"] == "grazing" && end["surface"] == "wall";
    let ends = document["ends"].as_array().unwrap();
    let grazing: Vec<&Value> = ends.iter().filter(grazes).collect();
    assert_eq!(grazing.len(), 1, "{ends:?}");
    assert_near(grazing[0]["parameter"].as_f64().unwrap(), g.abs(), 1e-6);
    let points = document["points"].as_array().unwrap();
    assert!(points.len() > 20);
    for point in points {
        let (d, q) = (
            point["parameter"].as_f64().unwrap(),
            numbers(&point["before"]["q"]),
        );
        let (speed, phi) = (q[1], q[2]);
        assert_near(g * (phi.cos() + k * phi.sin()), d, 1e-9);
        assert_near(speed, -2.0 * g * w * phi.sin() / (1.0 - e), 1e-8);
        assert_near(point["period"].as_f64().unwrap(), TAU / w, 1e-9);
        let multipliers = point["multipliers"].as_array().unwrap().iter();
        let parts = multipliers.map(|it| [&it["re"], &it["im"]].map(|part| part.as_f64().unwrap()));
        let [re, _] = parts.fold([1.0, 0.0], |[a, b], [c, d]| [a * c - b * d, a * d + b * c]);
        // The forced motion preserves area. The impact scales deviations of position and of velocity by `e` each.
        if speed > 0.1 {
            assert_near(re, e * e, 1e-7);
        }
    }
}

/// A ball on a floor. An impact halves its speed and then adds `w`. The orbit has the speed `2 w` and the period `4 w`.
const KICKED: &str = "
    Kicked {
        coordinates { x; v; }
        parameters { w = 0.5; }
        field { dot(x) = v; dot(v) = -1; }
        impacts { floor: x >= 0 => reset { v = -v/2 + w; }; }
        initial { x = 5; until = 500; }
    }";

#[test]
fn periods_may_change_by_any_factor_in_both_directions() {
    for range in ["w=0.02..4", "w=4..0.02"] {
        let done = follow(
            KICKED,
            &format!("--surface floor --continue {range} --json -"),
        );
        let document = done.json();
        let ends = document["ends"].as_array().unwrap();
        assert!(
            ends.iter().all(|end| end["kind"] == "range"),
            "{range}: {ends:?}"
        );
        for point in document["points"].as_array().unwrap() {
            let [w, period] = ["parameter", "period"].map(|key| point[key].as_f64().unwrap());
            assert_near(period, 4.0 * w, 1e-9);
        }
    }
}

/// Two equal maps side by side, whose multipliers cross the unit circle in pairs, and two that are nearly equal.
#[test]
fn multipliers_that_pass_the_circle_together_are_a_bifurcation() {
    let twin = |factor: &str, apart: &str| {
        format!(
            "Twin {{
                coordinates {{ x; y; tau; }}
                parameters {{ r = 0.5; }}
                field {{ dot(x) = 0; dot(y) = 0; dot(tau) = 1; }}
                impacts {{ tick: tau <= 1 => reset {{
                    x = {factor}r*x + x^3; y = {factor}(r - {apart})*y + y^3; tau = 0;
                }}; }}
                initial {{ until = 10; }}
            }}"
        )
    };
    for (factor, kind) in [("-", "flip"), ("", "branch_point")] {
        let flags = "--surface tick --continue r=0.3..2";
        let table = rows(&twin(factor, "0"), flags);
        assert_bifurcations(&table, "r", &[(kind, 1.0)], 1e-8);
        let table = rows(&twin(factor, "0.001"), flags);
        assert_bifurcations(&table, "r", &[(kind, 1.0), (kind, 1.001)], 1e-8);
    }
}

/// A driven oscillator with the amplitude `F/sqrt((1 - w^2)^2 + c^2 w^2)`. The orbit does not meet the wall until its
/// amplitude, which grows with `F`, is 1.
#[test]
fn an_orbit_grazes_a_wall_that_it_has_not_met() {
    let text = "
        Driven {
            coordinates { x; v; phi: angle; }
            parameters { F = 0.5; w = 2; c = 0.2; e = 0.5; }
            field { dot(x) = v; dot(v) = -c*v - x + F*cos(phi); dot(phi) = w; }
            impacts { round: sin(phi) >= 0 => reset { }; wall: x <= 1 => reset { v = -e*v; }; }
            initial { phi = 1; until = 500; }
        }";
    for w in [1.5_f64, 2.0, 3.0] {
        let flags = format!("--surface round --continue F=0.1..10 --set w={w} --json -");
        let document = follow(text, &flags).json();
        let end = &document["ends"][1];
        assert_eq!(
            [&end["kind"], &end["surface"]],
            ["grazing", "wall"],
            "{end}"
        );
        let known = f64::hypot(1.0 - w * w, 0.2 * w);
        assert_near(end["parameter"].as_f64().unwrap(), known, 1e-6);
    }
}

#[test]
fn files_tell_the_same_branch() {
    let folder = Folder::new("branch");
    let [csv, json, svg] = ["b.csv", "b.json", "b.svg"].map(|name| folder.path(name));
    let flags = format!(
        "--surface tick --continue r=2..3.5 --csv {csv} --json {json} --plot {svg} --axis square"
    );
    let done = follow(LOGISTIC, &flags);
    assert_eq!((done.exit, done.errors.as_str()), (Exit::Reached, ""));
    let (table, svg) = (folder.read("b.csv"), folder.read("b.svg"));
    let document: Value = serde_json::from_str(&folder.read("b.json")).unwrap();
    let points = document["points"].as_array().unwrap();
    let values: Vec<f64> = points
        .iter()
        .map(|it| it["parameter"].as_f64().unwrap())
        .collect();
    assert_eq!(values, numbers_of(&table, "in.r"));
    assert_eq!(document["parameter"], "r");
    assert_eq!(numbers(&document["range"]), [2.0, 3.5]);
    for word in [
        "logistic",
        "stable",
        "unstable",
        "flip",
        "square",
        "section tick, 1 return",
    ] {
        assert!(svg.contains(word), "{word}");
    }
    // The label of the axis is on a line of its own.
    assert!(svg.lines().any(|line| line == "r"), "{svg}");
    for line in [
        "continued    r from 2 to 3.5",
        "flip           r = 3",
        "last end     r = 3.5: the end",
    ] {
        assert!(done.output.contains(line), "{line} in {}", done.output);
    }
    // The table has one line for each point, below the header.
    let lines = done
        .output
        .lines()
        .skip_while(|line| !line.is_empty())
        .count();
    assert_eq!(lines, values.len() + 2);
    fs::metadata(folder.path("b.svg")).unwrap();
}

#[test]
fn few_steps_end_a_branch_early() {
    let flags = "--surface tick --continue r=0.5..3.5 --points 3";
    let done = follow(LOGISTIC, flags);
    assert_eq!(done.exit, Exit::Reached);
    assert_eq!(
        done.output
            .matches("the number of steps in --points")
            .count(),
        2
    );
}

/// The guide and the schema list the same kinds of ends as the code.
#[test]
fn every_end_is_in_the_guide_and_in_the_schema() {
    let page = include_str!("../../docs/guide/continuation.md");
    let (_, table) = page
        .split_once("| end | meaning |")
        .expect("the table of ends");
    let rows = table
        .lines()
        .skip(2)
        .take_while(|line| line.starts_with('|'));
    let told: Vec<&str> = rows.filter_map(|row| row.split('`').nth(1)).collect();
    assert_eq!(told, BranchEnd::KINDS);
    let schema = include_str!("../../docs/reference/schemas/branch.json");
    let schema: Value = serde_json::from_str(schema).unwrap();
    let kinds = &schema["$defs"]["end"]["properties"]["kind"]["enum"];
    assert_eq!(*kinds, serde_json::json!(BranchEnd::KINDS));
}

#[test]
fn unusable_flags_are_refused() {
    let refused = |flags: &str, part: &str| {
        let done = follow(LOGISTIC, flags);
        assert_eq!(done.exit, Exit::Refused, "{flags}: {}", done.output);
        assert!(done.errors.contains(part), "{flags}: {}", done.errors);
    };
    let with = |range: &str| format!("--surface tick --continue {range}");
    refused(&with("q=0..1"), "--continue: unknown parameter `q`");
    refused(&with("x=0..1"), "--continue: unknown parameter `x`");
    refused(&with("r"), "expected NAME=A..B");
    refused(&with("r=1"), "expected NAME=A..B");
    refused(&with("r=1..1"), "two different ends");
    refused(&with("r=1..inf"), "expected a finite number");
    refused(&with("r=1..2:5"), "expected a finite number");
    refused(
        &with("r=2..3 --axis z --plot none.svg"),
        "--axis: unknown quantity `z`",
    );
    refused(&with("r=2..3 --plot none.png"), "ends in .svg");
    refused(&with("r=2..3 --csv - --json -"), "need different files");
    refused("--surface tick --csv -", "--continue");
    refused("--surface tick --plot b.svg", "--continue");
    refused("--continue r=2..3", "--surface");
    refused("--surface tock --continue r=2..3", "unknown surface `tock`");
    let done = follow(
        LOGISTIC,
        "--surface tick --initial x=0.6,tau=2 --continue r=2..3 --json -",
    );
    assert_ne!(done.exit, Exit::Reached);
}

#[test]
fn a_branch_that_is_not_found_leaves_old_files() {
    let folder = Folder::new("kept");
    let csv = folder.path("old.csv");
    fs::write(&csv, "old").unwrap();
    let done = follow(
        LOGISTIC,
        &format!("--surface tick --initial x=0.6,tau=2 --continue r=2..3 --csv {csv}"),
    );
    assert_ne!(done.exit, Exit::Reached);
    assert_eq!(folder.read("old.csv"), "old");
    let done = follow(
        LOGISTIC,
        &format!("--surface tick --continue r=2..3 --csv {csv}"),
    );
    assert_eq!(done.exit, Exit::Reached);
    assert!(folder.read("old.csv").starts_with("in.r,"));
}
