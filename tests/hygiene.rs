//! Generated code compiles with awkward names of the user and in hostile surroundings.

/// Names that generated functions use, names that differ only in case, and Greek names.
mod names {
    dalembert::model! {
        pub Awkward {
            coordinates { state; rate; q; p; qdot; forms; X; x; excess[2]: angle; φ: angle; v1; }
            parameters { values > 0 = 1; report[2] > 0 = [1, 2]; M > 0 = 2; }
            lagrangian = values/2*(dot(state)^2 + dot(rate)^2 + dot(q)^2 + dot(p)^2 + dot(qdot)^2 + dot(forms)^2)
                + M/2*(dot(X)^2 + dot(x)^2 + dot(v1)^2) + report[2]/2*(dot(excess[1])^2 + dot(excess[2])^2 + dot(φ)^2)
                - report[1]*cos(excess[1] - φ)*state;
            constraints {
                surface: d(X) - state*d(x) = 0;
                affine: d(q) - rate*d(p) - sin(φ)*d(t) = 0;
            }
            impacts { direction: qdot >= 0; size: X + 1 >= 0 => newton(1/2); }
            outputs { x_dot: dot(x); energy_: energy; lambda: multiplier(affine); }
            view { path: (q, p); region: 1 - q^2 - p^2 >= 0; }
        }
    }
}

/// Items that shadow those that generated code relies on, and constants with the names of its local variables.
#[allow(dead_code, non_upper_case_globals, clippy::upper_case_acronyms)]
mod surroundings {
    struct Option;
    struct Result;
    struct Some;
    struct Ok;
    struct Default;
    const x: f64 = 1.0;
    const q: usize = 0;
    const state: usize = 0;
    use shadowed::coordinate::{phi, y};
    use shadowed::surface::floor;
    const M: f64 = 2.0;
    fn components() {}

    /// Indices of the model that the module imports.
    pub fn places() -> [usize; 3] {
        [y, phi, floor]
    }

    dalembert::model! {
        pub(crate) Shadowed {
            coordinates { y; L; phi: angle; }
            parameters { m > 0 = 1; }
            lagrangian = m/2*(dot(y)^2 + dot(L)^2 + dot(phi)^2) - y*cos(phi);
            constraints { slide: d(L) - y*d(y) = 0; }
            impacts { floor: y >= 0; }
        }
    }
}

/// Only `dalembert` and `core` are in scope.
mod bare {
    #![no_implicit_prelude]

    ::dalembert::model! {
        pub Bare {
            coordinates { y; theta in (0, pi); }
            parameters { m > 0 = 1; g; }
            lagrangian = m/2*(dot(y)^2 + dot(theta)^2) - m*g*y;
            forces { drag: -dot(y)*d(y); }
            impacts { floor: y >= 0 when theta > 1 => restitution(1/2); }
            initial { y = m; theta = 1; until = m + 1; }
        }
    }
}

/// Members of families in any order, with other entries between them.
mod families {
    dalembert::model! {
        pub Scattered {
            coordinates { x; y; z; u; v; w; }
            lagrangian = (dot(x)^2 + dot(y)^2 + dot(z)^2 + dot(u)^2 + dot(v)^2 + dot(w)^2)/2;
            constraints { roll[2]: d(u) - y*d(x) = 0; hold: d(v) = z*d(x); roll[1]: d(w) = x*d(z); }
            impacts { side[2]: x <= 3; floor: y >= 2; side[1]: x >= -1; top[i in 1..=2]: z <= 10*i; side[3]: x + z <= 5; }
            outputs { o[1]: x; p: y; o[2]: z; }
        }
    }
}

/// A model inside a function.
fn local() -> f64 {
    dalembert::model! {
        Local {
            coordinates { x; }
            parameters { m > 0 = 3; }
            lagrangian = m/2*dot(x)^2;
        }
    }
    Local::default().m
}

#[test]
fn awkward_names_mean_what_was_declared() {
    use dalembert::{Described, Impacting, System};
    use names::{Awkward, awkward};
    let system = Awkward::default();
    let mut q = <Awkward as System>::Vector::zeros();
    q[awkward::coordinate::state] = 0.25;
    q[awkward::coordinate::qdot] = 0.75;
    let state = system
        .state_projected(0.0, &q, &<Awkward as System>::Vector::repeat(0.5))
        .expect("a state");
    assert_eq!(system.gaps(0.0, &state)[awkward::surface::direction], 0.75);
    assert_eq!(
        Awkward::DESCRIPTION.coordinates[awkward::coordinate::excess[1]].name,
        "excess.2"
    );
    assert_eq!(system.report, [1.0, 2.0]);
    let qdot = system.velocity(0.0, &state).expect("a velocity");
    let expected = 0.25 * qdot[awkward::coordinate::x];
    assert!((qdot[awkward::coordinate::X] - expected).abs() < 1e-15);
}

#[test]
fn models_compile_in_hostile_surroundings() {
    use dalembert::{Described, Instance, System};
    assert_eq!(local(), 3.0);
    assert_eq!(surroundings::Shadowed::DESCRIPTION.name, "shadowed");
    assert_eq!(surroundings::places(), [0, 2, 0]);
    // A model with a parameter without default has no `Default`, and is refused until the parameter is set.
    let mut bare = bare::Bare::with_defaults();
    assert!(bare.check_parameters().is_err());
    bare.g = 9.81;
    assert_eq!(bare.check_parameters(), Ok(()));
    assert_eq!(bare.initial().until, Some(2.0));
}

#[test]
fn the_indices_of_a_family_are_in_the_order_of_its_members() {
    use dalembert::{Described, Impacting, System};
    use families::{Scattered, scattered};
    let described = Scattered::DESCRIPTION;
    let names = |indices: &[usize]| {
        indices
            .iter()
            .map(|s| described.surfaces[*s].name)
            .collect::<Vec<_>>()
    };
    assert_eq!(
        names(&scattered::surface::side),
        ["side.1", "side.2", "side.3"]
    );
    assert_eq!(names(&scattered::surface::top), ["top.1", "top.2"]);
    assert_eq!(names(&[scattered::surface::floor]), ["floor"]);
    let constraints = scattered::constraint::roll.map(|a| described.constraints[a].name);
    assert_eq!(constraints, ["roll.1", "roll.2"]);
    assert_eq!(
        scattered::output::o.map(|o| described.outputs[o]),
        ["o.1", "o.2"]
    );
    let system = Scattered {};
    let q = [0.5, 4.0, 1.0, 0.0, 0.0, 0.0].into();
    let state = system
        .state_unchecked(0.0, &q, &[0.0; 6].into())
        .expect("a state");
    let gaps = system.gaps(0.0, &state);
    assert_eq!(scattered::surface::side.map(|s| gaps[s]), [1.5, 2.5, 3.5]);
}
