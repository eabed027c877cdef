//! Parameters, initial values, views and outputs that are refused.

use super::{accepted, particle, refused, refused_in};

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
        &with("m in [0, 0.1*pi] = «0.5»"),
        "the default `0.5` violates `in [0, 0.1*pi]`",
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
fn initial_values_are_given_for_coordinates() {
    refused_in("initial { «z» = 1; }", "unknown coordinate `z`");
    for slip in ["x_dot", "xdot"] {
        refused_in(
            &format!("initial {{ «{slip}» = 1; }}"),
            &format!("unknown coordinate `{slip}`\nhelp: the velocity of `x` is written `dot(x)`"),
        );
    }
    refused_in("initial { «t» = 0; }", "help: a run starts at time 0");
    refused_in(
        "initial { «t_end» = 9; }",
        "help: the end of a run is written `until = 10;`",
    );
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
fn a_start_lies_in_front_of_every_wall() {
    let message = "the start lies behind the surface `w`: its gap is -3";
    refused_in("impacts { w: x >= 1; } initial { x = «-2»; }", message);
    refused_in("impacts { w: x >= y; } initial { y = «3»; }", message);
    refused_in(
        "impacts { w: y >= x + 2*k; } initial { y = 1; x = «2*k»; }",
        message,
    );
    refused_in(
        "impacts { w: x >= 1 when y > 0; } initial { y = 1; x = «-2*m»; }",
        message,
    );
    let on_the_wall = "impacts { w: 10*x >= 3; } initial { x = 3/10; }";
    let beside = "impacts { w: x >= 1 when y > 0; } initial { y = -1; x = -2; }";
    let undeclared = "impacts { w: x >= 1; } initial { y = 1; }";
    for rest in [on_the_wall, beside, undeclared] {
        accepted(&particle(rest));
    }
}

#[test]
fn rates_are_taken_of_variable_quantities() {
    let message = "which depends neither on coordinates nor on `t`\nhelp: parameters, inputs and numbers have no rate";
    refused_in("outputs { o: «dot(m)»; }", message);
    refused_in("constraints { c: d(x) = «d(k*m)»; }", message);
    accepted(&particle("let l = 2*m; outputs { o: dot(l); }"));
    refused_in("forces { f: (1 + «dot(3)»)*d(x); }", message);
    let of_families = |term: &str| {
        format!(
            "P {{ coordinates {{ x[2]; }} parameters {{ l[2]; }} let X[0] = l[1]; let X[i in 1..=2] = x[i];
                lagrangian = sum(i in 1..=2: {term}*dot(x[i])); }}"
        )
    };
    refused(&of_families("(dot(x[i]) + «dot(l[i])»)"), message);
    accepted(&of_families("(dot(X[i]) + dot(X[i - 1]))"));
    accepted(&particle("outputs { o: dot(t) + dot(m*x); }"));
    accepted(&particle(
        "let turned(a) = a*sin(x); outputs { o: dot(turned(0)) + dot(turned(m - m)); }",
    ));
    accepted(&particle(
        "let rate(u) = dot(u); outputs { o: rate(x) + rate(m); }",
    ));
}

#[test]
fn starts_are_on_the_constraints() {
    let at_rest = "constraints { c: x^2 + y^2 = 1; } initial { x = 3/5; y = «4/5 + 1/100»; }";
    let message = "the start is off the constraint `c`: left side minus right side is 0.0161\nhelp: leave one of these values out";
    refused_in(at_rest, message);
    for accepted_start in [
        "constraints { c: x^2 + y^2 = 1; } initial { x = 3/5; y = 4/5; }",
        "constraints { c: x^2 + y^2 = 1; } initial { y = 4/5; }",
        "constraints { c: d(x^2 + y^2) = 0; } initial { y = 4/5; dot(y) = 0; }",
        "constraints { c: dot(x) = y*dot(a); } initial { y = 4/5; dot(a) = 5; dot(x) = 4; }",
        // `x` is solved for at run time, so its rate cannot be checked here.
        "constraints { c: x^2 + y^2 = 1; } initial { y = 4/5; dot(y) = 3; dot(x) = 3; }",
    ] {
        accepted(&particle(accepted_start));
    }
    refused_in(
        "constraints { c: dot(x) = y*dot(a); } initial { y = 4/5; dot(a) = 5; dot(x) = «3»; }",
        "the start is off the constraint `c`: left side minus right side is -1\nhelp: leave one of these values out",
    );
    refused_in(
        "constraints { c: dot(x)^2 + dot(y)^2 = 25; } initial { dot(x) = 3; dot(y) = «5»; }",
        "the start is off the constraint `c`: left side minus right side is 9",
    );
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
