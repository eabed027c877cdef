//! Models that are loaded from files.

use std::path::PathBuf;

use super::folder::Folder;
use super::*;

const BALL: &str = "
    /// A ball that bounces.
    Ball {
        coordinates { x; }
        parameters { g > 0 = 9.81; e in [0, 1] = 0.5; }
        lagrangian = dot(x)^2/2 - g*x;
        impacts { floor: x >= 0 => newton(e); }
        initial { x = 1; until = 1; }
        claims { conserved: energy; }
    }";

/// The text block of a page that begins with these words.
fn block<'p>(page: &'p str, first: &str) -> &'p str {
    let blocks = page.split("```text\n").skip(1);
    let mut blocks = blocks.filter_map(|rest| rest.split("```").next());
    blocks.find(|block| block.starts_with(first)).unwrap()
}

#[test]
fn every_command_takes_a_file() {
    let folder = Folder::new("commands");
    let ball = folder.file("ball.dal", BALL);
    let simulated = run(&format!("simulate {ball} --json -")).json();
    assert_eq!(simulated["model"], "ball");
    assert_eq!(simulated["outcome"]["kind"], "done");
    // The ball falls for sqrt(2/g). As 2 e = 1, the next flight takes the same time, and the flight after that takes
    // half of it.
    assert_eq!(simulated["counters"]["impacts"], 2);
    let time = simulated["events"][0]["t"].as_f64().unwrap();
    assert!((time - (2.0_f64 / 9.81).sqrt()).abs() < 1e-14, "{time}");
    let derived = run(&format!("derive {ball}"));
    assert!(derived.output.starts_with("ball\nA ball that bounces."));
    let checked = run(&format!("check {ball}"));
    assert_eq!(checked.exit, Exit::Reached, "{}", checked.output);
    let evaluated = run_on(r#"[{"q": [2], "qdot": [1]}]"#, &["eval", &ball]).json();
    assert_eq!(evaluated[0]["energy"].as_f64(), Some(0.5 + 2.0 * 9.81));
    let measured = run(&format!("accuracy {ball} --until 0.2 --wanted 1e-6"));
    assert_eq!(measured.exit, Exit::Reached, "{}", measured.errors);
    let ensemble = run(&format!("ensemble {ball} --vary x=1..2:4 --until 1"));
    assert_eq!(ensemble.exit, Exit::Reached, "{}", ensemble.errors);
}

#[test]
fn a_model_comes_from_the_standard_input() {
    let done = run_on(BALL, &["simulate", "-", "--until", "0.2", "--json", "-"]);
    assert_eq!(done.json()["outcome"]["kind"], "done");
}

#[test]
fn the_pages_show_models_that_run() {
    let folder = Folder::new("pages");
    let page = include_str!("../../docs/language.md");
    let two = folder.file("two.dal", block(page, "// Two pendulums."));
    for name in ["rod", "moving"] {
        let done = run(&format!(
            "simulate {two}:{name} --integrator taylor --json -"
        ));
        assert_eq!(done.json()["outcome"]["kind"], "done", "{}", done.errors);
    }
    let readme = include_str!("../../README.md");
    let skate = folder.file("skate.dal", block(readme, "/// Skate on an incline"));
    let done = run(&format!("simulate {skate} --json -"));
    assert_eq!(done.json()["outcome"]["kind"], "done", "{}", done.errors);
}

#[test]
fn a_file_with_several_models_needs_a_name() {
    let folder = Folder::new("several");
    let both = folder.file(
        "both.dal",
        &format!("{BALL} Other {{ coordinates {{ y; }} lagrangian = dot(y)^2; }}"),
    );
    let refused = run(&format!("simulate {both}"));
    assert_eq!(refused.exit, Exit::Refused);
    assert!(
        refused.errors.ends_with(&format!(
            "expected one of its models: {both}:ball, {both}:other\n"
        )),
        "{}",
        refused.errors
    );
    let unknown = run(&format!("simulate {both}:bell"));
    assert!(
        unknown
            .errors
            .contains("unknown model `bell`; did you mean `ball`?"),
        "{}",
        unknown.errors
    );
    let missing = run("simulate skate.da");
    assert!(
        missing.errors.contains(
            "there is no file `skate.da`; the name of a file with models ends with `.dal`"
        ),
        "{}",
        missing.errors
    );
    let found = run(&format!("derive {both}:other"));
    assert_eq!(found.exit, Exit::Reached, "{}", found.errors);
}

#[test]
fn mistakes_are_shown_where_they_are() {
    let folder = Folder::new("mistakes");
    let wrong = folder.file(
        "wrong.dal",
        "P {\n    coordinates { x; }\n    lagrangian = dot(x)^2/2 - k*x;\n}\n",
    );
    let refused = run(&format!("simulate {wrong}"));
    assert_eq!(refused.exit, Exit::Refused);
    let expected = format!(
        " --> {wrong}:3:31\n  |\n3 |     lagrangian = dot(x)^2/2 - k*x;\n  |                               ^\n"
    );
    assert!(
        refused.errors.starts_with("error: unknown name `k`"),
        "{}",
        refused.errors
    );
    assert!(refused.errors.ends_with(&expected), "{}", refused.errors);
    let open = folder.file("open.dal", "P { coordinates { x;");
    assert!(run(&format!("check {open}")).errors.contains(":1:"));
    let empty = folder.file("empty.dal", "// nothing\n");
    assert!(
        run(&format!("check {empty}"))
            .errors
            .contains("no model here")
    );
}

#[test]
fn a_false_claim_refuses_the_model() {
    let text = BALL.replace("conserved: energy", "conserved: dot(x)");
    let refused = run_on(&text, &["simulate", "-"]);
    assert_eq!(refused.exit, Exit::Refused);
    assert!(
        refused.errors.contains("conserved: dot(x)"),
        "{}",
        refused.errors
    );
}

#[test]
fn files_that_cannot_be_read_are_named() {
    let missing = run("simulate nowhere.dal");
    assert_eq!(missing.exit, Exit::Refused);
    assert!(
        missing.errors.starts_with("error: MODEL nowhere.dal: "),
        "{}",
        missing.errors
    );
    let folder = Folder::new("large");
    // The limit also cuts a character of two bytes.
    for long in [
        "// a long comment\n".repeat(1 << 17),
        format!("/{}", "ö".repeat(1 << 20)),
    ] {
        let large = folder.file("large.dal", &long);
        let refused = run(&format!("simulate {large}"));
        assert!(
            refused.errors.contains("at most 1048576 bytes"),
            "{}",
            refused.errors
        );
    }
}

#[test]
fn what_is_too_large_is_said() {
    let walls: String = (1..=130).map(|k| format!("w{k}: x <= {k}; ")).collect();
    let text = format!(
        "P {{ coordinates {{ x; }} lagrangian = dot(x)^2/2; impacts {{ {walls} }} initial {{ until = 1; }} }}"
    );
    let refused = run_on(&text, &["simulate", "-"]);
    assert_eq!(refused.exit, Exit::Refused);
    assert!(
        refused
            .errors
            .contains("130 surfaces, and there is room for 128 without a compiler"),
        "{}",
        refused.errors
    );
    let terms: Vec<String> = (1..=1200).map(|k| format!("sin({k}*x)/{k}")).collect();
    let text = format!(
        "P {{ coordinates {{ x; y; }} lagrangian = dot(x)^2/2 + dot(y)^2/2 - ({}); initial {{ until = 1; }} }}",
        terms.join(" + ")
    );
    let refused = run_on(&text, &["simulate", "-"]);
    assert_eq!(refused.exit, Exit::Refused);
    assert!(
        refused.errors.contains("kept power series"),
        "{}",
        refused.errors
    );
}

#[test]
fn a_text_is_loaded_only_where_its_model_is_asked_for() {
    // Loading the second text would panic.
    let models = [
        Entry::of_text("ball", BALL),
        Entry::of_text("broken", "Broken {"),
    ];
    let simulated = run_over(&models, "", &["simulate", "ball", "--json", "-"]);
    assert_eq!(simulated.exit, Exit::Reached, "{}", simulated.errors);
    assert_eq!(simulated.json()["model"], "ball");
    let misspelt = run_over(&models, "", &["simulate", "brokn"]);
    assert_eq!(misspelt.exit, Exit::Refused);
    assert!(misspelt.errors.contains("`broken`"), "{}", misspelt.errors);
}

#[test]
fn times_name_the_code_that_was_loaded() {
    let models = [Entry::of_text("ball", BALL)];
    let measured = run_over(&models, "", &["accuracy", "ball", "--until", "0.2"]);
    let expected = "times with the model's functions loaded from its text";
    assert!(measured.output.contains(expected), "{}", measured.output);
}

#[test]
fn new_writes_a_model_that_runs() {
    let folder = Folder::new("new");
    let file = folder.0.join("wall_clock.dal");
    let name = folder.0.join("wall_clock").display().to_string();
    let written = run(&format!("new {name}"));
    assert_eq!(written.exit, Exit::Reached, "{}", written.errors);
    let shown = format!("wrote {}; `dalembert watch", file.display());
    assert!(written.output.starts_with(&shown), "{}", written.output);
    let document = run(&format!("simulate {} --json -", file.display())).json();
    assert_eq!(document["model"], "wall_clock");
    assert_eq!(document["outcome"]["kind"], "done");
    assert!(document["counters"]["impacts"].as_u64() > Some(2));
    let again = run(&format!("new {name}.dal"));
    assert_eq!(again.exit, Exit::Refused);
    assert!(
        again.errors.contains("files are not overwritten"),
        "{}",
        again.errors
    );
    for wrong in ["Clock", "2", "wall-clock", "clock.txt", "loop"] {
        let refused = run_on("", &["new", wrong]);
        assert_eq!(refused.exit, Exit::Refused, "{wrong}");
        assert!(
            refused.errors.contains("small letters"),
            "{}",
            refused.errors
        );
    }
}

/// A model whose second mode has a coordinate less than the first.
const MODES: &str = "Hop {
    parameters { k = 1; }
    modes {
        pair { coordinates { x; y; } lagrangian = (dot(x)^2 + dot(y)^2)/2 - x; initial { x = 1; y = 2; dot(x) = 3; } }
        single { coordinates { y; } lagrangian = k*dot(y)^2/2 - y; initial { y = 3; } }
    }
    transitions { over: pair -> single when x >= 3 => reset { y = y; dot(y) = dot(y); }; }
}";

