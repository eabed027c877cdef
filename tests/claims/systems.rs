//! Systems beyond those of the reference file: bodies, balls, trains, particles.

use dalembert_declarations::bodies::{ball, top, train};
use dalembert_tests::divergence::{Flow, State};
use dalembert_tests::numeric::{moved, slope};
use dalembert_tests::verdict::{Decided, Existence};
use dalembert_tests::verified::verified;

#[test]
fn suslov_has_a_density_iff_the_axis_is_principal() {
    let principal = "A > 0 = 3; B > 0 = 4; C > 0 = 5;";
    let inertia = "A*b1^2 + B*b2^2 + C*b3^2";
    for axis in ["b1", "b2", "b3"] {
        assert_eq!(
            verified(&top(principal, inertia, axis)),
            Existence::Global,
            "{axis}"
        );
    }
    for axis in ["b1 + b2", "b1 - 2*b3", "b1 + 2*b2 + 2*b3"] {
        assert_eq!(
            verified(&top(principal, inertia, axis)),
            Existence::None,
            "{axis}"
        );
    }
    let round = "A > 0 = 3;";
    assert_eq!(
        verified(&top(round, "A*(b1^2 + b2^2 + b3^2)", "b1 + 2*b2 + 2*b3")),
        Existence::Global
    );
    let symmetric = "A*(b1^2 + b2^2) + C*b3^2";
    let parameters = "A > 0 = 3; C > 0 = 5;";
    assert_eq!(
        verified(&top(parameters, symmetric, "b1 + 2*b2")),
        Existence::Global
    );
    assert_eq!(
        verified(&top(parameters, symmetric, "b1 + b3")),
        Existence::None
    );
}

/// Veselova's constraint, on the angular velocity along an axis fixed in space, keeps a volume for every inertia.
#[test]
fn constraints_of_fixed_axis_in_space_keep_a_volume() {
    let parameters = "A > 0 = 3; B > 0 = 4; C > 0 = 5; D = 1/2; E = 1/3;";
    let inertia = "A*b1^2 + B*b2^2 + C*b3^2 + 2*D*b1*b2 + 2*E*b2*b3";
    for axis in ["s3", "s1", "s1 + s2"] {
        assert_eq!(
            verified(&top(parameters, inertia, axis)),
            Existence::Global,
            "{axis}"
        );
    }
}

#[test]
fn balls_on_a_plane() {
    let triaxial = "A*b1^2 + B*b2^2 + C*b3^2";
    let symmetric = "A*(b1^2 + b2^2) + C*b3^2";
    let round = "A*(b1^2 + b2^2 + b3^2)";
    let rubber = "rubber: s3 = 0;";
    // Chaplygin's sphere and the ball with equal moments of inertia, each with and without spinning.
    assert_eq!(verified(&ball("0, 0, 0", triaxial, "")), Existence::Global);
    assert_eq!(verified(&ball("0, 0, 0", round, "")), Existence::Global);
    assert_eq!(
        verified(&ball("0, 0, 0", triaxial, rubber)),
        Existence::Global
    );
    assert_eq!(verified(&ball("0, 0, 0", round, rubber)), Existence::Global);
    // Routh's sphere has its centre of mass on the axis of symmetry. Off the axis there is no density.
    assert_eq!(verified(&ball("0, 0, l", symmetric, "")), Existence::Global);
    assert_eq!(verified(&ball("l, 0, 0", symmetric, "")), Existence::None);
    assert_eq!(verified(&ball("l, 0, k", triaxial, "")), Existence::None);
}

