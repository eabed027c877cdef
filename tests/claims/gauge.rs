//! Symmetries that change the Lagrangian by a total time derivative.

use dalembert_codegen::claims::Verdict;
use dalembert_tests::claim::verdict;

/// The verdict as a word, then the remarks.
fn found(declarations: &str, claim: &str) -> String {
    let finding = verdict(&format!(
        "Sample {{ {declarations} claims {{ {claim}; }} }}"
    ));
    let word = match finding.verdict {
        Verdict::Proved(_) => "proved",
        Verdict::Refuted(_) => "refuted",
        Verdict::Undecided(_) => "undecided",
    };
    format!("{word} {}", finding.remarks.join("; "))
}

const FREE: &str = "coordinates { x; y; } parameters { m > 0 = 1; }
    lagrangian = m/2*(dot(x)^2 + dot(y)^2);";
const MAGNETIC: &str = "coordinates { x; y; } parameters { B = 1; }
    lagrangian = (dot(x)^2 + dot(y)^2)/2 + B*x*dot(y);";
const FALL: &str = "coordinates { x; y; } parameters { g = 9.81; }
    lagrangian = (dot(x)^2 + dot(y)^2)/2 - g*y;";
/// A translation along `x` adds the total derivative of `exp(x)*sin(y)`, which is not a polynomial.
const WAVE: &str = "coordinates { x; y; }
    lagrangian = (dot(x)^2 + dot(y)^2)/2 + exp(x)*cos(y)*dot(y) + exp(x)*sin(y)*dot(x);";

#[test]
fn a_boost_is_a_symmetry_with_the_centre_of_mass_as_its_momentum() {
    let found = found(FREE, "symmetry: t*partial(x)");
    assert!(found.starts_with("proved"), "{found}");
    assert!(found.contains("m*(dot(x)*t - x) is conserved"), "{found}");
}

#[test]
fn translations_in_a_magnetic_field_are_symmetries() {
    let found = found(MAGNETIC, "symmetry: partial(x)");
    assert!(found.starts_with("proved"), "{found}");
    assert!(found.contains("dot(x) - B*y is conserved"), "{found}");
}

#[test]
fn gains_that_are_no_polynomials_are_said_as_rates() {
    let found = found(WAVE, "symmetry: partial(x)");
    assert!(found.starts_with("proved"), "{found}");
    let rate = "has the rate exp(x)*(dot(y)*cos(y) + dot(x)*sin(y))";
    assert!(found.contains(rate), "{found}");
}

#[test]
fn falls_are_the_same_at_every_height() {
    let found = found(FALL, "symmetry: partial(y)");
    assert!(found.starts_with("proved"), "{found}");
}

/// Changes of the Lagrangian that are affine in the velocities but no total derivatives, and quadratic changes.
#[test]
fn other_changes_of_the_lagrangian_are_refuted() {
    for (declarations, claim) in [
        (FREE, "symmetry: t^2*partial(x)"),
        (FREE, "symmetry: x*partial(x)"),
        (FREE, "symmetry: y*partial(x)"),
        (MAGNETIC, "symmetry: t*partial(x)"),
        (MAGNETIC, "symmetry: x*partial(y)"),
        (FALL, "symmetry: x*partial(y) - y*partial(x)"),
        (FALL, "symmetry: t^2*partial(y)"),
    ] {
        let found = found(declarations, claim);
        assert!(found.starts_with("refuted"), "{claim}: {found}");
    }
}
