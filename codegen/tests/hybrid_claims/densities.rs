//! Verdicts on the claims `density: exact`, `density: locally_exact`, `density: none` and `density = e` about the
//! motion.
//!
//! Near misses have a slope, an arm, a force or an exponent that differs by 1e-9.

use crate::Expected::{self, Barred, False, Shown, True};
use crate::check;
use crate::systems::{disk, grooves, particle};

/// A particle whose vertical velocity is a multiple of its velocity along x.
fn slope(of: &str) -> String {
    format!(
        "pub Slope {{ coordinates {{ x; y; z; }} lagrangian = (dot(x)^2 + dot(y)^2 + dot(z)^2)/2;
        constraints {{ slope: dot(z) = ({of})*dot(x); }} CLAIM }}"
    )
}

/// A sleigh with its centre of mass this far behind the blade.
fn sleigh(arm: &str) -> String {
    format!(
        "pub Sleigh {{ coordinates {{ x; y; theta: angle; }}
        lagrangian = (dot(x - {arm}*cos(theta))^2 + dot(y - {arm}*sin(theta))^2)/2 + dot(theta)^2/5;
        constraints {{ blade: dot(y)*cos(theta) = dot(x)*sin(theta); }} CLAIM }}"
    )
}

/// A screw whose advance per angle is `pitch*z`, where `pitch` is a function of the angle. In one turn the logarithm
/// `G` of its density changes by minus the integral of `pitch`.
fn screw(pitch: &str) -> String {
    format!(
        "pub Screw {{ coordinates {{ phi: angle; x; z; }} parameters {{ b > 0 = 1; k > 0 = 1/2; }}
        let slip = dot(z) - ({pitch})*z*dot(phi) - b*dot(x); lagrangian = (dot(phi)^2 + dot(x)^2 + slip^2)/2;
        constraints {{ screw: slip = 0; }} CLAIM }}"
    )
}

/// A particle on a line with a force.
fn pulled(by: &str) -> String {
    format!(
        "pub Pulled {{ coordinates {{ x; }} parameters {{ c > 0 = 1/3; }} lagrangian = dot(x)^2/2;
        forces {{ f: ({by})*d(x); }} CLAIM }}"
    )
}

/// A point on a ring and a point on a line. As the first goes round, the force changes the speed of the second.
fn ring(loss: &str) -> String {
    format!(
        "pub Ring {{ coordinates {{ x: angle; y; }} lagrangian = (dot(x)^2 + dot(y)^2)/2;
        forces {{ f: -({loss})*dot(x)*dot(y)*d(y); }} CLAIM }}"
    )
}

fn field(rates: [&str; 2]) -> String {
    crate::systems::field(
        &format!("dot(x) = {}; dot(y) = {};", rates[0], rates[1]),
        "",
    )
}

const WIRE: &str = "pub Wire { coordinates { x; y; } lagrangian = (dot(x)^2 + dot(y)^2)/2 - y;
    constraints { wire: x^2 + y^2 = 1; } CLAIM }";
const CHARGED: &str = "pub Charged { coordinates { x; y; } parameters { b > 0 = 3; }
    lagrangian = (dot(x)^2 + dot(y)^2)/2 + b*x*dot(y); CLAIM }";
const COUPLED: &str = "pub Coupled { coordinates { x; y; }
    lagrangian = dot(x)^2 + dot(y)^2 + cos(x - y)*dot(x)*dot(y) + sin(x - y); CLAIM }";

/// Systems with a density on all of Q.
fn with_density() -> Vec<String> {
    let declared = [WIRE, CHARGED, COUPLED].map(str::to_owned);
    let built = [
        slope("y"),
        slope("exp(y)"),
        sleigh("0"),
        screw("sin(phi)"),
        pulled("-dot(x)^2"),
        ring("sin(x)"),
        disk(""),
        grooves("dot(y) = dot(x)", "dot(y) = 0"),
    ];
    declared.into_iter().chain(built).collect()
}

/// Systems without a density of the position, and the contents of the message.
fn without_density() -> Vec<(String, Expected)> {
    // With g(f) = f/(1 + f^2) and f = x + y = -0.17 at the state: delta = -g'' = 2 f (3 - f^2)/(1 + f^2)^3.
    let f: f64 = -0.17;
    let delta = 2.0 * f * (3.0 - f * f) / (1.0 + f * f).powi(3);
    vec![
        (slope("x + y"), Shown("delta", delta)),
        (
            slope("y^2 + x"),
            False("[X1,[X1,X2]] = 0 as a vector field"),
        ),
        (slope("x*y"), False("[X1,[X1,X2]] = 2.77777777778*[X1,X2]")),
        (slope("y + 1e-9*x"), False("delta")),
        (sleigh("1/3"), False("delta")),
        (sleigh("1e-9"), False("delta")),
        // The divergence is -c also at rest, where the rate of `G` is 0.
        (pulled("-c*dot(x)"), Shown("delta", 1.0 / 3.0)),
        (pulled("-1e-9*dot(x)"), Shown("delta", 1e-9)),
        // -3 dot(x)^2 with dot(x) = 1/2.
        (pulled("-dot(x)^3"), Shown("rate", -0.75)),
    ]
}

