//! Claims about motion whose equations jump. Each claim that stays open here is false, or holds by an argument that is not
//! made; each one that is proved is true.

use dalembert_codegen::claims::Verdict;
use dalembert_tests::claim::Outcome::{Proved, Undecided};
use dalembert_tests::claim::{check, verdict};

/// Checks that a claim stays open because its own value, or the equations, may jump at this place.
#[track_caller]
fn open_itself(model: &str, claim: &str, place: &'static str) {
    check(model, claim, Undecided(place));
}

const FREE: &str = "coordinates { x; y; } lagrangian = (dot(x)^2 + dot(y)^2)/2;";

/// Checks that a claim stays open because the equations, or the gap of a surface, may jump at this place.
#[track_caller]
fn open(model: &str, claim: &str, place: &str) {
    stays_open(model, claim, &format!(" may jump {place}"));
}

/// Checks that a claim stays open for a reason that contains this text.
#[track_caller]
fn stays_open(model: &str, claim: &str, reason: &str) {
    let source = format!("M {{ {model} claims {{ {claim}; }} }}");
    match verdict(&source).verdict {
        Verdict::Undecided(text)
            if text.starts_with("it holds where nothing jumps, but ") && text.contains(reason) => {}
        other => panic!("{claim}: {other:?}"),
    }
}

#[test]
fn rates_of_a_first_order_system_that_jump() {
    let turned = "coordinates { x; y; } field { dot(x) = 1; dot(y) = atan2(x, 0); }";
    let cut = "in the cut of `atan2(x, 0)`";
    // From -pi/2 to pi/2 at x = 0.
    open(turned, "conserved: dot(y)", cut);
    open(turned, "density = 3 + dot(y)", cut);
    open(turned, "invariant: d(y)", cut);
    open(turned, "symmetry: partial(x)", cut);
    check(turned, "conserved: x - t", Proved);
    check(turned, "conserved: dot(x)", Proved);
    // Starts at a distance of 0.1 end at a distance of 0.832.
    let rush = "coordinates { x; } field { dot(x) = 2 + atan2(x, 0); }";
    for claim in ["density = 1", "volume: kept", "invariant: d(x)"] {
        open(rush, claim, cut);
    }
    // Every motion reaches 0, and stays.
    let sticky = "coordinates { x; y; } field { dot(x) = -abs(x)/x; dot(y) = y; }";
    for claim in ["density = 1/y", "conserved: abs(x) + t"] {
        open(sticky, claim, "where `x` is 0");
    }
    check(sticky, "conserved: y*exp(-t)", Proved);
    // A relay, whose motion crosses `x = 0` at the rate `y`.
    let relay = "coordinates { x; y; } field { dot(x) = y; dot(y) = -abs(x)/x; }";
    check(relay, "density = 1", Proved);
    check(relay, "volume: kept", Proved);
    open(relay, "invariant: d(x)^d(y)", "where `x` is 0");
    let hidden = "coordinates { x; y; } field { dot(x) = -sqrt(x^2)/x; dot(y) = y; }";
    open(hidden, "density = 1/y", "where `x` is 0");
}

