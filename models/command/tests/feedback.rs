//! Closed loops: `--feedback` against declarations with the law written out and against closed forms, and laws that are
//! refused.

// A test may fail by panicking.
#![allow(clippy::unwrap_used)]

mod support;

use dalembert_cli::Exit;
use serde_json::Value;
use support::{Done, run_on};

/// A cart with two inputs and a wall. The first input enters an output, too.
const CART: &str = "
    Cart {
        coordinates { x; }
        parameters { k > 0 = 4; c = 0; }
        inputs {
            /// The drive.
            u;
            wind; // without a law in some tests
        }
        lagrangian = dot(x)^2/2;
        cost { running = u^2 + wind^2; }
        forces { push: (u + wind)*d(x); }
        impacts { wall: x <= 1 => newton(1/2); }
        outputs { power: u*dot(x); }
        initial { x = 0.5; until = 6; }
    }";

/// Two independent masses, each with a thrust.
const ROD: &str = "
    Rod {
        const N = 2;
        coordinates { x[N]; }
        inputs { thrust[N]; }
        lagrangian = sum(i in 1..=N: dot(x[i])^2)/2;
        forces { push: sum(i in 1..=N: thrust[i]*d(x[i])); }
        initial { x[1] = 1; x[2] = 2; until = 1; }
    }";

/// A mass that is four times as heavy from `x = 1/2` down.
const TABLE: &str = "
    Table {
        coordinates { x; }
        inputs { u; }
        modes {
            smooth { lagrangian = dot(x)^2/2; forces { push: u*d(x); } }
            heavy { lagrangian = 2*dot(x)^2; forces { push: u*d(x); } }
        }
        transitions { over: smooth -> heavy when 0.5 - x >= 0 => reset { dot(x) = dot(x); }; }
        initial { x = 1; until = 2; }
    }";

fn ran(text: &str, line: &str) -> Value {
    let done = run_on(text, line);
    assert_eq!(done.exit, Exit::Reached, "{line}: {}", done.errors);
    serde_json::from_str(&done.output).unwrap()
}

fn refused(text: &str, line: &str) -> String {
    let Done { exit, errors, .. } = run_on(text, line);
    assert_eq!(exit, Exit::Refused, "{line}");
    errors
}

fn written(text: &str, law: &str) -> String {
    let (head, rest) = text.split_once("inputs {").unwrap();
    let (_, rest) = rest.split_once('}').unwrap();
    let rest = rest.replace("cost { running = u^2 + wind^2; }", "");
    let rest = rest.replace("(u + wind)", &format!("({law})"));
    format!("{head} {}", rest.replace("u*dot(x)", "-k*x*dot(x)"))
}

/// Runs of the closed loop and its linearisation are those of the model with the law written out.
#[test]
fn a_closed_loop_is_the_model_with_the_law_written_out() {
    let laws = "--feedback u=-k*x --feedback wind=sin(3*t)/10-c*dot(x)";
    let text = written(CART, "-k*x + sin(3*t)/10 - c*dot(x)");
    for line in [
        "simulate - --set c=0.1 --initial x=0.9,x_dot=2 --integrator taylor --json -",
        "simulate - --set k=5 --initial x_dot=-3 --integrator gauss6 --json -",
        "linearise - --initial x=0.9,x_dot=2 --every 0.7 --samples 4 --json -",
    ] {
        let [closed, written] = [(CART, laws), (text.as_str(), "")].map(|(text, laws)| {
            let mut document = ran(text, &format!("{line} {laws}"));
            document.as_object_mut().unwrap().remove("seconds");
            document
        });
        assert_eq!(closed, written, "{line}");
    }
}

/// The derivatives of `x = x_0 cos(2 t) + v_0 sin(2 t)/2` with respect to `x_0` and `v_0`, before the wall.
#[test]
fn derivatives_of_a_closed_loop_are_those_of_its_closed_form() {
    let line = "linearise - --feedback u=-k*x --feedback wind=0 --initial x=0.3,x_dot=0 --every 0.5 --samples 1 --json -";
    let document = ran(CART, line);
    let transition = &document["samples"][0]["Phi"];
    let entry = |row: usize, column: usize| transition[row][column].as_f64().unwrap();
    let (sin, cos) = 1.0_f64.sin_cos();
    let expected = [[cos, sin / 2.0], [-2.0 * sin, cos]];
    for row in 0..2 {
        for column in 0..2 {
            let difference = entry(row, column) - expected[row][column];
            assert!(difference.abs() < 1e-14, "{row} {column}: {difference:e}");
        }
    }
}

