//! Tests of surfaces with the law `stop`. Claims cannot name them. Verdicts on claims about the motion and about other
//! surfaces are those of the model without them.

use crate::Expected::{False, True};
use crate::check;
use crate::systems::{ball, disk, particle};

/// A ball whose floor has a law, below a ceiling that ends its motion.
fn below_a_ceiling(law: &str) -> String {
    ball(law).replace("floor:", "ceiling: x <= 4 => stop; floor:")
}

#[test]
fn a_stop_keeps_what_impacts_would_change() {
    for claim in ["volume: kept", "symplectic", "invariant: d(x)^d(dot(x))"] {
        check(&ball("stop"), claim, True);
        check(&ball("newton(c)"), claim, False("floor"));
        check(&below_a_ceiling("elastic"), claim, True);
        check(&below_a_ceiling("newton(c)"), claim, False("floor"));
    }
}

#[test]
fn the_motion_before_it_is_examined() {
    let drag = ball("stop").replace("impacts", "forces { drag: -k*dot(x)*d(x); } impacts");
    check(&drag, "volume: kept", False(""));
    check(&ball("stop"), "conserved: energy", True);
    check(&ball("stop"), "conserved: dot(x)", False(""));
    check(&disk("edge: x <= 1 => stop;"), "symmetry: partial(y)", True);
    check(
        &particle("edge: x <= 1 => stop;"),
        "integrable: momentum(x), momentum(y)",
        True,
    );
}
