//! Volumes at transitions between first-order modes: sliding needs a transition that leads back.

use crate::Expected::{self, False, Open, Shown, True};
use crate::check;
use crate::systems::crossing;

const HALF: &str = "density under leftward: factor = 1/2";
const MAY_SLIDE: Expected = Open("the motion may slide along it");

/// A motion that comes to `x = 0` with the rate -2 of x and has the rate `rate` behind it, with this transition back.
fn crossing_with(rate: &str, back: &str) -> String {
    let always = "rightward: left -> right when x >= 0;";
    let declared = crossing(["-2", "1"], [rate, "1"], "1");
    assert!(declared.contains(always));
    declared.replace(always, back)
}

#[test]
fn without_a_transition_back_the_motion_goes_on() {
    for back in [
        "",
        "rightward: left -> right when x >= 5;",
        "rightward: left -> right when x >= 2 + sin(y);",
        "rightward: left -> right when x <= -1 - y^2;",
    ] {
        let declared = crossing_with("1", back);
        check(&declared, HALF, True);
        let other = |factor: &str| format!("density under leftward: factor = {factor}");
        check(&declared, &other("0"), Shown("Jacobian", 0.5));
        check(
            &declared,
            &other("1"),
            False("does not multiply the volume by 1"),
        );
        check(&crossing_with("2", back), "density = 1; volume: kept", True);
        check(&declared, "volume: kept", False("Jacobian"));
        check(&declared, "invariant: d(x)^d(y)", False("after"));
        check(&crossing_with("2", back), "invariant: d(y)", True);
    }
    check(&crossing_with("-1", ""), HALF, True);
}

#[test]
fn with_a_transition_back_the_motion_slides() {
    let declared = crossing_with("1", "rightward: left -> right when x >= 0;");
    check(&declared, HALF, Shown("Jacobian", -0.5));
    check(&declared, "density under leftward: factor = 0", Open(""));
    check(&declared, "volume: kept", Shown("Jacobian", -0.5));
}

/// It is not known whether these transitions act where the mode is entered.
#[test]
fn what_depends_on_a_transition_that_may_act_stays_open() {
    for back in [
        "rightward: left -> right when x >= 0 when y > 100;",
        "rightward: left -> right when x >= y;",
        "rightward: left -> right when 2*x >= 0;",
        "rightward: left -> right when x >= 0 => reset { y = 0; };",
        "on: left -> right when x >= 0 when y > 1; off: left -> right when x >= 0 when y < 0;",
    ] {
        let declared = crossing_with("1", back);
        check(&declared, HALF, MAY_SLIDE);
        check(
            &crossing_with("2", back),
            "density = 1; volume: kept",
            MAY_SLIDE,
        );
        check(&crossing_with("2", back), "invariant: d(x)^d(y)", Open(""));
        // Neither 1/2, where the motion goes on, nor 0, where it slides.
        let wrong = "density under leftward: factor = 1";
        check(&declared, wrong, False("does not multiply the volume by 1"));
        check(&crossing_with("-1", back), HALF, True);
    }
}
