//! Claims about models with position equations: what happens at positions that break them counts for nothing.

use dalembert_tests::claim::Outcome::{Proved, Refuted, Undecided};
use dalembert_tests::claim::{Outcome, check};

const FREE: &str = "coordinates { x; y; } lagrangian = (dot(x)^2 + dot(y)^2)/2;";
const ROD: &str = "constraints { rod: x^2 + y^2 = 1; }";

/// Checks a claim about a pendulum in Cartesian coordinates.
#[track_caller]
fn pendulum(rest: &str, claim: &str, expected: Outcome) {
    let falling = "coordinates { x; y; } lagrangian = (dot(x)^2 + dot(y)^2)/2 - y;";
    check(&format!("{falling} {ROD} {rest}"), claim, expected);
}

#[test]
fn conserved_quantities_are_those_of_positions_that_satisfy_the_equations() {
    let length = "(x^2 + y^2 - 1)";
    pendulum("", "conserved: energy*(x^2 + y^2)", Proved);
    pendulum("", &format!("conserved: x*{length}"), Proved);
    pendulum("", &format!("not conserved: x*{length}"), Refuted("is 0"));
    pendulum("", "conserved: x*dot(y) - y*dot(x)", Refuted("d/dt"));
    pendulum("", "not conserved: x*dot(y) - y*dot(x)", Proved);
    let force = format!("forces {{ f: {length}*d(x); }}");
    pendulum(&force, "conserved: energy", Proved);
    let friction = format!("forces {{ f: -{length}*(dot(x)*d(x) + dot(y)*d(y)); }}");
    pendulum(&friction, "not conserved: energy", Refuted("is 0"));
    // No position has x > 1, but residues know no order.
    pendulum(
        "",
        "conserved: abs(x - 2) + x",
        Undecided("values at real points do not confirm"),
    );
    let long = "coordinates { x; y; } parameters { l > 0 = 1; g = 9.81; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2 - g*y; constraints { rod: x^2 + y^2 = l^2; }";
    let scaled = "(dot(x)^2 + dot(y)^2)/2 + g*y*(x^2 + y^2)/l^2";
    check(long, &format!("conserved: {scaled}"), Proved);
}

#[test]
fn equations_may_depend_on_time_and_on_each_other() {
    let driven = format!("{FREE} constraints {{ drive: y = sin(t); }}");
    check(&driven, "conserved: x*(y - sin(t)) + dot(x)", Proved);
    check(&driven, "conserved: y", Refuted("d/dt(y)"));
    let hyperbola = format!("{FREE} constraints {{ c: x*y = 1; }}");
    check(&hyperbola, "conserved: energy + x*(x*y - 1)", Proved);
    check(&hyperbola, "conserved: energy + x", Refuted("d/dt"));
    let chain = "coordinates { x; y; u; v; } lagrangian = (dot(x)^2 + dot(y)^2 + dot(u)^2 + dot(v)^2)/2 - y - v;
        constraints { first: x^2 + y^2 = 1; second: (u - x)^2 + (v - y)^2 = 1; }";
    let second = "((u - x)^2 + (v - y)^2)";
    check(chain, &format!("conserved: energy*{second}"), Proved);
    check(chain, "conserved: x*dot(y) - y*dot(x)", Refuted("d/dt"));
    check(chain, "density: exact", Proved);
}

#[test]
fn equations_that_are_not_solved_leave_open_what_depends_on_them() {
    let link = "coordinates { a: angle; b: angle; } lagrangian = (dot(a)^2 + dot(b)^2)/2;
        constraints { link: sin(a) + sin(b) = 1; }";
    check(link, "conserved: energy", Proved);
    check(
        link,
        "conserved: cos(a)*(sin(a) + sin(b) - 1)",
        Undecided("the equations of its positions are not solved"),
    );
    check(link, "conserved: sin(a)", Refuted("d/dt(sin(a))"));
    check(link, "density: exact", Proved);
}

#[test]
fn impacts_happen_at_positions_that_satisfy_the_equations() {
    let wall = "impacts { w: x >= 0 => newton(1/2); }";
    // At the wall, y is 1 or -1.
    pendulum(wall, "conserved under w: dot(x)*(y^2 - 1)", Proved);
    pendulum(wall, "conserved under w: dot(x)*(y - 1)", Refuted("y = -1"));
    pendulum(wall, "conserved under w: dot(x)*(y + 1)", Refuted("y = 1"));
    let turn = "impacts { w: x >= 0 => reset { dot(x) = -dot(x)*(y^2 + 1)/2; }; }";
    pendulum(turn, "energy under w: not increasing", Proved);
    pendulum(turn, "volume: kept", Proved);
}

