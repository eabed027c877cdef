//! The models of `dalembert_tests::visible_models` are the systems of `reference/verdicts_visible.json`: metric, forms
//! and potential agree at the point of the file. Contradictions of their claims are refuted.

use dalembert_tests::claim::{Declaration, refusal};
use dalembert_tests::formula::{Scope, value};
use dalembert_tests::numeric::Snapshot;
use dalembert_tests::reference::{number, read};
use dalembert_tests::visible_models::systems;
use dalembert_tests::witness;
use serde_json::Value;

/// A formula of the file in the notation of claims. The file writes `**` for powers and `x_dot` for velocities.
fn translated(formula: &Value, coordinates: &[&str]) -> String {
    let mut text = formula.as_str().expect("a formula").replace("**", "^");
    for name in coordinates {
        text = text.replace(&format!("{name}_dot"), &format!("dot({name})"));
    }
    text
}

/// A system of the file with the point at which the file has values.
struct Golden<'g> {
    system: &'g Value,
    coordinates: Vec<&'g str>,
    parameters: Vec<(&'g str, f64)>,
    q: Vec<f64>,
}

impl<'g> Golden<'g> {
    fn of(system: &'g Value) -> Self {
        let golden = &system["golden"];
        let text = |value: &'g Value| value.as_str().expect("a name");
        let list = |key: &str| system[key].as_array().expect("a list");
        let coordinates: Vec<&str> = list("coordinates")
            .iter()
            .map(|coordinate| text(&coordinate["name"]))
            .collect();
        let names = list("params")
            .iter()
            .map(|parameter| text(&parameter["name"]));
        Self {
            system,
            parameters: names
                .map(|name| (name, number(&golden["params"][name])))
                .collect(),
            q: coordinates
                .iter()
                .map(|name| number(&golden["point"][*name]))
                .collect(),
            coordinates,
        }
    }

    fn value(&self, formula: &Value, qdot: &[f64]) -> f64 {
        let state = Snapshot {
            t: 0.0,
            q: self.q.clone(),
            qdot: qdot.to_vec(),
            p: Vec::new(),
            energy: f64::NAN,
        };
        let scope = Scope {
            coordinates: &self.coordinates,
            parameters: &self.parameters,
            definitions: &[],
            state: &state,
            partial: None,
        };
        value(&translated(formula, &self.coordinates), &scope)
    }

    /// `2 T` at a velocity that is the sum of the unit vectors of these coordinates.
    fn twice_kinetic(&self, units: &[usize]) -> f64 {
        let mut qdot = vec![0.0; self.q.len()];
        units.iter().for_each(|i| qdot[*i] += 1.0);
        2.0 * self.value(&self.system["kinetic"], &qdot)
    }
}

fn close(name: &str, found: f64, expected: f64) {
    let error = (found - expected).abs();
    assert!(
        error <= 1e-13 * (1.0 + expected.abs()),
        "{name}: {found} for {expected}"
    );
}

#[test]
fn the_declared_systems_are_those_of_the_file() {
    let file = read("verdicts_visible");
    let listed = file["systems"].as_array().expect("systems");
    let mut declared = systems();
    assert_eq!(declared.len(), listed.len());
    for ((name, model), system) in declared.iter_mut().zip(listed) {
        assert_eq!(system["name"], **name);
        let golden = Golden::of(system);
        let names: Vec<&str> = model
            .description()
            .coordinates
            .iter()
            .map(|coordinate| coordinate.name)
            .collect();
        assert_eq!(names, golden.coordinates, "{name}");
        for (parameter, value) in &golden.parameters {
            assert!(model.set(parameter, *value), "{name}: {parameter}");
        }
        let n = golden.q.len();
        let rest = vec![0.0; n];
        let state = model.state(0.0, &golden.q, &rest);
        let report = model.report(0.0, &state);
        let potential = golden.value(&system["potential"], &rest);
        close(name, report.number("energy"), potential);
        let metric = &report.0["metric"];
        for i in 0..n {
            for j in 0..n {
                let [both, first, second] =
                    [&[i, j][..], &[i], &[j]].map(|units| golden.twice_kinetic(units));
                close(name, metric[n * i + j], (both - first - second) / 2.0);
            }
        }
        let forms = system["eta"].as_array().expect("forms");
        assert_eq!(report.0["W"].len(), n * forms.len(), "{name}");
        for (dual, form) in report.0["W"].chunks(n).zip(forms) {
            for (k, row) in metric.chunks(n).enumerate() {
                let found: f64 = row.iter().zip(dual).map(|(g, w)| g * w).sum();
                close(name, found, golden.value(&form[k], &rest));
            }
        }
    }
}

