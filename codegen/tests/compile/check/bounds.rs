//! Limits, and several mistakes at once.

use dalembert_codegen::spec;

use super::{KINETIC, check, diagnostics, particle, refused, refused_in, with_lagrangian};

#[test]
fn a_model_has_at_most_64_coordinates() {
    let source = "P { coordinates { «q»[65]; } lagrangian = sum(i in 1..=65: dot(q[i])^2); }";
    refused(source, "65 coordinates; the limit is 64");
}

#[test]
fn independent_mistakes_are_all_reported() {
    let source = particle(
        "forces { f: thta*d(x); } impacts { w: x >= 0 => bouncy; } initial { z = 1; } outputs { o: sinn(x); }",
    );
    let errors = diagnostics(&source);
    assert_eq!(errors.len(), 4);
}

#[test]
fn written_out_definitions_are_bounded() {
    let mut source = String::from("P { coordinates { x; } let f0(u) = sum(i in 1..=4000: u);");
    for level in 1..4 {
        source.push_str(&format!(
            "let f{level}(u) = sum(i in 1..=4000: f{}(u + i));",
            level - 1
        ));
    }
    source.push_str("lagrangian = dot(x)^2 + f3(x); }");
    let errors = diagnostics(&source);
    assert!(
        errors
            .iter()
            .next()
            .unwrap()
            .message()
            .contains("parts once its sums and definitions are expanded")
    );
}

#[test]
fn deep_expressions_are_resolved_or_refused() {
    let nested = format!("{}x{}", "-(1 + 2*(".repeat(120), ")^2)".repeat(120));
    let source = with_lagrangian(&format!("{KINETIC} - {nested}"));
    let spec = spec::parse(source.parse().unwrap()).unwrap();
    assert!(check(&spec).is_ok());
    let mut source = String::from("P { coordinates { x; } let f0(u) = u;");
    for level in 1..500 {
        source.push_str(&format!("let f{level}(u) = -(1 + 2*f{}(u)^2);", level - 1));
    }
    source.push_str("lagrangian = dot(x)^2 + f499(x); }");
    let errors = diagnostics(&source);
    assert!(
        errors
            .iter()
            .next()
            .unwrap()
            .message()
            .contains("nested more than 1024 deep")
    );
}

#[test]
fn a_model_has_at_most_256_surfaces() {
    refused_in(
        "impacts { first: x >= 0; «w»[i in 1..=256]: y >= -i; }",
        "more than 256 surfaces",
    );
}

#[test]
fn definitions_of_definitions_are_bounded() {
    let mut source = String::from("let a0 = x;");
    for level in 0..2000 {
        let inner = if level == 1024 {
            "«sin(a1024)»".to_owned()
        } else {
            format!("sin(a{level})")
        };
        source.push_str(&format!("let a{} = {inner};", level + 1));
    }
    refused_in(&source, "nested more than 1024 deep");
}

#[test]
fn powers_of_powers_are_bounded() {
    refused_in(
        "let c = «(x^4096)^2»;",
        "`(x^4096)^2` has the exponent 8192",
    );
    refused_in(
        "let c = x^4096; let b = «c*c»;",
        "`c*c` has the exponent 8192",
    );
}

#[test]
fn coefficients_are_as_bounded_as_numbers() {
    let message = "an exact number of more than 4096 bits";
    refused_in("let c = 10^1000*x*«10^1000»;", message);
    refused_in("let c = 10^1000*x; let b = 10^1000*«c»;", message);
    refused_in("let c = «sum(i in 1..=4096: 1/i)»;", message);
    refused_in("let c = «sum(i in 1..=2000: x/(2*i + 1))»;", message);
}

#[test]
fn algebra_without_end_is_given_up_where_it_began() {
    let factors: Vec<String> = (0..2200).map(|i| format!("(x + {i})")).collect();
    let kinetic = "dot(x)^2 + dot(y)^2 + dot(a)^2 + dot(z)^2";
    let product = factors.join("*");
    let source = format!(
        "P {{ coordinates {{ x; y; z; a: angle; }} lagrangian = {kinetic}; let p = {product}*«dot({product})»; }}"
    );
    refused(
        &source,
        "the algebra takes more than 4194304 steps; it was given up here",
    );
}

#[test]
fn the_number_of_errors_is_limited() {
    let names: Vec<String> = (0..3000).map(|i| format!("u{i}")).collect();
    let errors = diagnostics(&particle(&format!(
        "outputs {{ o: {}; }}",
        names.join(" + ")
    )));
    assert_eq!(errors.len(), 1000);
}
