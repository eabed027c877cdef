//! Nothing is proved by an accident of evaluation: domains, branches, jumps, rounding, angles, parts of surfaces that are
//! out of sight, models without states. Every claim here is proved because it is true, refused, or undecided.

use dalembert::Described;
use dalembert_codegen::claims::Verdict;
use dalembert_tests::claim::{Declaration, refusal, verdict};

/// What becomes of a claim.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Outcome {
    /// It is true, and proved.
    Proved,
    /// It is false, and refuted with this in the message.
    Refuted(&'static str),
    /// Left open with this as the reason.
    Undecided(&'static str),
    /// Refused before it is looked at, with this message.
    Refused(&'static str),
}

use Outcome::{Proved, Refused, Refuted, Undecided};

#[track_caller]
fn check(declarations: &str, claim: &str, expected: Outcome) {
    let source = format!("Sample {{ {declarations} claims {{ {claim}; }} }}");
    if let Refused(text) = expected {
        let (message, _) = refusal(&source);
        assert!(message.contains(text), "{claim}: {message}");
        return;
    }
    let finding = verdict(&source);
    let matches = match (&finding.verdict, expected) {
        (Verdict::Proved(_), Proved) => true,
        (Verdict::Refuted(witness), Refuted(text)) => witness.to_string().contains(text),
        (Verdict::Undecided(reason), Undecided(text)) => reason.contains(text),
        _ => false,
    };
    assert!(
        matches,
        "{claim}: expected {expected:?}, found {}",
        finding.note()
    );
}

/// A free particle: everything made of velocities is conserved, and nothing else but straight lines.
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
    let hidden = Undecided("values at real points do not confirm");
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
    // What would jump is itself constant, or of one sign.
    free("conserved: atan2(y*dot(x) - x*dot(y), dot(x))", Proved);
    free("conserved: abs(dot(x))/dot(x)", Proved);
    free("conserved: abs(dot(x))/(1 + dot(y)^2)", Proved);
    free("density = 1/abs(dot(x))^3", Proved);
}

#[test]
fn absolute_values_are_those_of_real_numbers() {
    free("conserved: abs(dot(x))", Proved);
    free("conserved: abs(x)", Refuted("d/dt(abs(x)) = 0.5"));
    free("conserved: abs(x) - sqrt(x^2)", Proved);
    // Positive at the first points that are tried, where it is 0 for rounding alone.
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
        Undecided("do not confirm"),
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
    // On a line the same field is a rotation.
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

const LINES: &str = "coordinates { x; y; } lagrangian = (dot(x)^2 + dot(y)^2)/2;";

#[track_caller]
fn at(surface: &str, claim: &str, expected: Outcome) {
    check(
        &format!("{LINES} impacts {{ w: {surface}; }}"),
        claim,
        expected,
    );
}

#[test]
fn every_component_of_a_surface_counts() {
    at("x*y >= 0", "conserved under w: dot(y)", Refuted("y = 0"));
    at("x*y >= 0", "conserved under w: dot(x)", Refuted("x = 0"));
    at("x*y >= 0", "conserved under w: energy", Proved);
    at(
        "x*y >= 0",
        "conserved under w: dot(x)^2",
        Undecided("parts of `w` may be out of sight"),
    );
    at(
        "(x - 1)*(x - 2) >= 0",
        "conserved under w: (x - 2)*dot(x)",
        Refuted("x = 1"),
    );
    at(
        "(x - 1)*(x - 2) >= 0",
        "conserved under w: (x - 1)*dot(x)",
        Refuted("x = 2"),
    );
    at(
        "(x - 1)*(x - 2) >= 0",
        "conserved under w: (x - 1)*(x - 2)*dot(x)",
        Proved,
    );
    at(
        "x^2 - y^2 >= 0",
        "conserved under w: (x - y)*(dot(x) + dot(y))",
        Refuted(" after = "),
    );
    at(
        "x^2 - y^2 >= 0",
        "conserved under w: (x + y)*(dot(x) - dot(y))",
        Refuted(" after = "),
    );
    at(
        "sqrt(x) - y >= 0",
        "conserved under w: 2*y*dot(x) + dot(y)",
        Proved,
    );
    at(
        "sqrt(x) - y >= 0",
        "conserved under w: 2*x*dot(x) + dot(y)",
        Refuted(" after = "),
    );
}

#[test]
fn impacts_happen_where_the_surface_counts() {
    let kinked = "not conserved under w: (abs(y) - y)*dot(x)";
    at("x >= 0", kinked, Proved);
    at("x >= 0 when y > 0", kinked, Undecided("do not confirm"));
    at("x >= 0 when -y > 0", kinked, Proved);
    at("x >= 0 when y > 0", "conserved under w: dot(x)^2", Proved);
    at(
        "x >= 0 when y > 0",
        "conserved under w: dot(x)",
        Refuted("dot(x) after = "),
    );
    at(
        "x >= 0 when y - 1000 > 0",
        "not conserved under w: dot(x)",
        NOWHERE,
    );
    at("x >= -1000", "not conserved under w: dot(x)", Proved);
    // No such place.
    at(
        "2 + sin(x)*cos(y) >= 0",
        "not conserved under w: dot(x)",
        NOWHERE,
    );
    at(
        "2 + sin(x)*cos(y) >= 0",
        "conserved under w: dot(x)",
        NOWHERE,
    );
    // A jump only where the velocity has the sign of one that approaches.
    at(
        "x >= 0",
        "conserved under w: abs(dot(x)) + dot(x)",
        Refuted(" after = "),
    );
    at(
        "x >= 0 => impact_plastic",
        "conserved under w: abs(dot(x)) + dot(x)",
        Undecided("do not confirm"),
    );
}

/// A particle with `dz = f dx`.
fn particle(rest: &str) -> String {
    format!("coordinates {{ x; y; z; }} lagrangian = (dot(x)^2 + dot(y)^2 + dot(z)^2)/2; {rest}")
}

#[test]
fn logarithms_that_are_related_refute_no_density() {
    let related = "ln(x*y) - ln(x) - ln(y)";
    let hidden = Undecided("as these may be related: ln(x*y), ");
    for function in [
        format!("x*({related}) + y"),
        "x*ln(x*y) - x*ln(x) - x*ln(y) + y".to_owned(),
    ] {
        let model = particle(&format!(
            "constraints {{ c: d(z) - ({function})*d(x) = 0; }}"
        ));
        check(&model, "density: exact", hidden);
        check(&model, "density: none", hidden);
    }
    let model = particle(&format!(
        "constraints {{ c: d(z) - ({related})*d(x) = 0; }}"
    ));
    check(&model, "density: exact", Proved);
}

#[test]
fn densities_depend_on_what_roots_and_absolute_values_are_in_real_numbers() {
    let blade = "constraints { c: d(z) - y*d(x) = 0; }";
    let friction = |force: &str| particle(&format!("{blade} forces {{ f: {force}; }}"));
    // Without friction for x > 0: what is so in places only is left open.
    let half = friction("(abs(x) - x)*dot(y)*d(y)");
    for claim in ["density: exact", "density: none"] {
        check(&half, claim, Undecided("as these may be related: abs(x)"));
    }
    check(
        &friction("-sqrt(1 + x^2)*dot(y)*d(y)"),
        "density: none",
        Proved,
    );
    let cubic = friction("-abs(dot(x))*dot(x)*d(x)");
    check(&cubic, "density: none", Undecided(""));
    check(&cubic, "not conserved: energy", Proved);
}

#[test]
fn of_a_model_without_states_nothing_is_proved() {
    let none = Undecided("no real state was found");
    let plane = |lagrangian: &str| format!("coordinates {{ x; y; }} lagrangian = {lagrangian};");
    for lagrangian in [
        "(sqrt(x - 1 - x^2)*dot(x)^2 + dot(y)^2)/2",
        "(dot(x)^2 + dot(y)^2)/2 - sqrt(x - 1 - x^2)",
        "(dot(x)^2 + dot(y)^2)/2 - ln(x - 1 - x^2)",
    ] {
        for claim in [
            "density: exact",
            "density: none",
            "density = 1",
            "conserved: energy",
            "conserved: dot(y)",
            "not conserved: dot(x)",
            "symmetry: partial(y)",
        ] {
            check(&plane(lagrangian), claim, none);
        }
    }
    // Ten units away there are states.
    let far = plane("(dot(x)^2 + dot(y)^2)/2 - sqrt(x - 5)");
    check(&far, "conserved: energy", Proved);
    check(&far, "symmetry: partial(y)", Proved);
    check(&far, "conserved: dot(x)", Refuted("d/dt(dot(x)) = "));
}

#[test]
fn kepler_keeps_what_it_keeps() {
    let kepler = "coordinates { x; y; } parameters { m > 0 = 1; k > 0 = 1; }
        let r = sqrt(x^2 + y^2); let l = m*(x*dot(y) - y*dot(x));
        lagrangian = m/2*(dot(x)^2 + dot(y)^2) + k/r;";
    check(kepler, "conserved: energy", Proved);
    check(kepler, "conserved: l", Proved);
    check(kepler, "conserved: l*dot(y) - k*x/r", Proved);
    check(
        kepler,
        "conserved: l*dot(y) + k*x/r",
        Refuted("d/dt(l*dot(y) + k*x/r) = "),
    );
    check(kepler, "not conserved: l*dot(x) - k*y/r", Proved);
    check(kepler, "symmetry: x*partial(y) - y*partial(x)", Proved);
}

dalembert::model! {
    /// A particle with dry friction, of whose volume nothing is known here: `assume` lets it pass.
    pub Assumed {
        coordinates { x; y; z; }
        parameters { c > 0 = 1/2; }
        lagrangian = (dot(x)^2 + dot(y)^2 + dot(z)^2)/2;
        constraints { slope: d(z) - y*d(x) = 0; }
        forces { dry: -c*abs(dot(y))*dot(y)*d(y); }
        claims {
            assume density: exact;
            assume not conserved: energy;
        }
    }
}

#[test]
fn what_is_assumed_is_said_to_be() {
    let declaration = Declaration::of(Assumed::DESCRIPTION.source);
    let open = declaration.verdict("assume density: exact");
    assert_eq!((open.word(), open.is_accepted()), ("assumed", true));
    let reason =
        "`density: exact` is assumed: a force is no polynomial of degree 2 in the velocities";
    assert!(open.note().starts_with(reason), "{}", open.note());
    let open = declaration.verdict("density: exact");
    assert_eq!((open.word(), open.is_accepted()), ("undecided", false));
    // What can be decided is decided.
    let proved = declaration.verdict("assume not conserved: energy");
    assert_eq!(proved.word(), "proved");
    let refuted = declaration.verdict("assume conserved: energy");
    assert_eq!((refuted.word(), refuted.is_accepted()), ("refuted", false));
}
