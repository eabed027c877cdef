//! Compares shipped models with `reference/invariant_densities.json`: the density form theta and its values on D,
//! existence, differences of the logarithm of the density, and the effect of elastic impacts off D.

use dalembert_cli::Exit;
use dalembert_codegen::claims::{Equation, find_conditions};
use dalembert_expr::SymbolId;
use dalembert_tests::command::{dalembert, models};
use dalembert_tests::divergence::{Flow, State};
use dalembert_tests::linear::determinant;
use dalembert_tests::reference::{number, numbers, paired, read};
use dalembert_tests::verdict::{Decided, Existence};
use serde_json::{Value, json};

fn close(found: f64, expected: f64, what: &str) {
    let size = f64::max(expected.abs(), 1.0);
    assert!(
        (found - expected).abs() <= 1e-12 * size,
        "{what}: {found} for {expected}"
    );
}

fn entries(list: &str) -> Vec<Value> {
    let file = read("invariant_densities");
    let entries = file[list].as_array().expect("entries").clone();
    assert!(entries.len() >= 5);
    entries
}

fn name(entry: &Value) -> &str {
    entry["system"].as_str().expect("a name")
}

fn decided(entry: &Value) -> Decided {
    let models = models();
    let mut descriptions = models.iter().map(dalembert_cli::Entry::description);
    let model = descriptions.find(|description| description.name == name(entry));
    Decided::of(&model.expect("a model").source)
}

/// Values of the parameters of the model in an entry.
fn parameters(entry: &Value, decided: &Decided) -> Vec<(SymbolId, f64)> {
    let values = entry["parameters"].as_object().expect("values");
    let parameters = decided.model.parameters.iter();
    parameters
        .map(|parameter| (parameter.symbol, number(&values[&parameter.name.display])))
        .collect()
}

#[test]
fn theta_on_d_agrees() {
    for entry in entries("systems") {
        let decided = decided(&entry);
        for point in entry["points"].as_array().expect("points") {
            let q = numbers(&point["q"]);
            // In each vector of the basis of D, one independent velocity is 1 and the others are 0. The constraints
            // determine the dependent velocities.
            let dependent: Vec<_> = match name(&entry) {
                "chaplygin_sleigh" | "holonomic_bead_on_ellipses" => vec![1],
                _ => vec![0, 1],
            };
            let flow = Flow::new(&decided, &parameters(&entry, &decided), &dependent);
            let state = State {
                t: 0.0,
                v: vec![0.0; q.len() - dependent.len()],
                q,
            };
            let geometry = flow.geometry(&state);
            for (values, key) in [
                (&geometry.theta, "theta"),
                (&geometry.demands, "theta_on_D"),
            ] {
                for (found, expected) in paired(values, &point[key]) {
                    close(found, expected, name(&entry));
                }
            }
        }
    }
}

#[test]
fn existence_agrees() {
    for entry in entries("systems") {
        let mut decided = decided(&entry);
        let exists = Value::Bool(decided.existence() == Existence::Global);
        let expected = &entry["invariant_density_depending_on_configuration"];
        if exists == *expected {
            continue;
        }
        // There is no density at generic values of the parameters, but one at these values.
        assert_eq!(*expected, Value::Bool(true), "{}", name(&entry));
        let exactness = decided.exactness.clone().expect("a verdict");
        let scan = find_conditions(&mut decided.model, &decided.problem, &exactness, 1);
        let is_met = |equation: &Equation| {
            let value = |p: &usize| {
                let name = &decided.model.parameters[*p].name.display;
                number(&entry["parameters"][name])
            };
            match equation {
                Equation::Value(p, expected) => value(p) == expected.to_f64(),
                Equation::Equal(p, q) => value(p) == value(q),
                Equation::Zero(polynomial) => {
                    let of_symbol = |symbol| {
                        let mut all = decided.model.parameters.iter();
                        let position = all.position(|parameter| parameter.symbol == symbol);
                        value(&position.expect("a parameter"))
                    };
                    decided.model.pool.eval(&[*polynomial], &of_symbol)[0] == 0.0
                }
            }
        };
        let found = scan.expect("a scan").found;
        let mut met = found
            .iter()
            .filter(|condition| condition.equations.iter().all(is_met));
        assert!(met.any(|condition| condition.is_global), "{}", name(&entry));
    }
}

