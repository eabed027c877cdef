//! Surfaces with a reset, which may be crossed. The reset acts once each time the gap falls through zero.
#![allow(missing_docs, clippy::unwrap_used, reason = "tests")]

use dalembert::{Dop853, Impacts, Law, Outcome, Tolerance};
use dalembert_stability::gap;
use dalembert_stability::particle::*;

/// The gap `cos(x)`, which falls through 0 at `x = pi/2 + 2 pi n`.
const WAVE: Gap = gap!(c | x, y | Numbers::cos(x), [-x.sin(), 0.0]);

/// The gap `-cos(x)`, which falls through 0 where [`WAVE`] rises.
const TROUGH: Gap = gap!(c | x, y | -Numbers::cos(x), [x.sin(), 0.0]);

#[test]
fn a_surface_with_an_empty_reset_counts_every_fall_once() {
    let point = Particle::new([0.0, 0.0], [WAVE, TROUGH]).with_reset(|_, state| state);
    let times: Vec<f64> = (0..12)
        .map(|n| core::f64::consts::PI * (f64::from(n) + 0.5))
        .collect();
    with_every_integrator(&point, at(0.0, 0.0, 1.0, 0.0), 37.0, |run, log, case| {
        assert_done(run, case);
        assert_times(log, &times, 1e-11, case);
        for (n, event) in log.iter().enumerate() {
            assert_eq!((event.surface, event.law), (n % 2, Law::Reset), "{case}");
            assert_eq!(event.before, event.after, "{case}");
        }
    });
}

#[test]
fn several_falls_in_one_step_hide_none() {
    let point = Particle::new([0.0, 0.0], [WAVE]).with_reset(|_, state| state);
    let mut log = Log::new();
    let stepper = Dop853::new(Tolerance::new(1e-6).unwrap());
    // The motion is free, so steps have the largest length from the start.
    let run = run_with(&point, stepper, at(0.0, 0.0, 40.0, 0.0), 30.0, &mut log);
    assert_eq!(run.outcome, Outcome::Done);
    assert_eq!(log.seen(), 191);
}

/// A ball is thrown up from the negative side. The gap rises through 0, but only its fall counts.
#[test]
fn below_the_surface_is_no_fault_and_a_rise_no_event() {
    let ball = Particle::new([-1.0, 0.0], [FLOOR]).with_reset(|_, state| state);
    with_every_integrator(&ball, at(-1.5, 0.0, 2.0, 0.0), 6.0, |run, log, case| {
        assert_done(run, case);
        assert_times(log, &[3.0], 1e-11, case);
        assert!((run.state[0] + 7.5).abs() < 1e-10, "{case}");
    });
}

#[test]
fn a_start_on_the_surface_counts_only_if_it_falls() {
    let ball = Particle::new([-1.0, 0.0], [FLOOR]).with_reset(|_, state| state);
    with_every_integrator(&ball, at(0.0, 0.0, 1.0, 0.0), 5.0, |run, log, case| {
        assert_done(run, case);
        assert_times(log, &[2.0], 1e-12, case);
    });
    with_every_integrator(&ball, at(0.0, 0.0, -1.0, 0.0), 5.0, |run, log, case| {
        assert_done(run, case);
        assert_times(log, &[0.0], 1e-12, case);
    });
}

#[test]
fn a_crossing_at_gap_rate_zero_counts() {
    let cubic = gap!(c | x, y | y - x * x * x, [-3.0 * x * x, 1.0]);
    let point = Particle::new([0.0, 0.0], [cubic]).with_reset(|_, state| state);
    with_every_integrator(&point, at(-1.0, 0.0, 1.0, 0.0), 3.0, |run, log, case| {
        assert_done(run, case);
        assert_eq!(log.seen(), 1, "{case}");
        let t = log.iter().next().unwrap().t;
        assert!((t - 1.0).abs() < 1e-4, "{case}: {t}");
    });
}

#[test]
fn a_reset_that_bounces_is_a_bounce() {
    let ball =
        Particle::new([-1.0, 0.0], [FLOOR]).with_reset(|_, s| at(s[0], s[1], -s[2], 0.5 * s[3]));
    with_every_integrator(&ball, at(0.0, 0.0, 1.0, 8.0), 7.0, |run, log, case| {
        assert_done(run, case);
        assert_times(log, &[2.0, 4.0, 6.0], 1e-11, case);
        assert_eq!(run.state[3], 1.0, "{case}");
    });
}

