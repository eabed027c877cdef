//! Ensembles: rows that do not depend on threads, shards or interruptions; members that fail; known densities.

mod members;
mod merge;
#[cfg(feature = "parquet")]
mod parquet;

use std::fs;

use dalembert_stability::text::Text;

use super::folder::Folder;
use super::*;

static SPRING: Text = Text::new(
    "Spring {
        coordinates { x; }
        parameters { k > 0 = 1; }
        lagrangian = (dot(x)^2 - k*x^2)/2;
        initial { x = 1; }
    }",
);

/// An ensemble of balls. One ninth of them start below the floor.
const BALLS: &str = "ensemble bouncing_ball --vary x=-0.5..3.5:9 --vary x_dot=-1..1:14 --until 6";

/// The rows on the standard output.
fn rows(line: &str) -> String {
    run(&format!("{line} --csv -")).output
}

/// A column of a table.
fn column(table: &str, name: &str) -> Vec<String> {
    let mut reader = csv::Reader::from_reader(table.as_bytes());
    let index = reader
        .headers()
        .unwrap()
        .iter()
        .position(|known| known == name)
        .unwrap_or_else(|| panic!("no column {name}"));
    let records = reader.records().map(Result::unwrap);
    records.map(|record| record[index].to_owned()).collect()
}

fn numbers_of(table: &str, name: &str) -> Vec<f64> {
    let column = column(table, name);
    column.iter().map(|text| text.parse().unwrap()).collect()
}

/// An integrator that makes runs one after the other, and the one that makes them in SIMD lanes.
const INTEGRATORS: [&str; 2] = ["dop853", "taylor"];

#[test]
fn rows_do_not_depend_on_threads() {
    for integrator in INTEGRATORS {
        let line = format!("{BALLS} --integrator {integrator}");
        let one = rows(&format!("{line} --threads 1"));
        assert_eq!(one.lines().count(), 1 + 9 * 14);
        for threads in [2, 5] {
            assert_eq!(rows(&format!("{line} --threads {threads}")), one);
        }
    }
}

#[test]
fn shards_one_after_the_other_are_the_whole() {
    for line in [
        BALLS,
        "ensemble bouncing_ball --random 7 --members 50 --vary x=1+-0.1 --vary x_dot=-1..1 --until 2",
    ] {
        let whole = rows(line);
        let mut parts = String::new();
        for shard in 1..=4 {
            let part = rows(&format!("{line} --shard {shard}/4"));
            let (header, rest) = part.split_once('\n').unwrap();
            if shard == 1 {
                parts = format!("{header}\n");
            }
            parts += rest;
        }
        assert_eq!(parts, whole);
    }
}

#[test]
fn a_row_is_what_simulate_says() {
    for integrator in INTEGRATORS {
        assert_row_is_what_simulate_says(integrator);
    }
}

fn assert_row_is_what_simulate_says(integrator: &str) {
    let flags = format!("--until 10 --integrator {integrator}");
    let table = rows(&format!(
        "ensemble bouncing_ball --vary x=0.5..2:4 --vary m=1,2 {flags}"
    ));
    assert_eq!(
        numbers_of(&table, "in.x"),
        [0.5, 0.5, 1.0, 1.0, 1.5, 1.5, 2.0, 2.0]
    );
    assert_eq!(
        numbers_of(&table, "in.m"),
        [1.0, 2.0, 1.0, 2.0, 1.0, 2.0, 1.0, 2.0]
    );
    let single = run(&format!(
        "simulate bouncing_ball --initial x=1.5 --set m=2 {flags} --samples 1 --json -"
    ))
    .json();
    let member = 5;
    assert_eq!(
        numbers(&single["outcome"]["q"]),
        [numbers_of(&table, "end.x")[member]]
    );
    assert_eq!(
        numbers(&single["outcome"]["qdot"]),
        [numbers_of(&table, "end.x_dot")[member]]
    );
    let impacts = column(&table, "impacts.floor");
    assert_eq!(
        impacts[member],
        single["events"].as_array().unwrap().len().to_string()
    );
    let accepted = column(&table, "accepted");
    assert_eq!(accepted[member], single["counters"]["accepted"].to_string());
}

