//! Tests of the claim `symplectic`.

use crate::Expected::{Barred, False, Open, Shown, True};
use crate::check;
use crate::reduction::BALL;
use crate::systems::{ball, disk, grooves, media, particle, spokes};

const CLAIM: &str = "symplectic";

fn forced(force: &str) -> String {
    particle("wall: x >= 0;").replace("impacts", &format!("forces {{ pull: {force}; }} impacts"))
}

#[test]
fn maps_and_forces_that_keep_the_form_are_proved() {
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
fn maps_and_forces_that_change_the_form_are_refuted_at_a_point() {
    check(&ball("restitution(c)"), CLAIM, Shown("Jacobian", 0.49));
    check(&ball("impact_plastic"), CLAIM, Shown("Jacobian", 0.0));
    check(
        &ball("reset { dot(x) = -k*dot(x); }"),
        CLAIM,
        Shown("Jacobian", 4.0),
    );
    // Both maps keep the volume, and neither keeps the energy. The first also keeps the area in (x, dot(x)).
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

/// The constraint forces of a homogeneous ball and of a straight groove are 0. The form on D is kept; walls change it.
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

/// A bead on a circular wire whose squared radius is `size`.
fn bead(size: &str, rest: &str) -> String {
    format!(
        "pub Bead {{ coordinates {{ x; y; }} parameters {{ c > 0 = 1/2; }} lagrangian = (dot(x)^2 + dot(y)^2)/2 - y;
        constraints {{ wire: x^2 + y^2 = {size}; }} {rest} CLAIM }}"
    )
}

/// A particle with one constraint.
fn held(constraint: &str, rest: &str) -> String {
    format!(
        "pub Held {{ coordinates {{ x; y; z; }} lagrangian = (dot(x)^2 + dot(y)^2 + dot(z)^2)/2 - y*z^2;
        constraints {{ held: {constraint}; }} {rest} CLAIM }}"
    )
}

/// On a leaf the motion is that of the Lagrangian restricted to the leaf.
#[test]
fn integrable_constraints_keep_the_form_on_their_leaves() {
    let wall = "impacts { wall: x >= 0; }";
    for declaration in [
        bead("1", ""),
        bead("1", wall),
        bead("1 + t^2", ""),
        bead("1", "impacts { wall: x >= 0 => newton(1); }"),
        bead("1", "forces { spring: -x*d(x); }"),
        held("dot(z) = x*dot(x)", wall),
        held("exp(x*y)*(dot(z) - x*dot(x)) = 0", ""),
        held(
            "dot(z) = 3",
            "impacts { wall: x + z <= 3 + t => newton(1); }",
        ),
        // This constraint is integrable with time as a variable: `z - t*x` is constant.
        held("dot(z) = t*dot(x) + x", ""),
    ] {
        check(&declaration, CLAIM, True);
    }
    // `slope` is integrable only together with `stop`.
    let both = "pub Both { coordinates { x; y; z; w; } lagrangian = (dot(x)^2 + dot(y)^2 + dot(z)^2 + dot(w)^2)/2 - z*w;
        constraints { slope: dot(z) = x*dot(y); stop: dot(y) = 0; } CLAIM }";
    check(both, CLAIM, True);
}