#[test]
fn bounces_of_a_reset_accumulate_as_others_do() {
    let ball =
        Particle::new([-1.0, 0.0], [FLOOR]).with_reset(|_, s| at(s[0], s[1], -0.5 * s[2], s[3]));
    with_every_integrator(&ball, at(0.0, 0.0, 1.0, 0.0), 7.0, |run, _, case| {
        let Outcome::Zeno { t, surface: 0 } = run.outcome else {
            panic!("{case}: {:?}", run.outcome)
        };
        assert!((t - 4.0).abs() < 1e-9, "{case}: {t}");
    });
}

/// A circle of length 1: the reset at `x = 1` moves the point to `x = 0` and counts the turn in `y`.
#[test]
fn a_position_that_is_reset_goes_on_from_there() {
    let point = Particle::new([0.0, 0.0], [CEILING])
        .with_reset(|_, s| at(s[0] - 1.0, s[1] + 1.0, s[2], s[3]));
    with_every_integrator(&point, at(0.25, 0.0, 1.0, 0.0), 10.0, |run, log, case| {
        assert_done(run, case);
        let times: Vec<f64> = (0..10).map(|n| f64::from(n) + 0.75).collect();
        assert_times(log, &times, 1e-11, case);
        assert_eq!(run.state[1], 10.0, "{case}");
    });
}

/// The reset puts the state onto the other surface, moving towards it. The other surface acts at the same time.
#[test]
fn a_reset_onto_another_surface_acts_there_too() {
    let jump = |surface: usize, s: State| match surface {
        0 => at(1.0, s[1], -s[2], s[3]),
        _ => at(s[0], s[1] + 1.0, -s[2], s[3]),
    };
    let point = Particle::new([0.0, 0.0], [FLOOR, CEILING]).with_reset(jump);
    with_every_integrator(&point, at(0.5, 0.0, -1.0, 0.0), 2.0, |run, log, case| {
        assert_done(run, case);
        let met: Vec<usize> = log.iter().map(|event| event.surface).collect();
        assert_eq!(met, [0, 1, 0, 1], "{case}");
        assert_times(log, &[0.5, 0.5, 1.5, 1.5], 1e-12, case);
    });
}

/// Two surfaces send the state to each other. Each acts once at that time, then the first is crossed.
#[test]
fn a_surface_acts_once_at_a_time() {
    let jump = |surface: usize, s: State| at(f64::from(surface == 0), s[1], -s[2], s[3]);
    let point = Particle::new([0.0, 0.0], [FLOOR, CEILING]).with_reset(jump);
    with_every_integrator(&point, at(0.5, 0.0, -1.0, 0.0), 2.0, |run, log, case| {
        assert_done(run, case);
        assert_times(log, &[0.5, 0.5], 1e-12, case);
        assert!((run.state[0] + 1.5).abs() < 1e-12, "{case}");
    });
}

#[test]
fn a_reset_into_a_wall_is_named() {
    let ball = Particle::new([-1.0, 0.0], [FLOOR, RAISED_FLOOR])
        .with_reset(|_, s| at(-1.0, s[1], s[2], s[3]));
    let effects = Impacts::declared(&ball).with_law(0, Law::Elastic);
    let run = observed(&ball, effects, (at(2.0, 0.0, 0.0, 0.0), 9.0), &mut ());
    assert!(
        matches!(run.outcome, Outcome::StartsInside { surface: 0, gap } if gap == -1.0),
        "{:?}",
        run.outcome
    );
}

#[test]
fn a_reset_that_is_not_declared_is_refused_at_the_start() {
    let ball = Particle::new([-1.0, 0.0], [FLOOR]);
    let effects = Impacts::declared(&ball).with_law(0, Law::Reset);
    let run = observed(&ball, effects, (at(1.0, 0.0, 0.0, 0.0), 9.0), &mut ());
    assert_eq!((run.outcome, run.t), (Outcome::NoReset { surface: 0 }, 0.0));
}

#[test]
fn another_law_may_stand_for_a_reset() {
    let ball = Particle::new([-1.0, 0.0], [FLOOR]).with_reset(|_, state| state);
    let effects = Impacts::declared(&ball).with_law(0, Law::Elastic);
    let mut log = Log::new();
    let run = observed(&ball, effects, (at(0.0, 0.0, 1.0, 0.0), 5.0), &mut log);
    assert_eq!((run.outcome, log.seen()), (Outcome::Done, 2));
}

#[test]
fn numbers_that_are_not_finite_end_the_run() {
    let ball =
        Particle::new([-1.0, 0.0], [FLOOR]).with_reset(|_, s| at(s[0], s[1], s[2], s[3] / 0.0));
    with_every_integrator(&ball, at(1.0, 0.0, 0.0, 1.0), 5.0, |run, log, case| {
        assert_eq!(run.outcome, Outcome::NonFinite { component: 3 }, "{case}");
        assert_eq!(log.seen(), 0, "{case}");
    });
}
