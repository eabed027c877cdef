//! Section F: long runs, chaos, structure.

use core::ops::ControlFlow;

use dalembert::math::larger;
use dalembert::{Event, Observer, Segment, StateVector, System, VectorField};
use dalembert_cli::Integrator;
use dalembert_cli::suite::{Case, Report, Run, Setting};

use super::course::{Course, U};
use super::crossing::OSCILLATOR;
use super::scaling::HOPPER;
use super::tables::{RECTANGLE, SINAI, elliptic_table};
use super::text::{Model, value};

/// The cases.
pub const CASES: &[Case] = &[
    Case {
        id: "F01",
        title: "a circle billiard at 0.3 to the normal, 1e5 bounces",
        right: "bounce n at polar angle n (pi - 0.6); energy and angular momentum constant",
        bound: "ten times plain double arithmetic: 6.8e-11, 1.5e-9, 7.3e-8 at n = 1e3, 1e4, 1e5",
        run: Run::Integrators(|setting, report| circle(setting, report, 100_000)),
        ..Case::QUICK
    },
    Case {
        id: "F01b",
        title: "a circle billiard at 0.3 to the normal, 1e6 bounces",
        right: "as F01",
        bound: "5.4e-7 at n = 1e6",
        run: Run::Integrators(|setting, report| circle(setting, report, 1_000_000)),
        ..Case::NIGHTLY
    },
    Case {
        id: "F02",
        title: "an ellipse billiard with half axes 2 and 1, 1e5 bounces",
        right: "the product of the angular momenta about the foci is constant",
        bound: "1e-11",
        run: Run::Integrators(ellipse),
        ..Case::QUICK
    },
    Case {
        id: "F03",
        title: "a rectangle billiard of irrational slope, 1e5 bounces",
        right: "the position by unfolding",
        bound: "8 u t v",
        run: Run::Integrators(|setting, report| rectangle(setting, report, 100_000)),
        ..Case::QUICK
    },
    Case {
        id: "F03b",
        title: "a rectangle billiard of irrational slope, 1e6 bounces",
        right: "the position by unfolding",
        bound: "8 u t v",
        run: Run::Integrators(|setting, report| rectangle(setting, report, 1_000_000)),
        ..Case::NIGHTLY
    },
    Case {
        id: "F05",
        title: "a Sinai billiard, a square with a disk of radius 1/2",
        right: "bounces of a 200-digit run",
        bound: "ten times exact-formula double arithmetic: 1e-14, 1e-13, 8e-13 and 2e-9 at bounces 1, 3, 10, 20",
        run: Run::Integrators(sinai),
        ..Case::QUICK
    },
    Case {
        id: "F07",
        title: "a circle and an ellipse billiard, reversed at t = 150",
        right: "back at the start with the opposite velocity",
        bound: "1e3 times the error of F01 at n = 100",
        run: Run::Integrators(turned_round),
        ..Case::QUICK
    },
    Case {
        id: "F08",
        title: "error after impacts in a smooth potential, for steps halved twice",
        right: "the error falls with the order of the integrator, not with order 1",
        bound: "exponent at most 1/2 less than the order",
        run: Run::Integrators(order_across_impacts),
        ..Case::QUICK
    },
    Case {
        id: "F09",
        title: "dense output between the impacts of an oscillator",
        right: "a cosine between reflections; no interpolation across a reflection",
        bound: "ten times the largest error at ends of steps",
        run: Run::Integrators(dense_across_impacts),
        ..Case::QUICK
    },
    Case {
        id: "F11",
        title: "200 bounces off a disk in a square, by arithmetic and square roots alone, on several machines",
        right: "the same bits; with the feature `strict`, this holds for every run, see `tests/strict.rs`",
        bound: "a hash kept with the sources",
        // NOTE: without `strict`, multiplications and additions are fused in builds for machines that support it.
        pending: match cfg!(target_feature = "fma") {
            true => Some(
                "built for fused multiplication without `strict`: the bits are those of such builds",
            ),
            false => None,
        },
        run: Run::Chosen(&[Integrator::Taylor], same_bits),
        ..Case::QUICK
    },
];

