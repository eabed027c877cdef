//! Claims that a careless evaluation would prove or refute wrongly: domains, branches, jumps, rounding, angles,
//! parameters with special defaults. Every claim that is proved here is true.

use dalembert_codegen::claims::Verdict;
use dalembert_tests::claim::Outcome::{Proved, Refused, Refuted, Undecided};
use dalembert_tests::claim::{Outcome, check, verdict};

/// A free particle. Functions of the velocities are conserved, and so are moments such as `x*dot(y) - y*dot(x)`.
const FREE: &str = "coordinates { x; y; theta: angle; } parameters { m > 0 = 1; k > 0 = 2; z = 0; }
    lagrangian = m/2*(dot(x)^2 + dot(y)^2 + dot(theta)^2);";

#[track_caller]
fn free(claim: &str, expected: Outcome) {
    check(FREE, claim, expected);
}

const NOWHERE: Outcome = Undecided("it has no value at any of the real points");

#[test]
fn what_has_no_real_value_is_not_conserved_by_default() {
    for claim in [
        "conserved: sqrt(dot(x) - dot(x)^2 - 1)",
        "conserved: sqrt(x - x^2 - 1 - k*dot(x)^2)",
        "not conserved: sqrt(x - x^2 - 1)",
        "conserved: dot(x) + 0*sqrt(x - 1 - y^2 - x^2)",
        "conserved: dot(x) + sqrt(x - 1 - x^2) - sqrt(x - 1 - x^2)",
        "conserved: ln(dot(x) - 1 - dot(x)^2)",
        "conserved: asin(2 + dot(x)^2)",
        "conserved: asin(2 + x^2) + acos(2 + x^2)",
        "density = sqrt(dot(x) - 1 - dot(x)^2)",
        "density = sqrt(dot(x) - 1 - dot(x)^2)^2",
        "density = ln(dot(x) - 1 - dot(x)^2)",
    ] {
        free(claim, NOWHERE);
    }
    free(
        "conserved: sqrt(-1 - energy^2)",
        Refused("`sqrt(-1 - energy^2)` is not a real number"),
    );
    free(
        "conserved: ln(-1 - dot(x)^2)",
        Refused("`ln(-1 - dot(x)^2)` is not a real number"),
    );
    free(
        "conserved: 1/(dot(x) - dot(x))",
        Refused("division by zero"),
    );
    let hidden = Undecided("at none of the points that were tried");
    free("conserved: 1/(cos(x)^2 + sin(x)^2 - 1)", hidden);
    free("not conserved: 1/(cos(x)^2 + sin(x)^2 - 1)", hidden);
}

#[test]
fn what_is_real_in_places_is_decided_there() {
    free("conserved: sqrt(dot(x))", Proved);
    free(
        "conserved: ln(dot(x)*dot(y)) - ln(dot(x)) - ln(dot(y))",
        Proved,
    );
    free("conserved: asin(dot(x)/9) + sqrt(1 + dot(y)^2)", Proved);
    free("conserved: sqrt(x)*sqrt(x) - x", Proved);
    free("conserved: sqrt(x)", Refuted("d/dt(sqrt(x)) = "));
    free("not conserved: ln(x)", Proved);
}

#[test]
fn a_rate_of_zero_does_not_hide_a_jump() {
    for (claim, place) in [
        ("conserved: abs(x)/x", "where `x` is 0"),
        ("conserved: sqrt(x^2)/x", "where `x` is 0"),
        ("conserved: dot(y) + x/abs(x)", "where `abs(x)` is 0"),
        ("conserved: atan(x) + atan(1/x)", "where `x` is 0"),
        (
            "conserved: x - atan2(sin(x), cos(x))",
            "in the cut of `atan2(sin(x), cos(x))`",
        ),
        (
            "conserved: dot(x) + x - atan2(sin(x), cos(x))",
            "in the cut of",
        ),
        (
            "conserved: x - 2*atan(tan(x/2))",
            "at the poles of `tan(x/2)`",
        ),
        ("conserved: exp(ln(x^2)/2)/x", "where `x^2` is 0"),
        ("density = 2 + abs(x)/x", "where `x` is 0"),
        ("density = x - atan2(sin(x), cos(x))", "in the cut of"),
        ("symmetry: abs(x)/x*partial(x)", "where `x` is 0"),
        (
            "symmetry: atan2(sin(x), cos(x))*partial(y) - x*partial(y)",
            "in the cut of",
        ),
    ] {
        free(claim, Undecided(place));
    }
    // Here the argument of the function that jumps is itself constant.
    free("conserved: atan2(y*dot(x) - x*dot(y), dot(x))", Proved);
    free("conserved: abs(dot(x))/dot(x)", Proved);
    free("conserved: abs(dot(x))/(1 + dot(y)^2)", Proved);
    free("density = 1/abs(dot(x))^3", Proved);
}

