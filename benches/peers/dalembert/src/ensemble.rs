//! W5: many disks that differ in their rate of rolling, on one core.

use dalembert::{Dop853, Scene, Simulation, Stepper, Taylor, Tolerance};
use serde_json::json;

use crate::Plan;
use crate::models::Disk;
use crate::timing::timed;
use crate::works::rolling;

/// Trajectories.
const TRAJECTORIES: usize = 10_000;

/// Trajectories whose ends are compared one by one.
const SAMPLES: usize = 10;

/// Trajectories that are timed together: a stretch so short that some repetition is undisturbed.
const PART: usize = 80;

/// W5, and W5r.
pub fn disks(plan: &Plan) {
    for &value in plan.ensemble_tolerances {
        let tolerance = Tolerance::new(value).expect("a tolerance");
        report(value, "dalembert-taylor", Taylor::new(tolerance), plan);
        report(value, "dalembert-dop853", Dop853::new(tolerance), plan);
    }
}

fn report<T: Stepper<Disk> + Copy>(tolerance: f64, peer: &str, stepper: T, plan: &Plan) {
    let mut ends = vec![0.0; TRAJECTORIES];
    let mut times = vec![f64::INFINITY; TRAJECTORIES / PART];
    let mut impacts = 0;
    for _ in 0..plan.repetitions {
        impacts = 0;
        for (part, (ends, least)) in ends.chunks_mut(PART).zip(&mut times).enumerate() {
            let (time, count) = timed(|| run(stepper, part * PART, ends));
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

/// Runs trajectories for 10 seconds; the places where they end along x, and the number of impacts.
fn run<T: Stepper<Disk> + Copy>(stepper: T, first: usize, ends: &mut [f64]) -> u64 {
    let disk = Disk::default();
    let mut impacts = 0;
    for (k, end) in ends.iter_mut().enumerate() {
        let roll = 10.0 + 0.005 * (2.0 * (first + k) as f64 / (TRAJECTORIES - 1) as f64 - 1.0);
        let run = Simulation::new(&disk, stepper, disk.effects())
            .run(0.0, rolling(&disk, roll), 10.0, &mut ())
            .expect("a start");
        impacts += run.counters.impacts;
        *end = run.state[0];
    }
    impacts
}
