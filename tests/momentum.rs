//! Densities that depend on velocities against `reference/verdicts_visible.json`.

use std::time::Instant;

use dalembert_codegen::claims::{Dynamics, Problem, decide, find_momentum_density};
use dalembert_codegen::{mechanics, model, spec};
use dalembert_expr::{RealPoint, SymbolId};
use dalembert_tests::reference::read;
use dalembert_tests::verdict::declaration;
use serde_json::Value;

/// `|l|^(s) * det(m)^(k)` as `(l, s, k)`.
fn parts(formula: &str) -> (String, f64, f64) {
    let exponent = |text: &str| {
        let text = text.trim_start_matches('^').trim_matches(['(', ')']);
        match text.split_once('/') {
            Some((n, d)) => n.parse::<f64>().unwrap() / d.parse::<f64>().unwrap(),
            None => text.parse().unwrap(),
        }
    };
    let (_, rest) = formula.split_once('|').expect("a factor");
    let (factor, rest) = rest.split_once('|').expect("a factor");
    let (power, mass) = match rest.split_once(" * det(m)") {
        Some((power, mass)) => (power, exponent(mass)),
        None => (rest, 0.0),
    };
    (factor.to_owned(), exponent(power), mass)
}

/// Values of all symbols, none of them near another.
fn real_point(symbols: usize, attempt: usize) -> RealPoint {
    let value = |i: usize| 0.35 + ((i * 7 + attempt * 5) % 11) as f64 * 0.093;
    RealPoint::new((0..symbols).map(value).collect())
}

fn check(system: &Value) {
    let name = &system["name"];
    let (factor, exponent, mass_exponent) =
        parts(system["momentum_density"]["f"].as_str().expect("a formula"));
    let mut factor = factor.clone();
    for coordinate in system["coordinates"].as_array().expect("coordinates") {
        let q = coordinate["name"].as_str().expect("a name");
        factor = factor.replace(&format!("{q}_dot"), &format!("dot({q})"));
    }
    let source = declaration(system);
    let source = format!("{} outputs {{ factor: {factor}; }} }}", source.strip_suffix('}').expect("a body"));
    let spec = spec::parse(source.parse().expect("tokens")).expect(&source);
    let mut model = model::check(&spec).expect(&source);
    let derivation = mechanics::derive(&mut model);
    let problem = Problem::of(&mut model, &derivation);
    let exactness = decide(&mut model, &problem, 1).expect("a verdict");
    let clock = Instant::now();
    let found = find_momentum_density(&mut model, &derivation, &problem, &exactness, 1)
        .expect("points")
        .unwrap_or_else(|| panic!("{name}: nothing found"));
    println!("{name} {} {:?}", found.text(&model.pool), clock.elapsed());
    assert_eq!(found.exponent.to_f64(), exponent, "{name}");
    assert_eq!(found.mass_exponent.to_f64(), mass_exponent, "{name}");
    assert!(found.certified.error < 1e-60);
    // On D the factors are multiples of each other.
    let dynamics = Dynamics::of(&mut model, &derivation);
    let ratio = |attempt| {
        let mut point = real_point(model.pool.symbol_count(), attempt);
        for parameter in &model.parameters {
            let default = parameter.default.expect("a default");
            point.set(parameter.symbol, model.pool.eval(&[default], &|_| 0.0)[0]);
        }
        dynamics.motion(&model.pool, &mut point, None).expect("a regular point");
        let value = |symbol: SymbolId| point.value(symbol);
        let values = model.pool.eval(&[found.factor, model.outputs[0].value], &value);
        values[0] / values[1]
    };
    for attempt in 1..5 {
        assert!((ratio(attempt) / ratio(0) - 1.0).abs() < 1e-12, "{name}");
    }
}

#[test]
fn every_known_density_is_found_up_to_a_constant() {
    let file = read("verdicts_visible");
    let systems = file["systems"].as_array().expect("systems");
    let known: Vec<_> = systems.iter().filter(|own| own.get("momentum_density").is_some()).collect();
    assert!(known.len() >= 4);
    known.into_iter().for_each(check);
}
