//! What the parser reads, and what it says of what it cannot read.

#![allow(clippy::unwrap_used)] // a test may stop at the first surprise

use proc_macro2::{Delimiter, Group, TokenStream, TokenTree};

use super::{ScalarKind, Spec, parse};
use crate::diagnostics::{Diagnostics, reported, unmarked};

const MODEL: &str = "
    /// A model.
    pub(crate) Chain {
        const N = 4;
        coordinates { x; u in (0, 2*pi); theta[N]: angle; }
        /// parameters
        parameters { /** mass */ m[N] > 0 = [1, 2, 3, 4]; l > 0 = 0.5; e in [0, 1] = 1; k != 0; }
        let f(a, b) = a^2 + b^-1;
        let X[0] = 0;
        let X[i in 1..=N] = X[i - 1] + l*sin(theta[i % N + 1]);
        lagrangian = sum(i in 1..=N: m[i]/2*dot(X[i])^2) + dot(x)^2 + dot(u)^2 - f(x, u);
        constraints { joint[i in 1..=2]: d(theta[i]) - 2*d(x) = 3*d(t); }
        forces { drag: -k*dot(x)*d(x); }
        impacts { wall: x <= 1 + l/2 when u > 1 when x < 2 => restitution(e); floor: x >= -1; }
        initial { theta[i in 1..=N] = 0.1*i; dot(theta[1]) = 1; until = 10; }
        view { path: (x, X[N]); region: 1 - x >= 0; }
        outputs { load[i in 1..=2]: multiplier(joint[i]); }
    }";

fn read(source: &str) -> Result<Spec, Diagnostics> {
    parse(source.parse().unwrap())
}

fn lagrangian(expression: &str) -> String {
    format!("P {{ coordinates {{ x; }} lagrangian = {expression}; }}")
}

fn tree(expression: &str) -> String {
    let spec = read(&lagrangian(expression)).unwrap();
    bracketed(&spec.lagrangian.unwrap().value.kind)
}

/// The expression with every operation in brackets.
fn bracketed(kind: &ScalarKind) -> String {
    match kind {
        ScalarKind::Negative(inner) => format!("(-{})", bracketed(&inner.kind)),
        ScalarKind::Power(base, exponent) => {
            format!("({}^{})", bracketed(&base.kind), bracketed(&exponent.kind))
        }
        ScalarKind::Sum(terms) => {
            let signed = |(negative, term): &(bool, super::Scalar)| {
                format!(
                    "{}{}",
                    if *negative { "-" } else { "+" },
                    bracketed(&term.kind)
                )
            };
            format!("({})", terms.iter().map(signed).collect::<String>())
        }
        ScalarKind::Product(factors) => {
            let signed = |(operator, factor): &(super::Operator, super::Scalar)| {
                let sign = match operator {
                    super::Operator::Times => '*',
                    super::Operator::Over => '/',
                    super::Operator::Modulo => '%',
                };
                format!("{sign}{}", bracketed(&factor.kind))
            };
            format!("({})", factors.iter().map(signed).collect::<String>())
        }
        other => super::Scalar {
            kind: other.clone(),
            at: proc_macro2::Span::call_site().into(),
        }
        .to_string(),
    }
}

/// Exactly one error, with this message, at the marked place.
#[track_caller]
fn refused(source: &str, message: &str) {
    let (source, marked) = unmarked(source);
    let diagnostics = read(&source).expect_err("accepted");
    let errors = reported(&source, &diagnostics);
    assert_eq!(errors.len(), 1, "{errors:?}");
    assert!(errors[0].0.contains(message), "{}", errors[0].0);
    assert_eq!(errors[0].1, marked, "{}", errors[0].0);
}

#[track_caller]
fn refused_expression(expression: &str, message: &str) {
    refused(&lagrangian(expression), message);
}

#[track_caller]
fn refused_in(rest: &str, message: &str) {
    refused(
        &format!("P {{ coordinates {{ x; }} lagrangian = x; {rest} }}"),
        message,
    );
}