/// Routh's sphere has the density `exp(G) = det m/sqrt(A C + m (r, I r))` with `r` from the centre of mass to the
/// contact (Chaplygin).
#[test]
fn the_density_of_routh_s_sphere_is_the_known_one() {
    let decided = Decided::of(&ball("0, 0, l", "A*(b1^2 + b2^2) + C*b3^2", ""));
    let (m, a, c, l) = (2.0, 3.0, 5.0, 0.25);
    let known = |flow: &Flow<'_>, state: &State| {
        let (sine, cosine) = state.q[3].sin_cos();
        let contact = a * sine.powi(2) + c * (cosine + l).powi(2);
        flow.geometry(state).mass_determinant / f64::sqrt(a * c + m * contact)
    };
    let state = State {
        t: 0.0,
        q: vec![0.3, -0.2, 0.7, 1.1, 0.4],
        v: vec![0.5, -0.4, 0.8],
    };
    let flow = Flow::at(&decided, &state);
    assert!(flow.divergence(&state, &|_, _| 1.0).abs() > 1e-3);
    let divergence = flow.divergence(&state, &known);
    assert!(divergence.abs() < 1e-9, "{divergence}");
    // The logarithm of the known density has the derivatives that the generator demands of every density.
    assert_eq!(decided.existence(), Existence::Global);
    for theta in [0.4, 1.1, 2.3] {
        let mut state = state.clone();
        state.q[3] = theta;
        let flow = Flow::at(&decided, &state);
        let geometry = flow.geometry(&state);
        assert_eq!((geometry.frame.len(), geometry.demands.len()), (3, 3));
        for (field, demand) in geometry.frame.iter().zip(&geometry.demands) {
            let rate = slope(&mut |s| {
                let q = moved(&state.q, s, field);
                known(&flow, &State { q, ..state.clone() }).ln()
            });
            assert!((rate - demand).abs() < 1e-9, "{rate} for {demand}");
        }
    }
}

#[test]
fn rubber_balls_off_centre() {
    let triaxial = "A*b1^2 + B*b2^2 + C*b3^2";
    let symmetric = "A*(b1^2 + b2^2) + C*b3^2";
    let rubber = "rubber: s3 = 0;";
    assert_eq!(
        verified(&ball("l, 0, 0", triaxial, rubber)),
        Existence::None
    );
    assert_eq!(
        verified(&ball("0, 0, l", symmetric, rubber)),
        Existence::Global
    );
}

#[test]
fn trains_have_no_density() {
    for count in 1..=3 {
        assert_eq!(verified(&train(count)), Existence::None, "{count}");
    }
}

/// `dz = f dx` with the flat metric.
fn particle(f: &str) -> String {
    format!(
        "Particle {{ coordinates {{ x; y; z; }} parameters {{ k = 1/3; }}
            lagrangian = (dot(x)^2 + dot(y)^2 + dot(z)^2)/2; constraints {{ c: d(z) - ({f})*d(x) = 0; }} }}"
    )
}

/// The divergence is a form in the velocities, `-f f_y dy/(1 + f^2) - ..`. It is closed for `f(y)`, including
/// Martinet's form, and for holonomic constraints.
#[test]
fn particles_with_one_form() {
    for f in [
        "y",
        "y^2",
        "y^3",
        "k*y^2 + y",
        "exp(k*y)",
        "sin(y)",
        "x",
        "z",
        "1/(1 + y^2)",
    ] {
        assert_eq!(verified(&particle(f)), Existence::Global, "{f}");
    }
    for f in ["x + y", "x*y", "y*z", "y + z", "y^2 + x", "sin(y) + k*x"] {
        assert_eq!(verified(&particle(f)), Existence::None, "{f}");
    }
}

#[test]
fn contact_forms_on_five_dimensions() {
    let contact = |metric: &str, form: &str| {
        format!(
            "Contact {{ coordinates {{ x1; y1; x2; y2; z; }} parameters {{ k > 0 = 3; a = 1/2; }}
                lagrangian = ({metric})/2; constraints {{ c: d(z) - {form} = 0; }} }}"
        )
    };
    let flat = "dot(x1)^2 + dot(y1)^2 + dot(x2)^2 + dot(y2)^2 + dot(z)^2";
    let squeezed =
        "k*dot(x1)^2 + dot(y1)^2 + dot(x2)^2 + 2*dot(y2)^2 + dot(z)^2 + a*dot(x1)*dot(y2)";
    let symmetric = "(y1*d(x1) - x1*d(y1) + y2*d(x2) - x2*d(y2))";
    let gauge = "(y1*d(x1) + y2*d(x2))";
    assert_eq!(verified(&contact(flat, symmetric)), Existence::Global);
    assert_eq!(verified(&contact(flat, gauge)), Existence::Global);
    assert_eq!(verified(&contact(squeezed, gauge)), Existence::None);
}