#[test]
fn a_table_of_a_run_in_modes_starts_members() {
    let folder = Folder::new("modes");
    let (model, table) = (folder.file("hop.dal", MODES), folder.path("run.csv"));
    let run = run(&format!(
        "simulate {model} --mode single --until 1 --samples 3 --csv {table}"
    ));
    assert_eq!(run.exit, Exit::Reached, "{}", run.errors);
    let ensemble = |mode: &str| {
        let line = format!("ensemble {model} --mode {mode} --from {table} --until 1 --csv -");
        super::run(&line)
    };
    let done = ensemble("single");
    assert_eq!(done.exit, Exit::Reached, "{}", done.errors);
    let head = done.output.lines().next().unwrap();
    assert!(head.contains("in.y") && !head.contains("in.x"), "{head}");
    assert_eq!(done.output.lines().count(), 4, "{}", done.output);
    let refused = ensemble("pair");
    assert_eq!(refused.exit, Exit::Refused);
    let told = "`pair`, the mode in which the members start";
    assert!(refused.errors.contains(told), "{}", refused.errors);
}

#[test]
fn a_fault_of_a_mode_names_its_coordinate() {
    let folder = Folder::new("fault");
    let model = folder.file("hop.dal", MODES);
    let done = run(&format!(
        "simulate {model} --mode single --set k=-1 --until 1"
    ));
    let told = "the pivot at coordinate `y` is -1";
    assert!(done.output.contains(told), "{}{}", done.output, done.errors);
}

