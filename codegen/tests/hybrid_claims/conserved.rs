//! Tests of the claims `conserved: e` and `not conserved: e`, about the motion and under impulses and resets, and of
//! `symmetry: X`, in Lagrangian systems.
//!
//! Refutations show the state x = 0.36, y = -0.53, dot(x) = 0.5, dot(y) = -0.75, or a state at a wall.

use crate::Expected::{self, Barred, False, Shown, True};
use crate::check;
use crate::systems::{ball, disk};

const FALL: &str = "pub Fall { coordinates { x; y; } parameters { g > 0 = 2; }
    lagrangian = (dot(x)^2 + dot(y)^2)/2 - g*y; CLAIM }";
const ROUND: &str = "pub Round { coordinates { x; y; }
    lagrangian = (dot(x)^2 + dot(y)^2)/2 - (x^2 + y^2)^2; CLAIM }";
const CHARGED: &str = "pub Charged { coordinates { x; y; } parameters { b > 0 = 3; }
    lagrangian = (dot(x)^2 + dot(y)^2)/2 + b*x*dot(y); CLAIM }";
/// A wall with the normal `(1, 2)`, and a wall whose reset changes velocities and moves the particle along the wall.
const WALLS: &str = "pub Walls { coordinates { x; y; } parameters { a > 0 = 5/4; }
    lagrangian = (dot(x)^2 + dot(y)^2)/2; impacts { wall: x + 2*y >= 0;
    left: x >= 0 => reset { dot(x) = -a*dot(x); dot(y) = dot(y)/a; y = y + 1; }; } CLAIM }";
const TURN: &str = "x*partial(y) - y*partial(x)";

#[track_caller]
fn all(kind: &str, cases: &[(&str, &str, Expected)]) {
    for (system, stated, expected) in cases {
        check(system, &format!("{kind}: {stated}"), *expected);
    }
}

#[test]
fn quantities_along_the_motion() {
    let disk = disk("");
    let kept = [
        (FALL, "energy"),
        (FALL, "dot(x)"),
        (FALL, "momentum(y) + g*t"),
        (FALL, "dot(y)^2 + 2*g*y"),
        (FALL, "x - t*dot(x)"),
        (ROUND, "x*dot(y) - y*dot(x)"),
        (CHARGED, "dot(x) - b*y"),
        (CHARGED, "dot(y) + b*x"),
        (disk.as_str(), "dot(theta)"),
        (disk.as_str(), "dot(x)^2 + dot(y)^2"),
    ];
    for (system, stated) in kept {
        check(system, &format!("conserved: {stated}"), True);
        check(
            system,
            &format!("not conserved: {stated}"),
            Barred("along the motion on D is 0"),
        );
    }
    let changed = [
        (FALL, "x", Shown("d/dt(x)", 0.5)),
        (FALL, "dot(y)", Shown("d/dt(dot(y))", -2.0)),
        (FALL, "y - t*dot(y)", Shown("d/dt(y - t*dot(y))", 0.78)),
        (
            FALL,
            "x*momentum(y) - y*momentum(x)",
            Shown("d/dt(x*momentum(y) - y*momentum(x))", -0.72),
        ),
        (CHARGED, "dot(x)", Shown("d/dt(dot(x))", -2.25)),
        (CHARGED, "momentum(x)", Shown("d/dt(momentum(x))", -2.25)),
        (
            disk.as_str(),
            "dot(x)",
            False("d/dt(dot(x)) = -0.131306892764"),
        ),
        // The rate is -sin(phi) dot(phi).
        (
            disk.as_str(),
            "cos(phi)",
            Shown("d/dt(cos(phi))", -0.81_f64.sin() / 4.0),
        ),
        // Near misses.
        (
            FALL,
            "energy + 1e-9*dot(y)",
            Shown("d/dt(energy + 1e-9*dot(y))", -2e-9),
        ),
        (
            FALL,
            "dot(y)^2 + (2 + 1e-9)*g*y",
            Shown("d/dt(dot(y)^2 + (2 + 1e-9)*g*y)", -1.5e-9),
        ),
        (
            ROUND,
            "x*dot(y) - (1 + 1e-9)*y*dot(x)",
            False("6.17064000000e-11"),
        ),
    ];
    for (system, stated, expected) in changed {
        check(system, &format!("conserved: {stated}"), expected);
        check(system, &format!("not conserved: {stated}"), True);
    }
}

/// `not conserved: e` is refuted without a counterexample, by a proof that `e` is conserved. The message shows a state
/// at which the parts of its rate cancel.
#[test]
fn parts_that_cancel_are_shown() {
    // The parts are g dot(y) and -g dot(y) with g = 2. A rotation and an impact follow.
    let sum = "\nfor example part by y = -1.5, part by dot(y) = 1.5 at y = -0.53, g = 2, dot(x) = 0.5, dot(y) = -0.75";
    check(FALL, "not conserved: energy", Barred(sum));
    let turned = "pub Turned { coordinates { x; y; } field { dot(x) = -y; dot(y) = x; } CLAIM }";
    let sum = "part by x = 0.3816, part by y = -0.3816 at x = 0.36, y = -0.53";
    check(turned, "not conserved: x^2 + y^2", Barred(sum));
    let same = "for example energy after = ";
    check(WALLS, "not conserved under wall: energy", Barred(same));
}

