//! `control --vary`: least costs against closed forms, independence of threads, and requests that are refused.

// A test may fail by panicking.
#![allow(clippy::unwrap_used)]

mod support;

use dalembert_cli::Exit;
use serde_json::Value;
use support::run_on;

/// A free particle above a wall. From rest to rest over the displacement `(a, b)` the cost is `6 k (a^2 + b^2)/T^3`.
/// With an impact on the wall, the cost is that of the motion to the mirror image of the end.
const MIRROR: &str = "
    Mirror {
        coordinates { x; y; }
        parameters { k > 0 = 1; }
        inputs { u; w; }
        cost { running = k*(u^2 + w^2)/2; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2;
        forces { first: u*d(x); second: w*d(y); }
        impacts { wall: y >= 0; }
        initial { y = 1; until = 2; }
    }";

const TO_REST: &str = "--end x=2,y=1,x_dot=0,y_dot=0 --impacts 0..1";

fn members(input: &str, line: &str) -> Vec<Value> {
    let done = run_on(input, &format!("control {line} --json -"));
    assert_eq!(done.exit, Exit::Reached, "{}", done.errors);
    let document: Value = serde_json::from_str(&done.output).unwrap();
    document["members"].as_array().unwrap().clone()
}

/// The value of a member, and its least cost with this number of impacts.
fn least(member: &Value, impacts: usize) -> (f64, Option<f64>) {
    let extremals = member["extremals"].as_array().unwrap();
    let count = |extremal: &&Value| extremal["impacts"].as_array().unwrap().len() == impacts;
    let cost = extremals
        .iter()
        .find(count)
        .map(|it| it["cost"].as_f64().unwrap());
    (member["value"].as_f64().unwrap(), cost)
}

#[track_caller]
fn assert_least(member: &Value, impacts: usize, expected: impl Fn(f64) -> f64) {
    let (value, cost) = least(member, impacts);
    let (cost, expected) = (cost.expect("an extremal"), expected(value));
    assert!(
        (cost - expected).abs() < 1e-9 * (1.0 + expected),
        "at {value}: {cost} for {expected}"
    );
}

#[test]
fn a_component_of_the_start_is_varied() {
    let members = members(MIRROR, &format!("- {TO_REST} --vary x=0..1:5"));
    assert_eq!(members.len(), 5);
    for member in &members {
        let across = |x: f64| (2.0 - x).powi(2);
        assert_least(member, 0, |x| 6.0 / 8.0 * across(x));
        assert_least(member, 1, |x| 6.0 / 8.0 * (across(x) + 4.0));
    }
}

#[test]
fn a_parameter_is_varied() {
    for member in &members(MIRROR, &format!("- {TO_REST} --vary k=1,2,5")) {
        assert_least(member, 0, |k| k * 6.0 / 8.0 * 4.0);
        assert_least(member, 1, |k| k * 6.0 / 8.0 * 8.0);
    }
}

/// The ball starts and ends at rest at height 1. Without an impact, the force that holds it costs `m^2 g^2 T/2 = 10`.
/// The costs with one impact, for two coefficients of restitution, were computed with this library.
#[test]
fn losses_at_impacts_cost_force() {
    let line = "controlled_ball --initial x=1 --end x=1,y=0 --impacts 0..1 --vary e=0.8,1";
    let members = members("", line);
    for (member, expected) in members.iter().zip([3.58405209, 3.46669914]) {
        let (_, cost) = least(member, 1);
        assert!((cost.unwrap() - expected).abs() < 1e-8, "{member}");
        assert_least(member, 0, |_| 10.0);
    }
}

#[test]
fn rows_and_pictures_do_not_depend_on_threads() {
    let path = std::env::temp_dir().join(format!("dalembert-sweep-{}.svg", std::process::id()));
    let run = |threads: u32| {
        let path = path.display();
        let line = format!(
            "control - {TO_REST} --vary x=0..1:3 --threads {threads} --csv - --plot {path}"
        );
        let done = run_on(MIRROR, &line);
        assert_eq!(done.exit, Exit::Reached, "{}", done.errors);
        (
            done.output,
            std::fs::read_to_string(&*format!("{path}")).unwrap(),
        )
    };
    let (rows, picture) = run(1);
    assert!(
        rows.starts_with("in.x,impacts,cost,terminal,costate.x,"),
        "{rows}"
    );
    assert_eq!(rows.lines().count(), 7, "{rows}");
    assert!(picture.contains("1 impact") && picture.contains("cost"));
    assert_eq!(run(2), (rows, picture));
    std::fs::remove_file(&path).unwrap();
}

#[test]
fn values_that_are_refused_are_listed_with_the_reason() {
    let line = "control controlled_ball --impacts 0 --vary x=-1,1";
    let done = run_on("", line);
    assert_eq!(done.exit, Exit::Reached, "{}", done.errors);
    let lines: Vec<&str> = done.output.lines().collect();
    let refused = lines[lines.len() - 2];
    assert!(
        refused.contains("-1.0") && refused.contains("behind `floor`"),
        "{}",
        done.output
    );
    assert!(lines[2].contains("run"), "{}", done.output);
}

#[test]
fn what_cannot_be_varied_is_refused() {
    for (line, message) in [
        (
            "--vary z=0..1:3",
            "unknown coordinate, velocity or parameter `z`",
        ),
        (
            "--vary costate_x=0..1:3",
            "a parameter or a component of the state at the start",
        ),
        (
            "--vary x_dot=0..1:3",
            "a parameter or a component of the state at the start",
        ),
        (
            "--vary e=0.5..1:3 --set e=1",
            "a quantity that no other flag gives",
        ),
        (
            "--vary x=0.5..1:3 --initial y=0,x=1",
            "a quantity that no other flag gives",
        ),
        ("--vary x=0.5..1", "--vary"),
        ("--vary x=0..1:1000000", "at most 100000 values"),
        ("--vary x=-2,-1", "the state lies behind `floor`"),
        ("--vary x=1,2 --axes t,x --plot a.svg", "--axes"),
        ("--threads 2", "--threads"),
    ] {
        let done = run_on("", &format!("control controlled_ball {line}"));
        assert_eq!(done.exit, Exit::Refused, "{line}: {}", done.output);
        assert!(done.errors.contains(message), "{line}: {}", done.errors);
    }
}
