//! The first example of every help text runs and succeeds.

use crate::reference::{commands, help};
use crate::session::Session;

/// The command line after `Example: `, which stands between purpose and usage.
fn first_example(help: &str) -> Option<&str> {
    let (head, _) = help.split_once("\nUsage: ")?;
    let mut lines = head.lines();
    lines.find_map(|line| line.strip_prefix("Example: "))
}

#[test]
fn every_help_has_a_first_example_that_runs() {
    let overview = help(None);
    let names = commands(&overview);
    let mut session = Session::begin("examples");
    for command in names.into_iter().map(Some).chain([None]) {
        let text = help(command);
        let example = first_example(&text).unwrap_or_else(|| panic!("{command:?}: {text}"));
        let line = match command {
            // The hard cases are in another package.
            Some("stability") => {
                assert!(example.contains("-p dalembert-stability"), "{example}");
                continue;
            }
            // The command runs until it is stopped.
            Some("watch") => format!("{example} --runs 1"),
            _ => example.to_owned(),
        };
        if let Some(name) = command {
            assert!(line.contains(&format!("dalembert {name}")), "{line}");
        }
        let fresh = format!("$ rm -rf pendulum pendulum.dal && {line}\n");
        if let Err(mistake) = session.commands(&fresh, true) {
            panic!("{mistake}");
        }
    }
}
