//! Surfaces whose impulses do not affect each other, and motions that two surfaces squeeze: planes at right angles, at any
//! angle to the axes, and walls that close. The right answers are those of balls that bounce each on its own.

use dalembert::{Impacting, Outcome, System};
use dalembert_cli::Integrator;
use dalembert_cli::suite::Setting;
use dalembert_stability::course::{Course, End, vector};
use dalembert_stability::text::{Text, set};

/// Three planes; the distances from them are those of three balls above floors, under the gravity 1.
static PLANES: Text = Text::new(
    "Planes {
        coordinates { x; y; z; }
        lagrangian = (dot(x)^2 + dot(y)^2 + dot(z)^2)/2 - (5*x + y + z)/3;
        impacts {
            a: x + 2*y + 2*z >= 0 => impact_plastic;
            b: 2*x + y - 2*z >= 0 => elastic;
            c: 2*x - 2*y + z >= 0 => newton(1/2);
        }
    }",
);

/// Two planes under the gravities 1 and 1.
static GROOVE: Text = Text::new(
    "Groove {
        coordinates { x; y; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2 - (7*x + y)/5;
        impacts {
            a: 3*x + 4*y >= 0 => impact_plastic;
            b: 4*x - 3*y >= 0 => elastic;
        }
    }",
);

/// Two planes that are hit along their edge.
static EDGE: Text = Text::new(
    "Edge {
        coordinates { x; y; z; }
        lagrangian = (dot(x)^2 + dot(y)^2 + dot(z)^2)/2;
        impacts {
            b: 2*x + y - 2*z >= 0;
            c: 2*x - 2*y + z >= 0;
        }
    }",
);

/// A body between a floor at `w*t` and a press that comes down to it with the speed `v`.
static PRESS: Text = Text::new(
    "Press {
        coordinates { x; }
        parameters { e in [0, 1] = 1/2; f in [0, 1] = 1; v = 1; w = 0; h = 1; }
        lagrangian = dot(x)^2/2;
        impacts { floor: x >= w*t => newton(f); press: x <= h - v*t => newton(e); }
    }",
);

/// The numbers of impacts on each surface.
fn counts(end: &End, surfaces: usize) -> Vec<usize> {
    let on = |surface: usize| end.hits.iter().filter(|hit| hit.surface == surface).count();
    (0..surfaces).map(on).collect()
}

#[test]
fn a_plane_that_holds_the_motion_is_not_struck_by_impulses_along_it() {
    let corner = PLANES.model();
    // a holds from 1 on, c from 3 on; b is hit at 1, 3, .., 11.
    for &integrator in Integrator::every() {
        let course = Course::new(&corner, &[5.0 / 6.0, 1.0 / 6.0, 1.0 / 6.0], &[0.0; 3], 12.0);
        let end = course
            .tol(1e-10)
            .step(1e-2)
            .resting()
            .run(Setting::free(integrator));
        let name = integrator.name();
        assert_eq!(end.outcome, Outcome::Done, "{name}");
        assert_eq!(counts(&end, 3)[..2], [1, 6], "{name}");
        for (found, right) in end.qdot.iter().zip([0.0, 0.0, 0.0]) {
            assert!((found - right).abs() < 1e-7, "{name}: {:?}", end.qdot);
        }
    }
    let groove = GROOVE.model();
    for (q, qdot, until, right) in [
        ([1.4, 0.1], [1.0 / 3.0, 0.0], 10.0, [1, 3]),
        ([0.8, -0.6], [0.0, 0.0], 200.0, [0, 71]),
    ] {
        for &integrator in Integrator::every() {
            let course = Course::new(&groove, &q, &qdot, until).tol(1e-10).step(1e-2);
            let end = course.resting().run(Setting::free(integrator));
            let name = integrator.name();
            assert_eq!(end.outcome, Outcome::Done, "{name}");
            assert_eq!(counts(&end, 2), right, "{name}");
        }
    }
}

