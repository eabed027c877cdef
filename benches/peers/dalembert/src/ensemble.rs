//! W5: many disks that differ in their angular velocity of rolling, on one core.

use dalembert::lanes::{Member, run_abreast};
use dalembert::{Dop853, Scene, Simulation, Stepper, Taylor, Tolerance};
use serde_json::json;

use crate::Plan;
use crate::models::Disk;
use crate::timing::timed;
use crate::works::rolling;

/// Number of trajectories.
const TRAJECTORIES: usize = 10_000;

/// Number of trajectories whose ends are compared one by one.
const SAMPLES: usize = 10;

/// Number of trajectories that are timed together. The time is so short that other programs leave some repetitions
/// undisturbed.
const PART: usize = 400;

/// Measures W5. There is no W5r: the generator reduces the disk itself.
pub fn disks(plan: &Plan) {
    for &value in plan.ensemble_tolerances {
        let tolerance = Tolerance::new(value).expect("a tolerance");
        report(value, "dalembert-taylor", plan, |first, ends| {
            alone(Taylor::new(tolerance), first, ends)
        });
        report(value, "dalembert-abreast", plan, |first, ends| {
            abreast(Taylor::new(tolerance), first, ends)
        });
        report(value, "dalembert-dop853", plan, |first, ends| {
            alone(Dop853::new(tolerance), first, ends)
        });
    }
}

/// Times an ensemble and prints its results. `run` takes the index of a first trajectory and a slice for the final `x`
/// of that trajectory and the following ones; it returns the number of impacts.
fn report(
    tolerance: f64,
    peer: &str,
    plan: &Plan,
    run: impl Fn(usize, &mut [f64]) -> u64,
) {
    let mut ends = vec![0.0; TRAJECTORIES];
    let mut times = vec![f64::INFINITY; TRAJECTORIES / PART];
    let mut impacts = 0;
    for _ in 0..plan.repetitions {
        impacts = 0;
        for (part, (ends, least)) in ends.chunks_mut(PART).zip(&mut times).enumerate() {
            let (time, count) = timed(|| run(part * PART, ends));
            impacts += count;
            *least = least.min(time.as_secs_f64());
        }
    }
    let between = (TRAJECTORIES - 1) / (SAMPLES - 1);
    let samples: Vec<f64> = (0..SAMPLES).map(|k| ends[k * between]).collect();
    println!(
        "{}",
        json!({
            "peer": peer, "work": "W5", "tol": tolerance, "n": TRAJECTORIES, "nev": impacts,
            "time": times.iter().sum::<f64>(), "sumx": ends.iter().sum::<f64>(), "samples": samples,
        })
    );
}

/// Angular velocity of rolling of a trajectory.
fn roll(index: usize) -> f64 {
    10.0 + 0.005 * (2.0 * index as f64 / (TRAJECTORIES - 1) as f64 - 1.0)
}

fn alone<T: Stepper<Disk> + Copy>(stepper: T, first: usize, ends: &mut [f64]) -> u64 {
    let disk = Disk::default();
    let mut impacts = 0;
    for (k, end) in ends.iter_mut().enumerate() {
        let run = Simulation::new(&disk, stepper, disk.effects())
            .run(0.0, rolling(&disk, roll(first + k)), 10.0, &mut ())
            .expect("a start");
        impacts += run.counters.impacts;
        *end = run.state[0];
    }
    impacts
}

fn abreast(stepper: Taylor<Disk>, first: usize, ends: &mut [f64]) -> u64 {
    let disk = Disk::default();
    let mut impacts = 0;
    let members = (0..ends.len()).map(|k| {
        let start = (0.0, rolling(&disk, roll(first + k)));
        Member::new(k, &disk, stepper, disk.effects(), (), start, 10.0)
    });
    run_abreast(members, |k, run| {
        let run = run.expect("a start");
        impacts += run.counters.impacts;
        ends[k] = run.state[0];
    });
    impacts
}
