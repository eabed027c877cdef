//! Tests of the claim `volume: kept`.

use crate::Expected::{False, Open, Shown, True};
use crate::systems::{ball, crossing, disk, field, grooves, media, particle, spokes, walker};
use crate::{check, findings};

const KEPT: &str = "volume: kept";

#[test]
fn kept_volumes_are_proved() {
    check(&ball("elastic"), KEPT, True);
    check(&ball("newton(1)"), KEPT, True);
    check(&ball("reset { dot(x) = -dot(x); x = x + 1; }"), KEPT, True);
    check(
        &particle("left: x >= 0 => reset { dot(x) = -a*dot(x); dot(y) = dot(y)/a^2; };"),
        KEPT,
        True,
    );
    check(
        &particle("wall: 1 - x^2 - y^2 >= 0; moving: x <= 3 + t/10;"),
        KEPT,
        True,
    );
    check(&walker("-dot(theta)"), KEPT, True);
    check(&disk("wall: 1 - x - R*cos(phi) >= 0;"), KEPT, True);
    check(
        &field(
            "dot(x) = y; dot(y) = -x;",
            "wall: x <= 1 => reset { y = -y; };",
        ),
        KEPT,
        True,
    );
    check(
        &crossing(["-2", "1"], ["-1", "-1"], "2"),
        "volume: kept; density = 1",
        True,
    );
    check(
        &media(
            "m1/2*(dot(x)^2 + dot(y)^2)",
            "m2/2*(dot(x)^2 + dot(y)^2) - V",
        ),
        KEPT,
        True,
    );
    check(&grooves("dot(y) = dot(x)", "dot(y) = dot(x)"), KEPT, True);
}

#[test]
fn lost_volumes_are_refuted_at_a_point() {
    check(&ball("restitution(c)"), KEPT, Shown("Jacobian", 0.49));
    check(&ball("impact_plastic"), KEPT, Shown("Jacobian", 0.0));
    check(
        &ball("reset { dot(x) = -k*dot(x); }"),
        KEPT,
        Shown("Jacobian", 4.0),
    );
    check(
        &particle("left: x >= 0 => reset { dot(x) = -a*dot(x); dot(y) = b*dot(y)/2; };"),
        KEPT,
        Shown("Jacobian", 0.5),
    );
    check(&walker("cos(2*delta)*dot(theta)"), KEPT, False("step"));
    check(
        &disk("wall: 1 - x >= 0 => totally_plastic;"),
        KEPT,
        False("(1 - rho)^2"),
    );
    check(
        &field(
            "dot(x) = y; dot(y) = -x;",
            "wall: x <= 1 => reset { y = -k*y; };",
        ),
        KEPT,
        Shown("Jacobian", 0.25),
    );
    check(
        &field(
            "dot(x) = y; dot(y) = -x - y;",
            "wall: x <= 1 => reset { y = -y; };",
        ),
        KEPT,
        Shown("divergence", -1.0),
    );
    check(
        &crossing(["-2", "1"], ["-1", "-1"], "1"),
        "volume: kept",
        Shown("Jacobian", 0.5),
    );
    check(
        &grooves("dot(y) = 0", "dot(y) = dot(x)"),
        KEPT,
        Shown("Jacobian", 0.25),
    );
    check(&spokes("l1/l2*cos(2*h)*dot(x)"), KEPT, False("cos(2*h)^2"));
}

#[test]
fn near_misses_are_refuted() {
    check(&ball("newton(1 - 1e-9)"), KEPT, False("Jacobian"));
    let surface = |factor: &str| {
        format!("left: x >= 0 => reset {{ dot(x) = -a*dot(x); dot(y) = ({factor})*dot(y)/a^2; }};")
    };
    check(&particle(&surface("1 + 1e-9")), KEPT, False("Jacobian"));
    check(
        &field(
            "dot(x) = y; dot(y) = -x - 1e-9*y;",
            "wall: x <= 1 => reset { y = -y; };",
        ),
        KEPT,
        False("divergence"),
    );
    check(
        &crossing(["-1", "1"], ["-1 - 1e-9", "-1"], "1"),
        KEPT,
        False("Jacobian"),
    );
}

/// The walker's step without loss preserves the volume at the declared angle, and at no other angle.
#[test]
fn a_surface_that_is_moved_is_seen() {
    let moved = walker("-dot(theta)").replace("theta >= -delta", "theta >= -delta + 1e-9");
    check(&moved, KEPT, False("Jacobian"));
}