#[test]
fn densities_are_those_of_the_positions_that_satisfy_the_equations() {
    let friction = "-(dot(x)*d(x) + dot(y)*d(y))";
    let vanishing = format!("forces {{ f: (x^2 + y^2 - 1)*({friction}); }}");
    pendulum(&vanishing, "density: exact", Proved);
    pendulum(&vanishing, "density: none", Refuted("a density exists"));
    pendulum(&vanishing, "density = 1", Proved);
    let lasting = format!("forces {{ f: (x^2 + y^2)*({friction}); }}");
    pendulum(&lasting, "density: none", Proved);
    pendulum(&lasting, "density: exact", Refuted("delta = 1"));
}

#[test]
fn forms_are_evaluated_on_vectors_along_the_positions() {
    pendulum("", "symplectic", Proved);
    let area = "d(dot(x))^d(x) + d(dot(y))^d(y)";
    pendulum("", &format!("invariant: (x^2 + y^2)*({area})"), Proved);
    pendulum(
        "",
        &format!("invariant: (1 + x)*({area})"),
        Refuted("rate of the form"),
    );
    let nonholonomic = "coordinates { x; y; z; } lagrangian = (dot(x)^2 + dot(y)^2 + dot(z)^2)/2;
        constraints { surface: z = x^2; blade: dot(y) = z*dot(x); }";
    check(
        nonholonomic,
        "invariant: d(x)^d(dot(x))",
        Undecided("positions that break the position equations"),
    );
}

#[test]
fn functions_are_independent_on_every_component() {
    let lines = format!("{FREE} constraints {{ c: x^2 = 1; }}");
    check(&lines, "integrable: dot(y)", Proved);
    check(
        &lines,
        "integrable: (x - 1)*dot(y)",
        Undecided("every component of the positions"),
    );
    let ball = "coordinates { x; y; z; } lagrangian = (dot(x)^2 + dot(y)^2 + dot(z)^2)/2 - z;
        constraints { ball: x^2 + y^2 + z^2 = 1; }";
    let energy = "(dot(x)^2 + dot(y)^2 + dot(z)^2)/2 + z*(x^2 + y^2 + z^2)";
    check(
        ball,
        &format!("integrable: {energy}, x*dot(y) - y*dot(x)"),
        Proved,
    );
}

#[test]
fn a_symmetry_maps_positions_that_satisfy_the_equations_to_such() {
    let line = "constraints { c: y = 1; }";
    let free = format!("{FREE} {line}");
    check(&free, "symmetry: partial(x)", Proved);
    check(&free, "symmetry: partial(y)", Refuted("left side of c"));
    let bent = format!(
        "coordinates {{ x; y; }} lagrangian = (dot(x)^2 + dot(y)^2)/2 - x^3*(y - 1); {line}"
    );
    check(&bent, "symmetry: partial(x)", Proved);
    let ball = "coordinates { x; y; z; } lagrangian = (dot(x)^2 + dot(y)^2 + dot(z)^2)/2 - z;
        constraints { ball: x^2 + y^2 + z^2 = 1; }";
    check(ball, "symmetry: x*partial(y) - y*partial(x)", Proved);
    check(
        ball,
        "symmetry: y*partial(z) - z*partial(y)",
        Refuted("Euler-Lagrange expression of this rate along the velocity"),
    );
    let heavy = "coordinates { x; y; z; } lagrangian = (dot(x)^2 + (1 + x)*dot(y)^2 + dot(z)^2)/2;
        constraints { ball: x^2 + y^2 + z^2 = 1; }";
    check(
        heavy,
        "symmetry: x*partial(y) - y*partial(x)",
        Refuted("not linear in the velocities"),
    );
    // The rate -y z^3 is 0 where z is.
    let circle = "coordinates { x; y; z; } lagrangian = (dot(x)^2 + dot(y)^2 + dot(z)^2)/2 + x*z^3;
        constraints { circle: x^2 + y^2 = 1; level: z = 0; }";
    check(circle, "symmetry: x*partial(y) - y*partial(x)", Proved);
    let drift = "coordinates { x; y; } lagrangian = (dot(x)^2 + dot(y)^2)/2 + t*dot(x);
        constraints { line: y = 1; }";
    check(drift, "symmetry: partial(x)", Proved);
    check(drift, "symmetry: x*partial(x)", Refuted("not linear"));
}
