//! One test case per error of the parser: the message, and the source text that it points at, marked `«..»`.

use super::{lagrangian, read};
use crate::marks::{reported, unmarked};

/// Checks that there is exactly one error, with this message, at the marked place.
#[track_caller]
pub(super) fn refused(source: &str, message: &str) {
    let (source, marked) = unmarked(source);
    let diagnostics = read(&source).expect_err("accepted");
    let errors = reported(&source, &diagnostics);
    assert_eq!(errors.len(), 1, "{errors:?}");
    assert!(errors[0].0.contains(message), "{}", errors[0].0);
    assert_eq!(errors[0].1, marked, "{}", errors[0].0);
}

#[track_caller]
pub(super) fn refused_expression(expression: &str, message: &str) {
    refused(&lagrangian(expression), message);
}

#[track_caller]
pub(super) fn refused_in(rest: &str, message: &str) {
    refused(
        &format!("P {{ coordinates {{ x; }} lagrangian = x; {rest} }}"),
        message,
    );
}

#[test]
fn long_words_are_refused_with_short_messages() {
    let name = "a".repeat(10_000);
    refused_expression(
        &format!("«{name}»"),
        "the name `aaaaaaaaaaaa..` has 10000 letters; the limit is 64",
    );
    let number = "1".repeat(1 << 16);
    refused_expression(
        &format!("«{number}»"),
        "a number of 65536 digits; the limit is 40",
    );
}

#[test]
fn nesting_is_bounded() {
    let nested = |depth: usize| format!("{}x{}", "(".repeat(depth), ")".repeat(depth));
    assert!(read(&lagrangian(&nested(255))).is_ok());
    let errors = read(&lagrangian(&nested(1000))).unwrap_err();
    assert!(
        errors
            .iter()
            .next()
            .unwrap()
            .message()
            .starts_with("nested 1001 deep; the limit is 256")
    );
    let exponents = format!("{}x", "x^".repeat(1000));
    let errors = read(&lagrangian(&exponents)).unwrap_err();
    assert!(
        errors
            .iter()
            .next()
            .unwrap()
            .message()
            .starts_with("exponents are nested more than 256 deep")
    );
    assert!(read(&lagrangian(&format!("x{}x", "-".repeat(100_000)))).is_ok());
}

#[test]
fn missing_semicolons_are_named_behind_the_last_token() {
    refused(
        "P { coordinates { «x» y; } lagrangian = x; }",
        "expected `;`",
    );
    refused(
        "P { coordinates { x; «y» } lagrangian = x; }",
        "expected `;`",
    );
    refused(
        "P { lagrangian = x^«2» coordinates { x; } }",
        "expected `;`",
    );
    refused(
        "P { coordinates { x; } parameters { m > 0 = 1 «k» > 0 = 1; } lagrangian = x; }",
        "missing operator before `k`",
    );
    refused(
        "P { coordinates { x; } parameters { m > «0» k > 0 = 1; } lagrangian = x; }",
        "expected `;`",
    );
    refused("P { coordinates { x; } lagrangian = «x» }", "expected `;`");
}

#[test]
fn declarations_are_known() {
    refused_in(
        "«constriants» { c: d(x) = 0; }",
        "unknown declaration `constriants`\nhelp: did you mean `constraints`?",
    );
    refused_in(
        "«banana» { }",
        "unknown declaration `banana`\nhelp: a model consists of `const`",
    );
    refused_in(
        "«banana» = 3;",
        "unknown declaration `banana`\nhelp: a definition is written `let banana = ..;`",
    );
    refused_in("«L» = x;", "help: write `lagrangian = ..;`");
    refused_in("«params» { m; }", "help: write `parameters { .. }`");
    refused_in(
        "«potential» = x;",
        "help: the Lagrangian is kinetic minus potential energy",
    );
    refused_in("«lagrangian» = 2;", "`lagrangian` declared again");
    refused(
        "P { «coordinates» { } lagrangian = 1; }",
        "a model needs at least one coordinate",
    );
    refused_in("initial «=» 3;", "expected `{ .. }` after `initial`");
    refused_in(
        "«#»[cfg(test)] let a = 1;",
        "unknown attribute\nhelp: a comment is written `// ..`",
    );
    refused_in(
        "«#»[global] let a = 1;",
        "`#[global]` belongs to a whole model\nhelp: write it before the name of the model",
    );
    refused(
        "«#»[global] P { coordinates { x; } lagrangian = dot(x)^2; modes { a { } b { } } }",
        "the modes of a model always have their global forms\nhelp: leave out `#[global]`",
    );
    refused_in(
        "«until» = 3;",
        "help: write it into `initial { until = ..; }`",
    );
    refused(
        "P { coordinates { x; } lagrangian = x; } «Q» {}",
        "declare one model in each `model!`",
    );
    refused("pub «{ }»", "expected the name of a model");
}

#[test]
fn instantaneous_constraints_stand_in_braces_behind_a_law() {
    let in_surface = |rest: &str, text: &str| {
        refused_in(&format!("impacts {{ w: x >= 0 => {rest}; }}"), text);
    };
    in_surface(
        "elastic, «instantaneous» { }",
        "no instantaneous constraint",
    );
    in_surface("elastic, instantaneous «5»", "expected `{ .. }` after");
    in_surface("elastic, «sticky» { }", "expected `instantaneous { .. }`");
    in_surface("elastic, instantaneous { s: x «>=» 0; }", "expected `=`");
    in_surface("elastic, instantaneous { s: x = «0» }", "expected `;`");
    in_surface("reset { }, «instantaneous» { }", "a reset takes no");
}

