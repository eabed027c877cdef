//! Tests of the claim `invariant: FORM`.

use crate::Expected::{Barred, False, Open, Shown, True};
use crate::check;
use crate::systems::{ball, crossing, disk, field, grooves, media, particle, spokes, walker};

const AREA: &str = "invariant: d(momentum(x))^d(x)";
const PLANE: &str = "invariant: d(momentum(x))^d(x) + d(momentum(y))^d(y)";
const SPACE: &str = "invariant: d(x)^d(y)^d(dot(x))^d(dot(y))";
const ON_D: &str = "invariant: d(x)^d(y)^d(theta)^d(phi)^d(dot(theta))^d(dot(phi))";

/// A particle on a line in a potential.
const QUARTIC: &str = "pub Quartic { coordinates { x; } lagrangian = dot(x)^2/2 - x^4; CLAIM }";

/// Constant fields on both sides of `x = 0`, with a parameter.
fn parametric(left: [&str; 2], parameter: &str) -> String {
    let declared = format!("coordinates {{ x; y; }} parameters {{ {parameter}; }}");
    crossing(["-2", "1"], left, "1").replace("coordinates { x; y; }", &declared)
}

/// A particle on a line with a force.
fn forced(force: &str) -> String {
    format!(
        "pub Forced {{ coordinates {{ x; }} parameters {{ c > 0 = 1/3; }} lagrangian = dot(x)^2/2 - x^4;
        forces {{ f: {force}; }} CLAIM }}"
    )
}

fn sleigh() -> &'static str {
    "pub Sleigh { coordinates { x; y; theta: angle; } parameters { a > 0 = 1/3; }
    lagrangian = (dot(x - a*cos(theta))^2 + dot(y - a*sin(theta))^2)/2 + dot(theta)^2/5;
    constraints { blade: dot(y)*cos(theta) = dot(x)*sin(theta); } CLAIM }"
}

#[test]
fn forms_that_the_motion_keeps_are_proved() {
    check(QUARTIC, AREA, True);
    check(&forced("x^3*d(x)"), "invariant: d(momentum(x)*d(x))", True);
    check(QUARTIC, "invariant: d(energy)", True);
    check(QUARTIC, "invariant: energy^2*d(x)^d(dot(x))", True);
    // The volume shrinks at the rate c, and exp(c*t) grows at this rate.
    check(
        &forced("-c*dot(x)*d(x)"),
        "invariant: exp(c*t)*d(x)^d(dot(x))",
        True,
    );
    let sheared = field("dot(x) = 1; dot(y) = x;", "");
    check(&sheared, "invariant: d(x)^d(y)", True);
    check(&sheared, "invariant: d(y) - x*d(x)", True);
    check(&sheared, "invariant: (y - x^2/2)*d(x)", True);
    check(
        sleigh(),
        "invariant: d(x)^d(y)^d(theta)^d(dot(x))^d(dot(theta))/(cos(theta)*dot(theta))",
        True,
    );
    check(&disk(""), ON_D, True);
    check(&disk(""), "invariant: d(dot(phi))^d(dot(theta))", True);
}

#[test]
fn forms_that_the_motion_changes_are_refuted() {
    // The form d(x): its rate along the motion is d(dot(x)).
    check(
        QUARTIC,
        "invariant: d(x)",
        Shown("rate of the form on partial(dot(x))", 1.0),
    );
    check(
        &forced("-dot(x)*d(x)/3"),
        "invariant: d(x)^d(dot(x))",
        Shown(
            "rate of the form on partial(x), partial(dot(x))",
            -1.0 / 3.0,
        ),
    );
    check(
        &forced("-c*dot(x)*d(x)"),
        "invariant: exp(2*c*t)*d(x)^d(dot(x))",
        False("the motion changes"),
    );
    check(
        &field("dot(x) = 3*x; dot(y) = -2*y;", ""),
        "invariant: d(x)^d(y)",
        Shown("rate of the form on partial(x), partial(y)", 1.0),
    );
    check(
        sleigh(),
        "invariant: d(x)^d(y)^d(theta)^d(dot(x))^d(dot(theta))/cos(theta)",
        False("the motion changes"),
    );
    check(
        &disk(""),
        "invariant: d(momentum(x))^d(x)",
        False("the motion changes"),
    );
    check(
        &disk(""),
        "invariant: d(momentum(x))^d(x) + d(momentum(y))^d(y) + d(momentum(theta))^d(theta) + d(momentum(phi))^d(phi)",
        False("the motion changes"),
    );
}

