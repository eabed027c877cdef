//! Errata of the sources of the shipped models, explained in `docs/theory/errata.md`.
//!
//! `C`: W. Clark, thesis (2020). `CB`: W. Clark and A. Bloch, Invariant forms in hybrid and impact systems. `CV`: J.
//! Cortes and A. M. Vinogradov (2006). Every right value follows from the declaration of a model. The printed formula
//! is evaluated at the same state.

use std::f64::consts::FRAC_PI_2;

use dalembert_cli::errata::{Check, Erratum};
use serde_json::Value;

/// A number of a document, by its JSON pointer.
fn number(document: &Value, pointer: &str) -> Option<f64> {
    document.pointer(pointer)?.as_f64()
}

/// A vector of a document, by its JSON pointer.
fn vector(document: &Value, pointer: &str) -> Option<Vec<f64>> {
    let entries = document.pointer(pointer)?.as_array()?;
    entries.iter().map(Value::as_f64).collect()
}

/// `a . b`
fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Divergence at the first evaluated state: with the printed factor n, and as derived.
fn divergence(document: &Value) -> Option<[f64; 2]> {
    let (theta, qdot) = (
        vector(document, "/0/density_form_theta")?,
        vector(document, "/0/qdot")?,
    );
    let printed = -(qdot.len() as f64) * dot(&theta, &qdot);
    Some([printed, number(document, "/0/divergence_mu_C")?])
}

/// Rate of `ln f` plus the divergence, where the density `f` is the power -3 or -1 of the angular momentum of the sleigh.
fn density_of_the_sleigh(document: &Value) -> Option<[f64; 2]> {
    let rate = number(document, "/0/pdot/2")? / number(document, "/0/p/2")?;
    let divergence = number(document, "/0/divergence_mu_C")?;
    Some([-3.0, -1.0].map(|power| power * rate + divergence))
}

/// Parameters of the disk in [`DISK_COMMAND`].
struct Disk {
    radius: f64,
    inertia: f64,
    mass: f64,
}

const DISK: Disk = Disk {
    radius: 0.375,
    inertia: 0.2,
    mass: 1.5,
};
const DISK_COMMAND: &str =
    "eval rolling_disk --set m=1.5 --set R=0.375 --set I=0.2 --set J=0.1 --set ta=2 --set tb=1";
const DISK_STATE: &str = r#"[{"q": [0.5, 0.25, 0, 0], "qdot": [0.375, 0, 1, 0.75]}]"#;

/// The position in [`DISK_STATE`] and the half axes in [`DISK_COMMAND`].
const PLACE: [f64; 2] = [0.5, 0.25];
const HALF_AXES: [f64; 2] = [2.0, 1.0];

/// Partial derivatives `h_x`, `h_y` of the gap at the leading end of the disk. The disk points along x.
fn slopes() -> [f64; 2] {
    let [x, y] = [PLACE[0] + DISK.radius, PLACE[1]];
    [
        -2.0 * x / HALF_AXES[0].powi(2),
        -2.0 * y / HALF_AXES[1].powi(2),
    ]
}

/// Change of the velocities by the elastic law at the leading end: a multiple of `pi_D grad h`.
fn change(document: &Value) -> Option<Vec<f64>> {
    let before = vector(document, "/0/qdot")?;
    let after = vector(document, "/0/impacts/leading_edge/laws/elastic/qdot_plus")?;
    Some(after.iter().zip(before).map(|(a, b)| a - b).collect())
}

/// Component of `pi_D grad h` along theta: `R/(I + m R^2) (h_x cos phi + h_y sin phi)` with phi = 0.
fn rolling_component() -> f64 {
    let Disk {
        radius,
        inertia,
        mass,
        ..
    } = DISK;
    radius * slopes()[0] / (inertia + mass * radius * radius)
}

/// Ratio of the components of `pi_D grad h` along phi and theta, as printed with `R/I` and as derived.
fn turning_component(document: &Value) -> Option<[f64; 2]> {
    let printed = DISK.radius / DISK.inertia * slopes()[1] / rolling_component();
    let change = change(document)?;
    Some([printed, change.get(3)? / change.get(2)?])
}

/// Ratio of the components of `pi_D grad h` along y and theta, as printed and as derived.
fn sideways_component(document: &Value) -> Option<[f64; 2]> {
    let [h_x, h_y] = slopes();
    let mass = DISK.inertia + DISK.mass * DISK.radius.powi(2);
    // The printed bracket h_y (1 - sin 2 phi) + h_x cos 2 phi with phi = 0.
    let printed = DISK.radius.powi(2) / (2.0 * mass) * (h_y + h_x);
    let change = change(document)?;
    Some([
        printed / rolling_component(),
        change.get(1)? / change.get(2)?,
    ])
}

/// Second momentum of the disk on D: as printed, `p_theta`, and as derived, `R p.e(phi) + p_theta` with phi = 0.
fn momentum_of_the_disk(document: &Value) -> Option<[f64; 2]> {
    let p = vector(document, "/0/p")?;
    Some([*p.get(2)?, DISK.radius * p.first()? + p.get(2)?])
}

