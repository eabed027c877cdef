//! One case for each error of the check: the message, and the part of the text it points at, marked `«..»`.

#![allow(clippy::unwrap_used)] // a test may stop at the first surprise

use super::check;
use crate::diagnostics::{Diagnostics, reported, unmarked};
use crate::spec;

/// A particle in the plane with further declarations.
fn particle(rest: &str) -> String {
    format!(
        "P {{ coordinates {{ x; y; a: angle; }} parameters {{ m > 0 = 1; k > 0 = 1; }}
            lagrangian = m/2*(dot(x)^2 + dot(y)^2 + dot(a)^2);
            {rest} }}"
    )
}

/// Two coordinates and an angle with this Lagrangian.
fn with_lagrangian(lagrangian: &str) -> String {
    format!(
        "P {{ coordinates {{ x; y; theta: angle; }} parameters {{ m > 0 = 1; v; }}
            lagrangian = {lagrangian}; }}"
    )
}

fn diagnostics(source: &str) -> Diagnostics {
    let spec = spec::parse(source.parse().unwrap()).unwrap_or_else(|errors| panic!("{errors:?}"));
    match check(&spec) {
        Ok(_) => panic!("accepted: {source}"),
        Err(diagnostics) => diagnostics,
    }
}

/// Exactly one error, with this message, at the marked place.
#[track_caller]
fn refused(source: &str, message: &str) {
    let (source, marked) = unmarked(source);
    let errors = reported(&source, &diagnostics(&source));
    let texts: Vec<&str> = errors.iter().map(|(text, _)| text.as_str()).collect();
    assert_eq!(errors.len(), 1, "{texts:?}");
    assert!(errors[0].0.contains(message), "{}", errors[0].0);
    assert_eq!(errors[0].1, marked, "{}", errors[0].0);
}

const KINETIC: &str = "m/2*(dot(x)^2 + dot(y)^2 + dot(theta)^2)";

#[track_caller]
fn refused_term(term: &str, message: &str) {
    refused(&with_lagrangian(&format!("{KINETIC} - {term}")), message);
}

#[track_caller]
fn refused_in(rest: &str, message: &str) {
    refused(&particle(rest), message);
}

#[test]
fn unknown_names_come_with_what_was_meant() {
    refused_term(
        "«thta»",
        "unknown name `thta`\nhelp: did you mean the coordinate `theta`?",
    );
    refused_term(
        "«x·y»",
        "unknown name `x·y`\nhelp: the middle dot is part of the name; write `x*y`",
    );
    refused_term(
        "«xdot»",
        "unknown name `xdot`\nhelp: the velocity of `x` is written `dot(x)`",
    );
    refused_term("«dx»*x", "the differential of `x` is written `d(x)`");
    refused_term(
        "«banana»",
        "unknown name `banana`\nhelp: a parameter is declared with `parameters { banana; }`",
    );
    refused_term("«ẋ»", "unknown name `ẋ`\nhelp: did you mean `dot(x)`?");
    refused_term(
        "«ν»*x",
        "`ν` (Greek nu) is not the declared `v`\nhelp: write `v`",
    );
    refused_term(
        "«θ»",
        "`θ` (Greek theta) is not the declared `theta`\nhelp: write `theta`",
    );
}

#[test]
fn unknown_functions_come_with_the_list() {
    refused_term(
        "«sinn»(x)",
        "unknown function `sinn`\nhelp: did you mean `sin`?",
    );
    refused_term("«log»(x)", "unknown function `log`\nhelp: write `ln(..)`");
    refused_term("«max»(x, y)", "`max` is not differentiable");
    refused_term(
        "«m»(x + y)",
        "`m` is a parameter, not a function\nhelp: a product is written `m*(x + y)`",
    );
    refused_term("«sin»(x, y)", "`sin` takes 1 argument, found 2");
}

#[test]
fn numbers_without_a_value_are_refused() {
    refused_term("x/«0»", "division by zero");
    refused_term("«0^-1»", "division by zero");
    refused_term("«0^0»", "`0^0` is not defined");
    refused_term("«(-8)^(1/3)»", "is not a real number");
    refused_term("«ln(0)»", "`ln(0)` is not a real number");
    refused_term("«sqrt(-2)»", "`sqrt(-2)` is not a real number");
    refused_term(
        "x^«1000000000»",
        "the exponent `1000000000` is too large; the limit is 4096",
    );
    refused_term("2^«(2^40)»", "is too large; the limit is 4096");
    refused_term("«(10^30)^4000»", "an exact number of more than 4096 bits");
    refused_term(
        "x^«y»",
        "the exponent `y` is not a constant rational number\nhelp: write `exp(y*ln(x))`",
    );
}