#[test]
fn a_bad_member_is_a_row_and_harms_no_other() {
    for integrator in INTEGRATORS {
        assert_bad_members_are_rows(integrator);
    }
}

fn assert_bad_members_are_rows(integrator: &str) {
    let run = |line: &str| run(&format!("{line} --integrator {integrator}"));
    let done = run(&format!("{BALLS} --csv -"));
    assert_eq!(done.exit, Exit::Other);
    let outcomes = column(&done.output, "outcome");
    let bad = outcomes
        .iter()
        .filter(|outcome| *outcome == "starts_inside")
        .count();
    assert_eq!((bad, outcomes.len()), (14, 126));
    assert!(outcomes[14..].iter().all(|outcome| outcome == "done"));
    assert!(column(&done.output, "reason")[0].contains("surface floor, gap -0.5"));
    // The other members are the same as in an ensemble without the bad ones.
    let good = "ensemble bouncing_ball --vary x=0..3.5:8 --vary x_dot=-1..1:14 --until 6 --csv -";
    let good = run(good).output;
    assert_eq!(column(&good, "end.x"), column(&done.output, "end.x")[14..]);

    let done = run("ensemble bouncing_ball --vary m=-1,1,0 --until 2 --csv -");
    assert_eq!(
        column(&done.output, "outcome"),
        ["refused", "done", "refused"]
    );
    assert!(column(&done.output, "reason")[0].contains("`m`"));
    assert_eq!(column(&done.output, "t"), ["NaN", "2.0", "NaN"]);

    let done = run("ensemble bouncing_ball --vary x=1e-9,1 --until 2 --steps 100");
    assert_eq!(done.exit, Exit::Other);
    for part in ["done 1, step_budget 1", "member 0: step_budget"] {
        assert!(done.output.contains(part), "{}", done.output);
    }
    let done = run("ensemble bead --vary y=0,2,0.5 --until 1");
    assert!(
        done.output
            .contains("member 1: refused (coordinate `y` lies outside")
    );
}

#[test]
fn a_member_in_whose_run_the_program_fails_is_a_row() {
    for integrator in INTEGRATORS {
        assert_failure_is_a_row(integrator);
    }
}

fn assert_failure_is_a_row(integrator: &str) {
    let members = "ensemble spring --vary k=1,13,2 --until 2 --threads 1";
    let line = &format!("{members} --csv - --integrator {integrator}");
    let models = [systems::missing!(SPRING)];
    let run = |line: &str| run_over(&models, "", &line.split(' ').collect::<Vec<_>>());
    let done = run(line);
    assert_eq!(done.exit, Exit::Other);
    assert_eq!(
        column(&done.output, "outcome"),
        ["done", "panicked", "done"]
    );
    assert_eq!(column(&done.output, "reason"), ["", "unlucky", ""]);
    let good = run(&line.replace(",13", ""));
    assert_eq!(good.exit, Exit::Reached);
    let [with, without] = [&done, &good].map(|done| column(&done.output, "end.x"));
    assert_eq!([&with[0], &with[2]], [&without[0], &without[1]]);
}

#[test]
fn draws_belong_to_members() {
    let line = "ensemble bouncing_ball --random 7 --vary x=2+-0.1 --vary m=1..3 --until 1";
    let [short, long] = [20, 400].map(|count| rows(&format!("{line} --members {count}")));
    assert!(long.starts_with(&short));
    let heights = numbers_of(&long, "in.x");
    let mean = heights.iter().sum::<f64>() / 400.0;
    assert!((mean - 2.0).abs() < 0.02, "{mean}");
    assert!(
        numbers_of(&long, "in.m")
            .iter()
            .all(|m| (1.0..3.0).contains(m))
    );
    let other = rows(&line.replace("--random 7", "--random 8 --members 20"));
    assert_ne!(column(&other, "in.x"), column(&short, "in.x"));
}

