//! Refusals in families of modes and transitions.

use super::refusals::refused;

/// A hopper on three legs, with these modes and transitions.
fn hopper(rest: &str) -> String {
    format!(
        "Hopper {{
            const N = 3;
            coordinates {{ x; y; }}
            parameters {{ l[N] > 0 = 1; k[N] > 0 = [1, 2, 3]; }}
            {rest}
        }}"
    )
}

#[track_caller]
fn refused_hopper(rest: &str, message: &str) {
    refused(&hopper(rest), message);
}

/// Checks the message for transitions between the modes `leg[1]` to `leg[3]` and `flight`.
#[track_caller]
fn refused_transition(rest: &str, message: &str) {
    let modes = "leg[i in 1..=N] { lagrangian = dot(x)^2; } flight { lagrangian = dot(y)^2; }";
    refused_hopper(
        &format!("modes {{ {modes} }} transitions {{ {rest} }}"),
        message,
    );
}

#[test]
fn ranges_of_modes_are_known_while_reading() {
    refused_hopper(
        "modes { leg[i in «1..=0»] { } }",
        "`i in 1..=0` takes no value",
    );
    refused_hopper("modes { leg[i in 1..=«M»] { } }", "unknown name `M`");
    refused_hopper(
        "let n = 3; modes { leg[i in 1..=«n»] { } }",
        "`n` is a definition, and a constant is expected here",
    );
    refused_hopper(
        "parameters { n = 3; } modes { leg[i in 1..=«n»] { } }",
        "`n` is a parameter, and a constant is expected here",
    );
    refused_hopper(
        "modes { leg[«0»] { } }",
        "members are counted from 1, found 0",
    );
    refused_hopper(
        "modes { leg[i in «1..=5000»] { } }",
        "takes more than 4096 values",
    );
    refused_hopper("modes { «leg»[i in 1..=33] { } }", "more than 32 modes");
    refused_hopper("modes { «leg»[2] { } }", "mode `leg[1]` is not declared");
    refused_hopper(
        "const M = «k»; modes { leg[i in 1..=M] { } }",
        "`k` is a parameter, and a constant is expected here",
    );
}

#[test]
fn names_of_members_are_taken_once() {
    refused_hopper(
        "modes { leg2 { } «leg»[i in 1..=N] { } }",
        "mode `leg2` declared again",
    );
    refused_hopper(
        "modes { leg[i in 1..=N] { } «leg2» { } }",
        "mode `leg2` declared again",
    );
    refused_hopper(
        "modes { leg { } «leg»[i in 1..=N] { } }",
        "mode `leg` declared alone and as a family",
    );
    refused_hopper(
        "modes { leg[1] { } «leg» { } }",
        "mode `leg` declared alone and as a family",
    );
    let inside = |text: &str| {
        let text = format!("modes {{ leg[i in 1..=2] {{ {text} }} }}");
        refused_hopper(&text, "`i` is the index of `leg` here");
    };
    inside("coordinates { «i»; }");
    inside("let «i» = 3;");
    inside("initial { «i» = 3; }");
}

#[test]
fn references_name_one_mode() {
    refused_transition(
        "go: «leg» -> flight when x >= 0;",
        "`leg` is a family of 3\nhelp: write `leg[1]`",
    );
    refused_transition(
        "go: flight -> «leg2» when x >= 0;",
        "unknown mode `leg2`\nhelp: a member of `leg` is written `leg[2]`",
    );
    refused_transition(
        "go: «flight»[1] -> leg[1] when x >= 0;",
        "`flight` is not a family\nhelp: write `flight`",
    );
    refused_transition(
        "go: «log»[1] -> flight when x >= 0;",
        "unknown mode `log`\nhelp: did you mean `leg`?",
    );
    refused_transition(
        "go[i in 1..=N]: leg[i] -> leg[«i%N + 2»] when x >= 0;",
        "`leg[4]` does not exist\nhelp: `leg` has the members 1 to 3",
    );
    refused_transition(
        "go: leg[«1 - 1»] -> flight when x >= 0;",
        "`leg[0]` does not exist",
    );
    refused_transition(
        "go: leg[«i in 1..=2»] -> flight when x >= 0;",
        "a transition connects one mode with another, found `i in 1..=2`",
    );
    refused_transition(
        "go[i in 1..=N]: leg[i] -> flight when x >= 0 => reset { «i» = 1; };",
        "`i` is the index of `go` here",
    );
    refused_transition(
        "go[«0»]: leg[1] -> flight when x >= 0;",
        "members are counted from 1",
    );
    refused_transition(
        "go[i in 1..=N]: leg[i] -> flight when x >= 0 «+»;",
        "expected an expression",
    );
}

/// Consequences of a mistake elsewhere are not reported.
#[test]
fn consequences_are_not_reported() {
    refused_hopper(
        "const M «=»; modes { leg[i in 1..=M] { } } transitions { go: leg[1] -> leg[2] when x >= 0; }",
        "expected an expression",
    );
    refused_hopper(
        "modes { leg[i in 1..=«M»] { } } transitions { go: leg[1] -> leg[2] when x >= 0; }",
        "unknown name `M`",
    );
}