#[test]
fn a_lagrangian_that_is_not_natural_is_refused_at_its_term() {
    refused_term("«dot(x)^3»", "not natural: `dot(x)^3`");
    refused_term("«dot(x)^2*dot(y)»", "not natural: `dot(x)^2*dot(y)`");
    refused_term("«sqrt(1 - dot(x)^2)»", "not natural: `sqrt(1 - dot(x)^2)`");
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
    let errors = diagnostics("P { lagrangian = 0; }");
    assert!(errors.iter().any(|error| {
        error
            .message()
            .starts_with("a model needs at least one coordinate")
    }));
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
}

#[test]
fn constraints_are_linear_one_forms() {
    refused_in(
        "constraints { c: «x + y = 1»; }",
        "a constraint is a one-form\nhelp: write `d(x + y - (1)) = 0`",
    );
    refused_in(
        "constraints { c: «d(x)*d(y)» = 0; }",
        "`d(x)*d(y)`: constraints are linear in velocities",
    );
    refused_in(
        "constraints { c: «dot(x)^2» = k; }",
        "`dot(x)^2`: constraints are linear in velocities",
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
fn surfaces_are_regular_and_can_be_reached() {
    refused_in(
        "impacts { w: x - «dot(x)» >= 0; }",
        "impact surfaces depend on position (and time) only",
    );
    refused_in(
        "impacts { w: «k >= 0»; }",
        "surface has no zero set: it does not depend on position",
    );
    refused_in(
        "impacts { w: «x^2 + 1 >= 0»; }",
        "surface has no zero set: it is never zero",
    );
    refused_in(
        "impacts { w: «(x - 1)^2 >= 0»; }",
        "not regular: the gradient vanishes",
    );
    refused_in(
        "constraints { c: d(x) = 0; } impacts { w: «x >= 1»; }",
        "no allowed motion can reach the surface `w`",
    );
    refused_in(
        "impacts { w: x - 1 >= 0; v: «2*x - 2 >= 0»; }",
        "same surface as `w`",
    );
    refused_in(
        "impacts { w: x - 1 >= 0; v: «1 - x >= 0»; }",
        "same surface as `w`",
    );
}

#[test]
fn laws_are_known_and_have_their_coefficients() {
    refused_in("impacts { w: x >= 0 => «bouncy»; }", "unknown law `bouncy`");
    refused_in(
        "impacts { w: x >= 0 => «elastik»; }",
        "did you mean `elastic`?",
    );
    refused_in(
        "impacts { w: x >= 0 => restitution(«1.2»); }",
        "restitution 1.2 adds energy",
    );
    refused_in(
        "impacts { w: x >= 0 => newton(«-0.5»); }",
        "newton -0.5 goes on into the wall",
    );
    refused_in(
        "impacts { w: x >= 0 => «restitution»; }",
        "`restitution` takes one coefficient",
    );
    refused_in(
        "impacts { w: x >= 0 => «elastic»(0.5); }",
        "`elastic` takes no coefficient",
    );
    refused_in(
        "impacts { w: x >= 0 => newton(«x»); }",
        "the coefficient of a law depends on parameters only",
    );
}

#[test]
fn names_are_declared_once() {
    let twice = "P { coordinates { x; «x»; } lagrangian = dot(x)^2; }";
    refused(twice, "`x` declared again");
    let both = "P { coordinates { x; } parameters { «x» > 0; } lagrangian = dot(x)^2; }";
    refused(both, "`x` declared again");
    refused_in("let «m» = 2;", "`m` declared again");
    refused_in(
        "constraints { c: d(x) = 0; «c»: d(y) = 0; }",
        "constraint `c` declared again",
    );
    refused_in("outputs { o: x; «o»: y; }", "output `o` declared again");
}

#[test]
fn definitions_use_what_stands_above() {
    refused_in(
        "let p = «q»; let q = p;",
        "defined in terms of itself: p -> q -> p",
    );
    refused_in("let p = «p» + 1;", "defined in terms of itself: p -> p");
    refused_in(
        "let f(u) = «f»(u - 1);",
        "defined in terms of itself: f -> f",
    );
    refused_in(
        "let p = «q»; let q = 1;",
        "`q` is used before it is defined\nhelp: move `let q` above `let p`",
    );
    refused_in("let f(u) = u + «thta»;", "unknown name `thta`");
    refused_in(
        "let X[i in 1..=3] = X[«i - 1»] + 1;",
        "`X[0]` is not defined above\nhelp: begin with `let X[0] = ..;`",
    );
    refused_in(
        "let f(u) = u; outputs { o: «f»; }",
        "`f` is a function\nhelp: write `f(u)`",
    );
    refused_in(
        "let f(u) = u; outputs { o: «f»(x, y); }",
        "`f` takes 1 argument, found 2",
    );
}

#[test]
fn families_have_members() {
    let chain = |rest: &str| {
        format!(
            "C {{ const N = 3; coordinates {{ q[N]; }} parameters {{ m[N] > 0 = 1; }}
                lagrangian = sum(i in 1..=N: m[i]*dot(q[i])^2); {rest} }}"
        )
    };
    refused(
        &chain("outputs { o: q[«4»]; }"),
        "`q[4]` does not exist\nhelp: `q` has the members 1 to 3",
    );
    refused(
        &chain("outputs { o: «q»; }"),
        "`q` is a family of 3\nhelp: write `q[1]`",
    );
    refused(&chain("outputs { o: «N»[1]; }"), "`N` is not a family");
    refused(
        &chain("outputs { o: q[«m[1]»]; }"),
        "`m[1]` is not an integer known while building",
    );
    refused(&chain("initial { «q» = 1; }"), "`q` is a family of 3");
    refused(
        &chain("outputs { o: sum(i in «1..=10000»: x); }"),
        "takes more than 4096 values",
    );
    refused(
        "P { coordinates { q[«0»]; } lagrangian = dot(q[1])^2; }",
        "a family of 0",
    );
}