#[test]
fn lagrangians_and_constraints_that_jump() {
    let corner = format!("{FREE} constraints {{ c: dot(y) = (2 + sqrt(x^2)/x)*dot(x); }}");
    for claim in [
        "conserved: dot(x)",
        "conserved: dot(y)",
        "conserved: energy",
    ] {
        open(&corner, claim, "where `x` is 0");
    }
    let cut = "in the cut of `atan2(x, 0)`";
    let turned = format!("{FREE} constraints {{ c: dot(y) = (2 + atan2(x, 0))*dot(x); }}");
    for claim in ["volume: kept", "density: exact", "symplectic"] {
        open(&turned, claim, cut);
    }
    let affine = format!("{FREE} constraints {{ c: dot(y) = atan2(t - 1, 0); }}");
    open(
        &affine,
        "conserved: dot(y)",
        "in the cut of `atan2(t - 1, 0)`",
    );
    let position = format!("{FREE} constraints {{ c: y = atan2(x, 0); }}");
    open(&position, "conserved: y", cut);
    let hidden = format!("{FREE} constraints {{ c: x*dot(y) = sqrt(x^2)*dot(x); }}");
    open(
        &hidden,
        "conserved: dot(y)",
        "where the constraints are not independent",
    );

    let magnetic =
        "coordinates { x; y; } lagrangian = (dot(x)^2 + dot(y)^2)/2 + atan2(x, 0)*dot(y);";
    open(magnetic, "conserved: dot(y)", cut);
    open(magnetic, "integrable: dot(x), dot(y)", cut);
    check(magnetic, "symmetry: partial(y)", Proved);
    let mass = "coordinates { x; } lagrangian = (2 + sqrt(x^2)/x)/2*dot(x)^2;";
    for claim in [
        "conserved: dot(x)",
        "symplectic",
        "density: exact",
        "volume: kept",
    ] {
        open(mass, claim, "where `x` is 0");
    }
}

#[test]
fn forces_that_jump() {
    let cut = "in the cut of `atan2(x, 0)`";
    let kick = format!("{FREE} forces {{ f: atan2(x, 0)*d(y); }}");
    open(&kick, "invariant: d(dot(y))", cut);
    open(&kick, "symplectic", cut);
    // The velocity dot(x) is the same on both sides.
    check(&kick, "density = 1", Proved);
    check(&kick, "conserved: dot(x)", Proved);
    // The density on both sides is exp(-y) and exp(y).
    let drag = format!("{FREE} forces {{ f: abs(x)/x*dot(y)^2/2*d(y); }}");
    open(&drag, "density: exact", "where `x` is 0");

    let stick = format!("{FREE} forces {{ f: -abs(dot(x))/dot(x)*d(x); }}");
    for claim in ["density = 1", "symplectic", "conserved: abs(dot(x)) + t"] {
        open(&stick, claim, "where `dot(x)` is 0");
    }
    check(&stick, "conserved: dot(y)", Proved);
    let switched = format!("{FREE} forces {{ f: abs(sin(t))/sin(t)*x*d(x); }}");
    for claim in [
        "density = 1",
        "symplectic",
        "volume: kept",
        "invariant: d(dot(y))",
    ] {
        check(&switched, claim, Proved);
    }
}

#[test]
fn potentials_with_kinks() {
    let wedge = "coordinates { x; } lagrangian = dot(x)^2/2 - sqrt(x^2);";
    for claim in [
        "symplectic",
        "density = 1",
        "volume: kept",
        "conserved: energy",
    ] {
        check(wedge, claim, Proved);
    }
    open(wedge, "invariant: d(dot(x))", "where `x^2` is 0");
}

#[test]
fn functions_of_infinite_arguments() {
    let potential = "coordinates { x; y; } lagrangian = (dot(x)^2 + dot(y)^2)/2 - tanh(1/x);";
    open_itself(potential, "conserved: energy", "where `x` is 0");
    let constraint = format!("{FREE} constraints {{ c: dot(y) = (2 + tanh(1/x))*dot(x); }}");
    let metric = "coordinates { x; y; } lagrangian = (2 + tanh(1/x))*dot(x)^2/2 + dot(y)^2/2;";
    for claim in ["symplectic", "density: exact", "volume: kept"] {
        open(&constraint, claim, "where `x` is 0");
        open(metric, claim, "where `x` is 0");
    }
    let magnetic = "coordinates { x; y; } lagrangian = (dot(x)^2 + dot(y)^2)/2 + tanh(1/x)*dot(y);";
    for claim in ["conserved: dot(x)^2 + dot(y)^2", "symplectic"] {
        open(magnetic, claim, "where `x` is 0");
    }
    // The divergences of both forces cancel, and that of `f` jumps at `dot(x) = 0`.
    let drag = format!(
        "{FREE} forces {{ f: -(2 + tanh(1/dot(x)))*d(x); g: -dot(y)/dot(x)^2*(1 - tanh(1/dot(x))^2)*d(y); }}"
    );
    open(&drag, "density = 1", "where `dot(x)` is 0");
    let rates =
        "coordinates { x; y; } field { dot(x) = 2 + tanh(1/x); dot(y) = y*(1 - tanh(1/x)^2)/x^2; }";
    for claim in ["volume: kept", "density = 1", "invariant: d(x)^d(y)"] {
        open(rates, claim, "where `x` is 0");
    }
    open_itself(rates, "conserved: y*(2 + tanh(1/x))", "where `x` is 0");
    // Constant denominators, and arguments that are infinite nowhere, are harmless.
    let smooth = "coordinates { x; y; } parameters { l; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2 - tanh(x/l) - exp(1/(1 + x^2));";
    for claim in [
        "conserved: energy",
        "conserved: dot(y)",
        "symplectic",
        "density: exact",
    ] {
        check(smooth, claim, Proved);
    }
}

