use super::*;

#[test]
fn sound_declarations_pass() {
    let done = run("check bouncing_ball");
    assert_eq!(done.exit, Exit::Reached, "{}", done.output);
    assert!(done.output.contains("m = 1, > 0"));
    assert!(done.output.contains("claims are not checked"));
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
    assert_eq!(checked["claims"]["checked"], false);
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