#[test]
fn parameters_satisfy_their_assumptions() {
    let with = |parameter: &str| {
        format!("P {{ coordinates {{ x; }} parameters {{ {parameter}; }} lagrangian = dot(x)^2; }}")
    };
    refused(&with("m > 0 = «-1»"), "the default `-1` violates `> 0`");
    refused(
        &with("m in [0, 1] = «2»"),
        "the default `2` violates `in [0, 1]`",
    );
    refused(
        &with("m in [«2, 1»]"),
        "the interval from `2` to `1` is empty",
    );
    refused(&with("m = «x»"), "`x`: a default is a constant");
    refused(
        &with("m[2] = «[1, 2, 3]»"),
        "3 defaults for 2 members of `m`",
    );
    refused(&with("«m»[300]"), "300 parameters; the limit is 256");
}

#[test]
fn a_model_has_at_most_64_coordinates() {
    let source = "P { coordinates { «q»[65]; } lagrangian = sum(i in 1..=65: dot(q[i])^2); }";
    refused(source, "65 coordinates; the limit is 64");
}

#[test]
fn initial_values_are_given_for_coordinates() {
    refused_in("initial { «z» = 1; }", "unknown coordinate `z`");
    refused_in(
        "initial { «m» = 1; }",
        "`m` is a parameter, not a coordinate",
    );
    refused_in(
        "initial { x = «y»; }",
        "an initial value depends on parameters only",
    );
    refused_in(
        "initial { x = 1; «x» = 2; }",
        "initial value of `x` given again",
    );
    refused_in("initial { until = «-1»; }", "a run until -1 is empty");
    let chart =
        "P { coordinates { u in (0, pi); } lagrangian = dot(u)^2; initial { u = «2*pi»; } }";
    refused(chart, "`2*pi` lies outside of the interval of `u`");
}

#[test]
fn outputs_and_views_name_known_quantities() {
    refused_in(
        "outputs { o: multiplier(«c»); }",
        "`c` is not a constraint\nhelp: the model declares no constraints",
    );
    refused_in("outputs { o: momentum(«m»); }", "`m` is not a coordinate");
    refused_in(
        "outputs { o: «d(x)»; }",
        "an output contains no differentials",
    );
    refused_in(
        "view { path: (x, «dot(y)»); }",
        "views depend on position (and time) only",
    );
    refused_in("view { region: «x >= 0»; }", "a `view` needs a `path`");
}

#[test]
fn independent_mistakes_are_all_reported() {
    let source = particle(
        "forces { f: thta*d(x); } impacts { w: x >= 0 => bouncy; } initial { z = 1; } outputs { o: sinn(x); }",
    );
    let errors = diagnostics(&source);
    assert_eq!(errors.len(), 4);
}

#[test]
fn written_out_definitions_are_bounded() {
    let mut source = String::from("P { coordinates { x; } let f0(u) = sum(i in 1..=4000: u);");
    for level in 1..4 {
        source.push_str(&format!(
            "let f{level}(u) = sum(i in 1..=4000: f{}(u + i));",
            level - 1
        ));
    }
    source.push_str("lagrangian = dot(x)^2 + f3(x); }");
    let errors = diagnostics(&source);
    assert!(
        errors
            .iter()
            .next()
            .unwrap()
            .message()
            .contains("parts with sums and definitions written out")
    );
}

#[test]
fn deep_expressions_are_resolved_or_refused() {
    let nested = format!("{}x{}", "-(1 + 2*(".repeat(120), ")^2)".repeat(120));
    let source = with_lagrangian(&format!("{KINETIC} - {nested}"));
    let spec = spec::parse(source.parse().unwrap()).unwrap();
    assert!(check(&spec).is_ok());
    let mut source = String::from("P { coordinates { x; } let f0(u) = u;");
    for level in 1..500 {
        source.push_str(&format!("let f{level}(u) = -(1 + 2*f{}(u)^2);", level - 1));
    }
    source.push_str("lagrangian = dot(x)^2 + f499(x); }");
    let errors = diagnostics(&source);
    assert!(
        errors
            .iter()
            .next()
            .unwrap()
            .message()
            .contains("nested more than 1024 deep")
    );
}
