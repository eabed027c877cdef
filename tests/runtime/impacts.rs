//! Impacts are found at the times of closed forms, and each acts once.
#![allow(missing_docs, clippy::unwrap_used, reason = "tests")]

use dalembert::math::larger;
use dalembert::{Dop853, Impacts, Law, Outcome, Tolerance};
use dalembert_stability::gap;
use dalembert_stability::particle::*;

const U: f64 = f64::EPSILON / 2.0;

#[test]
fn a01_zero_at_the_start_is_not_reported_and_hides_nothing() {
    let ball = Particle::new([-1.0, 0.0], [FLOOR]);
    with_every_integrator(&ball, at(0.0, 0.0, 1.0, 0.0), 5.0, |run, log, case| {
        assert_done(run, case);
        assert_times(log, &[2.0, 4.0], 1e-13, case);
    });
}

#[test]
fn a02_entering_at_the_start_is_one_impact() {
    let ball = Particle::new([-1.0, 0.0], [FLOOR]);
    with_every_integrator(&ball, at(0.0, 0.0, -1.0, 0.0), 5.0, |run, log, case| {
        assert_done(run, case);
        assert_times(log, &[0.0, 2.0, 4.0], 1e-13, case);
    });
}

#[test]
fn a03_resting_is_contact_without_impacts() {
    let ball = Particle::new([-1.0, 0.0], [FLOOR]);
    with_every_integrator(&ball, at(0.0, 0.0, 0.0, 0.0), 1e6, |run, log, case| {
        assert_eq!(run.outcome, Outcome::Contact { surface: 0 }, "{case}");
        assert_eq!((run.t, log.seen()), (0.0, 0), "{case}");
    });
}

#[test]
fn a04_leaving_from_rest_is_no_event() {
    let ball = Particle::new([1.0, 0.0], [FLOOR]);
    with_every_integrator(&ball, at(0.0, 0.0, 0.0, 0.0), 2.0, |run, log, case| {
        assert_done(run, case);
        assert_eq!(log.seen(), 0, "{case}");
        // Rounding errors add up over the 2000 steps of the smallest step size.
        assert!(
            (run.state[0] - 2.0).abs() <= 1e-12,
            "{case}: {}",
            run.state[0]
        );
    });
}

/// `h'' = 2`, `h(0) = 1 - eps`, `h'(0) = -2`.
fn near_graze(eps: f64, mut check: impl FnMut(f64, &Log, &str)) {
    let ball = Particle::new([2.0, 0.0], [FLOOR]);
    with_every_integrator(
        &ball,
        at(1.0 - eps, 0.0, -2.0, 0.0),
        3.0,
        |run, log, case| {
            assert_done(run, case);
            check(run.state[0], log, case);
        },
    );
}

#[test]
fn a05_near_grazes_are_found_in_whatever_step() {
    for eps in [1e-2, 1e-4, 1e-8, 1e-12] {
        // The gap at the start is the rounded 1 - eps, which equals 1 - held.
        let held: f64 = 1.0 - (1.0 - eps);
        let root = held.sqrt();
        near_graze(eps, |end, log, case| {
            let eta = 32.0 * U * 4.0 * if case.ends_with("0.001") { 16.0 } else { 1.0 };
            assert_times(log, &[1.0 - root], 2.0 * eta / (2.0 * root), case);
            let exact = 4.0 + 8.0 * root + 3.0 * held;
            // An error eta in the gap gives an error eta / rate in the speed.
            assert!(
                (end - exact).abs() <= 4.0 * eta / root + 16.0 * eta,
                "{case}, {eps}: {end} for {exact}"
            );
        });
    }
}

#[test]
fn a06_a07_a08_grazes_within_rounding_change_nothing_visible() {
    for eps in [0.0, -1e-15, 1e-15] {
        near_graze(eps, |end, log, case| {
            let eta = 32.0 * U * 4.0 * if case.ends_with("0.001") { 64.0 } else { 1.0 };
            assert!(
                (end - 4.0).abs() <= 16.0 * eta.sqrt(),
                "{case}, {eps}: {end}"
            );
            assert!(log.seen() <= 1, "{case}, {eps}: {:?}", times(log));
            assert!(log.iter().all(|event| event.graze), "{case}, {eps}");
        });
    }
}

