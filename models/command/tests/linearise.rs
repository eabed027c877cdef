//! Linearised equations, equilibria and sampled motion against closed forms and differences, and flags that are refused.

// A test may fail by panicking.
#![allow(clippy::unwrap_used)]

mod support;

use dalembert_cli::Exit;
use serde_json::Value;
use support::{Done, run_on};

/// A pole on a cart, with a force on the cart.
const CART: &str = "
    Cart {
        coordinates { x; theta: angle; }
        parameters { M > 0 = 2; m > 0 = 0.5; l > 0 = 0.8; g > 0 = 9.81; }
        inputs { u; }
        lagrangian = M*dot(x)^2/2
            + m*((dot(x) + l*cos(theta)*dot(theta))^2 + (l*sin(theta)*dot(theta))^2)/2 - m*g*l*cos(theta);
        forces { push: u*d(x); }
        outputs { tip: x + l*sin(theta); speed: dot(x)^2; }
    }";

/// A metric that depends on position, a term linear in a velocity, friction, a force that depends on time, and inputs.
const CHARGE: &str = "
    Charge {
        coordinates { x; y; }
        parameters { B = 0.7; k = 0.3; }
        inputs { u; v; }
        lagrangian = (1 + x^2)*(dot(x)^2 + dot(y)^2)/2 + B*x*y*dot(y) - x^2*y;
        forces { drag: -k*dot(x)^3*d(x); wind: (u*x + v^2)*d(y) + sin(t)*d(x); }
        outputs { spin: x*dot(y) - y*dot(x); }
    }";

/// A sleigh whose mass lies ahead of its knife edge.
const SLEIGH: &str = "
    Sleigh {
        coordinates { x; y; theta: angle; }
        parameters { m > 0 = 1.5; I > 0 = 0.4; a = 0.6; }
        inputs { thrust; }
        lagrangian = m*((dot(x) - a*sin(theta)*dot(theta))^2 + (dot(y) + a*cos(theta)*dot(theta))^2)/2 + I*dot(theta)^2/2;
        constraints { edge: -sin(theta)*d(x) + cos(theta)*d(y) = 0; }
        forces { push: thrust*(cos(theta)*d(x) + sin(theta)*d(y)); }
        frame { v: cos(theta)*d(x) + sin(theta)*d(y); w: d(theta); }
        initial { dot(x) = 2; }
    }";

/// A mass on a spring, with a force on the mass.
const SPRING: &str = "
    Spring {
        coordinates { x; }
        parameters { w > 0 = 1.3; }
        inputs { u; }
        lagrangian = dot(x)^2/2 - w^2*x^2/2;
        forces { push: u*d(x); }
        initial { x = 0.4; }
    }";

/// A ball above a floor. Every impact multiplies its speed by `e`.
const BALL: &str = "
    Ball {
        coordinates { x; }
        parameters { g > 0 = 1; e in [0, 1] = 0.8; }
        lagrangian = dot(x)^2/2 - g*x;
        impacts { floor: x >= 0 => newton(e); }
        initial { x = 2; }
    }";

fn linearise(input: &str, line: &str) -> Done {
    run_on(input, &format!("linearise {line}"))
}

fn document(input: &str, line: &str) -> Value {
    let done = linearise(input, &format!("{line} --json -"));
    assert_eq!(done.exit, Exit::Reached, "{} {}", done.output, done.errors);
    serde_json::from_str(&done.output).unwrap()
}

fn matrix(value: &Value) -> Vec<Vec<f64>> {
    serde_json::from_value(value.clone()).unwrap()
}

fn assert_close(found: &Value, expected: &[&[f64]], bound: f64) {
    let found = matrix(found);
    assert_eq!(found.len(), expected.len(), "{found:?}");
    for (row, expected) in found.iter().zip(expected) {
        assert_eq!(row.len(), expected.len(), "{row:?}");
        for (value, expected) in row.iter().zip(*expected) {
            assert!((value - expected).abs() <= bound, "{found:?} {expected:?}");
        }
    }
}

