//! Tests of the claim `involution: f, g, ..`.

use crate::Expected::{False, Shown, True};
use crate::check;
use crate::systems::{ball, disk, particle};

const CENTRAL: &str = "pub Central { coordinates { x; y; } parameters { k > 0 = 2; }
    lagrangian = (dot(x)^2 + dot(y)^2)/2 + k/sqrt(1 + x^2 + y^2); CLAIM }";

/// A charge in a magnetic field of the strength b.
const CHARGED: &str = "pub Charged { coordinates { x; y; } parameters { b > 0 = 3; }
    lagrangian = (dot(x)^2 + dot(y)^2)/2 + b*x*dot(y); CLAIM }";

const COUPLED: &str = "pub Coupled { coordinates { x; y; }
    lagrangian = dot(x)^2 + dot(y)^2 + cos(x - y)*dot(x)*dot(y) + sin(x - y); CLAIM }";

const SLEIGH: &str = "pub Sleigh { coordinates { x; y; theta: angle; } parameters { a > 0 = 1/3; }
    lagrangian = (dot(x - a*cos(theta))^2 + dot(y - a*sin(theta))^2)/2 + dot(theta)^2/5;
    constraints { blade: dot(y)*cos(theta) = dot(x)*sin(theta); } CLAIM }";

#[test]
fn functions_in_involution_are_proved() {
    check(
        CENTRAL,
        "involution: energy, x*momentum(y) - y*momentum(x)",
        True,
    );
    check(&particle(""), "involution: momentum(x), momentum(y)", True);
    check(
        &particle(""),
        "involution: x - t*dot(x), y - t*dot(y)",
        True,
    );
    check(
        &particle(""),
        "involution: dot(x)^2 + x^2, dot(y)^2 + y^2, dot(x)^2 + dot(y)^2 + x^2 + y^2",
        True,
    );
    // Canonical momenta commute, velocities do not.
    check(CHARGED, "involution: momentum(x), momentum(y)", True);
    check(CHARGED, "involution: momentum(y), energy", True);
    check(
        CHARGED,
        "involution: dot(x) - b*y, energy, atan2(1, 2)*energy",
        True,
    );
    check(
        COUPLED,
        "involution: momentum(x) + momentum(y), energy",
        True,
    );
    check(
        COUPLED,
        "involution: momentum(x)*momentum(y), momentum(x) - momentum(y)",
        True,
    );
    check(
        &disk(""),
        "involution: momentum(theta), momentum(phi), energy",
        True,
    );
    check(&disk(""), "involution: x, y, phi, theta", True);
    check(SLEIGH, "involution: x, y, theta", True);
    // Impacts do not matter.
    check(&ball("newton(1/2)"), "involution: energy, energy^2", True);
}

#[test]
fn functions_that_are_not_in_involution_are_refuted() {
    check(
        &particle(""),
        "involution: x, momentum(x)",
        Shown("{x, momentum(x)}", 1.0),
    );
    check(
        &particle(""),
        "involution: momentum(x), y, x^2*momentum(y)",
        Shown("{momentum(x), x^2*momentum(y)}", 2.0 * 0.36 * 0.75),
    );
    // Every pair counts.
    check(
        &particle(""),
        "involution: momentum(x), momentum(y), y",
        Shown("{momentum(y), y}", -1.0),
    );
    check(
        &ball("elastic"),
        "involution: dot(x), x",
        False("{dot(x), x} = -1/m"),
    );
    // dA = b dx^dy.
    check(
        CHARGED,
        "involution: dot(x), dot(y)",
        Shown("{dot(x), dot(y)}", 3.0),
    );
    check(
        CHARGED,
        "involution: momentum(x), energy",
        False("{momentum(x), energy} = b*dot(y)"),
    );
    check(
        &particle(""),
        "involution: momentum(x), x*momentum(y) - y*momentum(x)",
        False("= -dot(y)"),
    );
    check(
        COUPLED,
        "involution: momentum(x), energy",
        False("are not in involution"),
    );
    check(
        &disk(""),
        "involution: x, momentum(x)",
        False("= m*R^2*cos(phi)^2/(I + m*R^2)"),
    );
    check(
        &disk(""),
        "involution: momentum(phi), phi",
        Shown("{momentum(phi), phi}", -1.0),
    );
    check(
        &disk(""),
        "involution: momentum(x), momentum(phi)",
        False("are not in involution"),
    );
    check(
        SLEIGH,
        "involution: dot(x), dot(theta)",
        False("are not in involution"),
    );
    check(
        SLEIGH,
        "involution: energy, theta",
        False("{energy, theta} = -dot(theta)"),
    );
}

#[test]
fn near_misses_are_refuted() {
    check(
        CENTRAL,
        "involution: energy, (1 + 1e-9)*x*momentum(y) - y*momentum(x)",
        False("are not in involution"),
    );
    check(
        COUPLED,
        "involution: momentum(x) + 1.000000001*momentum(y), energy",
        False("are not in involution"),
    );
    check(
        &disk(""),
        "involution: momentum(theta), phi*1e-9 + momentum(phi), 1e-9*x + momentum(phi)",
        False("are not in involution"),
    );
    check(
        &particle(""),
        "involution: dot(x)^2 + x^2, (1 + 1e-9)*dot(x)^2 + dot(y)^2 + x^2",
        False("are not in involution"),
    );
}