#[test]
fn impacts_that_keep_forms_are_proved() {
    check(&ball("elastic"), AREA, True);
    check(&ball("elastic"), "invariant: d(energy)", True);
    check(&particle("wall: x^2 + y^2 >= 1;"), PLANE, True);
    check(&particle("moving: x - sin(t) >= 0;"), PLANE, True);
    check(
        &particle("left: x >= 0;"),
        "invariant: d(dot(x)^2)^d(dot(y))",
        True,
    );
    // The reset multiplies dot(x) by -alpha and dot(y) by beta, with alpha^2 beta = 1.
    check(
        &particle("left: x >= 0 => reset { dot(x) = -5/4*dot(x); dot(y) = 16/25*dot(y); };"),
        SPACE,
        True,
    );
    check(
        &particle("left: x >= 0 => reset { dot(x) = -dot(x); x = x; y = y + x; };"),
        PLANE,
        True,
    );
    check(&disk("wall: x <= 1;"), ON_D, True);
    let media = media(
        "m1/2*(dot(x)^2 + dot(y)^2)",
        "m2/2*(dot(x)^2 + dot(y)^2) - V",
    );
    check(&media, PLANE, True);
    check(&media, "invariant: d(momentum(y))", True);
    let crossing = crossing(["-2", "1"], ["-2", "-1"], "1");
    check(&crossing, "invariant: d(x)^d(y)", True);
    check(&crossing, "invariant: d(x)", True);
    let turned = field(
        "dot(x) = 1; dot(y) = 0;",
        "right: x <= 1 => reset { x = 0; y = y + k; };",
    );
    check(&turned, "invariant: d(y)", True);
}

#[test]
fn impacts_that_change_forms_are_refuted() {
    check(
        &ball("newton(7/10)"),
        "invariant: d(x)^d(dot(x))",
        Shown("the form on partial(x), partial(dot(x)) after", 0.49),
    );
    check(&ball("impact_plastic"), AREA, False("`floor` changes"));
    check(
        &particle("left: x >= 0;"),
        "invariant: d(dot(x))",
        Shown("the form on partial(dot(x)) after", -1.0),
    );
    check(
        &particle("left: x >= 0 => reset { dot(x) = -a*dot(x); dot(y) = b*dot(y); };"),
        SPACE,
        False("`left` changes"),
    );
    check(
        &particle("left: x >= 0 => reset { dot(x) = -2*dot(x); dot(y) = dot(y)/4; };"),
        PLANE,
        False("`left` changes"),
    );
    // The saltation matrix is [[1, 0], [1, 1]]: a motion that starts further to the right reaches the other field
    // later.
    check(
        &crossing(["-2", "1"], ["-2", "-1"], "1"),
        "invariant: d(y)",
        Shown("the form on partial(x) after", 1.0),
    );
    check(
        &crossing(["-2", "1"], ["-1", "-1"], "2"),
        "invariant: d(x)^d(y)",
        Shown("the form on partial(x), partial(y) after", 0.5),
    );
    check(
        &grooves("dot(y) = dot(x)/2", "dot(y) = 2*dot(x)"),
        "invariant: d(x)^d(y)^d(dot(x))",
        Shown(
            "the form on partial(x), partial(y), partial(dot(x)) after",
            0.16,
        ),
    );
    check(
        &field(
            "dot(x) = 1; dot(y) = 0;",
            "right: x <= 1 => reset { x = 0; y = 2*y; };",
        ),
        "invariant: d(y)^d(x)",
        Shown("the form on partial(x), partial(y) after", -2.0),
    );
    check(
        &spokes("l1/l2*cos(2*h)*dot(x)"),
        AREA,
        False("`step` changes"),
    );
    check(
        &walker("cos(2*delta)*dot(theta)"),
        "invariant: d(momentum(x_c))^d(x_c) + d(momentum(theta))^d(theta)",
        False("`step` changes"),
    );
    check(
        &disk("wall: x <= 1 => newton(1/2);"),
        ON_D,
        False("`wall` changes"),
    );
}