/// Angular acceleration of the walker by the printed equation (4.7), and as derived; m = g = b = 1, I = 1/4, lf = 1/2.
fn walker(document: &Value) -> Option<[f64; 2]> {
    let (length, inertia, slope) = (0.5, 0.25, 0.1_f64);
    let (theta, omega, v) = (
        number(document, "/0/q/1")?,
        number(document, "/0/qdot/1")?,
        number(document, "/0/qdot/0")?,
    );
    let (sin, cos) = theta.sin_cos();
    let pull = sin * (slope.cos() + omega * omega * cos);
    let friction = length * cos * (v + length * omega * cos);
    let printed = length / (inertia + (length * sin).powi(2)) * (pull - friction);
    Some([printed, number(document, "/0/acceleration/1")?])
}

/// Rate of xi by the printed equation (4.11), and as derived; mu = 1, eps = 2.
fn dimensionless_walker(document: &Value) -> Option<[f64; 2]> {
    let (mu, eps, slope) = (1.0, 2.0, 0.1_f64);
    let (theta, xi, eta) = (
        number(document, "/0/q/0")?,
        number(document, "/0/q/1")?,
        number(document, "/0/q/2")?,
    );
    let (sin, cos) = theta.sin_cos();
    let weight = mu / (1.0 + mu * sin * sin);
    let printed = weight * (sin * (slope.cos() + eps * xi * xi * cos) - cos * (eta + xi * cos));
    Some([printed, number(document, "/0/qdot/1")?])
}

/// Angle of the third triangle of the wheel with ten spokes: printed, and from the angle at which the foot lands,
/// `pi/2 - xi - 2 delta - alpha`.
fn angle_of_the_wheel(document: &Value) -> Option<[f64; 2]> {
    let landing = number(document, "/events/2/q_minus/0")?;
    let delta = number(document, "/parameters/delta.3")?;
    let alpha = number(document, "/parameters/alpha")?;
    Some([1.5354, FRAC_PI_2 - landing - 2.0 * delta - alpha])
}

/// Rate of the vertical momentum of a falling ball: `{H, P(X)} = dH/dx`, and as derived.
fn falling(document: &Value) -> Option<[f64; 2]> {
    let (mass, gravity) = (2.0, 9.81);
    Some([mass * gravity, number(document, "/0/pdot/0")?])
}

/// First entry of the metric of the sphere, as printed with a minus sign and as it follows from the embedding.
fn metric_of_the_sphere(document: &Value) -> Option<[f64; 2]> {
    let (x, y) = (number(document, "/0/q/0")?, number(document, "/0/q/1")?);
    let printed = 1.0 - x * x / (1.0 - x * x - y * y);
    Some([printed, number(document, "/0/metric/0/0")?])
}

/// A misprint without a computed value.
const fn listed(place: &'static str, printed: &'static str, right: &'static str) -> Erratum {
    Erratum {
        place,
        printed,
        right,
        check: None,
    }
}