#[test]
fn losses_forces_and_nonintegrable_constraints_change_the_form_on_leaves() {
    // On the circle, the form on these vectors is -1 before the impact at x = 0. A law with the coefficient e
    // multiplies the form by e^2.
    let wall = |law: &str| bead("1", &format!("impacts {{ wall: x >= 0 => {law}; }}"));
    let after = "the form on partial(x), partial(dot(x)) after";
    check(&wall("newton(c)"), CLAIM, Shown(after, -0.25));
    check(&wall("impact_plastic"), CLAIM, Shown(after, 0.0));
    check(
        &bead("1", "forces { drag: -c*dot(x)*d(x); }"),
        CLAIM,
        Shown("rate of the form on partial(x), partial(dot(x))", 0.5),
    );
    // The factor, a force, and integrability in space and with time are off by 1e-9.
    check(
        &wall("newton(1 - 1e-9)"),
        CLAIM,
        Shown(after, -(1.0 - 1e-9_f64).powi(2)),
    );
    check(
        &bead("1", "forces { drag: -1e-9*dot(x)*d(x); }"),
        CLAIM,
        Shown("rate of the form on partial(x), partial(dot(x))", 1e-9),
    );
    let slope = held("dot(z) = x*dot(x) + 1e-9*y*dot(x)", "");
    check(&slope, CLAIM, False("lambda_a deta^a(X, Y)"));
    let belt = held("dot(z) = 1e-9*y", "");
    check(&belt, CLAIM, False("the motion changes"));
    // With an affine constraint the elastic law does not reverse the gap rate.
    let turned = held("dot(z) = 3", "impacts { wall: x + z <= 3 + t; }");
    check(&turned, CLAIM, Shown(after, 1.4));
    // The reset moves the states of one leaf to different leaves.
    let torn = held(
        "dot(z) = 0",
        "impacts { wall: x >= 0 => reset { dot(x) = -dot(x); z = z + y; }; }",
    );
    check(&torn, CLAIM, False("`wall` changes"));
}

/// After a transition the form is that of the target mode, in the coordinates of that mode.
#[test]
fn transitions_lead_from_leaves_to_leaves() {
    let step = |potential: &str, z: &str| {
        format!(
            "pub Step {{ coordinates {{ x; y; }} modes {{
                near {{ lagrangian = (dot(x)^2 + dot(y)^2)/2; constraints {{ groove: dot(y) = dot(x); }} CLAIM }}
                far {{ coordinates {{ z; }} lagrangian = (dot(x)^2 + dot(y)^2 + dot(z)^2)/2 - {potential};
                    constraints {{ groove: dot(y) = dot(x); shelf: dot(z) = 0; }} }} }}
            transitions {{ go: near -> far when x <= 0 => reset {{ z = {z}; dot(z) = 0; }}; }} }}"
        )
    };
    // On a leaf of the groove `x - y` is constant. Without forces the form is kept on all of D.
    check(&step("x*z", "x - y"), CLAIM, True);
    check(&step("0", "x + y"), CLAIM, True);
    check(
        &step("x*z", "dot(x)"),
        CLAIM,
        Open("along leaves of the constraints behind it"),
    );
    check(
        &step("x*z", "x - y + 1e-9*dot(x)"),
        CLAIM,
        Open("along leaves of the constraints behind"),
    );
    let mixed = "pub Mixed { coordinates { x; y; z; turn; } constraints { roll: dot(y) = x*dot(turn); shelf: dot(z) = 0; }
        lagrangian = (dot(x)^2 + dot(z)^2 + (dot(y) - x*dot(turn))^2 + dot(turn)^2)/2 - z*x; CLAIM }";
    check(
        mixed,
        CLAIM,
        Open("some constraints are integrable and some are not"),
    );
}

