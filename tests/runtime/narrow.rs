//! Steps do not pass over forces that act in a small part of a step.
#![allow(missing_docs, clippy::unwrap_used, reason = "tests")]

use std::f64::consts::{FRAC_PI_2, PI};

use dalembert::{Outcome, Run, VectorField};
use dalembert_cli::Integrator;
use dalembert_stability::course::{Course, vector};
use dalembert_stability::text::{Model, Text};

/// A point with a unit impulse of width `s` at the time 5.3.
static STRUCK: Text = Text::new(
    "Struck {
        coordinates { x; }
        parameters { s > 0 = 0.1; }
        lagrangian = dot(x)^2/2;
        forces { blow: exp(-((t - 5.3)/s)^2)/(s*sqrt(pi))*d(x); }
    }",
);

/// A point with a potential barrier of height 1 and width `s` at `x = 2`.
static BARRIER: Text = Text::new(
    "Barrier {
        coordinates { x; }
        parameters { s > 0 = 0.1; }
        lagrangian = dot(x)^2/2 - exp(-((x - 2)/s)^2);
    }",
);

/// A point on a spring with a unit impulse of width `s` at the time 5.3.
static SPRING: Text = Text::new(
    "Spring {
        coordinates { x; }
        parameters { s > 0 = 0.01; }
        lagrangian = dot(x)^2/2 - x^2/2;
        forces { blow: exp(-((t - 5.3)/s)^2)/(s*sqrt(pi))*d(x); }
    }",
);

/// A point in a steep potential near `x = 0`.
static STEEP: Text = Text::new(
    "Steep {
        coordinates { x in (0, 100); }
        parameters { e > 0 = 1e-30; }
        lagrangian = dot(x)^2/2 - e/x^12;
    }",
);

fn run(
    model: &Model,
    integrator: Integrator,
    start: impl AsRef<[f64]>,
    until: f64,
) -> Run<<Model as VectorField>::State> {
    let course = Course::from_state(model, vector(start.as_ref()), until).tol(1e-10);
    let course = match integrator.is_adaptive() {
        true => course,
        false => course.step(until / 200.0),
    };
    course.observed(integrator, &mut ())
}

/// Position and velocity at the end, and the number of steps, by six integrators. Every run must reach its end.
fn ends(model: &Model, start: [f64; 2], until: f64) -> Vec<(Integrator, [f64; 2], u64)> {
    let integrators = [
        Integrator::Dop853,
        Integrator::Dopri5,
        Integrator::Taylor,
        Integrator::Rk4,
        Integrator::Gauss6,
        Integrator::Dla2,
    ];
    let end = |integrator: Integrator| {
        let run = run(model, integrator, start, until);
        let state = run.state.as_ref();
        assert_eq!(
            run.outcome,
            Outcome::Done,
            "{integrator:?} at {}: {:?}",
            run.t,
            run.counters
        );
        (integrator, [state[0], state[1]], run.counters.accepted)
    };
    integrators.map(end).into()
}

/// True for integrators of fixed step: they shorten a step that meets a narrow force, but do not estimate its error.
fn is_fixed(integrator: Integrator) -> bool {
    !integrator.is_adaptive()
}

#[test]
fn k05_a_unit_impulse_gives_its_velocity() {
    for s in [1.0, 0.1, 1e-2, 1e-3, 1e-4] {
        for (integrator, [_, v], steps) in ends(&STRUCK.with([("s", s)]), [0.0, 0.0], 12.0) {
            if is_fixed(integrator) && s < 0.1 {
                continue;
            }
            let allowed = if is_fixed(integrator) { 0.05 } else { 1e-7 };
            assert!(
                (v - 1.0).abs() < allowed,
                "{integrator:?}, s = {s}: {v} after {steps} steps"
            );
        }
    }
}