#[test]
fn a09_a_wall_crossed_at_rest_ends_the_run_where_it_is_crossed() {
    let cubic = gap!(c | x, y | y - x * x * x, [-3.0 * x * x, 1.0]);
    let particle = Particle::new([0.0, 0.0], [cubic]);
    with_every_integrator(&particle, at(-1.0, 0.0, 1.0, 0.0), 2.0, |run, log, case| {
        assert_eq!(
            run.outcome,
            Outcome::TangentialCrossing { surface: 0 },
            "{case}"
        );
        assert_eq!(log.seen(), 0, "{case}");
        assert!((run.t - 1.0).abs() < 1e-4, "{case}: {}", run.t);
    });
}

#[test]
fn a11_a_thin_slab_is_not_passed_at_high_speed() {
    const W: f64 = 1e-10;
    let near = gap!(c | x, y | c(1.0) - x, [-1.0, 0.0]);
    let far = gap!(c | x, y | x - c(1.0) - c(W), [1.0, 0.0]);
    let mut slab = Particle::new([0.0, 0.0], [near, far]);
    slab.active = |surface, [x, _]| (surface == 0) == (x < 1.0 + 0.5 * W);
    for speed in [1e6, 1.0] {
        let mut log = Log::new();
        let run = run(&slab, at(0.0, 0.0, speed, 0.0), 10.0 / speed, &mut log);
        assert_done(&run, "slab");
        assert_times(&log, &[1.0 / speed], 1e-14 / speed, "slab");
        assert!((run.state[0] + 8.0).abs() < 64.0 * U * 8.0);
    }
}

#[test]
fn a12_ten_thousand_impacts_in_a_channel() {
    let channel = Particle::new([0.0, 0.0], [FLOOR, CEILING]);
    struct Watch(u64, f64);
    impl dalembert::Observer<Particle> for Watch {
        fn event(&mut self, event: &dalembert::Event<State>) -> core::ops::ControlFlow<()> {
            self.0 += 1;
            self.1 = larger(self.1, (event.t - self.0 as f64 / 1e4).abs());
            core::ops::ControlFlow::Continue(())
        }
    }
    let mut watch = Watch(0, 0.0);
    let start = at(0.0, 0.0, 1e4, 0.0);
    let run = observed(
        &channel,
        Impacts::declared(&channel),
        (start, 1.0),
        &mut watch,
    );
    assert_done(&run, "channel");
    assert_eq!((watch.0, run.counters.impacts), (10_000, 10_000));
    assert!(watch.1 <= 16.0 * U, "{:e}", watch.1);
}

#[test]
fn a13_first_of_seven_crossings_of_a_corrugated_wall() {
    let wall = gap!(
        c | x,
        y | y - c(0.05) * Numbers::sin(c(200.0) * x),
        [-10.0 * (200.0 * x).cos(), 1.0]
    );
    let particle = Particle::new([0.0, 0.0], [wall]);
    for max_step in [f64::INFINITY, 0.25, 1e-3] {
        let stepper = Dop853::new(Tolerance::new(1e-10).unwrap())
            .with_max_step(max_step)
            .unwrap();
        let mut log = Log::new();
        run_with(&particle, stepper, at(0.0, 1.0, 1.0, -1.0), 1.0, &mut log);
        let first = times(&log)[0];
        assert!(
            (first - 0.950_069_023_754_718).abs() < 1e-13,
            "{max_step}: {first}"
        );
    }
}

