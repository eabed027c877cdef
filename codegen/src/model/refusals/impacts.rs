//! Surfaces and laws that are refused.

use super::refused_in;

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