#[test]
fn the_order_of_slow_impacts_on_planes_at_right_angles_does_not_matter() {
    let edge = EDGE.model();
    for slow in [1e-3, 1e-5, 1e-7, 1e-9] {
        // Normal velocities of -3 slow, and 30 along the edge.
        let along = [10.0, 20.0, 20.0];
        let towards = [-4.0, 1.0, 1.0];
        let qdot = [0, 1, 2].map(|i| along[i] + slow * towards[i]);
        let q = towards.map(|component| -slow * component);
        for &integrator in Integrator::every() {
            let course = Course::new(&edge, &q, &qdot, 2.0).step(1e-2);
            let end = course.run(Setting::free(integrator));
            let case = format!("{}, {slow:e}", integrator.name());
            assert_eq!(end.outcome, Outcome::Done, "{case}");
            assert_eq!(counts(&end, 2), [1, 1], "{case}");
            for i in 0..3 {
                let right = 2.0 * along[i] - slow * towards[i];
                assert!((end.q[i] - right).abs() < 1e-12, "{case}: {:?}", end.q);
            }
        }
    }
}

#[test]
fn a_squeezed_motion_ends_where_the_gap_closes() {
    let mut press = PRESS.model();
    for [e, f, v, w, h] in [
        [0.0, 1.0, 1.0, 0.0, 1.0],
        [0.02, 1.0, 1.0, 0.0, 1.0],
        [0.2, 1.0, 1.0, 0.0, 1.0],
        [0.45, 1.0, 1.0, 0.0, 1.0],
        [0.8, 1.0, 1.0, 0.0, 1.0],
        [0.5, 0.5, 0.5, 1.0, 3.0],
        [0.3, 0.1, 0.25, 0.0, 1.5],
    ] {
        for (name, value) in ["e", "f", "v", "w", "h"].iter().zip([e, f, v, w, h]) {
            set(&mut press, name, value);
        }
        let closes = h / (v + w);
        for &integrator in Integrator::every() {
            let course = Course::new(&press, &[0.5], &[3.0], 2.0 * closes)
                .tol(1e-10)
                .step(1e-2);
            let end = course.run(Setting::free(integrator));
            let t = match end.outcome {
                Outcome::Zeno { t, .. } | Outcome::Spasmodic { t, .. } => t,
                // Held by one of them until they meet.
                _ => end.t,
            };
            let case = format!("{}, {e} {f} {v} {w}", integrator.name());
            assert!((t - closes).abs() < 1e-10, "{case}: {:?}", end.outcome);
        }
    }
}

/// A pendulum beside a wall, in Cartesian coordinates.
static PENDULUM: Text = Text::new(
    "Pendulum {
        coordinates { x; y; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2 - y;
        constraints { rod: x^2 + y^2 = 1; }
        impacts { wall: x >= -1/2; }
    }",
);

#[test]
fn impacts_lie_on_their_surface_after_projection() {
    let pendulum = PENDULUM.model();
    for &integrator in Integrator::every() {
        for tol in [1e-4, 1e-7, 1e-10] {
            let course = Course::new(&pendulum, &[0.6, -0.8], &[0.0; 2], 10.0).tol(tol);
            let end = course.run(Setting::free(integrator));
            let case = format!("{}, {tol:e}", integrator.name());
            assert_eq!(end.hits.len(), 2, "{case}");
            for hit in &end.hits {
                let state = pendulum.state_unchecked(hit.t, &vector(&hit.q), &vector(&[0.0; 2]));
                let gap = pendulum.gaps(hit.t, &state.expect("a state"));
                assert!(gap.as_ref()[0].abs() < 1e-15, "{case}: {gap:?}");
                let length = hit.q[0].hypot(hit.q[1]);
                assert!((length - 1.0).abs() < 1e-13, "{case}: {length}");
            }
        }
    }
}
