//! Section F: long runs, chaos, structure.

use core::ops::ControlFlow;

use dalembert::{Event, Observer, System, VectorField};
use dalembert_cli::suite::{Case, Report, Run, Setting};

use super::course::{Course, Random, U};
use super::location::Fall;
use super::tables::{Rectangle, Sinai};
use crate::PointBilliard;

/// Why energies drift.
const BIASED: &str = "the coefficients of the Runge-Kutta tables are rounded: stages err by up to 100 u of h^2 x'', in the same \
                      direction in every flight";

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
        id: "F04",
        title: "energy of elastic balls from 32 starts over 2^12 impacts",
        right: "rounding errors that add up like a random walk",
        bound: "root mean square below 16 u sqrt(n); exponent at most 0.6",
        pending: Some(BIASED),
        run: Run::Integrators(|setting, report| energy_drift(setting, report, 12)),
        ..Case::QUICK
    },
    Case {
        id: "F04b",
        title: "energy of elastic balls from 32 starts over 2^20 impacts",
        right: "as F04",
        bound: "as F04",
        pending: Some(BIASED),
        run: Run::Integrators(|setting, report| energy_drift(setting, report, 20)),
        ..Case::NIGHTLY
    },
    Case {
        id: "F05",
        title: "a Sinai billiard, a square with a disk of radius 1/2",
        right: "bounces of a 200-digit run",
        bound: "ten times exact-formula double arithmetic: 1e-14, 8e-13 and 2e-9 at bounces 3, 10, 20",
        run: Run::Integrators(sinai),
        ..Case::QUICK
    },
    Case {
        id: "F06",
        title: "F05 with 53, 106 and 160 bits",
        right: "the horizon grows like the number of bits",
        bound: "1:2:3 within 20%",
        pending: Some("states are `f64`: there is no second type of numbers"),
        ..Case::QUICK
    },
    Case {
        id: "F07",
        title: "turned round after 100 bounces, a circle and an ellipse billiard",
        right: "back at the start with the opposite velocity",
        bound: "1e3 times the error of F01 at n = 100",
        run: Run::Integrators(turned_round),
        ..Case::QUICK
    },
    Case {
        id: "F10",
        title: "one ensemble on 1, 2 and 8 threads, in two orders",
        right: "the same bits",
        bound: "equal hashes of all last states",
        run: Run::Integrators(threads),
        ..Case::QUICK
    },
    Case {
        id: "F11",
        title: "one run on several machines with the feature `strict`",
        right: "the same bits",
        bound: "a hash kept with the sources",
        pending: Some("the feature `strict` is being built; one machine cannot tell"),
        ..Case::QUICK
    },
    Case {
        id: "F12",
        title: "two-form and volume across elastic impacts",
        right: "det = 1, J^T W J = W",
        bound: "1e-11 per 100 impacts",
        pending: Some("no first variations: differences of runs lose half the digits"),
        ..Case::QUICK
    },
    Case {
        id: "F13",
        title: "F05 over 1e6 bounces: where the point is at equal times",
        right: "uniform in area",
        bound: "chi-square of 8 x 8 cells within 5 sigma",
        run: Run::Once(uniform),
        ..Case::NIGHTLY
    },
    Case {
        id: "F14",
        title: "1e8 impacts shown to an observer that keeps a sum",
        right: "memory does not grow",
        bound: "resident size constant to 1 MiB",
        run: Run::Once(flat_memory),
        ..Case::NIGHTLY
    },
];

/// Watches impacts of a planar model through their positions and velocities after them.
struct Bounces<'a, M, F> {
    system: &'a M,
    count: u64,
    /// Number of the bounce, time, position and velocity after it.
    see: F,
}

impl<M: System, F: FnMut(u64, f64, [f64; 2], [f64; 2])> Observer<M> for Bounces<'_, M, F> {
    fn event(&mut self, event: &Event<M::State>) -> ControlFlow<()> {
        use dalembert::StateVector;
        self.count += 1;
        let q = self.system.position(&event.after);
        if let Ok(v) = self.system.velocity(event.t, &event.after) {
            let pair = |values: &[f64]| [values[0], values[1]];
            (self.see)(self.count, event.t, pair(q.as_slice()), pair(v.as_slice()));
        }
        ControlFlow::Continue(())
    }
}

const UNIT_CIRCLE: PointBilliard = PointBilliard {
    m: 1.0,
    ta: 1.0,
    tb: 1.0,
};

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
    let mut watch = Bounces {
        system: &UNIT_CIRCLE,
        count: 0,
        see: |n: u64, _, [x, y]: [f64; 2], [u, v]: [f64; 2]| {
            let (sin, cos) = (n as f64 * turn).sin_cos();
            worst = worst.max((x - cos).hypot(y - sin));
            last = [u * u + v * v - 1.0, x * v - y * u - vy];
            if n.is_power_of_two() || PLAIN.iter().any(|(mark, _)| *mark == n) {
                marks.push([n as f64, worst]);
            }
        },
    };
    let end = Course::new(&UNIT_CIRCLE, &[1.0, 0.0], &[-vx, vy], 1e9)
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
    report.curve("position", ["bounce", "largest error"], marks);
}

