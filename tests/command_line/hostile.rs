//! Wrong input gives exit status 2, an empty standard output, and a message that names the flag and the accepted
//! values. The program never panics.

use std::io::ErrorKind;

use super::folder::Folder;
use super::*;

/// The message of a command line that is refused.
fn refused(words: &[&str]) -> String {
    let done = run_on("", words);
    assert_eq!(done.exit, Exit::Refused, "{words:?} gave {}", done.output);
    assert!(done.output.is_empty(), "{words:?}");
    done.errors
}

/// Asserts that each line is refused with a message that contains these parts.
fn check(cases: &[(&str, &[&str])]) {
    for (line, parts) in cases {
        let message = refused(&line.split_whitespace().collect::<Vec<_>>());
        for part in *parts {
            assert!(
                message.contains(part),
                "`{line}` gave `{message}`, without `{part}`"
            );
        }
    }
}

#[test]
fn unknown_names_bring_the_nearest_and_all() {
    check(&[
        (
            "simulate bouncing_bal",
            &["did you mean `bouncing_ball`?", "oscillator", "MODEL"],
        ),
        (
            "derive nothing_like_it",
            &["MODEL", "bouncing_ball, oscillator, bead"],
        ),
        ("check nothing", &["MODEL"]),
        ("eval nothing", &["MODEL"]),
        (
            "simulate bouncing_ball --set mm=1",
            &["--set", "`mm`", "did you mean `m`?", "m, g"],
        ),
        (
            "simulate bouncing_ball --until 1 --initial z=1",
            &["--initial", "`z`", "x, x_dot"],
        ),
        (
            "simulate bouncing_ball --until 1 --law wall=elastic",
            &["--law", "surface `wall`", "floor"],
        ),
        (
            "simulate bouncing_ball --until 1 --law elastc",
            &["--law", "did you mean `elastic`?", "totally_plastic"],
        ),
        ("simulate bouncing_ball --scene windy", &["--scene", "all"]),
        (
            "simulate bouncing_ball --integrator euler",
            &[
                "--integrator",
                "dop853",
                "dopri5",
                "taylor",
                "rk4",
                "gauss6",
                "dla4",
            ],
        ),
        (
            "simulate bouncing_ball --step 0.1",
            &["--step", "--tol", "--integrator rk4", "dla2"],
        ),
        (
            "simulate bouncing_ball --integrator rk4 --step 0",
            &["--step", "positive"],
        ),
        (
            "simulate bouncing_ball --integrator rk4 --max-step 0.1",
            &["--max-step", "--step", "dop853, dopri5 or taylor"],
        ),
        (
            "simulate bouncing_ball --max-step 0",
            &["--max-step", "positive"],
        ),
        (
            "ensemble bouncing_ball --vary x=1,2 --max-step -1",
            &["--max-step", "positive"],
        ),
        ("list --format xml", &["--format", "text", "json"]),
        ("simulat bouncing_ball", &["simulate"]),
        ("simulate bouncing_ball --untill 3", &["--until"]),
    ]);
}

#[test]
fn values_that_are_not_accepted() {
    check(&[
        ("simulate bouncing_ball --set m", &["--set", "NAME=VALUE"]),
        ("simulate bouncing_ball --set m=-1", &["--set m", "> 0"]),
        ("simulate bouncing_ball --set m=nan", &["--set m", "finite"]),
        (
            "simulate bouncing_ball --set m=1e999",
            &["--set m", "finite"],
        ),
        ("simulate bouncing_ball --set m=", &["--set m"]),
        (
            "simulate bouncing_ball --set m=1,g",
            &["--set", "NAME=VALUE,.."],
        ),
        (
            "simulate bouncing_ball --output x_dot=1",
            &["--output", "another name", "a column `x_dot`"],
        ),
        (
            "simulate bouncing_ball --until 1 --initial x=inf",
            &["--initial x", "finite"],
        ),
        (
            "simulate bouncing_ball --until 1 --initial x",
            &["--initial", "NAME=VALUE"],
        ),
        (
            "simulate bouncing_ball --until -5",
            &["--until", "positive"],
        ),
        (
            "simulate bouncing_ball --until nan",
            &["--until", "positive"],
        ),
        ("simulate bouncing_ball --until 0", &["--until", "positive"]),
        ("simulate bouncing_ball --tol 0", &["--tol", "1e-15"]),
        ("simulate bouncing_ball --tol -1", &["--tol", "1e-15"]),
        ("simulate bouncing_ball --tol x", &["--tol"]),
        ("simulate bouncing_ball --samples -1", &["--samples"]),
        ("simulate bouncing_ball --samples 1e3", &["--samples"]),
        (
            "simulate bouncing_ball --samples 99999999999999999999999",
            &["--samples"],
        ),
        ("simulate bouncing_ball --impacts 0", &["--impacts"]),
        ("simulate bouncing_ball --impacts -3", &["--impacts"]),
        (
            "simulate bouncing_ball --until 1 --law newton",
            &["--law", "newton:E", "0 to 1"],
        ),
        (
            "simulate bouncing_ball --until 1 --law newton:2",
            &["--law", "0 to 1"],
        ),
        (
            "simulate bouncing_ball --until 1 --law newton:",
            &["--law", "0 to 1"],
        ),
        (
            "simulate bouncing_ball --until 1 --law elastic:1",
            &["--law", "without a coefficient"],
        ),
        ("simulate bouncing_ball --until 1 --law =", &["--law"]),
        (
            "simulate bouncing_ball --projection maybe",
            &["--projection", "on", "off"],
        ),
        (
            "simulate bead --off-constraint drop",
            &["--off-constraint", "project"],
        ),
        (
            "eval bouncing_ball --newton 1.5",
            &["--newton", "from 0 to 1"],
        ),
        ("eval bouncing_ball --restitution nan", &["--restitution"]),
    ]);
}