/// Calls a function with the position and velocity after each impact of a planar model.
struct Bounces<'a, F> {
    system: &'a Model,
    count: u64,
    /// Receives the index of the bounce, its time, and position and velocity after it.
    see: F,
}

impl<F: FnMut(u64, f64, [f64; 2], [f64; 2])> Observer<Model> for Bounces<'_, F> {
    fn event(&mut self, event: &Event<<Model as VectorField>::State>) -> ControlFlow<()> {
        self.count += 1;
        let q = self.system.position(&event.after);
        if let Ok(v) = self.system.velocity(event.t, &event.after) {
            let pair = |values: &[f64]| [values[0], values[1]];
            (self.see)(self.count, event.t, pair(q.as_slice()), pair(v.as_slice()));
        }
        ControlFlow::Continue(())
    }
}

fn circle(setting: Setting, report: &mut Report, bounces: u64) {
    const PLAIN: [(u64, f64); 4] = [
        (1000, 6.8e-12),
        (10_000, 1.5e-10),
        (100_000, 7.3e-9),
        (1_000_000, 5.4e-8),
    ];
    let turn = core::f64::consts::PI - 0.6;
    let (vy, vx) = 0.3_f64.sin_cos();
    let (mut worst, mut marks, mut last) = (0.0_f64, Vec::new(), [0.0; 2]);
    let (mut inwards, mut squares) = (0.0_f64, 0.0_f64);
    let table = elliptic_table(1.0, 1.0);
    let mut watch = Bounces {
        system: &table,
        count: 0,
        see: |n: u64, _, [x, y]: [f64; 2], [u, v]: [f64; 2]| {
            let (sin, cos) = (n as f64 * turn).sin_cos();
            worst = larger(worst, (x - cos).hypot(y - sin));
            let gap = 1.0 - x * x - y * y;
            (inwards, squares) = (inwards + gap, squares + gap * gap);
            last = [u * u + v * v - 1.0, x * v - y * u - vy];
            if n.is_power_of_two() || PLAIN.iter().any(|(mark, _)| *mark == n) {
                marks.push([n as f64, worst]);
            }
        },
    };
    let end = Course::new(&table, &[1.0, 0.0], &[-vx, vy], 1e9)
        .impacts(bounces)
        .follow(setting, &mut watch);
    report.class(&end.outcome, "impact_budget");
    for (n, plain) in PLAIN {
        if let Some([_, error]) = marks.iter().find(|[mark, _]| *mark == n as f64) {
            report.error(format!("position at bounce {n}"), *error, 10.0 * plain);
        }
    }
    let walk = 16.0 * U * (bounces as f64).sqrt();
    report.error("energy", last[0].abs(), walk);
    report.error("angular momentum", last[1].abs(), walk);
    // Gaps of one sign would be a bias that makes angles drift.
    let lean = inwards.abs() / (bounces as f64 * squares).sqrt();
    report.error("mean gap over its root mean square", lean, 0.25);
    report.curve("position", ["bounce", "largest error"], marks);
}

/// Product of the angular momenta about the foci of the ellipse with half axes 2 and 1.
fn about_foci([x, y]: [f64; 2], [u, v]: [f64; 2]) -> f64 {
    let focus = 3.0_f64.sqrt();
    ((x - focus) * v - y * u) * ((x + focus) * v - y * u)
}

fn ellipse(setting: Setting, report: &mut Report) {
    let table = elliptic_table(2.0, 1.0);
    let (q, v) = ([0.3, 0.2], [0.6, 0.8]);
    let exact = about_foci(q, v);
    let (mut worst, mut marks) = (0.0_f64, Vec::new());
    let mut watch = Bounces {
        system: &table,
        count: 0,
        see: |n: u64, _, q, v| {
            worst = larger(worst, (about_foci(q, v) / exact - 1.0).abs());
            if n.is_power_of_two() {
                marks.push([n as f64, worst]);
            }
        },
    };
    let end = Course::new(&table, &q, &v, 1e9)
        .impacts(100_000)
        .follow(setting, &mut watch);
    report.class(&end.outcome, "impact_budget");
    report.error("relative drift", worst, 1e-11);
    report.curve(
        "product of angular momenta",
        ["bounce", "largest drift"],
        marks,
    );
}

