//! Test cases for the errors of the check. A case has a message and a source text, in which `«..»` marks the location
//! of the error.

mod bounds;
mod impacts;
mod motion;
mod names;
mod values;

use dalembert_codegen::diagnostics::Diagnostics;
use dalembert_codegen::model::check;
use dalembert_codegen::spec;

use crate::marks::{reported, unmarked};

/// A particle in the plane with further declarations.
fn particle(rest: &str) -> String {
    format!(
        "P {{ coordinates {{ x; y; a: angle; }} parameters {{ m > 0 = 1; k > 0 = 1; }}
            lagrangian = m/2*(dot(x)^2 + dot(y)^2 + dot(a)^2);
            {rest} }}"
    )
}

/// Two coordinates and an angle with this Lagrangian.
fn with_lagrangian(lagrangian: &str) -> String {
    format!(
        "P {{ coordinates {{ x; y; theta: angle; }} parameters {{ m > 0 = 1; v; }}
            lagrangian = {lagrangian}; }}"
    )
}

fn diagnostics(source: &str) -> Diagnostics {
    let spec = spec::parse(source.parse().unwrap()).unwrap_or_else(|errors| panic!("{errors:?}"));
    match check(&spec) {
        Ok(_) => panic!("accepted: {source}"),
        Err(diagnostics) => diagnostics,
    }
}

#[track_caller]
fn accepted(source: &str) {
    let spec = spec::parse(source.parse().unwrap()).unwrap_or_else(|errors| panic!("{errors:?}"));
    if let Err(errors) = check(&spec) {
        panic!("{source}: {:?}", reported(source, &errors));
    }
}

/// Asserts that the source has exactly one error, with this message at the marked place.
#[track_caller]
fn refused(source: &str, message: &str) {
    let (source, marked) = unmarked(source);
    let errors = reported(&source, &diagnostics(&source));
    let texts: Vec<&str> = errors.iter().map(|(text, _)| text.as_str()).collect();
    assert_eq!(errors.len(), 1, "{texts:?}");
    assert!(errors[0].0.contains(message), "{}", errors[0].0);
    assert_eq!(errors[0].1, marked, "{}", errors[0].0);
}

const KINETIC: &str = "m/2*(dot(x)^2 + dot(y)^2 + dot(theta)^2)";

#[track_caller]
fn refused_term(term: &str, message: &str) {
    refused(&with_lagrangian(&format!("{KINETIC} - {term}")), message);
}

#[track_caller]
fn refused_in(rest: &str, message: &str) {
    refused(&particle(rest), message);
}
