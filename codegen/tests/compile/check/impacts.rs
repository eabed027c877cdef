//! Surfaces and laws that are refused.

use super::{accepted, refused, refused_in};

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
        "impacts { w: x >= 0 => «plastic»; }",
        "did you mean `nonholonomic_plastic` or `impact_plastic` or `totally_plastic`?",
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
fn coefficients_lie_between_0_and_1() {
    let law = |coefficient: &str| format!("impacts {{ w: x >= 0 => newton({coefficient}); }}");
    refused_in(&law("«6/5»"), "newton 6/5 adds energy");
    refused_in(&law("«1 + 1/2»"), "newton 1 + 1/2 adds energy");
    refused_in(&law("«pi/3»"), "newton pi/3 adds energy");
    refused_in(&law("«-1»"), "newton -1 goes on into the wall");
    refused_in(&law("«1 - sqrt(2)»"), "goes on into the wall");
    refused_in(
        &law("«2*k»"),
        "`2*k` is 2 at the default of `k`\nhelp: the coefficient lies in [0, 1]; change it or the default",
    );
    refused_in(
        &law("«m/2 - k»"),
        "`m/2 - k` is -0.5 at the defaults of `m` and `k`",
    );
}

#[test]
fn gaps_change_their_sign_where_they_are_zero() {
    let gap = |gap: &str| format!("impacts {{ w: «{gap} >= 0»; }}");
    for power in ["(x - 1)^2", "2*k*(x - y)^3", "-x^2", "cos(a)^2"] {
        let message = "not regular: the gradient vanishes where the surface is zero\nhelp: write `";
        refused_in(&gap(power), message);
    }
    for bounded in [
        "x^2 + y^2",
        "m*x^2 + k*(y - t)^4",
        "abs(x)",
        "exp(y)*(x - y)^2",
    ] {
        refused_in(&gap(bounded), "not regular: the gap is never negative");
    }
    refused_in(
        "impacts { w: «x^2 + y^2 <= 0»; }",
        "not regular: the gap is never positive",
    );
    for repeated in [
        "x^2 - 2*x + 1",
        "x^2 - 2*pi*x + pi^2",
        "x^2 + 2*x*y + y^2",
        "k^2*x^2 - 2*k*x*t + t^2",
        "x^4 - 2*x^2 + 1",
        "x^2*(x - 1)",
        "1 - 2*(x^2/k^2 + y^2/m^2) + (x^2/k^2 + y^2/m^2)^2",
    ] {
        refused_in(&gap(repeated), "not regular: a factor is repeated");
    }
    for positive in ["x^2 - 2*x + 2", "x^2 + x + 1", "2 + x^4 - 2*x^2"] {
        refused_in(&gap(positive), "surface has no zero set: it is never zero");
    }
    let chart =
        "P { coordinates { u in (0, 1); } lagrangian = dot(u)^2; impacts { w: «u^2 >= 4»; } }";
    refused(chart, "surface has no zero set: it is never zero");
}

/// Gaps that are undefined near the origin are compared at points where they are defined.
#[test]
fn surfaces_share_a_gap_that_is_defined_far_away_only() {
    for other in ["sqrt(x - 5) >= 1", "2*sqrt(x - 5) >= 2"] {
        accepted(&format!(
            "P {{ coordinates {{ x in (5, 9); y; }} lagrangian = (dot(x)^2 + dot(y)^2)/2;
                impacts {{ a: sqrt(x - 5) >= 1 when y > 0; b: {other} otherwise; }} }}"
        ));
    }
}
