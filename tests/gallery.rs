//! The gallery of the shipped models: every picture is made, and runs end as the captions state.

use std::collections::BTreeSet;
use std::fs;

use dalembert_cli::{Exit, Streams};
use serde_json::Value;

/// Runs `gallery` over the shipped models, and returns its exit and its standard error.
fn gallery(words: &[&str]) -> (Exit, String) {
    let (mut output, mut errors) = (Vec::new(), Vec::new());
    let mut streams = Streams {
        input: &mut std::io::empty(),
        output: &mut output,
        errors: &mut errors,
        terminal: false,
    };
    let line = ["dalembert", "gallery"].iter().chain(words);
    let exit = dalembert_command::catalogue().run_with(line, &mut streams);
    (exit, String::from_utf8(errors).expect("text"))
}

#[test]
fn every_picture_is_made_and_runs_end_as_captions_say() {
    let folder = std::env::temp_dir().join(format!("dalembert-pictures-{}", std::process::id()));
    let (exit, errors) = gallery(&[folder.to_str().unwrap(), "--quick"]);
    assert_eq!(exit, Exit::Reached, "{errors}");
    let page = fs::read_to_string(folder.join("index.html")).unwrap();
    let manifest = fs::read_to_string(folder.join("manifest.json")).unwrap();
    fs::remove_dir_all(&folder).unwrap();

    assert!(page.len() < 3_000_000, "{}", page.len());
    let manifest: Value = serde_json::from_str(&manifest).unwrap();
    let rows = manifest["pictures"].as_array().unwrap();
    let names: BTreeSet<&str> = rows
        .iter()
        .map(|row| row["picture"].as_str().unwrap())
        .collect();
    assert_eq!(names.len(), rows.len(), "two pictures have the same name");
    for row in rows {
        let (name, outcome) = (row["picture"].as_str().unwrap(), &row["outcome"]);
        let outcome = outcome.as_str().unwrap();
        let expected = match name {
            "double_pendulum-flips" => "failed: ",
            _ if name.starts_with("bouncing_ball-zeno") => "zeno at t = 9.8994949366",
            _ if name.starts_with("dimensionless_walker-basin") => "orbit 1 (period 1): ",
            _ if name.starts_with("dimensionless_walker-gaits") => "period 1: ",
            _ if name.starts_with("dimensionless_walker-tongues") => "period 1: ",
            "mathieu-tongues" => "period 1: 180",
            "controlled_ball-loss-costs" => "21 extremals: 5 with 0 impacts, 11 with 1 impact",
            "controlled_ball-sections-late" => "18 extremals: 9 with 0 impacts, 9 with 1",
            "controlled_ball-sections-half" => "27 extremals: 8 with 0 impacts, 10 with",
            "controlled_ball-sections-first" => "33 extremals: 7 with 0 impacts, 16 with",
            "bouncing_ball-connections-paths" => "7 motions: 1 with 0 impacts",
            "bouncing_ball-connections-bounds" => "6 motions: 2 with 1 impact",
            "controlled_ball-optimal-fixed" => "4 extremals: 1 with 0 impacts, 3 with 1 impact",
            "controlled_ball-optimal-grid" | "controlled_ball-impacts" => {
                "2 paths: 2 impacts, 1 impact"
            }
            _ if name.starts_with("controlled_ball-weak") => {
                "6 paths: 2 impacts, 2 impacts, 2 impacts, 1 impact, 1 impact, 1 impact"
            }
            "controlled_ball-displacement" => "2 paths: 1 impact, 1 impact",
            _ if name.starts_with("controlled_ball-least") => "1 path: 2 impacts",
            "controlled_ball-loss-e07" => "2 extremals: 1 with 1 impact, 1 with 2 impacts",
            "controlled_ball-loss-e09" => "3 extremals: 2 with 1 impact, 1 with 2 impacts",
            _ if name.starts_with("controlled_ball-loss") => {
                "4 extremals: 3 with 1 impact, 1 with 2 impacts"
            }
            _ if name.starts_with("controlled_ball-optimal") => "3 extremals: 1 with 0 impacts",
            "compass_walker-doubling-one" => "flip at gamma = 0.015088438",
            "compass_walker-doubling-two" => "flip at gamma = 0.017669375",
            _ if name.starts_with("bouncing_ball-action") || name.ends_with("foliation-leaves") => {
                "done: "
            }
            _ if name.contains("-starts-") => "100 of 100 runs at",
            _ if row["command"].as_str().unwrap().contains("--impacts") => "impact_budget at",
            _ => "done at",
        };
        assert!(outcome.starts_with(expected), "{name}: {outcome}");
    }
    for source in [
        "4.4", "4.5", "6.2", "6.3", "6.4", "8.4", "8.5", "9.3", "9.5", "9.7", "10.1", "10.2",
    ] {
        assert!(page.contains(&format!("W. Clark, thesis, Fig. {source}")));
    }
}
