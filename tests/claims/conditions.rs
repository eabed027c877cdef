//! Conditions on parameters under which a density exists, for models that have none for generic values.

use dalembert_codegen::claims::{Condition, find_conditions};
use dalembert_declarations::visible::{Scheme, declaration, visible_system};
use dalembert_tests::verdict::{Decided, Existence};

/// The conditions of a model, as text.
fn conditions(source: &str) -> Vec<String> {
    let mut decided = Decided::of(source);
    let exactness = decided.exactness().clone();
    let scan = find_conditions(&mut decided.model, &decided.problem, &exactness, 1);
    let scan = scan.expect("a scan");
    assert!(scan.is_complete, "{source}");
    let text = |condition: &Condition| {
        let place = if condition.is_global { "" } else { ", locally" };
        format!("{}{place}", condition.text(&decided.model))
    };
    scan.found.iter().map(text).collect()
}

#[test]
fn the_sleigh_needs_its_centre_of_mass_over_the_blade() {
    let sleigh = declaration(&visible_system("chaplygin_sleigh"));
    assert_eq!(conditions(&sleigh), ["a = 0"]);
    // `m = 0` makes the metric singular and is no condition, whatever the assumption on `m`.
    assert_eq!(conditions(&sleigh.replace("m > 0", "m")), ["a = 0"]);
    // No condition is left if the assumption on `a` excludes it.
    assert!(conditions(&sleigh.replace("a =", "a > 0 =")).is_empty());
    assert!(conditions(&sleigh.replace("a =", "a in [1/2, 1] =")).is_empty());
}

#[test]
fn suslov_needs_a_principal_axis() {
    let suslov = declaration(&visible_system("suslov"));
    assert_eq!(conditions(&suslov), ["I13 = 0 and I23 = 0"]);
}

/// `b = 0` alone is not enough: the mass is still at the distance `a` from the hinge. If both offsets are 0, the blades
/// are at one point, and the constraints are dependent where the blades are parallel.
#[test]
fn the_roller_racer_needs_both_offsets_to_vanish() {
    let mut scheme = Scheme::of(&visible_system("roller_racer"));
    scheme.parameters = scheme
        .parameters
        .replace("a > 0", "a")
        .replace("b > 0", "b");
    assert_eq!(
        conditions(&scheme.declaration()),
        ["a = 0 and b = 0, locally"]
    );
}

#[test]
fn the_helical_circle_needs_pitch_zero() {
    let helix = declaration(&visible_system("helical_circle"));
    assert_eq!(conditions(&helix), ["k = 0"]);
}

/// The axis `b1 + 2*b2` is principal if the moments of inertia `A` and `B` are equal.
#[test]
fn a_suslov_axis_between_two_principal_ones_needs_equal_moments() {
    let body = "Body {
        coordinates { phi: angle; theta in (0, pi); psi: angle; }
        parameters { A > 0 = 3; B > 0 = 4; C > 0 = 5; }
        let b1 = dot(phi)*sin(theta)*sin(psi) + dot(theta)*cos(psi);
        let b2 = dot(phi)*sin(theta)*cos(psi) - dot(theta)*sin(psi);
        let b3 = dot(phi)*cos(theta) + dot(psi);
        lagrangian = (A*b1^2 + B*b2^2 + C*b3^2)/2;
        constraints { axis: b1 + 2*b2 = 0; }
    }";
    assert_eq!(conditions(body), ["A = B"]);
}

/// At `l1 = 0` the axle of the trailer is below the hitch, and both blades are at one point.
#[test]
fn a_trailer_needs_its_axle_below_the_hitch() {
    let trailer = "Trailer {
        coordinates { x; y; theta0: angle; theta1: angle; }
        parameters { m > 0 = 2; m1 > 0 = 1; I0 > 0 = 1; I1 > 0 = 1/2; l1 = 1/3; }
        let x1 = x - l1*cos(theta1);
        let y1 = y - l1*sin(theta1);
        lagrangian = m/2*(dot(x)^2 + dot(y)^2) + I0/2*dot(theta0)^2 + m1/2*(dot(x1)^2 + dot(y1)^2) + I1/2*dot(theta1)^2;
        constraints {
            blade: -sin(theta0)*d(x) + cos(theta0)*d(y) = 0;
            trailer: -sin(theta1)*d(x1) + cos(theta1)*d(y1) = 0;
        }
    }";
    assert_eq!(conditions(trailer), ["l1 = 0, locally"]);
}

/// The condition is a value other than 0. Verdicts are for generic values, even if the default meets the condition.
#[test]
fn values_at_which_the_obstruction_vanishes_are_found() {
    let particle = "Particle {
        coordinates { x; y; z; } parameters { k = 1/3; }
        lagrangian = (dot(x)^2 + dot(y)^2 + dot(z)^2)/2;
        constraints { c: d(z) - (y + (k - 2)*x)*d(x) = 0; }
    }";
    assert_eq!(conditions(particle), ["k = 2"]);
    assert_eq!(
        Decided::of(&particle.replace("k = 1/3", "k = 2")).existence(),
        Existence::None
    );
}

/// Remarks on a sleigh whose blade has this offset from the centre of mass, a polynomial in the parameters.
fn off_by(offset: &str, parameters: &str) -> String {
    let source = format!(
        "Sleigh {{ coordinates {{ x; y; th: angle; }} parameters {{ m > 0 = 1; J > 0 = 1; {parameters} }}
        lagrangian = m/2*(dot(x)^2 + dot(y)^2) + J/2*dot(th)^2;
        constraints {{ blade: -sin(th)*d(x) + cos(th)*d(y) - ({offset})*d(th) = 0; }}
        claims {{ density: none; }} }}"
    );
    dalembert_tests::claim::verdict(&source).remarks.join("; ")
}

#[test]
fn conditions_are_polynomials_in_the_parameters() {
    for (offset, parameters, condition) in [
        ("a + b", "a = 1; b = 2;", "a + b = 0"),
        ("a - 2*b", "a = 1; b = 2;", "2*b - a = 0"),
        ("a^2 - b", "a = 1; b = 2;", "a^2 - b = 0"),
        ("a*b - 1", "a = 1; b = 2;", "a*b - 1 = 0"),
        ("J - m*a^2", "a = 1/2;", "m*a^2 - J = 0"),
        ("a + b + c", "a = 1; b = 2; c = 3;", "a + b + c = 0"),
    ] {
        let remarks = off_by(offset, parameters);
        let expected = format!("a density exists where {condition}, among the conditions scanned");
        assert!(remarks.contains(&expected), "{offset}: {remarks}");
    }
}

#[test]
fn conditions_that_assumptions_exclude_are_not_named() {
    let remarks = off_by("a + b", "a > 0 = 1; b > 0 = 2;");
    assert!(remarks.contains("none of the conditions"), "{remarks}");
}

#[test]
fn the_values_at_which_a_closed_form_fails_are_named() {
    let source = "Particle { coordinates { x; y; } parameters { k >= 0 = 1; c > 0 = 1; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2;
        constraints { belt: dot(x) = k; } forces { drag: -c*dot(y)*d(y); }
        claims { density: exact; } }";
    let note = dalembert_tests::claim::verdict(source).note();
    assert!(note.contains("G = c/k*x, where k != 0"), "{note}");
}