#[test]
fn densities_differ_between_points_as_listed() {
    let mut seen = 0;
    for entry in entries("systems") {
        let decided = decided(&entry);
        let Some((potential, _)) = decided.exactness().density.clone() else {
            continue;
        };
        seen += usize::from(!potential.terms.is_empty());
        let parameters = parameters(&entry, &decided);
        let mut offsets = Vec::new();
        for point in entry["points"].as_array().expect("points") {
            let mut values = parameters.clone();
            let coordinates = decided
                .model
                .coordinates
                .iter()
                .map(|coordinate| coordinate.q);
            values.extend(coordinates.zip(numbers(&point["q"])));
            let found = decided.log_density_at(&values).expect("a regular point");
            offsets.push(found - number(&point["g"]));
        }
        for offset in &offsets {
            close(*offset, offsets[0], name(&entry));
        }
    }
    assert!(seen >= 1);
}

/// Output of `eval` for the state of an entry with these momenta, which may be off D.
fn eval(entry: &Value, momenta: &[f64]) -> Value {
    let values = entry["parameters"].as_object().expect("values");
    let settings: Vec<String> = values
        .iter()
        .map(|(name, value)| format!("{name}={}", value.as_str().expect("a number")))
        .collect();
    let mut arguments = vec!["eval", name(entry)];
    arguments.extend(settings.iter().flat_map(|setting| ["--set", setting]));
    let states = json!([{ "q": entry["q"], "p": momenta }]);
    let finished = dalembert(&arguments, &states.to_string());
    assert_eq!(finished.exit, Exit::Reached, "{}", finished.errors);
    let printed: Value = serde_json::from_str(&finished.output).expect("JSON");
    printed[0].clone()
}

fn elastic<'v>(entry: &Value, printed: &'v Value) -> &'v Value {
    let surface = entry["surface"].as_str().expect("a name");
    &printed["impacts"][surface]["laws"]["elastic"]
}

/// `P(W^a)`
fn constraint_momenta(printed: &Value, p: &[f64]) -> Vec<f64> {
    let fields = printed["W"].as_array().expect("fields");
    let contract = |w: &Value| numbers(w).iter().zip(p).map(|(w, p)| w * p).sum();
    fields.iter().map(contract).collect()
}

#[test]
fn elastic_impacts_off_d_keep_energy_and_constraint_momenta() {
    for entry in entries("global_elastic_impacts") {
        let before = numbers(&entry["p_minus"]);
        let printed = eval(&entry, &before);
        let after = elastic(&entry, &printed);
        let p = numbers(&after["p_plus"]);
        for (found, expected) in paired(&p, &entry["p_plus"]) {
            close(found, expected, name(&entry));
        }
        for (key, p) in [("P(W)_minus", &before), ("P(W)_plus", &p)] {
            let momenta = constraint_momenta(&printed, p);
            for (found, expected) in paired(&momenta, &entry[key]) {
                close(found, expected, name(&entry));
            }
        }
        close(
            number(&printed["energy"]),
            number(&entry["energy_minus"]),
            name(&entry),
        );
        close(
            number(&after["energy_plus"]),
            number(&entry["energy_plus"]),
            name(&entry),
        );
    }
}

/// An impact multiplies the flux of `omega^n` through the surface by the ratio of the gap rates times the determinant
/// of the map of momenta. The map is linear, so that differences are exact. The closed form of the factor is
/// `(2 dh.pi_D - dh)/dh`.
#[test]
fn elastic_impacts_off_d_change_the_liouville_volume_as_listed() {
    for entry in entries("global_elastic_impacts") {
        let p = numbers(&entry["p_minus"]);
        let printed = eval(&entry, &p);
        let base = numbers(&elastic(&entry, &printed)["p_plus"]);
        let columns: Vec<Vec<f64>> = (0..p.len())
            .map(|i| {
                let mut moved = p.clone();
                moved[i] += 1.0;
                let moved = numbers(&elastic(&entry, &eval(&entry, &moved))["p_plus"]);
                moved.iter().zip(&base).map(|(a, b)| a - b).collect()
            })
            .collect();
        let surface = entry["surface"].as_str().expect("a name");
        let rate = number(&printed["impacts"][surface]["gap_rate"]);
        let rate_after = number(&elastic(&entry, &printed)["gap_rate_plus"]);
        let jacobian = determinant(&columns) * rate_after / rate;
        let expected = number(&entry["hybrid_jacobian_omega_n"]);
        assert!(
            (jacobian - expected).abs() < 1e-12,
            "{}: {jacobian}",
            name(&entry)
        );
        // dh(qdot+) = dh(qdot-) - 2 dh(pi_D qdot-).
        let projected = (rate - rate_after) / 2.0;
        close(
            (2.0 * projected - rate) / rate,
            number(&entry["formula_(2 dh.piD - dh)/dh"]),
            name(&entry),
        );
    }
}