/// Folds an unbounded coordinate into `[0, length]` by reflections at both walls.
fn folded(x: f64, length: f64) -> f64 {
    let at = x.rem_euclid(2.0 * length);
    if at > length { 2.0 * length - at } else { at }
}

fn rectangle(setting: Setting, report: &mut Report, bounces: u64) {
    let table = RECTANGLE.model();
    let [a, b] = ["a", "b"].map(|name| value(&table, name));
    let (q, v) = ([0.3, 0.2], [1.0, 2.0_f64.sqrt()]);
    let (mut worst, mut marks) = (0.0_f64, Vec::new());
    let mut watch = Bounces {
        system: &table,
        count: 0,
        see: |n: u64, t: f64, [x, y]: [f64; 2], _| {
            let apart = (x - folded(q[0] + v[0] * t, a)).hypot(y - folded(q[1] + v[1] * t, b));
            let share = apart / (8.0 * U * t * v[0].hypot(v[1]) + 8.0 * U);
            worst = larger(worst, share);
            if n.is_power_of_two() {
                marks.push([n as f64, apart]);
            }
        },
    };
    let end = Course::new(&table, &q, &v, 1e9)
        .impacts(bounces)
        .follow(setting, &mut watch);
    report.class(&end.outcome, "impact_budget");
    report.error("worst position over its bound", worst, 1.0);
    report.curve("position", ["bounce", "error"], marks);
}

/// A chaotic run, in which a difference of one bit changes all later states. The hash is the 64-bit hash of Fowler,
/// Noll and Vo.
fn same_bits(setting: Setting, report: &mut Report) {
    let mut hash = 0xcbf2_9ce4_8422_2325_u64;
    let table = SINAI.model();
    let mut watch = Bounces {
        system: &table,
        count: 0,
        see: |_, t: f64, q: [f64; 2], v: [f64; 2]| {
            for number in [t, q[0], q[1], v[0], v[1]] {
                for byte in number.to_bits().to_le_bytes() {
                    hash = (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
                }
            }
        },
    };
    let end = Course::new(&table, &[0.7, 0.1], &[0.6, 0.8], 1e3)
        .impacts(200)
        .follow(setting, &mut watch);
    report.class(&end.outcome, "impact_budget");
    report.equal(
        "hash of the bounces",
        format!("{hash:016x}"),
        String::from("12ee64bb06d5280f"),
    );
}

fn sinai(setting: Setting, report: &mut Report) {
    let end = Course::new(&SINAI.model(), &[0.7, 0.1], &[0.6, 0.8], 1e3)
        .impacts(45)
        .run(setting);
    report.class(&end.outcome, "impact_budget");
    report.equal("bounces", end.hits.len(), 45);
    let plain = |n: usize| match n {
        1 => 1e-14,
        3 => 1e-13,
        10 => 8e-13,
        _ => 2e-9,
    };
    let times = [
        (1, 0.5),
        (3, 1.810_102_051_443_364_3),
        (10, 9.415_429_786_165_796),
        (20, 17.885_708_026_778_517),
    ];
    let places = [
        (1, 0, 1.0),
        (1, 1, 0.5),
        (3, 0, 0.213_938_769_133_981_5),
        (3, 1, 0.451_918_358_845_308_4),
        (10, 0, -0.176_261_309_664_186),
        (20, 1, 0.376_220_754_114_177_1),
    ];
    for (n, t) in times {
        report.near(
            format!("time of bounce {n}"),
            end.hits[n - 1].t,
            t,
            plain(n),
        );
    }
    for (n, i, x) in places {
        report.near(
            format!("place of bounce {n}"),
            end.hits[n - 1].q[i],
            x,
            plain(n),
        );
    }
}

fn turned_round(setting: Setting, report: &mut Report) {
    for ta in [1.0, 2.0] {
        let table = elliptic_table(ta, 1.0);
        let (q, v) = ([0.3, 0.2], [0.6, 0.8]);
        let there = Course::new(&table, &q, &v, 150.0).run(setting);
        let back: Vec<f64> = there.qdot.iter().map(|v| -v).collect();
        let again = Course::new(&table, &there.q, &back, 150.0).run(setting);
        report.class(&again.outcome, "done");
        report.equal("bounces", again.hits.len(), there.hits.len());
        for i in 0..2 {
            report.near(format!("q, ta = {ta}"), again.q[i], q[i], 1e-10);
            report.near(format!("v, ta = {ta}"), -again.qdot[i], v[i], 1e-10);
        }
    }
}

fn order_across_impacts(setting: Setting, report: &mut Report) {
    let system = HOPPER.model();
    let run = |step: f64| {
        let forced = Setting {
            max_step: Some(step),
            ..setting
        };
        // A tolerance that never shortens a step.
        let end = Course::new(&system, &[1.0], &[0.3], 15.0)
            .tol(1e3)
            .run(forced);
        (end.hits.len(), end.q[0])
    };
    let exact = Course::new(&system, &[1.0], &[0.3], 15.0)
        .tol(1e-14)
        .run(Setting::free(Integrator::Dop853));
    let Some(order) = setting.integrator.order() else {
        // The order depends on the tolerance, so the error is checked at several tolerances.
        for tol in [1e-6, 1e-9, 1e-12] {
            let end = Course::new(&system, &[1.0], &[0.3], 15.0)
                .tol(tol)
                .run(setting);
            report.near(
                format!("x, tolerance {tol:e}"),
                end.q[0],
                exact.q[0],
                100.0 * tol,
            );
        }
        return;
    };
    let first = if order == 5 { 0.1 } else { 0.4 };
    let points: Vec<[f64; 2]> = [1.0, 0.5, 0.25]
        .into_iter()
        .map(|share| {
            let (impacts, x) = run(share * first);
            report.equal(format!("impacts, {share}"), impacts, exact.hits.len());
            [share * first, (x - exact.q[0]).abs()]
        })
        .collect();
    let exponent = dalembert_cli::suite::exponent(&points).unwrap_or(f64::NAN);
    report.error("order lost", (order as f64 - exponent).max(0.0), 0.5);
    report.curve("error", ["step", "error"], points);
}

/// The largest errors of an oscillator at the ends of steps and between them.
struct Errors<'a> {
    system: &'a Model,
    t1: f64,
    ends: f64,
    between: f64,
}

