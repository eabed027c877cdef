//! Every example runs and checks its own results. The tests check the printed lines.
#![allow(missing_docs, clippy::unwrap_used, reason = "tests")]

use std::path::PathBuf;
use std::process::Command;

/// The lines that a built example prints.
fn printed(name: &str) -> Vec<String> {
    let test = std::env::current_exe().unwrap();
    let folder: PathBuf = test.ancestors().nth(2).unwrap().join("examples");
    let output = Command::new(folder.join(name)).output().unwrap();
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{name}: {errors}");
    let text = String::from_utf8(output.stdout).unwrap();
    text.lines().map(Into::into).collect()
}

#[test]
fn every_example_runs() {
    for (name, first) in [
        ("rolling_disk", "reached the requested end at t = 20"),
        (
            "impact_table",
            "  1  t = 0.451523640986  -4.429446918 -> +3.100612843",
        ),
        ("limit_cycle", "a step takes "),
        ("ensemble", "angles of 10000 pendulums at t = 100"),
        (
            "model_from_text",
            "Oscillator: reached the requested end at t = 10",
        ),
    ] {
        let lines = printed(name);
        assert!(lines[0].starts_with(first), "{name}: {lines:#?}");
        assert!(lines.len() > 2, "{name}: {lines:#?}");
    }
}

/// The normal modes are cosines: the sum of the positions has the frequency 2, their difference sqrt(5).
#[test]
fn the_oscillator_is_where_its_modes_put_it() {
    let lines = printed("model_from_text");
    let value = |line: &str| line.split(" = ").nth(1).unwrap().parse::<f64>().unwrap();
    let modes = [20.0_f64.cos(), (10.0 * 5.0_f64.sqrt()).cos()];
    assert!((value(&lines[1]) - (modes[0] + modes[1]) / 2.0).abs() < 1e-10);
    assert!((value(&lines[2]) - (modes[0] - modes[1]) / 2.0).abs() < 1e-10);
}
