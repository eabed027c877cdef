use super::*;

#[test]
fn the_source_is_derived_again_in_every_format() {
    for (format, part) in [
        ("text", "m"),
        ("latex", "\\begin{document}"),
        ("json", "\"model\""),
    ] {
        let done = run(&format!("derive bouncing_ball --format {format}"));
        assert_eq!(done.exit, Exit::Reached, "{}", done.errors);
        assert!(done.output.contains(part), "{format}: {}", done.output);
    }
    assert_eq!(
        run("derive bouncing_ball --format json").json()["model"],
        "bouncing_ball"
    );
}

#[test]
fn a_source_that_the_generator_refuses_is_an_error() {
    let done = run("derive oscillator");
    assert_eq!(done.exit, Exit::Refused);
    assert!(
        done.errors.starts_with("error: derive: "),
        "{}",
        done.errors
    );
}
