//! Measurements of this project for the comparison with other programs: workloads with known results, one line of JSON
//! for each integrator and tolerance. `benches/peers/run.py` runs all programs and compares them.
//!
//! `cargo run --release -- [WORK..] [--repetitions N] [--once INTEGRATOR TOLERANCE]`
//!
//! `--once` makes single runs and prints nothing, for programs that count instructions.

mod chains;
mod course;
mod ensemble;
mod models;
mod right_hand_side;
mod timing;
mod works;

/// The state of a system.
type State<S> = <S as dalembert::VectorField>::State;

/// Extent of the measurements.
#[derive(Debug, Clone, Copy)]
pub struct Plan {
    /// Relative and absolute tolerances of single runs.
    tolerances: &'static [f64],
    /// Relative and absolute tolerances of the ensemble.
    ensemble_tolerances: &'static [f64],
    /// Number of timings of each case. The shortest counts, as other programs use the machine.
    repetitions: usize,
    /// The integrator and the tolerance of a single run.
    once: Option<(&'static str, f64)>,
}

const PLAN: Plan = Plan {
    tolerances: &[1e-2, 1e-3, 1e-4, 1e-6, 1e-8, 1e-10, 1e-12, 1e-14],
    ensemble_tolerances: &[1e-3, 1e-4, 1e-6, 1e-9, 1e-12],
    repetitions: 5,
    once: None,
};

/// Names of the workloads with their measuring functions.
const WORKS: [(&str, fn(&Plan)); 7] = [
    ("W1", works::disk_billiard),
    ("W2", works::sleigh),
    ("W2b", works::sleigh_billiard),
    ("W3", works::double_pendulum),
    ("W3b", right_hand_side::chains),
    ("W4", works::bouncing_ball),
    ("W5", ensemble::disks),
];

/// The plan, with the number of `--repetitions`, and the names of the workloads to measure.
fn arguments() -> (Plan, Vec<String>) {
    let mut plan = PLAN;
    let mut names = Vec::new();
    let mut arguments = std::env::args().skip(1);
    while let Some(argument) = arguments.next() {
        if argument == "--repetitions" {
            let count = arguments.next().and_then(|count| count.parse().ok());
            plan.repetitions = count.expect("`--repetitions` is followed by a number");
        } else if argument == "--once" {
            let integrator = match arguments.next().as_deref() {
                Some("taylor") => "dalembert-taylor",
                Some("dop853") => "dalembert-dop853",
                _ => panic!("`--once` is followed by `taylor` or `dop853`"),
            };
            let tolerance = arguments.next().and_then(|value| value.parse().ok());
            let tolerance = tolerance.expect("a tolerance follows the integrator of `--once`");
            plan.once = Some((integrator, tolerance));
        } else if !argument.starts_with('-') {
            names.push(argument);
        }
    }
    (plan, names)
}

fn main() {
    let (plan, names) = arguments();
    for (name, measure) in WORKS {
        if names.is_empty() || names.iter().any(|wanted| wanted == name) {
            measure(&plan);
        }
    }
}
