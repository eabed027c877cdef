//! Densities of models with forces that depend on velocities, affine constraints, or dependence on time.

use dalembert_declarations::bodies::{BODY, EULER};
use dalembert_tests::verdict::{Decided, Existence};
use dalembert_tests::verified::verified;

fn sleigh(offset: &str, rest: &str) -> String {
    format!(
        "Sleigh {{
            coordinates {{ x; y; theta: angle; }}
            parameters {{ m > 0 = 2; I > 0 = 3; c > 0 = 1/2; k = 1/3; }}
            let xc = x + {offset}*cos(theta); let yc = y + {offset}*sin(theta);
            lagrangian = m/2*(dot(xc)^2 + dot(yc)^2) + I/2*dot(theta)^2;
            {rest}
        }}"
    )
}

const BLADE: &str = "constraints { blade: -sin(theta)*d(x) + cos(theta)*d(y) = 0; }";

#[test]
fn friction_contracts_and_what_does_no_work_on_d_does_not() {
    let with = |force: &str| sleigh("0", &format!("{BLADE} forces {{ f: {force}; }}"));
    for friction in ["-c*dot(theta)*d(theta)", "-c*(dot(x)*d(x) + dot(y)*d(y))"] {
        assert_eq!(verified(&with(friction)), Existence::None, "{friction}");
    }
    for harmless in [
        // Friction across the blade.
        "-c*(-sin(theta)*dot(x) + cos(theta)*dot(y))*(-sin(theta)*d(x) + cos(theta)*d(y))",
        // A gyroscopic force, and a force that depends only on the position.
        "c*(dot(x)*d(theta) - dot(theta)*d(x))",
        "(x - y)*d(theta)",
        // The divergences of friction and of its opposite cancel.
        "-c*dot(theta)/m*d(theta) + c/I*(dot(x)*d(x) + dot(y)*d(y))",
    ] {
        assert_eq!(verified(&with(harmless)), Existence::Global, "{harmless}");
    }
}

/// `F = -k xdot^2 dx` has the divergence `-2 k xdot/m`. The density is `exp(2 k x/m)`, which is not single-valued if
/// `x` is an angle.
#[test]
fn drag_quadratic_in_the_velocity_is_a_density_on_a_line() {
    let bead = |domain: &str, drag: &str| {
        format!(
            "Bead {{ coordinates {{ x{domain}; y; }} lagrangian = dot(x)^2 + dot(y)^2/2;
                forces {{ drag: {drag}*d(x); }} }}"
        )
    };
    assert_eq!(verified(&bead("", "-3*dot(x)^2")), Existence::Global);
    assert_eq!(verified(&bead(": angle", "-3*dot(x)^2")), Existence::Local);
    assert_eq!(verified(&bead("", "-3*dot(x)*dot(y)")), Existence::Global);
    assert_eq!(verified(&bead("", "-3*y*dot(x)^2")), Existence::None);
    assert_eq!(
        Decided::of(&bead("", "-dot(x)^3")).existence(),
        Existence::Open
    );
}

#[test]
fn affine_constraints_add_the_divergence_of_their_drift() {
    let affine = |offset: &str, drift: &str| {
        let blade = "-sin(theta)*d(x) + cos(theta)*d(y)";
        sleigh(
            offset,
            &format!("constraints {{ blade: {blade} + ({drift})*d(t) = 0; }}"),
        )
    };
    assert_eq!(verified(&affine("0", "k")), Existence::Global);
    assert_eq!(
        verified(&affine("0", "x^2*y + sin(theta)")),
        Existence::None
    );
    assert_eq!(
        verified(&affine("k", "x^2*y + sin(theta)")),
        Existence::None
    );
    // A rotating table: the drift is a rotation of the plane.
    assert_eq!(
        verified(&affine("0", "k*(x*cos(theta) + y*sin(theta))")),
        Existence::Global
    );
}

/// For a round ball the density is 1. For a ball with an axis of symmetry it is `sqrt(det m)`.
#[test]
fn balls_on_a_turning_table_keep_a_volume() {
    let table = |inertia: &str| {
        format!(
            "Table {{ coordinates {{ x; y; {EULER} }} parameters {{ m > 0 = 2; A > 0 = 3; C > 0 = 5; w = 1/2; }} {BODY}
                lagrangian = m/2*(dot(x)^2 + dot(y)^2) + ({inertia})/2;
                constraints {{ rolling_x: dot(x) - s2 = -w*y; rolling_y: dot(y) + s1 = w*x; }} }}"
        )
    };
    assert_eq!(
        verified(&table("A*(b1^2 + b2^2 + b3^2)")),
        Existence::Global
    );
    let symmetric = table("A*(b1^2 + b2^2) + C*b3^2");
    assert_eq!(verified(&symmetric), Existence::Global);
    let potential = Decided::of(&symmetric).potential();
    assert_eq!(potential.as_deref(), Some("1/2*ln(det m)"));
}

/// Without constraints the volume of phase space is kept although metric and potential depend on time. With constraints
/// that depend on time a density may exist.
#[test]
fn time_enters_metric_and_constraints() {
    let free = "Free { coordinates { x; y; }
        lagrangian = (2 + sin(t))*dot(x)^2/2 + exp(t)*dot(y)^2/2 + t*x*dot(y) - x*y*t; }";
    assert_eq!(verified(free), Existence::Global);
    let blade = |metric: &str, form: &str| {
        format!(
            "Blade {{ coordinates {{ x; y; theta: angle; }}
                lagrangian = {metric}*(dot(x)^2 + dot(y)^2)/2 + dot(theta)^2/2;
                constraints {{ blade: {form} = 0; }} }}"
        )
    };
    let turning = "-sin(theta + t)*d(x) + cos(theta + t)*d(y)";
    assert_eq!(verified(&blade("1", turning)), Existence::Global);
    assert_eq!(verified(&blade("exp(t)", turning)), Existence::Global);
    assert_eq!(
        verified(&blade("(1 + t^2)", "d(y) - t*d(x)")),
        Existence::Global
    );
    // With `s = t + x` and the affine part `x`, the divergence is the rate of `-ln(1 + s^2)/2`. The affine part `y`
    // adds `-1/(1 + s^2)`, which is not the rate of a function of the configuration.
    let drift = |drift: &str| blade("1", &format!("d(y) - (t + x)*d(theta) + {drift}*d(t)"));
    assert_eq!(verified(&drift("x")), Existence::Global);
    assert_eq!(verified(&drift("y")), Existence::None);
    // With `s = t*x` and `a = 1 + s^2` the divergence is the rate of `-ln(a) - F(s)` with
    // `F' = s*(1 + 3*s^2)/(1 + a*s^2)`.
    let scaled = blade("(1 + x^2*t^2)", "d(y) - t*x*d(theta)");
    assert_eq!(verified(&scaled), Existence::Global);
}