/// By hand: `x'' = (u - m g theta)/M` and `theta'' = ((M + m) g theta - u)/(M l)` near the upright pole.
#[test]
fn a_pole_on_a_cart_has_its_textbook_matrices() {
    let found = document(CART, "- --trim");
    let (m, l, g, big) = (0.5, 0.8, 9.81, 2.0);
    let a: [&[f64]; 4] = [
        &[0.0, 0.0, 1.0, 0.0],
        &[0.0, 0.0, 0.0, 1.0],
        &[0.0, -m * g / big, 0.0, 0.0],
        &[0.0, (big + m) * g / (big * l), 0.0, 0.0],
    ];
    assert_close(&found["A"], &a, 1e-12);
    assert_close(
        &found["B"],
        &[&[0.0], &[0.0], &[1.0 / big], &[-1.0 / (big * l)]],
        1e-14,
    );
    assert_close(&found["C"], &[&[1.0, l, 0.0, 0.0], &[0.0; 4]], 1e-14);
    assert_close(&found["D"], &[&[0.0], &[0.0]], 0.0);
    assert_eq!(found["equilibrium"], true);
    assert_eq!(found["stability"], "unstable");
    let root = ((big + m) * g / (big * l)).sqrt();
    let eigenvalues = matrix(&found["eigenvalues"]);
    assert!(
        eigenvalues.iter().any(|it| (it[0] - root).abs() < 1e-12),
        "{eigenvalues:?}"
    );
}

/// The spring is at rest at `x = 3`, where the gap of the gate is -2. The state is allowed, because the law of the gate
/// is a reset, and motions go on behind it.
#[test]
fn an_equilibrium_may_lie_behind_the_surface_of_a_reset() {
    const GATE: &str = "
        Gate {
            coordinates { x; }
            lagrangian = dot(x)^2/2 - (x - 3)^2/2;
            impacts { gate: x <= 1 => reset { dot(x) = dot(x)/2; }; }
            initial { x = 0; dot(x) = 0; until = 1; }
        }
    ";
    let found = document(GATE, "- --initial x=2.5 --trim");
    let x = found["state"]["x"].as_f64().unwrap();
    assert!((x - 3.0).abs() < 1e-12, "{x}");
    let wall = GATE.replace("reset { dot(x) = dot(x)/2; }", "elastic");
    let refused = linearise(&wall, "- --initial x=2.5 --trim --json -");
    assert_eq!(refused.exit, Exit::Other, "{}", refused.errors);
}

/// A force holds the pole at an angle while the cart accelerates: `a = g tan(theta)`, `u = (M + m) a`.
#[test]
fn only_what_is_free_changes_and_what_moves_may_move() {
    let found = document(CART, "- --initial theta=3 --trim=u --moving x_dot,x");
    let u = found["inputs"]["u"].as_f64().unwrap();
    let acceleration = found["rates"]["x_dot"].as_f64().unwrap();
    let theta = 3.0_f64;
    assert_eq!(found["state"]["theta"], 3.0);
    assert!(
        (acceleration - 9.81 * theta.tan()).abs() < 1e-9,
        "{acceleration}"
    );
    assert!((u - 2.5 * acceleration).abs() < 1e-9, "{u}");
    let refused = linearise(CART, "- --initial theta=3 --trim=u --json -");
    assert_eq!(refused.exit, Exit::Other);
    let refused: Value = serde_json::from_str(&refused.output).unwrap();
    assert_eq!(refused["outcome"]["kind"], "no_equilibrium");
    let reason = refused["outcome"]["reason"].as_str().unwrap();
    assert!(
        reason.contains("no equilibrium was found: the rate of "),
        "{reason}"
    );
}