#[test]
fn k06_a_barrier_above_the_energy_turns_the_motion_back() {
    for s in [1.0, 0.1, 1e-2, 1e-3] {
        for (integrator, [x, v], steps) in ends(&BARRIER.with([("s", s)]), [-8.0, 1.0], 15.0) {
            if is_fixed(integrator) && s < 0.1 {
                continue;
            }
            let allowed = if is_fixed(integrator) { 0.05 } else { 1e-6 };
            assert!(
                x < 2.0 && (v + 1.0).abs() < allowed,
                "{integrator:?}, s = {s}: {x} {v} after {steps} steps"
            );
        }
    }
}

#[test]
fn a_needle_beside_other_forces_is_felt() {
    for s in [0.1, 1e-2, 1e-3] {
        let (integrator, [x, v], _) = ends(&SPRING.with([("s", s)]), [1.0, 0.0], 12.0)[0];
        // A smeared unit impulse acts with the value of its spectrum at the frequency of the spring.
        let strength = (-s * s / 4.0).exp();
        let exact = [
            12.0_f64.cos() + strength * (12.0 - 5.3_f64).sin(),
            -12.0_f64.sin() + strength * (12.0 - 5.3_f64).cos(),
        ];
        let error = (x - exact[0]).hypot(v - exact[1]);
        assert!(error < 1e-7, "{integrator:?}, s = {s}: {error:e}");
    }
}

#[test]
fn a_steep_wall_turns_the_motion_back() {
    for (integrator, [x, v], _) in ends(&STEEP.model(), [1.0, -1.0], 2.0) {
        let allowed = if is_fixed(integrator) { 0.1 } else { 1e-6 };
        assert!(
            x > 0.9 && (v - 1.0).abs() < allowed,
            "{integrator:?}: {x} {v}"
        );
    }
}

#[test]
fn smooth_forces_cost_no_steps() {
    // The blow is longer than every step. The rates along steps are checked, and no step is rejected.
    let spring = SPRING.with([("s", 2.0)]);
    assert!(spring.has_narrow_rates());
    for integrator in [Integrator::Dop853, Integrator::Dopri5, Integrator::Taylor] {
        let run = run(&spring, integrator, [1.0, 0.0], 12.0);
        assert_eq!(run.counters.rejected, 0, "{integrator:?}");
        // Without the blow the velocity is `-sin(12)`. The blow adds about `cos(12 - 5.3)/e`.
        let gained = run.state.as_ref()[1] + 12.0_f64.sin();
        assert!((0.33..0.35).contains(&gained), "{integrator:?}: {gained}");
    }
    // A narrow blow costs nothing before it acts.
    let spring = SPRING.with([("s", 1e-3)]);
    let counters = run(&spring, Integrator::Dop853, [1.0, 0.0], 4.0).counters;
    assert_eq!(counters.rejected, 0, "{counters:?}");
}

/// A pointer that turns, and a point whose rate varies with the angle by a factor of 1 + m.
static POINTER: Text = Text::new(
    "Pointer {
        coordinates { x; theta: angle; }
        parameters { m > 0 = 1; }
        field { dot(x) = 1/(1 + m*sin(theta)^2); dot(theta) = 1; }
    }",
);

/// A point with a force that depends on the angle of a pointer: `cos(theta)^n`, a bump of width about 2.4/sqrt(n).
macro_rules! striker {
    ($n:literal) => {
        concat!(
            "Striker {
                coordinates { x; theta: angle; }
                lagrangian = dot(x)^2/2 + dot(theta)^2/2;
                forces { blow: cos(theta)^",
            $n,
            "*d(x); }
            }"
        )
    };
}
static STRIKERS: [(u32, Text); 3] = [
    (20, Text::new(striker!(20))),
    (400, Text::new(striker!(400))),
    (4000, Text::new(striker!(4000))),
];