#[test]
fn build_writes_a_crate_once() {
    let folder = Folder::new("build");
    let both = format!("{BALL} pub BallOnTop {{ coordinates {{ y; }} lagrangian = dot(y)^2; }}");
    let file = folder.file("balls.dal", &both);
    let written = run(&format!("build {file}"));
    assert_eq!(written.exit, Exit::Reached, "{}", written.errors);
    let read = |name: &str| std::fs::read_to_string(folder.0.join("balls").join(name)).unwrap();
    assert_eq!(read("src/balls.dal"), both);
    let main = read("src/main.rs");
    assert!(
        main.contains("dalembert::model_file!(\"src/balls.dal\");"),
        "{main}"
    );
    assert!(main.contains("models![Ball, BallOnTop]"), "{main}");
    let manifest = read("Cargo.toml");
    assert!(manifest.contains("name = \"balls\""), "{manifest}");
    let again = run(&format!("build {file}"));
    assert_eq!(again.exit, Exit::Refused);
    assert!(again.errors.starts_with("error: --to "), "{}", again.errors);
    let elsewhere = folder.0.join("other").display().to_string();
    let nowhere = run(&format!(
        "build {file} --to {elsewhere} --library {elsewhere}"
    ));
    assert!(nowhere.errors.contains("--library"), "{}", nowhere.errors);
    let wrong = folder.file("wrong.dal", "Ball { coordinates { x } }");
    let refused = run(&format!("build {wrong}"));
    assert!(
        refused.errors.contains("wrong.dal:1:"),
        "{}",
        refused.errors
    );
    assert!(!folder.0.join("wrong").exists());
}

