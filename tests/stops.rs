//! The law `stop`: surfaces at which a run ends.

use dalembert::{Law, Outcome};
use dalembert_cli::Integrator;
use dalembert_cli::suite::Setting;
use dalembert_stability::course::{Course, End};
use dalembert_stability::text::{Model, Text};

/// A particle under gravity between a floor and a ceiling, which end its motion, and a wall.
static THROWN: Text = Text::new(
    "Thrown {
        coordinates { x; y; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2 - y;
        impacts { wall: x <= 1; floor: y >= 0 => stop; ceiling: y <= 2 => stop; }
    }",
);

/// A first-order system that leaves a strip.
static GROWING: Text = Text::new(
    "Growing {
        coordinates { x; }
        field { dot(x) = x; }
        impacts { edge: x <= 2 => stop; }
    }",
);

/// A hopper whose motion ends at the bottom of a hole, the second mode.
static HOPPER: Text = Text::new(
    "Hopper {
        coordinates { x; y; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2 - y;
        modes {
            road { impacts { ground: y >= 0; } }
            hole { impacts { bottom: y >= -1 => stop; } }
        }
        transitions { edge: road -> hole when x >= 1; }
    }",
);

/// A particle of constant speed: a constraint that is not linear in the velocities.
static BENDING: Text = Text::new(
    "Bending {
        coordinates { x; y; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2 - x;
        constraints { speed: dot(x)^2 + dot(y)^2 = 1; }
        impacts { edge: y <= 1 => stop; }
    }",
);

/// Passes the end of a run with each of these integrators, and the name of the integrator, to `check`.
fn each(
    model: &Model,
    [q, qdot]: [&[f64]; 2],
    integrators: &[Integrator],
    check: impl Fn(&str, &End),
) {
    for &integrator in integrators {
        let course = Course::new(model, q, qdot, 10.0).tol(1e-13);
        let course = match integrator.is_adaptive() {
            true => course,
            false => course.step(1e-3),
        };
        check(integrator.name(), &course.run(Setting::free(integrator)));
    }
}

const ADAPTIVE: [Integrator; 3] = [Integrator::Dop853, Integrator::Dopri5, Integrator::Taylor];

#[track_caller]
fn assert_stopped(name: &str, end: &End, surface: usize, t: f64) {
    let graze = false;
    assert_eq!(end.outcome, Outcome::StoppedAt { surface, graze }, "{name}");
    assert!((end.t - t).abs() < 1e-6, "{name}: {} instead of {t}", end.t);
}

#[test]
fn the_run_ends_where_the_surface_is_reached() {
    let start = [&[0.0, 1.0][..], &[0.0, 1.0]];
    each(&THROWN.model(), start, Integrator::every(), |name, end| {
        let root = 3.0_f64.sqrt();
        assert_stopped(name, end, 1, 1.0 + root);
        assert!(end.hits.is_empty(), "{name}");
        assert!(end.q[1].abs() < 1e-12, "{name}: {:?}", end.q);
        // The state is the one at arrival.
        assert!((end.qdot[1] + root).abs() < 1e-6, "{name}: {:?}", end.qdot);
    });
}

#[test]
fn impacts_before_it_are_carried_out() {
    let start = [&[0.0, 1.0][..], &[2.0, 1.0]];
    each(&THROWN.model(), start, &ADAPTIVE, |name, end| {
        assert_stopped(name, end, 1, 1.0 + 3.0_f64.sqrt());
        assert_eq!(end.hits.len(), 1, "{name}");
    });
}

#[test]
fn it_comes_before_surfaces_that_are_reached_at_the_same_time() {
    // The particle falls from 3/2 with the speed 1 and reaches the corner of wall and floor at the time 1.
    let start = [&[0.0, 1.5][..], &[1.0, -1.0]];
    each(&THROWN.model(), start, &ADAPTIVE, |name, end| {
        assert_stopped(name, end, 1, 1.0);
        assert!(end.hits.is_empty(), "{name}");
        assert!(end.qdot[0] > 0.0, "{name}");
    });
}

