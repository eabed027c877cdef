//! What a declaration costs to build: its expansion, how that grows with the size of a model, and the compiler's part.
//!
//! `cargo bench --package dalembert-benches --bench compile_time [-- --csv]`

use std::fs;
use std::path::PathBuf;
use std::process::Command;

use dalembert::Described;
use dalembert_benches::table::{Layout, Table};
use dalembert_benches::timing::{is_benchmark, median, timed};
use dalembert_codegen::{mechanics, model, program, spec, try_expand};
use dalembert_models::{Chain2, Chain4, Chain8, Chain16, DoublePendulum, RollingDisk};

/// What is measured of one expansion.
struct Expansion {
    /// Milliseconds.
    time: f64,
    /// Operations of the generated rate.
    operations: usize,
    /// Characters of the generated code.
    characters: usize,
}

/// The median of some expansions of a declaration, without reading it from text.
fn expand(source: &str, rounds: usize) -> Expansion {
    let mut characters = 0;
    let times = (0..rounds).map(|_| {
        let tokens = source.parse().expect("tokens");
        let (time, items) = timed(|| try_expand(tokens).expect("a model"));
        characters = items.to_string().len();
        time.as_secs_f64() * 1e3
    });
    let time = median(times.collect());
    Expansion {
        time,
        operations: operations(source),
        characters,
    }
}

/// Operations of the rate.
fn operations(source: &str) -> usize {
    let spec = spec::parse(source.parse().expect("tokens")).expect("a declaration");
    let mut model = model::check(&spec).expect("a model");
    let derivation = mechanics::derive(&mut model);
    program::lower(&model, &derivation, None)
        .main
        .rate
        .cost
        .total()
}

/// Every shipped model.
fn expansions(rounds: usize) -> Table {
    let mut table = Table::new(["model", "coordinates", "operations", "characters", "ms"]);
    for entry in dalembert_models::all() {
        let description = entry.description();
        let expansion = expand(description.source, rounds);
        table.push([
            description.name.to_owned(),
            description.coordinates.len().to_string(),
            expansion.operations.to_string(),
            expansion.characters.to_string(),
            format!("{:.3}", expansion.time),
        ]);
    }
    table
}

/// The chain of N links, and the powers of N that fit.
fn growth(rounds: usize) -> Table {
    let sources = [
        (2.0, Chain2::DESCRIPTION.source),
        (4.0, Chain4::DESCRIPTION.source),
        (8.0, Chain8::DESCRIPTION.source),
        (16.0, Chain16::DESCRIPTION.source),
    ];
    let mut table = Table::new(["links", "operations", "ms"]);
    let (mut work, mut time) = (Vec::new(), Vec::new());
    for (n, source) in sources {
        let expansion = expand(source, rounds);
        work.push((n, expansion.operations as f64));
        time.push((n, expansion.time));
        let [operations, time] = [expansion.operations as f64, expansion.time];
        table.push([
            format!("{n}"),
            format!("{operations}"),
            format!("{time:.3}"),
        ]);
    }
    let [work, time] = [fitted_power(&work), fitted_power(&time)];
    table.push([
        "power of N".into(),
        format!("{work:.2}"),
        format!("{time:.2}"),
    ]);
    table
}

/// The power of a growth: the slope of the straight line of least squares through the logarithms.
fn fitted_power(points: &[(f64, f64)]) -> f64 {
    let logarithms: Vec<(f64, f64)> = points.iter().map(|(x, y)| (x.ln(), y.ln())).collect();
    let mean = |value: fn(&(f64, f64)) -> f64| {
        logarithms.iter().map(value).sum::<f64>() / logarithms.len() as f64
    };
    let (x, y) = (mean(|point| point.0), mean(|point| point.1));
    let slope = |f: fn(f64, f64) -> f64| -> f64 {
        logarithms
            .iter()
            .map(|point| f(point.0 - x, point.1 - y))
            .sum()
    };
    slope(|x, y| x * y) / slope(|x, _| x * x)
}

/// A user's crate, outside of the workspace: a program that simulates one model.
struct UserCrate {
    folder: PathBuf,
}

