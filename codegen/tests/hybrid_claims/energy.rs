//! Tests of the claim `energy under s: not increasing`.

use crate::Expected::{False, Open, Shown, True};
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
