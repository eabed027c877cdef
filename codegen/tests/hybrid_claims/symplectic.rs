//! `symplectic`.

use crate::Expected::{False, Open, Shown, True};
use crate::check;
use crate::reduction::BALL;
use crate::systems::{ball, disk, grooves, media, particle, spokes};

const CLAIM: &str = "symplectic";

fn forced(force: &str) -> String {
    particle("wall: x >= 0;").replace("impacts", &format!("forces {{ pull: {force}; }} impacts"))
}

#[test]
fn what_keeps_the_form_is_proved() {
    check(&ball("elastic"), CLAIM, True);
    check(&ball("newton(1)"), CLAIM, True);
    check(&ball("reset { dot(x) = -dot(x); }"), CLAIM, True);
    check(&particle("wall: 1 - x^2 - y^2 >= 0;"), CLAIM, True);
    check(&particle("wall: x <= 1 + t^2;"), CLAIM, True);
    check(
        &particle("low: y >= 0 => reset { dot(y) = -dot(y); x = x + 3; };"),
        CLAIM,
        True,
    );
    check(
        &particle("low: y >= 0 => reset { dot(y) = -dot(y); dot(x) = -dot(x); x = -x; };"),
        CLAIM,
        True,
    );
    check(
        &media(
            "m1/2*(dot(x)^2 + dot(y)^2)",
            "m2/2*(dot(x)^2 + dot(y)^2) - V",
        ),
        CLAIM,
        True,
    );
    check(
        &media(
            "(dot(x)^2 + dot(y)^2)/2 + x*dot(y)",
            "(dot(x)^2 + dot(y)^2)/2",
        ),
        CLAIM,
        True,
    );
    check(&forced("-x*y^2*d(x) - x^2*y*d(y)"), CLAIM, True);
    check(&forced("-t*x*d(x)"), CLAIM, True);
}

#[test]
fn what_does_not_is_refuted_at_a_point() {
    check(&ball("restitution(c)"), CLAIM, Shown("Jacobian", 0.49));
    check(&ball("impact_plastic"), CLAIM, Shown("Jacobian", 0.0));
    check(
        &ball("reset { dot(x) = -k*dot(x); }"),
        CLAIM,
        Shown("Jacobian", 4.0),
    );
    // Volume and area in (x, dot(x)) are kept, energy is not.
    check(
        &particle("low: y >= 0 => reset { dot(y) = -dot(y); dot(x) = dot(x)/2; x = 2*x; };"),
        CLAIM,
        False("changes `d(momentum(x))^d(x) + d(momentum(y))^d(y)`"),
    );
    check(
        &particle("left: x >= 0 => reset { dot(x) = -a*dot(x); dot(y) = dot(y)/a^2; };"),
        CLAIM,
        False("changes `d(momentum(x))^d(x) + d(momentum(y))^d(y)`"),
    );
    check(
        &forced("-y*d(x) + x*d(y)"),
        CLAIM,
        Shown("curl of the force in x and y", -2.0),
    );
    check(
        &forced("-dot(x)*d(x)"),
        CLAIM,
        False("derivative of the force on x by dot(x)"),
    );
    check(&disk(""), CLAIM, False("lambda_a deta^a(X, Y)"));
    check(
        &disk("wall: x <= 1;"),
        CLAIM,
        False("lambda_a deta^a(X, Y)"),
    );
    check(&spokes("l1/l2*cos(2*h)*dot(x)"), CLAIM, False("step"));
    let sleigh = "pub Sleigh { coordinates { x; y; theta: angle; } lagrangian = (dot(x)^2 + dot(y)^2 + dot(theta)^2)/2;
        constraints { blade: dot(x)*sin(theta) = dot(y)*cos(theta); } CLAIM }";
    check(sleigh, CLAIM, False("lambda_a deta^a(X, Y)"));
}

#[test]
fn near_misses_are_refuted() {
    check(&ball("newton(1 - 1e-9)"), CLAIM, False("Jacobian"));
    check(
        &particle(
            "low: y >= 0 => reset { dot(y) = -dot(y); dot(x) = dot(x) + 1e-9*y*dot(x) + 1e-9; x = x; };",
        ),
        CLAIM,
        False("changes `d(momentum(x))^d(x) + d(momentum(y))^d(y)`"),
    );
    check(
        &forced("1e-9*y*d(x)"),
        CLAIM,
        Shown("curl of the force in x and y", 1e-9),
    );
}

/// The constraint forces of a homogeneous ball and of a straight groove are 0, and the form on D is kept; walls change it on D.
#[test]
fn constraints_without_forces_keep_the_form_on_d() {
    check(BALL, CLAIM, True);
    let wall = BALL.replace("CLAIM", "impacts { wall: x >= 0; } CLAIM");
    check(&wall, CLAIM, False("`wall` changes"));
    let sticky =
        "impacts { wall: x >= 0 => elastic, instantaneous { no_slip: dot(y) = r*wz; }; } CLAIM";
    check(
        &BALL.replace("CLAIM", sticky),
        CLAIM,
        False("`wall` changes"),
    );
    check(&grooves("dot(y) = dot(x)", "dot(y) = dot(x)"), CLAIM, True);
    // A slope of 1e-9 is nonholonomic, and its forces are not 0.
    let slope =
        "pub Slope { coordinates { x; y; z; } lagrangian = (dot(x)^2 + dot(y)^2 + dot(z)^2)/2;
        constraints { slope: dot(z) = 1e-9*y*dot(x); } CLAIM }";
    check(slope, CLAIM, False("lambda_a deta^a(X, Y)"));
}

#[test]
fn leaves_of_integrable_constraints_are_not_looked_at() {
    let bead = "pub Bead { coordinates { x; y; } lagrangian = (dot(x)^2 + dot(y)^2)/2 - y;
        constraints { wire: x^2 + y^2 = 1; } CLAIM }";
    check(bead, CLAIM, Open("leaves of integrable constraints"));
}
