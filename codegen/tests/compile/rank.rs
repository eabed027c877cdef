//! Constraints of constant rank, and constraints whose rank can drop.

use dalembert_codegen::compile;

/// True if the rank of these constraints is proved to be constant.
fn is_constant(constraints: &str) -> bool {
    let source = format!(
        "pub Model {{
            coordinates {{ x; y; z; w; theta: angle; }}
            parameters {{ a > 0 = 1; b = 1; c != 0 = 1; }}
            lagrangian = (dot(x)^2 + dot(y)^2 + dot(z)^2 + dot(w)^2 + dot(theta)^2)/2;
            constraints {{ {constraints} }}
        }}"
    );
    let compiled = compile(source.parse().expect("tokens")).expect("a model");
    !compiled.derivation.can_lose_rank
}

#[test]
fn constant_ranks_are_proved() {
    for constraints in [
        "k: d(x) - y*d(z) = 0;",
        "k: sin(theta)*d(x) - cos(theta)*d(y) = 0;",
        "k: (1 + x^2)*d(x) + y*d(z) = 0;",
        "k: x*d(y) + y*d(z) + a*d(w) = 0;",
        "k: d(z) - y*d(x) = 0; l: d(z) - y*d(x) + c*(d(w) - x*d(y)) = 0;",
        "k: a*sin(theta)*d(x) - a*cos(theta)*d(y) = 0; l: cos(theta)*d(x) + sin(theta)*d(y) - b*d(z) = 0;",
        "k: d(x^2/a + y^2 - 1) = 0;",
        "k: d(x^2 + y^2) = 0; l: d(z) - w*d(w) - x*d(theta) = 0;",
        "k: d(x^2 + y^2) = 0; l: d((x - z)^2 + w^2) = 0;",
        "k: x*d(x) + y*d(y) = 0; l: (z - x)*(d(z) - d(x)) + (w - y)*(d(w) - d(y)) = 0;",
        "k: (a + exp(t))*(sin(theta)*d(x) - cos(theta)*d(y)) = 0;",
    ] {
        assert!(is_constant(constraints), "{constraints}");
    }
}

#[test]
fn ranks_that_can_drop_are_not_proved_constant() {
    for constraints in [
        "k: d(x) = 0; l: d(x) + y*d(z) = 0;",
        "k: d(x) = 0; l: d(x) + y^2*d(z) = 0;",
        "k: d(x) = 0; l: d(x) + cos(theta)*d(z) = 0;",
        "k: y*d(x) = 0;",
        "k: x*d(y) + y*d(x) = 0;",
        "k: d(x^2 + y^4) = 0;",
        "k: d(x^2 - y^2) = 0;",
        "k: d((x - y)^2 + (x + y)^3) = 0;",
        "k: x*d(z) + y*d(w) = 0;",
        "k: d(x) - t*d(y) = 0; l: d(x) - d(y) = 0;",
        "k: d(x) + y*d(z) = 0; l: y*d(x) + d(z) = 0;",
        "k: x*d(x) + y*d(y) + z*d(t) = 0;",
        "k: b*d(x) + y*d(z) = 0;",
    ] {
        assert!(!is_constant(constraints), "{constraints}");
    }
}
