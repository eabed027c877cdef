//! Section F, fourth part: many runs, many points, many impacts.

use core::ops::ControlFlow;

use dalembert::{Observer, Segment, StateVector, System, VectorField};
use dalembert_cli::suite::{Case, Report, Run, Setting};
use dalembert_cli::{Exit, Integrator, Streams, run_with};

use super::course::Course;
use super::tables::{SINAI, elliptic_table};
use super::text::Model;

/// The cases.
pub const CASES: &[Case] = &[
    Case {
        id: "F10",
        title: "one ensemble on 1, 2 and 8 threads, in two orders",
        right: "the same bits",
        bound: "equal hashes of all last states",
        run: Run::Integrators(threads),
        ..Case::QUICK
    },
    Case {
        id: "F13",
        title: "F05 over 1e6 bounces: positions at equally spaced times",
        right: "uniform in area",
        bound: "chi-square of 8 x 8 cells within 5 sigma",
        run: Run::Once(uniform),
        ..Case::NIGHTLY
    },
    Case {
        id: "F14",
        title: "1e8 impacts with an observer that sums their times",
        right: "memory does not grow",
        bound: "resident size constant to 1 MiB",
        run: Run::Once(flat_memory),
        ..Case::NIGHTLY
    },
];

/// The rows that the command line writes for an ensemble of balls starting at these heights, and its exit status.
fn rows(heights: &[f64]) -> (Vec<String>, Exit) {
    let heights = heights.iter().map(|height| format!("{height}\n"));
    let table: String = std::iter::once("x\n".to_owned()).chain(heights).collect();
    let (mut output, mut errors) = (Vec::new(), Vec::new());
    let mut streams = Streams {
        input: &mut table.as_bytes(),
        output: &mut output,
        errors: &mut errors,
        terminal: false,
    };
    let line = "dalembert ensemble bouncing_ball --from - --until 1 --csv -";
    let exit = run_with(line.split(' '), &dalembert_command::all(), &mut streams);
    let text = String::from_utf8_lossy(&output);
    (text.lines().skip(1).map(str::to_owned).collect(), exit)
}

/// Case H05: an ensemble without members.
pub fn empty(report: &mut Report) {
    let (rows, exit) = rows(&[]);
    report.equal("rows", rows.len(), 0);
    report.equal("exit", exit, Exit::Reached);
}

/// Case H06: an ensemble in which one member of 10,000 is refused.
pub fn one_bad_member(report: &mut Report) {
    let mut heights: Vec<f64> = (0..10_000).map(|k| 0.5 + 1e-4 * f64::from(k)).collect();
    let (good, exit) = rows(&heights);
    report.equal("exit without it", exit, Exit::Reached);
    heights[4711] = -1.0;
    let (rows, exit) = rows(&heights);
    report.equal("exit", exit, Exit::Other);
    let changed: Vec<usize> = (0..rows.len()).filter(|&k| rows[k] != good[k]).collect();
    report.equal("rows that differ", changed, vec![4711]);
    let done = rows.iter().filter(|row| row.contains(",done,")).count();
    report.equal("done", done, 9999);
}

/// Hash of the bits of the last states of an ensemble run on `threads` threads, combined in the order of the members.
fn hash(setting: Setting, threads: usize, backwards: bool) -> u64 {
    const MEMBERS: usize = 16;
    let member = |index: usize| {
        let angle = 0.1 + index as f64;
        let end = Course::new(
            &SINAI.model(),
            &[0.7, 0.1],
            &[angle.cos(), angle.sin()],
            50.0,
        )
        .run(setting);
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
    hashes.into_iter().fold(0, |hash: u64, hash_of_run| {
        hash.wrapping_mul(31) ^ hash_of_run
    })
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

/// Counts the visits of a path to cells at equally spaced times.
struct Cells<'a> {
    system: &'a Model,
    next: f64,
    counts: [f64; 64],
}

impl Observer<Model> for Cells<'_> {
    fn step(
        &mut self,
        segment: &mut Segment<'_, <Model as VectorField>::State>,
    ) -> ControlFlow<()> {
        while self.next <= segment.t_end() {
            let Ok(state) = segment.at(self.next) else {
                return ControlFlow::Break(());
            };
            let q = self.system.position(&state);
            let cell = |x: f64| ((x + 1.0) * 4.0).clamp(0.0, 7.0) as usize;
            self.counts[8 * cell(q.as_slice()[0]) + cell(q.as_slice()[1])] += 1.0;
            self.next += 7.0;
        }
        ControlFlow::Continue(())
    }
}

fn uniform(report: &mut Report) {
    let setting = Setting::free(Integrator::Dop853);
    let system = SINAI.model();
    let mut cells = Cells {
        system: &system,
        next: 7.0,
        counts: [0.0; 64],
    };
    let end = Course::new(&system, &[0.7, 0.1], &[0.6, 0.8], 1e9)
        .impacts(1_000_000)
        .follow(setting, &mut cells);
    report.class(&end.outcome, "impact_budget");
    let areas = free_areas();
    let (total, area): (f64, f64) = (cells.counts.iter().sum(), areas.iter().sum());
    let used = || {
        cells
            .counts
            .iter()
            .zip(areas)
            .filter(|(_, free)| *free > 0.0)
    };
    let chi: f64 = used()
        .map(|(count, free)| (count - total * free / area).powi(2) / (total * free / area))
        .sum();
    let freedom = used().count() as f64 - 1.0;
    report.error(
        "chi-square in sigma",
        ((chi - freedom) / (2.0 * freedom).sqrt()).max(0.0),
        5.0,
    );
}

/// Area outside the disk of each of 8 x 8 cells, by strips.
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

/// Pages of memory that the process holds; `None` if the system does not report them.
fn resident_pages() -> Option<f64> {
    let text = std::fs::read_to_string("/proc/self/statm").ok()?;
    text.split_whitespace().nth(1)?.parse().ok()
}

/// Sums the times of impacts.
struct Sum(f64);

impl Observer<Model> for Sum {
    fn event(
        &mut self,
        event: &dalembert::Event<<Model as VectorField>::State>,
    ) -> ControlFlow<()> {
        self.0 += event.t;
        ControlFlow::Continue(())
    }
}

fn flat_memory(report: &mut Report) {
    let setting = Setting::free(Integrator::Dop853);
    let circle = elliptic_table(1.0, 1.0);
    let run = |impacts: u64| {
        let course = Course::new(&circle, &[1.0, 0.0], &[-0.8, 0.6], 1e12).impacts(impacts);
        course.follow(setting, &mut Sum(0.0))
    };
    run(10_000);
    let before = resident_pages();
    let end = run(100_000_000);
    report.class(&end.outcome, "impact_budget");
    if let (Some(before), Some(after)) = (before, resident_pages()) {
        report.error("pages of 4 KiB", after - before, 256.0);
    }
}
