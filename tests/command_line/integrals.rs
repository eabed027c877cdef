//! Outputs that are integrals along a run, declared or given as flags, compared with closed forms.

use std::fs;

use super::folder::Folder;
use super::tables::{column, numbers_of};
use super::{Done, Exit, run_on};

/// A ball over a floor, with the action and the time as integrals.
const BALL: &str = "
    Ball {
        coordinates { x; }
        lagrangian = dot(x)^2/2 - x;
        impacts { floor: x >= 0; }
        outputs { S: integral(lagrangian); clock: integral(1); speed: dot(x); }
        initial { until = 5; }
    }";

/// A particle that a constant force pulls in the second of two layers.
const LAYERS: &str = "
    Layers {
        coordinates { x; }
        modes {
            left { lagrangian = dot(x)^2/2; initial { x = -1; dot(x) = 1; until = 3; } outputs { way: integral(dot(x)); pulled: integral(0); } }
            right { lagrangian = dot(x)^2/2 + x; outputs { way: integral(dot(x)); pulled: integral(1); } }
        }
        transitions { go: left -> right when x >= 0; }
    }";

/// A mass that is pushed.
const PUSHED: &str = "
    Pushed {
        coordinates { x; }
        inputs { u; }
        lagrangian = dot(x)^2/2;
        forces { push: u*d(x); }
        outputs { effort: integral(u^2); place: x; }
        initial { until = 2; }
    }";

/// Initial speed and action of the motions of the ball from x = 0 to x = 0.2 at t = 5, with no impact and with one.
const ACTIONS: [(f64, f64); 2] = [
    (2.54, -5.704_333_333_333_333),
    (1.291_369_123_503_562, -1.539_814_194_880_541),
];

fn on(model: &str, words: &[&str]) -> Done {
    run_on(model, words)
}

fn table(model: &str, line: &str) -> String {
    let words: Vec<&str> = line.split_whitespace().collect();
    let done = on(model, &[&words[..], &["--csv", "-"]].concat());
    assert_eq!(done.exit, Exit::Reached, "{}", done.errors);
    done.output
}

fn last(table: &str, name: &str) -> f64 {
    *numbers_of(table, name).last().unwrap()
}

#[test]
fn the_action_of_a_ball_is_that_of_the_motion_between_two_points() {
    for (speed, action) in ACTIONS {
        for (integrator, bound) in [("dop853", 1e-9), ("taylor", 1e-12), ("gauss6", 1e-6)] {
            let line = format!(
                "simulate - --initial x=0,x_dot={speed} --integrator {integrator} --tol 1e-13"
            );
            let table = table(BALL, &line);
            let found = last(&table, "S");
            assert!((found - action).abs() < bound, "{line}: {found}");
            for (t, clock) in numbers_of(&table, "t")
                .iter()
                .zip(numbers_of(&table, "clock"))
            {
                assert!((t - clock).abs() < 1e-12, "{clock} at {t}");
            }
        }
    }
}

#[test]
fn its_value_does_not_depend_on_the_times_that_are_recorded() {
    let at = |samples: u32| {
        let line = format!("simulate - --initial x=0,x_dot=1.3 --samples {samples}");
        last(&table(BALL, &line), "S").to_bits()
    };
    assert_eq!(at(2), at(777));
}

#[test]
fn impacts_add_nothing_and_show_the_value_of_their_time() {
    let line = "simulate - --initial x=0,x_dot=1 --samples 3 --tol 1e-13";
    let table = table(BALL, line);
    let marked: Vec<(String, f64)> = (column(&table, "event").into_iter())
        .zip(numbers_of(&table, "S"))
        .filter(|(event, _)| !event.is_empty())
        .collect();
    assert!(marked.len() >= 2, "{table}");
    // Action of a flight that starts with speed 1 and lasts 2: the integral of (1 - t)^2/2 - t + t^2/2.
    let flight = -1.0 / 3.0;
    for (index, (event, action)) in marked.iter().enumerate() {
        let flights = (index + 1) as f64;
        assert!(
            (action - flights * flight).abs() < 1e-11,
            "{event}: {action}"
        );
    }
}

#[test]
fn an_integral_goes_on_through_modes() {
    let table = table(LAYERS, "simulate - --tol 1e-13");
    let x = last(&table, "x");
    assert!((last(&table, "way") - (x + 1.0)).abs() < 1e-11);
    assert!((last(&table, "pulled") - 2.0).abs() < 1e-11);
}

#[test]
fn ensembles_have_the_integrals_of_single_runs() {
    for integrator in ["taylor", "dop853"] {
        let line =
            format!("ensemble - --initial x=0 --vary x_dot=1..2:9 --integrator {integrator}");
        let many = table(BALL, &line);
        assert_eq!(numbers_of(&many, "out.S").len(), 9);
        for (speed, action) in numbers_of(&many, "in.x_dot")
            .iter()
            .zip(numbers_of(&many, "out.S"))
        {
            let line = format!("simulate - --initial x=0,x_dot={speed} --integrator {integrator}");
            assert_eq!(last(&table(BALL, &line), "S"), action, "{line}");
        }
    }
}