#[test]
fn members_are_read_from_tables() {
    let folder = Folder::new("from");
    let path = folder.path("run.csv");
    run(&format!(
        "simulate bouncing_ball --until 3 --samples 5 --csv {path}"
    ));
    let table = rows(&format!("ensemble bouncing_ball --from {path} --until 1"));
    assert_eq!(column(&table, "in.x"), column(&folder.read("run.csv"), "x"));
    assert_eq!(
        column(&table, "in.x_dot"),
        column(&folder.read("run.csv"), "x_dot")
    );

    // The rows of an ensemble are valid input.
    let first = rows("ensemble bouncing_ball --vary x=1..2:3 --vary g=1,2 --until 1");
    fs::write(folder.0.join("rows.csv"), &first).unwrap();
    let again = rows(&format!(
        "ensemble bouncing_ball --from {} --until 1",
        folder.path("rows.csv")
    ));
    assert_eq!(again, first);
    let done = run_on(
        "x,m\n1,2\n",
        &["ensemble", "bouncing_ball", "--from", "-", "--until", "1"],
    );
    assert_eq!(done.exit, Exit::Reached, "{}", done.errors);
}

#[test]
fn a_run_that_was_cut_off_goes_on_to_the_same_file() {
    let folder = Folder::new("resume");
    let density = "--density x_dot=-3..3,x=0..4:8 --every 0.25";
    for more in ["", density] {
        let line = format!("{BALLS} {more} --csv {}", folder.path("rows.csv"));
        run(&line);
        let (whole, meta) = (folder.read("rows.csv"), folder.read("rows.csv.meta.json"));
        let document = || run(&format!("{line} --resume --json -")).output;
        let complete = document();
        for cut in [
            0,
            10,
            whole.len() / 3,
            whole.len() / 2,
            whole.len() - 1,
            whole.len(),
        ] {
            fs::write(folder.0.join("rows.csv"), &whole.as_bytes()[..cut]).unwrap();
            // The file of counts belongs to the complete table, so a shorter table must not have it.
            let _ = fs::remove_file(folder.0.join("rows.csv.counts"));
            if cut == 0 {
                fs::remove_file(folder.0.join("rows.csv.meta.json")).unwrap();
            }
            assert_eq!(document(), complete, "cut at {cut}");
            assert_eq!(folder.read("rows.csv"), whole, "cut at {cut}");
            assert_eq!(folder.read("rows.csv.meta.json"), meta);
        }
    }
    // Complete rows are not computed again.
    let done = run(&format!(
        "{BALLS} {density} --resume --csv {}",
        folder.path("rows.csv")
    ));
    assert!(
        done.output.contains("(126 members taken over)"),
        "{}",
        done.output
    );
    let other = BALLS.replace("--until 6", "--until 7");
    let refused = run(&format!(
        "{other} {density} --resume --csv {}",
        folder.path("rows.csv")
    ));
    assert_eq!(refused.exit, Exit::Refused);
    assert!(
        refused.errors.contains("`until` was 6.0 and is 7.0"),
        "{}",
        refused.errors
    );
}

