//! Tests of motions between two configurations, which are compared with closed forms, and of refused flags.

// A test may fail by panicking.
#![allow(clippy::unwrap_used)]

mod support;

use dalembert_cli::Exit;
use serde_json::Value;
use support::{Done, run_on};

/// A point in a rectangle whose walls reduce the normal speed by the factor e.
const BOX: &str = "
    Table {
        coordinates { x; y; }
        parameters { a > 0 = 2; b > 0 = 1; e in [0, 1] = 1; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2;
        impacts {
            left: x >= 0 => newton(e); right: a - x >= 0 => newton(e);
            bottom: y >= 0 => newton(e); top: b - y >= 0 => newton(e);
        }
    }";

/// A linear oscillator with the frequency w along x and 2 w along y. All motions from the origin are there again after
/// half a period of x.
const SPRING: &str = "
    Spring {
        coordinates { x; y; }
        parameters { w > 0 = 1; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2 - w^2*x^2/2 - 2*w^2*y^2;
    }";

/// A charge in a magnetic field: its Lagrangian has a term that is linear in a velocity.
const DRIFT: &str = "
    Drift {
        coordinates { x; y; }
        parameters { B = 0.7; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2 + B*x*dot(y);
    }";

/// A point in the plane that a constraint holds on a circle.
const ROD: &str = "
    Rod {
        coordinates { x; y; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2;
        constraints { rod: d(x^2 + y^2) = 0; }
        frame { turn: x*d(y) - y*d(x); }
        initial { x = 1; }
    }";

/// A ball in the plane between a floor and a wall.
const SHELF: &str = "
    Shelf {
        coordinates { x; z; }
        parameters { g > 0 = 1; }
        lagrangian = (dot(x)^2 + dot(z)^2)/2 - g*z;
        impacts { floor: z >= 0; wall: 1 - x >= 0; }
    }";

/// Runs `connect` with this standard input.
fn connect_on(input: &str, line: &str) -> Done {
    run_on(input, &format!("connect {line}"))
}

/// The motions of a document.
fn motions_on(input: &str, line: &str) -> Vec<Value> {
    let done = connect_on(input, &format!("{line} --json -"));
    assert_eq!(done.exit, Exit::Reached, "{}", done.errors);
    let document: Value = serde_json::from_str(&done.output).unwrap();
    document["motions"].as_array().unwrap().clone()
}

fn motions(line: &str) -> Vec<Value> {
    motions_on("", line)
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap()
}

fn count(motion: &Value) -> usize {
    motion["impacts"].as_array().unwrap().len()
}

/// The first velocity at the start.
fn speed(motion: &Value) -> f64 {
    number(&motion["start"]["qdot"][0])
}

#[track_caller]
fn assert_near(found: f64, expected: f64, within: f64) {
    assert!((found - expected).abs() <= within, "{found} and {expected}");
}

/// Velocities `v` at the start and actions of the motions of a ball with `m = g = 1` from 0 at `t = 0` to `x` at `t`, with
/// `k` impacts. Every flight takes `2 v`, and `x = v s - s^2/2` with the time `s = t - 2 k v` since the last impact.
fn closed(x: f64, t: f64, k: f64) -> Vec<[f64; 2]> {
    let root = (t * t - 8.0 * k * (k + 1.0) * x).sqrt();
    let velocities = match k {
        0.0 => vec![x / t + 0.5 * t],
        _ => [-1.0, 1.0]
            .map(|side| ((1.0 + 2.0 * k) * t + side * root) / (4.0 * k * (k + 1.0)))
            .to_vec(),
    };
    // L = v^2/2 - 2 v s + s^2 along a flight.
    let flight = |v: f64, s: f64| v * v * s / 2.0 - v * s * s + s * s * s / 3.0;
    let action = |v: f64| k * flight(v, 2.0 * v) + flight(v, t - 2.0 * k * v);
    velocities.into_iter().map(|v| [v, action(v)]).collect()
}

#[test]
fn the_seven_motions_of_the_ball() {
    let found = motions("bouncing_ball --from x=0 --to x=0.2 --time 5 --impacts 0..3");
    let expected = [
        [0.0, 2.54, -5.704_333_333_333_333],
        [1.0, 1.291_369_123_503_562_4, -1.539_814_194_880_540_9],
        [1.0, 2.458_630_876_496_437_6, -4.720_602_471_786_126],
        [2.0, 0.878_154_859_413_761_8, -0.723_860_057_984_162],
        [2.0, 1.205_178_473_919_571_5, -1.073_593_645_719_541_8],
        [3.0, 0.678_993_355_921_698_8, -0.417_132_848_961_256_7],
        [3.0, 0.779_339_977_411_634_6, -0.445_425_021_409_113_6],
    ];
    assert_eq!(found.len(), expected.len());
    for (motion, [impacts, velocity, action]) in found.iter().zip(expected) {
        assert_eq!(count(motion) as f64, impacts);
        assert_near(speed(motion), velocity, 1e-13);
        assert_near(number(&motion["action"]), action, 1e-13);
        assert_near(number(&motion["end"]["q"][0]), 0.2, 1e-14);
        assert!(number(&motion["residual"]) <= 1e-14);
    }
}

#[test]
fn every_motion_of_the_ball_is_found_for_many_ends() {
    for (x, t, most) in [
        (0.01, 5.0, 20_u32),
        (0.5, 3.0, 3),
        (0.05, 2.0, 3),
        (2.0, 7.5, 4),
        (0.3, 0.4, 2),
    ] {
        let line = format!("bouncing_ball --from x=0 --to x={x} --time {t} --impacts 0..{most}");
        let found = motions(&line);
        let mut expected = Vec::new();
        for k in 0..=most {
            let k = f64::from(k);
            let all = closed(x, t, k).into_iter().filter(|[v, _]| v.is_finite());
            // The last impact comes before the end.
            let mut all: Vec<_> = all.filter(|[v, _]| 2.0 * k * v < t).collect();
            all.sort_by(|left, right| left[0].total_cmp(&right[0]));
            expected.extend(all.into_iter().map(|it| (k, it)));
        }
        assert_eq!(found.len(), expected.len(), "{line}");
        for (motion, (k, [velocity, action])) in found.iter().zip(expected) {
            assert_eq!(count(motion) as f64, k);
            assert_near(speed(motion), velocity, 1e-12);
            assert_near(number(&motion["action"]), action, 1e-12);
        }
    }
}

#[test]
fn the_momentum_at_the_end_is_the_derivative_of_the_action() {
    let h = 1e-5;
    let at = |x: f64| {
        motions(&format!(
            "bouncing_ball --from x=0 --to x={x} --time 5 --impacts 0..3"
        ))
    };
    let (before, after) = (at(0.2 - h), at(0.2 + h));
    for (motion, (before, after)) in at(0.2).iter().zip(before.iter().zip(&after)) {
        let slope = (number(&after["action"]) - number(&before["action"])) / (2.0 * h);
        assert_near(number(&motion["end"]["p"][0]), slope, 1e-8);
    }
}

#[test]
fn conjugate_points_of_the_ball_lie_on_the_envelope() {
    let line = "bouncing_ball --from x=0 --to x=0.2 --time 5 --impacts 0..4 --envelope 30 --json -";
    let document: Value = serde_json::from_str(&connect_on("", line).output).unwrap();
    let points = document["envelope"].as_array().unwrap();
    let touched = document["motions"].as_array().unwrap().iter();
    let touched = touched.flat_map(|motion| motion["conjugate"].as_array().unwrap());
    let mut impacts = Vec::new();
    for point in points.iter().chain(touched) {
        let (k, t) = (number(&point["impacts"]), number(&point["t"]));
        assert_near(number(&point["q"][0]), t * t / (8.0 * k * (k + 1.0)), 1e-10);
        impacts.push(k as usize);
    }
    assert_eq!([1, 2, 3, 4].map(|k| impacts.contains(&k)), [true; 4]);
    // A motion with one impact that falls at the end has touched the envelope; one that rises at the end has not.
    let touches: Vec<usize> = motions("bouncing_ball --from x=0 --to x=0.2 --time 5 --impacts 1")
        .iter()
        .map(|motion| motion["conjugate"].as_array().unwrap().len())
        .collect();
    assert_eq!(touches, [1, 0]);
}

#[test]
fn a_ball_that_loses_speed() {
    // From x = 1 with velocity v the ball hits the floor at t1 = v + v1 with the speed v1, v1^2 = v^2 + 2. Then
    // x = e v1 s - s^2/2 with s = 5 - t1.
    let found =
        motions("bouncing_ball --from x=1 --to x=0.2 --time 5 --impacts 1 --law newton:0.8");
    let height = |v: f64| {
        let v1 = (v * v + 2.0).sqrt();
        let s = 5.0 - v - v1;
        0.8 * v1 * s - s * s / 2.0
    };
    assert_eq!(found.len(), 3);
    for motion in &found {
        assert_near(height(speed(motion)), 0.2, 1e-12);
        let impact = &motion["impacts"][0];
        let [before, after] = ["qdot_minus", "qdot_plus"].map(|key| number(&impact[key][0]));
        assert_near(after, -0.8 * before, 1e-14);
    }
    // The error at the end changes its sign three times on a fine grid of velocities.
    let grid = (-40_000..40_000).map(|k| 1e-4 * f64::from(k));
    let is_hit = |v: &f64| v + (v * v + 2.0).sqrt() < 5.0;
    let changes =
        grid.filter(|v| is_hit(&(v + 1e-4)) && (height(*v) - 0.2) * (height(v + 1e-4) - 0.2) < 0.0);
    assert_eq!(changes.count(), 3);
}

#[test]
fn an_end_on_the_floor_is_reached_before_the_impact_there() {
    let found = motions("bouncing_ball --from x=0 --to x=0 --time 5 --impacts 0..3");
    assert_eq!(found.len(), 4);
    for (k, motion) in found.iter().enumerate() {
        let velocity = 2.5 / (k + 1) as f64;
        assert_near(speed(motion), velocity, 1e-8);
        // The velocity at the arrival, before the impact at the same time.
        assert_near(number(&motion["end"]["qdot"][0]), -velocity, 1e-8);
    }
}

/// The images of a coordinate in walls at 0 and `length`, with the number of reflections.
fn images(at: f64, length: f64, most: i32) -> Vec<(f64, u32)> {
    let cell = |index: i32| match index % 2 {
        0 => f64::from(index) * length + at,
        _ => f64::from(index + 1) * length - at,
    };
    (-most..=most)
        .map(|index| (cell(index), index.unsigned_abs()))
        .collect()
}

#[test]
fn chords_of_a_rectangle_lead_to_the_images_of_the_end() {
    let line = "- --from x=0.3,y=0.4 --to x=1.7,y=0.25 --time 1.3 --impacts 0..4";
    let found = motions_on(BOX, line);
    let mut expected = Vec::new();
    for (x, i) in images(1.7, 2.0, 4) {
        for (y, j) in images(0.25, 1.0, 4) {
            if i + j <= 4 {
                expected.push((i + j, [(x - 0.3) / 1.3, (y - 0.4) / 1.3]));
            }
        }
    }
    assert_eq!(expected.len(), 1 + 4 + 8 + 12 + 16);
    assert_eq!(found.len(), expected.len());
    for (impacts, [u, v]) in expected {
        let is_chord = |motion: &&Value| {
            let start = &motion["start"]["qdot"];
            (number(&start[0]) - u).abs() < 1e-11 && (number(&start[1]) - v).abs() < 1e-11
        };
        let chord = found.iter().find(is_chord).expect("the chord");
        assert_eq!(count(chord), impacts as usize);
        assert_near(number(&chord["action"]), 1.3 * (u * u + v * v) / 2.0, 1e-11);
        assert_near(number(&chord["determinant"]).abs(), 1.0, 1e-9);
    }
}

#[test]
fn a_lossy_wall_slows_the_motion_after_it() {
    // To the right wall and back with half the speed: 1.5/u + 1/(u/2) = 2.
    let found = motions_on(
        BOX,
        "- --from x=0.5,y=0.5 --to x=1,y=0.5 --time 2 --impacts 1 --set e=0.5",
    );
    let right = |motion: &&Value| motion["impacts"][0]["surface"] == "right";
    let motion = found.iter().find(right).expect("the way by the right wall");
    assert_near(speed(motion), 1.75, 1e-12);
    let kinetic = [1.75 * 1.75 * 1.5 / 1.75, 0.875 * 0.875 * 1.0 / 0.875].map(|it| it / 2.0);
    assert_near(number(&motion["action"]), kinetic.iter().sum(), 1e-12);
    assert_eq!(found.len(), 4);
}

#[test]
fn gravity_and_a_wall_are_two_independent_balls() {
    // Along x the motion is free, with or without an impact on the wall x = 1. Along z it is that of the bouncing ball.
    // Two impacts are two on the floor, or one on the floor and one on the wall.
    let found = motions_on(
        SHELF,
        "- --from x=0,z=0 --to x=0.5,z=0.2 --time 5 --impacts 0..3",
    );
    let ways = |k: u32| closed(0.2, 5.0, f64::from(k)).len();
    for total in 0..=3 {
        let walled = if total > 0 { ways(total - 1) } else { 0 };
        let counted = found.iter().filter(|it| count(it) == total as usize);
        assert_eq!(counted.count(), ways(total) + walled, "{total} impacts");
    }
}

#[test]
fn motions_of_springs_meet_after_half_their_periods() {
    let found = motions_on(SPRING, "- --from x=0,y=0 --to x=0.3,y=0.2 --time 4");
    assert_eq!(found.len(), 1);
    let motion = &found[0];
    assert_near(speed(motion), 0.3 / 4.0_f64.sin(), 1e-12);
    assert_near(
        number(&motion["start"]["qdot"][1]),
        0.4 / 8.0_f64.sin(),
        1e-12,
    );
    let conjugate = motion["conjugate"].as_array().unwrap();
    let times: Vec<f64> = conjugate.iter().map(|it| number(&it["t"])).collect();
    // The determinant sin(t) sin(2 t)/2 passes through 0 at pi/2, and touches 0 at pi, where both factors vanish.
    assert_eq!(times.len(), 2, "{times:?}");
    assert_near(times[0], std::f64::consts::FRAC_PI_2, 1e-10);
    assert_near(times[1], std::f64::consts::PI, 1e-7);
}

#[test]
fn the_action_counts_terms_that_are_linear_in_velocities() {
    // From 0 with velocity (u, v): the velocity turns at the rate -B, and L = |v|^2/2 + B x dot(y).
    let found = motions_on(DRIFT, "- --from x=0,y=0 --to x=0.4,y=0.1 --time 2");
    assert_eq!(found.len(), 1);
    let [u, v] = [0, 1].map(|index| number(&found[0]["start"]["qdot"][index]));
    let (b, steps) = (0.7, 20_000);
    let place = |t: f64| {
        let (sin, cos) = (b * t).sin_cos();
        [
            (u * sin + v * (1.0 - cos)) / b,
            (v * sin - u * (1.0 - cos)) / b,
        ]
    };
    assert_near(place(2.0)[0], 0.4, 1e-12);
    assert_near(place(2.0)[1], 0.1, 1e-12);
    let lagrangian = |t: f64| {
        let (sin, cos) = (b * t).sin_cos();
        let (xdot, ydot) = (u * cos + v * sin, v * cos - u * sin);
        (xdot * xdot + ydot * ydot) / 2.0 + b * place(t)[0] * ydot
    };
    let h = 2.0 / f64::from(steps);
    let middle = (0..steps).map(|k| h * lagrangian(h * (f64::from(k) + 0.5)));
    assert_near(number(&found[0]["action"]), middle.sum(), 1e-7);
}

#[test]
fn a_constraint_of_positions_leaves_one_unknown() {
    let found = motions_on(ROD, "- --to x=0,y=1 --time 2");
    let rates: Vec<f64> = found
        .iter()
        .map(|it| number(&it["start"]["qdot"][1]))
        .collect();
    // A quarter turn forward or three quarters of a turn back, plus whole turns.
    let quarter = std::f64::consts::FRAC_PI_2;
    for turn in [-1.0, 0.0] {
        let rate = (quarter + turn * 4.0 * quarter) / 2.0;
        assert!(
            rates.iter().any(|it| (it - rate).abs() < 1e-9),
            "{rate} in {rates:?}"
        );
    }
    for rate in rates {
        let turns = (2.0 * rate - quarter) / (4.0 * quarter);
        assert_near(turns, turns.round(), 1e-9);
    }
}

#[test]
fn motions_through_a_focus_are_one_family() {
    let found =
        motions("point_billiard --set ta=1 --from x=0,y=0 --to x=0,y=0 --time 1 --impacts 1");
    assert_eq!(found.len(), 1);
    assert_eq!(found[0]["isolated"], false);
    assert!(number(&found[0]["family"]) > 10.0);
    assert_near(number(&found[0]["action"]), 2.0, 1e-12);
}

/// After half a period, every motion of an oscillator is at the opposite place. The actions of all are 0.
#[test]
fn motions_to_a_conjugate_end_are_one_family() {
    let oscillator = "Oscillator { coordinates { x; } lagrangian = (dot(x)^2 - x^2)/2; }";
    let line = "- --from x=1 --to x=-1 --time 3.141592653589793";
    let found = motions_on(oscillator, line);
    assert_eq!(found.len(), 1, "{found:?}");
    assert!(number(&found[0]["family"]) > 10.0);
    let told = connect_on(oscillator, line).output;
    assert!(told.contains("conjugate the end"), "{told}");
}

#[test]
fn a_disk_that_rolls_is_steered_to_a_point_and_simulated_there() {
    let line = "rolling_disk --from x=0,y=0 --to x=0.05,y=0.02 --time 1 --energy 1e-5 --starts 8";
    let found = motions(line);
    assert!(found.len() >= 3, "{}", found.len());
    for motion in found {
        let list = |key: &str| {
            let values = motion["start"][key].as_array().unwrap().iter();
            values.map(Value::to_string).collect::<Vec<_>>().join(",")
        };
        let state = format!("--q {} --qdot {}", list("q"), list("qdot"));
        let done = run_on(
            "",
            &format!("simulate rolling_disk {state} --until 1 --json -"),
        );
        let run: Value = serde_json::from_str(&done.output).unwrap();
        let end = &run["samples"].as_array().unwrap().last().unwrap()["q"];
        assert_near(number(&end[0]), 0.05, 1e-9);
        assert_near(number(&end[1]), 0.02, 1e-9);
    }
}

#[test]
fn another_seed_and_more_starts_find_the_same() {
    let line = "- --from x=0.3,y=0.4 --to x=1.7,y=0.25 --time 1.3 --impacts 3 --csv -";
    let rows = |flags: &str| {
        let done = connect_on(BOX, &format!("{line} {flags}"));
        done.output.lines().count()
    };
    assert_eq!(rows(""), 13);
    assert_eq!(rows("--seed 5"), 13);
    assert_eq!(rows("--starts 200"), 13);
    let twice = [0, 1].map(|_| connect_on(BOX, &format!("{line} --seed 3")).output);
    assert_eq!(twice[0], twice[1]);
}

#[test]
fn rows_and_text_and_picture_have_every_motion() {
    let line = "bouncing_ball --from x=0 --to x=0.2 --time 5 --impacts 0..3";
    let rows = connect_on("", &format!("{line} --csv -")).output;
    let head = "impacts,action,x_dot,end.x,end.x_dot,residual,times,surfaces,conjugate";
    assert_eq!(rows.lines().next(), Some(head));
    assert_eq!(rows.lines().count(), 8);
    assert!(rows.contains("floor floor floor"));
    let text = connect_on("", line).output;
    assert!(
        text.contains("7 motions: 1 with 0 impacts, 2 with 1 impact,"),
        "{text}"
    );
    let path = std::env::temp_dir().join(format!("dalembert-connect-{}.svg", std::process::id()));
    let done = connect_on("", &format!("{line} --plot {}", path.display()));
    assert_eq!(done.exit, Exit::Reached, "{}", done.errors);
    let svg = std::fs::read_to_string(&path).unwrap();
    std::fs::remove_file(&path).unwrap();
    assert!(svg.contains("3 impacts (2)"), "no legend");
    // Dots at twelve impacts, rings at the starts of seven paths, and a ring and a dot in the legend.
    let circles = svg.matches("<circle").count();
    assert_eq!(circles, 12 + 7 + 2, "{circles}");
}

#[test]
fn nothing_found_is_no_error() {
    let done = connect_on(
        "",
        "bouncing_ball --from x=0 --to x=0.2 --time 5 --impacts 4",
    );
    assert_eq!(done.exit, Exit::Other);
    assert!(done.output.contains("motions may be missed"));
    assert!(
        done.output.contains("found       no motion"),
        "{}",
        done.output
    );
}

/// Command lines that are refused, each with a part of the message.
const REFUSED: &[(&str, &str)] = &[
    (
        "bouncing_ball --to y=1 --time 1",
        "--to: unknown coordinate `y`",
    ),
    (
        "bouncing_ball --to x_dot=1 --time 1",
        "--to: unknown coordinate `x_dot`",
    ),
    (
        "bouncing_ball --to x=1 --from v=1 --time 1",
        "--from: unknown coordinate `v`",
    ),
    (
        "bouncing_ball --to x=a --time 1",
        "--to x: `a` is not accepted",
    ),
    ("bouncing_ball --to x --time 1", "--to: `x` is not accepted"),
    (
        "bouncing_ball --to x=1,x=2 --time 1",
        "every coordinate once",
    ),
    ("bouncing_ball --to , --time 1", "--to: `,` is not accepted"),
    (
        "bouncing_ball --to x=1 --time 0",
        "expected a positive number",
    ),
    (
        "bouncing_ball --to x=1 --time 1 --impacts 3..1",
        "--impacts: `3..1`",
    ),
    (
        "bouncing_ball --to x=1 --time 1 --impacts many",
        "--impacts: `many`",
    ),
    (
        "bouncing_ball --to x=1 --time 1 --impacts 2000",
        "1000 at most",
    ),
    (
        "double_pendulum --to theta1=1,theta2=1 --time 1 --impacts 1",
        "no impact surfaces",
    ),
    (
        "bouncing_ball --to x=-1 --time 1",
        "--to: the configuration lies behind `floor`",
    ),
    (
        "bouncing_ball --from x=-1 --to x=1 --time 1",
        "--from: the configuration lies behind `floor`",
    ),
    (
        "point_billiard --to x=0 --time 1",
        "--to: 1 coordinate is given, and the velocity at the start has 2 free components",
    ),
    (
        "rolling_disk --to x=0,y=0,theta=1,phi=1 --time 1",
        "--to: 4 coordinates are given",
    ),
    (
        "dimensionless_walker --to theta=1 --time 1",
        "a first-order system has no free velocities",
    ),
    (
        "holonomic_bead_on_ellipses --to x=0,y=1 --time 1",
        "in its reduced form, and this one has none",
    ),
    (
        "refracted_particle --to x=1,y=1 --time 1",
        "change between modes",
    ),
    (
        "point_billiard --to x=0,y=0 --time 1 --envelope 5",
        "--envelope: envelopes are known for one free velocity",
    ),
    (
        "bouncing_ball --to x=1 --time 1 --csv - --json -",
        "need different files",
    ),
    (
        "bouncing_ball --to x=1 --time 1 --plot a.png",
        "ends in .svg",
    ),
    (
        "bouncing_ball --to x=1 --time 1 --plot a.svg --axes t,speed",
        "unknown quantity `speed`",
    ),
    (
        "bouncing_ball --to x=1 --time 1 --law wall=elastic",
        "--law: unknown surface `wall`",
    ),
    (
        "bouncing_ball --to x=1 --time 1 --energy -1",
        "expected a positive number",
    ),
];

#[track_caller]
fn assert_refused(input: &str, line: &str, text: &str) {
    let done = connect_on(input, line);
    assert_eq!(done.exit, Exit::Refused, "{line}: {}", done.output);
    assert!(done.errors.contains(text), "{line}: {}", done.errors);
    assert_eq!(done.output, "", "{line}");
}

#[test]
fn what_cannot_be_sought_is_refused() {
    for (line, text) in REFUSED {
        assert_refused("", line, text);
    }
    assert_refused(
        ROD,
        "- --to x=1,y=1 --time 1",
        "--to: the constraint `rod` keeps a value that differs by 1 there",
    );
}

/// All neighbours of a motion meet it at the same time, so the determinant touches 0 and keeps its sign.
#[test]
fn conjugate_points_of_multiplicity_two() {
    let round = "
        Round { coordinates { x; y; } lagrangian = (dot(x)^2 + dot(y)^2)/2 - (x^2 + y^2)/2; }";
    let turning = "
        Turning {
            coordinates { x; y; }
            lagrangian = (dot(x)^2 + dot(y)^2)/2 + (x*dot(y) - y*dot(x))/2;
        }";
    let cases = [
        (
            round,
            "--from x=1,y=0 --to x=0.2,y=0.5 --time 4",
            std::f64::consts::PI,
        ),
        (
            turning,
            "--from x=0,y=0 --to x=1,y=0 --time 8",
            std::f64::consts::TAU,
        ),
    ];
    for (text, flags, known) in cases {
        let found = motions_on(text, &format!("- {flags}"));
        assert_eq!(found.len(), 1);
        let conjugate = found[0]["conjugate"].as_array().unwrap();
        let times: Vec<f64> = conjugate.iter().map(|it| number(&it["t"])).collect();
        assert_eq!(times.len(), 1, "{times:?}");
        assert_near(times[0], known, 1e-7);
    }
}
