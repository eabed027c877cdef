//! Compares `eval` with independent values of 50 digits: field, multipliers, geometry, impact laws.

use dalembert_cli::Exit;
use dalembert_tests::command::dalembert;
use dalembert_tests::reference::{compare, number, numbers, read};
use serde_json::{Map, Value, json};

const TOLERANCE: f64 = 1e-12;

/// Names of the compared quantities, in the state files and in the output of `eval`.
const QUANTITIES: [&str; 14] = [
    "qdot",
    "p",
    "pdot",
    "acceleration",
    "multipliers",
    "energy",
    "metric",
    "W",
    "constraint_mass",
    "constraint_mass_inverse",
    "pi_D",
    "density_form_theta",
    "divergence_mu_C",
    "divergence_omega_n",
];

/// Evaluates states of a model and returns the output of `eval`.
fn eval(model: &str, flags: &[&str], states: &[Value]) -> Vec<Value> {
    let mut arguments = vec!["eval", model];
    arguments.extend(flags);
    let finished = dalembert(&arguments, &Value::from(states.to_vec()).to_string());
    assert_eq!(
        finished.exit,
        Exit::Reached,
        "{model}: {}\n{}",
        finished.errors,
        finished.output
    );
    let printed: Value = serde_json::from_str(&finished.output).expect("JSON");
    printed.as_array().expect("one entry per state").clone()
}

/// The state as `eval` takes it, with velocities or with momenta.
fn input(state: &Value, rates: &str) -> Value {
    let mut input = Map::new();
    input.insert("q".into(), state["q"].clone());
    input.insert(rates.into(), state[rates].clone());
    if let Some(t) = state.get("t") {
        input.insert("t".into(), t.clone());
    }
    input.into()
}

/// Collects mismatches so that one run shows all of them.
#[derive(Default)]
struct Mismatches {
    compared: usize,
    /// Quantities that needed the allowance for rounded input.
    conditioned: usize,
    found: Vec<String>,
}

impl Mismatches {
    fn check(&mut self, path: &str, actual: &Value, expected: &Value) {
        self.compared += 1;
        self.found
            .extend(compare(path, actual, expected, TOLERANCE).err());
    }

    /// Same as [`Mismatches::check`], with an allowance for components that almost vanish by cancellation: the effect
    /// of rounding the given 30 digits to `f64`. No arithmetic on the rounded numbers can do better.
    fn check_conditioned(
        &mut self,
        path: &str,
        actual: &Value,
        expected: &Value,
        spread: impl FnOnce() -> Vec<f64>,
    ) {
        self.compared += 1;
        let Err(mismatch) = compare(path, actual, expected, TOLERANCE) else {
            return;
        };
        let flat = |value: &Value| {
            value
                .as_array()
                .map_or_else(|| vec![number(value)], |_| numbers(value))
        };
        let allowed =
            |((a, e), spread): ((&f64, &f64), &f64)| (a - e).abs() <= TOLERANCE * e.abs() + spread;
        let (actual, expected, spread) = (flat(actual), flat(expected), spread());
        let is_shaped = [expected.len(), spread.len()] == [actual.len(); 2];
        if !is_shaped || !actual.iter().zip(&expected).zip(&spread).all(allowed) {
            self.found.push(mismatch);
        }
        self.conditioned += 1;
    }

    fn finish(self, name: &str, least: usize) {
        assert!(
            self.compared >= least,
            "{name}: only {} quantities compared",
            self.compared
        );
        let shown = self
            .found
            .iter()
            .take(40)
            .cloned()
            .collect::<Vec<_>>()
            .join("\n");
        assert!(
            self.conditioned <= 5,
            "{name}: {} by cancellation",
            self.conditioned
        );
        assert!(
            self.found.is_empty(),
            "{name}: {} of {}\n{shown}",
            self.found.len(),
            self.compared
        );
    }
}

fn check_states(name: &str, file: &Value, list: &str, mismatches: &mut Mismatches) {
    let Some(states) = file[list].as_array() else {
        return;
    };
    for rates in ["qdot", "p"] {
        let inputs: Vec<Value> = states.iter().map(|state| input(state, rates)).collect();
        let rows = eval(name, &[], &inputs);
        assert_eq!(rows.len(), states.len(), "{name}");
        for (k, (actual, expected)) in rows.iter().zip(states).enumerate() {
            for quantity in QUANTITIES {
                // The divergence of the global field is the same for omega^n and mu_C, on D* and off it.
                let printed = if quantity == "divergence_omega_n" {
                    "divergence_mu_C"
                } else {
                    quantity
                };
                if let Some(value) = expected.get(quantity) {
                    mismatches.check(
                        &format!("{list}[{k}].{quantity} from {rates}"),
                        &actual[printed],
                        value,
                    );
                }
            }
        }
    }
}

/// The names of a law's results in the reference files and as `eval` prints them.
const RESULTS: [(&str, &str); 5] = [
    ("qdot_plus", "qdot_plus"),
    ("p_plus", "p_plus"),
    ("dh(qdot_plus)", "gap_rate_plus"),
    ("gap_rate_plus", "gap_rate_plus"),
    ("energy_plus", "energy_plus"),
];