/// The product of the angular momenta about the foci of the ellipse with half axes 2 and 1.
fn about_foci([x, y]: [f64; 2], [u, v]: [f64; 2]) -> f64 {
    let focus = 3.0_f64.sqrt();
    ((x - focus) * v - y * u) * ((x + focus) * v - y * u)
}

fn ellipse(setting: Setting, report: &mut Report) {
    let table = PointBilliard {
        ta: 2.0,
        tb: 1.0,
        ..UNIT_CIRCLE
    };
    let (q, v) = ([0.3, 0.2], [0.6, 0.8]);
    let exact = about_foci(q, v);
    let (mut worst, mut marks) = (0.0_f64, Vec::new());
    let mut watch = Bounces {
        system: &table,
        count: 0,
        see: |n: u64, _, q, v| {
            worst = worst.max((about_foci(q, v) / exact - 1.0).abs());
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

/// Where a point in `[0, length]` is, from where it is without walls.
fn folded(x: f64, length: f64) -> f64 {
    let at = x.rem_euclid(2.0 * length);
    if at > length { 2.0 * length - at } else { at }
}

fn rectangle(setting: Setting, report: &mut Report, bounces: u64) {
    let table = Rectangle::default();
    let (q, v) = ([0.3, 0.2], [1.0, 2.0_f64.sqrt()]);
    let (mut worst, mut marks) = (0.0_f64, Vec::new());
    let mut watch = Bounces {
        system: &table,
        count: 0,
        see: |n: u64, t: f64, [x, y]: [f64; 2], _| {
            let apart =
                (x - folded(q[0] + v[0] * t, table.a)).hypot(y - folded(q[1] + v[1] * t, table.b));
            let share = apart / (8.0 * U * t * v[0].hypot(v[1]) + 8.0 * U);
            worst = worst.max(share);
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

fn energy_drift(setting: Setting, report: &mut Report, doublings: u32) {
    let mut random = Random::new(4);
    let mut squares = vec![0.0; doublings as usize + 1];
    for _ in 0..32 {
        let speed = random.between(0.5, 2.0);
        let system = Fall::default();
        let start = 0.5 * speed * speed;
        let mut watch = Energies {
            system: &system,
            start,
            count: 0,
            squares: &mut squares,
        };
        let end = Course::new(&system, &[0.0], &[speed], 1e9)
            .impacts(1 << doublings)
            .follow(setting, &mut watch);
        report.class(&end.outcome, "impact_budget");
    }
    let points: Vec<[f64; 2]> = squares
        .iter()
        .enumerate()
        .map(|(power, sum)| [2.0_f64.powi(power as i32), (sum / 32.0).sqrt()])
        .collect();
    let share = points
        .iter()
        .map(|[n, error]| error / (16.0 * U * n.sqrt()));
    report.error("worst drift over its bound", share.fold(0.0, f64::max), 1.0);
    let exponent = dalembert_cli::suite::exponent(&points[points.len() / 2..]).unwrap_or(f64::NAN);
    report.error("exponent", exponent, 0.6);
    report.curve(
        "energy",
        ["impacts", "root mean square of the relative error"],
        points,
    );
}

/// Adds up squares of relative energy errors at impacts 1, 2, 4, ..
struct Energies<'a> {
    system: &'a Fall,
    start: f64,
    count: u64,
    squares: &'a mut [f64],
}

impl Observer<Fall> for Energies<'_> {
    fn event(&mut self, event: &Event<<Fall as VectorField>::State>) -> ControlFlow<()> {
        self.count += 1;
        if self.count.is_power_of_two() {
            let energy = self
                .system
                .energy(event.t, &event.after)
                .unwrap_or(f64::NAN);
            self.squares[self.count.ilog2() as usize] += (energy / self.start - 1.0).powi(2);
        }
        ControlFlow::Continue(())
    }
}

fn sinai(setting: Setting, report: &mut Report) {
    let end = Course::new(&Sinai {}, &[0.7, 0.1], &[0.6, 0.8], 1e3)
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
    let tables = [
        UNIT_CIRCLE,
        PointBilliard {
            ta: 2.0,
            tb: 1.0,
            ..UNIT_CIRCLE
        },
    ];
    for table in tables {
        let (q, v) = ([0.3, 0.2], [0.6, 0.8]);
        let there = Course::new(&table, &q, &v, 150.0).run(setting);
        let back: Vec<f64> = there.qdot.iter().map(|v| -v).collect();
        let again = Course::new(&table, &there.q, &back, 150.0).run(setting);
        report.class(&again.outcome, "done");
        report.equal("bounces", again.hits.len(), there.hits.len());
        for i in 0..2 {
            report.near(format!("q, ta = {}", table.ta), again.q[i], q[i], 1e-10);
            report.near(format!("v, ta = {}", table.ta), -again.qdot[i], v[i], 1e-10);
        }
    }
}

/// The bits of the last states of an ensemble, made by this many threads, folded in order of the members.
fn hash(setting: Setting, threads: usize, backwards: bool) -> u64 {
    const MEMBERS: usize = 16;
    let member = |index: usize| {
        let angle = 0.1 + index as f64;
        let end =
            Course::new(&Sinai {}, &[0.7, 0.1], &[angle.cos(), angle.sin()], 50.0).run(setting);
        let bits = end.q.iter().chain(&end.qdot).map(|value| value.to_bits());
        bits.fold(0_u64, |hash, bits| hash.rotate_left(7) ^ bits)
    };
    let mut hashes = vec![0_u64; MEMBERS];
    let share = MEMBERS.div_ceil(threads);
    std::thread::scope(|scope| {
        for (block, part) in hashes.chunks_mut(share).enumerate() {
            scope.spawn(move || {
                let order: Vec<usize> = match backwards {
                    true => (0..part.len()).rev().collect(),
                    false => (0..part.len()).collect(),
                };
                for index in order {
                    part[index] = member(block * share + index);
                }
            });
        }
    });
    hashes
        .into_iter()
        .fold(0, |hash: u64, own| hash.wrapping_mul(31) ^ own)
}

fn threads(setting: Setting, report: &mut Report) {
    let one = hash(setting, 1, false);
    for threads in [2, 8] {
        report.equal(
            format!("{threads} threads"),
            hash(setting, threads, false),
            one,
        );
        report.equal(
            format!("{threads} threads, backwards"),
            hash(setting, threads, true),
            one,
        );
    }
}

/// Counts the cells a path is in at equal times.
struct Cells {
    next: f64,
    counts: [f64; 64],
}

impl Observer<Sinai> for Cells {
    fn step(
        &mut self,
        segment: &mut dalembert::Segment<'_, <Sinai as VectorField>::State>,
    ) -> ControlFlow<()> {
        while self.next <= segment.t_end() {
            let Ok(state) = segment.at(self.next) else {
                return ControlFlow::Break(());
            };
            let q = Sinai {}.position(&state);
            let cell = |x: f64| ((x + 1.0) * 4.0).clamp(0.0, 7.0) as usize;
            self.counts[8 * cell(q[0]) + cell(q[1])] += 1.0;
            self.next += 7.0;
        }
        ControlFlow::Continue(())
    }
}

fn uniform(report: &mut Report) {
    let setting = Setting::free(dalembert_cli::Integrator::Dop853);
    let mut cells = Cells {
        next: 7.0,
        counts: [0.0; 64],
    };
    let end = Course::new(&Sinai {}, &[0.7, 0.1], &[0.6, 0.8], 1e9)
        .impacts(1_000_000)
        .follow(setting, &mut cells);
    report.class(&end.outcome, "impact_budget");
    let areas = free_areas();
    let (total, area): (f64, f64) = (cells.counts.iter().sum(), areas.iter().sum());
    let used = || cells.counts.iter().zip(areas).filter(|(_, own)| *own > 0.0);
    let chi: f64 = used()
        .map(|(count, own)| (count - total * own / area).powi(2) / (total * own / area))
        .sum();
    let freedom = used().count() as f64 - 1.0;
    report.error(
        "chi-square in sigma",
        ((chi - freedom) / (2.0 * freedom).sqrt()).max(0.0),
        5.0,
    );
}

/// Area of each of 8 x 8 cells outside of the disk, by strips.
fn free_areas() -> [f64; 64] {
    const STRIPS: usize = 4000;
    let mut areas = [0.0; 64];
    for (index, area) in areas.iter_mut().enumerate() {
        let (left, low) = (index as f64 / 8.0, (index % 8) as f64);
        let (left, low) = (left.floor() / 4.0 - 1.0, low / 4.0 - 1.0);
        for strip in 0..STRIPS {
            let x = left + 0.25 * (strip as f64 + 0.5) / STRIPS as f64;
            let half = (0.25 - x * x).max(0.0).sqrt();
            let covered = (low + 0.25).min(half) - low.max(-half);
            *area += 0.25 / STRIPS as f64 * (0.25 - covered.max(0.0));
        }
        if *area < 1e-9 {
            *area = 0.0;
        }
    }
    areas
}

/// Pages of memory that the process holds, where the system says so.
fn resident_pages() -> Option<f64> {
    let text = std::fs::read_to_string("/proc/self/statm").ok()?;
    text.split_whitespace().nth(1)?.parse().ok()
}

fn flat_memory(report: &mut Report) {
    let setting = Setting::free(dalembert_cli::Integrator::Dop853);
    let run = |impacts: u64| {
        let mut sum = 0.0;
        let mut watch = Bounces {
            system: &UNIT_CIRCLE,
            count: 0,
            see: |_, t, _, _| sum += t,
        };
        Course::new(&UNIT_CIRCLE, &[1.0, 0.0], &[-0.8, 0.6], 1e12)
            .impacts(impacts)
            .follow(setting, &mut watch)
    };
    run(10_000);
    let before = resident_pages();
    let end = run(100_000_000);
    report.class(&end.outcome, "impact_budget");
    if let (Some(before), Some(after)) = (before, resident_pages()) {
        report.error("pages of 4 KiB", after - before, 256.0);
    }
}
