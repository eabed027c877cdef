//! Cost of each effect of a scene, in instructions. A scene must cost as much as a model that declares nothing else.
//!
//! `valgrind --tool=callgrind` counts the instructions, so that the numbers are reproducible even on a busy machine.
//! The program runs itself under `valgrind`, once for each count.
//!
//! `cargo bench --package dalembert-benches --bench effects [-- --csv]`

use std::process::{Command, ExitCode};

use dalembert::math::larger;
use dalembert::{Described, Dop853, Effect, Instance, Scene, Simulation, Tolerance};
use dalembert_benches::table::{Layout, Table};
use dalembert_benches::timing::is_benchmark;

/// A blade on a tilted plane, with these forces, surfaces and scenes.
macro_rules! blade {
    ($name:ident, forces { $($forces:tt)* } impacts { $($impacts:tt)* } scenes { $($scenes:tt)* }) => {
        dalembert::model! {
            #[global]
            pub $name {
                coordinates { x; y; theta: angle; }
                parameters { m > 0 = 1.5; I > 0 = 0.4; a = 0.2; g = 0.7; c >= 0 = 0.3; table > 0 = 1e12; }
                lagrangian = m/2*(dot(x)^2 + dot(y)^2) + I/2*dot(theta)^2
                    + m*a*dot(theta)*(cos(theta)*dot(y) - sin(theta)*dot(x)) + m*g*x;
                constraints { knife: sin(theta)*d(x) - cos(theta)*d(y) = 0; }
                forces { $($forces)* }
                impacts { $($impacts)* }
                scenes { $($scenes)* }
                initial { dot(theta) = 3; dot(x) = 1; }
            }
        }
    };
}

blade!(
    Blade,
    forces { drag: -c*dot(x)*d(x) - c*dot(y)*d(y); }
    impacts {
        tip: table - (x + cos(theta)/2)^2 - (y + sin(theta)/2)^2 >= 0;
        heel: table - (x - cos(theta)/2)^2 - (y - sin(theta)/2)^2 >= 0;
    }
    scenes {
        free;
        kept: projection;
        measured: volume;
        slowed: drag;
        one_surface: tip;
        two_surfaces: tip, heel;
        everything: drag, tip, heel, projection, volume;
    }
);
blade!(Free, forces {} impacts {} scenes {});
// Inlining depends on the number of calls of a function, so most rows have a type of their own, as scenes do. `Free`
// and `TwoSurfaces` serve two rows each, and `Blade` serves the row `everything`.
blade!(Kept, forces {} impacts {} scenes {});
blade!(Measured, forces {} impacts {} scenes {});
blade!(Slowed, forces { drag: -c*dot(x)*d(x) - c*dot(y)*d(y); } impacts {} scenes {});
blade!(
    OneSurface,
    forces {}
    impacts { tip: table - (x + cos(theta)/2)^2 - (y + sin(theta)/2)^2 >= 0; }
    scenes {}
);
blade!(
    TwoSurfaces,
    forces {}
    impacts {
        tip: table - (x + cos(theta)/2)^2 - (y + sin(theta)/2)^2 >= 0;
        heel: table - (x - cos(theta)/2)^2 - (y - sin(theta)/2)^2 >= 0;
    }
    scenes {}
);

/// A run of `steps` steps from the declared start, with these effects. Returns accepted steps and impacts.
fn work<S: Described, E: Effect<S>>(system: &S, effects: E, steps: u64) -> [u64; 2] {
    let initial = system.initial();
    let completed = system.complete_velocity(0.0, &initial.q, &initial.qdot, &initial.named);
    let state = completed.and_then(|qdot| system.state(0.0, &initial.q, &qdot));
    let state = state.expect("the declared start");
    let stepper = Dop853::new(Tolerance::new(1e-9).expect("a tolerance"));
    let mut simulation = Simulation::new(system, stepper, effects).with_step_budget(steps);
    let run = simulation.run(0.0, state, f64::MAX, &mut ());
    let counters = run.expect("a start").counters;
    [counters.accepted, counters.impacts]
}

/// A row of the table.
struct Row {
    name: &'static str,
    scene: fn(u64) -> [u64; 2],
    /// The model that declares nothing else.
    plain: fn(u64) -> [u64; 2],
}

/// A row from a scene and a model, both with their declared effects.
macro_rules! row {
    ($name:literal, $scene:expr, $plain:expr) => {
        Row {
            name: $name,
            scene: |steps| work(&$scene, $scene.effects(), steps),
            plain: |steps| work(&$plain, $plain.effects(), steps),
        }
    };
}

/// Squared radius of a table on which the blade often meets the border.
const SMALL: f64 = 4.0;