/// An input without a law still takes the value of `--input`. The cost stays as long as an input is left.
#[test]
fn inputs_without_a_law_stay() {
    let half = "simulate - --feedback u=-k*x --input wind=0.3 --json -";
    let whole = "simulate - --feedback u=-k*x --feedback wind=0.3 --json -";
    let [half, whole] =
        [half, whole].map(|line| ran(CART, line)["outcome"]["q"][0].as_f64().unwrap());
    assert!((half - whole).abs() < 1e-12, "{half} {whole}");
    let left = run_on(CART, "derive - --feedback u=-k*x --control");
    assert_eq!(left.exit, Exit::Reached, "{}", left.errors);
    let none = refused(
        CART,
        "derive - --feedback u=-k*x --feedback wind=0 --control",
    );
    assert!(none.contains("cost"), "{none}");
}

/// Laws for the members of a family, one by one and all at once: `x[i]` oscillates at the frequency `i`.
#[test]
fn families_of_inputs_have_laws() {
    let all = ran(
        ROD,
        "simulate - --feedback 'thrust[i in 1..=2]=-i^2*x[i]' --tol 1e-13 --json -",
    );
    let each = ran(
        ROD,
        "simulate - --feedback thrust.1=-x[1] --feedback thrust[2]=-4*x[2] --tol 1e-13 --json -",
    );
    for document in [all, each] {
        let q = &document["outcome"]["q"];
        for (place, expected) in [1.0_f64.cos(), 2.0 * 2.0_f64.cos()].into_iter().enumerate() {
            let value = q[place].as_f64().unwrap();
            assert!((value - expected).abs() < 1e-11, "{place}: {value}");
        }
    }
    let errors = refused(ROD, "simulate - --feedback thrust.1=-x[1]");
    assert!(errors.contains("thrust"), "{errors}");
}

/// One law acts in every mode: the motion is `x = cos(t)` until `x = 1/2`, and from there on `x'' = -x/4`.
#[test]
fn modes_share_a_law() {
    let document = ran(TABLE, "simulate - --feedback u=-x --tol 1e-13 --json -");
    let crossing = std::f64::consts::FRAC_PI_3;
    let event = document["events"][0]["t"].as_f64().unwrap();
    assert!((event - crossing).abs() < 1e-12, "{event}");
    let (sin, cos) = ((2.0 - crossing) / 2.0).sin_cos();
    let expected = 0.5 * cos - 2.0 * (3.0_f64.sqrt() / 2.0) * sin;
    let x = document["outcome"]["q"][0].as_f64().unwrap();
    assert!((x - expected).abs() < 1e-11, "{x} {expected}");
}

/// Every start of a map and every member of an ensemble is run with the law.
#[test]
fn sweeps_run_closed_loops() {
    let line = "map - --feedback u=-4*x --feedback wind=0 --vary x=0.1..0.5:5 --until 1 --csv -";
    let done = run_on(CART, line);
    assert_eq!(done.exit, Exit::Reached, "{}", done.errors);
    assert_eq!(
        done.output
            .lines()
            .filter(|line| line.contains("done"))
            .count(),
        5,
        "{}",
        done.output
    );
    let line =
        "ensemble - --feedback u=-4*x --feedback wind=0 --vary x=0.1..0.5:5 --until 1 --csv -";
    let done = run_on(CART, line);
    assert_eq!(done.exit, Exit::Reached, "{}", done.errors);
    let ends = done.output.lines().skip(1).count();
    assert_eq!(ends, 5, "{}", done.output);
}

#[test]
fn laws_that_cannot_be_used_are_refused() {
    for (law, words) in [
        ("v=-x", "--feedback: unknown input `v`"),
        ("u", "--feedback: `u` is not accepted; expected INPUT=LAW"),
        ("u=", "write one expression"),
        ("'u=1; let y = 2'", "write one expression"),
        ("u=-y", "unknown name `y`"),
        ("u=ddot(x)", "ddot"),
        ("'u=1)'", "write one expression"),
    ] {
        let errors = refused(CART, &format!("simulate - --feedback {law}"));
        assert!(errors.contains(words), "{law}: {errors}");
    }
    let errors = refused(CART, "simulate - --feedback u=1 --feedback u=2");
    assert!(errors.contains("input `u` has two laws"), "{errors}");
    let errors = refused("", "simulate bouncing_ball --feedback u=1");
    assert!(errors.contains("the model has no inputs"), "{errors}");
    let errors = refused(CART, "simulate - --input u=-k*x");
    assert!(errors.contains("--feedback u=-k*x"), "{errors}");
}