/// Systems with local densities `exp(G)`, and the growth of `G` in one turn of the angle.
fn with_growth() -> Vec<(String, f64)> {
    let turn = 2.0 * std::f64::consts::PI;
    vec![
        (screw("1/3"), -turn / 3.0),
        (screw("-2"), 2.0 * turn),
        (screw("1"), -turn),
        (screw("k^2"), -turn / 4.0),
        // The mean of 1/(2 + sin) is 1/sqrt(3).
        (screw("1/(2 + sin(phi))"), -turn / 3.0_f64.sqrt()),
        (ring("1"), turn),
        (ring("1 + sin(x)"), turn),
        (ring("sin(x) + 1e-9"), turn * 1e-9),
    ]
}

#[test]
fn densities_on_all_of_q_are_recognised() {
    for system in with_density() {
        check(&system, "density: exact", True);
        check(&system, "density: none", Barred("exists"));
        check(
            &system,
            "density: locally_exact",
            Barred("exists on all of Q"),
        );
    }
}

#[test]
fn absence_of_a_density_is_proved_and_shown_at_a_point() {
    for (system, shown) in without_density() {
        check(&system, "density: none", True);
        check(&system, "density: exact", shown);
        check(&system, "density: locally_exact", shown);
    }
}

#[test]
fn densities_that_grow_on_a_turn_are_local_ones() {
    for (system, period) in with_growth() {
        check(&system, "density: locally_exact", True);
        check(&system, "density: exact", Shown("period", period));
        check(&system, "density: none", Barred("exists"));
    }
}

#[test]
fn stated_densities_that_the_motion_keeps_are_proved() {
    for (system, density) in [
        (slope("y"), "sqrt(1 + y^2)"),
        (slope("y"), "3*sqrt(1 + y^2)"),
        (slope("x + y"), "sqrt(1 + (x + y)^2)/abs(dot(x) + dot(y))"),
        (sleigh("1/3"), "1/abs(dot(theta))"),
        (screw("sin(phi)"), "exp(cos(phi))"),
        (disk(""), "1"),
        (pulled("-c*dot(x)"), "exp(c*t)"),
        (pulled("-dot(x)"), "1/abs(dot(x))"),
        (pulled("-dot(x)^2"), "exp(2*x)"),
        (field(["x", "-2*y"]), "abs(x)"),
        (field(["x", "-2*y"]), "1/abs(y)^(1/2)"),
        (field(["1", "0"]), "1 + y^2"),
        (particle(""), "1 + (dot(x)^2 + dot(y)^2)^2"),
    ] {
        check(&system, &format!("density = {density}"), True);
    }
}

/// The state of the witness is x = 0.36, y = -0.53, dot(x) = 0.5, dot(y) = -0.75.
#[test]
fn stated_densities_that_the_motion_changes_are_refuted_at_a_point() {
    let (y, dy) = (-0.53, -0.75);
    for (system, density, name, value) in [
        // G = ln(1 + y^2)/2 has the rate y dot(y)/(1 + y^2).
        (slope("y"), "1", "divergence", -y * dy / (1.0 + y * y)),
        (
            slope("y"),
            "1 + y^2",
            "d/dt(ln(1 + y^2))",
            2.0 * y * dy / (1.0 + y * y),
        ),
        (pulled("-c*dot(x)"), "1", "divergence", -1.0 / 3.0),
        (
            pulled("-c*dot(x)"),
            "exp(2*c*t)",
            "d/dt(ln(exp(2*c*t)))",
            2.0 / 3.0,
        ),
        (pulled("-dot(x)"), "exp(x)", "d/dt(ln(exp(x)))", 0.5),
        (
            pulled("-dot(x)"),
            "1/abs(dot(x))^2",
            "d/dt(ln(1/abs(dot(x))^2))",
            2.0,
        ),
        (pulled("-dot(x)^2"), "exp(x)", "divergence", -1.0),
        (field(["x", "-2*y"]), "1", "divergence", -1.0),
        (field(["x", "-2*y"]), "abs(x)^2", "d/dt(ln(abs(x)^2))", 2.0),
        (
            field(["1", "0"]),
            "1 + x^2",
            "d/dt(ln(1 + x^2))",
            0.72 / 1.1296,
        ),
        (
            field(["1", "0"]),
            "exp(1e-9*x)",
            "d/dt(ln(exp(1e-9*x)))",
            1e-9,
        ),
        (
            field(["x", "-(2 + 1e-9)*y"]),
            "abs(x)",
            "divergence",
            -(1.0 + 1e-9),
        ),
    ] {
        check(&system, &format!("density = {density}"), Shown(name, value));
    }
    let near = "density = sqrt(1 + y^2)*(1 + 1e-9*sin(x))";
    check(&slope("y"), near, False("divergence = -0.31032867515"));
}