fn check_impacts(name: &str, file: &Value, mismatches: &mut Mismatches) {
    let impacts = file["impacts"].as_array().cloned().unwrap_or_default();
    for (k, impact) in impacts.iter().enumerate() {
        let surface = impact["surface"].as_str().expect("a surface");
        let mut state = json!({ "q": impact["q"], "qdot": impact["qdot_minus"] });
        if let Some(t) = impact.get("t") {
            state["t"] = t.clone();
        }
        let moving = impact.get("gap_rate_minus").is_some();
        for (law, expected) in impact["laws"].as_object().expect("laws") {
            let Some((law, flags)) = flags_of(law) else {
                continue;
            };
            let results = |states: &[Value]| -> Vec<Value> {
                let flags: Vec<&str> = flags.iter().map(String::as_str).collect();
                let rows = eval(name, &flags, states);
                let law = |row: &Value| row["impacts"][surface]["laws"][law].clone();
                rows.iter().map(law).collect()
            };
            let actual = &results(std::slice::from_ref(&state))[0];
            for (theirs, ours) in RESULTS {
                // For moving walls `dh(qdot)` is not the gap rate.
                let applies = !(moving && theirs.starts_with("dh("));
                if let Some(value) = expected.get(theirs).filter(|_| applies) {
                    let path = format!("impacts[{k}].{surface}.{law}.{theirs}");
                    let spread = || spread(&results(&neighbours(&state)), &actual[ours], ours);
                    mismatches.check_conditioned(&path, &actual[ours], value, spread);
                }
            }
        }
    }
}

/// Copies of the state, each with one number moved by one unit in the last place.
fn neighbours(state: &Value) -> Vec<Value> {
    let mut moved = Vec::new();
    for key in ["q", "qdot"] {
        for i in 0..state[key].as_array().expect("numbers").len() {
            let mut neighbour = state.clone();
            neighbour[key][i] = number(&state[key][i]).next_up().into();
            moved.push(neighbour);
        }
    }
    moved
}

/// Sum of the changes of a result over neighbouring states, for each component.
fn spread(neighbours: &[Value], actual: &Value, result: &str) -> Vec<f64> {
    let flat = |value: &Value| {
        value
            .as_array()
            .map_or_else(|| vec![number(value)], |_| numbers(value))
    };
    let actual = flat(actual);
    let mut spread = vec![0.0; actual.len()];
    for neighbour in neighbours {
        for ((spread, a), b) in spread.iter_mut().zip(&actual).zip(flat(&neighbour[result])) {
            *spread += (a - b).abs();
        }
    }
    spread
}

/// The name of a law on the command line, with the flags that select it.
fn flags_of(law: &str) -> Option<(&str, Vec<String>)> {
    for (prefix, ours) in [
        ("elastic_family_e=", "restitution"),
        ("newton_e=", "newton"),
    ] {
        if let Some(coefficient) = law.strip_prefix(prefix) {
            let coefficient = number(&Value::from(coefficient)).to_string();
            return Some((ours, vec![format!("--{ours}"), coefficient]));
        }
    }
    // The command line has no name for this family.
    if law.starts_with("nonholonomic_family_e=") {
        None
    } else {
        Some((law, Vec::new()))
    }
}

fn check_file(name: &str, file: &str, least: usize) {
    let file = read(file);
    assert_eq!(file["system"]["name"], name);
    let mut mismatches = Mismatches::default();
    for list in ["states", "states_on_level", "off_constraint_states"] {
        check_states(name, &file, list, &mut mismatches);
    }
    check_impacts(name, &file, &mut mismatches);
    mismatches.finish(name, least);
}

macro_rules! agrees {
    ($($test:ident $name:literal $file:literal $least:literal;)*) => {$(
        #[test]
        fn $test() {
            check_file($name, $file, $least);
        }
    )*};
}

agrees! {
    rolling_disk_agrees "rolling_disk" "rolling_disk" 500;
    chaplygin_sleigh_agrees "chaplygin_sleigh" "chaplygin_sleigh" 500;
    rolling_ball_euler_agrees "rolling_ball_euler" "rolling_ball_euler" 400;
    ball_on_rotating_table_agrees "ball_on_rotating_table" "rotating_table_states" 200;
    two_wheels_rod_agrees "two_wheels_rod" "cv64_two_wheels" 400;
    holonomic_bead_agrees "holonomic_bead_on_ellipses" "holonomic_bead" 200;
    integrable_bead_agrees "integrable_bead" "integrable_bead" 300;
    affine_sleigh_agrees "affine_sleigh" "affine_sleigh" 600;
    table_wall_agrees "table_wall" "table_wall" 400;
    magnetic_disk_agrees "magnetic_disk" "magnetic_disk" 400;
    damped_sleigh_agrees "damped_sleigh" "damped_sleigh" 300;
    point_billiard_agrees "point_billiard" "point_billiard_states" 150;
    bouncing_ball_agrees "bouncing_ball" "bouncing_ball_states" 150;
    moving_wall_disk_agrees "moving_wall_disk" "moving_wall_disk" 300;
    rheonomic_agrees "rheonomic" "rheonomic" 300;
    walker_with_multiplier_agrees "walker_with_multiplier" "walker_multiplier_states" 200;
    walker_foot_slip_agrees "walker_foot_slip" "walker_states" 80;
}