#[test]
fn densities_of_each_kind_are_claimed_where_the_file_has_them() {
    let file = read("verdicts_visible");
    let listed = file["systems"].as_array().expect("systems");
    let declared = systems();
    assert_eq!(declared.len(), listed.len());
    for ((name, model), system) in declared.iter().zip(listed) {
        let verdict = &system["verdict"];
        let expected = match (&verdict["local_exists"], &verdict["global_exists"]) {
            (Value::Bool(true), Value::Bool(true)) => "exact",
            (Value::Bool(true), _) => "locally_exact",
            _ => "none",
        };
        let declaration = Declaration::of(&model.description().source);
        let has = |claim: &str| {
            declaration
                .claims
                .iter()
                .any(|listed| listed.starts_with(claim))
        };
        assert!(has(&format!("density : {expected}")), "{name}");
        assert!(has("conserved : energy"), "{name}");
        assert!(
            has("density =") || system["momentum_density"].is_null(),
            "{name}"
        );
    }
}

#[test]
fn what_contradicts_the_file_is_refuted() {
    for (name, model) in &mut systems() {
        let declaration = Declaration::of(&model.description().source);
        let is_none = declaration
            .claims
            .iter()
            .any(|listed| listed == "density : none");
        for word in ["exact", "locally_exact", "none"] {
            let claim = format!("density: {word}");
            if declaration.claims.contains(&format!("density : {word}")) {
                continue;
            }
            let (source, line) = declaration.claiming(&claim);
            let (message, lines) = refusal(&source);
            assert_eq!(lines, [line, line], "{name}");
            assert!(
                message.starts_with(&format!("`{claim}` is refuted: ")),
                "{message}"
            );
            if is_none || message.contains("\nperiod = ") {
                witness::check(model.as_mut(), &claim, &message);
            }
        }
    }
}

#[test]
fn energy_is_kept_by_the_motion_and_densities_balance_its_divergence() {
    let mut seen = 0;
    for (name, model) in &systems() {
        let declaration = Declaration::of(&model.description().source);
        let file = read("verdicts_visible");
        let listed = file["systems"].as_array().expect("systems");
        let system = listed
            .iter()
            .find(|system| system["name"] == **name)
            .expect("a system");
        let q = Golden::of(system).q;
        let qdot: Vec<f64> = (0..q.len()).map(|i| 0.4 - 0.3 * i as f64).collect();
        let state = model.projected(0.0, &q, &qdot);
        let rate = witness::rate(model.as_ref(), "energy", 0.0, &state);
        assert!(rate.abs() < 1e-9, "{name}: {rate}");
        let divergence = model.report(0.0, &state).number("divergence_mu_C");
        for claim in &declaration.claims {
            let Some(density) = claim.strip_prefix("density =") else {
                continue;
            };
            seen += 1;
            let rate = witness::rate(model.as_ref(), &format!("ln({density})"), 0.0, &state);
            assert!(
                (rate + divergence).abs() < 1e-8,
                "{name}: {rate} {divergence}"
            );
        }
    }
    assert!(seen >= 16, "{seen}");
}