/// Forces that are narrow products of wide factors: powers of cosines, and quotients.
static PRODUCTS: [Text; 2] = [
    Text::new(
        "Bumps {
            coordinates { x; theta: angle; }
            lagrangian = dot(x)^2/2 + dot(theta)^2/2;
            let f1 = ((1 + cos(2*theta))/2)^6;
            let f2 = ((1 + cos(2*theta + 1e-9))/2)^6;
            let f3 = ((1 + cos(2*theta - 1e-9))/2)^6;
            let f4 = ((1 + cos(2*theta + 2e-9))/2)^6;
            let f5 = ((1 + cos(2*theta - 2e-9))/2)^6;
            forces { blow: (f1*f2*f3*f4*f5)^3*d(x); }
        }",
    ),
    Text::new(
        "Quotients {
            coordinates { x; theta: angle; }
            lagrangian = dot(x)^2/2 + dot(theta)^2/2;
            let f1 = 1/(1 + 2.9*sin(theta)^2);
            let f2 = 1/(1 + 2.9*sin(theta + 1e-9)^2);
            let f3 = 1/(1 + 2.9*sin(theta - 1e-9)^2);
            let f4 = 1/(1 + 2.9*sin(theta + 2e-9)^2);
            let f5 = 1/(1 + 2.9*sin(theta - 2e-9)^2);
            forces { blow: (f1*f2*f3*f4*f5)^8*d(x); }
        }",
    ),
];

/// A mode with wide rates, and one with a narrow barrier.
static ROUTE: Text = Text::new(
    "Route {
        coordinates { x; theta: angle; }
        parameters { m > 0 = 1; s > 0 = 0.1; }
        modes {
            road { lagrangian = (1 + m*sin(theta)^2)*dot(x)^2/2 + dot(theta)^2/2; }
            field { lagrangian = dot(x)^2/2 + dot(theta)^2/2 - exp(-(x/s)^2); }
        }
        transitions { off: road -> field when x >= 3; }
    }",
);

/// Without the check a step takes 12 evaluations of the rates.
#[test]
fn a_denominator_that_changes_little_costs_no_check() {
    for (m, is_checked) in [(0.5, false), (2.9, false), (3.1, true), (100.0, true)] {
        let pointer = POINTER.with([("m", m)]);
        assert_eq!(pointer.has_narrow_rates(), is_checked, "m = {m}");
        let counters = Course::from_state(&pointer, vector(&[0.0, 1.0]), 10.0)
            .tol(1e-10)
            .observed(Integrator::Dop853, &mut ())
            .counters;
        // A step that the error estimate rejects takes one evaluation less.
        let most = 12 * counters.accepted + 11 * counters.rejected + 2;
        let has_more = counters.rate_evaluations > most;
        assert_eq!(has_more, is_checked, "m = {m}: {counters:?}");
    }
}

/// Asserts that half a turn of the pointer, with the bump in the middle, gives this impulse by every adaptive
/// integrator.
fn assert_gains(text: &Text, blow: f64) {
    let model = text.model();
    assert!(model.has_narrow_rates());
    for integrator in [Integrator::Dop853, Integrator::Dopri5, Integrator::Taylor] {
        let run = run(&model, integrator, [0.0, -FRAC_PI_2, 0.0, 1.0], PI);
        let gained = run.state.as_ref()[2];
        assert!(
            (gained - blow).abs() < 1e-7,
            "{integrator:?}: {gained} instead of {blow}"
        );
    }
}

/// The integral of `cos^n` over half a turn, for even `n`.
fn bump(n: u32) -> f64 {
    (1..=n / 2).fold(PI, |product, k| product * (1.0 - 0.5 / f64::from(k)))
}

/// A high power of a cosine is a narrow bump: a long step evaluates the force only outside of it.
#[test]
fn a_blow_by_a_high_power_is_felt() {
    for (n, text) in &STRIKERS {
        assert_gains(text, bump(*n));
    }
}

#[test]
fn a_blow_by_a_product_is_felt() {
    // The midpoint rule gives the second integral to rounding error, since the integrand is periodic and smooth.
    let places = (0..1000).map(|k| PI * (f64::from(k) + 0.5) / 1000.0);
    let quotients = places.map(|angle| (1.0 + 2.9 * angle.sin().powi(2)).powi(-40));
    assert_gains(&PRODUCTS[0], bump(180));
    assert_gains(&PRODUCTS[1], quotients.sum::<f64>() * PI / 1000.0);
}