impl UserCrate {
    /// Writes the crate, and builds what it depends on in every way that will be timed.
    fn create() -> Self {
        let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("user_crate");
        let root = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("..");
        fs::create_dir_all(folder.join("src")).expect("a writable folder");
        // The versions that the workspace has: nothing has to be fetched.
        fs::copy(root.join("Cargo.lock"), folder.join("Cargo.lock")).expect("a lock file");
        let manifest = format!(
            "[workspace]\n[package]\nname = \"user_crate\"\nedition = \"2024\"\n\
             [dependencies]\ndalembert = {{ path = {:?} }}\n",
            root.join("runtime")
        );
        fs::write(folder.join("Cargo.toml"), manifest).expect("a writable folder");
        let created = Self { folder };
        for command in COMMANDS {
            created.seconds(WITHOUT_MODEL, command);
        }
        created
    }

    /// Seconds of a cargo command after the program has changed.
    fn seconds(&self, program: &str, command: &[&str]) -> f64 {
        fs::write(self.folder.join("src/main.rs"), program).expect("a writable folder");
        let mut cargo = Command::new(env!("CARGO"));
        cargo
            .args(command)
            .args(["--quiet", "--offline"])
            .current_dir(&self.folder);
        cargo.env("CARGO_TARGET_DIR", self.folder.join("target"));
        let (time, status) = timed(|| cargo.status().expect("cargo"));
        assert!(status.success(), "cargo {command:?} fails on\n{program}");
        time.as_secs_f64()
    }
}

/// What is timed of the user's crate.
const COMMANDS: [&[&str]; 3] = [&["check"], &["build"], &["build", "--release"]];

/// What cargo and an empty program take.
const WITHOUT_MODEL: &str = "use dalembert as _;\nfn main() {}\n";

/// A program that simulates a model from a state made of its declared initial values.
fn program(name: &str, source: &str) -> String {
    format!(
        "use dalembert::{{Described, Dop853, Scene, Simulation, System, Tolerance}};\n\
         dalembert::model! {{ {source} }}\n\
         fn main() {{\n\
             let system = {name}::default();\n\
             let start = system.initial();\n\
             let state = system.state_projected(0.0, &start.q, &start.qdot).unwrap();\n\
             let stepper = Dop853::new(Tolerance::new(1e-9).unwrap());\n\
             let run = Simulation::new(&system, stepper, system.effects()).run(0.0, state, 1.0, &mut ());\n\
             println!(\"{{}}\", run.unwrap().outcome);\n\
         }}\n"
    )
}

/// Seconds that cargo takes when a user's crate has changed, by model; the models take turns.
fn builds(rounds: usize) -> Table {
    let crate_ = UserCrate::create();
    let mut programs = vec![("no model", WITHOUT_MODEL.to_owned())];
    for description in [
        DoublePendulum::DESCRIPTION,
        RollingDisk::DESCRIPTION,
        Chain4::DESCRIPTION,
        Chain8::DESCRIPTION,
        Chain16::DESCRIPTION,
    ] {
        let text = program(description.type_name, description.source);
        programs.push((description.name, text));
    }
    let mut times = vec![[const { Vec::new() }; COMMANDS.len()]; programs.len()];
    for round in 0..rounds {
        for ((_, text), times) in programs.iter().zip(&mut times) {
            // Cargo goes by what has changed: the comment makes every round a change.
            let text = format!("// round {round}\n{text}");
            for (command, times) in COMMANDS.iter().zip(times) {
                times.push(crate_.seconds(&text, command));
            }
        }
    }
    let mut table = Table::new(["model", "check_s", "build_s", "release_s"]);
    for ((name, _), times) in programs.iter().zip(times) {
        let [check, build, release] = times.map(|times| format!("{:.2}", median(times)));
        table.push([(*name).to_owned(), check, build, release]);
    }
    table
}

fn main() {
    let layout = Layout::from_arguments();
    let rounds = if is_benchmark() { 15 } else { 1 };
    expansions(rounds).print(layout);
    println!();
    growth(rounds).print(layout);
    if is_benchmark() {
        println!();
        builds(5).print(layout);
    }
}
