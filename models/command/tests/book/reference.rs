//! The page of the command line, made from `--help`.

use std::process::Command;

use crate::pages;
use crate::session::PROGRAM;

const PAGE: &str = "reference/command_line.md";
const HEAD: &str = "# Command line

The texts below are printed by `dalembert --help` and `dalembert COMMAND --help`.
A test compares this page with them; `ACCEPT=1 cargo test -p dalembert-command --test book` writes it anew.
";

/// Help text of a command; that of the program for `None`.
pub fn help(command: Option<&str>) -> String {
    let mut program = Command::new(PROGRAM);
    let done = program.args(command).arg("--help").output();
    let printed = done.expect("the command runs").stdout;
    String::from_utf8(printed).expect("text")
}

/// Names of the commands, from the help text of the program.
pub fn commands(overview: &str) -> Vec<&str> {
    let (_, list) = overview.split_once("Commands:\n").expect("commands");
    let list = list.split("\n\n").next().unwrap_or_default();
    let names = list.lines().filter_map(|line| line.strip_prefix("  "));
    names
        .filter(|line| !line.starts_with(' '))
        .filter_map(|line| line.split_whitespace().next())
        .filter(|name| *name != "help")
        .collect()
}

fn block(title: &str, text: &str) -> String {
    let lines: Vec<&str> = text.lines().map(str::trim_end).collect();
    format!(
        "\n## {title}\n\n```text\n{}\n```\n",
        lines.join("\n").trim()
    )
}

#[test]
fn the_page_of_the_command_line_is_the_help() {
    let overview = help(None);
    let mut made = format!("{HEAD}{}", block("dalembert", &overview));
    let names = commands(&overview);
    assert!(names.len() >= 10, "{names:?}");
    for name in names {
        made.push_str(&block(&format!("dalembert {name}"), &help(Some(name))));
    }
    if std::env::var_os("ACCEPT").is_some() {
        std::fs::write(pages::folder().join(PAGE), &made).expect("a writable folder");
    }
    let stored = pages::text(PAGE);
    let differing = stored.lines().zip(made.lines()).find(|(a, b)| a != b);
    assert_eq!(
        differing, None,
        "stored and printed; write it with ACCEPT=1"
    );
    assert_eq!(stored.len(), made.len(), "write it with ACCEPT=1");
}

/// Names of the outcomes, as the runtime writes them.
fn outcomes() -> impl Iterator<Item = &'static str> {
    let source = include_str!("../../../../runtime/src/outcome.rs");
    let (_, kinds) = source.split_once("fn kind(").expect("the names");
    let kinds = kinds.split("fn ").next().unwrap_or_default();
    kinds.split('"').skip(1).step_by(2)
}

#[test]
fn every_outcome_is_explained() {
    let page = pages::text("reference/messages.md");
    let (_, table) = page.split_once("## Outcomes").expect("the table");
    assert!(outcomes().count() >= 25);
    for kind in outcomes() {
        assert!(table.contains(&format!("`{kind}`")), "`{kind}` is missing");
    }
}
