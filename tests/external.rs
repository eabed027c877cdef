//! A crate outside the workspace declares a new constrained system with an impact and runs the commands for it. The
//! crate depends on `dalembert` and `dalembert-cli` only.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use serde_json::Value;

/// Builds the crate in `tests/external` and returns the path of its binary.
fn build() -> PathBuf {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("external");
    // All crates outside the workspace use one target folder, so that they share compiled dependencies.
    let target = Path::new(env!("CARGO_TARGET_TMPDIR")).join("outside");
    let status = Command::new(env!("CARGO"))
        .args(["build", "--quiet", "--manifest-path"])
        .arg(folder.join("Cargo.toml"))
        .arg("--target-dir")
        .arg(&target)
        .env_remove("CARGO_TARGET_DIR")
        .status()
        .expect("cargo");
    assert!(status.success(), "the crate does not build");
    target.join("debug").join("skate")
}

fn run(binary: &Path, arguments: &[&str], input: &str) -> Output {
    use std::io::Write;
    use std::process::Stdio;
    let mut child = Command::new(binary)
        .args(arguments)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the binary starts");
    child
        .stdin
        .take()
        .expect("a pipe")
        .write_all(input.as_bytes())
        .expect("input");
    child.wait_with_output().expect("output")
}

#[test]
#[ignore = "builds a crate of its own: `.ci/run` runs it"]
fn a_users_crate_has_every_command_for_its_own_model() {
    let binary = build();
    let derived = run(&binary, &["derive", "inclined_skate"], "");
    assert!(derived.status.success());
    let text = String::from_utf8_lossy(&derived.stdout);
    assert!(text.contains("sin(theta)"), "{text}");

    let state = r#"[{"q": [0, 0, 0], "qdot": [1, 0, 0.5]}]"#;
    let evaluated = run(&binary, &["eval", "inclined_skate"], state);
    assert!(
        evaluated.status.success(),
        "{}",
        String::from_utf8_lossy(&evaluated.stderr)
    );
    let values: Value = serde_json::from_slice(&evaluated.stdout).expect("JSON");
    // Only gravity acts along the heading of the skate: a = g sin(slope).
    let along = values[0]["acceleration"][0].as_f64().expect("a number");
    assert!((along - 9.81 * 0.1_f64.sin()).abs() < 1e-12, "{along}");
    // The edge turns the velocity: yddot = v thetadot.
    let across = values[0]["acceleration"][1].as_f64().expect("a number");
    assert!((across - 0.5).abs() < 1e-12, "{across}");

    let simulated = run(&binary, &["simulate", "inclined_skate", "--json", "-"], "");
    let outcome: Value = serde_json::from_slice(&simulated.stdout).expect("JSON");
    assert_eq!(outcome["model"], "inclined_skate");
    assert!(
        !outcome["events"].as_array().expect("events").is_empty(),
        "the skate reaches the wall"
    );
}
