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
    let done = run_over(&[systems::made_by_hand()], "", &["derive", "oscillator"]);
    assert_eq!(done.exit, Exit::Refused);
    assert!(
        done.errors.starts_with("error: derive: "),
        "{}",
        done.errors
    );
}

#[test]
fn brackets_and_groups_are_printed_in_every_format() {
    for (flags, line) in [
        ("--bracket x,momentum(x)", "  {x, momentum(x)} = 1\n"),
        (
            "--bracket momentum(x),energy",
            "  {momentum(x), energy} = -m*g\n",
        ),
        (
            "--jacobiator x,momentum(x),energy",
            "  Jac(x, momentum(x), energy) = 0\n",
        ),
    ] {
        let done = run(&format!("derive bouncing_ball {flags}"));
        assert_eq!(done.exit, Exit::Reached, "{}", done.errors);
        assert!(done.output.contains(line), "{flags}: {}", done.output);
    }
    let done = run("derive bouncing_ball --bracket x,momentum(x) --format latex");
    assert!(done.output.contains("\\[ \\{x, "), "{}", done.output);
    let bracket = run("derive bouncing_ball --bracket x,momentum(x) --format json").json();
    let item = &bracket["sections"][0]["items"][0];
    assert_eq!(item["left"]["text"], "{x, momentum(x)}");
    assert_eq!(item["right"]["text"], "1");
}

#[test]
fn what_has_no_bracket_and_what_is_no_symmetry_is_refused_with_the_flag() {
    for (flags, parts) in [
        ("--bracket x", vec!["--bracket: ", "2 functions"]),
        ("--bracket x,z", vec!["--bracket: ", "`z`"]),
        (
            "--jacobiator x,energy",
            vec!["--jacobiator: ", "3 functions"],
        ),
        (
            "--group partial(x)",
            vec!["--group: ", "`partial(x)` is no symmetry"],
        ),
        ("--group x", vec!["--group: ", "is not a vector field"]),
        (
            "--group partial(x) --bracket x,energy",
            vec!["--bracket", "cannot be used with"],
        ),
    ] {
        let done = run(&format!("derive bouncing_ball {flags}"));
        assert_eq!(done.exit, Exit::Refused, "{flags}: {}", done.output);
        for part in parts {
            assert!(done.errors.contains(part), "{flags}: {}", done.errors);
        }
    }
}

/// The momentum of a group that no motion on the constraints follows is changed by impacts.
#[test]
fn no_impact_is_said_to_keep_momenta_that_it_changes() {
    let text = "Spin { coordinates { x; y; } lagrangian = (dot(x)^2 + dot(y)^2)/2;
        constraints { c: dot(y) = dot(x)*x; } impacts { w: y + x <= 1; } }";
    let done = run_on(text, &["derive", "-", "--group", "partial(y)"]);
    assert!(!done.output.contains("keeps"), "{}", done.output);
    assert!(
        done.output.contains("impacts may change J"),
        "{}",
        done.output
    );
}

#[test]
fn the_equations_of_every_mode_are_derived() {
    let hill = "Hill {
        coordinates { x; }
        modes {
            low { lagrangian = dot(x)^2/2; initial { x = -1; dot(x) = 1; until = 2; } }
            high { lagrangian = dot(x)^2/2 - x; }
        }
        transitions { up: low -> high when x >= 0; down: high -> low when x <= 0; }
    }";
    let derived = |options: &[&str]| run_on(hill, &[&["derive", "-"], options].concat());
    let text = derived(&[]).output;
    for part in [
        "Mode low",
        "Mode high",
        "Lagrangian",
        "Work of the emitted functions",
    ] {
        assert!(text.contains(part), "{part}: {text}");
    }
    let latex = derived(&["--format", "latex"]).output;
    assert_eq!(latex.matches("\\section*{Mode ").count(), 2, "{latex}");
    assert_eq!(latex.matches("\\end{document}").count(), 1);
    let document = derived(&["--format", "json"]).json();
    assert_eq!(document["modes"][1]["model"], "high");
    let one = derived(&["--scene", "high", "--format", "json"]).json();
    assert_eq!(document["modes"][1], one);
    assert!(one["modes"].is_null());
}
