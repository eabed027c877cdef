use super::*;

#[test]
fn a_state_gives_everything_in_order() {
    let done = run_on(
        r#"[{"q": [2], "qdot": ["-3.0"], "t": 0}]"#,
        &["eval", "bouncing_ball", "--set", "m=2"],
    );
    assert_eq!(done.exit, Exit::Reached, "{}", done.errors);
    let row = &done.json()[0];
    let keys: Vec<&String> = row.as_object().unwrap().keys().collect();
    let expected = [
        "q",
        "qdot",
        "p",
        "pdot",
        "acceleration",
        "multipliers",
        "metric",
        "W",
        "constraint_mass",
        "constraint_mass_inverse",
        "pi_D",
        "energy",
        "density_form_theta",
        "divergence_mu_C",
        "log_density",
        "impacts",
    ];
    assert_eq!(keys, expected);
    assert_eq!(numbers(&row["p"]), [-6.0]);
    assert_eq!(row["energy"], 13.0);
    assert_eq!(row["metric"].to_string(), "[[2.0]]");
    assert_eq!(row["W"].to_string(), "[]");
    assert_eq!(row["log_density"], Value::Null);
}

#[test]
fn what_else_a_model_reports_follows_before_the_impacts() {
    let given = r#"[{"q": [1, 0], "qdot": [0, 1]}]"#;
    let words = ["eval", "oscillator", "--set", "k=2"];
    let rows = run_over(&[systems::made_by_hand()], given, &words).json();
    let keys: Vec<&String> = rows[0].as_object().unwrap().keys().collect();
    assert_eq!(
        keys[keys.len() - 3..],
        ["log_density", "samples", "impacts"]
    );
    assert_eq!(numbers(&rows[0]["samples"])[4], 0.5);
}

#[test]
fn momenta_are_velocities_times_the_metric() {
    let given = r#"[{"q": [2], "p": [-6]}, {"q": [2], "qdot": [-3]}]"#;
    let rows = run_on(given, &["eval", "bouncing_ball", "--set", "m=2"]).json();
    assert_eq!(rows[0], rows[1]);
}

#[test]
fn the_laws_of_a_surface() {
    let words = [
        "eval",
        "bouncing_ball",
        "--restitution",
        "0.5",
        "--newton",
        "0.25",
    ];
    let done = run_on(r#"[{"q": [0], "qdot": [-4]}]"#, &words);
    let floor = &done.json()[0]["impacts"]["floor"];
    assert_eq!(
        (&floor["gap"], &floor["gap_rate"]),
        (&0.0.into(), &(-4.0).into())
    );
    let after = [
        ("elastic", 4.0),
        ("nonholonomic_plastic", 4.0),
        ("impact_plastic", 0.0),
        ("totally_plastic", 0.0),
        ("restitution", 2.0),
        ("newton", 1.0),
    ];
    let laws = floor["laws"].as_object().unwrap();
    assert_eq!(laws.keys().collect::<Vec<_>>(), after.map(|(name, _)| name));
    for (name, rate) in after {
        let law = &laws[name];
        assert_eq!(numbers(&law["qdot_plus"]), [rate], "{name}");
        assert_eq!(numbers(&law["p_plus"]), [rate], "{name}");
        assert_eq!(law["gap_rate_plus"], rate, "{name}");
        assert_eq!(law["energy_plus"], 0.5 * rate * rate, "{name}");
    }
}

#[test]
fn a_fault_is_reported_in_its_place_and_the_others_are_evaluated() {
    let given = r#"[{"q": [7, 0], "qdot": [0, 0]}, {"q": [1, 0], "qdot": [0, 1]}]"#;
    let thin =
        "Thin { coordinates { x[2]; } lagrangian = (dot(x[1])^2 + (7 - x[1])*dot(x[2])^2)/2; }";
    let done = run_over(&[Entry::of_text("thin", thin)], given, &["eval", "thin"]);
    assert_eq!(done.exit, Exit::Other);
    let rows = done.json();
    assert_eq!(rows[0]["error"]["kind"], "metric_not_positive");
    assert!(
        rows[0]["error"]["message"]
            .as_str()
            .unwrap()
            .contains("`x.2`")
    );
    assert_eq!(rows[1]["energy"], 3.0);
}

#[test]
fn off_constraint_states_are_kept_and_states_outside_the_chart_are_not() {
    let given = r#"[{"q": [0, 0], "qdot": [1, 2]}, {"q": [0, 3], "qdot": [1, 1]}]"#;
    let done = run_on(given, &["eval", "bead"]);
    assert_eq!(done.exit, Exit::Other);
    let rows = done.json();
    assert_eq!(numbers(&rows[0]["qdot"]), [1.0, 2.0]);
    assert_eq!(rows[1]["error"]["kind"], "outside_chart");
}

#[test]
fn no_states_give_no_rows() {
    let done = run_on("[]", &["eval", "bouncing_ball"]);
    assert_eq!((done.exit, done.output.as_str()), (Exit::Reached, "[]\n"));
}

#[test]
fn states_may_come_from_a_file() {
    let path =
        std::env::temp_dir().join(format!("dalembert-cli-states-{}.json", std::process::id()));
    std::fs::write(&path, r#"[{"q": ["1"], "qdot": [0]}]"#).unwrap();
    let done = run_on(
        "",
        &["eval", "bouncing_ball", "--input", path.to_str().unwrap()],
    );
    std::fs::remove_file(&path).unwrap();
    assert_eq!(done.json()[0]["energy"], 1.0);
}
