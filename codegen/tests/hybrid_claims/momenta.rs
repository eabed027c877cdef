//! Effects of surfaces on the momentum of a symmetry.

use crate::findings;
use crate::systems::{disk, particle};

fn note(declaration: &str, field: &str) -> String {
    let source = declaration.replace("CLAIM", &format!("claims {{ symmetry: {field}; }}"));
    let found = findings(&source);
    assert_eq!(found[0].word(), "proved", "{}", found[0].note());
    found[0].note()
}

const TURN: &str = "x*partial(y) - y*partial(x)";

#[test]
fn a_round_wall_keeps_the_angular_momentum_and_an_ellipse_does_not() {
    let round = note(&particle("wall: 1 - x^2 - y^2 >= 0;"), TURN);
    assert!(
        round.contains("an impact at wall keeps the symmetry and keeps its momentum"),
        "{round}"
    );
    let oval = note(&particle("wall: 1 - x^2/4 - y^2 >= 0;"), TURN);
    assert!(
        oval.contains("an impact at wall breaks the symmetry and changes its momentum by eps*("),
        "{oval}"
    );
    assert!(oval.contains("momentum after = "), "{oval}");
}

#[test]
fn a_straight_wall_keeps_the_momentum_along_it() {
    let wall = particle("wall: x + 2*y >= 0 => newton(1/2);");
    let along = note(&wall, "2*partial(x) - partial(y)");
    assert!(
        along.contains("an impact at wall keeps the symmetry and keeps its momentum"),
        "{along}"
    );
    let across = note(&wall, "partial(x)");
    assert!(
        across.contains("breaks the symmetry and changes its momentum by eps*(1)"),
        "{across}"
    );
}

/// The rotation of the disk and of its position about the origin is a symmetry that is not in D. A round table keeps
/// the symmetry. The momentum of the symmetry still jumps, because the impulse acts within D.
#[test]
fn a_disk_on_a_round_table_keeps_its_symmetry() {
    let table = |tb: &str| {
        let edge = format!("edge: 1 - (x + R*cos(phi))^2 - (y + R*sin(phi))^2/{tb} >= 0;");
        note(&disk(&edge), "partial(phi) - y*partial(x) + x*partial(y)")
    };
    let round = table("1");
    assert!(
        round.contains(
            "an impact at edge keeps the symmetry and changes its momentum by eps*dh(pi_D xi)"
        ),
        "{round}"
    );
    let oval = table("4");
    assert!(
        oval.contains(
            "an impact at edge breaks the symmetry and changes its momentum by eps*dh(pi_D xi)"
        ),
        "{oval}"
    );
}

#[test]
fn resets_and_gauge_symmetries_are_examined() {
    let step = particle("step: y >= 0 => reset { dot(y) = -dot(y); dot(x) = dot(x)/2; };");
    let found = note(&step, "partial(x)");
    assert!(
        found.contains("an impact at step changes its momentum: momentum after = "),
        "{found}"
    );
    let charge = "pub Charge { coordinates { x; y; } parameters { B = 2; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2 + B*x*dot(y); impacts { wall: y >= 0; } CLAIM }";
    let found = note(charge, "partial(x)");
    assert!(
        found.contains("an impact at wall keeps the symmetry and keeps its momentum less the gain"),
        "{found}"
    );
    // A boost: `t*dot(x) - x` is conserved, and the reset moves x.
    let moved = particle("wall: y >= 0 => reset { dot(y) = -dot(y); x = x + 1; };");
    let found = note(&moved, "t*partial(x)");
    assert!(
        found.contains("an impact at wall changes its momentum less the gain: momentum after = "),
        "{found}"
    );
}

/// The flow moves states at which the surface counts to states at which it does not.
#[test]
fn a_condition_that_the_flow_changes_is_no_symmetry_of_the_impact() {
    let half = note(&particle("wall: x >= 0 when y > 0;"), "partial(y)");
    assert!(
        half.contains("an impact at wall keeps its momentum"),
        "{half}"
    );
    let round = note(
        &particle("wall: 1 - x^2 - y^2 >= 0 when x^2 + y^2 > 1/2;"),
        TURN,
    );
    assert!(
        round.contains("an impact at wall keeps the symmetry and keeps its momentum"),
        "{round}"
    );
}