#[test]
fn every_declaration_is_read() {
    let spec = read(MODEL).unwrap();
    assert_eq!(spec.visibility, "pub(crate)");
    assert_eq!(spec.documentation, ["A model."]);
    assert_eq!(spec.coordinates.len(), 3);
    assert_eq!(spec.parameters[0].documentation, ["mass"]);
    assert_eq!(spec.definitions.len(), 3);
    assert_eq!(spec.surfaces[0].conditions.len(), 2);
    assert_eq!(spec.surfaces[0].gap.greater.to_string(), "1 + l/2");
    assert_eq!(
        spec.surfaces[0].law.as_ref().unwrap().name.text,
        "restitution"
    );
    assert_eq!(spec.initial.len(), 3);
    assert_eq!(spec.view.path.as_ref().unwrap()[1].to_string(), "X[N]");
    assert_eq!(spec.constraints[0].left.to_string(), "d(theta[i]) - 2*d(x)");
}

#[test]
fn powers_bind_tighter_than_signs_and_to_the_right() {
    assert_eq!(tree("-x^2"), "(-(x^2))");
    assert_eq!(tree("x^2^3"), "(x^(2^3))");
    assert_eq!(tree("x^-1/2"), "(*(x^(-1))/2)");
    assert_eq!(tree("a + b^2*c"), "(+a+(*(b^2)*c))");
    assert_eq!(tree("a - b - c"), "(+a-b-c)");
    assert_eq!(tree("--x*y"), "(*x*y)");
    assert_eq!(tree("a/b*c % 2"), "(*a/b*c%2)");
}

#[test]
fn expressions_are_written_as_a_person_would() {
    for text in [
        "a - (b - c)",
        "-x^2",
        "(a + b)^2",
        "(a*b)^2",
        "x^(1/2)",
        "a/(b*c)",
        "2*(a + b)",
        "(-x)^2",
        "sum(i in 1..=N: i)",
    ] {
        let spec = read(&lagrangian(text)).unwrap();
        assert_eq!(spec.lagrangian.unwrap().value.to_string(), text);
    }
}

#[test]
fn an_invisible_group_is_an_atom() {
    let sum: TokenStream = "a + b".parse().unwrap();
    let group = TokenTree::from(Group::new(Delimiter::None, sum));
    let mut tokens: Vec<TokenTree> = "coordinates { x; } lagrangian = 2 *"
        .parse::<TokenStream>()
        .unwrap()
        .into_iter()
        .collect();
    tokens.push(group);
    tokens.extend("^ 2;".parse::<TokenStream>().unwrap());
    let body = TokenTree::from(Group::new(Delimiter::Brace, tokens.into_iter().collect()));
    let mut model: TokenStream = "P".parse().unwrap();
    model.extend([body]);
    let spec = parse(model).unwrap();
    assert!(
        without_blanks(&spec.source).contains("lagrangian=2*(a+b)^2;"),
        "{}",
        spec.source
    );
    assert_eq!(spec.lagrangian.unwrap().value.to_string(), "2*(a + b)^2");
}

fn without_blanks(text: &str) -> String {
    text.chars()
        .filter(|character| !character.is_whitespace())
        .collect()
}

#[test]
fn slips_in_expressions_are_named() {
    refused_expression("«2x»", "missing `*` between `2` and `x`\nhelp: write `2*x`");
    refused_expression("«1.5e3m»", "missing `*` between `1.5e3` and `m`");
    refused_expression("«2f64»", "numbers have no type: `f64`\nhelp: write `2`");
    refused_expression("«0x10»", "numbers are decimal");
    refused_expression("«1e400»", "`1e400` is not a finite number");
    refused_expression(
        "x «**» 2",
        "no `**` operator\nhelp: a power is written `x^2`",
    );
    refused_expression(
        "sin «x»",
        "function call needs parentheses\nhelp: write `sin(x)`",
    );
    refused_expression("«sin»^2*x", "the power of a function is written `sin(x)^2`");
    refused_expression("m «v»^2", "missing operator before `v`");
    refused_expression("x «<» 1", "`<` is not differentiable");
    refused_expression("x «==» 1", "`==` is not differentiable");
    refused_expression("«if»(x)", "`if` is not differentiable");
    refused_expression("x «if» y", "an expression has no cases");
    refused_expression("«|»x|", "the absolute value is written `abs(x)`");
    refused_expression("theta«.»3", "a member of a family is written `theta[3]`");
    refused_expression("«\"text\"»", "expected an expression, found a text");
    refused_expression("x «+»", "expected an expression");
    refused_expression("«(»)", "expected an expression");
    refused_expression("sum(i in 1«.».N: x)", "expected `..=`");
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
            .starts_with("more than 256 exponents above each other")
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
        "«banana» = 3;",
        "unknown declaration `banana`\nhelp: a model consists of `const`",
    );
    refused_in("«lagrangian» = 2;", "second `lagrangian`");
    refused(
        "P { «coordinates» { } lagrangian = 1; }",
        "a model needs at least one coordinate",
    );
    refused_in("initial «=» 3;", "expected `{ .. }` after `initial`");
    refused_in(
        "«#»[cfg(test)] let a = 1;",
        "attributes are not part of a model",
    );
    refused(
        "P { coordinates { x; } lagrangian = x; } «Q» {}",
        "declare one model in each `model!`",
    );
    refused("pub «{ }»", "expected the name of a model");
}