/// The derivatives are central differences of the rates that `linearise` prints at neighbouring states and inputs.
#[test]
fn derivatives_are_those_of_the_rates() {
    let line = |values: [f64; 6]| {
        let [x, y, p, q, u, v] = values;
        format!("- --at 0.4 --initial x={x},y={y},x_dot={p},y_dot={q} --input u={u} --input v={v}")
    };
    let at = [0.7, -0.4, 1.1, 0.3, 0.2, -0.5];
    let found = document(CHARGE, &line(at));
    let names = ["x", "y", "x_dot", "y_dot"];
    let step = 1e-5;
    for (variable, place) in (0..6).map(|k| (k, if k < 4 { k } else { k - 4 })) {
        let [low, high] = [-step, step].map(|change| {
            let mut values = at;
            values[variable] += change;
            document(CHARGE, &line(values))
        });
        let [state, outputs] = if variable < 4 { ["A", "C"] } else { ["B", "D"] };
        let check = |matrix_name: &str, row: usize, quantity: &str, name: &str| {
            let value = |it: &Value| it[quantity][name].as_f64().unwrap();
            let difference = (value(&high) - value(&low)) / (2.0 * step);
            let derivative = matrix(&found[matrix_name])[row][place];
            assert!(
                (derivative - difference).abs() < 1e-8,
                "{matrix_name} {name}: {derivative} {difference}"
            );
        };
        for (row, name) in names.iter().enumerate() {
            check(state, row, "rates", name);
        }
        check(outputs, 0, "outputs", "spin");
    }
    // The rates are those of `eval`, which computes them by other functions.
    let state = r#"[{"t": 0.4, "q": [0.7, -0.4], "qdot": [1.1, 0.3], "inputs": [0.2, -0.5]}]"#;
    let folder = std::env::temp_dir().join(format!("dalembert-linearise-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let file = folder.join("charge.dal");
    std::fs::write(&file, CHARGE).unwrap();
    let evaluated = run_on(state, &format!("eval {}", file.display()));
    std::fs::remove_dir_all(&folder).unwrap();
    let evaluated: Value = serde_json::from_str(&evaluated.output).unwrap();
    for (index, name) in ["x_dot", "y_dot"].into_iter().enumerate() {
        let acceleration = evaluated[0]["acceleration"][index].as_f64().unwrap();
        let rate = found["rates"][name].as_f64().unwrap();
        assert!(
            (acceleration - rate).abs() < 1e-13,
            "{name}: {acceleration} {rate}"
        );
    }
}

/// At steady sliding with speed `v`, a small rate of turning satisfies `w' = -m a v w/(I + m a^2)`.
#[test]
fn a_steady_motion_of_a_sleigh_is_linearised_in_its_frame() {
    let found = document(SLEIGH, "- --trim=w,thrust --moving x,y,theta");
    let (m, inertia, a, v) = (1.5, 0.4, 0.6, 2.0);
    let rate = -m * a * v / (inertia + m * a * a);
    let rows = matrix(&found["A"]);
    assert_eq!(rows.len(), 5);
    assert!((rows[4][4] - rate).abs() < 1e-13, "{rows:?}");
    assert!(rows[3].iter().all(|entry| entry.abs() < 1e-13), "{rows:?}");
    assert_close(
        &found["B"],
        &[&[0.0], &[0.0], &[0.0], &[1.0 / m], &[0.0]],
        1e-14,
    );
    assert_eq!(found["equilibrium"], true);
}

/// The equilibrium of a pendulum that a constraint holds on its circle lies on the circle.
#[test]
fn an_equilibrium_keeps_the_levels_of_constraints() {
    let rod = "
        Rod {
            coordinates { x; y; }
            lagrangian = (dot(x)^2 + dot(y)^2)/2 - 9*y;
            constraints { rod: d(x^2 + y^2) = 0; }
            frame { turn: x*d(y) - y*d(x); }
            initial { x = 2.4; y = -0.7; }
        }";
    let found = document(rod, "- --trim");
    let value = |name: &str| found["state"][name].as_f64().unwrap();
    assert!(
        value("x").abs() < 1e-9 && (value("y") + 2.5).abs() < 1e-9,
        "{found}"
    );
    let frequency = (9.0_f64 / 2.5).sqrt();
    let eigenvalues = matrix(&found["eigenvalues"]);
    assert!(
        eigenvalues
            .iter()
            .any(|it| (it[1] - frequency).abs() < 1e-9),
        "{eigenvalues:?}"
    );
    assert_eq!(found["stability"], "undecided");
}

/// `Phi` and `Gamma` of an oscillator in closed form.
/// A free charge in the field `(2, 1, 1)`: the velocity turns at the rate `sqrt(6)`. The diagonal of the matrix is 0.
#[test]
fn a_matrix_without_a_diagonal_has_eigenvalues() {
    let charge = "
        Charge {
            coordinates { x; y; z; }
            lagrangian = (dot(x)^2 + dot(y)^2 + dot(z)^2)/2 + x*dot(y) + 2*y*dot(z) + z*dot(x);
        }";
    let found = document(charge, "-");
    let eigenvalues = found["eigenvalues"].as_array().expect("eigenvalues");
    let imaginary = |it: &Value| it[1].as_f64().expect("a number").abs();
    let turning = eigenvalues
        .iter()
        .filter(|it| (imaginary(it) - 6f64.sqrt()).abs() < 1e-14);
    assert_eq!((turning.count(), eigenvalues.len()), (2, 6));
}

#[test]
fn a_sampled_oscillator_has_its_exact_matrices() {
    let found = document(SPRING, "- --input u=0.3 --every 0.9 --samples 3");
    let (w, h) = (1.3_f64, 0.9_f64);
    let (sin, cos) = (w * h).sin_cos();
    let samples = found["samples"].as_array().unwrap();
    assert_eq!(samples.len(), 3);
    for sample in samples {
        assert_close(&sample["Phi"], &[&[cos, sin / w], &[-w * sin, cos]], 1e-13);
        assert_close(
            &sample["Gamma"],
            &[&[(1.0 - cos) / (w * w)], &[sin / w]],
            1e-13,
        );
    }
    assert_eq!(samples[0]["next"], samples[1]["state"]);
    assert_eq!(found["equilibrium"], false);
    assert!(found["stability"].is_null());
}

/// A ball that falls from rest hits the floor at `sqrt(2 x/g)`. The derivatives of its motion afterwards are computed
/// by hand.
#[test]
fn samples_go_across_impacts() {
    let found = document(BALL, "- --every 2.5 --samples 1");
    let sample = &found["samples"][0];
    assert_eq!(sample["impacts"], 1);
    let (x, e, t) = (2.0_f64, 0.8, 2.5_f64);
    // After the impact at T = v + sqrt(v^2 + 2 x) the speed is s = e sqrt(v^2 + 2 x), and the height is
    // s (t - T) - (t - T)^2/2. Here v = 0.
    let root = (2.0 * x).sqrt();
    let (time, speed) = (root, e * root);
    let (by_x, by_v) = ([1.0 / root, e / root], [1.0, 0.0]);
    let left = t - time;
    let position = |by: [f64; 2]| by[1] * left - speed * by[0] + left * by[0];
    let velocity = |by: [f64; 2]| by[1] + by[0];
    assert_close(
        &sample["Phi"],
        &[
            &[position(by_x), position(by_v)],
            &[velocity(by_x), velocity(by_v)],
        ],
        1e-12,
    );
    let next = matrix(&Value::Array(vec![sample["next"].clone()]));
    assert!((next[0][0] - (speed * left - left * left / 2.0)).abs() < 1e-12);
    // If impacts accumulate before the sample, the motion has no derivative.
    let ended = linearise(BALL, "- --every 25 --samples 1");
    assert_eq!(ended.exit, Exit::Other);
    assert!(
        ended.output.contains("the sampled motion ends at t = "),
        "{}",
        ended.output
    );
}

#[test]
fn the_summary_names_rows_and_columns() {
    let done = linearise(CART, "- --trim --every 0.1");
    for line in [
        ", linearised at t = 0\n",
        "  equilibrium yes\n",
        "    d/dt theta_dot  0  15.328125000 ",
        "  stability   unstable: 1 eigenvalue has a positive real part\n",
        "  sample from t = 0 to t = 0.1, 0 impacts\n",
        "    next      x = 0.0, theta = 0.0, x_dot = 0.0, theta_dot = 0.0\n",
        "  Gamma",
    ] {
        assert!(done.output.contains(line), "{line}: {}", done.output);
    }
}

#[test]
fn flags_that_make_no_sense_are_refused() {
    for (input, line, reason) in [
        (CART, "- --trim=w", "unknown component or input `w`"),
        (CART, "- --trim --moving u", "unknown component `u`"),
        (CART, "- --moving x", "--trim"),
        (CART, "- --samples 2", "--every"),
        (CART, "- --input w=1", "unknown input `w`"),
        (SWITCHED, "- --mode of", "unknown mode `of`"),
    ] {
        let refused = linearise(input, line);
        assert_eq!(refused.exit, Exit::Refused, "{line}: {}", refused.output);
        assert!(
            refused.errors.contains(reason),
            "{line}: {}",
            refused.errors
        );
    }
}

/// A mass that moves freely until it touches a plate on a spring, with a force on the mass.
const SWITCHED: &str = "
    Switched {
        coordinates { x; }
        parameters { m > 0 = 2; k > 0 = 3; }
        inputs { u; }
        modes {
            free { lagrangian = m/2*dot(x)^2; forces { motor: u*d(x); } outputs { speed: dot(x); } }
            plate {
                coordinates { z; }
                lagrangian = m/2*dot(x)^2 + dot(z)^2/2 - k/2*(x - z)^2;
                forces { motor: u*d(x); }
                outputs { stretch: x - z; }
            }
        }
        transitions { touch: free -> plate when x >= 1 => reset { z = x; dot(z) = 0; }; }
        initial { dot(x) = 1; }
    }";

/// The equilibrium -1 of a mass on a spring is refused if it lies outside of the interval of the coordinate or behind a
/// floor. The angle at which a torque holds a pendulum is found.
#[test]
fn an_equilibrium_is_a_state_that_the_model_allows() {
    for (coordinate, surface) in [("x in (0.5, 3)", ""), ("x", "impacts { floor: x >= 0; }")] {
        let text = format!(
            "Spring {{ coordinates {{ {coordinate}; }} lagrangian = dot(x)^2/2 - (x + 1)^2/2; {surface} initial {{ x = 1; }} }}"
        );
        let done = run_on(&text, "linearise - --trim");
        assert_eq!(done.exit, Exit::Other, "{}", done.output);
        let expected = "no equilibrium was found: the rate of x_dot stays";
        assert!(done.output.contains(expected), "{}", done.output);
    }
    let text = "
        Held {
            coordinates { th: angle; }
            lagrangian = dot(th)^2/2 + cos(th);
            forces { torque: (1/2)*d(th); }
            initial { th = 1.57; }
        }";
    let done = run_on(text, "linearise - --trim --json -");
    assert_eq!(done.exit, Exit::Reached, "{}", done.errors);
    let document: Value = serde_json::from_str(&done.output).unwrap();
    let angle = document["state"]["th"].as_f64().unwrap();
    assert!((angle.sin() - 0.5).abs() < 1e-12, "{angle}");
    assert!((angle - 1.57).abs() <= std::f64::consts::PI, "{angle}");
}

#[test]
fn a_mode_is_linearised_as_a_model_of_its_own() {
    let document = |flags: &str| {
        let done = run_on(SWITCHED, &format!("linearise - {flags} --json -"));
        assert_eq!(done.exit, Exit::Reached, "{}", done.errors);
        serde_json::from_str::<Value>(&done.output).unwrap()
    };
    let free = document("--input u=2");
    assert_eq!(free["mode"], "free");
    assert_eq!(free["A"], serde_json::json!([[0.0, 1.0], [0.0, 0.0]]));
    assert_eq!(free["B"], serde_json::json!([[0.0], [0.5]]));
    assert_eq!(free["rates"]["x_dot"], 1.0);
    assert_eq!(free["C"], serde_json::json!([[0.0, 1.0]]));
    let plate = document("--mode plate --set k=4 --initial x=1,z=0.5,x_dot=0");
    assert_eq!(plate["mode"], "plate");
    let a = [
        [0.0, 0.0, 1.0, 0.0],
        [0.0, 0.0, 0.0, 1.0],
        [-2.0, 2.0, 0.0, 0.0],
        [4.0, -4.0, 0.0, 0.0],
    ];
    assert_eq!(plate["A"], serde_json::json!(a));
    assert_eq!(plate["B"], serde_json::json!([[0.0], [0.0], [0.5], [0.0]]));
    assert_eq!(plate["C"], serde_json::json!([[1.0, -1.0, 0.0, 0.0]]));
    assert_eq!(plate["outputs"]["stretch"], 0.5);
}

#[test]
fn a_sampled_motion_ends_where_it_leaves_the_mode() {
    let done = run_on(SWITCHED, "linearise - --every 0.4 --samples 2");
    assert_eq!(done.exit, Exit::Reached, "{}", done.errors);
    assert!(
        done.output.contains(", mode free, linearised"),
        "{}",
        done.output
    );
    let done = run_on(SWITCHED, "linearise - --every 0.4 --samples 3");
    assert_eq!(done.exit, Exit::Other, "{}", done.output);
    assert!(
        done.output.contains("the sampled motion ends at t = 1"),
        "{}",
        done.output
    );
}

/// The least torque that holds a pendulum horizontal. Two equilibria meet there: one eigenvalue is 0, and only half of
/// the digits of the state are determined.
#[test]
fn the_stability_of_a_fold_is_open() {
    let text = "
        Buckling {
            coordinates { th: angle; }
            parameters { T = 1; c = 0.5; }
            lagrangian = dot(th)^2/2 + cos(th);
            forces { torque: T*d(th) - c*dot(th)*d(th); }
            initial { th = 1; }
        }";
    let stability = |flags: &str| {
        let done = run_on(text, &format!("linearise - --trim {flags}"));
        assert_eq!(done.exit, Exit::Reached, "{}", done.errors);
        done.output
    };
    let told = stability("--set T=1");
    assert!(told.contains("not decided"), "{told}");
    // A larger torque turns the pendulum on and on.
    let done = run_on(text, "linearise - --trim --set T=1.000000000001");
    assert!(
        done.output.contains("no equilibrium was found"),
        "{}",
        done.output
    );
    // For a smaller torque, the lower equilibrium is stable and the upper one is not.
    assert!(stability("--set T=0.9").contains("stable: all real parts are negative"));
    let upper = stability("--set T=0.9 --initial th=2");
    assert!(upper.contains("unstable"), "{upper}");
}

/// At a multiple root the eigenvalue is 0. The search ends near the root, where it is not.
#[test]
fn the_stability_at_a_multiple_root_is_open() {
    for field in [
        "dot(x) = -x^3; dot(y) = -y;",
        "dot(x) = x^2; dot(y) = -y;",
        "dot(x) = -x^3 + 3*x^2 - 3*x + 1; dot(y) = -y;",
        "dot(x) = -x^3; dot(y) = -y + x^3;",
        "dot(x) = -(x^2 - 2*x + 1); dot(y) = -y;",
        "dot(x) = exp(x - 1) - x; dot(y) = -y;",
        "dot(x) = -(cosh(x) - 1); dot(y) = -y;",
        "dot(x) = sin(x) - x; dot(y) = -y;",
        "dot(x) = x - tan(x); dot(y) = -y;",
        "dot(x) = 0.25 - x + x^2; dot(y) = -y;",
        "dot(x) = -(x^3 - 9*x^2 + 24*x - 20); dot(y) = x - 2 - y;",
    ] {
        let text = format!("M {{ coordinates {{ x; y; }} field {{ {field} }} }}");
        let done = run_on(&text, "linearise - --trim --initial x=1.2,y=0.3");
        assert_eq!(done.exit, Exit::Reached, "{field}: {}", done.errors);
        let told = &done.output;
        assert!(told.contains("equilibrium yes"), "{field}: {told}");
        let open = "1 eigenvalue with real part 0 up to rounding";
        assert!(told.contains(open), "{field}: {told}");
    }
}

/// The rates become small, but there is no equilibrium.
#[test]
fn slow_motion_is_no_equilibrium() {
    for (model, start) in [
        (
            "M { coordinates { x; } field { dot(x) = exp(-x); } }",
            "x=1",
        ),
        (
            "M { coordinates { x; } field { dot(x) = exp(-x); } }",
            "x=30",
        ),
        (
            "M { coordinates { x; } lagrangian = dot(x)^2/2 + exp(-x); forces { f: -dot(x)*d(x); } }",
            "x=5",
        ),
        (
            "M { coordinates { x; } field { dot(x) = 1e-12*(2 + sin(x)); } }",
            "x=1",
        ),
        ("M { coordinates { x; } field { dot(x) = 1e-12; } }", "x=1"),
    ] {
        for trim in ["--trim", ""] {
            let line = format!("linearise - {trim} --initial {start}");
            let done = run_on(model, &line);
            let told = [done.output, done.errors].concat();
            let is_said = told.contains("no equilibrium") || told.contains("equilibrium no");
            assert!(is_said && !told.contains("stability"), "{model}: {told}");
        }
    }
}

/// By its eigenvalues at any time, the first model is stable. It has the motion `exp(t/2) (cos(t), -sin(t))`.
#[test]
fn eigenvalues_at_one_time_decide_nothing() {
    let grows = "M {
        coordinates { x; y; }
        field {
            dot(x) = (-1 + 1.5*cos(t)^2)*x + (1 - 1.5*sin(t)*cos(t))*y;
            dot(y) = (-1 - 1.5*sin(t)*cos(t))*x + (-1 + 1.5*sin(t)^2)*y;
        }
    }";
    let told = run_on(grows, "linearise - --trim --initial x=0.01").output;
    assert!(told.contains("equilibrium yes"), "{told}");
    assert!(told.contains("the equations depend on time"), "{told}");
    let driven = "M { coordinates { x; } lagrangian = dot(x)^2/2 - x^2/2; forces { f: cos(t)*d(x) - dot(x)*d(x); } }";
    let told = run_on(driven, "linearise - --trim --initial x=0.1").output;
    let unsteady = "equilibrium no: at t = 0.1 the rates are not 0";
    assert!(told.contains(unsteady), "{told}");
}

#[test]
fn a_kink_at_an_equilibrium_leaves_its_stability_open() {
    // On one side of x = 0 the motion is that of a saddle, and of a damped oscillator on the other.
    let half = "M { coordinates { x; } lagrangian = dot(x)^2/2; forces { f: -abs(x)*d(x) - dot(x)*d(x); } initial { until = 1; } }";
    let first = "M { coordinates { x; } field { dot(x) = -abs(x); } initial { until = 1; } }";
    let root = "M { coordinates { x; y; } lagrangian = (dot(x)^2 + dot(y)^2)/2 - (x + y) - x^2 - y^2; \
        forces { f: (1 + abs(x - y))*d(x) + d(y) - dot(x)*d(x) - dot(y)*d(y); } initial { until = 1; } }";
    // Close to 0, rounding hides the kink.
    let pendulum = "M { coordinates { th: angle; } lagrangian = dot(th)^2/2 - 9.81*(1 - cos(th)); \
        forces { f: -dot(th)*d(th); p: 20*sqrt(2 - 2*cos(th))*d(th); } initial { until = 1; } }";
    // The slope of the root is infinite at 0, although the chain rule gives 0 there.
    let cusp = "M { coordinates { x; } field { dot(x) = -x + 2*(x^2)^(1/3); } }";
    let ridge =
        "M { coordinates { x; y; } field { dot(x) = -x + 2*(x^2*y^2)^(1/4); dot(y) = -y; } }";
    let pushed = "M { coordinates { x; } lagrangian = (dot(x)^2 - x^2)/2; \
        forces { f: 2*(x^2)^(1/3)*d(x) - dot(x)*d(x); } }";
    // Large derivatives of other rates, and tiny units, hide no kink.
    let stiff_beside = "M { coordinates { x; v; z; } field { dot(x) = v; dot(v) = -1e12*x - 1e-3*v; dot(z) = -z + 2*abs(z); } }";
    let light = "M { coordinates { x; } parameters { m > 0 = 1e-26; } lagrangian = m*(dot(x)^2 - x^2)/2; \
        forces { f: -m*dot(x)*d(x) + m*abs(x)*d(x); } }";
    for (model, across) in [
        (stiff_beside, "`z`"),
        (light, "`x`"),
        (cusp, "`x`"),
        (ridge, "`x` and of `y`"),
        (pushed, "`x`"),
        (half, "`x`"),
        (first, "`x`"),
        (root, "`x` and of `y`"),
        (pendulum, "`th`"),
    ] {
        let found = run_on(model, "linearise -");
        assert_eq!(found.exit, Exit::Reached, "{}", found.errors);
        let expected = format!("at this value of {across}, derivatives of the rates jump");
        assert!(found.output.contains(&expected), "{}", found.output);
    }
    // Slopes that vary over short distances are no kink.
    let steep = "M { coordinates { x; } lagrangian = dot(x)^2/2 - x^2 - 1000*x^4 - 1e5*x^3; \
        forces { f: -dot(x)*d(x); } initial { until = 1; } }";
    let atoms = "M { coordinates { x; } parameters { m > 0 = 6.6e-26; s > 0 = 3.4e-10; e > 0 = 1.65e-21; c = 1e-13; } \
        lagrangian = m*dot(x)^2/2 - 4*e*((s/x)^12 - (s/x)^6); forces { drag: -c*dot(x)*d(x); } \
        initial { x = 3.8163709642252e-10; until = 1; } }";
    let narrow = "M { coordinates { x; } field { dot(x) = -x + 3*(sqrt(1e-16 + x^2) - 1e-8); } initial { until = 1; } }";
    // A frequency of 1e6 and a damping of 1e-3.
    let stiff = "M { coordinates { x; v; } field { dot(x) = v; dot(v) = -1e12*x - 1e-3*v; } initial { until = 1; } }";
    for smooth in [steep, atoms, narrow, stiff] {
        let found = run_on(smooth, "linearise -");
        assert!(
            found.output.contains("stable: all real parts are negative"),
            "{}",
            found.output
        );
    }
    let output = "M { coordinates { x; } lagrangian = dot(x)^2/2 - x^2; initial { x = 1; } outputs { i: 1/(x - 1); } }";
    let found = run_on(output, "linearise -");
    assert!(
        found.output.contains("the output `i`, or its derivative"),
        "{}",
        found.output
    );
    // All derivatives of a rate are 0 at the equilibrium.
    let flat =
        "M { coordinates { x; y; } field { dot(x) = y^2; dot(y) = y; } initial { until = 1; } }";
    let found = run_on(flat, "linearise -");
    assert!(
        found
            .output
            .contains("unstable: 1 eigenvalue has a positive real part"),
        "{}",
        found.output
    );
}

#[test]
fn eigenvalues_that_rounding_moves_across_the_axis_leave_the_stability_open() {
    // All eigenvalues are -1, and those that are found are not: A + 1 is nilpotent.
    let nilpotent = "M { coordinates { x; y; z; } parameters { k = 1e5; } field { dot(x) = -x + k*(x + y + 3*z); \
        dot(y) = -y + k*(5*x + 2*y + 6*z); dot(z) = -z + k*(-2*x - y - 3*z); } initial { until = 1; } }";
    for k in ["1e5", "3e5", "7e5", "3e6"] {
        let found = run_on(nilpotent, &format!("linearise - --set k={k}"));
        assert!(
            found
                .output
                .contains("3 eigenvalues with real part 0 up to rounding"),
            "{}",
            found.output
        );
    }
    let found = run_on(nilpotent, "linearise - --set k=1");
    assert!(
        found.output.contains("stable: all real parts"),
        "{}",
        found.output
    );
}