#[test]
fn symmetries_that_lead_across_a_jump() {
    let mass = "coordinates { x; y; } lagrangian = (2 + sqrt(x^2)/x)*dot(x)^2/2 + dot(y)^2/2;";
    open(mass, "symmetry: partial(x)", "where `x` is 0");
    check(mass, "symmetry: partial(y)", Proved);
    let step = "coordinates { x; y; } lagrangian = (dot(x)^2 + dot(y)^2)/2 - atan2(x, 0);";
    open(step, "symmetry: partial(x)", "in the cut of `atan2(x, 0)`");
    check(step, "symmetry: partial(y)", Proved);
    let wall = format!("{FREE} impacts {{ w: x >= sqrt(y^2)/y; }}");
    open(&wall, "symmetry: partial(y)", "where `y` is 0");
    let ring = format!("{FREE} impacts {{ w: sqrt(x^2 + y^2) >= 1; }}");
    check(&ring, "symmetry: x*partial(y) - y*partial(x)", Proved);
}

/// On both sides of a kink the Lagrangian gains the derivative of a function, and both functions do not fit.
#[test]
fn symmetries_that_lead_across_a_kink() {
    let with = |potential: &str| {
        let kinetic = "(dot(x)^2 + dot(y)^2)/2";
        format!("coordinates {{ x; y; }} lagrangian = {kinetic} - {potential};")
    };
    // No force at x < 0, a constant one at x > 0.
    let ramp = with("(sqrt(x^2) + x)/2");
    for claim in ["symmetry: partial(x)", "symmetry: t*partial(x)"] {
        open(&ramp, claim, "where `x^2` is 0");
    }
    check(&ramp, "symmetry: partial(y)", Proved);
    open(
        &with("exp(ln(x^2)/2)"),
        "symmetry: partial(x)",
        "where `x` is 0",
    );
    let wave = "coordinates { phi: angle; } lagrangian = dot(phi)^2/2 - acos(cos(phi));";
    open(
        wave,
        "symmetry: partial(phi)",
        "where `1 - cos(phi)^2` is 0",
    );
    let cone = with("sqrt((x - y)^2)");
    open(&cone, "symmetry: partial(x)", "where `(x - y)^2` is 0");
    check(&cone, "symmetry: partial(x) + partial(y)", Proved);
    let well = with("sqrt(x^2 + y^2)");
    check(&well, "symmetry: x*partial(y) - y*partial(x)", Proved);
    let magnetic = with("sqrt(x^2)*dot(y)");
    open(&magnetic, "symmetry: partial(x)", "where `x^2` is 0");
    check(&with("9*x"), "symmetry: partial(x)", Proved);

    // The flow gives a velocity that jumps at t = 0.
    open(FREE, "symmetry: abs(t)*partial(x)", "where `abs(t)` is 0");
    check(FREE, "symmetry: t*partial(x)", Proved);
}

