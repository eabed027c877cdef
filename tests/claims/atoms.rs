//! Verdicts on models that contain exponentials, roots, bare angles, logarithms and relations between them; refusals;
//! and singular models. A verdict may stay open, but is never wrong.

use dalembert_tests::verdict::{Answer, Decided, Existence, answer, refusal};
use dalembert_tests::verified::verified;

/// A particle with `dz = f dx` and twice the kinetic energy `kinetic`.
fn particle(coordinates: &str, kinetic: &str, f: &str) -> String {
    format!(
        "Particle {{ coordinates {{ {coordinates} }} parameters {{ k = 1/3; p > 0 = 2; }}
            lagrangian = ({kinetic})/2; constraints {{ c: d(z) - ({f})*d(x) = 0; }} }}"
    )
}

const FLAT: &str = "dot(x)^2 + dot(y)^2 + dot(z)^2";
const POSITIVE: &str = "x in (0, 9); y in (0, 9); z;";

/// With `f(y)` the density `sqrt(det m)` exists; with `f(x + y)` there is none.
#[test]
fn functions_of_one_coordinate_and_of_two() {
    for f in [
        "exp(S)",
        "exp(-2*S/3)",
        "sqrt(2 + S)",
        "(3 + S)^(1/3)",
        "ln(3 + S)",
        "log1p(2 + S)",
        "tanh(S)",
        "asinh(S)",
        "atan(S)",
        "cosh(k*S)",
    ] {
        let of = |argument: &str| particle("x; y; z;", FLAT, &f.replace('S', argument));
        let alone = Decided::of(&of("y")).existence();
        assert_eq!(alone, Existence::Global, "{f}");
        assert_eq!(verified(&of("(x + y)")), Existence::None, "{f}");
        assert_eq!(verified(&of("y")), Existence::Global, "{f}");
    }
}

/// The angle of a helix is a coordinate on a line. It appears both bare and inside sine and cosine.
#[test]
fn a_line_inside_and_outside_of_the_sine() {
    let spiral = |f: &str| {
        format!(
            "Spiral {{ coordinates {{ x; z; phi; }} lagrangian = (dot(x)^2 + dot(z)^2 + dot(phi)^2)/2;
                constraints {{ c: d(z) - ({f})*d(x) = 0; }} }}"
        )
    };
    for f in ["phi + sin(phi)", "phi*cos(phi)", "phi^2 - tan(phi/4)"] {
        assert_eq!(verified(&spiral(f)), Existence::Global, "{f}");
    }
    for f in [
        "phi + sin(x)",
        "phi*cos(phi + x)",
        "sin(phi/2) + x*cos(phi/3)",
    ] {
        assert_eq!(verified(&spiral(f)), Existence::None, "{f}");
    }
}

/// Expressions that are identically 0. A verdict that took one of them for a number other than 0 would refute
/// the density.
#[test]
fn related_atoms_are_not_taken_for_independent_ones() {
    let relations = [
        ("ln(x*y) - ln(x) - ln(y)", POSITIVE),
        ("ln(x^2) - 2*ln(x)", POSITIVE),
        ("exp(2*x) - exp(x)^2", "x; y; z;"),
        ("exp(x + y) - exp(x)*exp(y)", "x; y; z;"),
        ("exp(ln(x)) - x", POSITIVE),
        ("log1p(x) - ln(1 + x)", POSITIVE),
        ("exp(2*log1p(x)) - (1 + x)^2", POSITIVE),
        ("ln(exp(x)) - x", "x; y; z;"),
        ("sqrt(x*y) - sqrt(x)*sqrt(y)", POSITIVE),
        ("sqrt(x^2) - x", POSITIVE),
        ("sqrt(1 + 2*x + x^2) - 1 - x", POSITIVE),
        ("sin(2*x) - 2*sin(x)*cos(x)", "x; y; z;"),
        ("sinh(x) - (exp(x) - exp(-x))/2", "x; y; z;"),
        ("cosh(x)^2 - sinh(x)^2 - 1", "x; y; z;"),
        ("tanh(x) - sinh(x)/cosh(x)", "x; y; z;"),
        ("atan(x) + atan(1/x) - pi/2", POSITIVE),
        ("asin(x/9) + acos(x/9) - pi/2", POSITIVE),
        ("sqrt(p)*sqrt(x) - sqrt(p*x)", POSITIVE),
        ("exp(x*ln(y)) - exp(x*ln(y/2))*exp(x*ln(2))", POSITIVE),
    ];
    for (zero, coordinates) in relations {
        // With 0 there is a density; with another number in its place there is none.
        let source = particle(coordinates, FLAT, &format!("y + ({zero})*x"));
        for seed in 1..8 {
            let existence = Decided::with_seed(&source, seed).existence();
            assert_ne!(existence, Existence::Local, "{zero}");
            if existence == Existence::None {
                assert_ne!(answer(&source, "density: none"), Answer::Proved, "{zero}");
            }
        }
        assert!(
            !matches!(answer(&source, "density: exact"), Answer::Refuted(_)),
            "{zero}"
        );
        assert_ne!(answer(&source, "density: none"), Answer::Proved, "{zero}");
    }
}