#[test]
fn a_motion_that_turns_before_it_goes_on() {
    let speed = |height: f64| (2.0 * (height - 1.0)).sqrt();
    let model = THROWN.model();
    let over = [&[0.0, 1.0][..], &[0.0, speed(2.0 + 1e-9)]];
    each(&model, over, &ADAPTIVE, |name, end| {
        let rest = (2.0e-9_f64).sqrt();
        assert_stopped(name, end, 2, speed(2.0 + 1e-9) - rest);
    });
    let below = [&[0.0, 1.0][..], &[0.0, speed(2.0 - 1e-9)]];
    each(&model, below, &ADAPTIVE, |name, end| {
        assert_stopped(name, end, 1, speed(2.0 - 1e-9) + 2.0 - 0.5e-9);
    });
}

#[test]
fn a_motion_that_touches_it_within_rounding_ends_there_with_a_remark_or_goes_on() {
    let start = [&[0.0, 1.0][..], &[0.0, 2.0_f64.sqrt()]];
    each(&THROWN.model(), start, &ADAPTIVE, |name, end| {
        match end.outcome {
            Outcome::StoppedAt { surface: 2, graze } => assert!(graze, "{name}"),
            _ => assert_stopped(name, end, 1, 2.0_f64.sqrt() + 2.0),
        }
    });
}

#[test]
fn a_start_that_presses_into_it_ends_at_once() {
    let start = [&[0.0, 0.0][..], &[0.25, 0.0]];
    each(&THROWN.model(), start, Integrator::every(), |name, end| {
        let is_stopped = matches!(end.outcome, Outcome::StoppedAt { surface: 1, .. });
        assert!(is_stopped && end.t == 0.0, "{name}: {:?}", end.outcome);
    });
}

#[test]
fn the_law_may_be_chosen_and_replaced() {
    let model = THROWN.model();
    let course = || Course::new(&model, &[0.0, 1.0], &[2.0, 1.0], 10.0).tol(1e-13);
    let setting = Setting::free(Integrator::Dop853);
    let end = course().law(0, Law::Stop).run(setting);
    assert_stopped("wall", &end, 0, 0.5);
    let end = course().law(1, Law::Elastic).run(setting);
    assert_eq!(end.outcome, Outcome::Done);
    assert!(end.hits.iter().any(|hit| hit.surface == 1));
}

#[test]
fn first_order_systems_stop() {
    each(
        &GROWING.model(),
        [&[1.0], &[0.0]],
        &ADAPTIVE,
        |name, end| {
            assert_stopped(name, end, 0, 2.0_f64.ln());
        },
    );
}

#[test]
fn a_mode_has_stops_of_its_own() {
    let start = [&[0.0, 0.0][..], &[2.0, 1.0]];
    each(&HOPPER.model(), start, &ADAPTIVE, |name, end| {
        // The hopper passes the edge in flight at the time 1/2, and reaches -1 at the time 1 + sqrt(3).
        assert_stopped(name, end, 2, 1.0 + 3.0_f64.sqrt());
    });
}

#[test]
fn nonlinear_constraints_need_no_impulse_there() {
    // The direction starts at 30 degrees from y and bends towards -x. The particle reaches y = 1.
    let start = [&[0.0, 0.0][..], &[0.5, 0.75_f64.sqrt()]];
    each(&BENDING.model(), start, &ADAPTIVE, |name, end| {
        assert!(
            matches!(end.outcome, Outcome::StoppedAt { surface: 0, .. }),
            "{name}: {:?}",
            end.outcome
        );
        assert!((end.q[1] - 1.0).abs() < 1e-12, "{name}");
        assert!(
            (end.qdot[0].hypot(end.qdot[1]) - 1.0).abs() < 1e-11,
            "{name}"
        );
    });
}
