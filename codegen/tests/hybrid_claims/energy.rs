//! Tests of the claim `energy under s: not increasing`.

use crate::Expected::{self, False, Open, Shown, True};
use crate::check;
use crate::systems::{ball, disk, grooves, media, particle};

fn under(surface: &str) -> String {
    format!("energy under {surface}: not increasing")
}

#[test]
fn maps_that_reduce_the_energy_are_proved() {
    check(&ball("elastic"), &under("floor"), True);
    check(&ball("restitution(c)"), &under("floor"), True);
    check(&ball("impact_plastic"), &under("floor"), True);
    check(
        &ball("reset { dot(x) = -c*dot(x); }"),
        &under("floor"),
        True,
    );
    check(
        &particle("low: y >= 0 => reset { dot(y) = -dot(y)/2; dot(x) = dot(x)/3; x = x + 7; };"),
        &under("low"),
        True,
    );
    check(
        &disk("wall: 1 - x >= 0 => nonholonomic_plastic;"),
        &under("wall"),
        True,
    );
    check(
        &disk("wall: 1 - x >= 0 => newton(e), instantaneous { no_turn: d(phi) = 0; };"),
        &under("wall"),
        True,
    );
    check(
        &media(
            "m1/2*(dot(x)^2 + dot(y)^2)",
            "m2/2*(dot(x)^2 + dot(y)^2) - V",
        ),
        &under("rightward"),
        True,
    );
    check(
        &grooves("dot(y) = 0", "dot(y) = dot(x)"),
        &under("rightward"),
        True,
    );
}

#[test]
fn maps_that_add_energy_are_refuted_at_a_state() {
    check(
        &ball("reset { dot(x) = -k*dot(x); }"),
        &under("floor"),
        False("energy after"),
    );
    check(
        &ball("reset { dot(x) = -dot(x); x = x + 1; }"),
        &under("floor"),
        False("energy after"),
    );
    check(
        &particle("left: x >= 0 => reset { dot(x) = -a*dot(x); dot(y) = b*dot(y); };"),
        &under("left"),
        False("energy after"),
    );
    check(
        &particle("low: y >= 0 => reset { dot(y) = -dot(y); dot(x) = dot(x) + x; };"),
        &under("low"),
        False("energy after"),
    );
    check(
        &particle("wall: x <= 2 - t;"),
        &under("wall"),
        False("energy after"),
    );
    check(
        &particle("low: y >= 0 => reset { dot(y) = -dot(y)/2; dot(x) = 2*dot(x) + dot(y); };"),
        &under("low"),
        False("energy after"),
    );
    check(
        &grooves("dot(y) = 0", "dot(y) = 1"),
        &under("rightward"),
        Shown("energy after", 0.625),
    );
    let reset = media("(dot(x)^2 + dot(y)^2)/2", "(dot(x)^2 + dot(y)^2)/2 - V")
        .replace("when x >= 0", "when x >= 0 => reset { }");
    check(&reset, &under("rightward"), False("energy after"));
}

#[test]
fn near_misses_are_refuted() {
    check(
        &ball("reset { dot(x) = -(1 + 1e-9)*dot(x); }"),
        &under("floor"),
        False("the energy grows"),
    );
    check(
        &particle("low: y >= 0 => reset { dot(y) = -dot(y); dot(x) = dot(x) + 1e-9; };"),
        &under("low"),
        False("the energy grows"),
    );
}

#[test]
fn unexplained_losses_of_energy_stay_open() {
    check(
        &particle("wall: x <= 2 + t;"),
        &under("wall"),
        Open("no state was found"),
    );
}

/// Where the metric is not positive definite, a projection may add energy, and so may a law that reduces the gap rate.
#[test]
fn laws_add_no_energy_only_with_a_positive_metric() {
    const UNKNOWN: Expected = Open("if the metric is positive definite");
    let wall = |metric: &str, law: &str| {
        particle(&format!("wall: x >= 0 => {law};")).replace("dot(x)^2 + dot(y)^2", metric)
    };
    for law in ["newton(1/2)", "restitution(1/2)", "impact_plastic"] {
        for metric in [
            "dot(x)^2 + 4*dot(x)*dot(y) + dot(y)^2",
            "dot(x)^2 + 2*y*dot(x)*dot(y) + dot(y)^2",
            "(1 - y)*dot(x)^2 + dot(y)^2",
            "d1*dot(x)^2 + dot(y)^2",
        ] {
            check(&wall(metric, law), &under("wall"), UNKNOWN);
        }
        for metric in [
            "dot(x)^2 + dot(x)*dot(y) + dot(y)^2",
            "a*dot(x)^2 + b*y^2*dot(y)^2",
            "(a + b)*dot(x)^2 + a*dot(y)^2 + 2*a*cos(x - y)*dot(x)*dot(y)",
            "(cos(x)*dot(x) + cos(y)*dot(y))^2 + (sin(x)*dot(x) + sin(y)*dot(y))^2 + b*dot(x)^2",
        ] {
            check(&wall(metric, law), &under("wall"), True);
        }
    }
    check(
        &wall("dot(x)^2 + 4*dot(x)*dot(y) + dot(y)^2", "elastic"),
        &under("wall"),
        True,
    );
    let grooves = grooves("dot(y) = 0", "dot(y) = 3*dot(x)");
    check(&grooves, &under("rightward"), True);
    let indefinite = grooves.replace("dot(y)^2)/2", "dot(y)^2 + 4*(x + 1)*dot(x)*dot(y))/2");
    check(&indefinite, &under("rightward"), UNKNOWN);
}
