//! Lagrangians, angles, constraints and forces that are refused.

use super::{
    KINETIC, accepted, diagnostics, particle, refused, refused_in, refused_term, with_lagrangian,
};

#[test]
fn a_lagrangian_that_is_not_natural_is_refused_at_its_term() {
    refused_term("«dot(x)^3»", "not natural: `dot(x)^3`");
    refused_term("«dot(x)^2*dot(y)»", "not natural: `dot(x)^2*dot(y)`");
    refused_term(
        "«sqrt(1 - dot(x)^2)»",
        "not natural: `sqrt(1 - dot(x)^2)` is no polynomial in the velocities",
    );
    // The value is a polynomial, but it is not written as one.
    refused_term(
        "«sqrt(dot(x)^4)»/2",
        "not natural: `sqrt(dot(x)^4)` is no polynomial in the velocities",
    );
    refused_term(
        "sum(i in 1..=2: i*«(dot(x)^3/dot(x))»)",
        "not natural: `dot(x)^3/dot(x)` is no polynomial",
    );
    refused_term(
        "«abs(x)»",
        "`abs(x)`: `abs` is not differentiable and not allowed in `lagrangian`",
    );
    refused_term("x*«d(y)»", "a Lagrangian contains no differentials");
    refused_term("«energy»", "`energy` is derived and not known here");
    refused(
        &with_lagrangian("«-m*x^2»"),
        "no kinetic term: the metric is zero",
    );
}

#[test]
fn a_metric_that_is_not_positive_is_refused() {
    let singular = "P { coordinates { x; «z»; } lagrangian = dot(x)^2 - z^2; }";
    refused(
        singular,
        "the metric is singular: `dot(z)` does not appear\nhelp: make `z` a parameter",
    );
    let cancels =
        "P { coordinates { x; «z»; } lagrangian = dot(x)^2 + (sin(x)^2 + cos(x)^2 - 1)*dot(z)^2; }";
    refused(cancels, "the metric is singular: `dot(z)` cancels");
    let linear = "P { coordinates { x; «z»; } lagrangian = dot(x)^2 + x*dot(z); }";
    refused(
        linear,
        "the metric is singular: `dot(z)` appears only linearly",
    );
    let family = "P { coordinates { x; «q»[9]; } lagrangian = dot(x)^2 - q[1]; }";
    refused(family, "the metric is singular: `dot(q.1)` does not appear");
    let dependent = "P { coordinates { x; y; } lagrangian = «(dot(x) + dot(y))^2»; }";
    refused(dependent, "the metric is singular: rank 1 of 2");
    let indefinite = "P { coordinates { x; y; } lagrangian = dot(x)^2 - «dot(y)^2»; }";
    refused(indefinite, "the metric is not positive: entry (y, y) = -2");
}

#[test]
fn a_model_has_one_lagrangian_and_a_coordinate() {
    refused("«P» { coordinates { x; } }", "a model needs a `lagrangian`");
    refused(
        "P { coordinates { x; y; } «field» { dot(x) = 1; } }",
        "the rate of `y` is not given",
    );
    refused(
        "P { coordinates { x; } «field» { dot(x) = 1; } lagrangian = dot(x)^2; }",
        "a model has a `lagrangian` or a `field`, not both",
    );
    let errors = diagnostics("P { lagrangian = 0; }");
    assert!(errors.iter().any(|error| {
        error
            .message()
            .starts_with("a model needs at least one coordinate")
    }));
}

/// A full turn leaves these functions of half an angle unchanged, although they are not written in integer multiples of
/// the angle.
#[test]
fn a_turn_may_leave_functions_of_half_an_angle_unchanged() {
    for term in [
        "sin(theta/2)^2",
        "sqrt(2 + cos(theta/2)^2)",
        "sin(theta/2)*cos(theta/2)*x",
        "tan(theta/2)*x",
        "exp(cos(theta/2 + v)^2)",
        "sqrt(sin(theta/2)^2 + x^2)*cos(3*theta/2)*sin(theta/2)",
        "1/(2 + sin(theta/4)^2*cos(theta/4)^2)",
    ] {
        accepted(&with_lagrangian(&format!("{KINETIC} - {term}")));
    }
}

