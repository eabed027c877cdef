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
        ("--set x=1", "expected --initial x=1"),
        ("--certificate file.json", "cannot be used with"),
    ] {
        let done = on(flags);
        assert_eq!(done.exit, Exit::Refused, "{flags}");
        assert!(done.errors.contains(message), "{}", done.errors);
    }
    assert_eq!(run("check bouncing_ball --set m=1").exit, Exit::Refused);
}

/// Another Lagrangian and constraints: the state is refracted within the constraints of the mode that is left, and then focused on
/// those of the mode that is entered. The energies are those of the simulation.
#[test]
fn claims_about_a_mode_that_is_entered_take_its_constraints_into_account() {
    let model = |left: &str, entered: &str, claim: &str| {
        format!(
            "Entered {{
                coordinates {{ x; y; z; }}
                modes {{
                    a {{
                        lagrangian = (dot(x)^2 + dot(y)^2 + dot(z)^2)/2;
                        constraints {{ c: dot(z) = {left}; }}
                        initial {{ x = -1; dot(x) = 1; }}
                        claims {{ {claim}; }}
                    }}
                    b {{
                        lagrangian = (dot(x)^2 + dot(y)^2 + dot(z)^2)/2 - 3/10;
                        constraints {{ c: dot(z) = {entered}; }}
                    }}
                }}
                transitions {{ g: a -> b when x >= 0; h: b -> a when x <= -1; }}
            }}"
        )
    };
    for (left, entered, claim, verdict) in [
        (
            "y*dot(x)",
            "x*dot(y)",
            "conserved under g: energy",
            "is refuted",
        ),
        (
            "y*dot(x)",
            "x*dot(y)",
            "not conserved under g: energy",
            "proved",
        ),
        (
            "dot(x)",
            "dot(y)",
            "conserved under g: dot(y)",
            "is refuted",
        ),
        (
            "y*dot(x)",
            "1",
            "energy under g: not increasing",
            "is refuted",
        ),
        (
            "y*dot(x)",
            "y*dot(x)",
            "conserved under g: energy",
            "proved",
        ),
        (
            "y*dot(x)",
            "x*dot(y)",
            "energy under g: not increasing",
            "proved",
        ),
    ] {
        let done = run_on(&model(left, entered, claim), &["check", "-"]);
        let said = format!("{}{}", done.output, done.errors);
        assert!(said.contains(verdict), "{left}, {entered}: {claim}\n{said}");
    }
    let refuted = model("y*dot(x)", "x*dot(y)", "conserved under g: energy");
    let said = run_on(&refuted, &["check", "-"]).errors;
    let [after, before, y, vx, vy] = ["after = ", "before = ", " y = ", "dot(x) = ", "dot(y) = "]
        .map(|name| {
            let rest = &said[said.find(name).expect(name) + name.len()..];
            let end = rest.find([',', '\n']).expect("an end");
            rest[..end].trim().parse::<f64>().expect("a number")
        });
    let start = format!("x=-1e-12,y={y},dot(x)={vx},dot(y)={vy}");
    let line = "simulate - --no-claims --until 1e-11 --json - --initial";
    let mut arguments: Vec<&str> = line.split_whitespace().collect();
    arguments.push(&start);
    let samples = run_on(&refuted, &arguments).json()["samples"].clone();
    let last = &samples
        .as_array()
        .and_then(|all| all.last())
        .expect("samples")["energy"];
    let last = last.as_f64().expect("a number");
    let first = (vx * vx + vy * vy + (y * vx) * (y * vx)) / 2.0;
    assert!((first - before).abs() < 1e-9, "{first} {said}");
    assert!((last - after).abs() < 1e-9, "{last} {said}");
}

/// An input may change at any time, and with it a rate that it gives.
#[test]
fn rates_that_inputs_give_are_not_conserved() {
    let model = |claim: &str| {
        format!(
            "Driven {{
                coordinates {{ x; y; }}
                inputs {{ u; }}
                field {{ dot(x) = u; dot(y) = 1 + u^2; }}
                impacts {{ w: x >= 0 => reset {{ y = -y; }}; }}
                claims {{ {claim}; }}
            }}"
        )
    };
    for claim in [
        "conserved: dot(x)",
        "conserved: dot(x)*t - x",
        "not conserved: dot(x)",
        "conserved under w: dot(x)",
    ] {
        let done = run_on(&model(claim), &["check", "-"]);
        let text = "is undecided: it holds where nothing jumps, but the claimed quantity may jump with the input `u`";
        assert!(done.errors.contains(text), "{claim}: {}", done.errors);
    }
    let done = run_on(&model("conserved: dot(y) - dot(x)^2"), &["check", "-"]);
    assert!(done.output.contains("proved"), "{}", done.errors);
}

/// Multiples of primes that are the same for all declarations were taken for 0.
#[test]
fn numbers_do_not_vanish_at_all_points() {
    let text = "Spring {
        coordinates { x; }
        let c = 2305843009213693951*2305843009213682039*2305843009213577279/2^183;
        lagrangian = dot(x)^2/2 - c*x^2/2;
        initial { x = 1; until = 1; }
        claims { not conserved: dot(x); }
    }";
    let done = run_on(text, &["simulate", "-", "--json", "-"]);
    let x = done.json()["outcome"]["q"][0].as_f64().expect("a number");
    assert!((x - 1_f64.cos()).abs() < 1e-9, "{x}");
}

#[test]
fn names_of_velocities_and_momenta_are_taken() {
    for (declared, text) in [
        (
            "coordinates { x; x_dot; }",
            "`x_dot` is the name of the velocity of `x` in tables and flags",
        ),
        (
            "coordinates { x; p_x; }",
            "`p_x` is the name of the momentum of `x` in tables and flags",
        ),
        (
            "coordinates { q[2]; q_dot[2]; }",
            "`q_dot.1` is the name of the velocity of `q.1` in tables and flags",
        ),
        (
            "coordinates { x; } parameters { x_dot = 1; }",
            "`x_dot` is the name of the velocity of `x` in tables and flags",
        ),
    ] {
        let model = format!("M {{ {declared} lagrangian = 0; }}");
        let done = run_on(&model, &["check", "-"]);
        assert!(done.errors.contains(text), "{declared}: {}", done.errors);
    }
}