/// Both fields lead to the surface, so the motion slides. Volumes are mapped to 0 although both gap rates have the same
/// absolute value.
#[test]
fn a_motion_that_slides_keeps_no_volume() {
    let slide = crossing(["-1", "1"], ["1", "-1"], "1");
    check(&slide, KEPT, False("holds the motion"));
    check(
        &slide,
        "density under leftward: factor = 1",
        Shown("Jacobian", -1.0),
    );
    // For negative y the motion slides, and the factor is 0.
    let partly = crossing(["-1", "1"], ["-y", "1"], "1");
    let factor = "density under leftward: factor =";
    let slides = Shown("Jacobian", -0.53);
    check(&partly, &format!("{factor} y"), slides);
    check(
        &partly,
        &format!("{factor} abs(y)"),
        Shown("Jacobian", -0.53),
    );
    let positive = "(y + abs(y))/2";
    check(&partly, &format!("{factor} {positive}"), Open(""));
    let stops = crossing(["-1", "1"], ["0", "1"], "1");
    check(&stops, &format!("{factor} 1"), Shown("Jacobian", 0.0));
    check(&stops, &format!("{factor} 0"), True);
    let never = crossing(["-1", "1"], ["-1 - y^2", "1"], "1");
    check(&never, &format!("{factor} 1 + y^2"), True);
}

/// Densities may have any sign. Their absolute values are compared, and the gap rates decide whether the motion slides.
#[test]
fn densities_that_are_negative_are_compared_by_their_size() {
    let claim = |rest: &str| format!("density = y; {rest}");
    let factor = |value: &str| claim(&format!("density under leftward: factor = {value}"));
    let to = |rate: &str| crossing(["-1", "0"], [rate, "0"], "-y");
    let slides = Shown("Jacobian", -1.0);
    check(&to("1"), &factor("1"), slides);
    check(&to("1"), &claim("volume: kept"), slides);
    check(&to("-1"), &factor("1"), True);
    check(&to("-1"), &claim("volume: kept"), True);
    check(&to("-1 - 1e-9"), &factor("1"), False("Jacobian"));
    check(
        &to("-1 - 1e-9"),
        &claim("volume: kept"),
        False("difference = 5.3"),
    );
    // A negative factor is refuted for all densities.
    check(&to("-1"), &factor("y/abs(y)"), False("is negative"));
    // With one field on both sides the motion crosses, in whichever direction it leads.
    let same = crossing(["-y - x^2", "0"], ["-y - x^2", "0"], "-y").replace("density = -y;", "");
    check(&same, "density under leftward: factor = 1", True);
}

/// A density that the program finds is known up to a constant factor only. The modes of a transition would have to
/// agree on the factor.
#[test]
fn densities_of_modes_that_are_not_plain_are_stated() {
    let slopes = "pub Slopes { coordinates { x; y; z; } lagrangian = (dot(x)^2 + dot(y)^2 + dot(z)^2)/2;
        modes { left { constraints { slope: dot(z) = y*dot(x); } CLAIM } right { constraints { slope: dot(z) = y*dot(x); } STATED } }
        transitions { rightward: left -> right when x >= 0; } }";
    let unstated = slopes.replace("STATED", "");
    check(&unstated, KEPT, Open("are known up to factors"));
    let stated = slopes.replace("STATED", "claims { density = sqrt(1 + y^2); }");
    check(&stated, "density = sqrt(1 + y^2); volume: kept", True);
    let other = slopes.replace("STATED", "claims { density = 2*sqrt(1 + y^2); }");
    check(
        &other,
        "density = sqrt(1 + y^2); volume: kept",
        False("after times the Jacobian"),
    );
}

#[test]
fn friction_is_told_from_impacts() {
    let drag = ball("elastic").replace("impacts", "forces { drag: -dot(x)*d(x); } impacts");
    check(&drag, KEPT, False("the motion does not keep it"));
}

#[test]
fn a_stated_density_that_impacts_do_not_keep_is_refuted() {
    // Free motion and elastic impacts preserve the density 1/speed^2; inelastic impacts do not.
    let claims = |law: &str| {
        let model = particle(&format!("wall: x >= 0 => {law};")).replace("d1 = 1/3;", "");
        let claims = "claims { density = 1/(dot(x)^2 + dot(y)^2); volume: kept; }";
        let found = findings(&model.replace("CLAIM", claims));
        found[1].word()
    };
    assert_eq!(claims("elastic"), "proved");
    assert_eq!(claims("restitution(1/2)"), "refuted");
}