#[test]
fn angles_are_used_periodically() {
    refused_term(
        "m*«theta^2»",
        "`theta` is an angle but `theta^2` is not periodic\nhelp: declare it as a line: `theta;`",
    );
    refused_term(
        "«theta»",
        "`theta` is an angle and stands outside of `sin`, `cos` and `tan`",
    );
    refused_term(
        "«sin(theta/2)»",
        "`theta` is an angle but `sin(theta/2)` is not periodic",
    );
    // A bump that is 0 in doubles almost everywhere.
    refused_term(
        "«exp(-(1000*(theta - 5))^2)»",
        "`theta` is an angle but `exp(-(1000*(theta - 5))^2)` is not periodic",
    );
    refused_term(
        "«sqrt(x - 5 - theta^2)»",
        "`theta` is an angle but `sqrt(x - 5 - theta^2)` is not periodic",
    );
    refused_in(
        "constraints { c: d(x) = «k*a*d(y)»; }",
        "`a` is an angle but `k*a*d(y)` is not periodic",
    );
    refused_in(
        "impacts { w: x - «a» >= 0; }",
        "`a` is an angle and stands outside",
    );
    refused_in(
        "forces { f: «-k*a*d(a)»; }",
        "`a` is an angle but `-k*a*d(a)` is not periodic",
    );
    refused_in(
        "constraints { c: x = «k*a»; }",
        "`a` is an angle but `k*a` is not periodic",
    );
}

#[test]
fn one_forms_are_linear() {
    refused_in(
        "constraints { c: «1 = k»; }",
        "this equation has no coordinates\nhelp: a constraint restricts positions, `x^2 + y^2 = l^2`, or velocities",
    );
    refused_in(
        "impacts { w: x >= 0 => elastic, instantaneous { c: «x + y = 1»; }; }",
        "instantaneous constraints restrict velocities, and this equation has none\nhelp: write `dot(x) = R*dot(theta)`",
    );
    refused_in(
        "constraints { c: «d(x)*d(y)» = 0; }",
        "`d(x)*d(y)`: constraints are linear in velocities",
    );
    refused_in("constraints { c: «d(x) - d(x) = 0»; }", "this form is zero");
    refused_in(
        "constraints { c: d(x) - k*«dot(y)» = 0; }",
        "`dot(y)` and `d(x)` in one equation",
    );
    refused_in(
        "constraints { c: d(x) - «k» = 0; }",
        "`k` has no differential; every term of a one-form has one",
    );
    refused_in(
        "constraints { c: d(x) = «abs(y)»*d(y); }",
        "`abs` is not differentiable and not allowed in `constraints`",
    );
    refused_in(
        "constraints { c: dot(x) = «dot(dot(y))»; }",
        "`dot` of an expression that contains a velocity",
    );
}

#[test]
fn constraints_are_independent() {
    let twice = "constraints { c: d(x) - k*d(y) = 0; e: «2*d(x) - 2*k*d(y) = 0»; }";
    refused_in(twice, "`e` is dependent on `c`: it is 2 times that form");
    let errors = diagnostics(&particle(&twice.replace(['«', '»'], "")));
    assert_eq!(errors.iter().next().unwrap().places().len(), 2);
    let all = "constraints { c: d(x) = 0; e: d(y) = 0; f: «d(a) = 0»; }";
    refused_in(all, "no motion is left: rank 3 of 3");
}

#[test]
fn forces_are_one_forms() {
    refused_in("forces { f: «-k*x»; }", "a force is a one-form");
    for zero in [
        "0",
        "(k - k)*d(x)",
        "d(x) - d(x)",
        "(sin(a)^2 + cos(a)^2 - 1)*d(x)",
    ] {
        let force = format!("forces {{ f: «{zero}»; }}");
        refused_in(&force, "this force is zero\nhelp: leave it out");
    }
    refused_in("forces { f: -k*d(x) - «k»; }", "`k` has no differential");
    refused_in(
        "forces { f: «d(x)*d(y)»; }",
        "forces are linear in differentials",
    );
    refused_in(
        "forces { f: d(x) - k*«d(t)»; }",
        "a force does no work along `t`",
    );
}

#[test]
fn inputs_in_rates_act_in_every_scene() {
    let scene = |rest: &str| {
        format!(
            "P {{ coordinates {{ x; y; }} inputs {{ u; }} field {{ dot(x) = y; dot(y) = u; }}
                scenes {{ s; }} claims for s {{ {rest} }} }}"
        )
    };
    refused(
        &scene("«density = 1»;"),
        "`u` may depend on the state: only claims of conserved quantities are allowed with inputs",
    );
    accepted(&scene("conserved: x;"));
}