#[test]
fn a_file_that_another_run_is_writing_is_refused() {
    let folder = Folder::new("busy");
    for (line, name) in [
        (BALLS, "--csv rows"),
        (BALLS, "--resume --csv rows"),
        (BALLS, "--json all"),
        (
            "ensemble bouncing_ball --vary x=1,2 --until 1 --density x,x_dot",
            "--cells cells",
        ),
        ("simulate bouncing_ball --until 1", "--csv run"),
    ] {
        let (flags, name) = name.rsplit_once(' ').unwrap();
        let line = format!("{line} {flags} {}", folder.path(name));
        let before = run(&line);
        assert_ne!(before.exit, Exit::Refused, "{}", before.errors);
        let written = folder.read(name);
        let other = fs::File::open(folder.0.join(name)).unwrap();
        other.lock().unwrap();
        let refused = run(&line);
        assert_eq!(refused.exit, Exit::Refused, "{line}");
        let flag = flags.rsplit(' ').next().unwrap();
        for part in [flag, &folder.path(name), "another run is writing"] {
            assert!(refused.errors.contains(part), "{}", refused.errors);
        }
        assert_eq!(folder.read(name), written, "nothing was touched");
        drop(other);
        assert_eq!(run(&line).exit, before.exit);
    }
    // Two paths to the same file.
    let twice = format!(
        "{BALLS} --csv {} --json {}/./rows",
        folder.path("rows"),
        folder.0.display()
    );
    assert_eq!(run(&twice).exit, Exit::Refused);
}

/// Replaces the byte of a file at this place.
fn alter(folder: &Folder, name: &str, place: usize, byte: u8) {
    let mut bytes = fs::read(folder.0.join(name)).unwrap();
    assert_ne!(bytes[place], byte);
    bytes[place] = byte;
    fs::write(folder.0.join(name), bytes).unwrap();
}

#[test]
fn a_row_that_was_altered_is_not_continued() {
    let folder = Folder::new("altered");
    let density = "--density x_dot=-3..3,x=0..4:8 --every 0.25";
    for more in ["", density] {
        let line = format!("{BALLS} {more} --csv {}", folder.path("rows.csv"));
        run(&line);
        let resumed = || run(&format!("{line} --resume"));
        let whole = folder.read("rows.csv");
        // Position of a digit in the energy of member 20.
        let row = whole.lines().nth(21).unwrap();
        let energy = column(&whole, "energy")[20].clone();
        let place = whole.find(row).unwrap() + row.find(&energy).unwrap() + energy.len() - 1;
        let digit = if whole.as_bytes()[place] == b'3' {
            b'4'
        } else {
            b'3'
        };
        for (place, byte, at) in [
            (place, digit, "line 22"),
            (3, b'B', "line 1"),
            // The end of a row.
            (whole.find(row).unwrap() - 1, b' ', "line 21"),
        ] {
            alter(&folder, "rows.csv", place, byte);
            let refused = resumed();
            assert_eq!(refused.exit, Exit::Refused, "{at}: {}", refused.output);
            for part in ["--resume", "rows.csv", at, "altered", "start again"] {
                assert!(refused.errors.contains(part), "{}", refused.errors);
            }
            fs::write(folder.0.join("rows.csv"), &whole).unwrap();
        }
        assert_eq!(resumed().exit, Exit::Other);
        assert_eq!(folder.read("rows.csv"), whole);
    }
    alter(&folder, "rows.csv.counts", 900, 77);
    let refused = run(&format!(
        "{BALLS} {density} --resume --csv {}",
        folder.path("rows.csv")
    ));
    assert_eq!(refused.exit, Exit::Refused);
    assert!(
        refused.errors.contains("rows.csv.counts"),
        "{}",
        refused.errors
    );
    fs::remove_file(folder.0.join("rows.csv.sums")).unwrap();
    fs::remove_file(folder.0.join("rows.csv.counts")).unwrap();
    let refused = run(&format!(
        "{BALLS} {density} --resume --csv {}",
        folder.path("rows.csv")
    ));
    assert!(
        refused.errors.contains("rows.csv.sums"),
        "{}",
        refused.errors
    );
}

/// Rows without a checksum are run again.
#[test]
fn rows_whose_checksums_were_cut_off_are_run_again() {
    let folder = Folder::new("sums");
    let line = format!("{BALLS} --csv {}", folder.path("rows.csv"));
    run(&line);
    let [whole, sums] = ["rows.csv", "rows.csv.sums"].map(|name| folder.read(name));
    assert_eq!(sums.lines().count(), whole.lines().count() - 1);
    for cut in [0, 30, sums.len() / 2] {
        fs::write(folder.0.join("rows.csv.sums"), &sums[..cut]).unwrap();
        let done = run(&format!("{line} --resume"));
        let kept = cut / 17;
        assert!(
            kept == 0 || done.output.contains(&format!("({kept} member")),
            "{}",
            done.output
        );
        assert_eq!(folder.read("rows.csv"), whole);
        assert_eq!(folder.read("rows.csv.sums"), sums);
    }
}