/// Expressions that are similar but not 0. The obstruction is found.
#[test]
fn unrelated_atoms_are_not_taken_for_related_ones() {
    let differences = [
        ("ln(x*y) - ln(x) + ln(y)", POSITIVE),
        ("exp(2*x) - exp(x)^3", "x; y; z;"),
        ("sqrt(x*y) - sqrt(x)/sqrt(y)", POSITIVE),
        ("sqrt(1 + x^2) - 1 - x", POSITIVE),
        ("sinh(x) - (exp(x) - exp(-x))/3", "x; y; z;"),
    ];
    for (difference, coordinates) in differences {
        let source = particle(coordinates, FLAT, &format!("y + ({difference})*x"));
        assert_eq!(
            answer(&source, "density: none"),
            Answer::Proved,
            "{difference}"
        );
        assert!(
            matches!(answer(&source, "density: exact"), Answer::Refuted(_)),
            "{difference}"
        );
    }
}

/// `sqrt((x - 1/5)^2)` is the absolute value of `x - 1/5`. There is a density only on one side of `x = 1/5`.
#[test]
fn a_root_that_hides_an_absolute_value_proves_nothing() {
    let source = particle("x; y; z;", FLAT, "y + (sqrt((x - 1/5)^2) - (x - 1/5))*x");
    for seed in 1..60 {
        let existence = Decided::with_seed(&source, seed).existence();
        assert!(
            matches!(existence, Existence::None | Existence::Open),
            "{seed}: {existence:?}"
        );
    }
    for claim in ["density: exact", "density: none", "density: locally_exact"] {
        assert_ne!(answer(&source, claim), Answer::Proved, "{claim}");
    }
}

#[test]
fn functions_with_kinks_are_refused_in_metric_and_forms() {
    let kinks = [
        ("abs(x)", "`abs` is not differentiable"),
        ("sign(x)", "unknown function `sign`"),
        ("min(x, y)", "unknown function `min`"),
        ("max(x, y)", "unknown function `max`"),
        ("floor(x)", "unknown function `floor`"),
        ("(x < y)", "`<` is not differentiable"),
        ("sqrt(-1 - 1)", "is not a real number"),
        ("x*ln(-3)", "is not a real number"),
    ];
    for (kink, message) in kinks {
        let sources = [
            particle("x; y; z;", FLAT, kink),
            particle("x; y; z;", &format!("{FLAT} + dot(y)^2*({kink})"), "y"),
        ];
        for source in sources {
            let messages = refusal(&source);
            assert!(messages[0].contains(message), "{kink}: {messages:?}");
        }
    }
}

/// Outside the domain of a root, logarithm or arcsine there are values modulo primes, but no real values.
#[test]
fn parts_without_real_values_prove_nothing() {
    for f in [
        "y + x*sqrt(y - 9)",
        "sqrt(y - 9)",
        "y*ln(y - 9)",
        "y + x*asin(y + 2)",
    ] {
        let source = particle("x; y in (0, 9); z;", FLAT, f);
        for claim in ["density: exact", "density: none", "density: locally_exact"] {
            let answer = answer(&source, claim);
            assert!(
                matches!(answer, Answer::Undecided(_)),
                "{f}: {claim}: {answer:?}"
            );
        }
    }
}

/// The root is real only for `y >= 9`.
#[test]
fn real_values_are_looked_for_far_out() {
    let source = particle("x; y; z;", FLAT, "sqrt(y - 9)");
    assert_eq!(answer(&source, "density: exact"), Answer::Proved);
}

#[test]
fn singular_matrices_are_reported() {
    let metric = "Singular { coordinates { x; y; z; }
        lagrangian = ((dot(x) + z*dot(y))^2 + dot(z)^2)/2; constraints { c: d(z) - y*d(x) = 0; } }";
    let messages = refusal(metric);
    assert!(
        messages[0].contains("the metric is singular: rank 2 of 3"),
        "{messages:?}"
    );
    let forms =
        "Dependent { coordinates { x; y; z; } lagrangian = (dot(x)^2 + dot(y)^2 + dot(z)^2)/2;
        constraints { first: d(z) - y*d(x) = 0; second: x*d(z) - x*y*d(x) = 0; } }";
    let messages = refusal(forms);
    assert!(messages[0].contains("dependent"), "{messages:?}");
}
