//! The exact work of short runs of every integrator on every declared system. A change of these numbers is a change of
//! the method. `ACCEPT=1 cargo test --release -p dalembert-tests --test structure` stores them anew.

use std::fmt::Write as _;
use std::path::Path;

use dalembert::{Instance, StateVector, System};
use dalembert_stability::text::Large;
use dalembert_tests::command::dalembert;
use dalembert_tests::golden;
use dalembert_tests::sampling::{every_system, states};
use serde_json::Value;

/// Duration of the motions.
const TIME: &str = "1";

/// Every integrator, with its tolerance or its fixed step.
const INTEGRATORS: [(&str, [&str; 2]); 8] = [
    ("dop853", ["--tol", "1e-9"]),
    ("dopri5", ["--tol", "1e-9"]),
    ("taylor", ["--tol", "1e-9"]),
    ("rk4", ["--step", "0.015625"]),
    ("gauss4", ["--step", "0.015625"]),
    ("gauss6", ["--step", "0.015625"]),
    ("dla2", ["--step", "0.015625"]),
    ("dla4", ["--step", "0.015625"]),
];

/// Counters with the widths of their columns.
const COUNTERS: [(&str, usize); 7] = [
    ("rate_evaluations", 6),
    ("coefficients", 6),
    ("accepted", 5),
    ("rejected", 4),
    ("dense_constructions", 4),
    ("impacts", 4),
    ("projections", 4),
];

fn list<V: StateVector>(vector: V) -> String {
    let numbers: Vec<String> = vector.as_slice().iter().map(f64::to_string).collect();
    numbers.join(",")
}

/// Appends the lines of a system, one for each integrator.
fn write_work(work: &mut String, system: &Large) {
    let state = states(system, 1, 7)[0];
    let q = list(system.position(&state));
    let qdot = list(system.velocity(0.0, &state).expect("a velocity"));
    let name = system.description().name;
    for (integrator, accuracy) in INTEGRATORS {
        let mut line = vec!["simulate", name, "--integrator", integrator];
        line.extend(accuracy);
        line.extend(["--until", TIME, "--q", &q, "--qdot", &qdot]);
        line.extend([
            "--off-constraint",
            "project",
            "--samples",
            "0",
            "--json",
            "-",
        ]);
        let finished = dalembert(&line, "");
        let run: Value = serde_json::from_str(&finished.output)
            .unwrap_or_else(|_| panic!("{line:?}: {}", finished.errors));
        write!(work, "{name:28} {integrator:7}").expect("a string");
        for (counter, width) in COUNTERS {
            let count = run["counters"][counter].as_u64().expect("a count");
            write!(work, " {count:width$}").expect("a string");
        }
        let kind = run["outcome"]["kind"].as_str().expect("a kind");
        writeln!(work, "  {kind}").expect("a string");
    }
}

#[test]
fn work_is_as_counted() {
    let mut work = String::new();
    for system in every_system() {
        write_work(&mut work, system);
    }
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("golden/work.txt");
    golden::compare_file(&path, &work);
}
