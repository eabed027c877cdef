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
