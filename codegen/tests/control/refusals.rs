//! Models without a maximum principle: the error message, and the source text that it points at, marked `«..»`.

use dalembert_codegen::{compile_control, spec};

#[track_caller]
fn refused(source: &str, message: &str) {
    let begin = source.find('«').expect("a mark");
    let (plain, marked) = (source.replace(['«', '»'], ""), source);
    let length = marked[begin..].find('»').expect("its end") - '«'.len_utf8();
    let marked = &plain[begin..begin + length];
    let spec = spec::parse(plain.parse().unwrap()).unwrap();
    let errors = compile_control(&spec, None).expect_err("accepted");
    let errors: Vec<_> = errors.iter().collect();
    assert_eq!(errors.len(), 1, "{errors:?}");
    assert!(
        errors[0].message().contains(message),
        "{}",
        errors[0].message()
    );
    let span = errors[0].places()[0].0.first;
    let line = plain.lines().nth(span.start().line - 1).expect("a line");
    let at = &line[span.start().column..];
    assert!(at.starts_with(marked.split(' ').next().unwrap()), "{at}");
}

fn particle(rest: &str) -> String {
    format!(
        "P {{ coordinates {{ x; y; }} parameters {{ m > 0 = 1; }} inputs {{ u; }} lagrangian = m/2*(dot(x)^2 + dot(y)^2); {rest} }}"
    )
}

const COST: &str = "cost { running = u^2; }";

#[test]
fn a_model_without_a_cost_is_refused_at_its_name() {
    refused(
        "«P» { coordinates { x; } inputs { u; } field { dot(x) = u; } }",
        "`P` declares no `cost`\nhelp: write `cost {",
    );
}

#[test]
fn constraints_are_refused() {
    refused(
        &particle(&format!(
            "constraints {{ c: «dot(x)» = (2 + x^2)*dot(y); }} forces {{ f: u*d(x); }} {COST}"
        )),
        "no maximum principle is derived for a model with constraints, such as `c`",
    );
}

#[test]
fn laws_that_forget_are_refused() {
    for law in [
        "impact_plastic",
        "totally_plastic",
        "newton(0)",
        "reset { x = 0; }",
    ] {
        refused(
            &particle(&format!(
                "impacts {{ w: «x» >= 0 => {law}; }} forces {{ f: u*d(x); }} {COST}"
            )),
            "the law of `w` is not invertible",
        );
    }
}

#[test]
fn inputs_that_are_no_linear_factor_are_refused() {
    refused(
        &particle("forces { f: u^2*d(x); } «cost» { running = u^2; }"),
        "the rate of `x_dot` is not affine in `u`",
    );
}

#[test]
fn inputs_that_act_on_a_gap_are_refused() {
    refused(
        "P { coordinates { x; } inputs { u; } cost { running = u^2; } field { dot(x) = 1 - u; }
            impacts { w: «x» >= 0 => reset { x = x + 1; }; } }",
        "`u` acts on the gap of `w` itself",
    );
}