/// The motion passes `x = 0`, where the equations have a limit or are bounded.
#[test]
fn a_denominator_of_the_equations_hides_no_jump() {
    const AT_ZERO: Outcome = Undecided("it may jump where `x` is 0");
    let plane = |rest: &str| format!("coordinates {{ x; y; }} {rest}");
    let of_potential =
        |term: &str| plane(&format!("lagrangian = (dot(x)^2 + dot(y)^2)/2 + {term};"));
    let of_field = |rate: &str| plane(&format!("field {{ dot(x) = 1; dot(y) = {rate}; }}"));
    for declared in [
        of_potential("sin(x)/x"),
        of_potential("x^2/x"),
        of_potential("x/sqrt(x^2)*y"),
        plane("lagrangian = (dot(x)^2 + dot(y)^2)/2; forces { f: sin(x)/x*d(y); }"),
    ] {
        check(&declared, "conserved: dot(x) - dot(x) + abs(x)/x", AT_ZERO);
    }
    check(
        &of_potential("sin(x)/x"),
        "conserved: energy*abs(x)/x",
        AT_ZERO,
    );
    // The terms are total derivatives: the motion is free. The potential contains `0/x`, the equations `0/sqrt(x)`.
    for term in ["dot(x)/x", "dot(x)/x^2", "dot(x)*sqrt(x)", "dot(x)/sqrt(x)"] {
        for claim in ["abs(x)/x", "energy*abs(x)/x"] {
            let free = "frame { u: dot(x); v: dot(y); }";
            check(
                &format!("{} {free}", of_potential(term)),
                &format!("conserved: {claim}"),
                AT_ZERO,
            );
        }
    }
    // What cancels does not end the motion.
    for rate in [
        "1 + sqrt(x) - sqrt(x)",
        "exp(ln(x) - ln(x))",
        "cos(0*ln(x))",
        "1 + ln(1 + 0*sqrt(x))",
        "sqrt(x)^0",
    ] {
        let declared = format!("coordinates {{ x; }} field {{ dot(x) = {rate}; }}");
        check(&declared, "conserved: abs(x)/x", AT_ZERO);
    }
    for rate in ["(1 - cos(x))/x^2", "sin(x)/x", "abs(x)/x"] {
        check(&of_field(rate), "conserved: abs(x)/x", AT_ZERO);
        check(
            &of_field(rate),
            "invariant: (2 + abs(x)/x)*d(x)^d(y)",
            AT_ZERO,
        );
        let density = Undecided("may jump where `x` is 0");
        check(&of_field(rate), "density = 2 + abs(x)/x", density);
    }
    check(
        &of_field("x/abs(x)"),
        "conserved: x/abs(x)",
        Undecided("where `abs(x)` is 0"),
    );
    check(
        &of_potential("tan(x)*cos(x)"),
        "conserved: atan(tan(x)) - x",
        Undecided("at the poles of `tan(x)`"),
    );
    // The constraint leads every motion through the origin.
    check(
        &plane("lagrangian = (dot(x)^2 + dot(y)^2)/2; constraints { c: x*dot(y) = y*dot(x); }"),
        "conserved: x/sqrt(x^2 + y^2)",
        Undecided("where `x^2 + y^2` is 0"),
    );
    // All motions are straight lines through the origin, at which these equations have no limit.
    check(
        &plane("field { dot(x) = x^2/(x^2 + y^2); dot(y) = x*y/(x^2 + y^2); }"),
        "conserved: x/sqrt(x^2 + y^2)",
        Undecided("where `x^2 + y^2` is 0"),
    );
    check(
        &plane("field { dot(x) = x/t; dot(y) = y/t; }"),
        "conserved: x/sqrt(x^2 + y^2)",
        Undecided("where `x^2 + y^2` is 0"),
    );
}

