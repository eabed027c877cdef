//! Existence of invariant densities against `reference/verdicts_visible.json`.

use dalembert_codegen::claims::{Exactness, Global, Problem, decide, find_obstruction};
use dalembert_codegen::model::Model;
use dalembert_codegen::{mechanics, model, spec};
use dalembert_tests::reference::read;
use dalembert_tests::verdict::declaration;
use serde_json::Value;

/// Every system of the file, decided.
fn decided() -> Vec<(Value, Model, Problem, Exactness)> {
    let file = read("verdicts_visible");
    let systems = file["systems"].as_array().expect("systems");
    assert!(systems.len() >= 19);
    systems
        .iter()
        .map(|system| {
            let source = declaration(system);
            let spec = spec::parse(source.parse().expect("tokens")).expect(&source);
            let mut model = model::check(&spec).expect(&source);
            let derivation = mechanics::derive(&mut model);
            let problem = Problem::of(&mut model, &derivation);
            let clock = std::time::Instant::now();
            let exactness = decide(&mut model, &problem, 1).expect(&source);
            println!("{} {:?}", system["name"], clock.elapsed());
            (system.clone(), model, problem, exactness)
        })
        .collect()
}

#[test]
fn verdicts_hull_ranks_and_growth_agree() {
    for (system, model, problem, exactness) in decided() {
        let (name, verdict, local) = (&system["name"], &system["verdict"], &exactness.local);
        let number = |key: &str| verdict[key].as_u64().expect("a rank") as usize;
        let growth: Vec<usize> = verdict["generic_growth"]
            .as_array()
            .expect("ranks")
            .iter()
            .map(|rank| rank.as_u64().expect("a rank") as usize)
            .collect();
        assert_eq!(Value::Bool(local.exists), verdict["local_exists"], "{name}");
        let global = exactness.global == Some(Global::Exists);
        println!(
            "{name} {:?} {:?}",
            exactness.global,
            exactness.density.as_ref().map(|(p, _)| p
                .terms
                .iter()
                .map(|(k, t)| format!("{} {:?}", model.pool.text(*k), t))
                .collect::<Vec<_>>())
        );
        assert_eq!(Value::Bool(global), verdict["global_exists"], "{name}");
        assert_eq!(local.rank, number("hull_rank"), "{name}");
        assert_eq!(local.extended_rank, number("extended_hull_rank"), "{name}");
        assert_eq!(local.growth, growth, "{name}");
        if !local.exists {
            let obstruction = find_obstruction(&model, &problem, local).expect("an obstruction");
            println!("{obstruction:?}\n  {}", system["golden"]["obstruction"]);
        }
    }
}
