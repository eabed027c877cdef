//! Tests of the remarks in proofs of `volume: kept`: impacts rarely accumulate, and the motion is recurrent.

use dalembert_codegen::claims::Verdict;

use crate::findings;
use crate::systems::{ball, disk, field, particle};

const RARE: &str = "impacts accumulate for almost no start, unless states become unbounded";
const RECURRENT: &str = "almost every start comes back arbitrarily near";

/// Checks whether the proof of `volume: kept` has the remarks `RARE` and `RECURRENT`, in this order.
#[track_caller]
fn check(declaration: &str, claims: &str, expected: [bool; 2]) {
    let source = declaration.replace("CLAIM", &format!("claims {{ {claims} }}"));
    let found = findings(&source);
    let kept = found.iter().find(|finding| finding.claim == "volume: kept");
    let kept = kept.expect("the claim");
    assert!(
        matches!(kept.verdict, Verdict::Proved(_)),
        "{}",
        kept.note()
    );
    let says = |text: &str| kept.remarks.iter().any(|remark| remark.starts_with(text));
    assert_eq!([RARE, RECURRENT].map(says), expected, "{:?}", kept.remarks);
}

const KEPT: &str = "volume: kept;";
const BOX: &str = "left: x >= -1; right: x <= 1; low: y >= -2; high: b*y <= 1;";

#[test]
fn bounded_billiards_are_recurrent() {
    check(
        &particle("wall: 1 - x^2/a^2 - y^2/b^2 >= 0;"),
        KEPT,
        [true; 2],
    );
    check(&particle(BOX), KEPT, [true; 2]);
    let table = "front: 1 - (x + R*cos(phi))^2 - (y + R*sin(phi))^2 >= 0; back: x^2 + y^2 <= 4;";
    check(&disk(table), KEPT, [true; 2]);
    let pendulum =
        "pub Pendulum { coordinates { x: angle; } lagrangian = dot(x)^2/2 + cos(x); CLAIM }";
    check(pendulum, KEPT, [false, true]);
}

#[test]
fn unbounded_motion_is_not_reported_as_recurrent() {
    check(&ball("elastic"), KEPT, [true, false]);
    check(&particle("outside: x^2 + y^2 >= 1;"), KEPT, [true, false]);
    check(&particle("strip: 1 - x^2 >= 0;"), KEPT, [true, false]);
    check(
        &particle("slanted: x + y >= 0; other: x + y <= 1;"),
        KEPT,
        [true, false],
    );
    check(
        &particle(&BOX.replace("high: b*y <= 1;", "")),
        KEPT,
        [true, false],
    );
    check(
        &particle("wall: 1 - x^2 - y^2 >= 0 when x > 0;"),
        KEPT,
        [true, false],
    );
    // Where the condition begins to hold, motion may be behind the surface, and ends.
    for condition in ["y > 1/2", "sin(t) > 0"] {
        let middle = format!("{BOX} middle: x >= 1/2 when {condition};");
        check(&particle(&middle), KEPT, [true, false]);
    }
    check(&disk(""), KEPT, [false, false]);
    // `1/sin(phi)` goes to minus infinity.
    let pole = "Pole { coordinates { x; phi: angle; } lagrangian = (dot(x)^2 + dot(phi)^2)/2;
        impacts { low: x - 1/sin(phi) >= 0; high: x <= 5; } CLAIM }";
    check(pole, KEPT, [true, false]);
    check(&pole.replace("1/sin(phi)", "sin(phi)"), KEPT, [true; 2]);
}

#[test]
fn where_metric_or_potential_are_infinite_no_recurrence_is_reported() {
    let on_circle = |lagrangian: &str| {
        format!("Circle {{ coordinates {{ a: angle; }} lagrangian = {lagrangian}; CLAIM }}")
    };
    check(&on_circle("dot(a)^2/2 + cos(a)"), KEPT, [false, true]);
    check(&on_circle("dot(a)^2/2/(1 + cos(a))^2"), KEPT, [false; 2]);
    // A force that does no work and has no value where the cosine is negative.
    let gyroscopic =
        "Torus { coordinates { x: angle; y: angle; } lagrangian = (dot(x)^2 + dot(y)^2)/2;
        forces { turn: F*(dot(x)*d(y) - dot(y)*d(x)); } CLAIM }";
    check(&gyroscopic.replace('F', "cos(x)"), KEPT, [false, true]);
    check(&gyroscopic.replace('F', "sqrt(cos(x))"), KEPT, [false; 2]);
    // All motions end where the metric vanishes.
    check(&on_circle("(1 + cos(a))*dot(a)^2/2"), KEPT, [false; 2]);
    check(&on_circle("dot(a)^2/2 + tan(a)"), KEPT, [false; 2]);
    let between = "Line { coordinates { x; } lagrangian = dot(x)^2/2/(x - 1/2)^2;
        impacts { low: x >= 0; high: x <= 1; } CLAIM }";
    check(between, KEPT, [true, false]);
}

#[test]
fn motion_whose_energy_changes_is_not_reported_as_recurrent() {
    check(
        &particle("wall: 1 + sin(t)/2 - x^2 - y^2 >= 0;"),
        KEPT,
        [true, false],
    );
    // The force keeps volumes, but not the energy.
    let driven = particle("wall: 1 - x^2 - y^2 >= 0;")
        .replace("impacts", "forces { pull: -y*d(x) + x*d(y); } impacts");
    check(&driven, KEPT, [true, false]);
}

#[test]
fn jumps_at_grazing_and_rough_densities_have_no_remarks() {
    check(
        &particle("left: x >= 0 => reset { dot(x) = -dot(x); y = y + 1; };"),
        KEPT,
        [false; 2],
    );
    check(&field("dot(x) = 1; dot(y) = 0;", ""), KEPT, [false; 2]);
    check(
        &particle("left: x >= 0;"),
        "density = 1/dot(y)^2; volume: kept;",
        [false; 2],
    );
    check(
        &particle("left: x >= 0;"),
        "density = 1 + dot(y)^2; volume: kept;",
        [true, false],
    );
    for kink in [
        "1 + abs(dot(y))",
        "2 + sqrt(dot(y)^2)",
        "1 + (dot(y)^2)^(3/2)",
    ] {
        check(
            &particle("left: x >= 0;"),
            &format!("density = {kink}; volume: kept;"),
            [false; 2],
        );
    }
}

#[test]
fn nothing_recurs_where_a_surface_ends_the_motion() {
    check(
        &particle(&BOX.replace("y >= -2;", "y >= -2 => stop;")),
        KEPT,
        [false; 2],
    );
}
