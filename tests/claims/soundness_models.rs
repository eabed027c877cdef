//! Claims about surfaces, densities and whole models that invite invalid proofs: hidden parts of surfaces, relations
//! between logarithms, absolute values, models without states. See also `soundness.rs`.

use dalembert::Described;
use dalembert_tests::claim::Outcome::{Proved, Refuted, Undecided};
use dalembert_tests::claim::{Declaration, Outcome, check};

const NOWHERE: Outcome = Undecided("it has no value at any of the real points");

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
        Undecided("parts of `w` may be missed"),
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
    // This surface has no points.
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
    // Before an impact the gap rate is negative.
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
    // There is no friction for x > 0: a density exists there, and none elsewhere.
    let half = friction("(abs(x) - x)*dot(y)*d(y)");
    check(&half, "density: exact", Refuted("at x = -"));
    check(&half, "density: locally_exact", Refuted("at x = -"));
    check(
        &half,
        "density: none",
        Undecided("near some configurations"),
    );
    check(
        &friction("-sqrt(1 + x^2)*dot(y)*d(y)"),
        "density: none",
        Proved,
    );
    let cubic = friction("-abs(dot(x))*dot(x)*d(x)");
    check(&cubic, "density: none", Proved);
    check(&cubic, "not conserved: energy", Proved);
}

#[test]
fn of_a_model_without_states_nothing_is_proved() {
    let none = Undecided("at none of the real states");
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
    // There are states for x >= 5.
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
    /// A particle in a vortex. Its density grows along loops around the axis, which the generator does not examine;
    /// `assume` accepts the claim.
    pub Assumed {
        coordinates { x; y; z; }
        parameters { c > 0 = 1/2; }
        lagrangian = (dot(x)^2 + dot(y)^2 + dot(z)^2)/2;
        forces { vortex: -c*dot(z)*(x*dot(y) - y*dot(x))/(x^2 + y^2)*d(z); }
        claims {
            assume density: exact;
            assume not conserved: energy;
        }
    }
}

#[test]
fn what_is_assumed_is_said_to_be() {
    let declaration = Declaration::of(Assumed::DESCRIPTION.source.value());
    let open = declaration.verdict("assume density: exact");
    assert_eq!((open.word(), open.is_accepted()), ("assumed", true));
    let reason = "`density: exact` is assumed: a density exists locally; on all of Q, G was found in no closed form";
    assert!(open.note().starts_with(reason), "{}", open.note());
    let open = declaration.verdict("density: exact");
    assert_eq!((open.word(), open.is_accepted()), ("undecided", false));
    // Decidable claims are decided.
    let proved = declaration.verdict("assume not conserved: energy");
    assert_eq!(proved.word(), "proved");
    let refuted = declaration.verdict("assume conserved: energy");
    assert_eq!((refuted.word(), refuted.is_accepted()), ("refuted", false));
}

/// On the surface these values are 0 up to the rounding errors of the position.
#[test]
fn the_rounding_of_a_position_on_a_surface_is_no_witness() {
    let declaration = |claim: &str| {
        format!(
            "Sector {{ coordinates {{ th: angle; y; }} lagrangian = (dot(th)^2 + dot(y)^2)/2;
                impacts {{ s: sin(th) >= 0; c: cos(th) >= 0; }} claims {{ {claim}; }} }}"
        )
    };
    for (surface, value) in [
        ("s", "sin(th)*dot(th)"),
        ("s", "sin(2*th)*dot(th)"),
        ("c", "cos(th)*dot(th)"),
        ("c", "cos(th)*dot(y)*dot(th)"),
    ] {
        let message = |claim: String| {
            let tokens = declaration(&claim).parse().expect("tokens");
            let refused = dalembert_emit::try_expand(tokens).err();
            refused.map(|errors| {
                errors
                    .iter()
                    .map(|error| error.message().to_owned())
                    .collect::<String>()
            })
        };
        let told = message(format!("conserved under {surface}: {value}"));
        assert!(
            told.is_none_or(|told| told.contains("is undecided")),
            "{value}"
        );
        let told = message(format!("not conserved under {surface}: {value}")).expect("a refusal");
        assert!(
            told.contains("is undecided") || told.contains("is refuted"),
            "{told}"
        );
    }
}
