//! An ensemble that is killed and resumed writes the same files as one that runs without interruption.

// A test may fail by panicking.
#![allow(clippy::unwrap_used)]

use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};
use std::thread;
use std::time::{Duration, Instant};

/// An ensemble that runs long enough to be killed before its end.
const DISKS: &str = "ensemble rolling_disk --random 5 --members 1000 --vary theta_dot=10+-0.1 --vary phi=0..pi --until 100 \
                     --threads 2";

fn ensemble(more: &str, rows: &Path, output: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_dalembert"));
    command.args(DISKS.split_whitespace());
    command.args(more.split_whitespace()).args(output);
    command.arg("--csv").arg(rows);
    command.stdout(Stdio::piped()).stderr(Stdio::inherit());
    command
}

/// Waits until the file has this many bytes.
fn wait_for(path: &Path, bytes: u64) {
    let begun = Instant::now();
    while fs::metadata(path).map_or(0, |file| file.len()) < bytes {
        assert!(begun.elapsed() < Duration::from_secs(120));
        thread::sleep(Duration::from_millis(5));
    }
}

fn kill_and_go_on(name: &str, more: &str) {
    let folder = format!("dalembert-killed-{name}-{}", std::process::id());
    let folder = std::env::temp_dir().join(folder);
    fs::create_dir_all(&folder).unwrap();
    let [whole, killed] = ["whole.csv", "killed.csv"].map(|name| folder.join(name));
    let document = ["--resume", "--json", "-"];
    let expected = ensemble(more, &whole, &document).output().unwrap();
    assert!(expected.status.success());
    let rows = fs::read(&whole).unwrap();

    let mut cuts = 0;
    for part in [4, 2] {
        let mut process = ensemble(more, &killed, &["--resume"]).spawn().unwrap();
        wait_for(&killed, rows.len() as u64 / part);
        process.kill().unwrap();
        process.wait().unwrap();
        let left = fs::read(&killed).unwrap();
        assert!(rows.starts_with(&left));
        cuts += usize::from(left.len() < rows.len());
    }
    assert!(cuts > 0);
    let resumed = ensemble(more, &killed, &document).output().unwrap();
    assert!(resumed.status.success());
    assert_eq!(fs::read(&killed).unwrap(), rows);
    assert_eq!(resumed.stdout, expected.stdout);
    fs::remove_dir_all(&folder).unwrap();
}

#[test]
fn a_killed_ensemble_goes_on_to_the_same_rows() {
    kill_and_go_on("rows", "");
}

#[test]
fn a_killed_ensemble_goes_on_to_the_same_density() {
    kill_and_go_on("density", "--density x,y:20");
}

/// Contents of the table of rows, of its metadata and of its sums.
fn files(rows: &Path) -> [Vec<u8>; 3] {
    ["", ".meta.json", ".sums"]
        .map(|ending| fs::read(format!("{}{ending}", rows.display())).unwrap())
}

#[test]
fn a_killed_ensemble_keeps_the_rows_that_it_was_to_replace() {
    let folder = format!("dalembert-killed-replacing-{}", std::process::id());
    let folder = std::env::temp_dir().join(folder);
    fs::create_dir_all(&folder).unwrap();
    let [whole, rows] = ["whole.csv", "rows.csv"].map(|name| folder.join(name));
    let succeed = |more: &str, rows: &Path, flags: &[&str]| {
        let done = ensemble(more, rows, flags).output().unwrap();
        assert!(done.status.success());
    };
    succeed("--shard 1/6", &whole, &[]);
    succeed("--shard 1/100", &rows, &[]);
    let old = files(&rows);

    let mut process = ensemble("--shard 1/6", &rows, &[]).spawn().unwrap();
    wait_for(
        &folder.join("rows.csv.new"),
        files(&whole)[0].len() as u64 / 4,
    );
    process.kill().unwrap();
    process.wait().unwrap();
    assert_eq!(files(&rows), old);
    // The flags of the old run find the old rows, and those of the new run find the new rows.
    succeed("--shard 1/100", &rows, &["--resume"]);
    assert_eq!(files(&rows), old);
    succeed("--shard 1/6", &rows, &["--resume"]);
    assert_eq!(files(&rows), files(&whole));
    let names = fs::read_dir(&folder).unwrap();
    assert_eq!(names.count(), 6, "no new file is left");
    fs::remove_dir_all(&folder).unwrap();
}

/// Rows that began in one mode are not continued in another.
#[test]
fn the_first_mode_is_part_of_the_metadata() {
    let folder = std::env::temp_dir().join(format!("dalembert-mode-{}", std::process::id()));
    fs::create_dir_all(&folder).unwrap();
    let rows = folder.join("rows.csv");
    let run = |mode: &str| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_dalembert"));
        let line = format!(
            "ensemble ball_on_switching_table --mode {mode} --vary x=0..1:3 --until 1 --resume"
        );
        command
            .args(line.split_whitespace())
            .arg("--csv")
            .arg(&rows);
        command.args(["--json", "-"]).output().unwrap()
    };
    let first = run("slow");
    let document: serde_json::Value = serde_json::from_slice(&first.stdout).unwrap();
    assert_eq!(document["mode"], "slow");
    let other = run("fast");
    assert_eq!(other.status.code(), Some(2));
    let errors = String::from_utf8(other.stderr).unwrap();
    assert!(errors.contains("--resume"), "{errors}");
    fs::remove_dir_all(&folder).unwrap();
}
