//! Inputs from tables: extremals that reach their ends, jumps, lines, constant values, and tables that are refused.

// A test may fail by panicking.
#![allow(clippy::unwrap_used)]

#[path = "support/folder.rs"]
mod folder;
mod support;

use std::fs;

use dalembert_cli::Exit;
use folder::Folder;
use serde_json::Value;
use support::{Done, run_on};

/// A mass with one input that pushes and another one that pulls.
const MASS: &str = "
    Mass {
        coordinates { x; }
        inputs { u; v; }
        lagrangian = dot(x)^2/2;
        forces { push: (u - 2*v)*d(x); }
        initial { until = 3; }
    }";

/// Writes a file of a test, and gives its path.
fn written(folder: &Folder, name: &str, text: &str) -> String {
    fs::write(folder.0.join(name), text).unwrap();
    folder.path(name)
}

fn simulate(input: &str, line: &str) -> Done {
    run_on(input, &format!("simulate {line}"))
}

/// The last positions and velocities of a run.
fn end(input: &str, line: &str) -> [Vec<f64>; 2] {
    let done = simulate(input, &format!("{line} --tol 1e-12 --json -"));
    assert_eq!(done.exit, Exit::Reached, "{} {}", done.output, done.errors);
    let document: Value = serde_json::from_str(&done.output).unwrap();
    let last = &document["outcome"];
    ["q", "qdot"].map(|key| serde_json::from_value(last[key].clone()).unwrap())
}

fn assert_near(found: f64, expected: f64, bound: f64) {
    assert!((found - expected).abs() <= bound, "{found} {expected}");
}

/// Motions of the ball from a height of 1/2 with one and with two impacts, and from a height of 2 with one impact.
#[test]
fn extremals_that_are_simulated_reach_their_ends() {
    let folder = Folder::new("inputs-extremals");
    let table = folder.path("best.csv");
    for (start, impacts, samples) in [(0.5, 1, 26), (0.5, 2, 101), (2.0, 1, 11)] {
        let line = format!(
            "control controlled_ball --initial x={start} --impacts {impacts} --inputs {table} --samples {samples} --json -"
        );
        let done = run_on("", &line);
        assert_eq!(done.exit, Exit::Reached, "{}", done.errors);
        let document: Value = serde_json::from_str(&done.output).unwrap();
        let expected = &document["extremals"][0]["end"]["state"];
        let line = format!("controlled_ball --initial x={start} --until 5 --inputs {table}");
        let [q, _] = end("", &line);
        for (name, found) in ["x", "y"].into_iter().zip(q) {
            assert_near(found, expected[name].as_f64().unwrap(), 1e-9);
        }
    }
}

/// `u` is 0 until the time 1, then 2. The other input has the value of the flag.
#[test]
fn jumps_are_where_two_rows_are() {
    let folder = Folder::new("inputs-jumps");
    let table = written(
        &folder,
        "jump.csv",
        "t,u,other\n0,0,7\n1,0,7\n1,2,7\n3,2,7\n",
    );
    for between in ["cubic", "linear", "held"] {
        let line = format!("- --inputs {table} --between {between} --input v=0.5");
        let [q, qdot] = end(MASS, &line);
        // x'' = -1 on [0, 1], 1 on [1, 3].
        assert_near(qdot[0], 1.0, 1e-13);
        assert_near(q[0], -0.5 - 2.0 + 2.0, 1e-13);
    }
}

/// Rows at 0.5, 1 and 2: two lines, two constant values, or the parabola through three rows. Before and after the rows
/// the input is constant.
#[test]
fn between_rows_inputs_are_as_asked() {
    let folder = Folder::new("inputs-between");
    let table = written(&folder, "rows.csv", "t,u\n0.5,1\n1,4\n2,1\n");
    let area = |between: &str| end(MASS, &format!("- --inputs {table} --between {between}"))[1][0];
    assert_near(area("linear"), 0.5 + 1.25 + 2.5 + 1.0, 1e-12);
    assert_near(area("held"), 0.5 + 0.5 + 4.0 + 1.0, 1e-12);
    // The parabola through the rows is -6 t^2 + 15 t - 5.
    let parabola = |t: f64| -2.0 * t.powi(3) + 7.5 * t * t - 5.0 * t;
    assert_near(
        area("cubic"),
        0.5 + parabola(2.0) - parabola(0.5) + 1.0,
        1e-11,
    );
}