#[test]
fn watch_runs_a_file_again_when_it_is_saved() {
    let folder = Folder::new("watch");
    let file = folder.file("ball.dal", "Ball { coordinates { x } }");
    let path = PathBuf::from(&file);
    let saving = std::thread::spawn(move || {
        std::thread::sleep(std::time::Duration::from_millis(500));
        std::fs::write(path, BALL).unwrap();
    });
    let done = run(&format!("watch {file} --until 0.5 --runs 2"));
    saving.join().unwrap();
    assert_eq!(done.exit, Exit::Reached, "{}", done.errors);
    assert!(done.errors.contains("ball.dal:1:"), "{}", done.errors);
    assert!(
        done.errors.contains("waiting for a change of"),
        "{}",
        done.errors
    );
    assert!(done.output.contains("ball"), "{}", done.output);
    let shipped = run("watch bouncing_ball --runs 1");
    assert_eq!(shipped.exit, Exit::Refused);
    assert!(
        shipped.errors.contains("dalembert new"),
        "{}",
        shipped.errors
    );
}

#[test]
fn claims_are_left_alone_where_that_is_asked_for() {
    let folder = Folder::new("claims");
    let claims = BALL.replace("conserved: energy;", "conserved: x;");
    let file = folder.file("ball.dal", &claims);
    let refused = run(&format!("simulate {file}"));
    assert_eq!(refused.exit, Exit::Refused, "{}", refused.output);
    let done = run(&format!("simulate {file} --no-claims --json -"));
    assert_eq!(done.json()["outcome"]["kind"], "done", "{}", done.errors);
    for line in [format!("derive {file}"), format!("export {file} --c -")] {
        assert_eq!(run(&line).exit, Exit::Refused, "{line}");
        let done = run(&format!("{line} --no-claims"));
        assert_eq!(done.exit, Exit::Reached, "{line}: {}", done.errors);
        assert!(done.output.contains("ball"), "{}", done.output);
    }
    // The claims are the subject of `check`.
    let refused = run(&format!("check {file} --no-claims"));
    assert_eq!(refused.exit, Exit::Refused);
    assert!(
        refused.errors.contains("unexpected argument") && !refused.errors.contains("as a value"),
        "{}",
        refused.errors
    );
}

#[test]
fn long_chains_run_and_say_what_they_are_too_long_for() {
    let text = "Chain { const N = 40; coordinates { a[N]: angle; } let X[0] = 0; let X[i in 1..=N] = X[i-1] + sin(a[i]);
        let Y[0] = 0; let Y[i in 1..=N] = Y[i-1] - cos(a[i]);
        lagrangian = sum(i in 1..=N: (dot(X[i])^2 + dot(Y[i])^2)/2 - Y[i]); initial { a[1] = 1; until = 1; } }";
    for options in [
        &["--verify"][..],
        &["--integrator", "taylor"],
        &["--integrator", "gauss4"],
    ] {
        let done = run_on(text, &[&["simulate", "-"], options].concat());
        assert_eq!(done.exit, Exit::Reached, "{}", done.errors);
        assert!(done.output.contains("done at t = 1"), "{}", done.output);
    }
    let lanes = "ensemble - --members 8 --vary a.1=0.1..1 --integrator taylor";
    let done = run_on(text, &lanes.split(' ').collect::<Vec<_>>());
    assert_eq!(done.exit, Exit::Reached, "{}", done.errors);
    for line in ["linearise -", "simulate - --certify"] {
        let refused = run_on(text, &line.split(' ').collect::<Vec<_>>());
        assert_eq!(refused.exit, Exit::Refused, "{line}: {}", refused.output);
        let reason = "80 components of a state, and there is room for 32 in this computation";
        assert!(
            refused.errors.contains(reason),
            "{line}: {}",
            refused.errors
        );
    }
}

#[test]
fn a_mistake_that_repeats_and_a_long_line_stay_readable() {
    let walls: String = (1..=30)
        .map(|k| format!("  surface w{k}: x <= {k};\n"))
        .collect();
    let text = format!(
        "P {{\n coordinates {{ x; }}\n lagrangian = dot(x)^2/2;\n initial {{ until = 1; }}\n{walls}}}\n"
    );
    let refused = run_on(&text, &["simulate", "-"]);
    assert_eq!(refused.exit, Exit::Refused);
    let shown = refused.errors.matches("-->").count();
    assert_eq!(shown, 3, "{}", refused.errors);
    let others = "the same in 27 more places: lines 8, 9, 10";
    assert!(refused.errors.contains(others), "{}", refused.errors);

    let long = vec!["sin(x)"; 400].join(" + ");
    let text =
        format!("P {{ coordinates {{ x; }} lagrangian = dot(x)^2/2 - ({long} + zz + {long}); }}");
    let refused = run_on(&text, &["simulate", "-"]);
    let lines: Vec<&str> = refused.errors.lines().collect();
    let marked = lines
        .iter()
        .position(|line| line.contains('^'))
        .expect("a caret");
    let (line, caret) = (lines[marked - 1], lines[marked]);
    assert!(line.len() < 200, "{line}");
    let place = caret.find('^').expect("a caret");
    assert_eq!(&line[place..place + 2], "zz", "{line}\n{caret}");
}