/// No run has a state at which the metric is not positive definite, or a coefficient of a law lies outside [0, 1].
#[test]
fn states_that_no_run_has_decide_nothing() {
    const OPEN: Outcome = Undecided("");
    let plane = |kinetic: &str, rest: &str| {
        format!(
            "coordinates {{ x; y; }} parameters {{ k = 1; c in [0, 1] = 1/2; }}
            lagrangian = ({kinetic})/2; {rest}"
        )
    };
    let half = plane("x*dot(x)^2 + dot(y)^2", "");
    check(&half, "not conserved: (abs(x) - x)*y", OPEN);
    check(&half, "conserved: (abs(x) - x)*y", OPEN);
    check(&half, "not conserved: (2*abs(x) - x)*y", Proved);
    let strip = plane("dot(x)^2 + 2*x*dot(x)*dot(y) + dot(y)^2", "");
    check(&strip, "conserved: (abs(1 - x) - 1 + x)*y", OPEN);
    check(
        &strip,
        "conserved: (abs(1/2 - x) - 1/2 + x)*y",
        Refuted("d/dt"),
    );
    let scaled = plane("k*(dot(x)^2 + dot(y)^2)", "");
    check(&scaled, "conserved: (abs(k) - k)*y", OPEN);
    check(&scaled, "density = 1 + (abs(k) - k)*x^2", OPEN);
    let hit = |law: &str| {
        plane(
            "k*(dot(x)^2 + dot(y)^2)",
            &format!("impacts {{ w: x >= 0 => {law}; }}"),
        )
    };
    let energy = "energy under w: not increasing";
    check(&hit("reset { dot(x) = -c*dot(x); }"), energy, OPEN);
    let grows = Refuted("the energy grows");
    check(&hit("reset { dot(x) = -(1 + c)*dot(x); }"), energy, grows);
    let newton = plane("dot(x)^2 + dot(y)^2", "impacts { w: x >= 0 => newton(k); }");
    for quantity in ["(abs(k) - k)*dot(x)", "(abs(1 - k) - 1 + k)*dot(x)"] {
        check(&newton, &format!("not conserved under w: {quantity}"), OPEN);
        check(&newton, &format!("conserved: {quantity}*x"), OPEN);
    }
    check(&newton, "not conserved under w: dot(x)", Proved);
}

/// States with other coefficients are refused.
#[test]
fn coefficients_of_laws_lie_between_0_and_1() {
    for law in [
        "newton(k)",
        "restitution(k)",
        "newton(1 - k)",
        "newton(k*(2 - k))",
        "restitution(sqrt(k))",
    ] {
        let plane = format!(
            "coordinates {{ x; y; }} parameters {{ k = 1/2; }} lagrangian = (dot(x)^2 + dot(y)^2)/2;
             impacts {{ w: x >= 0 => {law}; }}"
        );
        check(&plane, "energy under w: not increasing", Proved);
    }
    let moving =
        "coordinates { x; } lagrangian = dot(x)^2/2; impacts { w: x >= t => newton(1/2); }";
    check(
        moving,
        "energy under w: not increasing",
        Refuted("the energy grows"),
    );
}

/// `y = 0` is a motion, along which the root has no rate.
#[test]
fn where_a_root_has_no_rate_it_may_change() {
    let field =
        |rate: &str| format!("coordinates {{ x; y; }} field {{ dot(x) = 1; dot(y) = {rate}; }}");
    let stays = Undecided("where `y` is 0");
    check(&field("2*x*sqrt(y)"), "conserved: sqrt(y) - x^2/2", stays);
    check(&field("sqrt(y)"), "conserved: x - 2*sqrt(y)", stays);
    check(&field("2*y"), "conserved: exp(-x)*sqrt(y)", Proved);
}

#[test]
fn denominators_that_no_motion_passes_are_harmless() {
    let plane = "coordinates { x; y; } lagrangian = (dot(x)^2 + dot(y)^2)/2;";
    check(plane, "conserved: sqrt((x^2 + y^2)^2)/(x^2 + y^2)", Proved);
    let bodies = "coordinates { x1; y1; x2; y2; } parameters { k > 0 = 1; }
        let r = sqrt((x1 - x2)^2 + (y1 - y2)^2);
        let l = (x1 - x2)*dot(y1 - y2) - (y1 - y2)*dot(x1 - x2);
        lagrangian = (dot(x1)^2 + dot(y1)^2 + dot(x2)^2 + dot(y2)^2)/2 + k/r;";
    check(
        bodies,
        "conserved: l*dot(y1 - y2) - 2*k*(x1 - x2)/r",
        Proved,
    );
    check(bodies, "conserved: energy*abs(r)/r", Proved);
    let root = "coordinates { x; y; } field { dot(x) = 1; dot(y) = -sqrt(y); }";
    check(root, "conserved: abs(y)/y", Proved);
    // A root has no value between -1/10 and 1/10, and the quotient differs on both sides.
    check(
        "coordinates { x; y; } field { dot(x) = 1; dot(y) = 0; }",
        "conserved: x*abs(x)/(1/100 + sqrt(x^2 - 1/100)^2)",
        Undecided("it may jump"),
    );
}