/// All rows. A row whose name begins with `free` is the reference of the rows after it. In the row `free, global form`
/// neither side has effects: the declared effects of a model in global form include projection on the constraints,
/// those of the scene do not.
fn rows() -> [Row; 9] {
    [
        row!("free", blade::Free::default(), Free::default()),
        row!(
            "measured: volume",
            blade::Measured::default(),
            Measured::default()
        ),
        row!("slowed: drag", blade::Slowed::default(), Slowed::default()),
        row!(
            "one_surface: tip",
            blade::OneSurface::default(),
            OneSurface::default()
        ),
        row!(
            "two_surfaces: tip, heel",
            blade::TwoSurfaces::default(),
            TwoSurfaces::default()
        ),
        row!(
            "two_surfaces, met often",
            blade::TwoSurfaces(Blade {
                table: SMALL,
                ..Blade::default()
            }),
            TwoSurfaces {
                table: SMALL,
                ..TwoSurfaces::default()
            }
        ),
        row!("everything", blade::Everything::default(), Blade::default()),
        Row {
            name: "free, global form",
            scene: |steps| {
                work(
                    &blade::Free::default().global().expect("the global form"),
                    (),
                    steps,
                )
            },
            plain: |steps| {
                work(
                    &Free::default().global().expect("the global form"),
                    (),
                    steps,
                )
            },
        },
        row!(
            "kept: projection, global form",
            blade::Kept::default().global().expect("the global form"),
            Kept::default().global().expect("the global form")
        ),
    ]
}

/// Numbers of steps of the two counted runs. The count of the short run is subtracted from that of the long one.
const STEPS: [u64; 2] = [100, 1100];

/// Counts of one run under `valgrind`.
#[derive(Debug, Clone, Copy)]
struct Counted {
    instructions: u64,
    steps: u64,
    impacts: u64,
}

/// Runs this program under `valgrind`.
///
/// # Errors
/// Explains why there is no count.
fn count(row: usize, kind: &str, steps: u64) -> Result<Counted, String> {
    let program = std::env::current_exe().map_err(|error| error.to_string())?;
    let output = Command::new("valgrind")
        .args(["--tool=callgrind", "--callgrind-out-file=/dev/null"])
        .arg(program)
        .args(["--run", &row.to_string(), kind, &steps.to_string()])
        .output()
        .map_err(|error| format!("valgrind: {error}"))?;
    let said = String::from_utf8_lossy(&output.stderr);
    let collected = said
        .lines()
        .find_map(|line| line.split_once("Collected : "));
    let instructions = collected.and_then(|(_, number)| number.trim().parse().ok());
    let printed = String::from_utf8_lossy(&output.stdout);
    let numbers: Option<Vec<u64>> = printed
        .split_whitespace()
        .map(|number| number.parse().ok())
        .collect();
    match (instructions, numbers.as_deref()) {
        (Some(instructions), Some(&[steps, impacts])) => Ok(Counted {
            instructions,
            steps,
            impacts,
        }),
        _ => Err(format!("valgrind: {said}")),
    }
}

/// Instructions per accepted step, and impacts per thousand accepted steps.
fn per_step(row: usize, kind: &str) -> Result<[f64; 2], String> {
    let [few, many] = STEPS.map(|steps| count(row, kind, steps));
    let (few, many) = (few?, many?);
    let steps = (many.steps - few.steps) as f64;
    let instructions = (many.instructions - few.instructions) as f64;
    let impacts = (many.impacts - few.impacts) as f64;
    Ok([instructions / steps, 1000.0 * impacts / steps])
}

/// Prints the table. Returns the largest relative difference between a scene and its model.
fn measure() -> Result<f64, String> {
    let mut table = Table::new([
        "scene",
        "impacts in 1000 steps",
        "instructions a step",
        "scene/model",
        "/free",
    ]);
    let (mut worst, mut free) = (0.0_f64, f64::NAN);
    for (index, row) in rows().iter().enumerate() {
        let [scene, impacts] = per_step(index, "scene")?;
        let [plain, _] = per_step(index, "plain")?;
        if row.name.starts_with("free") {
            free = scene;
        }
        worst = larger(worst, (scene / plain - 1.0).abs());
        table.push([
            row.name.to_owned(),
            format!("{impacts:.0}"),
            format!("{scene:.0}"),
            format!("{:.4}", scene / plain),
            format!("{:.2}", scene / free),
        ]);
    }
    table.print(Layout::from_arguments());
    Ok(worst)
}

/// Allowed relative difference between a scene and its model, whose inlining may differ.
const ALLOWED: f64 = 0.005;

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().collect();
    if let Some(place) = arguments.iter().position(|argument| argument == "--run") {
        let number = |offset: usize| arguments[place + offset].parse::<u64>().expect("a number");
        let row = &rows()[number(1) as usize];
        let run = if arguments[place + 2] == "plain" {
            row.plain
        } else {
            row.scene
        };
        let [accepted, impacts] = run(number(3));
        println!("{accepted} {impacts}");
        return ExitCode::SUCCESS;
    }
    if Command::new("valgrind").arg("--version").output().is_err() {
        eprintln!("not run: `valgrind` is not installed");
        return ExitCode::from(u8::from(is_benchmark()));
    }
    match measure() {
        Ok(worst) if worst <= ALLOWED => ExitCode::SUCCESS,
        Ok(worst) => {
            eprintln!(
                "a scene and its model differ by {:.2} %; allowed are {:.1} %",
                100.0 * worst,
                100.0 * ALLOWED
            );
            ExitCode::FAILURE
        }
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}