#[test]
fn declarations_to_come_are_refused_by_name() {
    for word in ["scenes", "frame", "modes", "transitions", "field", "inputs"] {
        let message = format!("`{word}` is not implemented in this version\nhelp: ");
        refused_in(&format!("«{word}» {{ a: b; }}"), &message);
    }
    refused_in(
        "impacts { w: x >= 0 => «reset» { x = 1; }; }",
        "`reset` is not implemented in this version",
    );
    refused_in(
        "impacts { w: x >= 0 => elastic, «instantaneous» { }; }",
        "`instantaneous` is not implemented",
    );
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
        "`move` is a word of Rust",
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
        "impacts { w: x >= 0 when y «>=» 0; }",
        "expected `>` or `<`, found `>=`",
    );
    refused_in(
        "impacts { w: x >= 0 when y > 0 «and» z > 0; }",
        "several conditions are written",
    );
    refused_in(
        "impacts { w: x >= 0 => elastic «when» y > 0; }",
        "conditions stand before the law",
    );
    refused_in("parameters { m > «1»; }", "assumptions compare with 0");
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
fn models_with_tokens_missing_never_panic() {
    let mut random = Random(1);
    for _ in 0..2000 {
        let tokens = thinned(MODEL.parse().unwrap(), &mut random);
        if let Ok(spec) = parse(tokens) {
            let _ = crate::model::check(&spec).map_err(Diagnostics::into_compile_error);
        }
    }
}

#[test]
fn models_with_single_tokens_missing_never_panic() {
    let mut random = Random(2);
    let count = 400;
    for _ in 0..count {
        let mut position = random.next() % 300;
        let tokens = without(MODEL.parse().unwrap(), &mut position);
        if let Ok(spec) = parse(tokens) {
            let _ = crate::model::check(&spec).map_err(Diagnostics::into_compile_error);
        }
    }
}

/// Numbers by Knuth's linear congruence; the high bits are used.
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        self.0 >> 33
    }
}

/// The stream with 30 % of its tokens left out; a group left out leaves its inside.
fn thinned(tokens: TokenStream, random: &mut Random) -> TokenStream {
    let mut kept = TokenStream::new();
    for token in tokens {
        let leave_out = random.next() % 10 < 3;
        match token {
            TokenTree::Group(group) => {
                let inside = thinned(group.stream(), random);
                if leave_out {
                    kept.extend(inside);
                } else {
                    kept.extend([TokenTree::from(Group::new(group.delimiter(), inside))]);
                }
            }
            other if leave_out => drop(other),
            other => kept.extend([other]),
        }
    }
    kept
}

/// The stream without the token at `position`, counted in depth.
fn without(tokens: TokenStream, position: &mut u64) -> TokenStream {
    let mut kept = TokenStream::new();
    for token in tokens {
        let leave_out = *position == 0;
        *position = position.wrapping_sub(1);
        match token {
            TokenTree::Group(group) => {
                let inside = without(group.stream(), position);
                if leave_out {
                    kept.extend(inside);
                } else {
                    kept.extend([TokenTree::from(Group::new(group.delimiter(), inside))]);
                }
            }
            other if leave_out => drop(other),
            other => kept.extend([other]),
        }
    }
    kept
}
