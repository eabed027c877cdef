//! Orbits that close up to a group of symmetries: gaits against runs of a hundred steps, groups against closed forms, and
//! messages about missing or wrong symmetries.

// A test may fail by panicking.
#![allow(clippy::unwrap_used)]

mod support;

use std::f64::consts::PI;

use dalembert_cli::Exit;
use serde_json::Value;
use support::{Done, run_on};

/// An oscillator in the plane with a repulsion from its centre, as a first-order system. The section consists of the
/// states of largest radius. `r^2` oscillates with the period `pi/w`, in which the angle grows by `pi L/sqrt(L^2 + b)`
/// with the angular momentum `L`.
const CENTRAL: &str = "
    Central {
        coordinates { x; y; u; v; }
        parameters { w > 0 = 1; b > 0 = 1/2; }
        let square = x^2 + y^2;
        field {
            dot(x) = u;
            dot(y) = v;
            dot(u) = -w^2*x + b*x/square^2;
            dot(v) = -w^2*y + b*y/square^2;
        }
        impacts { far: x*u + y*v >= 0 => reset { }; }
        initial { x = 1; y = 1/10; u = 1/5; v = 3/5; until = 20; }
    }";

/// A point in a round table. All chords of its motion are congruent.
const ROUND: &str = "
    Round {
        coordinates { x; y; }
        parameters { r > 0 = 2; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2;
        impacts { rim: r^2 - x^2 - y^2 >= 0; }
        initial { x = 0; y = 1; dot(x) = 3; dot(y) = 0; }
    }";

/// A lens in the middle of a round table.
const LENS: &str = "
    Lens {
        coordinates { x; y; }
        parameters { V = -1; }
        let square = x^2 + y^2;
        let kinetic = (dot(x)^2 + dot(y)^2)/2;
        modes {
            air {
                lagrangian = kinetic;
                impacts { rim: square <= 4; }
                initial { x = -1.9; y = 0.3; dot(x) = 1; dot(y) = 0; until = 20; }
            }
            glass { lagrangian = kinetic - V; }
        }
        transitions { enter: air -> glass when square <= 1; leave: glass -> air when square >= 1; }
    }";

/// A charge in a magnetic field and a perpendicular electric field. It drifts by `2 pi E/B^2` in each turn.
const CROSSED: &str = "
    Crossed {
        coordinates { x; y; }
        parameters { B = 2; E = 3/10; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2 + GAUGE + E*y;
        impacts { middle: y >= 0 => reset { }; }
        initial { x = 1/4; y = 1/2; dot(x) = 6/5; dot(y) = 2/5; until = 20; }
    }";

/// A cart whose rate of turning is driven by a clock.
const CART: &str = "
    Cart {
        coordinates { x; y; h; s; }
        parameters { w = 0.3; }
        field { dot(x) = cos(h); dot(y) = sin(h); dot(h) = w + cos(s); dot(s) = 1; }
        impacts { tick: s <= 2*pi => reset { s = 0; }; }
        initial { x = 2; y = 1; h = 0.4; until = 20; }
    }";

/// Runs a command line given as words, with this standard input.
fn run(input: &str, words: &[&str]) -> Done {
    let quoted = words.iter().map(|word| format!("'{word}' "));
    run_on(input, &quoted.collect::<String>())
}

/// The document of a command line that succeeds.
#[track_caller]
fn document(input: &str, words: &[&str]) -> Value {
    let done = run(input, &[words, &["--json", "-"]].concat());
    assert_eq!(done.exit, Exit::Reached, "{}{}", done.errors, done.output);
    serde_json::from_str(&done.output).unwrap()
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap()
}

fn numbers(value: &Value) -> Vec<f64> {
    let entries = value.as_array().unwrap().iter();
    entries
        .map(|entry| entry.as_f64().unwrap_or(f64::NAN))
        .collect()
}

/// Real and imaginary parts of the multipliers.
fn multipliers(orbit: &Value) -> Vec<[f64; 2]> {
    let found = orbit["multipliers"].as_array().unwrap().iter();
    found
        .map(|one| [number(&one["re"]), number(&one["im"])])
        .collect()
}

fn advance(orbit: &Value, index: usize) -> f64 {
    number(&orbit["modulo"][index]["advance"])
}

#[track_caller]
fn assert_near(found: f64, expected: f64, within: f64) {
    assert!((found - expected).abs() <= within, "{found} and {expected}");
}

/// The names of the coordinates of a shipped model.
fn coordinates(model: &str) -> Vec<String> {
    let list = run_on("", "list --format json");
    let list: Value = serde_json::from_str(&list.output).unwrap();
    let mut entries = list.as_array().unwrap().iter();
    let entry = entries.find(|entry| entry["name"] == model).unwrap();
    let names = entry["coordinates"].as_array().unwrap().iter();
    names
        .map(|name| name.as_str().unwrap().to_owned())
        .collect()
}

/// Starts a run after the event that closes a gait, and compares its first hundred returns with the gait.
#[track_caller]
fn repeats_a_hundred_times(
    model: &str,
    surface: &str,
    modulo: Option<(&str, &[usize])>,
    mode: &[&str],
) {
    let mut words = vec!["orbit", model, "--surface", surface];
    words.extend(modulo.iter().flat_map(|(fields, _)| ["--modulo", fields]));
    let gait = document("", &words);
    let names = coordinates(model);
    let (q, qdot) = (
        numbers(&gait["after"]["q"]),
        numbers(&gait["after"]["qdot"]),
    );
    let is_first_order = gait["before"]["p"]
        .as_array()
        .unwrap()
        .iter()
        .all(Value::is_null);
    let given = (names.iter().zip(&q)).map(|(name, value)| (format!("{name}={value:?}"), value));
    let rates =
        (names.iter().zip(&qdot)).map(|(name, value)| (format!("{name}_dot={value:?}"), value));
    let rates = rates.filter(|_| !is_first_order);
    let start: Vec<String> = given
        .chain(rates)
        .filter(|(_, value)| !value.is_nan())
        .map(|(text, _)| text)
        .collect();
    let period = number(&gait["period"]);
    let until = (100.5 * period).to_string();
    let run = document(
        "",
        &[
            &[
                "simulate",
                model,
                "--initial",
                &start.join(","),
                "--until",
                &until,
                "--integrator",
                "taylor",
                "--tol",
                "1e-13",
            ],
            mode,
        ]
        .concat(),
    );
    let events = run["events"].as_array().unwrap().iter();
    let steps: Vec<&Value> = events.filter(|event| event["surface"] == surface).collect();
    assert_eq!(steps.len(), 100, "{model}");
    let before = numbers(&gait["before"]["q"]);
    for (k, step) in steps.iter().enumerate() {
        let count = (k + 1) as f64;
        assert_near(number(&step["t"]), count * period, 1e-8 * count);
        for (i, (found, before)) in numbers(&step["q_minus"]).iter().zip(&before).enumerate() {
            let moved = modulo.filter(|(_, moved)| moved.contains(&i));
            let moved = moved.map_or(0.0, |_| count * advance(&gait, 0));
            if !before.is_nan() {
                assert_near(*found, before + moved, 1e-8 * count);
            }
        }
    }
}

#[test]
fn gaits_repeat_a_hundred_times() {
    repeats_a_hundred_times(
        "walker_foot_slip",
        "step",
        Some(("partial(x_c)", &[0])),
        &[],
    );
    repeats_a_hundred_times("compass_walker", "heel", None, &[]);
    let fields = "partial(x) + partial(foot) + partial(front) + partial(back)";
    repeats_a_hundred_times(
        "spring_mass_walker",
        "touch_down",
        Some((fields, &[0, 2])),
        &["--mode", "double"],
    );
}

#[test]
fn the_slipping_walker_has_the_multipliers_of_its_reduction() {
    let reduced = document("", &["orbit", "dimensionless_walker", "--surface", "step"]);
    // The reduction has `mu = m lf^2/I` and `eps = m^2 g/(b^2 lf)`. Its unit of time is `m/b`, its unit of velocity `m g/b`.
    let set = [
        "--set",
        "I=0.1",
        "--set",
        "b=2",
        "--set",
        "alpha=0.4",
        "--set",
        "delta=0.4",
    ];
    let start = ["--initial", "x_c_dot=0.5,theta_dot=-1"];
    let walker = [
        "orbit",
        "walker_foot_slip",
        "--surface",
        "step",
        "--modulo",
        "partial(x_c)",
    ];
    let whole = document("", &[&walker[..], &set, &start].concat());
    let [found, expected] = [&whole, &reduced].map(multipliers);
    assert_eq!((found.len(), expected.len()), (2, 2));
    for ([re, im], [expected, _]) in found.into_iter().zip(expected) {
        assert_near(re, expected, 1e-12);
        assert_eq!(im, 0.0);
    }
    assert_near(
        number(&whole["period"]),
        0.5 * number(&reduced["period"]),
        1e-13,
    );
    // Modulo the translation the velocities are those of the reduction.
    let velocities = numbers(&whole["after"]["qdot"]);
    let scaled = numbers(&reduced["after"]["q"]);
    assert_near(velocities[0], 0.5 * scaled[2], 1e-13);
    assert_near(velocities[1], scaled[1], 1e-13);
    assert_eq!(whole["modulo"][0]["conserves_momentum"], false);
    // The gait of the declared parameters, found from the declared start.
    let declared = document("", &walker);
    assert_near(advance(&declared, 0), 0.369_980_386_579_607_5, 1e-12);
}

#[test]
fn the_spring_mass_walker_keeps_its_energy_alone() {
    let fields = "partial(x) + partial(foot) + partial(front) + partial(back)";
    let gait = document(
        "",
        &[
            "orbit",
            "spring_mass_walker",
            "--surface",
            "touch_down",
            "--modulo",
            fields,
        ],
    );
    let found = multipliers(&gait);
    assert_eq!(found.len(), 3);
    assert_near(found[0][0], 1.0, 1e-10);
    // The other two multipliers are a conjugate pair inside the unit circle: the gait is stable.
    assert_near(found[1][1], -found[2][1], 1e-12);
    assert!(f64::hypot(found[1][0], found[1][1]) < 0.99);
    assert_eq!(gait["modulo"][0]["conserves_momentum"], false);
}

#[test]
fn a_central_force_turns_by_its_apsidal_angle() {
    let turn = "x*partial(y) - y*partial(x) + u*partial(v) - v*partial(u)";
    for (set, start) in [
        ("w=1", "v=0.6"),
        ("w=1.7", "v=-0.9"),
        ("b=0.01", "v=0.5"),
        ("b=30", "v=2"),
    ] {
        let orbit = document(
            CENTRAL,
            &[
                "orbit",
                "-",
                "--surface",
                "far",
                "--modulo",
                turn,
                "--set",
                set,
                "--initial",
                start,
            ],
        );
        let parameter = |name: &str| number(&orbit["parameters"][name]);
        let q = numbers(&orbit["before"]["q"]);
        let momentum = q[0] * q[3] - q[1] * q[2];
        assert_near(number(&orbit["period"]), PI / parameter("w"), 1e-12);
        let angle = PI * momentum / momentum.hypot(parameter("b").sqrt());
        assert_near(advance(&orbit, 0), angle, 1e-12);
        // Energy and angular momentum are conserved and do not change the period, so both multipliers are 1.
        let found = multipliers(&orbit);
        assert_eq!(found.len(), 2);
        assert!(
            found.iter().all(|[re, im]| (re - 1.0).hypot(*im) < 1e-6),
            "{found:?}"
        );
    }
}

#[test]
fn chords_of_a_round_table_turn_by_their_angle() {
    let words = [
        "orbit",
        "-",
        "--surface",
        "rim",
        "--modulo",
        "x*partial(y) - y*partial(x)",
    ];
    let orbit = document(ROUND, &words);
    // A chord at the distance 1 from the centre of a circle of radius 2.
    assert_near(number(&orbit["period"]), 2.0 * 3.0_f64.sqrt() / 3.0, 1e-13);
    assert_near(advance(&orbit, 0), -2.0 * PI / 3.0, 1e-13);
    assert_eq!(orbit["modulo"][0]["conserves_momentum"], true);
    let found = multipliers(&orbit);
    assert_eq!(found.len(), 2);
    assert!(
        found.iter().all(|[re, im]| (re - 1.0).hypot(*im) < 1e-6),
        "{found:?}"
    );
    let told = run(ROUND, &words);
    assert!(
        told.output.contains(
            "conserved    the momentum of x*partial(y) - y*partial(x), which makes a multiplier 1"
        ),
        "{}",
        told.output
    );
}

/// A point in a round table with a round lens in its middle. Outside the lens its speed is v, inside it is v'
/// with v'^2 = v^2 + 2. The refraction keeps the angular momentum: p v = p' v' with the distances p, p' of the
/// straight paths from the centre.
#[test]
fn rays_through_a_lens_turn_by_their_angle() {
    let words = [
        "orbit",
        "-",
        "--surface",
        "rim",
        "--modulo",
        "x*partial(y) - y*partial(x)",
    ];
    let orbit = document(LENS, &words);
    let (p, v): (f64, f64) = (0.3, 1.0);
    let inside = (v * v + 2.0).sqrt();
    let deep = p * v / inside;
    let angle = 2.0 * ((p / 2.0).acos() - p.acos() + deep.acos());
    let half = |distance: f64, radius: f64| (radius * radius - distance * distance).sqrt();
    let time = 2.0 * ((half(p, 2.0) - half(p, 1.0)) / v + half(deep, 1.0) / inside);
    assert_near(number(&orbit["period"]), time, 1e-12);
    // The ray along y = 0.3 to the right passes the middle clockwise.
    assert_near(advance(&orbit, 0).cos(), angle.cos(), 1e-12);
    assert_near(advance(&orbit, 0).sin(), -angle.sin(), 1e-12);
    assert_eq!(orbit["modulo"][0]["conserves_momentum"], true);
    let found = multipliers(&orbit);
    assert_eq!(found.len(), 2);
    assert!(
        found.iter().all(|[re, im]| (re - 1.0).hypot(*im) < 1e-6),
        "{found:?}"
    );
}

#[test]
fn a_charge_that_drifts_is_told_so() {
    for gauge in ["B*x*dot(y)", "-B*y*dot(x)"] {
        let text = CROSSED.replace("+ GAUGE", &format!("+ ({gauge})"));
        let words = ["orbit", "-", "--surface", "middle"];
        let missed = run(&text, &words);
        assert_eq!(missed.exit, Exit::Other);
        let drift = "`x` changes by 0.471239 in a return, and the motion does not depend on it";
        for part in [drift, "--modulo \"partial(x)\""] {
            assert!(missed.output.contains(part), "{}", missed.output);
        }
        let told = run(&text, &[&words[..], &["--json", "-"]].concat());
        let told: Value = serde_json::from_str(&told.output).unwrap();
        assert_near(
            number(&told["outcome"]["drift"]["x"]),
            2.0 * PI * 0.3 / 4.0,
            1e-9,
        );
        assert_eq!(told["outcome"]["modulo"], "partial(x)");
        let orbit = document(&text, &[&words[..], &["--modulo", "partial(x)"]].concat());
        assert_near(number(&orbit["period"]), PI, 1e-13);
        assert_near(advance(&orbit, 0), 2.0 * PI * 0.3 / 4.0, 1e-13);
        assert_eq!(orbit["modulo"][0]["conserves_momentum"], true);
        assert_eq!(multipliers(&orbit).len(), 2);
    }
}

#[test]
fn the_missing_sum_of_a_model_with_modes_is_named() {
    let missed = run(
        "",
        &["orbit", "spring_mass_walker", "--surface", "touch_down"],
    );
    assert_eq!(missed.exit, Exit::Other);
    let flag = "--modulo \"partial(x) + partial(foot) + partial(front) + partial(back)\"";
    assert!(missed.output.contains(flag), "{}", missed.output);
}

#[test]
fn a_cart_closes_up_to_motions_of_the_plane() {
    let words = |fields| ["orbit", "-", "--surface", "tick", "--modulo", fields];
    let all = "partial(h) + x*partial(y) - y*partial(x), partial(x), partial(y)";
    let orbit = document(CART, &words(all));
    // The group acts along all directions of the section, so no multiplier is left. In a period of the clock the
    // heading turns by `2 pi w`.
    assert_eq!(multipliers(&orbit).len(), 0);
    assert_near(advance(&orbit, 0), 2.0 * PI * 0.3, 1e-12);
    // `exp(a_0 (turn) + a_1 partial(x) + a_2 partial(y))` turns the plane about `(-a_2, a_1)/a_0`. A run of two periods
    // ends at the image of its start under the turn by twice the angle.
    let a = [0, 1, 2].map(|index| advance(&orbit, index));
    let start = numbers(&orbit["before"]["q"]);
    let given = format!("x={:?},y={:?},h={:?},s=0", start[0], start[1], start[2]);
    let flags = [
        "--initial",
        &given,
        "--until",
        "12.6",
        "--integrator",
        "taylor",
        "--tol",
        "1e-13",
    ];
    let run = document(CART, &[&["simulate", "-"][..], &flags].concat());
    let after = numbers(&run["events"][1]["q_minus"]);
    let (centre, (sin, cos)) = ([-a[2] / a[0], a[1] / a[0]], (2.0 * a[0]).sin_cos());
    let [dx, dy] = [start[0] - centre[0], start[1] - centre[1]];
    assert_near(after[0], centre[0] + cos * dx - sin * dy, 1e-11);
    assert_near(after[1], centre[1] + sin * dx + cos * dy, 1e-11);
    // With the translations alone the orbit does not close. The turn and one translation do not generate a group.
    let missed = run_missed(CART, &words("partial(x), partial(y)"));
    assert!(missed.output.contains("not_converged"), "{}", missed.output);
    let refused = run_missed(
        CART,
        &words("partial(h) + x*partial(y) - y*partial(x), partial(x)"),
    );
    assert!(
        refused
            .errors
            .contains("their commutator is no combination of the fields"),
        "{}",
        refused.errors
    );
}

fn run_missed(input: &str, words: &[&str]) -> Done {
    let done = run(input, words);
    assert_ne!(done.exit, Exit::Reached, "{}", done.output);
    done
}

#[test]
fn fields_that_are_no_symmetries_are_refused_with_the_place() {
    let refused = |words: &[&str], parts: &[&str]| {
        let done = run("", words);
        assert_eq!(done.exit, Exit::Refused, "{}", done.output);
        for part in parts {
            assert!(
                done.errors.contains(part),
                "{part} is not in {}",
                done.errors
            );
        }
    };
    let walker = |fields| {
        [
            "orbit",
            "walker_foot_slip",
            "--surface",
            "step",
            "--modulo",
            fields,
        ]
    };
    refused(
        &walker("partial(theta)"),
        &["--modulo: `partial(theta)` is not a proved symmetry: the motion"],
    );
    refused(
        &walker("partial(x_c), 2*partial(x_c)"),
        &["field 2 is a combination of those before it"],
    );
    refused(&walker("partial(z)"), &["`z` is not a coordinate"]);
    refused(&walker(""), &["--modulo"]);
    let turn = [
        "orbit",
        "point_billiard",
        "--surface",
        "wall",
        "--modulo",
        "x*partial(y) - y*partial(x)",
    ];
    refused(&turn, &["surface `wall`", "rate of the gap along its flow"]);
}

#[test]
fn gaits_are_followed_modulo_a_symmetry() {
    let words = [
        "orbit",
        "walker_foot_slip",
        "--surface",
        "step",
        "--modulo",
        "partial(x_c)",
    ];
    let branch = document(
        "",
        &[&words[..], &["--continue", "alpha=0.1..0.3"]].concat(),
    );
    let points = branch["points"].as_array().unwrap();
    assert_eq!(branch["ends"][1]["kind"], "range");
    let last = points.last().unwrap();
    let orbit = document("", &[&words[..], &["--set", "alpha=0.3"]].concat());
    assert_near(number(&last["period"]), number(&orbit["period"]), 1e-11);
    assert_near(number(&last["advance"][0]), advance(&orbit, 0), 1e-11);
    for ([found, _], [expected, _]) in multipliers(last).into_iter().zip(multipliers(&orbit)) {
        assert_near(found, expected, 1e-9);
    }
    assert!(points.iter().all(|point| point["stability"] == "stable"));
    // The advance of the gait grows along the branch.
    let [one, other] = [&points[points.len() / 2], &points[points.len() / 2 + 1]];
    assert!(number(&one["advance"][0]) < number(&other["advance"][0]));
}

/// Two components: fewer than the generators that a group may have.
#[test]
fn a_group_acts_on_a_system_of_two_components() {
    let text = "
        Ramp {
            coordinates { x; y; }
            field { dot(x) = 1; dot(y) = -1; }
            impacts { floor: y >= 0 => reset { y = 1; }; }
            initial { y = 1; until = 9; }
        }";
    let done = run_on(text, "orbit - --surface floor --modulo partial(x) --json -");
    assert_eq!(done.exit, Exit::Reached, "{}", done.errors);
    let found: Value = serde_json::from_str(&done.output).unwrap();
    let period = found["period"].as_f64().unwrap();
    assert!((period - 1.0).abs() < 1e-12, "{period}");
}

/// Weak damping: all motions tend to 0, and none is periodic, however little it changes in one turn.
#[test]
fn a_motion_that_decays_slowly_is_no_orbit() {
    let text = "
        Weak {
            coordinates { x; v; }
            parameters { c = 1e-7; }
            field { dot(x) = v; dot(v) = -x - c*v; }
            impacts { section: v >= 0 => reset { }; }
            initial { x = 1; v = 0.1; until = 1000; }
        }";
    let done = run_on(text, "orbit - --surface section");
    assert!(!done.output.contains("found in"), "{}", done.output);
}