#[test]
fn near_misses_are_refuted() {
    check(
        &ball("newton(1 - 1e-9)"),
        "invariant: d(dot(x))^d(x)",
        Shown(
            "the form on partial(x), partial(dot(x)) after",
            -(1.0 - 1e-9_f64).powi(2),
        ),
    );
    check(
        QUARTIC,
        "invariant: (1 + 1e-9*x)*d(x)^d(dot(x))",
        False("rate of the form on partial(x), partial(dot(x))"),
    );
    check(
        &forced("-c*dot(x)*d(x)"),
        "invariant: exp((1 + 1e-9)*c*t)*d(x)^d(dot(x))",
        False("the motion changes"),
    );
    check(
        &particle(
            "left: x >= 0 => reset { dot(x) = -5/4*dot(x); dot(y) = (16/25 + 1e-9)*dot(y); };",
        ),
        SPACE,
        False("`left` changes"),
    );
    check(
        &crossing(["-2", "1"], ["-2", "1 + 1e-9"], "1"),
        "invariant: d(y)",
        False("`leftward` changes"),
    );
    // The wall is next to `x = 0`, where the reset would not change `y`.
    check(
        &particle("left: x >= 1e-9 => reset { dot(x) = -dot(x); y = y + x*dot(y)*dot(x)^2; };"),
        PLANE,
        False("`left` changes"),
    );
}

/// A particle with `g = 2` is stopped by a floor, which holds it, or by a ceiling, from which it falls again. The
/// values follow by hand from `v+ = dDelta(v) + (X+ - dDelta(X)) dh(v)/dh(X)`: the impact maps states by `Delta`, and
/// the motion has the rates `X` before and `X+` after it.
#[test]
fn forms_change_behind_laws_that_stop_the_motion() {
    let stop = |surface: &str| {
        format!(
            "pub Stop {{ coordinates {{ x; y; }} lagrangian = (dot(x)^2 + dot(y)^2)/2 - 2*y; impacts {{ stop: {surface}; }} CLAIM }}"
        )
    };
    let [floor, ceiling] = ["y >= 0 => impact_plastic", "y <= 0 => newton(0)"].map(stop);
    // On vectors along the surface, with dh(v) = 0, only the law matters.
    let along = "the form on partial(dot(y)) after";
    for held in [&floor, &ceiling] {
        check(held, "invariant: d(momentum(y) + 2*t)", Shown(along, 0.0));
        check(held, "invariant: d(dot(y)^2/2 + 2*y)", Shown(along, 0.0));
    }
    // On the floor, partial(y) becomes 0. Below the ceiling, which is met at dot(y) = 1.25, it becomes
    // -1.6 partial(dot(y)).
    let fallen = "invariant: d(momentum(y))^d(y)";
    check(&floor, fallen, False("the motion behind it is held"));
    check(
        &ceiling,
        fallen,
        False("the motion behind it goes on freely"),
    );
    let fall = "invariant: exp(y + dot(y)^2/4)*d(dot(y)^2/4 + y)^d(x - t*dot(x))";
    check(&floor, fall, False("`stop` changes"));
    // Without constraints, `nonholonomic_plastic` is elastic. With constraints, the motion may leave the surface.
    let elastic = stop("y >= 0 => nonholonomic_plastic");
    check(&elastic, "invariant: d(momentum(x))", True);
    check(&elastic, "invariant: d(x - t*dot(x))", True);
    let rim = disk("rim: 1 - x >= 0 => nonholonomic_plastic;");
    check(&rim, "invariant: d(dot(theta))", False("`rim` changes"));
}