#[test]
fn a_ball_has_every_speed_for_the_same_time() {
    let folder = Folder::new("density");
    // The ball starts upwards from the floor at speed 1, and each flight lasts 2. It has every speed from -1 to 1 for
    // the same time. The interval of the samples avoids the impacts, where rounding would decide the sign of the speed.
    let done = run(&format!(
        "ensemble bouncing_ball --q 0 --qdot 1 --until 40000 --every 0.01230001 --discard 2 --density x_dot=-1..1,x=0..0.51:10x20 \
         --cells {} --plot {} --json {}",
        folder.path("cells.csv"),
        folder.path("density.svg"),
        folder.path("all.json")
    ));
    assert_eq!(done.exit, Exit::Reached, "{}", done.errors);
    let cells = folder.read("cells.csv");
    let mut speeds = [0.0; 10];
    for (index, count) in numbers_of(&cells, "count").into_iter().enumerate() {
        speeds[index % 10] += count;
    }
    let all: f64 = speeds.iter().sum();
    assert!(all > 3.2e6);
    for count in speeds {
        assert!((count / all - 0.1).abs() < 2e-5, "{speeds:?}");
    }
    // Height of the ball at this speed: x = (1 - v^2)/2.
    let (v, x) = (numbers_of(&cells, "x_dot"), numbers_of(&cells, "x"));
    for (index, density) in numbers_of(&cells, "density").into_iter().enumerate() {
        let right = (1.0 - v[index] * v[index]) / 2.0;
        assert!(density == 0.0 || (x[index] - right).abs() < 0.12);
    }

    let document: Value = serde_json::from_str(&folder.read("all.json")).unwrap();
    let convergence = document["convergence"].as_array().unwrap();
    assert_eq!(convergence.len(), 5);
    let last = &convergence[4];
    assert_eq!(last["states"].as_f64(), Some(all));
    // The distribution is far more uniform than one of independent states.
    assert!(last["halves_of_time"].as_f64() < last["independent"].as_f64());
    assert!(last["halves_of_members"].is_null());
    let svg = folder.read("density.svg");
    for text in [
        "x\u{307}",
        "distance between halves of the time",
        "white: none",
        "crispEdges",
        "</svg>",
    ] {
        assert!(svg.contains(text), "{text}");
    }
}

#[test]
fn counts_do_not_depend_on_threads_and_tell_of_what_is_outside() {
    let line = format!("{BALLS} --density x_dot,x=0..1:7 --every 0.1 --json -");
    let one = run(&format!("{line} --threads 1")).output;
    assert_eq!(run(&format!("{line} --threads 3")).output, one);
    let document: Value = serde_json::from_str(&one).unwrap();
    let counts = document["counts"].as_array().unwrap();
    let inside: f64 = counts.iter().flat_map(numbers).sum();
    let outside = document["density_outside"].as_f64().unwrap();
    assert_eq!(inside + outside, 112.0 * 60.0);
    assert!(outside > 1000.0);
    // The range that is not given covers all samples.
    let range = numbers(&document["density"]["axes"][0]["range"]);
    assert!(range[0] < -2.0 && range[1] > 2.0, "{range:?}");
    let text = run(&format!("{BALLS} --density x_dot,x=0..1:7")).output;
    for part in ["more outside of it", "1/2", "independent"] {
        assert!(text.contains(part), "{text}");
    }
    assert!(!text.contains("1/4"), "6 states have no quarter: {text}");
}