/// A density exists before and after the jump. It is continuous along motions, and cannot change at all places at once.
#[test]
fn volumes_whose_growth_jumps_at_a_time() {
    let drag =
        |wave: &str| format!("{FREE} forces {{ f: {wave}*dot(y)*(dot(x)*d(x) + dot(y)*d(y)); }}");
    for claim in ["density: exact", "volume: kept"] {
        open(&drag("abs(t)/t"), claim, "where `t` is 0");
    }
    open(
        &drag("sqrt(sin(t)^2)/sin(t)"),
        "density: exact",
        "where `sin(t)` is 0",
    );
    for claim in ["density: none", "density: locally_exact"] {
        open(&drag("abs(x)/x"), claim, "where `x` is 0");
    }
    check(&drag("1"), "density: exact", Proved);
    let pushed = format!("{FREE} forces {{ f: abs(t)/t*d(y); }}");
    for claim in ["density: exact", "volume: kept", "symplectic"] {
        check(&pushed, claim, Proved);
    }
    let turning = "coordinates { x; y; } field { dot(x) = abs(t)/t*y; dot(y) = -x; }";
    check(turning, "volume: kept", Proved);
}

#[test]
fn surfaces_that_jump() {
    let wall = format!("{FREE} impacts {{ w: x >= sqrt(y^2)/y; }}");
    for claim in [
        "symplectic",
        "volume: kept",
        "conserved under w: dot(y)",
        "energy under w: not increasing",
    ] {
        open(&wall, claim, "where `y` is 0");
    }
    let moving = format!("{FREE} impacts {{ w: x <= 1 + sqrt(t^2)/t/4; }}");
    open(&moving, "volume: kept", "where `t` is 0");
}

#[test]
fn singular_points_that_almost_all_motions_avoid() {
    // Two bodies that turn around each other attract a third; the sign of `k` is not known.
    let three = "coordinates { x; y; } parameters { k = 1; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2 + k/sqrt((x - cos(t))^2 + (y - sin(t))^2) + 1/sqrt((x + cos(t))^2 + (y + sin(t))^2);";
    for claim in ["symplectic", "volume: kept", "density: exact"] {
        check(three, claim, Proved);
    }
    let kepler = "coordinates { x; y; } parameters { k = 1; } lagrangian = (dot(x)^2 + dot(y)^2)/2 + k/sqrt(x^2 + y^2);";
    check(kepler, "conserved: x*dot(y) - y*dot(x)", Proved);
    let spring =
        "coordinates { x; y; } lagrangian = (dot(x)^2 + dot(y)^2)/2 - (sqrt(x^2 + y^2) - 1)^2;";
    check(spring, "symplectic", Proved);
    check(spring, "invariant: d(dot(x))^d(x) + d(dot(y))^d(y)", Proved);
}

#[test]
fn lengths_that_constraints_keep() {
    for model in [
        format!("{FREE} constraints {{ rod: sqrt(x^2 + y^2) = 2; }}"),
        "coordinates { a; b; c; e; } parameters { l > 0 = 1; }
            lagrangian = (dot(a)^2 + dot(b)^2 + dot(c)^2 + dot(e)^2)/2;
            constraints { rod: sqrt((a - c)^2 + (b - e)^2) = l; }"
            .to_owned(),
    ] {
        for claim in ["conserved: energy", "symplectic", "volume: kept"] {
            check(&model, claim, Proved);
        }
    }
}