/// A particle on a belt that moves with the velocity `dot(z)`, at an angle to a wall. `restitution(0)` stops the
/// velocity across the belt, and leaves the gap rate due to the belt.
#[test]
fn a_belt_carries_the_motion_away_from_a_wall() {
    let belt = |rate: &str, law: &str| {
        format!(
            "pub Belt {{ coordinates {{ x; z; }} lagrangian = (dot(x)^2 + dot(z)^2)/2 - x;
            constraints {{ belt: dot(z) = {rate}; }} impacts {{ wall: x + z >= 0 => {law}; }} CLAIM }}"
        )
    };
    let pair = "invariant: d(z)^d(dot(x))";
    let along = "; the motion behind it goes on freely";
    check(&belt("1/4", "restitution(0)"), pair, False(along));
    // By hand: partial(x) becomes a vector with d(dot(x)) = -1/(dot(x) + 1/4), at dot(x) = -3/4.
    let after = "the form on partial(x), partial(z) after";
    check(&belt("1/4", "restitution(0)"), pair, Shown(after, -2.0));
    // The velocity with which the belt leads into the wall remains; no law reverses it.
    check(
        &belt("-1/4", "restitution(0)"),
        pair,
        Open("a law that reverses the rate of its gap"),
    );
    let held = "; the motion behind it is held";
    check(&belt("1/4", "newton(0)"), pair, False(held));
    check(&belt("1/4", "impact_plastic"), pair, False(held));
    check(&belt("0", "restitution(0)"), pair, False(held));
    // The volume becomes 0 even where the verdict on `pair` is open.
    let volume = "invariant: d(x)^d(z)^d(dot(x))";
    check(
        &belt("-1/4", "restitution(0)"),
        volume,
        False("`wall` changes"),
    );
}

#[test]
fn forms_that_are_not_examined_stay_open() {
    // The metric couples x and y: stopping the velocity along the wall changes the velocity across it.
    let coupled = particle("hold: x >= 0 => elastic, instantaneous { stick: dot(y) = 0; };")
        .replace("dot(y)^2)/2", "dot(y)^2 + dot(x)*dot(y))/2");
    check(
        &coupled,
        PLANE,
        Open("instantaneous constraints change the gap rate"),
    );
    check(
        &particle("hold: x >= 0 => impact_plastic;"),
        "invariant: d(dot(y))",
        Open("the sign of the acceleration of its gap at all states"),
    );
    check(
        &disk("hold: 1 - x >= 0 => nonholonomic_plastic;"),
        "invariant: d(dot(phi))",
        Open("a law that reverses the rate of its gap at all states"),
    );
    check(
        &parametric(["k", "1"], "k = 1"),
        "invariant: d(y)",
        Open("may slide"),
    );
    check(
        &parametric(["-k", "1"], "k > 0 = 1"),
        "invariant: d(y)",
        True,
    );
    check(
        QUARTIC,
        "invariant: (energy - 1)/abs(energy - 1)*d(x)^d(dot(x))",
        True,
    );
    check(
        &field("dot(x) = 1; dot(y) = 0;", ""),
        "invariant: x/abs(x)*d(y)",
        Open("it may jump"),
    );
}

#[test]
fn forms_without_components_are_refused() {
    check(
        &disk(""),
        "invariant: d(x)^d(y)^d(theta)^d(phi)^d(dot(theta))^d(dot(phi))^d(dot(x))",
        Barred("is of degree 7"),
    );
    check(
        &crossing(["-2", "1"], ["-2", "1"], "1"),
        "invariant: (dot(x) + 2)*d(x)",
        Barred("is 0 at all states"),
    );
    check(
        &disk(""),
        "invariant: d(dot(x))^d(theta) - R*cos(phi)*d(dot(theta))^d(theta) + R*sin(phi)*dot(theta)*d(phi)^d(theta)",
        Barred("is 0 at all states"),
    );
}
