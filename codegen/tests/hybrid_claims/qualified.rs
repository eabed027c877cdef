//! Tests of the words about impacts in verdicts on densities.

use crate::findings;
use crate::systems::{ball, disk};

fn note(declaration: &str, claim: &str) -> String {
    let source = declaration.replace("CLAIM", &format!("claims {{ {claim}; }}"));
    findings(&source)[0].note()
}

#[test]
fn a_density_of_the_motion_between_impacts_only_is_called_so() {
    let note_of = |law: &str, claim: &str| note(&ball(law), claim);
    let found = note_of("restitution(c)", "density: exact");
    assert!(
        found.contains("`density: exact` is proved: for the motion between impacts only"),
        "{found}"
    );
    assert!(
        found.contains("(impacts do not keep the volume: floor multiplies it by c^2)"),
        "{found}"
    );
    let found = note_of("elastic", "density: exact");
    assert!(
        !found.contains("between impacts only") && found.contains("floor (elastic) keeps it"),
        "{found}"
    );
    let found = note_of("reset { dot(x) = -k*dot(x); }", "density = 3");
    assert!(found.contains("for the motion between impacts only (impacts do not keep the volume: floor does not keep it"), "{found}");
    let wall = disk("wall: 1 - x >= 0 => elastic, instantaneous { no_turn: d(phi) = 0; };");
    let found = note(&wall, "density: exact");
    assert!(
        found.contains("wall maps it to 0, because of its instantaneous constraints"),
        "{found}"
    );
}

#[test]
fn a_step_that_moves_the_state_has_its_factor_in_closed_form() {
    let found = note(
        &crate::systems::walker("cos(2*delta)*dot(theta)"),
        "density: exact",
    );
    assert!(
        found.contains("step multiplies it by cos(2*delta)^2"),
        "{found}"
    );
}

#[test]
fn accumulation_is_not_excluded_where_impacts_contract_the_volume() {
    let open = "accumulation of impacts is not excluded";
    let says = |law: &str, claim: &str| note(&ball(law), claim).contains(open);
    for claim in ["density: exact", "density under floor: factor = c^2"] {
        assert!(says("restitution(c)", claim), "{claim}");
    }
    for claim in ["density: exact", "density under floor: factor = 1"] {
        assert!(!says("elastic", claim), "{claim}");
    }
    assert!(
        note(&ball("restitution(c)"), "density: exact").contains("the volume is not kept at floor")
    );
}