#[test]
fn quantities_under_impulses_and_resets() {
    let damped = ball("restitution(c)");
    let kept = [
        (WALLS, "wall", "energy"),
        // The velocity along the wall, in the direction (2, -1).
        (WALLS, "wall", "2*dot(x) - dot(y)"),
        (WALLS, "wall", "(dot(x) + 2*dot(y))^2"),
        (WALLS, "wall", "x*y"),
        (WALLS, "left", "dot(x)^2*dot(y)^2"),
        (WALLS, "left", "x"),
        (WALLS, "left", "x + abs(dot(x)*dot(y))"),
        (damped.as_str(), "floor", "x"),
    ];
    for (system, surface, stated) in kept {
        check(
            system,
            &format!("conserved under {surface}: {stated}"),
            True,
        );
        let negated = format!("not conserved under {surface}: {stated}");
        check(system, &negated, Barred("is the same before and after"));
    }
    let changed = [
        // The impact at dot(x) + 2 dot(y) = -1 adds 2/5 (1, 2) to the velocity.
        (WALLS, "wall", "dot(x)", Shown("dot(x) after", 0.9)),
        (WALLS, "wall", "dot(y)", Shown("dot(y) after", 0.05)),
        (
            WALLS,
            "wall",
            "x*dot(y) - y*dot(x)",
            Shown("x*dot(y) - y*dot(x) after", 0.18),
        ),
        (
            WALLS,
            "left",
            "dot(x)*dot(y)",
            Shown("dot(x)*dot(y) after", 0.9375),
        ),
        (WALLS, "left", "y", Shown("y after", 0.26)),
        // The velocity (-3/4, 5/4) becomes (15/16, 1), with the energy (15/16)^2/2 + 1/2.
        (
            WALLS,
            "left",
            "energy",
            Shown("energy after", 0.939_453_125),
        ),
        (
            damped.as_str(),
            "floor",
            "dot(x)",
            Shown("dot(x) after", 0.525),
        ),
        (
            damped.as_str(),
            "floor",
            "energy",
            Shown("energy after", 0.137_812_5),
        ),
        (
            WALLS,
            "wall",
            "2*dot(x) - (1 + 1e-9)*dot(y)",
            Shown("difference", -8e-10),
        ),
    ];
    for (system, surface, stated, expected) in changed {
        check(
            system,
            &format!("conserved under {surface}: {stated}"),
            expected,
        );
        check(
            system,
            &format!("not conserved under {surface}: {stated}"),
            True,
        );
    }
    // A wall that is turned by about 1e-9.
    let turned = WALLS.replace("x + 2*y", "x + (2 + 1e-9)*y");
    check(
        &turned,
        "conserved under wall: 2*dot(x) - dot(y)",
        False("difference"),
    );
}

/// The momentum of the field of D along which the disk rolls (W. Clark, thesis, 5.2) is conserved. The wall at `x = 1`
/// changes it.
#[test]
fn momenta_of_sections_of_d_are_conserved_by_the_disk() {
    let along = |factor: &str| {
        format!("({factor})*R*cos(phi)*momentum(x) + R*sin(phi)*momentum(y) + momentum(theta)")
    };
    let free = disk("");
    check(&free, &format!("conserved: {}", along("1")), True);
    check(
        &free,
        &format!("conserved: {}", along("1 + 1e-9")),
        False("changes along the motion"),
    );
    check(
        &free,
        "conserved: momentum(x)",
        False("changes along the motion"),
    );
    let wall = disk("wall: 1 - x >= 0;");
    check(
        &wall,
        &format!("not conserved under wall: {}", along("1")),
        True,
    );
    // A wall whose gap depends on `phi` only keeps the momentum.
    let stop = disk("stop: 1/2 - cos(phi) >= 0;");
    check(
        &stop,
        &format!("conserved under stop: {}", along("1")),
        True,
    );
}

#[test]
fn symmetries_of_lagrangians_are_proved_and_others_refuted() {
    let disk = disk("");
    all(
        "symmetry",
        &[
            (FALL, "partial(x)", True),
            (FALL, "partial(y)", True),
            (FALL, "t*partial(x)", True),
            (FALL, "t*partial(y)", True),
            (FALL, "partial(x) + 3*partial(y)", True),
            (ROUND, TURN, True),
            (CHARGED, "partial(x)", True),
            (CHARGED, "partial(y)", True),
            (&disk, "partial(x)", True),
            (&disk, "partial(theta)", True),
            (&disk, "partial(phi) - y*partial(x) + x*partial(y)", True),
        ],
    );
    let second = "second derivative of this rate in dot(x) and dot(x)";
    let mixed = "second derivative of this rate in dot(x) and dot(y)";
    let of_x = "Euler-Lagrange expression of this rate for x";
    let of_y = "Euler-Lagrange expression of this rate for y";
    all(
        "symmetry",
        &[
            // The rotation changes -g y at the rate -g x.
            (FALL, TURN, Shown(of_x, 2.0)),
            (FALL, "x*partial(x)", Shown(second, 2.0)),
            (FALL, "y*partial(x)", Shown(mixed, 1.0)),
            (FALL, "t^2*partial(x)", Shown(of_x, 2.0)),
            // The value is d/dx (4 x (x^2 + y^2)).
            (ROUND, "partial(x)", Shown(of_x, 2.6788)),
            (CHARGED, "x*partial(y)", Shown(mixed, 1.0)),
            (CHARGED, "t*partial(x)", Shown(of_y, 3.0)),
            (
                &disk,
                "partial(phi)",
                False("allowed velocities to velocities that are not allowed"),
            ),
            (FALL, "(1 + 1e-9*x)*partial(x)", Shown(second, 2e-9)),
            (
                ROUND,
                "x*partial(y) - (1 + 1e-9)*y*partial(x)",
                Shown(mixed, -1e-9),
            ),
            (
                &disk,
                "partial(phi) - (1 + 1e-9)*y*partial(x) + x*partial(y)",
                Shown(mixed, -1.4e-9),
            ),
        ],
    );
}