/// A mode that is entered across its leaves has to keep the form on all of its states, at its surfaces too.
#[test]
fn modes_that_are_entered_across_leaves_keep_all_of_the_form() {
    let step = |surfaces: &str, z: &str, rest: &str| {
        format!(
            "pub Step {{ coordinates {{ x; y; s; }} modes {{
                near {{ lagrangian = (dot(x)^2 + dot(y)^2 + dot(s)^2)/2; constraints {{ hold: dot(s) = 0; }} CLAIM }}
                far {{ coordinates {{ z; }} lagrangian = (dot(x)^2 + dot(y)^2 + dot(s)^2 + dot(z)^2)/2;
                    constraints {{ hold: dot(s) = 0; shelf: dot(z) = 0; }} {surfaces} }} }}
            transitions {{ go: near -> far when x <= 0 => reset {{ z = {z}; dot(z) = 0; }}; {rest} }} }}"
        )
    };
    let wall = |gap: &str| format!("impacts {{ wall: {gap} >= -1; }}");
    check(&step("", "dot(y)", ""), CLAIM, True);
    check(&step(&wall("x"), "dot(y)", ""), CLAIM, True);
    // The gap of the wall contains z: its impact keeps the form along leaves of the shelf, but not on vectors that
    // change z.
    let across = Open("along leaves of the constraints behind it");
    check(&step(&wall("x + z"), "dot(y)", ""), CLAIM, across);
    check(&step(&wall("x + 1e-9*z"), "dot(y)", ""), CLAIM, across);
    check(&step(&wall("x + z"), "y", ""), CLAIM, across);
    check(&step(&wall("x + z"), "3", ""), CLAIM, True);
    // Each of the two modes leads to the other one.
    let back = "back: far -> near when x >= 1 => reset { dot(s) = 0; };";
    check(&step("", "dot(y)", back), CLAIM, True);
    let changed = "back: far -> near when x >= 1 => reset { y = y + z; dot(s) = 0; };";
    check(&step("", "3", changed), CLAIM, True);
    check(&step("", "dot(y)", changed), CLAIM, across);
    // A third mode is entered at y = -1, where its potential and its force vanish.
    let third = |potential: &str, z: &str| {
        let on = "on: far -> third when y <= -1 => reset { dot(z) = 0; };";
        let mode = format!(
            "CLAIM }} third {{ coordinates {{ z; }} lagrangian = (dot(x)^2 + dot(y)^2 + dot(s)^2 + dot(z)^2)/2 - {potential};
                constraints {{ hold: dot(s) = 0; shelf: dot(z) = 0; }} }}"
        );
        step("", z, on).replace("CLAIM }", &mode)
    };
    check(&third("0", "dot(y)"), CLAIM, True);
    check(&third("z*(y + 1)^2", "dot(y)"), CLAIM, across);
    check(&third("z*(y + 1)^2", "3"), CLAIM, True);
}

#[test]
fn states_of_more_dimensions_may_keep_the_form() {
    let wider = |reset: &str, rest: &str| {
        format!(
            "pub Wider {{ coordinates {{ x; }} modes {{ line {{ lagrangian = dot(x)^2/2; CLAIM }}
                plane {{ coordinates {{ y; z; }} lagrangian = (dot(x)^2 + dot(y)^2 + dot(z)^2)/2; {rest} }} }}
            transitions {{ go: line -> plane when x <= 0 => reset {{ {reset} }}; }} }}"
        )
    };
    let still = "y = 0; dot(y) = 0; z = 0; dot(z) = 0;";
    check(&wider(still, ""), CLAIM, True);
    // By hand: the saltation matrix maps partial(x) to partial(x) + partial(y).
    let after = "the form on partial(x), partial(dot(x)) after";
    let moving = "y = 0; dot(y) = dot(x); z = 0; dot(z) = 0;";
    check(&wider(moving, ""), CLAIM, Shown(after, -2.0));
    let near = "y = 0; dot(y) = 1e-6*dot(x); z = 0; dot(z) = 0;";
    check(&wider(near, ""), CLAIM, False("`go` changes"));
    // The target mode is entered along its leaves, or across them.
    let belt = "constraints { belt: dot(z) = x*dot(x); }";
    let on_belt = |z: &str| format!("y = 0; dot(y) = 0; z = {z}; dot(z) = x*dot(x);");
    check(&wider(&on_belt("x^2/2"), belt), CLAIM, True);
    let shelf = |z: &str| {
        let lands = format!("y = 0; dot(y) = 0; z = {z}; dot(z) = 0;");
        let held = wider(&lands, "constraints { shelf: dot(z) = 0; }");
        held.replace("dot(z)^2)/2", "dot(z)^2)/2 - x*z")
    };
    check(&shelf("3"), CLAIM, True);
    let across = Open("along leaves of the constraints behind it");
    check(&shelf("dot(x)"), CLAIM, across);
    check(&shelf("3 + 1e-9*dot(x)"), CLAIM, across);
    // For constraints that are not linear in the velocities no leaves are known.
    let speed = wider(
        "y = 0; dot(y) = 1; z = 0; dot(z) = 0;",
        "constraints { speed: dot(y)^2 + dot(z)^2 = 1; }",
    );
    check(
        &speed,
        CLAIM,
        Open("not known whether these are integrable"),
    );
    // A map to fewer dimensions does not keep the form.
    let narrow = "pub Narrow { coordinates { x; y; } lagrangian = (dot(x)^2 + dot(y)^2)/2;
        modes { free { CLAIM } bound { constraints { shelf: dot(y) = 0; } } } transitions { go: free -> bound when x <= 0; } }";
    check(narrow, CLAIM, False("`go`"));
}

