use super::*;

#[test]
fn sound_declarations_pass() {
    let done = run("check bouncing_ball");
    assert_eq!(done.exit, Exit::Reached, "{}", done.output);
    assert!(done.output.contains("m = 1, > 0"));
    assert!(!done.output.contains("FAIL"));
}

#[test]
fn a_parameter_without_default_is_noted() {
    let checked = run("check oscillator --format json").json();
    assert_eq!(checked["parameters"][0]["default"], Value::Null);
    assert!(
        checked["notes"][0]
            .as_str()
            .unwrap()
            .contains("`k` has no default")
    );
    assert_eq!(checked["claims"], serde_json::json!([]));
}

#[test]
fn json_lists_constraints_and_charts() {
    let checked = run("check bead --format json").json();
    assert_eq!(checked["constraints"][0]["integrable"], true);
    assert_eq!(numbers(&checked["coordinates"][1]["topology"]), [-1.0, 1.0]);
    assert!(
        checked["checks"]
            .as_array()
            .unwrap()
            .iter()
            .all(|check| check["passed"] == true)
    );
}

#[test]
fn claims_are_listed_with_their_grounds() {
    let text = run("check bouncing_ball").output;
    assert!(
        text.contains("  proved    conserved: energy\n            the rate of `energy`"),
        "{text}"
    );
    let checked = run("check bouncing_ball --format json").json();
    let claims = &checked["claims"];
    assert_eq!(claims[0]["claim"], "conserved: energy");
    assert_eq!(claims[0]["verdict"], "proved");
    let certificate = &claims[0]["certificate"];
    assert!(certificate["points"].as_u64().unwrap() >= 12);
    assert!(certificate["error_bound"].as_f64().unwrap() < 1e-60);
    assert!(!certificate["primes"].as_array().unwrap().is_empty());
    assert!(certificate["seed"].is_u64());
    assert_eq!(claims[1]["verdict"], "proved");
    assert_eq!(claims[2]["verdict"], "assumed");
    assert!(claims[2].get("certificate").is_none());
}
