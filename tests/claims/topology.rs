//! Local and global existence of densities: circles, singular configurations, conditions on parameters.

use std::f64::consts::PI;

use dalembert_codegen::claims::Global;
use dalembert_declarations::visible::{declaration, visible_system};
use dalembert_tests::divergence::{Flow, State};
use dalembert_tests::verdict::{Answer, Decided, Existence, answer};
use dalembert_tests::verified::verified;

/// A system of `reference/verdicts_visible.json`, with some of its angles replaced by coordinates on a line.
fn unwrapped(name: &str, angles: &[&str]) -> String {
    let mut source = declaration(&visible_system(name));
    for angle in angles {
        let wrapped = format!("{angle}: angle;");
        assert!(source.contains(&wrapped), "{source}");
        source = source.replace(&wrapped, &format!("{angle};"));
    }
    source
}

/// Asserts by finite differences that a density relative to `mu_C` is invariant.
fn assert_invariant(source: &str, density: &dyn Fn(&[f64]) -> f64) {
    let decided = Decided::of(source);
    let (n, m) = (
        decided.model.coordinates.len(),
        decided.model.constraints.len(),
    );
    let state = State {
        t: 0.0,
        q: (0..n).map(|i| 0.3 + 0.2 * i as f64).collect(),
        v: (0..n - m).map(|i| 0.7 - 0.4 * i as f64).collect(),
    };
    let flow = Flow::at(&decided, &state);
    assert!(flow.divergence(&state, &|_, _| 1.0).abs() > 1e-3);
    let divergence = flow.divergence(&state, &|_, state| density(&state.q));
    assert!(divergence.abs() < 1e-9, "{source}\n{divergence}");
}

#[test]
fn the_helical_circle_has_a_density_on_the_line() {
    let circle = unwrapped("helical_circle", &[]);
    assert_eq!(verified(&circle), Existence::Local);
    let decided = Decided::of(&circle);
    let Some(Global::Many { turns, period, .. }) = &decided.exactness().global else {
        panic!("{:?}", decided.exactness().global);
    };
    assert_eq!(turns, &[(0, 1)]);
    // The density is exp(-k phi), k = 1/3.
    assert!((period + 2.0 * PI / 3.0).abs() < 1e-12, "{period}");
    assert_eq!(answer(&circle, "density: locally_exact"), Answer::Proved);
    let Answer::Refuted(message) = answer(&circle, "density: exact") else {
        panic!("accepted");
    };
    assert!(message.contains("period = -2.0943951"), "{message}");
    assert!(message.contains("phi makes a turn"), "{message}");
    let line = unwrapped("helical_circle", &["phi"]);
    assert_eq!(verified(&line), Existence::Global);
    assert_invariant(&line, &|q| f64::exp(-q[0] / 3.0));
    assert_eq!(answer(&line, "density: exact"), Answer::Proved);
}

/// A wheeled robot; its centre of mass lies `a` before the axle.
fn robot(wheels: &str) -> String {
    format!(
        "Robot {{
            coordinates {{ x; y; theta: angle; psi1{wheels}; psi2{wheels}; }}
            parameters {{ m > 0 = 2; I > 0 = 3; J > 0 = 1/2; a = 3/4; b > 0 = 1; r > 0 = 1/2; }}
            lagrangian = m/2*(dot(x)^2 + dot(y)^2) + (I + m*a^2)/2*dot(theta)^2
                + a*m*dot(theta)*(-dot(x)*sin(theta) + dot(y)*cos(theta)) + J/2*(dot(psi1)^2 + dot(psi2)^2);
            constraints {{
                blade: -sin(theta)*d(x) + cos(theta)*d(y) = 0;
                right: cos(theta)*d(x) + sin(theta)*d(y) + b*d(theta) - r*d(psi1) = 0;
                left: cos(theta)*d(x) + sin(theta)*d(y) - b*d(theta) - r*d(psi2) = 0;
            }}
        }}"
    )
}