#[test]
fn fractions_of_a_density_have_the_states_that_their_names_tell() {
    // All states are within the ranges. The 20 states of each member can be divided by 4, but not by 8.
    let line = format!(
        "{BALLS} --density x_dot=-20..20,x=0..20:7 --discard 0.001 --every 0.29995 --json -"
    );
    let document: Value = serde_json::from_str(&run(&line).output).unwrap();
    let all = document["density_states"].as_f64().unwrap();
    assert_eq!(all, 112.0 * 20.0);
    let convergence = document["convergence"].as_array().unwrap();
    let parts: Vec<f64> = convergence
        .iter()
        .map(|row| {
            let part = row["part"].as_f64().unwrap();
            assert_eq!(row["states"].as_f64(), Some(part * all));
            part
        })
        .collect();
    assert_eq!(parts, [0.25, 0.5, 1.0]);
}

#[test]
fn flags_that_are_wrong_are_named() {
    let cases: [(&str, &[&str]); 25] = [
        ("--vary z=0..1:3", &["--vary", "`z`", "x, x_dot, m, g"]),
        ("--vary x", &["--vary", "NAME=A..B"]),
        ("--vary x=0..1", &["--vary x", "COUNT", "--members"]),
        ("--vary x=0..1:0", &["--vary x", "positive"]),
        ("--vary x=0..b:3", &["--vary x", "`b`", "finite"]),
        ("--vary x=1+-0.1", &["--vary x", "--random"]),
        ("--vary x=1 --vary x=2", &["--vary", "once"]),
        ("--vary x=0..1:3 --members 4", &["--members", "3"]),
        ("--members 4", &["--members", "--vary"]),
        ("--random 1 --vary x=0..1", &["--random", "--members"]),
        ("--random 1 --members 4", &["--random", "--vary"]),
        ("--random 1 --members 4 --vary x=1,2", &["--vary x", "C+-S"]),
        ("--shard 0/3", &["--shard", "I/N"]),
        ("--shard 4/3", &["--shard", "I/N"]),
        ("--threads 0", &["--threads"]),
        ("--resume", &["--resume", "--csv"]),
        ("--csv - --json -", &["--csv", "--json", "once"]),
        ("--csv - --parquet rows", &["--csv -", "--parquet"]),
        ("--plot a.svg", &["--density"]),
        ("--density x", &["--density", "two names"]),
        ("--density x,y", &["--density", "`y`"]),
        ("--density x,x_dot:0", &["--density", "1 to 1000"]),
        ("--density x=1..0,x_dot", &["--density", "A below B"]),
        ("--density x,x_dot --discard 9", &["--density", "--discard"]),
        ("--from nowhere.csv", &["--from", "nowhere.csv"]),
    ];
    for (flags, parts) in cases {
        let done = run(&format!("ensemble bouncing_ball --until 5 {flags}"));
        assert_eq!(done.exit, Exit::Refused, "{flags} gave {}", done.output);
        assert!(done.output.is_empty(), "{flags}");
        for part in parts {
            assert!(
                done.errors.contains(part),
                "`{flags}` gave `{}`",
                done.errors
            );
        }
    }
    let tables = [
        ("a,b\n1,2\n", "`a`"),
        ("t,energy\n1,2\n", "no column"),
        ("x\none\n", "line 2, column `x`"),
        ("x,m\n1\n", "fields"),
        ("x,x\n1,1\n", "once"),
    ];
    for (table, part) in tables {
        let words = ["ensemble", "bouncing_ball", "--until", "1", "--from", "-"];
        let done = run_on(table, &words);
        assert_eq!(done.exit, Exit::Refused, "{table}");
        assert!(done.errors.contains(part), "{table}: {}", done.errors);
    }
}

#[cfg(not(feature = "parquet"))]
#[test]
fn parquet_needs_its_feature() {
    let done = run("ensemble bouncing_ball --until 5 --parquet rows.parquet");
    assert_eq!(done.exit, Exit::Refused);
    assert!(
        done.errors.contains("--features parquet"),
        "{}",
        done.errors
    );
}
