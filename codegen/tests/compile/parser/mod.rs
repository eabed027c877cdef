//! Tests of the parser; its refusals are tested in `refusals`.

mod families;
mod missing_tokens;
mod refusals;
mod slips;

use proc_macro2::{Delimiter, Group, TokenStream, TokenTree};

use dalembert_codegen::diagnostics::Diagnostics;
use dalembert_codegen::spec::{Declaration, Operator, Scalar, ScalarKind, Spec, parse};

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
        constraints { /** joint */ joint[i in 1..=2]: d(theta[i]) - 2*d(x) = 3*d(t); }
        forces { drag: -k*dot(x)*d(x); }
        impacts { wall: x <= 1 + l/2 when u > 1 when x < 2 => restitution(e); floor: x >= -1; }
        initial { theta[i in 1..=N] = 0.1*i; dot(theta[1]) = 1; until = 10; }
        view { /** seen */ path: (x, X[N]); region: 1 - x >= 0; }
        outputs { load[i in 1..=2]: multiplier(joint[i]); }
    }";

fn read(source: &str) -> Result<Spec, Diagnostics> {
    match dalembert_codegen::read(source.parse().unwrap())? {
        Declaration::Model(spec) => Ok(*spec),
        Declaration::Modes(declared) => panic!("{declared:?}"),
    }
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
            let signed = |(negative, term): &(bool, Scalar)| {
                format!(
                    "{}{}",
                    if *negative { "-" } else { "+" },
                    bracketed(&term.kind)
                )
            };
            format!("({})", terms.iter().map(signed).collect::<String>())
        }
        ScalarKind::Product(factors) => {
            let signed = |(operator, factor): &(Operator, Scalar)| {
                let sign = match operator {
                    Operator::Times => '*',
                    Operator::Over => '/',
                    Operator::Modulo => '%',
                };
                format!("{sign}{}", bracketed(&factor.kind))
            };
            format!("({})", factors.iter().map(signed).collect::<String>())
        }
        other => Scalar {
            kind: other.clone(),
            at: proc_macro2::Span::call_site().into(),
        }
        .to_string(),
    }
}

#[test]
fn every_declaration_is_read() {
    let spec = read(MODEL).unwrap();
    assert_eq!(spec.visibility, "pub(crate)");
    assert_eq!(spec.documentation, ["A model."]);
    assert_eq!(spec.coordinates.len(), 3);
    assert_eq!(spec.parameters[0].documentation, ["mass"]);
    assert_eq!(spec.constraints[0].documentation, ["joint"]);
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