#[test]
fn absolute_values_are_those_of_real_numbers() {
    free("conserved: abs(dot(x))", Proved);
    free("conserved: abs(x)", Refuted("d/dt(abs(x)) = 0.5"));
    free("conserved: abs(x) - sqrt(x^2)", Proved);
    // `x` is positive at the first sample points, where the quantity is 0 up to rounding.
    free(
        "conserved: abs(x) - x",
        Refuted("d/dt(abs(x) - x) = 3\nat x = -0.28"),
    );
    free("not conserved: abs(x) - x", Proved);
    for identity in [
        "abs(x)^2 - x^2",
        "abs(x*y) - abs(x)*abs(y)",
        "abs(x)*x - abs(x^3)/x",
    ] {
        let source = format!("Sample {{ {FREE} claims {{ not conserved: {identity}; }} }}");
        let found = verdict(&source).verdict;
        assert!(
            !matches!(found, Verdict::Proved(_)),
            "{identity}: {found:?}"
        );
    }
}

#[test]
fn rounding_is_no_witness() {
    for claim in [
        "not conserved: exp(ln(x)) - x",
        "not conserved: exp(ln(x)) - x + dot(y)",
        "not conserved: x*ln(x*y) - x*ln(x) - x*ln(y)",
        "not conserved: (1000000*x + 1)^2 - 1000000000000*x^2 - 2000000*x + dot(x)",
    ] {
        let source = format!("Sample {{ {FREE} claims {{ {claim}; }} }}");
        let found = verdict(&source).verdict;
        assert!(!matches!(found, Verdict::Proved(_)), "{claim}: {found:?}");
    }
}

#[test]
fn constants_are_conserved_and_change_for_nobody() {
    for constant in [
        "1",
        "0",
        "k",
        "0*x",
        "x - x",
        "cos(theta)^2 + sin(theta)^2",
        "exp(x)*exp(-x)",
    ] {
        free(&format!("conserved: {constant}"), Proved);
        free(&format!("not conserved: {constant}"), Refuted("is 0"));
    }
    free("density = 1", Proved);
    free("density = k", Proved);
    free("density = 0", Refused("`0` is not positive anywhere"));
    free("density = -1", Refused("`-1` is not positive anywhere"));
    free("density = -k", Refused("is not positive anywhere"));
    free("density = 2*x - x - x", Refused("is not positive anywhere"));
    free(
        "density = cos(x)^2 + sin(x)^2 - 1",
        Undecided("at none of the points that were tried"),
    );
    free(
        "symmetry: 0*partial(x)",
        Refused("`0*partial(x)` is not a vector field"),
    );
}

#[test]
fn angles_are_not_taken_for_numbers() {
    for claim in [
        "conserved: x*dot(theta) - theta*dot(x)",
        "conserved: theta",
        "not conserved: theta",
        "density = exp(theta*dot(x) - x*dot(theta))",
        "symmetry: theta*partial(x) - x*partial(theta)",
        "conserved: sin(theta/2)^3",
    ] {
        free(claim, Refused("`theta` is an angle"));
    }
    free(
        "conserved: sin(theta)^2 + cos(theta)^2 + dot(theta)",
        Proved,
    );
    // If theta is a coordinate on a line, the same field is a rotation.
    let line = FREE.replace("theta: angle", "theta");
    check(
        &line,
        "symmetry: theta*partial(x) - x*partial(theta)",
        Proved,
    );
    check(&line, "conserved: x*dot(theta) - theta*dot(x)", Proved);
}

#[test]
fn parameters_are_not_their_defaults() {
    free("conserved: dot(x) + z*x", Refuted("z = 0.58"));
    free(
        "conserved: (k - 2)*x + dot(x)",
        Refuted("d/dt((k - 2)*x + dot(x)) = "),
    );
    free("not conserved: (k - 2)*x + dot(x)", Proved);
    let fixed = FREE.replace("z = 0", "z in [0, 0] = 0");
    check(
        &fixed,
        "not conserved: dot(x) + z*x",
        Refused("the interval from `0` to `0` has one point"),
    );
}