#[test]
fn modes_and_transitions_keep_their_forms() {
    refused_in("«modes» { }", "`modes` needs at least one mode");
    refused_in(
        "«transitions» { a: b -> c when x >= 0; }",
        "`transitions` needs at least one mode",
    );
    refused_in("modes { «a» }", "expected `{ .. }` after the mode `a`");
    refused_in("modes { a { } «a» { } }", "mode `a` declared again");
    refused_in("modes { «sin» { } }", "`sin` is reserved");
    refused_in(
        "modes { a { «parameters» { k = 1; } } }",
        "`parameters` belongs outside of `modes`",
    );
    refused_in(
        "modes { a { «const» N = 1; } }",
        "`const` belongs outside of `modes`",
    );
    refused_in(
        "modes { a { } } «scenes» { s; }",
        "a model with modes has no `scenes`",
    );
    refused_in(
        "modes { a { } } «cost» { running = x; }",
        "a model with modes has no `cost`",
    );
    refused_in(
        "modes { a { «inputs» { u; } } }",
        "`inputs` belongs outside of `modes`",
    );
    refused_in(
        "modes { a { «modes» { b { } } } }",
        "`modes` is not allowed inside a mode",
    );
    let transition = |text: &str, message: &str| {
        refused_in(
            &format!("modes {{ a {{ }} b {{ }} }} transitions {{ {text} }}"),
            message,
        );
    };
    transition("go: a «=>» b when x >= 0;", "expected `->`, found `=>`");
    transition("go: a -> b «x» >= 0;", "expected `when`");
    transition(
        "go: a -> b when x «>» 0;",
        "expected `>=` or `<=`, found `>`",
    );
    transition("«a» -> b when x >= 0;", "a transition begins with its name");
}

#[test]
fn rates_are_written_with_dot() {
    refused_in("field { «x» = 1; }", "`x` is not a rate");
    refused_in("field { dot(x «+» y) = 1; }", "expected one coordinate");
    refused_in("field { dot(x) «==» 1; }", "expected `=`, found `==`");
}

#[test]
fn reserved_words_are_not_declared() {
    refused(
        "P { coordinates { «dot»; } lagrangian = 1; }",
        "`dot` is reserved",
    );
    refused(
        "P { coordinates { «sin»; } lagrangian = 1; }",
        "`sin` is reserved",
    );
    refused(
        "P { coordinates { «move»; } lagrangian = 1; }",
        "`move` is a keyword of Rust",
    );
    refused_in("let «t» = 1;", "`t` is reserved");
    refused_in("let f(«pi») = 1;", "`pi` is reserved");
    refused_in(
        "constraints { «energy»: d(x) = 0; }",
        "`energy` is reserved",
    );
}

#[test]
fn sections_keep_their_forms() {
    refused_in(
        "constraints { c: d(x) «==» 0; }",
        "expected `=`, found `==`",
    );
    refused_in("constraints { c: d«(x)»; }", "expected `=`");
    refused_in(
        "impacts { w: x «>» 0; }",
        "expected `>=` or `<=`, found `>`",
    );
    refused_in(
        "impacts { w: x >= 0 when y «==» 0; }",
        "expected `>=`, `<=`, `>` or `<`, found `==`",
    );
    refused_in(
        "impacts { w: x >= 0 when y > 0 «and» z > 0; }",
        "several conditions are written",
    );
    refused_in(
        "impacts { w: x >= 0 => elastic «when» y > 0; }",
        "conditions stand before the law",
    );
    refused_in(
        "parameters { m > «1»; }",
        "`>`, `>=` and `!=` compare a parameter with 0 only",
    );
    refused_in("parameters { m «<» 0; }", "expected an assumption");
    refused_in(
        "view { path: «(x)»; }",
        "the components of a path are two expressions, found 1",
    );
    refused_in("view { «paht»: (x, y); }", "unknown entry `paht` of `view`");
    refused(
        "P { coordinates { x: «circle»; } lagrangian = x; }",
        "expected `angle`, found `circle`",
    );
}

#[test]
fn independent_mistakes_are_all_reported() {
    let source = "P { coordinates { x y; z; } lagrangian = 2x; constraints { a: d(x) == 0; b: d(z) = 0; c: = 0; } modes { } }";
    assert_eq!(read(source).unwrap_err().len(), 5);
}

#[test]
fn a_model_and_its_module_have_two_names() {
    let named = |name: &str| format!("{name} {{ coordinates {{ x; }} lagrangian = x; }}");
    refused(
        &named("pub «pendulum»"),
        "`pendulum` would name both the type and its module\nhelp: write the type in camel case: `Pendulum`",
    );
    refused(&named("«rolling_disk»"), "camel case: `RollingDisk`");
    refused(&named("«t»"), "camel case: `T`");
    refused(&named("«__»"), "camel case, like `RollingDisk`");
    refused(
        &named("pub «Loop»"),
        "the module of `Loop` cannot be called `loop`, a keyword of Rust\nhelp: choose another name, for example `LoopModel`",
    );
    refused(&named("«Match»"), "cannot be called `match`");
    refused(&named("«Box»"), "cannot be called `box`");
    refused(&named("«Type»"), "cannot be called `type`");
    refused(&named("«Self»"), "`Self` is a keyword of Rust");
    refused(&named("«r#Loop»"), "`r#Loop` is a keyword of Rust");
    refused(
        &named("pub «struct» P"),
        "expected the name of a model, found `struct`\nhelp: a model is written `pub Name",
    );
    refused(
        "«coordinates» { x; } lagrangian = x;",
        "expected the name of a model, found `coordinates`",
    );
}