#[test]
fn lengths_say_what_was_expected_and_got() {
    check(&[
        (
            "simulate bead --q 1 --qdot 1,2",
            &["--q", "2 numbers (x, y)", "got 1"],
        ),
        (
            "simulate bead --q 1,2 --qdot 1,2,3",
            &["--qdot", "2 numbers (x, y)", "got 3"],
        ),
        ("simulate bead --q 1,2 --p 1,", &["--p (y)"]),
        ("simulate bead --q 0,nan --qdot 1,2", &["--q (y)", "finite"]),
        ("simulate bead --q 0,0 --qdot --p", &["--qdot"]),
    ]);
    assert!(refused(&["simulate", "bead", "--q", "", "--qdot", "1,2"]).contains("got 0"));
}

#[test]
fn flags_that_do_not_go_together() {
    check(&[
        ("simulate bead --q 0,0", &["--q needs --qdot or --p"]),
        ("simulate bead --qdot 0,0", &["need --q"]),
        (
            "simulate bead --q 0,0 --qdot 1,1 --p 1,1",
            &["--qdot", "--p"],
        ),
        (
            "simulate bead --q 0,0 --qdot 1,1 --initial x=1",
            &["--initial", "--q"],
        ),
        ("simulate bouncing_ball", &["--until", "--impacts"]),
        (
            "simulate bead --impacts 3",
            &["--impacts", "no impact surfaces"],
        ),
        (
            "simulate bead --law elastic",
            &["--law", "no impact surfaces"],
        ),
        (
            "simulate bead --law floor=elastic",
            &["--law", "there are none"],
        ),
        (
            "simulate bead --csv - --json -",
            &["--csv", "--json", "once"],
        ),
        ("simulate bead --plot picture.png", &["--plot", ".svg"]),
        ("simulate bead --plot -", &["--plot", ".svg"]),
        ("simulate oscillator", &["`k` has no default", "--set k="]),
        ("eval oscillator", &["`k` has no default"]),
        (
            "simulate bead --initial y=2",
            &["`y`", "outside its interval"],
        ),
    ]);
}

#[test]
fn files_that_cannot_be_opened() {
    check(&[
        (
            "simulate bead --csv /nonexistent/directory/run.csv",
            &["--csv", "/nonexistent/directory/run.csv"],
        ),
        (
            "simulate bead --plot /nonexistent/directory/run.svg",
            &["--plot"],
        ),
        (
            "eval bead --input /nonexistent/states.json",
            &["--input", "/nonexistent/states.json"],
        ),
    ]);
}

