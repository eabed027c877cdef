//! Build cost of a declaration: time of its expansion, growth with the size of the model, and time of cargo commands.
//!
//! `cargo bench --package dalembert-benches --bench compile_time [-- --csv]`

use std::fs;
use std::path::PathBuf;
use std::process::Command;

use dalembert::Described;
use dalembert_benches::table::{Layout, Table};
use dalembert_benches::timing::{is_benchmark, median, timed};
use dalembert_codegen::{compile_modes, mechanics, model, program, read, spec};
use dalembert_emit::try_expand;
use dalembert_models::{Chain16, DoublePendulum, RollingDisk};

/// Measurements of one expansion.
struct Expansion {
    /// Time in milliseconds.
    time: f64,
    /// Operations of the generated rate.
    operations: usize,
    /// Characters of the generated code.
    characters: usize,
}

/// Median over `rounds` expansions of a declaration, without the time to tokenise the text.
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

/// Number of operations of the rate, summed over all modes.
fn operations(source: &str) -> usize {
    let declared = read(source.parse().expect("tokens")).expect("a declaration");
    let spec = match declared {
        spec::Declaration::Model(spec) => spec,
        spec::Declaration::Modes(modes) => {
            let compiled = compile_modes(&modes).expect("a model");
            let rates = compiled.modes.iter().map(|mode| &mode.programs.main.rate);
            return rates.map(|rate| rate.cost.total()).sum();
        }
    };
    let mut model = model::check(&spec).expect("a model");
    let derivation = mechanics::derive(&mut model);
    program::lower(&model, &derivation, None)
        .main
        .rate
        .cost
        .total()
}

/// Expansions of every shipped model.
fn expansions(rounds: usize) -> Table {
    let mut table = Table::new(["model", "coordinates", "operations", "characters", "ms"]);
    for entry in dalembert_command::all() {
        let description = entry.description();
        let expansion = expand(&description.source, rounds);
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

/// A chain of 16 unit masses in Cartesian coordinates, with the rods as constraints.
const RODS: &str = "Rods16 {
    const N = 16;
    coordinates { x[N]; y[N]; }
    parameters { g = 9.81; }
    let X[0] = 0;
    let X[i in 1..=N] = x[i];
    let Y[0] = 0;
    let Y[i in 1..=N] = y[i];
    lagrangian = sum(i in 1..=N: 1/2*(dot(x[i])^2 + dot(y[i])^2) - g*y[i]);
    constraints {
        rod[i in 1..=N]: (X[i] - X[i-1])*(d(X[i]) - d(X[i-1])) + (Y[i] - Y[i-1])*(d(Y[i]) - d(Y[i-1])) = 0;
    }
}";

/// Both declarations of the chain of 16 links.
fn chains() -> [(&'static str, &'static str); 2] {
    [
        ("angles", Chain16::DESCRIPTION.source.value()),
        ("rods", RODS),
    ]
}

/// The declaration of a chain with another number of links.
fn with_links(source: &str, links: usize) -> String {
    source.replace("16", &links.to_string())
}

/// Expansions of both declarations of the chain, and the exponents of the power laws in the number N of links that fit
/// the operations and the times.
fn growth(rounds: usize) -> Table {
    let mut table = Table::new(["chain by", "links", "operations", "ms"]);
    for (name, source) in chains() {
        let (mut work, mut time) = (Vec::new(), Vec::new());
        for links in [2, 4, 8, 16, 32] {
            let expansion = expand(&with_links(source, links), rounds);
            work.push((links as f64, expansion.operations as f64));
            time.push((links as f64, expansion.time));
            table.push([
                name.to_owned(),
                links.to_string(),
                expansion.operations.to_string(),
                format!("{:.3}", expansion.time),
            ]);
        }
        let [work, time] = [work, time].map(|points| fitted_power(&points));
        table.push([
            name.to_owned(),
            "power of N".into(),
            format!("{work:.2}"),
            format!("{time:.2}"),
        ]);
    }
    table
}

/// The exponent of a power law, as the slope of the least-squares line through the logarithms.
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

/// A user's crate outside the workspace, with a program that simulates one model.
struct UserCrate {
    folder: PathBuf,
}

impl UserCrate {
    /// Writes the crate, and builds its dependencies with every command that will be timed.
    fn create() -> Self {
        let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("user_crate");
        let root = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("..");
        fs::create_dir_all(folder.join("src")).expect("a writable folder");
        // The lock file of the workspace names versions that are downloaded already.
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

    /// Seconds that a cargo command takes after the program has changed.
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

/// Commands that are timed in the user's crate.
const COMMANDS: [&[&str]; 3] = [&["check"], &["build"], &["build", "--release"]];

/// A program without a model, to measure the time of cargo itself.
const WITHOUT_MODEL: &str = "use dalembert as _;\nfn main() {}\n";

/// A program that simulates a model from its declared initial values, projected on the constraints.
fn program(name: &str, source: &str) -> String {
    format!(
        "use dalembert::{{Dop853, Instance, Scene, Simulation, System, Tolerance}};\n\
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

/// Median seconds of cargo commands after a change in a user's crate, by model. The models take turns.
fn builds(rounds: usize) -> Table {
    let crate_ = UserCrate::create();
    let mut programs = vec![("no model".to_owned(), WITHOUT_MODEL.to_owned())];
    for description in [DoublePendulum::DESCRIPTION, RollingDisk::DESCRIPTION] {
        let text = program(description.type_name, &description.source);
        programs.push((description.name.to_owned(), text));
    }
    for (name, source) in chains() {
        for links in BUILT_LINKS {
            let source = with_links(source, links);
            let type_name = source
                .split_whitespace()
                .find(|word| word.ends_with(&links.to_string()));
            let text = program(type_name.expect("a name"), &source);
            programs.push((format!("chain of {links} by {name}"), text));
        }
    }
    let mut times = vec![[const { Vec::new() }; COMMANDS.len()]; programs.len()];
    for round in 0..rounds {
        for ((_, text), times) in programs.iter().zip(&mut times) {
            // The comment changes the source in every round, so that cargo builds again.
            let text = format!("// round {round}\n{text}");
            for (command, times) in COMMANDS.iter().zip(times) {
                times.push(crate_.seconds(&text, command));
            }
        }
    }
    let mut table = Table::new(["model", "check_s", "build_s", "release_s"]);
    for ((name, _), times) in programs.iter().zip(times) {
        let [check, build, release] = times.map(|times| format!("{:.2}", median(times)));
        table.push([name.clone(), check, build, release]);
    }
    table
}

/// Numbers of links of the chains that are built.
const BUILT_LINKS: [usize; 3] = [8, 16, 32];

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