#[test]
fn inputs_of_a_table_are_integrated() {
    let folder = Folder::new("integrals");
    let path = folder.path("inputs.csv");
    fs::write(&path, "t,u\n0,0\n1,1\n1,3\n2,3\n").unwrap();
    let line = format!("simulate - --inputs {path} --between linear");
    let found = last(&table(PUSHED, &line), "effort");
    assert!((found - (1.0 / 3.0 + 9.0)).abs() < 1e-9, "{found}");
}

#[test]
fn linearised_equations_leave_integrals_out() {
    let words = ["linearise", "-", "--input", "u=0", "--json", "-"];
    let document = on(PUSHED, &words).json();
    assert_eq!(
        document["outputs"].as_object().unwrap().len(),
        1,
        "{document}"
    );
    assert_eq!(document["C"].as_array().unwrap().len(), 1);
}

#[test]
fn flags_add_outputs() {
    let run = |outputs: &[&str]| {
        let mut words = vec!["simulate", "-", "--initial", "x=0,x_dot=2.54", "--csv", "-"];
        outputs
            .iter()
            .for_each(|output| words.extend(["--output", output]));
        on(BALL, &words)
    };
    let done = run(&["W = integral(momentum(x)*dot(x))", "double = 2*x"]);
    let x = numbers_of(&done.output, "x");
    let doubles = numbers_of(&done.output, "double");
    assert!(x.len() > 2);
    assert!(x.iter().zip(&doubles).all(|(x, double)| 2.0 * x == *double));
    // The abbreviated action W is the action plus the energy times the time.
    let energy = 2.54 * 2.54 / 2.0;
    let expected = last(&done.output, "S") + 5.0 * energy;
    assert!((last(&done.output, "W") - expected).abs() < 1e-9);
    for (output, message) in [
        ("W", "NAME = EXPR"),
        ("S = x", "`S`"),
        ("a,b = x", "a word"),
        (
            "W = 1 + integral(x)",
            "an integral along a run must be the whole output",
        ),
        ("W = integral(z)", "unknown name `z`"),
        ("W > x", "NAME = EXPR"),
    ] {
        let done = run(&[output]);
        assert_eq!(done.exit, Exit::Refused, "{output}");
        assert!(done.errors.contains("--output"), "{}", done.errors);
        assert!(done.errors.contains(message), "{}", done.errors);
    }
}

#[test]
fn a_map_has_columns_and_a_picture_of_ends() {
    let folder = Folder::new("ends");
    let picture = folder.path("ends.svg");
    let words = |axes: &str| -> Vec<String> {
        let line = "map - --initial x=0 --vary x_dot=1..2:9 --csv - --plot";
        let mut words: Vec<String> = line.split(' ').map(str::to_owned).collect();
        words.extend([picture.clone(), "--output".into(), "W = integral(1)".into()]);
        words.extend(["--axes".into(), axes.to_owned()]);
        words
    };
    let run = |axes: &str| {
        let words = words(axes);
        on(BALL, &words.iter().map(String::as_str).collect::<Vec<_>>())
    };
    let done = run("x,W");
    assert_eq!(done.exit, Exit::Reached, "{}", done.errors);
    let clocks = numbers_of(&done.output, "out.W");
    assert!(clocks.len() == 9 && clocks.iter().all(|clock| (clock - 5.0).abs() < 1e-9));
    assert_eq!(
        fs::read_to_string(&picture)
            .unwrap()
            .matches("<circle")
            .count(),
        9
    );
    assert_eq!(run("end.x_dot,in.x_dot").exit, Exit::Reached);
    for (axes, message) in [("x", "two quantities"), ("x,y", "quantity")] {
        let done = run(axes);
        assert_eq!(done.exit, Exit::Refused, "{axes}");
        assert!(
            done.errors.contains("--axes") && done.errors.contains(message),
            "{}",
            done.errors
        );
    }
}

#[test]
fn a_map_refuses_integrals_of_a_start_and_returns_to_a_stop() {
    let run = |flags: &[&str]| {
        let line = ["map", "-", "--vary", "x_dot=1..2:3"];
        on(BALL, &[&line[..], flags].concat())
    };
    for (flags, message) in [
        (
            &["--contour", "integral(x)"][..],
            "an integral exists only along a run",
        ),
        (
            &["--start", "x = integral(x)"],
            "an integral exists only along a run",
        ),
        (
            &["--returns", "3", "--law", "stop"],
            "the motion ends at the surface",
        ),
        (&["--output", "W = x", "--output", "W = 1"], "given once"),
    ] {
        let done = run(flags);
        assert_eq!(done.exit, Exit::Refused, "{flags:?}: {}", done.output);
        assert!(done.errors.contains(message), "{}", done.errors);
    }
}

#[test]
fn an_integral_that_does_not_exist_is_empty_from_there_on() {
    let words =
        "simulate - --initial x=1,x_dot=0 --samples 5 --until 2 --csv - --output".split(' ');
    let words: Vec<&str> = words.chain(["W = integral(sqrt(dot(x) + 1/2))"]).collect();
    let table = on(BALL, &words).output;
    let known: Vec<bool> = column(&table, "W")
        .iter()
        .map(|text| text.parse::<f64>().is_ok_and(f64::is_finite))
        .collect();
    assert!(known[0] && !known[known.len() - 1], "{table}");
}