#[test]
fn a14_nearly_flat_crossing() {
    let wall = gap!(
        c | x,
        y | y - c(1e-3) * Numbers::sin(c(1000.0) * x),
        [-(1000.0 * x).cos(), 1.0]
    );
    let particle = Particle::new([0.0, 0.0], [wall]);
    let mut log = Log::new();
    run(&particle, at(0.0, 1.0, 1.0, -1.0), 0.9997, &mut log);
    assert!((times(&log)[0] - 0.999_523_328_411_884_5).abs() < 1e-12);
}

#[test]
fn a15_a16_an_event_at_the_end_belongs_to_the_step_that_ends_there() {
    let particle = Particle::new([0.0, 0.0], [FLOOR]);
    with_every_integrator(&particle, at(1.0, 0.0, -1.0, 0.0), 1.0, |run, log, case| {
        assert_done(run, case);
        let tolerance = if case.ends_with("0.001") {
            1e-13
        } else {
            4.0 * U
        };
        if log.seen() == 0 {
            // After a thousand rounded steps the point may end more than a unit in the last place before the wall.
            assert!(case.ends_with("0.001") && run.state[0] > 0.0, "{case}");
            return;
        }
        assert_times(log, &[1.0], tolerance, case);
        let mut more = Log::new();
        let on = run_on(&particle, run.t, run.state, 2.0, &mut more);
        assert_done(&on, case);
        assert_eq!(more.seen(), 0, "{case}");
        assert!((on.state[0] - 1.0).abs() < 1e-12, "{case}");
    });
}

#[test]
fn a19_two_surfaces_in_one_step_are_taken_in_order_of_time() {
    // The gap `x = (1 - t)^2 - 0.01` of `dip` falls through 0 at t = 0.9, before `y` reaches 1.05.
    let dip = gap!(c | x, y | x, [1.0, 0.0]);
    let end = gap!(c | x, y | c(1.05) - y, [0.0, -1.0]);
    let particle = Particle::new([2.0, 0.0], [end, dip]);
    with_every_integrator(
        &particle,
        at(0.99, 0.0, -2.0, 1.0),
        1.5,
        |run, log, case| {
            assert_done(run, case);
            let surfaces: Vec<_> = log.iter().map(|event| event.surface).collect();
            assert_eq!(surfaces, [1, 0], "{case}");
            assert_times(log, &[0.9, 1.05], 1e-12, case);
        },
    );
}

#[test]
fn a20_a_pole_is_no_impact() {
    let pole = gap!(
        c | x,
        y | c(1.0) / (x - c(1.0)),
        [-1.0 / ((x - 1.0) * (x - 1.0)), 0.0]
    );
    let mut particle = Particle::new([0.0, 0.0], [pole]);
    particle.active = |_, [x, _]| x > 0.5;
    let mut log = Log::new();
    let run = run(&particle, at(3.0, 0.0, -1.1, 0.0), 2.5, &mut log);
    assert_eq!(log.seen(), 0);
    // Beyond the pole the surface counts and the gap is negative.
    assert!(
        matches!(run.outcome, Outcome::StartsInside { surface: 0, .. }),
        "{}",
        run.outcome
    );
}

#[test]
fn b01_accumulating_impacts_end_as_zeno() {
    for (surface, x) in [(FLOOR, 0.0), (RAISED_FLOOR, 1.0)] {
        for e in [0.1, 0.5, 0.9, 0.99] {
            let ball = Particle::new([-1.0, 0.0], [surface]).with_law(Law::Restitution(e));
            let exact = 2.0 / (1.0 - e);
            with_every_integrator(&ball, at(x, 0.0, 1.0, 0.0), 1e3, |run, log, case| {
                let Outcome::Zeno { t, surface: 0 } = run.outcome else {
                    panic!("{case}, e = {e}: {} at {}", run.outcome, run.t);
                };
                // At a floor away from zero, hops end at the rounding error of the gap.
                let tolerance = if x == 0.0 { 1e-10 } else { 1e-6 };
                assert!(
                    (t - exact).abs() <= tolerance * exact,
                    "{case}, e = {e}: {t} for {exact}"
                );
                let sharp = log
                    .iter()
                    .take_while(|event| x == 0.0 || event.before[2] < -1e-3);
                for (n, event) in sharp.take(10).enumerate() {
                    let exact = 2.0 * (1.0 - e.powi(n as i32 + 1)) / (1.0 - e);
                    assert!(
                        (event.t - exact).abs() <= 1e-12 * exact,
                        "{case}, e = {e}: {n}"
                    );
                }
                assert!(run.state[0] >= x - 1e-14, "{case}");
            });
        }
    }
}