/// Left-invariant metrics on the group of motions of the plane. Right-invariant constraints keep a volume, these
/// left-invariant ones do not.
#[test]
fn motions_of_the_plane() {
    let motions = |constraint: &str| {
        format!(
            "Motions {{ coordinates {{ x; y; theta: angle; }}
                parameters {{ a > 0 = 2; b > 0 = 3; I > 0 = 1; c = 1/4; e = 1/5; }}
                let u = cos(theta)*dot(x) + sin(theta)*dot(y);
                let v = -sin(theta)*dot(x) + cos(theta)*dot(y);
                lagrangian = (a*u^2 + b*v^2 + I*dot(theta)^2)/2 + c*u*dot(theta) + e*v*dot(theta);
                constraints {{ c: {constraint} = 0; }} }}"
        )
    };
    for right in [
        "dot(x) + y*dot(theta)",
        "dot(y) - x*dot(theta)",
        "dot(theta)",
    ] {
        assert_eq!(verified(&motions(right)), Existence::Global, "{right}");
    }
    for left in ["v", "u", "u + v", "v - dot(theta)"] {
        assert_eq!(verified(&motions(left)), Existence::None, "{left}");
    }
}

/// D is integrable, so that the density is sought on every leaf.
#[test]
fn integrable_constraints_have_a_density() {
    let surfaces = "Surfaces { coordinates { x; y; z; }
        lagrangian = (dot(x)^2 + dot(y)^2 + dot(z)^2)/2;
        constraints { c: (2 + x^2)*(d(z) - y*d(x) - x*d(y)) = 0; } }";
    assert_eq!(verified(surfaces), Existence::Global);
    let bead = "Bead { coordinates { x; y; } parameters { k > 0 = 3; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2; constraints { c: d(x^2 + k*y^2) = 0; } }";
    assert_eq!(verified(bead), Existence::Global);
    let sphere = "Sphere { coordinates { x; y; z; } parameters { k > 0 = 3; }
        lagrangian = (dot(x)^2 + dot(y)^2 + dot(z)^2)/2 - z;
        constraints { c: x*d(x) + y*d(y) + z*d(z) = 0; } }";
    assert_eq!(verified(sphere), Existence::Global);
}

/// Two linear combinations of holonomic constraints. The determinant of their matrix `F` is not part of the
/// declaration. The density is `exp(G)` with `G = ln det m - ln det F`.
#[test]
fn mixed_forms_need_the_determinant_of_their_dependent_columns() {
    let pair = "Pair { coordinates { x; y; z; w; }
        lagrangian = (dot(x)^2 + dot(y)^2 + dot(z)^2 + dot(w)^2)/2;
        constraints {
            first: (2 + x^2*y^2)*(d(z) - x*d(x)) + (1 + y^2)*(d(w) - y*d(y)) = 0;
            second: -x^2*(d(z) - x*d(x)) + (3 + x^4)*(d(w) - y*d(y)) = 0;
        }
    }";
    assert_eq!(verified(pair), Existence::Global);
    let decided = Decided::of(pair);
    let potential = decided.potential().expect("a closed form");
    assert!(potential.contains("ln|det A_dep|"), "{potential}");
}

/// Without constraints the volume of phase space is kept, for every metric.
#[test]
fn free_systems_keep_the_volume_of_phase_space() {
    let free = "Free { coordinates { x; y; theta: angle; } parameters { k > 0 = 3; }
        lagrangian = (1 + x^2)*dot(x)^2/2 + (2 + sin(theta))*dot(y)^2 + x*dot(x)*dot(theta)/3 + dot(theta)^2 - k*x*y; }";
    assert_eq!(verified(free), Existence::Global);
}
