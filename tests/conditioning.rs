//! Nearly dependent constraints and widely different inertias. The vector field keeps its digits because the constraint
//! mass matrix is never formed.

use dalembert::{Fault, Instance, System, VectorField};
use dalembert_models::RollingDisk;

dalembert::model! {
    /// Two forms that span the same plane for every `delta`, and nearly coincide if `delta` is small.
    pub NearlyDependent {
        coordinates { x; y; z; w; }
        parameters { delta != 0 = 1; }
        lagrangian = 1/2*(dot(x)^2 + dot(y)^2 + dot(z)^2 + dot(w)^2) - x*z;
        constraints {
            first: dot(z) - y*dot(x) = 0;
            second: dot(z) - y*dot(x) + delta*(dot(w) - x*dot(y)) = 0;
        }
    }
}

dalembert::model! {
    /// Constraints whose rank drops at y = 0.
    pub RankDrops {
        coordinates { x; y; z; }
        lagrangian = 1/2*(dot(x)^2 + dot(y)^2 + dot(z)^2);
        constraints {
            first: d(x) = 0;
            second: d(x) + y*d(z) = 0;
        }
    }
}

/// The rate at a state of `NearlyDependent` that satisfies both constraints.
fn rate(delta: f64) -> <NearlyDependent as VectorField>::State {
    let system = NearlyDependent { delta };
    let (x, y) = (0.7, -0.4);
    let qdot = [0.3, 0.9, y * 0.3, x * 0.9];
    let state = system
        .state(0.0, &[x, y, 0.2, 0.1].into(), &qdot.into())
        .expect("a state");
    let mut rate = state;
    system.rate(0.0, &state, &mut rate).expect("a rate");
    rate
}

#[test]
fn the_motion_does_not_depend_on_how_nearly_dependent_the_forms_are() {
    let reference = rate(1.0);
    for d in [1e-3, 1e-6, 1e-9] {
        let error = (rate(d) - reference).amax();
        println!("d = {d:e}: {error:.1e}");
        assert!(error <= 1e-15 / d, "d = {d:e}: {error:e}");
    }
}

#[test]
fn a_drop_in_rank_is_a_fault_that_names_the_constraint() {
    let system = RankDrops {};
    let at = |y: f64| {
        let state = system
            .state_unchecked(0.0, &[0.0, y, 0.0].into(), &[0.0, 1.0, 0.0].into())
            .expect("a state");
        let mut rate = state;
        system.rate(0.0, &state, &mut rate)
    };
    assert_eq!(at(1e-9), Ok(()));
    assert!(
        matches!(
            at(0.0),
            Err(Fault::SingularConstraint { constraint: 1, .. })
        ),
        "{:?}",
        at(0.0)
    );
}

/// The vertical disk turns and rolls at constant rates for every inertia, so that `xddot = -R roll turn sin(phi)`.
#[test]
fn the_rolling_disk_keeps_its_digits_at_every_ratio_of_inertias() {
    for kappa in [1e-16, 1e-8, 1.0, 1e8, 1e12, 1e16] {
        let disk = RollingDisk {
            m: 1.0,
            R: 1.0,
            I: 1.0 / kappa,
            J: 1.0,
            ..RollingDisk::default()
        };
        let (roll, turn, phi) = (1.5, 0.75, 0.6_f64);
        let qdot = [roll * phi.cos(), roll * phi.sin(), roll, turn];
        let state = disk
            .state(0.0, &[0.0, 0.0, 0.0, phi].into(), &qdot.into())
            .expect("a state");
        let mut rate = state;
        disk.rate(0.0, &state, &mut rate).expect("a rate");
        assert_eq!(
            rate.as_slice()[4..],
            [0.0, 0.0],
            "kappa = {kappa:e}: reduced"
        );
        let global = disk.global().expect("the global form");
        let state = global.state(0.0, &disk.position(&state), &qdot.into());
        let state = state.expect("a state");
        let mut rate = state;
        global.rate(0.0, &state, &mut rate).expect("a rate");
        let expected = [-roll * turn * phi.sin(), roll * turn * phi.cos(), 0.0, 0.0];
        let rolling = rate.as_slice()[6] / disk.I;
        let error = (rate[4] - expected[0])
            .abs()
            .max((rate[5] - expected[1]).abs());
        println!("kappa = {kappa:e}: translation {error:.1e}, roll {rolling:.1e}");
        assert!(error < 1e-14, "kappa = {kappa:e}: {error:e}");
        assert!(rolling.abs() < 1e-10, "kappa = {kappa:e}: {rolling:e}");
    }
}