/// All errata, those with a computed value first.
pub const ERRATA: &[Erratum] = &[
    Erratum {
        place: "[C] (5.3) to (5.10)",
        printed: "a factor n in the divergence of the motion: div = -n theta(qdot)",
        right: "div = -theta(qdot)",
        check: Some(Check {
            quantity: "divergence of the Chaplygin sleigh",
            command: "eval chaplygin_sleigh --set m=1.5 --set I=0.4 --set a=0.5",
            input: r#"[{"q": [0, 0, 0], "qdot": [1.5, 0, 0.75]}]"#,
            how: "right: divergence_mu_C; printed: density_form_theta . qdot, times -n with n = 3",
            values: divergence,
        }),
    },
    Erratum {
        place: "[C] (5.3) to (5.10), constraint of positions",
        printed: "div = -n theta(qdot)",
        right: "div = -theta(qdot)",
        check: Some(Check {
            quantity: "divergence of the bead on ellipses",
            command: "eval holonomic_bead_on_ellipses",
            input: r#"[{"q": [1, 0.5], "qdot": [1, -0.5]}]"#,
            how: "right: divergence_mu_C; printed: density_form_theta . qdot, times -n with n = 2",
            values: divergence,
        }),
    },
    Erratum {
        place: "[C] Theorem V.36; [CB] 8.1",
        printed: "invariant density p_theta^-3 of the sleigh",
        right: "p_theta^-1",
        check: Some(Check {
            quantity: "rate of the logarithm of the density plus divergence (0 for an invariant density)",
            command: "eval chaplygin_sleigh --set m=1.5 --set I=0.4 --set a=0.5",
            input: r#"[{"q": [0, 0, 0], "qdot": [1.5, 0, 0.75]}]"#,
            how: "k pdot_theta/p_theta + divergence_mu_C with k = -3 (printed) and k = -1 (right)",
            values: density_of_the_sleigh,
        }),
    },
    Erratum {
        place: "[C] Remark VI.38, phi component",
        printed: "R/I in the phi component of pi_D grad h of the rolling disk",
        right: "R/J",
        check: Some(Check {
            quantity: "phi component of pi_D grad h, divided by the theta component",
            command: DISK_COMMAND,
            input: DISK_STATE,
            how: "right: change of qdot by the law elastic at leading_edge, which is a multiple of pi_D grad h",
            values: turning_component,
        }),
    },
    Erratum {
        place: "[C] Remark VI.38, y component",
        printed: "h_y (1 - sin 2 phi) + h_x cos 2 phi in the y component of pi_D grad h",
        right: "h_y (1 - cos 2 phi) + h_x sin 2 phi",
        check: Some(Check {
            quantity: "y component of pi_D grad h, divided by the theta component",
            command: DISK_COMMAND,
            input: DISK_STATE,
            how: "right: change of qdot by the law elastic at leading_edge; the printed vector violates a constraint",
            values: sideways_component,
        }),
    },
    Erratum {
        place: "[C] (6.27)",
        printed: "second momentum p_theta of the rolling disk",
        right: "R p.e(phi) + p_theta, which is (I + m R^2)/I p_theta on D",
        check: Some(Check {
            quantity: "second momentum on D",
            command: DISK_COMMAND,
            input: DISK_STATE,
            how: "right: R p_x + p_theta at phi = 0; printed: p_theta",
            values: momentum_of_the_disk,
        }),
    },
    Erratum {
        place: "[C] (4.7)",
        printed: "plus sign of the centripetal term of the walker, without the length of the leg",
        right: "minus sign, with the length",
        check: Some(Check {
            quantity: "angular acceleration",
            command: "eval walker_foot_slip",
            input: r#"[{"q": [0, 0.25], "qdot": [0.75, -1.5]}]"#,
            how: "right: acceleration of theta; printed: the equation at the same state",
            values: walker,
        }),
    },
    Erratum {
        place: "[C] (4.11)",
        printed: "plus sign of the centripetal term of the dimensionless walker",
        right: "minus sign",
        check: Some(Check {
            quantity: "rate of xi",
            command: "eval dimensionless_walker --set mu=1 --set eps=2 --set alpha=0.1",
            input: r#"[{"q": [0.25, -0.75, 0.75]}]"#,
            how: "right: qdot of xi; printed: the equation at the same state",
            values: dimensionless_walker,
        }),
    },
    Erratum {
        place: "[C] Table 4.2, row 3",
        printed: "xi_3 = 1.5354, a branch of the arcsine",
        right: "xi_3 = 1.6063: the angle is obtuse",
        check: Some(Check {
            quantity: "xi_3",
            command: "simulate rimless_wheel_ten --impacts 3 --samples 0 --json -",
            input: "",
            how: "right: pi/2 - x - 2 delta_3 - alpha, with the angle x at which the foot of step3 lands",
            values: angle_of_the_wheel,
        }),
    },
    Erratum {
        place: "[C] Proposition VI.23, (6.17)",
        printed: "rate {H, P(X)} of a momentum between impacts",
        right: "{P(X), H}, with the brackets of the thesis",
        check: Some(Check {
            quantity: "rate of the vertical momentum of a falling ball",
            command: "eval bouncing_ball --set m=2 --set g=9.81",
            input: r#"[{"q": [1], "qdot": [0]}]"#,
            how: "right: pdot; printed: dH/dx = m g",
            values: falling,
        }),
    },
    Erratum {
        place: "[CB] Example 3",
        printed: "1 - x^2/(1 - x^2 - y^2) in the metric of the sphere",
        right: "1 + x^2/(1 - x^2 - y^2), and the same in y",
        check: Some(Check {
            quantity: "first entry of the metric at x = 1/4, y = 1/8",
            command: "eval sphere_in_plane --mode inside",
            input: r#"[{"q": [0.25, 0.125], "qdot": [0, 0]}]"#,
            how: "right: metric of the model; printed: the formula at the same point",
            values: metric_of_the_sphere,
        }),
    },
    listed(
        "[C] after (6.26)",
        "the equation of the second momentum of the disk off D lacks a factor",
        "with the factor dot(phi); both vanish on D",
    ),
    listed(
        "[C] (4.12)",
        "two inequalities for the angles of a rimless wheel",
        "both reversed; as printed no angle satisfies them",
    ),
    listed(
        "[C] Theorem V.35",
        "generator of the rotation of the sleigh with the opposite sign in y",
        "the derivative of the printed action, a rotation about the centre of mass",
    ),
    listed(
        "[C] Theorem VI.31, (6.18)",
        "the formula for all groups of symmetries",
        "only for groups whose orbits span the directions of D",
    ),
    listed(
        "[C] Example IX.9",
        "augmented differential -Id of the bouncing ball",
        "lower left entry -2 g/v; see docs/guide/derivatives.md",
    ),
    listed(
        "[CB] Proposition 8",
        "valid for 0 < alpha < 1",
        "valid for 0 < alpha < 2^(-1/4)",
    ),
    listed(
        "[CV] 6.2",
        "slip dot(y) - r omega_z at the wall",
        "dot(y) + r omega_z for a wall at larger x",
    ),
    listed(
        "[CV] 6.3",
        "minus signs of the dq1 and dq2 terms of Q(Upsilon)",
        "+ x r dq1 + y r dq2",
    ),
];
