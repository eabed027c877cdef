//! Tests of the claims `conserved under s: e` and `not conserved under s: e` about transitions `s`, and about resets
//! whose maps have several branches.

use crate::Expected::{Barred, False, Shown, True};
use crate::check;
use crate::systems::{crossing, grooves, media, particle, spokes};

fn kept(surface: &str, quantity: &str) -> String {
    format!("conserved under {surface}: {quantity}")
}

fn changed(surface: &str, quantity: &str) -> String {
    format!("not {}", kept(surface, quantity))
}

const LEFT: &str = "m1/2*(dot(x)^2 + dot(y)^2)";
const RIGHT: &str = "m2/2*(dot(x)^2 + dot(y)^2) - V";

#[test]
fn quantities_that_a_transition_keeps_are_proved() {
    let glass = media(LEFT, RIGHT);
    check(&glass, &kept("rightward", "energy"), True);
    check(&glass, &kept("rightward", "momentum(y)"), True);
    check(&glass, &kept("rightward", "y"), True);
    check(&glass, &kept("rightward", "x*momentum(y)"), True);
    check(&glass, &kept("rightward", "momentum(y)^3 + energy"), True);
    for quantity in [
        "dot(y)",
        "momentum(x)",
        "energy + dot(y)",
        "y*dot(y)",
        "1e-9*dot(y)",
    ] {
        check(&glass, &changed("rightward", quantity), True);
    }
    let fields = crossing(["-2", "1"], ["-1", "-1"], "1");
    check(&fields, &kept("leftward", "x + y^2"), True);
    let cut = grooves("dot(y) = 0", "dot(y) = dot(x)");
    check(&cut, &kept("rightward", "momentum(x) + momentum(y)"), True);
    for quantity in ["energy", "dot(x)", "dot(y)"] {
        check(&cut, &changed("rightward", quantity), True);
    }
    check(
        &spokes("l1/l2*cos(2*h)*dot(x)"),
        &changed("step", "energy"),
        True,
    );
    check(
        &spokes("l1/l2*dot(x)"),
        &kept("step", "energy + g*cos(h)*momentum(x)*0"),
        False("energy"),
    );
}

#[test]
fn quantities_that_a_transition_changes_are_refuted_at_a_state() {
    let glass = media(LEFT, RIGHT);
    check(&glass, &kept("rightward", "dot(y)"), False("dot(y) after"));
    check(
        &glass,
        &kept("rightward", "momentum(x)"),
        False("momentum(x) after"),
    );
    let same = Barred("is the same before and after");
    for quantity in [
        "energy",
        "momentum(y)",
        "y",
        "energy*momentum(y)",
        "momentum(y) + x",
    ] {
        check(&glass, &changed("rightward", quantity), same);
    }
    let halved = Shown("dot(y) after", -0.375);
    check(&glass, &kept("rightward", "dot(y)"), halved);
    check(
        &glass,
        &kept("rightward", "energy + 1e-9*dot(y)"),
        False("difference"),
    );
    let cut = grooves("dot(y) = 0", "dot(y) = dot(x)");
    for quantity in ["y", "momentum(x) + momentum(y)", "x*energy"] {
        check(&cut, &changed("rightward", quantity), same);
    }
    check(
        &cut,
        &kept("rightward", "dot(x)"),
        Shown("dot(x) after", 0.25),
    );
    check(&cut, &kept("rightward", "energy"), False("energy after"));
    check(
        &cut,
        &kept("rightward", "momentum(x)"),
        False("momentum(x) after"),
    );
    check(
        &spokes("l1/l2*cos(2*h)*dot(x)"),
        &kept("step", "momentum(x)"),
        False("momentum(x) after"),
    );
    check(
        &spokes("l1/l2*cos(2*h)*dot(x)"),
        &kept("step", "x"),
        False("x after"),
    );
}

/// Where the step of the potential is too high, the particle is reflected. The reflection reverses the normal momentum
/// and keeps the energy.
#[test]
fn reflections_count_too() {
    let same = media("(dot(x)^2 + dot(y)^2)/2", "(dot(x)^2 + dot(y)^2)/2 - V*y^2");
    check(&same, &kept("rightward", "energy"), True);
    check(&same, &kept("rightward", "x*momentum(y)"), True);
}

/// The maps keep `dot(y)` only where `dot(y) >= 0`.
#[test]
fn all_branches_of_resets_are_examined() {
    for map in ["abs(dot(y))", "sqrt(dot(y)^2)"] {
        let folded = particle(&format!(
            "wall: x >= 0 => reset {{ dot(x) = -dot(x); dot(y) = {map}; }};"
        ));
        check(&folded, "conserved under wall: dot(y)^2", True);
        check(
            &folded,
            "conserved under wall: dot(y)",
            Shown("dot(y) after", 0.25),
        );
        check(&folded, "invariant: d(dot(y))", False("`wall` changes"));
        check(&folded, "symplectic", False("`wall` changes"));
    }
}
