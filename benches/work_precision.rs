//! Work against precision: the measured error of each problem at each tolerance, with its cost.
//!
//! `cargo bench --package dalembert-benches --bench work_precision [-- [--csv] [PROBLEM..]]`

use std::time::Duration;

use dalembert::Tolerance;
use dalembert_benches::problems::{self, Manner, Method, Problem, Solved};
use dalembert_benches::table::{Layout, Table};
use dalembert_benches::timing::{is_benchmark, median};

/// Extent of the measurements.
struct Plan {
    /// Powers of ten of the tolerances.
    decades: &'static [i32],
    /// Number of timings of each case. The cases take turns, so that a slow minute of the machine affects all of them.
    rounds: u32,
    /// Least time of one timing; shorter runs are repeated.
    least: Duration,
}

const FULL: Plan = Plan {
    decades: &[-4, -5, -6, -7, -8, -9, -10, -11, -12, -13],
    rounds: 9,
    least: Duration::from_millis(2),
};

const SHORT: Plan = Plan {
    decades: &[-6],
    rounds: 1,
    least: Duration::ZERO,
};

/// A problem with a method and a tolerance, and its measurements.
struct Case {
    problem: Problem,
    decade: i32,
    manner: Manner,
    solved: Solved,
    /// Microseconds per simulated second.
    times: Vec<f64>,
}

impl Case {
    /// Makes a first run, which gives the number of repetitions.
    fn new(problem: Problem, method: Method, decade: i32, least: Duration) -> Self {
        let value: f64 = format!("1e{decade}").parse().expect("a number");
        let tolerance = Tolerance::new(value).expect("a tolerance");
        let once = Manner {
            method,
            tolerance,
            times: 1,
        };
        let solved = (problem.solve)(once);
        let times = (least.as_secs_f64() / solved.time.as_secs_f64())
            .ceil()
            .max(1.0);
        let manner = Manner {
            times: times as u32,
            ..once
        };
        Self {
            problem,
            decade,
            manner,
            solved,
            times: Vec::new(),
        }
    }

    fn time(&mut self) {
        let solved = (self.problem.solve)(self.manner);
        self.times.push(solved.time.as_secs_f64() * 1e6 / solved.t);
    }

    fn row(self) -> [String; 10] {
        let Solved {
            outcome,
            error,
            counters,
            ..
        } = self.solved;
        [
            self.problem.name.to_owned(),
            self.manner.method.name().to_owned(),
            format!("1e{}", self.decade),
            format!("{error:.2e}"),
            counters.rate_evaluations.to_string(),
            counters.accepted.to_string(),
            counters.rejected.to_string(),
            counters.impacts.to_string(),
            format!("{:.3}", median(self.times)),
            outcome.kind().to_owned(),
        ]
    }
}

const HEAD: [&str; 10] = [
    "problem",
    "integrator",
    "tol",
    "error",
    "field",
    "steps",
    "rejected",
    "impacts",
    "us_per_s",
    "outcome",
];

/// The problems named as arguments, or all if none is named.
fn chosen() -> Vec<Problem> {
    let names: Vec<String> = std::env::args()
        .skip(1)
        .filter(|name| !name.starts_with('-'))
        .collect();
    let is_chosen =
        |problem: &Problem| names.is_empty() || names.iter().any(|name| name == problem.name);
    problems::ALL.into_iter().filter(is_chosen).collect()
}

fn cases(plan: &Plan) -> Vec<Case> {
    let mut cases = Vec::new();
    for problem in chosen() {
        for method in Method::ALL {
            let fine_enough = |decade: &&i32| **decade >= method.finest();
            for &decade in plan.decades.iter().filter(fine_enough) {
                cases.push(Case::new(problem, method, decade, plan.least));
            }
        }
    }
    cases
}

fn main() {
    let plan = if is_benchmark() { FULL } else { SHORT };
    let mut cases = cases(&plan);
    for _ in 0..plan.rounds {
        cases.iter_mut().for_each(Case::time);
    }
    let mut table = Table::new(HEAD);
    cases.into_iter().for_each(|case| table.push(case.row()));
    table.print(Layout::from_arguments());
}
