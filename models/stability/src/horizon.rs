//! Section F: number of correct bounces of chaotic runs in double-double and higher arithmetic.

use core::ops::ControlFlow;

use dalembert::System;
use dalembert::extended::{At, Extended, ExtendedSimulation};
use dalembert::impacts::Impacts;
use dalembert_cli::suite::{Case, Report, Run};

use super::tables::Sinai;

/// The cases of this section.
pub const CASES: &[Case] = &[Case {
    id: "F06",
    title: "F05 and 23 other starts with 53, 106 and 159 bits",
    right: "the number of correct bounces, compared with a run with 212 bits, is proportional to the number of bits",
    bound: "ratios 1:2:3 within 20%",
    run: Run::Once(horizons),
    ..Case::QUICK
}];

/// Number of bounces per run. Even 159 bits are lost before the last one.
const BOUNCES: u64 = 220;

/// Number of starts whose horizons are averaged.
const STARTS: u32 = 24;

/// Position error above which a bounce has no correct digit.
const GONE: f64 = 1e-2;

/// A start beside the disk: position and velocity. Number 0 is the start of F05.
fn start(number: u32) -> [[f64; 2]; 2] {
    let angle = 0.8_f64.atan2(0.6) + 2.4 * f64::from(number);
    let y = 0.1 + 0.03 * f64::from(number);
    match number {
        0 => [[0.7, 0.1], [0.6, 0.8]],
        _ => [[0.7, y], [angle.cos(), angle.sin()]],
    }
}

/// Positions of the bounces of a run with `PARTS` doubles per number.
fn bounces<const PARTS: usize>([q, v]: [[f64; 2]; 2]) -> Vec<[f64; 2]> {
    let table = Sinai {};
    let mut places = Vec::new();
    let Ok(state) = table.state(0.0, &q.into(), &v.into()) else {
        return places;
    };
    let effects = Impacts::declared(&table).with_budget(BOUNCES);
    // If a run ends early, the number of bounces shows it.
    let _ = ExtendedSimulation::<_, _, PARTS>::new(&table, effects).run(
        At::of(0.0, &state),
        1e3,
        |impact| {
            let [x, y, ..] = impact
                .before
                .map(|extended: Extended<PARTS>| extended.nearest());
            places.push([x, y]);
            ControlFlow::Continue(())
        },
    );
    places
}

/// Index of the first bounce whose position error exceeds [`GONE`].
fn horizon(run: &[[f64; 2]], truth: &[[f64; 2]]) -> usize {
    let mut pairs = run.iter().zip(truth);
    let gone = pairs.position(|([x, y], [u, v])| (x - u).hypot(y - v) > GONE);
    gone.unwrap_or(run.len().min(truth.len()))
}

fn horizons(report: &mut Report) {
    let mut sums = [0.0; 3];
    for number in 0..STARTS {
        let start = start(number);
        let truth = bounces::<4>(start);
        report.equal(
            format!("bounces of start {number}"),
            truth.len() as u64,
            BOUNCES,
        );
        let runs = [
            bounces::<1>(start),
            bounces::<2>(start),
            bounces::<3>(start),
        ];
        for (sum, run) in sums.iter_mut().zip(&runs) {
            *sum += horizon(run, &truth) as f64 / f64::from(STARTS);
        }
    }
    for (times, horizon) in [(2.0, sums[1]), (3.0, sums[2])] {
        let name = format!(
            "horizon of {} bits over that of 53, from {times}",
            53.0 * times
        );
        report.error(name, (horizon / sums[0] - times).abs() / times, 0.2);
    }
    let marks = sums
        .iter()
        .enumerate()
        .map(|(k, horizon)| [53.0 * (k + 1) as f64, *horizon]);
    report.curve("horizon", ["bits", "bounce"], marks.collect());
}
