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

/// A ball that is lifted to height 1 after every fall and keeps the fraction `r` of its speed. From one
/// reset to the next, the kinetic energy after the reset goes from `E` to `K (E + 1)`, with `K = r^2`.
const LIFTED: &str = "
    Lifted {
        coordinates { x; }
        parameters { r = 1/2; }
        lagrangian = dot(x)^2/2 - x;
        impacts { floor: x >= 0 => reset { x = 1; dot(x) = r*dot(x); }; }
    }";

#[test]
fn the_hypotheses_of_poincare_and_bendixson_depend_on_parameters() {
    let on = |flags: &str| {
        let line = format!("check - --bendixson {flags}");
        run_on(LIFTED, &line.split_whitespace().collect::<Vec<_>>())
    };
    let done = on("");
    assert_eq!(done.exit, Exit::Reached, "{}", done.output);
    for part in [
        "Q.6  holds",
        "P = 1, K = 0.25",
        "multiplier   0.25",
        "energy       0.33333333, kinetic, on entry",
    ] {
        assert!(done.output.contains(part), "{part} in {}", done.output);
    }
    let document = on("--set r=0.8 --format json").json();
    assert_eq!(document["concludes"], true);
    let kept = numbers(&document["cascade"]["multiplier"]);
    assert!(kept[0] <= 0.64 && 0.64 <= kept[1] && kept[1] - kept[0] < 1e-14);
    let done = on("--set r=1");
    assert_eq!(done.exit, Exit::Other);
    assert!(done.output.contains("Q.3  open"), "{}", done.output);
    for (flags, message) in [
        ("--set q=1", "unknown parameter `q`"),
        ("--certificate file.json", "cannot be used with"),
    ] {
        let done = on(flags);
        assert_eq!(done.exit, Exit::Refused, "{flags}");
        assert!(done.errors.contains(message), "{}", done.errors);
    }
    assert_eq!(run("check bouncing_ball --set m=1").exit, Exit::Refused);
}