#[test]
fn accumulation_by_large_factors_is_seen_before_hops_are_rounding_errors() {
    for e in [1e-3, 1e-4, 1e-6] {
        let ball = Particle::new([-1.0, 0.0], [RAISED_FLOOR]).with_law(Law::Restitution(e));
        with_every_integrator(&ball, at(1.0, 0.0, 1.0, 0.0), 1e3, |run, log, case| {
            let Outcome::Zeno { t, surface: 0 } = run.outcome else {
                panic!("{case}, e = {e}: {} at {}", run.outcome, run.t);
            };
            assert!((t - 2.0 / (1.0 - e)).abs() < 1e-9, "{case}, e = {e}: {t}");
            assert!(log.seen() <= 4, "{case}, e = {e}: {}", log.seen());
        });
    }
}

#[test]
fn b02_slow_loss_is_not_zeno_within_the_horizon() {
    let e = 1.0 - 1e-6;
    let ball = Particle::new([-1.0, 0.0], [FLOOR]).with_law(Law::Restitution(e));
    let mut log = Log::new();
    let run = run(&ball, at(0.0, 0.0, 1.0, 0.0), 1e3, &mut log);
    assert_done(&run, "ball");
    // t_n = 2 (1 - e^n) / (1 - e) <= 1000
    let count = ((1.0 - 500.0 * (1.0 - e)).ln() / e.ln()).floor();
    assert_eq!(run.counters.impacts as f64, count);
}

#[test]
fn b03_tiny_elastic_hops_are_counted() {
    let ball = Particle::new([-1.0, 0.0], [FLOOR]);
    let mut log = Log::new();
    let run = run(&ball, at(0.0, 0.0, 1e-8, 0.0), 1.00001e-3, &mut log);
    assert_done(&run, "ball");
    assert_eq!(run.counters.impacts, 50_000);
}

#[test]
fn c05_a_corner_hit_exactly_reverses_the_velocity() {
    let side = gap!(c | x, y | y, [0.0, 1.0]);
    let corner = Particle::new([0.0, 0.0], [FLOOR, side]);
    with_every_integrator(&corner, at(1.0, 1.0, -1.0, -1.0), 2.0, |run, log, case| {
        assert_done(run, case);
        assert_eq!(log.seen(), 2, "{case}");
        assert!(log.iter().all(|event| event.simultaneous), "{case}");
        assert_eq!((run.state[2], run.state[3]), (1.0, 1.0), "{case}");
    });
}

#[test]
fn c06_a_corner_missed_by_little_has_the_same_limit() {
    let side = gap!(c | x, y | y, [0.0, 1.0]);
    let corner = Particle::new([0.0, 0.0], [FLOOR, side]);
    for miss in [1e-13, 1e-16] {
        with_every_integrator(
            &corner,
            at(1.0, 1.0 + miss, -1.0, -1.0),
            2.0,
            |run, log, case| {
                assert_eq!(log.seen(), 2, "{case}");
                assert!(
                    (run.state - at(1.0, 1.0, 1.0, 1.0)).amax() <= 1e-12,
                    "{case}: {}",
                    run.state
                );
            },
        );
    }
}

#[test]
fn c20_the_impact_budget_leaves_a_usable_state() {
    let ball = Particle::new([-1.0, 0.0], [FLOOR]);
    let effects = Impacts::declared(&ball).with_budget(3);
    let mut log = Log::new();
    let run = observed(&ball, effects, (at(0.0, 0.0, 1.0, 0.0), 1e3), &mut log);
    assert_eq!((run.outcome, log.seen()), (Outcome::ImpactBudget, 3));
    assert!((run.t - 6.0).abs() < 1e-13 && (run.state[2] - 1.0).abs() < 1e-13);
}