/// With the speed `v = r (psi1dot + psi2dot)/2` and `w = thetadot`, the robot moves like a sleigh:
/// `I_eff wdot = -m a v w`. Hence `div = -m a v/I_eff`, and the density is `exp(G)` with `G = kappa (psi1 + psi2)`.
#[test]
fn the_wheels_of_a_robot_decide_whether_there_is_a_density() {
    let circles = robot(": angle");
    assert_eq!(verified(&circles), Existence::Local);
    let decided = Decided::of(&circles);
    assert_eq!(
        (
            decided.exactness().local.rank,
            decided.exactness().local.extended_rank
        ),
        (4, 4)
    );
    let Some(Global::Many { turns, period, .. }) = &decided.exactness().global else {
        panic!("{:?}", decided.exactness().global);
    };
    let (m, inertia, wheel, a, b, r) = (2.0, 3.0, 0.5, 0.75, 1.0, 0.5);
    let effective: f64 = inertia + m * a * a + 2.0 * wheel * b * b / (r * r);
    let kappa = m * a * r / (2.0 * effective);
    assert_eq!(turns, &[(3, 1), (4, 1)]);
    assert!((period - 4.0 * PI * kappa).abs() < 1e-10, "{period}");
    assert_eq!(verified(&robot("")), Existence::Global);
    assert_invariant(&robot(""), &|q| f64::exp(kappa * (q[3] + q[4])));
}

/// With `dx = x dy` every density for `x != 0` is `f(C) m/|x|`, where `C` labels the leaf `x = C exp(y)` and
/// `m = 1 + x^2` is the constraint mass. The density form is the same on both sides of `x = 0`. On the leaf `x = 0` the
/// density is `exp(-y)`, which is not single-valued if `y` is an angle.
#[test]
fn densities_that_are_singular_somewhere_are_none_of_all_of_q() {
    let leaves = |y: &str| {
        format!(
            "Leaves {{ coordinates {{ x; y{y}; z; }} lagrangian = (dot(x)^2 + dot(y)^2 + dot(z)^2)/2;
                constraints {{ c: d(x) - x*d(y) = 0; }} }}"
        )
    };
    assert_eq!(verified(&leaves("")), Existence::Global);
    assert_eq!(verified(&leaves(": angle")), Existence::Local);
    // All motions converge to y = 0.
    let attracted = "Attracted { coordinates { x; y; } parameters { k > 0 = 2; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2; constraints { c: dot(y) = -k*y; } }";
    assert_eq!(verified(attracted), Existence::LocalAtLeast);
    let half = "Attracted { coordinates { x; y in (0, 9); } parameters { k > 0 = 2; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2; constraints { c: dot(y) = -k*y; } }";
    assert_eq!(verified(half), Existence::Global);
}

/// The equations of the snakeboard are not defined where its two constraint forms coincide.
#[test]
fn circles_that_leave_the_regular_domain_leave_the_question_open() {
    let snakeboard = |phi: &str| {
        format!(
            "Snakeboard {{
                coordinates {{ x; y; theta: angle; psi: angle; phi{phi}; }}
                parameters {{ m > 0 = 2; r > 0 = 1; J > 0 = 1; Jr > 0 = 1/2; Jw > 0 = 1/3; }}
                lagrangian = m/2*(dot(x)^2 + dot(y)^2) + J/2*dot(theta)^2 + Jr/2*(dot(psi) + dot(theta))^2
                    + Jw/2*((dot(phi) + dot(theta))^2 + (dot(phi) - dot(theta))^2);
                constraints {{
                    front: -sin(theta + phi)*d(x) + cos(theta + phi)*d(y) + r*cos(phi)*d(theta) = 0;
                    back: -sin(theta - phi)*d(x) + cos(theta - phi)*d(y) - r*cos(phi)*d(theta) = 0;
                }}
            }}"
        )
    };
    assert_eq!(
        verified(&snakeboard(" in (-pi/2, pi/2)")),
        Existence::Global
    );
    assert_eq!(verified(&snakeboard(": angle")), Existence::LocalAtLeast);
}

/// A particle in the plane that moves on the curves `d(x) = f d(y)`. For a function `f` of `x` without zeros, it has
/// the density `(1 + f^2)/|f|`.
fn curves(coordinates: &str, f: &str) -> String {
    format!(
        "Curves {{ coordinates {{ {coordinates} }} parameters {{ c > 0 = 3; }}
            lagrangian = (dot(x)^2 + dot(y)^2)/2; constraints {{ curve: d(x) = ({f})*d(y); }} }}"
    )
}

