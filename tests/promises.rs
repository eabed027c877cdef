//! `docs/promises.md` names tests and cases that exist and hold; the commands of `docs/cases.md` succeed.

use std::path::Path;

use dalembert_cli::{Exit, Streams};
use dalembert_stability as stability;

const PROMISES: &str = include_str!("../docs/promises.md");
const CASES: &str = include_str!("../docs/cases.md");

/// The words in backticks.
fn quoted(text: &str) -> impl Iterator<Item = &str> {
    text.split('`').skip(1).step_by(2)
}

/// Describes the error of a table row `promise | kind | shown by`; `None` if it has none.
fn difference(row: &str) -> Option<String> {
    let cells: Vec<&str> = row.trim_matches('|').split(" | ").map(str::trim).collect();
    let [_, kind, shown] = cells[..] else {
        return Some("not three cells".to_owned());
    };
    if !["guaranteed", "flagged", "not handled"].contains(&kind) {
        return Some(format!("`{kind}` is no kind"));
    }
    let cases = stability::all();
    let (mut file, mut named) = (String::new(), 0);
    for name in quoted(shown) {
        if name.ends_with(".rs") {
            let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(name);
            file = std::fs::read_to_string(path).unwrap_or_default();
            continue;
        }
        named += 1;
        match cases.iter().find(|case| case.id == name) {
            Some(case) if case.pending.is_some() != (kind == "not handled") => {
                return Some(format!("`{name}` is not as `{kind}` says"));
            }
            Some(_) => {}
            None if file.contains(&format!("fn {name}(")) => {}
            None => return Some(format!("there is no `{name}`")),
        }
    }
    (named == 0).then(|| "nothing shows it".to_owned())
}

/// The rows of all tables, without their heads.
fn rows() -> impl Iterator<Item = &'static str> {
    let lines = PROMISES.lines().filter(|line| line.starts_with("| "));
    lines.filter(|line| !line.starts_with("| promise |"))
}

#[test]
fn every_promise_is_shown_by_what_it_names() {
    assert!(rows().count() > 40);
    let differences: Vec<String> = rows()
        .filter_map(|row| Some(format!("{row}\n  {}", difference(row)?)))
        .collect();
    assert!(differences.is_empty(), "{}", differences.join("\n"));
}

#[test]
fn a_wrong_promise_is_noticed() {
    assert_eq!(difference("| a | guaranteed | `A01` |"), None);
    assert_eq!(
        difference("| a | guaranteed | `tests/no_std.rs` `a_program_without_std_links_and_runs` |"),
        None
    );
    for wrong in [
        "| a | guaranteed | `A99` |",
        "| a | not handled | `A01` |",
        "| a | promised | `A01` |",
        "| a | guaranteed | `tests/no_std.rs` `a_program_without_std` |",
        "| a | guaranteed | |",
    ] {
        assert!(difference(wrong).is_some(), "{wrong}");
    }
}

#[test]
fn every_command_of_the_cases_succeeds() {
    let commands: Vec<&str> = CASES
        .lines()
        .filter_map(|line| line.strip_prefix("cargo run --release "))
        .filter_map(|line| Some(line.split_once("-- ")?.1))
        .collect();
    assert!(commands.len() >= 10, "{commands:?}");
    for command in commands {
        let (mut output, mut errors) = (Vec::new(), Vec::new());
        let mut streams = Streams {
            input: &mut std::io::empty(),
            output: &mut output,
            errors: &mut errors,
            terminal: false,
        };
        let line = ["dalembert"].into_iter().chain(command.split(' '));
        let exit = stability::catalogue().run_with(line, &mut streams);
        let output = String::from_utf8_lossy(&output);
        assert_eq!(exit, Exit::Reached, "{command}\n{output}");
        let holds = !command.starts_with("stability") || output.contains("1 pass");
        assert!(holds, "{command}\n{output}");
    }
}