#[test]
fn states_that_are_not_states() {
    let cases: [(&str, &[&str]); 18] = [
        ("", &["standard input"]),
        ("{", &["standard input"]),
        ("{}", &["expected a JSON array of states"]),
        ("null", &["expected a JSON array of states"]),
        ("[1]", &["state 0", "expected an object"]),
        ("[{}]", &["state 0", "\"q\" is missing"]),
        (r#"[{"q":[1]}]"#, &["state 0", "one of \"qdot\" and \"p\""]),
        (
            r#"[{"q":[1],"qdot":[1],"p":[1]}]"#,
            &["one of \"qdot\" and \"p\""],
        ),
        (
            r#"[{"q":[1],"qdot":[1]},{"q":[1,2],"qdot":[1]}]"#,
            &["state 1, q", "1 number (x)", "got 2"],
        ),
        (
            r#"[{"q":1,"qdot":[1]}]"#,
            &["state 0, q", "array of numbers"],
        ),
        (
            r#"[{"q":["one"],"qdot":[1]}]"#,
            &["state 0, q (x)", "finite number"],
        ),
        (r#"[{"q":["nan"],"qdot":[1]}]"#, &["finite number"]),
        (r#"[{"q":[null],"qdot":[1]}]"#, &["finite number"]),
        (r#"[{"q":[1e999],"qdot":[1]}]"#, &["standard input"]),
        (
            r#"[{"q":[1],"qdto":[1]}]"#,
            &["unknown key `qdto`", "did you mean `qdot`?"],
        ),
        (r#"[{"q":[1],"qdot":[1],"t":[]}]"#, &["state 0, t"]),
        (
            r#"[{"q":[1],"qdot":[1],"q":[2]}]"#,
            &["standard input", "`q`", "twice"],
        ),
        (
            r#"[{"q":[1],"t":0,"qdot":[1],"t":0}]"#,
            &["standard input", "`t`", "twice"],
        ),
    ];
    for (input, parts) in cases {
        let done = run_on(input, &["eval", "bouncing_ball"]);
        assert_eq!(done.exit, Exit::Refused, "{input}");
        assert!(done.output.is_empty(), "{input}");
        for part in parts {
            assert!(
                done.errors.contains(part),
                "`{input}` gave `{}`, without `{part}`",
                done.errors
            );
        }
    }
}

#[test]
fn deep_and_binary_input_is_refused() {
    for input in [
        "[".repeat(100_000),
        "\u{0}\u{1}".to_owned(),
        "[{\"q\":".repeat(5000),
    ] {
        assert_eq!(
            run_on(&input, &["eval", "bouncing_ball"]).exit,
            Exit::Refused
        );
    }
}

/// Memory is bounded. The message names the limit and the flag.
#[test]
#[cfg(unix)]
fn input_without_end_is_refused() {
    check(&[
        (
            "ensemble bouncing_ball --until 1 --from /dev/zero",
            &["--from /dev/zero", "1048576 bytes"],
        ),
        (
            "eval bouncing_ball --input /dev/zero",
            &["--input /dev/zero", "268435456 bytes"],
        ),
    ]);
}

/// A stream whose writes fail.
struct Failing(ErrorKind);

impl std::io::Write for Failing {
    fn write(&mut self, _bytes: &[u8]) -> std::io::Result<usize> {
        Err(self.0.into())
    }

    fn flush(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}

#[test]
fn a_stream_that_closes_early_needs_no_message() {
    for line in [
        "--help",
        "list",
        "simulate bead --json -",
        "simulate bead --csv -",
        "check bead",
        "simulate bead",
    ] {
        let mut errors = Vec::new();
        let mut streams = Streams {
            input: &mut "".as_bytes(),
            output: &mut Failing(ErrorKind::BrokenPipe),
            errors: &mut errors,
            terminal: false,
        };
        let args = std::iter::once("dalembert").chain(line.split_whitespace());
        assert_eq!(
            run_with(args, systems::entries(), &mut streams),
            Exit::Other,
            "{line}"
        );
        assert!(
            errors.is_empty(),
            "{line}: {}",
            String::from_utf8_lossy(&errors)
        );
    }
}

#[test]
fn output_that_finds_no_room_is_refused() {
    for line in ["--help", "--version", "simulate --help", "list"] {
        let mut errors = Vec::new();
        let mut streams = Streams {
            input: &mut "".as_bytes(),
            output: &mut Failing(ErrorKind::StorageFull),
            errors: &mut errors,
            terminal: false,
        };
        let args = std::iter::once("dalembert").chain(line.split_whitespace());
        let exit = run_with(args, systems::entries(), &mut streams);
        let errors = String::from_utf8_lossy(&errors);
        assert_eq!(exit, Exit::Refused, "{line}: {errors}");
        assert!(errors.contains("standard streams"), "{line}: {errors}");
    }
}

#[test]
fn numbers_at_the_ends_of_the_range_are_drawn_or_refused() {
    let path = std::env::temp_dir().join(format!("dalembert-cli-range-{}.svg", std::process::id()));
    for start in [
        "bouncing_ball --q 1e308 --qdot 1e308",
        "bouncing_ball --q 1e200 --qdot 1e200",
        "bouncing_ball --q 1e150 --qdot 0",
        "bead --q 1e-320,1e-320 --qdot 0,0",
        "oscillator --set k=1 --q 1e-310,0 --qdot 0,5e-324",
    ] {
        let line = format!("simulate {start} --until 1 --plot {}", path.display());
        let done = run(&line);
        let drawn = done.exit != Exit::Refused;
        assert!(
            drawn || done.errors.contains("--plot"),
            "{line}: {}",
            done.errors
        );
    }
    std::fs::remove_file(&path).unwrap();
}

#[test]
fn no_output_replaces_a_file_that_is_read() {
    let folder = Folder::new("replaced");
    let text = "One { coordinates { x; } lagrangian = dot(x)^2/2; initial { x = 1; until = 1; } }";
    let model = folder.file("one.dal", text);
    let starts = folder.file("starts.csv", "x,x_dot\n1,0\n");
    let lines = [
        format!("simulate {model} --csv {model}"),
        format!("simulate {model} --json {model}"),
        format!("derive {model} --json {model}"),
        format!("check {model} --certificate {model}"),
        format!("linearise {model} --json {model}"),
        format!("export {model} --c {model}"),
        format!("accuracy {model} --csv {model}"),
        format!("ensemble {model} --members 2 --csv {model}"),
        format!("ensemble {model} --from {starts} --csv {starts}"),
    ];
    for line in &lines {
        let message = refused(&line.split_whitespace().collect::<Vec<_>>());
        assert!(message.contains("does not read"), "{line}: {message}");
    }
    assert_eq!(folder.read("one.dal"), text);
}

#[test]
fn a_step_that_times_cannot_resolve_is_refused() {
    check(&[
        (
            "simulate bouncing_ball --integrator rk4 --step 1e-300 --until 10",
            &["--step", "`1e-300`", "distance of times"],
        ),
        (
            "simulate bouncing_ball --max-step 1e-17 --until 10",
            &["--max-step", "at least 2.2e-15"],
        ),
    ]);
}

#[test]
fn a_refused_command_leaves_no_new_file() {
    let folder = Folder::new("refused");
    let [picture, table] = ["picture.svg", "table.csv"].map(|name| folder.path(name));
    let lines = [
        format!("simulate bouncing_ball --q 1e300 --qdot 0 --until 1 --plot {picture}"),
        format!("ensemble bouncing_ball --members 2 --until 1 --vary nothing=1..2:2 --csv {table}"),
        format!("simulate bouncing_ball --until 1 --csv {table} --plot {picture} --axes t,nothing"),
    ];
    for line in &lines {
        refused(&line.split_whitespace().collect::<Vec<_>>());
        for path in [&picture, &table] {
            assert!(!std::path::Path::new(path).exists(), "{line} left {path}");
        }
    }
}

#[test]
fn a_table_may_go_to_a_device() {
    for line in [
        "simulate bouncing_ball --until 1 --csv /dev/null",
        "ensemble bouncing_ball --vary x=1..2:3 --until 1 --csv /dev/null",
    ] {
        let done = run(line);
        assert_eq!(done.exit, Exit::Reached, "{line}: {}", done.errors);
    }
    assert!(!std::path::Path::new("/dev/null.meta.json").exists());
}

#[test]
fn an_animation_has_a_largest_length() {
    check(&[(
        "simulate bouncing_ball --until 1 --html never.html --duration 1e20",
        &["--duration", "up to 600"],
    )]);
}

#[test]
fn the_gap_without_a_value_is_named() {
    let text = "Past { coordinates { x; y; } lagrangian = (dot(x)^2 + dot(y)^2)/2;
        impacts { root: sqrt(x) - 1/2 >= 0 when y > 5; } initial { x = 1; dot(x) = -1; until = 4; } }";
    let done = run_on(text, &["simulate", "-"]);
    assert_eq!(done.exit, Exit::Other, "{}", done.errors);
    assert!(
        done.output.contains("non_finite at t = 1"),
        "{}",
        done.output
    );
    assert!(done.output.contains("the gap of `root`"), "{}", done.output);
}

#[test]
fn control_characters_are_not_printed() {
    let text = "P { coordinates { x; } lagrangian = dot(x)^2 + \u{1b}[31m x; }";
    let message = run_on(text, &["check", "-"]).errors;
    assert!(message.contains("the character U+001B"), "{message}");
    assert!(!message.contains('\u{1b}'), "{message}");
}
