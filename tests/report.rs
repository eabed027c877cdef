//! Compares the density form that `derive` prints with the values that claims use.

use dalembert::Instance;
use dalembert::describe::Description;
use dalembert::math::larger;
use dalembert_codegen::claims::geometry_at;
use dalembert_codegen::report::{Item, density_form, report};
use dalembert_tests::sampling::every_system;
use dalembert_tests::verdict::Decided;

/// Compares density forms, and counts the forms and those that are not 0.
#[derive(Default)]
struct Compared {
    written: usize,
    not_zero: usize,
}

impl Compared {
    fn compare(&mut self, description: &Description) {
        let name = description.name;
        let mut decided = Decided::of(&description.source);
        if decided.derivation.constraints.is_empty() {
            return;
        }
        let Some(theta) = density_form(&mut decided.model, &decided.derivation) else {
            return;
        };
        self.written += 1;
        let mut size: f64 = 0.0;
        for attempt in 0..3_i32 {
            let mut values = decided.defaults();
            values.push((decided.model.time, 0.3));
            for (i, coordinate) in decided.model.coordinates.iter().enumerate() {
                let value = 0.31 + 0.17 * f64::from(attempt) + 0.23 * i as f64;
                values.push((coordinate.q, value));
            }
            let expected = geometry_at(&decided.model.pool, &decided.problem, &values, None);
            let expected = expected.expect("a regular point").theta;
            let value = |symbol| {
                let known = values.iter().find(|(known, _)| *known == symbol);
                known.map_or(f64::NAN, |(_, value)| *value)
            };
            let printed = decided.model.pool.eval(&theta, &value);
            assert_eq!(printed.len(), expected.len(), "{name}");
            for (k, (printed, expected)) in printed.iter().zip(&expected).enumerate() {
                let error = (printed - expected).abs();
                assert!(
                    error < 1e-10 * (1.0 + expected.abs()),
                    "{name} {k}: {printed} {expected}"
                );
                size = larger(size, expected.abs());
            }
        }
        self.not_zero += usize::from(size > 1e-3);
    }
}

#[test]
fn the_printed_density_form_is_the_one_that_is_decided_with() {
    let mut compared = Compared::default();
    for system in every_system() {
        compared.compare(system.description());
    }
    assert!(compared.written >= 8, "{}", compared.written);
    assert!(compared.not_zero >= 3, "{}", compared.not_zero);
}

#[test]
fn the_volume_is_reported_with_its_verdict() {
    let source = "Bead {
        coordinates { x; y; }
        lagrangian = dot(x)^2/2 + dot(y)^2/2;
        constraints { line: x*dot(x) + dot(y) = 0; }
    }";
    let report = report(source).expect("a report");
    let section = report
        .sections
        .iter()
        .find(|section| section.title == "Invariant volume");
    let items = &section.expect("a section").items;
    let formula = |name: &str| {
        items.iter().find_map(|item| match item {
            Item::Formula { left, right } if left[0] == name => Some(right.clone()),
            _ => None,
        })
    };
    let [text, latex] = formula("theta_x").expect("theta");
    assert_eq!(
        (text.as_str(), latex.as_str()),
        ("2*x/(x^2 + 1)", r"\frac{2 x}{x^{2} + 1}")
    );
    assert_eq!(formula("G").expect("G"), ["ln(det m)", r"\ln(\det m)"]);
    let is_proved = |item: &Item| matches!(item, Item::Words(words) if words.starts_with("exp(G)*mu_C is invariant"));
    assert!(items.iter().any(is_proved));
}
