//! A program without the standard library links and runs.

use std::path::Path;
use std::process::Command;

#[test]
#[ignore = "builds a crate of its own: `.ci/run` runs it"]
fn a_program_without_std_links_and_runs() {
    let manifest = Path::new(env!("CARGO_MANIFEST_DIR")).join("no_std/Cargo.toml");
    let target = Path::new(env!("CARGO_TARGET_TMPDIR")).join("outside");
    let status = Command::new(env!("CARGO"))
        .args(["build", "--quiet", "--release", "--manifest-path"])
        .arg(manifest)
        .arg("--target-dir")
        .arg(&target)
        .env_remove("CARGO_TARGET_DIR")
        .status()
        .expect("cargo");
    assert!(status.success(), "the program does not link");
    let ran = Command::new(target.join("release/bare"))
        .status()
        .expect("the program starts");
    assert_eq!(ran.code(), Some(0), "the ball did not bounce five times");
}