/// On `dot(x)^2 + dot(y)^2 = v^2` the rate of the form on `partial(y)` and `partial(dot(x))` is `2 dot(x)/v^2`. It is
/// the coefficient of `d(dot(x))` in `-2 dot(y) dlambda - 2 lambda d(dot(y))`, with `lambda = dot(y)/(2 v^2)`.
#[test]
fn constraints_that_are_not_linear_change_the_form() {
    let speed = |weight: &str, rest: &str| {
        format!(
            "pub Speed {{ coordinates {{ x; y; }} lagrangian = (dot(x)^2 + dot(y)^2)/2 - {weight};
            constraints {{ speed: dot(x)^2 + dot(y)^2 = 4; }} {rest} CLAIM }}"
        )
    };
    let rate = "rate of the form on partial(y), partial(dot(x))";
    let root = 55.0_f64.sqrt();
    check(&speed("y", ""), CLAIM, Shown(rate, root / 8.0));
    check(&speed("1e-9*y", ""), CLAIM, Shown(rate, 1e-9 * root / 8.0));
    check(&speed("0", ""), CLAIM, True);
    check(&speed("y", ""), "invariant: d(dot(x)*exp(-y/4))", True);
    check(
        &speed("y", ""),
        "invariant: d(dot(x)*exp(-y/4*(1 + 1e-9)))",
        False("the motion changes"),
    );
    check(
        &speed("y", ""),
        "invariant: d(dot(x)^2 + dot(y)^2)",
        Barred("is 0 at all states"),
    );
    let wall = "impacts { wall: x >= 0 => reset { dot(x) = -dot(x); }; }";
    check(
        &speed("0", wall),
        CLAIM,
        Open("resets beside constraints that are not linear"),
    );
    // Both roots count: the form is 0 on one of them.
    let two = "pub Two { coordinates { x; y; } lagrangian = (dot(x)^2 + dot(y)^2)/2 - y;
        constraints { speeds: (dot(x) - 1)*(dot(x) - 2) = 0; } CLAIM }";
    check(two, "invariant: (dot(x) - 1)*d(y)^d(dot(y))", True);
    check(
        two,
        "invariant: (dot(x) - 1)*d(y)",
        False("the motion changes"),
    );
    // By hand: the coefficient of d(dot(y)) in -2 dot(y) dlambda - 2 lambda d(dot(y)), with
    // lambda = -1/(10 dot(z)) = -0.08.
    let machine = "pub Machine { coordinates { x; y; z; } lagrangian = (dot(x)^2 + dot(y)^2 + dot(z)^2)/2 - z;
        constraints { machine: dot(x)^2 + dot(y)^2 = 4*dot(z)^2; } CLAIM }";
    let rate = "rate of the form on partial(y), partial(dot(y))";
    check(machine, CLAIM, Shown(rate, 0.1456));
}