/// Where `f` has a simple zero, there is an attracting or repelling closed orbit, so that no density is finite there.
#[test]
fn densities_that_are_singular_somewhere_are_not_proved() {
    let exact = |x: &str, f: &str| answer(&curves(&format!("{x}; y: angle;"), f), "density: exact");
    for (x, f) in [
        ("x", "x - 5"),
        ("x", "x - 50"),
        ("x", "x^2 - 900"),
        ("x", "x^2 - 10*c"),
        ("x", "exp(x) - 30"),
        ("x", "(x^2 + 1)*(x - 3)"),
        ("x: angle", "sin(x)"),
    ] {
        let answer = exact(x, f);
        assert!(matches!(answer, Answer::Refuted(_)), "{f}: {answer:?}");
    }
    // At a double zero, the orbit neither attracts nor repels to first order.
    for (x, f) in [
        ("x", "x^2 - x/2 + 1/16"),
        ("x", "cosh(x) - 1"),
        ("x", "(x - 3)^2"),
        ("x: angle", "1 + sin(x)"),
        ("x: angle", "1 - cos(x)"),
    ] {
        let answer = exact(x, f);
        assert!(matches!(answer, Answer::Undecided(_)), "{f}: {answer:?}");
    }
    for f in ["x^2 + 1", "2 + sin(x)", "exp(x)"] {
        let found = answer(
            &curves("x; y: angle;", &f.replace("sin(x)", "cos(y)")),
            "density: exact",
        );
        assert_eq!(found, Answer::Proved, "{f}");
    }
}

/// The centre of mass is a distance `o` ahead of the contact. The density is `exp(G)` with `G = m o R/(J + m o^2) th`.
#[test]
fn a_default_does_not_hide_a_period() {
    for o in ["0", "1e-12", "0.00001", "0.1"] {
        let source = format!(
            "Disk {{ coordinates {{ x; y; th: angle; ph: angle; }}
                parameters {{ m > 0 = 1; R > 0 = 0.4; I > 0 = 0.2; J > 0 = 0.1; o = {o}; }}
                lagrangian = m/2*(dot(x + o*cos(ph))^2 + dot(y + o*sin(ph))^2)
                    + I/2*dot(th)^2 + J/2*dot(ph)^2;
                constraints {{ a: dot(x) = R*cos(ph)*dot(th); b: dot(y) = R*sin(ph)*dot(th); }} }}"
        );
        assert_eq!(
            answer(&source, "density: locally_exact"),
            Answer::Proved,
            "{o}"
        );
    }
}

/// Friction that is quadratic in the velocity. The density is `exp(G)`, and the period of `G` around the circle is an
/// integral that vanishes. A numeric value near 0 refutes nothing. It proves nothing either, unless one of the searched
/// symmetries makes the integral 0.
#[test]
fn periods_that_converge_to_zero_refute_nothing() {
    for f in [
        "cos(x + 0.3)/(1 + 9*(sin(x + 0.3) - 1/2)^2)",
        "cos(x + 0.3)/(1 + 25*(sin(x + 0.3) - 1/2)^2)",
        "cos(x + 0.3)/sqrt(1.02 + sin(x + 0.3))",
        "cos(48*x)",
        "k*cos(x + 0.3)",
    ] {
        let source = format!(
            "Ring {{ coordinates {{ x: angle; y; }} parameters {{ k > 0 = 1e8; }}
                lagrangian = (dot(x)^2 + dot(y)^2)/2; forces {{ drag: -({f})*dot(x)^2*d(x); }} }}"
        );
        let found = answer(&source, "density: exact");
        assert!(matches!(found, Answer::Undecided(_)), "{f}: {found:?}");
    }
}

/// Friction along a circle, with a coefficient that changes its sign under a reflection.
#[test]
fn periods_that_a_reflection_makes_vanish_are_proved_to() {
    for f in [
        "cos(x)/(1 + 9*(sin(x) - 1/2)^2)",
        "cos(x)/(2 + sin(x)^3)",
        "sin(x)*exp(cos(x)^3)",
        "k*cos(x)*exp(sin(x)^5)",
    ] {
        let source = format!(
            "Ring {{ coordinates {{ x: angle; y; }} parameters {{ k > 0 = 1e8; }}
                lagrangian = (dot(x)^2 + dot(y)^2)/2; forces {{ drag: -({f})*dot(x)^2*d(x); }} }}"
        );
        assert_eq!(answer(&source, "density: exact"), Answer::Proved, "{f}");
    }
}

/// Leaves that wind around two circles several times.
#[test]
fn loops_of_several_turns_are_found() {
    for form in ["d(z) = d(phi)", "d(z) = 2*d(phi)", "3*d(z) = 2*d(phi)"] {
        let source = format!(
            "Winding {{ coordinates {{ z: angle; phi: angle; x; w; }}
                lagrangian = (dot(z)^2 + dot(phi)^2 + dot(x)^2 + (dot(w) - (w + x)*dot(phi))^2)/2;
                constraints {{ winding: {form}; slope: d(w) = (w + x)*d(phi); }} }}"
        );
        assert_eq!(
            answer(&source, "density: locally_exact"),
            Answer::Proved,
            "{form}"
        );
    }
}
