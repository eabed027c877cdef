//! Tests of forms and quantities across impacts with instantaneous constraints. The velocity is projected onto these
//! constraints before the law acts.

use crate::Expected::{False, Open, Shown, True};
use crate::check;
use crate::differences::{Hybrid, assert_close, one};
use crate::systems::{disk, particle};

/// A wall at `x = 0` that prescribes the velocity of the particle along it.
fn wall(law: &str, psi: &str) -> String {
    particle(&format!(
        "hold: x >= 0 => {law}, instantaneous {{ stick: {psi}; }};"
    ))
}

/// A solid cylinder that falls beside a wall, and does not slip on it during an impact.
const ROLLER: &str = "pub Roller { coordinates { x; y; theta; } parameters { k > 0 = 1/2; }
    lagrangian = (dot(x)^2 + dot(y)^2 + k*dot(theta)^2)/2 - y;
    impacts { wall: x >= 0 => elastic, instantaneous { no_slip: dot(y) = dot(theta); }; } CLAIM }";

#[test]
fn forms_and_quantities_that_the_projection_keeps_are_proved() {
    check(
        &wall("elastic", "dot(y) = 0"),
        "invariant: d(momentum(x))^d(x)",
        True,
    );
    check(
        &wall("newton(1)", "dot(y) = y"),
        "invariant: d(momentum(x))^d(x)",
        True,
    );
    check(
        &wall("elastic", "dot(y) = 0"),
        "conserved under hold: dot(x)^2",
        True,
    );
    check(
        &wall("restitution(1/2)", "dot(y) = 3"),
        "conserved under hold: x + y^2",
        True,
    );
    check(
        &wall("restitution(1/2)", "dot(y) = 3"),
        "not conserved under hold: dot(x)^2",
        True,
    );
    // The impulse along the wall has no moment about the line of contact.
    check(
        ROLLER,
        "conserved under wall: momentum(y) + momentum(theta)",
        True,
    );
    check(ROLLER, "conserved under wall: dot(x)^2", True);
    check(ROLLER, "energy under wall: not increasing", True);
    // The disk stops turning about the vertical, and rolls away.
    let turned = disk("wall: 1 - x >= 0 => elastic, instantaneous { no_turn: d(phi) = 0; };");
    check(&turned, "conserved under wall: dot(theta)^2", True);
}

#[test]
fn forms_and_quantities_that_the_projection_changes_are_refuted_at_a_point() {
    check(
        &wall("elastic", "dot(y) = 0"),
        "invariant: d(momentum(y))^d(y)",
        Shown("the form on partial(y), partial(dot(y)) after", 0.0),
    );
    check(
        &wall("elastic", "dot(y) = 0"),
        "conserved under hold: dot(y)",
        Shown("dot(y) after", 0.0),
    );
    check(
        &wall("elastic", "dot(y) = 3"),
        "conserved under hold: dot(y)",
        Shown("dot(y) after", 3.0),
    );
    check(
        &wall("elastic", "dot(y) = 0"),
        "conserved under hold: energy",
        False("energy after"),
    );
    // A belt gives energy to bodies that it takes along.
    check(
        &wall("elastic", "dot(y) = 3"),
        "energy under hold: not increasing",
        False("energy after"),
    );
    // The velocities 1.25 and 1/4 become (1.25 + 1/4/2)/1.5.
    check(
        ROLLER,
        "conserved under wall: momentum(y)",
        Shown("momentum(y) after", 11.0 / 12.0),
    );
    check(
        ROLLER,
        "conserved under wall: dot(y) - dot(theta)",
        Shown("dot(y) - dot(theta) before", 1.0),
    );
    check(
        ROLLER,
        "conserved under wall: momentum(y) + (1 + 1e-9)*momentum(theta)",
        False("difference"),
    );
    // By hand, the value is (4/9 + 8/9) 2/3. Free fall changes only dot(y), and 2/3 of this change passes to the common
    // velocity after the impact.
    check(
        ROLLER,
        "invariant: d(dot(y))^d(dot(theta))",
        Shown("the form on partial(x), partial(dot(y)) after", 8.0 / 9.0),
    );
}

/// `dot(y)` and `dot(theta)` become their mean with the weights 1 and k. The value that the verdict shows is compared
/// with finite differences of runs through the wall.
#[test]
fn vectors_are_carried_as_differences_carry_them() {
    let falls = |z: &[f64]| vec![z[3], z[4], z[5], 0.0, -1.0, 0.0];
    let roller = Hybrid {
        before: &falls,
        gap: &|z| z[0],
        map: &|z| {
            let common = (z[4] + 0.5 * z[5]) / 1.5;
            vec![z[0], z[1], z[2], -z[3], common, common]
        },
        after: &falls,
        densities: [&one, &one],
    };
    // The state of the verdict, a quarter of a time unit earlier: `x = 0`, `y = -0.74`, velocity (-3/4, 5/4, 1/4).
    let early = 0.25;
    let start = [
        0.75 * early,
        -0.74 - 1.5 * early + early * early / 2.0,
        0.45 - 0.25 * early,
        -0.75,
        1.5,
        0.25,
    ];
    let columns = roller.columns(&start, 0.5);
    let (x, y) = (&columns[0], &columns[1]);
    assert_close(x[4] * y[1] - y[4] * x[1], 4.0 / 9.0);
    check(
        ROLLER,
        "invariant: d(dot(y))^d(y)",
        Shown("the form on partial(x), partial(y) after", 4.0 / 9.0),
    );
}

#[test]
fn impacts_that_the_projection_may_turn_stay_open() {
    let coupled =
        wall("elastic", "dot(y) = 0").replace("dot(y)^2)/2", "dot(y)^2 + dot(x)*dot(y))/2");
    let claim = "conserved under hold: dot(x)^2";
    check(
        &coupled,
        claim,
        Open("instantaneous constraints change the gap rate"),
    );
    check(
        &wall("impact_plastic", "dot(y) = 0"),
        "invariant: d(momentum(x))^d(x)",
        Open("the sign of the acceleration of its gap"),
    );
}