#[test]
fn where_motions_come_together_an_infinite_density_is_not_claimed() {
    let rate =
        |rate: &str| format!("coordinates {{ x; y; }} field {{ dot(x) = {rate}; dot(y) = 1; }}");
    let force = |force: &str| format!("{FREE} forces {{ f: {force}*d(x); }}");
    let center = "coordinates { x; y; } field { dot(x) = -x/(x^2 + y^2)^(1/4); dot(y) = -y/(x^2 + y^2)^(1/4); }";
    // All motions reach `x = 0` in finite time and stay there, or start there at different times.
    for (model, claim, place) in [
        (
            rate("-sqrt(abs(x) + x)"),
            "density = 1/sqrt(abs(x))",
            "abs(x)",
        ),
        (rate("sqrt(abs(x))"), "density = 1/sqrt(abs(x))", "abs(x)"),
        (rate("-sqrt(x)"), "density = 1/sqrt(x)", "x"),
        (rate("-sqrt(x)"), "invariant: d(x)/sqrt(x)", "x"),
        (rate("-sqrt(x)"), "invariant: d(x)^d(y)/sqrt(x)", "x"),
        (
            center.to_owned(),
            "density = (x^2 + y^2)^(-3/4)",
            "x^2 + y^2",
        ),
        (
            force("-sqrt(abs(dot(x)) + dot(x))"),
            "density = abs(dot(x))^(-1/2)",
            "abs(dot(x))",
        ),
        (force("-dot(x)^(1/3)"), "density = dot(x)^(-1/3)", "dot(x)"),
    ] {
        let reason = format!("motions may reach states where `{place}` is 0 and stay there");
        stays_open(&model, claim, &reason);
    }
    // The differential of a root is infinite.
    for (claim, place) in [
        ("invariant: d(sqrt(x))", "x"),
        ("invariant: d(sqrt(x))^d(y)", "x"),
    ] {
        let reason = format!("motions may reach states where `{place}` is 0 and stay there");
        stays_open(&rate("-sqrt(x)"), claim, &reason);
    }
    check(&rate("-sqrt(x)"), "invariant: d(y)", Proved);
    // No motion reaches `x = 0`, and the divergence is finite, or the density is.
    check(&rate("x"), "density = 1/x", Proved);
    check(&rate("-x^3"), "density = 1/x^3", Proved);
    check(&rate("-x"), "invariant: d(x)^d(y)/x", Proved);
    let turning =
        "coordinates { x; y; } field { dot(x) = -y/(x^2 + y^2); dot(y) = x/(x^2 + y^2); }";
    check(turning, "density = 1/(x^2 + y^2)", Proved);
}

/// A root gives a velocity, and motions reach its zero and stay there, where the rate of the root does not exist.
#[test]
fn claims_about_velocities_that_a_root_gives_stay_open() {
    let planar = |constraint: &str| {
        format!(
            "coordinates {{ x; y; }} lagrangian = (dot(x)^2 + dot(y)^2)/2; constraints {{ c: {constraint}; }}"
        )
    };
    let along = planar("dot(y) = -2*sqrt(y)*dot(x)");
    let turning = planar("dot(y) = sqrt(1 - y^2)*dot(x)");
    let falling = planar("dot(x) = -sqrt(x)");
    let field = "coordinates { x; y; } field { dot(y) = -2*sqrt(y); dot(x) = 1; }".to_owned();
    let sine = "y*cos(x) - dot(y)/dot(x)*sin(x)";
    for (model, claim, place) in [
        (&along, "conserved: dot(y)/dot(x) - 2*x".to_owned(), "y"),
        (&along, "integrable: dot(y)/dot(x) - 2*x".to_owned(), "y"),
        (&turning, format!("conserved: {sine}"), "1 - y^2"),
        (&turning, format!("not conserved: {sine}"), "1 - y^2"),
        (&falling, "conserved: dot(x) - t/2".to_owned(), "x"),
        (&falling, "conserved: momentum(x) - t/2".to_owned(), "x"),
        (&falling, "invariant: d(dot(x))".to_owned(), "x"),
        (&field, "conserved: dot(y) - 2*x".to_owned(), "y"),
    ] {
        let reason = format!("motions may reach states where `{place}` is 0 and stay there");
        stays_open(model, &claim, &reason);
    }
    // Velocities that no root gives, the energy, and roots of what is never 0.
    check(&falling, "conserved: dot(y)", Proved);
    check(&along, "conserved: energy", Proved);
    check(&field, "conserved: dot(x)", Proved);
    let away = planar("dot(y) = -2*sqrt(1 + y^2)*dot(x)");
    check(&away, "conserved: dot(y) + 2*sqrt(1 + y^2)*dot(x)", Proved);
}
