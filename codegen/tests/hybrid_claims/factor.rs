//! Tests of the claim `density under s: factor = e`.

use crate::Expected::{Barred, False, Open, Shown, True};
use crate::check;
use crate::systems::{ball, crossing, disk, field, grooves, media, particle, spokes, walker};

const STRIP: &str = "left: x >= 0 => reset { dot(x) = -a*dot(x); dot(y) = b*dot(y); };";
const RATE: &str = "cos(2*delta)*dot(theta)";

#[test]
fn true_factors_are_proved() {
    let claim = |factor: &str, surface: &str| format!("density under {surface}: factor = {factor}");
    let floor = |law: &str, factor: &str| check(&ball(law), &claim(factor, "floor"), True);
    floor("restitution(c)", "c^2");
    floor("newton(c)", "c^2");
    floor("elastic", "1");
    floor("impact_plastic", "0");
    floor("reset { dot(x) = -k*dot(x); }", "k^2");
    floor("reset { dot(x) = -dot(x); x = x + 1; }", "1");
    check(&particle(STRIP), &claim("a^2*b", "left"), True);
    check(
        &particle("low: y >= 0 => reset { dot(y) = -dot(y); x = 3*x; };"),
        &claim("3", "low"),
        True,
    );
    check(&walker(RATE), &claim("cos(2*delta)^2", "step"), True);
    check(
        &disk("wall: 1 - x - R*cos(phi) >= 0;"),
        &claim("1", "wall"),
        True,
    );
    check(
        &disk("wall: 1 - x - R*cos(phi) >= 0 => restitution(e);"),
        &claim("e^2", "wall"),
        True,
    );
    check(
        &disk("wall: 1 - x >= 0 => nonholonomic_plastic;"),
        &claim(
            "(1 - 2*R^2*m/(I + m*R^2)*cos(phi)^2*I/(m*R^2)*m*R^2/I)^2",
            "wall",
        ),
        True,
    );
    check(
        &crossing(["-2", "1"], ["-1", "-1"], "1"),
        &claim("1/2", "leftward"),
        True,
    );
    check(
        &media(
            "m1/2*(dot(x)^2 + dot(y)^2)",
            "m2/2*(dot(x)^2 + dot(y)^2) - V",
        ),
        &claim("1", "rightward"),
        True,
    );
    check(
        &grooves("dot(y) = 0", "dot(y) = dot(x)"),
        &claim("1/4", "rightward"),
        True,
    );
    check(
        &spokes("l1/l2*cos(2*h)*dot(x)"),
        &claim("cos(2*h)^2", "step"),
        True,
    );
    check(
        &field(
            "dot(x) = y; dot(y) = -1;",
            "floor: x >= 0 => reset { y = -k*y; };",
        ),
        &claim("k^2", "floor"),
        True,
    );
}

#[test]
fn false_factors_are_refuted_at_a_point() {
    let claim = |factor: &str, surface: &str| format!("density under {surface}: factor = {factor}");
    let floor = |law: &str, factor: &str, expected| {
        check(&ball(law), &claim(factor, "floor"), expected);
    };
    // The parameter c is 0.7.
    floor("restitution(c)", "c", Shown("Jacobian", 0.49));
    floor("restitution(c)", "1", Shown("Jacobian", 0.49));
    floor("elastic", "2", Shown("Jacobian", 1.0));
    floor("impact_plastic", "1", Shown("Jacobian", 0.0));
    floor("reset { dot(x) = -k*dot(x); }", "k", Shown("Jacobian", 4.0));
    check(
        &particle(STRIP),
        &claim("a*b", "left"),
        Shown("Jacobian", 1.0),
    );
    check(
        &walker(RATE),
        &claim("cos(2*delta)", "step"),
        False("Jacobian = 0.68117887723"),
    );
    check(
        &disk("wall: 1 - x - R*cos(phi) >= 0 => restitution(e);"),
        &claim("1", "wall"),
        Shown("Jacobian", 0.25),
    );
    check(
        &crossing(["-2", "1"], ["-1", "-1"], "1"),
        &claim("2", "leftward"),
        Shown("Jacobian", 0.5),
    );
    check(
        &grooves("dot(y) = 0", "dot(y) = dot(x)"),
        &claim("1/2", "rightward"),
        Shown("Jacobian", 0.25),
    );
    check(
        &spokes("cos(2*h)*dot(x)"),
        &claim("cos(2*h)^2", "step"),
        False("does not multiply"),
    );
}

#[test]
fn near_misses_are_refuted() {
    let near = |factor: &str| format!("density under floor: factor = {factor}");
    check(
        &ball("restitution(c)"),
        &near("c^2*(1 + 1e-9)"),
        False("Jacobian"),
    );
    check(&ball("elastic"), &near("1 + 1e-9"), False("Jacobian"));
    let claim = "density under step: factor = cos(2*delta)^2 + 1e-9";
    check(&walker(RATE), claim, False("Jacobian"));
    // Changes of rates and surfaces by 1e-9.
    let claim = "density under step: factor = cos(2*delta)^2";
    check(
        &walker("(cos(2*delta) + 1e-9)*dot(theta)"),
        claim,
        False("Jacobian"),
    );
    let moved = walker(RATE).replace("theta >= -delta", "theta >= -delta - 1e-9");
    check(&moved, claim, False("Jacobian"));
    let crossed = crossing(["-2", "1"], ["-1 - 1e-9", "-1"], "1");
    check(
        &crossed,
        "density under leftward: factor = 1/2",
        False("Jacobian"),
    );
}

#[test]
fn maps_between_states_of_other_dimensions_have_no_factor() {
    let modes = "pub Modes { coordinates { x; y; } lagrangian = (dot(x)^2 + dot(y)^2)/2;
        modes { smooth { CLAIM } rough { constraints { groove: dot(y) = dot(x); } } }
        transitions { enter: smooth -> rough when x >= 0; } }";
    check(
        modes,
        "density under enter: factor = 1",
        Barred("states of 4 dimensions to states of 3"),
    );
}

#[test]
fn undecided_factors_stay_open() {
    let depends = particle("low: y >= 0 => reset { dot(y) = -dot(y); x = x + dot(x); };");
    check(
        &depends,
        "density under low: factor = 1",
        Open("positions after it depend on velocities"),
    );
    let unsigned = particle("low: y >= 0 => reset { dot(y) = -dot(y); x = d1*x; };");
    check(
        &unsigned,
        "density under low: factor = d1",
        Open("may be negative"),
    );
    check(&unsigned, "density under low: factor = abs(d1)", True);
}

#[test]
fn instantaneous_constraints_map_volumes_to_0() {
    let wall = disk("wall: 1 - x >= 0 => elastic, instantaneous { no_turn: d(phi) = 0; };");
    check(&wall, "density under wall: factor = 0", True);
    check(
        &wall,
        "density under wall: factor = 1",
        Barred("volumes become 0"),
    );
}
