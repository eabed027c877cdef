//! False theorems that were once proved, and their kin: products of absolute values, exceptional parameters, densities that
//! are singular far out, periods that are small, conditions of surfaces.

use dalembert_codegen::claims::{Finding, Verdict};
use dalembert_tests::claim::verdict;

/// The finding on a claim of a declaration with a name.
fn finding(name: &str, declarations: &str, claim: &str) -> Finding {
    verdict(&format!(
        "{name} {{ {declarations} claims {{ {claim}; }} }}"
    ))
}

#[track_caller]
fn not_proved(declarations: &str, claim: &str) {
    let found = finding("Sample", declarations, claim);
    assert!(
        !matches!(found.verdict, Verdict::Proved(_)),
        "{claim} of {declarations}: {}",
        found.note()
    );
}

#[track_caller]
fn not_refuted(declarations: &str, claim: &str) {
    let found = finding("Sample", declarations, claim);
    assert!(
        !matches!(found.verdict, Verdict::Refuted(_)),
        "{claim} of {declarations}: {}",
        found.note()
    );
}

/// Drag in a box of three coordinates, a product of six ramps.
const BOX: &str = "coordinates { x; y; z; } parameters { c > 0 = 1; }
    let ramp(u) = (abs(u) + u)/2;
    let inside(u) = ramp(u - 10)*ramp(20 - u);
    lagrangian = (dot(x)^2 + dot(y)^2 + dot(z)^2)/2;
    forces { drag: -c*inside(x)*inside(y)*inside(z)*(dot(x)*d(x) + dot(y)*d(y) + dot(z)*d(z)); }";

#[test]
fn drag_in_a_box_is_seen_whatever_the_name_of_the_model() {
    for k in 0..12 {
        let name = format!("Sample{k}");
        for claim in [
            "conserved: energy",
            "conserved: momentum(x)",
            "density: exact",
        ] {
            let found = finding(&name, BOX, claim);
            assert!(
                !matches!(found.verdict, Verdict::Proved(_)),
                "{name}: {}",
                found.note()
            );
        }
        let found = finding(&name, BOX, "not conserved: energy");
        assert!(
            matches!(found.verdict, Verdict::Proved(_)),
            "{name}: {}",
            found.note()
        );
    }
}

/// A force that acts in a box only is a force.
#[test]
fn a_fan_that_blows_in_a_box_changes_the_momentum() {
    let fan = "coordinates { x; y; z; }
        let ramp(u) = (abs(u) + u)/2;
        let inside(u, a, b) = ramp(u - a)*ramp(b - u);
        lagrangian = (dot(x)^2 + dot(y)^2 + dot(z)^2)/2;
        forces { fan: inside(x, 5, 6)*inside(y, 5, 6)*inside(z, 0, 1/2)*d(z); }";
    not_proved(fan, "conserved: dot(z)");
    not_refuted(fan, "not conserved: dot(z)");
}

#[test]
fn a_default_that_is_an_exception_is_no_proof() {
    let belt = |k: &str| {
        format!(
            "coordinates {{ x; y; }} parameters {{ k >= 0 = {k}; c > 0 = 1; }}
            lagrangian = (dot(x)^2 + dot(y)^2)/2;
            constraints {{ belt: dot(x) = k; }} forces {{ drag: -c*dot(y)*d(y); }}"
        )
    };
    not_proved(&belt("0"), "density: exact");
    let found = finding("Sample", &belt("1"), "density: exact");
    assert!(
        matches!(found.verdict, Verdict::Proved(_)),
        "{}",
        found.note()
    );
}

/// Each has a leaf on which the return map is no volume's: `x' = f(x)` along the circle of `y`, at a zero of `f`.
#[test]
fn densities_that_are_singular_far_out_are_not_proved() {
    for f in [
        "tanh(x - 40)",
        "1/(1 + exp(-20*(x - 10))) - 1/2",
        "1/(1 + (x - 50)^2) - 1/2",
        "exp(-(x - 50)^2) - 1/2",
        "1e30*exp(-x) - 1",
        "x^2 + k - 1",
        "(x - 50)^2",
        "x",
    ] {
        let rolling = format!(
            "coordinates {{ x; y: angle; }} parameters {{ k > 0 = 1000; }}
            lagrangian = (dot(x)^2 + dot(y)^2)/2; constraints {{ roll: dot(x) = ({f})*dot(y); }}"
        );
        not_proved(&rolling, "density: exact");
    }
    let regular = "coordinates { x; y: angle; } lagrangian = (dot(x)^2 + dot(y)^2)/2;
        constraints { roll: dot(x) = (x^4 - x^3 + 2)*dot(y); }";
    not_refuted(regular, "density: exact");
}

#[test]
fn small_and_narrow_periods_are_not_taken_for_none() {
    for slope in [
        "(1e-9 + 10*cos(th)*exp(sin(th)^3))*dot(th) + exp(-s^2)*dot(s)",
        "dot(th)*exp(-100000*(1 - cos(th)))",
    ] {
        let declared = format!(
            "coordinates {{ x; th: angle; s; }} lagrangian = (dot(x)^2 + dot(th)^2 + dot(s)^2)/2;
            forces {{ drag: -dot(x)*({slope})*d(x); }}"
        );
        not_proved(&declared, "density: exact");
        not_refuted(&declared, "density: locally_exact");
    }
}

#[test]
fn periods_that_vanish_by_symmetry_are_proved_to() {
    let declared = "coordinates { x; th: angle; s; }
        lagrangian = (dot(x)^2 + dot(th)^2 + dot(s)^2)/2;
        forces { drag: -dot(x)*(10*cos(th)*exp(sin(th)^3)*dot(th) + exp(-s^2)*dot(s))*d(x); }";
    let found = finding("Sample", declared, "density: exact");
    assert!(
        matches!(found.verdict, Verdict::Proved(_)),
        "{}",
        found.note()
    );
}

#[test]
fn parts_of_a_surface_that_do_not_count_refute_nothing() {
    let declared = "coordinates { x; } lagrangian = dot(x)^2/2;
        impacts { v: (x - 3)*(x + 3) <= 0 when x > 0; }";
    not_refuted(declared, "conserved under v: (x - 3)*dot(x)");
    not_proved(declared, "not conserved under v: (x - 3)*dot(x)");
}
