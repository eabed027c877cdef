//! Limits, and several mistakes at once.

use super::{KINETIC, check, diagnostics, particle, refused, with_lagrangian};
use crate::spec;

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
            .contains("parts with sums and definitions written out")
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