/// Between rows `h` apart the cubic differs from a sine by at most `3/128 h^4`, in the first and last interval by at
/// most `h^4/24`. Over the time 3 the integral differs by less than 5e-7.
#[test]
fn a_smooth_input_is_met_closely() {
    let folder = Folder::new("inputs-sine");
    let rows: Vec<String> = (0..=60)
        .map(|k| f64::from(k) * 0.05)
        .map(|t| format!("{t:?},{:?}", t.sin()))
        .collect();
    let table = written(&folder, "sine.csv", &format!("t,u\n{}\n", rows.join("\n")));
    let [q, qdot] = end(MASS, &format!("- --inputs {table}"));
    assert_near(qdot[0], 1.0 - 3.0_f64.cos(), 5e-7);
    assert_near(q[0], 3.0 - 3.0_f64.sin(), 1.5e-6);
}

/// Cubics through rows have kinks at the rows: a run makes no step across one. The velocity is the integral of the input,
/// which Simpson's rule gives exactly between two rows.
#[test]
fn kinks_between_cubics_cost_no_accuracy() {
    let folder = Folder::new("inputs-kinks");
    let t = [0.0, 0.37, 0.5, 0.93, 1.4, 1.45, 2.11, 2.5, 3.0];
    let u = [1.0, -4.0, 3.0, 2.5, -7.0, 5.0, 0.5, -3.0, 4.0];
    let rows: Vec<String> = t
        .iter()
        .zip(&u)
        .map(|(t, u)| format!("{t:?},{u:?}"))
        .collect();
    let table = written(&folder, "kinks.csv", &format!("t,u\n{}\n", rows.join("\n")));
    let cubic = |first: usize, at: f64| -> f64 {
        let weight = |i: usize| {
            let others = (first..first + 4).filter(|&j| j != i);
            others.map(|j| (at - t[j]) / (t[i] - t[j])).product::<f64>()
        };
        (first..first + 4).map(|i| weight(i) * u[i]).sum()
    };
    let mut v = 0.0;
    for k in 0..t.len() - 1 {
        let first = k.saturating_sub(1).min(t.len() - 4);
        let [from, to] = [t[k], t[k + 1]];
        let sum = cubic(first, from) + 4.0 * cubic(first, 0.5 * (from + to)) + cubic(first, to);
        v += (to - from) / 6.0 * sum;
    }
    for integrator in ["dop853", "dopri5"] {
        let [_, qdot] = end(
            MASS,
            &format!("- --inputs {table} --integrator {integrator}"),
        );
        assert_near(qdot[0], v, 1e-11);
    }
}

#[test]
fn tables_that_make_no_sense_are_refused() {
    let folder = Folder::new("inputs-refused");
    for (text, reason) in [
        ("u\n1\n", "there is no column `t`"),
        ("t,w\n0,1\n", "no column is an input of the model: u, v"),
        ("t,u,u\n0,1,1\n", "two columns are called `u`"),
        ("t,t,u\n0,0,1\n", "two columns are called `t`"),
        ("t,u\n0,1\n1,x\n", "line 3: `x` is no number"),
        ("t,u\n0,1\n2,1\n1,1\n", "line 4: the time decreases to 1"),
        ("t,u\n", "there are no rows"),
        ("t,u\n0,inf\n", "line 2: `inf` is no number"),
    ] {
        let table = written(&folder, "table.csv", text);
        let refused = simulate(MASS, &format!("- --inputs {table}"));
        assert_eq!(refused.exit, Exit::Refused, "{text}");
        assert!(
            refused.errors.contains(reason),
            "{text}: {}",
            refused.errors
        );
    }
    let table = written(&folder, "table.csv", "t,u\n0,1\n");
    for (input, line, reason) in [
        (
            MASS,
            format!("- --inputs {table} --integrator taylor"),
            "need dop853",
        ),
        (MASS, format!("- --inputs {table} --verify"), "--verify"),
        (MASS, "- --between held".to_owned(), "--inputs"),
        (
            "",
            format!("double_pendulum --inputs {table}"),
            "the model has no inputs",
        ),
        (
            MASS,
            format!("- --inputs {}", folder.path("nothing.csv")),
            "nothing.csv",
        ),
    ] {
        let refused = simulate(input, &line);
        assert_eq!(refused.exit, Exit::Refused, "{line}");
        assert!(
            refused.errors.contains(reason),
            "{line}: {}",
            refused.errors
        );
    }
}
