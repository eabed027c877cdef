use super::*;

#[test]
fn text_has_a_line_per_model_with_its_counts() {
    let done = run("list");
    assert_eq!(done.exit, Exit::Reached);
    let lines: Vec<&str> = done.output.lines().collect();
    assert_eq!(
        lines[1],
        "bouncing_ball    1   0   1  A ball above a floor."
    );
    assert_eq!(lines[3], "bead             2   1   0");
    assert_eq!(lines.len(), 4);
}

#[test]
fn json_has_the_same_and_the_names() {
    let list = run("list --format json").json();
    assert_eq!(list[0]["name"], "bouncing_ball");
    assert_eq!(
        (&list[2]["N"], &list[2]["M"], &list[2]["S"]),
        (&2.into(), &1.into(), &0.into())
    );
    assert_eq!(list[0]["surfaces"][0], "floor");
    assert_eq!(list[1]["coordinates"][1], "x.2");
}

/// `--json FILE` writes what `--format json` prints, beside the text; `--json -` prints it in place of the text.
#[test]
fn documents_go_to_files_and_to_the_standard_output() {
    let path = std::env::temp_dir().join(format!("dalembert-json-{}", std::process::id()));
    for line in [
        "list",
        "derive bouncing_ball",
        "derive bouncing_ball --bracket x,momentum(x)",
        "check bouncing_ball",
        "check bouncing_ball --bendixson",
    ] {
        let [text, document] =
            ["text", "json"].map(|format| run(&format!("{line} --format {format}")));
        let printed = run(&format!("{line} --json -"));
        assert_eq!(
            (printed.exit, &printed.output),
            (document.exit, &document.output),
            "{line}"
        );
        let written = run(&format!("{line} --json {}", path.display()));
        assert_eq!(
            (written.exit, &written.output),
            (text.exit, &text.output),
            "{line}"
        );
        assert_eq!(
            std::fs::read_to_string(&path).unwrap(),
            document.output,
            "{line}"
        );
        std::fs::remove_file(&path).unwrap();
    }
    let both = run("list --json - --format text");
    assert!(
        both.errors.contains("cannot be used with"),
        "{}",
        both.errors
    );
}

#[test]
fn every_command_has_help_with_examples() {
    for command in [
        "list",
        "derive",
        "check",
        "simulate",
        "orbit",
        "eval",
        "stability",
    ] {
        let done = run(&format!("{command} --help"));
        assert_eq!(done.exit, Exit::Reached, "{command}");
        let (head, rest) = done.output.split_once("\nUsage:").expect("the usage");
        assert!(head.contains("\nExample: "), "{command}");
        assert!(rest.contains("More examples:"), "{command}");
        assert!(done.errors.is_empty());
    }
}
