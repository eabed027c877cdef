//! Distribution of the phases of ten thousand pendulums with slightly different lengths. The pendulums run on all
//! cores, eight at a time in SIMD lanes.
//!
//! `cargo run --release -p dalembert-examples --example ensemble`

use std::error::Error;
use std::num::NonZero;
use std::thread;

use dalembert::lanes::{Member, run_abreast};
use dalembert::{Scene, System, Taylor, Tolerance};

dalembert::model! {
    /// A pendulum.
    pub Pendulum {
        coordinates { theta: angle; }
        parameters { l > 0 = 1; g > 0 = 9.81; }
        lagrangian = l^2*dot(theta)^2/2 + g*l*cos(theta);
    }
}

const MEMBERS: usize = 10_000;
const UNTIL: f64 = 100.0;
const BINS: usize = 16;

/// Final angles of the pendulums of one thread.
fn ends(pendulums: &[Pendulum]) -> Result<Vec<f64>, Box<dyn Error + Send + Sync>> {
    let tolerance = Tolerance::new(1e-10)?;
    let mut members = Vec::with_capacity(pendulums.len());
    for (tag, pendulum) in pendulums.iter().enumerate() {
        let start = pendulum.state(0.0, &[0.5].into(), &[0.0].into())?;
        let (stepper, effects) = (Taylor::new(tolerance), pendulum.effects());
        members.push(Member::new(
            tag,
            pendulum,
            stepper,
            effects,
            (),
            (0.0, start),
            UNTIL,
        ));
    }
    let mut angles = vec![f64::NAN; pendulums.len()];
    run_abreast(members, |tag, run| {
        if let (Ok(run), Some(angle)) = (run, angles.get_mut(tag)) {
            *angle = pendulums[tag].position(&run.state)[0];
        }
    });
    Ok(angles)
}

fn main() -> Result<(), Box<dyn Error + Send + Sync>> {
    let pendulums: Vec<Pendulum> = (0..MEMBERS)
        .map(|member| Pendulum {
            l: 0.95 + 0.1 * member as f64 / MEMBERS as f64,
            ..Pendulum::default()
        })
        .collect();
    let threads = thread::available_parallelism().map_or(1, NonZero::get);
    let shares = pendulums.chunks(MEMBERS.div_ceil(threads));
    let angles = thread::scope(|scope| {
        let running: Vec<_> = shares
            .map(|share| scope.spawn(move || ends(share)))
            .collect();
        let mut angles = Vec::new();
        for share in running {
            angles.extend(share.join().expect("a thread that does not panic")?);
        }
        Ok::<_, Box<dyn Error + Send + Sync>>(angles)
    })?;

    let mut counts = [0_usize; BINS];
    for angle in &angles {
        let part = (angle + 0.5) * BINS as f64;
        counts[(part.max(0.0) as usize).min(BINS - 1)] += 1;
    }
    println!("angles of {} pendulums at t = {UNTIL}", angles.len());
    for (bin, count) in counts.iter().enumerate() {
        let from = -0.5 + bin as f64 / BINS as f64;
        println!("{from:+.4}  {count:>5}  {}", "#".repeat(count / 25));
    }
    match angles.iter().all(|angle| angle.abs() <= 0.5 + 1e-8) {
        true => Ok(()),
        false => Err("a pendulum gained energy".into()),
    }
}