#[test]
fn starting_inside_is_refused_as_an_outcome() {
    let ball = Particle::new([-1.0, 0.0], [FLOOR]);
    let run = run(&ball, at(-1e-9, 0.0, 1.0, 0.0), 1.0, &mut Log::new());
    assert_eq!(
        run.outcome,
        Outcome::StartsInside {
            surface: 0,
            gap: -1e-9
        }
    );
}

#[test]
fn a_wall_that_counts_by_rounding_alone_is_not_met_from_inside() {
    let ledge = gap!(c | x, y | y - c(0.7), [0.0, 1.0]);
    let mut ball = Particle::new([0.0, -1.0], [ledge, FLOOR]);
    // The ledge at y = 0.7 counts for x < 0. The wall x >= 0 counts below the height of the ledge.
    ball.active = |surface, [x, y]| if surface == 0 { x < 0.0 } else { y < 0.7 };
    for height in (0..40).map(|k| 0.8 + 0.01 * f64::from(k)) {
        let start = at(-9.0, height, 1.0, 0.0);
        with_every_integrator(&ball, start, 5.0, |run, log, case| {
            assert_done(run, case);
            assert!(log.iter().all(|event| event.surface == 0), "{case}");
            assert!(log.seen() >= 1, "{case}");
        });
    }
    // Without the ledge the ball falls below this height, where the wall begins to count.
    ball.active = |surface, [_, y]| surface == 1 && y < 0.7;
    with_every_integrator(&ball, at(-9.0, 1.0, 1.0, 0.0), 5.0, |run, _, case| {
        let Outcome::BeginsBehind { surface: 1, gap } = run.outcome else {
            panic!("{case}: {}", run.outcome)
        };
        let t = 0.6_f64.sqrt();
        assert!((run.t - t).abs() < 1e-11, "{case}: {}", run.t);
        assert!((gap - (t - 9.0)).abs() < 1e-11, "{case}: {gap}");
    });
}

#[test]
fn the_same_run_gives_the_same_bits() {
    let ball = Particle::new([-1.0, 0.3], [FLOOR]).with_law(Law::Restitution(0.9));
    let (mut first, mut second) = (Log::new(), Log::new());
    let a = run(&ball, at(1.0, 0.0, 0.1, 0.0), 10.0, &mut first);
    let b = run(&ball, at(1.0, 0.0, 0.1, 0.0), 10.0, &mut second);
    assert_eq!(a, b);
    assert!(first.iter().eq(second.iter()));
}

#[test]
fn plastic_impact_on_a_pressed_floor_is_contact() {
    let ball = Particle::new([-1.0, 0.0], [FLOOR]).with_law(Law::ImpactPlastic);
    with_every_integrator(&ball, at(0.5, 0.0, 0.0, 1.0), 10.0, |run, log, case| {
        assert_eq!(run.outcome, Outcome::Contact { surface: 0 }, "{case}");
        // An impact at the end of a step may leave a gap of a few units in the last place. The ball falls through it in
        // hops, each shorter by nine orders of magnitude.
        assert!((1..=4).contains(&log.seen()), "{case}");
        assert!((run.t - 1.0).abs() < 1e-7, "{case}: {}", run.t);
    });
}

#[test]
fn sliding_along_a_wall_is_no_impact() {
    let oblique = gap!(c | x, y | c(0.6) * x + c(0.8) * y, [0.6, 0.8]);
    let particle = Particle::new([0.0, 0.0], [oblique]);
    with_every_integrator(
        &particle,
        at(0.0, 0.0, -0.8, 0.6),
        10.0,
        |run, log, case| {
            assert_done(run, case);
            assert_eq!(log.seen(), 0, "{case}");
        },
    );
}