#[test]
fn one_mode_with_narrow_rates_is_enough() {
    assert!(ROUTE.model().has_narrow_rates());
}

/// A point with a unit impulse of width `s` at the time `c`.
static STRUCK_SOMETIME: Text = Text::new(
    "StruckSometime {
        coordinates { x; }
        parameters { s > 0 = 0.1; c = 1; }
        lagrangian = dot(x)^2/2;
        forces { blow: exp(-((t - c)/s)^2)/(s*sqrt(pi))*d(x); }
    }",
);

/// Some stages of Runge-Kutta methods have no weight in the result. One of them meets the impulse at some of these times.
#[test]
fn an_impulse_acts_whichever_stage_of_a_step_meets_it() {
    let adaptive = Integrator::every().iter().filter(|one| one.is_adaptive());
    for &integrator in adaptive {
        for (tol, width) in [(1e-6, 1e-2), (1e-8, 1e-4), (1e-10, 1e-3), (1e-12, 1e-4)] {
            for k in 0..64 {
                let time = 0.8 + 0.05 * f64::from(k);
                let model = STRUCK_SOMETIME.with([("s", width), ("c", time)]);
                let end = Course::new(&model, &[0.0], &[1.0], 6.0).tol(tol);
                let run = end.observed(integrator, &mut ());
                let name = integrator.name();
                assert_eq!(run.outcome, Outcome::Done);
                let speed = run.state.as_ref()[1];
                assert!((speed - 2.0).abs() < 0.05, "{name}, {tol}, {time}: {speed}");
            }
        }
    }
}

/// A force that points to `x = 0` and jumps there: motion crosses the jump with a velocity. Friction that stops the motion, and
/// a first-order system that is turned back at the jump: there the motion does not go on.
#[test]
fn a_jump_of_the_rates_is_crossed_or_ends_the_run() {
    static DRAWN: Text = Text::new(
        "Drawn {
            coordinates { x; }
            lagrangian = dot(x)^2/2;
            forces { pull: -x/abs(x)*d(x); }
        }",
    );
    static RUBBED: Text = Text::new(
        "Rubbed {
            coordinates { x; }
            lagrangian = dot(x)^2/2;
            forces { friction: -dot(x)/abs(dot(x))*d(x); }
        }",
    );
    static TURNED: Text = Text::new(
        "Turned {
            coordinates { x; }
            field { dot(x) = -x/abs(x); }
        }",
    );
    for &integrator in Integrator::every() {
        let name = integrator.name();
        // From x = 1 at rest it reaches 0 after sqrt(2), and comes back after 4 sqrt(2).
        let drawn = DRAWN.model();
        let run = Course::new(&drawn, &[1.0], &[0.0], 4.0 * 2.0_f64.sqrt());
        let run = run.step(1e-3).observed(integrator, &mut ());
        assert_eq!(run.outcome, Outcome::Done, "{name}");
        let x = run.state.as_ref()[0];
        assert!((x - 1.0).abs() < 1e-2, "{name}: {x}");
        for (text, speed) in [(&RUBBED, [1.0].as_slice()), (&TURNED, &[])] {
            let model = text.model();
            let is_for_first_order =
                integrator != Integrator::Dla2 && integrator != Integrator::Dla4;
            if speed.is_empty() && !is_for_first_order {
                continue;
            }
            let run = Course::new(&model, &[1.0], speed, 3.0).step(1e-3);
            let run = run.observed(integrator, &mut ());
            assert_ne!(run.outcome, Outcome::Done, "{name}");
            assert!(
                (run.t - 1.0).abs() < 1e-2,
                "{name}: {} at {}",
                run.outcome,
                run.t
            );
            assert!(run.counters.accepted < 5000, "{name}: {:?}", run.counters);
        }
    }
}