impl Errors<'_> {
    fn first(&self, state: &<Model as VectorField>::State) -> f64 {
        self.system.position(state).as_slice()[0]
    }

    /// The error at a time. Between reflections at odd multiples of `t1`, the oscillator is at the cosine of the time
    /// since the nearest even multiple.
    fn at(&self, t: f64, x: f64) -> f64 {
        let phase = (t + self.t1).rem_euclid(2.0 * self.t1) - self.t1;
        (x - phase.cos()).abs()
    }
}

impl Observer<Model> for Errors<'_> {
    fn step(
        &mut self,
        segment: &mut Segment<'_, <Model as VectorField>::State>,
    ) -> ControlFlow<()> {
        let (start, end) = (segment.t_start(), segment.t_end());
        self.ends = self.ends.max(self.at(end, self.first(segment.end())));
        for part in 1..8 {
            let t = start + (end - start) * f64::from(part) / 8.0;
            let Ok(state) = segment.at(t) else {
                return ControlFlow::Break(());
            };
            self.between = self.between.max(self.at(t, self.first(&state)));
        }
        ControlFlow::Continue(())
    }
}

fn dense_across_impacts(setting: Setting, report: &mut Report) {
    let system = OSCILLATOR.with([("depth", 0.5)]);
    let mut errors = Errors {
        system: &system,
        t1: 2.0 * core::f64::consts::FRAC_PI_3,
        ends: 0.0,
        between: 0.0,
    };
    let end = Course::new(&system, &[1.0], &[0.0], 40.0)
        .tol(1e-8)
        .follow(setting, &mut errors);
    report.class(&end.outcome, "done");
    report.error("between ends of steps", errors.between, 10.0 * errors.ends);
}
