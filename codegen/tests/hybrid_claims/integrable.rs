//! Tests of the claim `integrable: f, g, ..`.

use dalembert_codegen::claims::Verdict;

use crate::Expected::{False, Open, Shown, True};
use crate::check;
use crate::systems::{ball, disk, particle};

const SPIN: &str = "integrable: energy, x*momentum(y) - y*momentum(x)";

fn central(surfaces: &str) -> String {
    format!(
        "pub Central {{ coordinates {{ x; y; }} parameters {{ k > 0 = 2; }}
        lagrangian = (dot(x)^2 + dot(y)^2)/2 + k/sqrt(1 + x^2 + y^2); impacts {{ {surfaces} }} CLAIM }}"
    )
}

const QUARTIC: &str = "pub Quartic { coordinates { x; } lagrangian = dot(x)^2/2 - x^4; CLAIM }";

const PENDULUM: &str = "pub Pendulum { coordinates { x: angle; } parameters { l > 0 = 2; }
    lagrangian = l^2*dot(x)^2/2 + l*cos(x); CLAIM }";

const COUPLED: &str = "pub Coupled { coordinates { x; y; }
    lagrangian = dot(x)^2 + dot(y)^2 + cos(x - y)*dot(x)*dot(y) + sin(x - y); CLAIM }";

#[test]
fn integrable_systems_are_proved() {
    check(QUARTIC, "integrable: energy", True);
    check(PENDULUM, "integrable: energy^3 + energy", True);
    check(
        COUPLED,
        "integrable: energy, momentum(x) + momentum(y)",
        True,
    );
    check(&central(""), SPIN, True);
    check(&central("wall: 4 - x^2 - y^2 >= 0;"), SPIN, True);
    check(
        &central("post: x^2 + y^2 >= 1; wall: 4 - x^2 - y^2 >= 0;"),
        SPIN,
        True,
    );
    check(&particle(""), "integrable: momentum(x), momentum(y)", True);
    check(
        &particle("left: x >= 0; right: 1 - x >= 0;"),
        "integrable: energy, momentum(y)",
        True,
    );
    check(
        &particle("left: x >= 0;"),
        "integrable: dot(x)^2, momentum(y)",
        True,
    );
    check(&ball("elastic"), "integrable: energy", True);
    // A rolling disk has two degrees of freedom.
    check(
        &disk(""),
        "integrable: momentum(theta), momentum(phi)",
        True,
    );
    check(&disk(""), "integrable: energy, momentum(phi)", True);
}

#[test]
fn systems_with_functions_that_change_are_refuted() {
    check(
        QUARTIC,
        "integrable: dot(x)",
        False("`dot(x)` changes along the motion"),
    );
    check(
        &central(""),
        "integrable: energy, momentum(x)",
        False("changes along the motion"),
    );
    // x = 0.36 and y = -0.53, dot(x) = 0.5 and dot(y) = -0.75: {p_x, x p_y - y p_x} = -p_y.
    check(
        &particle(""),
        "integrable: momentum(x), x*momentum(y) - y*momentum(x)",
        Shown("{momentum(x), x*momentum(y) - y*momentum(x)}", 0.75),
    );
    check(
        &disk(""),
        "integrable: momentum(theta), x - R*cos(phi)",
        False("changes along the motion"),
    );
    // x - R sin(phi) dot(theta)/dot(phi) is the x-coordinate of the centre of the circle that the disk rolls on.
    check(
        &disk(""),
        "integrable: momentum(phi), x - R*sin(phi)*dot(theta)/dot(phi)",
        False("are not in involution"),
    );
}

#[test]
fn functions_with_kinks_are_left_open() {
    // Both are 0 where energy <= 1/2.
    for stated in [
        "abs(energy - 1/2) + energy - 1/2",
        "sqrt((energy - 1/2)^2) + energy - 1/2",
    ] {
        check(
            QUARTIC,
            &format!("integrable: {stated}"),
            Open("may have a kink"),
        );
    }
}

#[test]
fn functions_that_depend_on_each_other_are_refuted() {
    check(
        &central(""),
        "integrable: energy, 2*energy",
        Shown("factor of d(2*energy)", -0.5),
    );
    check(
        &particle(""),
        "integrable: energy, momentum(x)^2 + momentum(y)^2",
        Shown("factor of d(momentum(x)^2 + momentum(y)^2)", -0.5),
    );
    check(
        &disk(""),
        "integrable: momentum(phi), dot(phi)^2",
        False("are dependent"),
    );
    check(
        &disk(""),
        "integrable: momentum(theta), momentum(x)^2 + momentum(y)^2",
        False("are dependent"),
    );
}

/// For almost all values of a parameter the functions are independent; at the declared one they are not.
#[test]
fn functions_that_depend_on_each_other_at_the_defaults_are_refuted() {
    let free = |default: &str| {
        format!(
            "Free {{ coordinates {{ x; y; }} parameters {{ k = {default}; }}
            lagrangian = (dot(x)^2 + dot(y)^2)/2; CLAIM }}"
        )
    };
    let scaled = "integrable: dot(x), k*dot(y) + dot(x)^2";
    check(&free("1"), scaled, True);
    check(&free("0"), scaled, False("at the declared defaults k = 0,"));
    let shifted = "integrable: dot(x), (k - 3)*dot(y)";
    check(&free("2"), shifted, True);
    check(
        &free("3"),
        shifted,
        False("at the declared defaults k = 3,"),
    );
}

#[test]
fn impacts_that_change_a_function_are_refuted() {
    check(
        &ball("newton(c)"),
        "integrable: energy",
        False("changes in an impact at `floor`"),
    );
    check(
        &particle("left: x >= 0;"),
        "integrable: momentum(x), momentum(y)",
        False("`momentum(x)` changes in an impact at `left`"),
    );
    check(
        &central("wall: 4 - x^2 - 2*y^2 >= 0;"),
        SPIN,
        False("changes in an impact at `wall`"),
    );
    check(
        &disk("wall: x >= 0;"),
        "integrable: momentum(theta), momentum(phi)",
        False("changes in an impact at `wall`"),
    );
}

#[test]
fn near_misses_are_refuted() {
    check(
        &central("wall: 4 - x^2 - (1 + 1e-9)*y^2 >= 0;"),
        SPIN,
        False("changes in an impact at `wall`"),
    );
    check(
        &central(""),
        "integrable: energy, (1 + 1e-9)*x*momentum(y) - y*momentum(x)",
        False("changes along the motion"),
    );
    check(
        &central("wall: 4 - (x - 1e-9)^2 - y^2 >= 0;"),
        SPIN,
        False("changes in an impact at `wall`"),
    );
    // The differentials are independent, but nearly dependent.
    check(
        &particle(""),
        "integrable: momentum(x), momentum(x) + 1e-9*momentum(y)",
        True,
    );
}

/// The certificate for a single function is a sentence in the singular.
#[test]
fn the_certificate_for_one_function_is_in_the_singular() {
    for (claim, told) in [
        (
            "integrable: energy",
            "`energy` is conserved, and its differential vanishes at almost no state; `floor` keeps it",
        ),
        (
            "involution: energy",
            "`energy` is in involution with itself",
        ),
    ] {
        let source = ball("elastic").replace("CLAIM", &format!("claims {{ {claim}; }}"));
        let Verdict::Proved(certificate) = &crate::findings(&source)[0].verdict else {
            panic!("{claim} is proved");
        };
        assert_eq!(certificate.shown, told);
    }
}
