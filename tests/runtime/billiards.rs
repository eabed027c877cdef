//! Billiards with known numbers, orders and positions of impacts.
#![allow(missing_docs, clippy::unwrap_used, reason = "tests")]

use dalembert::math::larger;
use dalembert::{Event, Impacts, Observer, Outcome};
use dalembert_stability::gap;
use dalembert_stability::particle::*;

/// The distance between a point of mass 1 at `u` and a block of mass `M` at `v / sqrt(M)`, where `ROOT = sqrt(M)`. The
/// metric is the identity in `u` and `v`.
fn block<const ROOT: u64>() -> Gap {
    Gap {
        at: |[u, v]| {
            let part = 1.0 / ROOT as f64;
            (v * part - u, [-1.0, part])
        },
        along: |[u, v]| v * TaylorModel::of(1.0 / ROOT as f64) - u,
    }
}

fn count<const ROOT: u64>() -> (u64, f64) {
    let system = Particle::new([0.0, 0.0], [FLOOR, block::<ROOT>()]);
    let root = ROOT as f64;
    let mut log = Log::new();
    let end = run(&system, at(1.0, 2.0 * root, 0.0, -root), 1e4, &mut log);
    assert_done(&end, "block");
    (end.counters.impacts, end.state[3] / root)
}

#[test]
fn c11_collisions_of_block_and_wall_count_the_digits_of_pi() {
    assert_eq!(count::<1>().0, 3);
    let exact = [31, 314, 3141, 31415];
    let speeds = [
        0.998_857_595_563_118_4,
        0.999_998_559_562_977_7,
        0.999_999_917_460_530_9,
        0.999_999_999_973_092,
    ];
    let found = [
        count::<10>(),
        count::<100>(),
        count::<1000>(),
        count::<10_000>(),
    ];
    for ((found, exact), speed) in found.into_iter().zip(exact).zip(speeds) {
        assert_eq!(found.0, exact);
        assert!((found.1 - speed).abs() < 1e-9, "{} for {speed}", found.1);
    }
}

#[test]
fn c13_a_cusp_is_left_after_finitely_many_reflections() {
    let upper = gap!(c | x, y | x * x - y, [2.0 * x, -1.0]);
    let lower = gap!(c | x, y | x * x + y, [2.0 * x, 1.0]);
    let mut cusp = Particle::new([0.0, 0.0], [upper, lower]);
    cusp.active = |_, [x, _]| x > 0.0;
    for (vy, exact) in [(0.05, 5), (0.01, 14), (0.001, 73)] {
        let mut log = Log::new();
        // The point is back at x = 1 before this time.
        let end = run(&cusp, at(1.0, 0.0, -1.0, vy), 2.0, &mut log);
        assert_done(&end, "cusp");
        assert_eq!(log.seen(), exact, "{vy}");
        if vy == 0.01 {
            assert!(
                (end.state[2] - 0.984_310_707_055).abs() < 1e-9,
                "{}",
                end.state
            );
            assert!(
                (end.state[3] + 0.176_726_998_437).abs() < 1e-9,
                "{}",
                end.state
            );
        }
    }
}

#[test]
fn f01_circle_keeps_angular_momentum_and_bounces_where_it_must() {
    let circle = gap!(c | x, y | c(1.0) - x * x - y * y, [-2.0 * x, -2.0 * y]);
    struct Watch {
        bounces: f64,
        worst: f64,
        /// Largest error of the angular momentum before or after a bounce.
        momentum: f64,
    }
    const TURN: f64 = core::f64::consts::PI - 0.6;
    impl Observer<Particle> for Watch {
        fn event(&mut self, event: &Event<State>) -> core::ops::ControlFlow<()> {
            self.bounces += 1.0;
            let (y, x) = (self.bounces * TURN).sin_cos();
            self.worst = self
                .worst
                .max((event.after[0] - x).hypot(event.after[1] - y));
            for state in [event.before, event.after] {
                let momentum = state[0] * state[3] - state[1] * state[2];
                self.momentum = larger(self.momentum, (momentum - 0.3_f64.sin()).abs());
            }
            core::ops::ControlFlow::Continue(())
        }
    }
    let table = Particle::new([0.0, 0.0], [circle]);
    let mut watch = Watch {
        bounces: 0.0,
        worst: 0.0,
        momentum: 0.0,
    };
    let (vy, vx) = 0.3_f64.sin_cos();
    let effects = Impacts::declared(&table).with_budget(1000);
    let run = observed(&table, effects, (at(1.0, 0.0, -vx, vy), 1e6), &mut watch);
    assert_eq!(
        (run.outcome, watch.bounces),
        (Outcome::ImpactBudget, 1000.0)
    );
    assert!(watch.worst < 6.8e-11, "{:e}", watch.worst);
    assert!(watch.momentum < 1e-12, "{:e}", watch.momentum);
}

#[test]
fn f05_sinai_table_follows_the_reference_for_twenty_bounces() {
    let right = gap!(c | x, y | c(1.0) - x, [-1.0, 0.0]);
    let left = gap!(c | x, y | x + c(1.0), [1.0, 0.0]);
    let top = gap!(c | x, y | c(1.0) - y, [0.0, -1.0]);
    let bottom = gap!(c | x, y | y + c(1.0), [0.0, 1.0]);
    let disk = gap!(c | x, y | x * x + y * y - c(0.25), [2.0 * x, 2.0 * y]);
    let table = Particle::new([0.0, 0.0], [right, left, top, bottom, disk]);
    let mut log = Log::new();
    let end = run(&table, at(0.7, 0.1, 0.6, 0.8), 51.0, &mut log);
    assert_done(&end, "table");
    assert!(log.seen() >= 45);
    let bounce = |n: usize| log.iter().nth(n - 1).unwrap();
    assert!((bounce(1).t - 0.5).abs() < 1e-15);
    assert!((bounce(3).t - 1.810_102_051_443_364_3).abs() < 1e-14);
    assert!(
        (bounce(10).t - 9.415_429_786_165_796).abs() < 8e-13,
        "{}",
        bounce(10).t
    );
    assert!((bounce(10).after[0] + 0.176_261_309_664_186).abs() < 8e-13);
    assert!((bounce(20).t - 17.885_708_026_778_517).abs() < 2e-9);
    assert!((bounce(20).after[1] - 0.376_220_754_114_177_1).abs() < 2e-9);
}
