use dalembert::Described;

use super::*;

dalembert::model! {
    /// A ball that is compiled into the program.
    pub CompiledBall {
        coordinates { x; }
        lagrangian = dot(x)^2/2 - x;
        impacts { floor: x >= 0; }
        initial { x = 1; until = 2; }
    }
}

const BALL: &str = "
    Ball {
        coordinates { x; }
        parameters { m > 0 = 1; g > 0 = 1; }
        lagrangian = m*dot(x)^2/2 - m*g*x;
        impacts { floor: x >= 0; }
        initial { x = 1; until = 2; }
    }";

const PLANE: &str = "
    Plane {
        coordinates { x; y; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2;
        impacts { right: x <= 1; upper: y <= 1; }
        initial { dot(x) = 1; dot(y) = 1/2; until = 3; }
    }";

const DRAIN: &str = "
    Drain {
        coordinates { x; }
        field { dot(x) = -x; }
        initial { x = 1; until = 1; }
    }";

const SCENES: &str = "
    Pushed {
        coordinates { x; }
        inputs { push; }
        lagrangian = dot(x)^2/2 - x;
        forces { pushed: push*d(x); }
        impacts { floor: x >= 0; }
        scenes { free; lively: pushed, floor, variations; }
        initial { x = 1; until = 1.5; }
    }";

const SLEIGH: &str = include_str!("../../models/src/chaplygin_sleigh.dal");

const WALKER: &str = include_str!("../../models/src/spring_mass_walker.dal");

/// Runs `simulate --certify` on a text.
fn certify(text: &str, flags: &str) -> Done {
    let words = ["simulate", "-", "--certify"];
    let words: Vec<&str> = words.into_iter().chain(flags.split_whitespace()).collect();
    run_on(text, &words)
}

/// Same as [`certify`]; returns the exit and the JSON document.
fn document(text: &str, flags: &str) -> (Exit, Value) {
    let done = certify(text, &format!("{flags} --json -"));
    assert!(!done.output.is_empty(), "{}", done.errors);
    (done.exit, done.json())
}

fn range(value: &Value) -> [f64; 2] {
    numbers(value).try_into().unwrap()
}

fn ranges(value: &Value) -> Vec<[f64; 2]> {
    value.as_array().unwrap().iter().map(range).collect()
}

#[test]
fn an_impact_lies_in_its_range_and_there_are_no_others() {
    let (exit, document) = document(BALL, "");
    assert_eq!(exit, Exit::Reached);
    let keys: Vec<&String> = document.as_object().unwrap().keys().collect();
    let expected = [
        "model",
        "scene",
        "parameters",
        "within",
        "form",
        "outcome",
        "events",
        "steps",
    ];
    assert_eq!(keys, expected);
    let events = document["events"].as_array().unwrap();
    assert_eq!(events.len(), 1);
    assert_eq!(events[0]["surface"], "floor");
    // sqrt(2) lies between `root.next_down()` and `root`.
    let root = std::f64::consts::SQRT_2;
    let [lo, hi] = range(&events[0]["t"]);
    assert!(lo <= root.next_down() && root <= hi && hi - lo < 1e-14);
    let speeds = ranges(&events[0]["qdot_minus"]);
    assert!(speeds[0][0] <= -root && -root.next_down() <= speeds[0][1]);
    let speeds = ranges(&events[0]["qdot_plus"]);
    assert!(speeds[0][0] <= root.next_down() && root <= speeds[0][1]);
    let outcome = &document["outcome"];
    assert_eq!(
        (&outcome["kind"], &outcome["t"]),
        (&"certified".into(), &2.0.into())
    );
    let [lo, hi] = ranges(&outcome["q"])[0];
    let fall = 2.0 - root;
    let height = root * fall - 0.5 * fall * fall;
    assert!(lo - 1e-15 <= height && height <= hi + 1e-15 && hi - lo < 1e-12);
}

#[test]
fn the_text_says_what_the_document_says() {
    let done = certify(BALL, "");
    assert_eq!(done.exit, Exit::Reached);
    let (_, document) = document(BALL, "");
    let [lo, hi] = range(&document["events"][0]["t"]);
    let lines: Vec<&str> = done.output.lines().collect();
    assert_eq!(lines[0], "ball");
    let impact = format!("  impact 1    t in [{lo:?}, {hi:?}] (width ");
    assert!(
        lines[1].starts_with(&impact) && lines[1].ends_with("), floor"),
        "{}",
        done.output
    );
    assert_eq!(lines[2], "  certified   up to t = 2");
    assert_eq!(lines[3], "  impacts     1; there are no others until t = 2");
    let [lo, hi] = ranges(&document["outcome"]["q"])[0];
    assert!(lines[4].starts_with(&format!("  x           [{lo:?}, {hi:?}] (width ")));
    assert!(lines[5].starts_with("  x_dot       ["));
    assert_eq!(lines[6], "  steps       2 steps, global form");
}

#[test]
fn motion_ends_after_as_many_impacts_as_are_asked_for() {
    let (exit, document) = document(BALL, "--impacts 3 --law newton:0.5");
    assert_eq!(exit, Exit::Reached);
    let events = document["events"].as_array().unwrap();
    let root = std::f64::consts::SQRT_2;
    for (event, falls) in events.iter().zip([1.0, 2.0, 2.5]) {
        let [lo, hi] = range(&event["t"]);
        assert!(lo < falls * root * (1.0 + 1e-15) && falls * root * (1.0 - 1e-15) < hi);
    }
    assert_eq!(events.len(), 3);
}

#[test]
fn every_motion_from_a_range_is_inside() {
    let flags = "--until 1.7 --certify-within x=0.99..1.01 --certify-within g=0.98..1.02";
    let (exit, document) = document(BALL, flags);
    assert_eq!(exit, Exit::Reached);
    // Ends that are not doubles are rounded outwards.
    let [lo, hi] = range(&document["within"]["x"]);
    assert_eq!([lo, hi], [0.99_f64.next_down(), 1.01_f64.next_up()]);
    let [first, last] = range(&document["events"][0]["t"]);
    let [below, above] = ranges(&document["outcome"]["q"])[0];
    for x in [0.99, 1.0, 1.01] {
        for g in [0.98_f64, 1.0, 1.02] {
            let t = (2.0 * x / g).sqrt();
            assert!(first - 1e-15 < t && t < last + 1e-15, "{x} {g}");
            let (speed, rest) = (g * t, 1.7 - t);
            let height = speed * rest - 0.5 * g * rest * rest;
            assert!(below - 1e-15 < height && height < above + 1e-15, "{x} {g}");
        }
    }
}

#[test]
fn declared_values_move_with_their_parameter() {
    const FREE: &str = "M {
        coordinates { x; }
        parameters { a = 1; }
        lagrangian = dot(x)^2/2;
        initial { x = a; dot(x) = 2*a; until = 1; }
    }";
    let (exit, document) = document(FREE, "--certify-within a=0.9..1.1");
    assert_eq!(exit, Exit::Reached);
    let [[lo, hi], [slow, fast]] =
        [&document["outcome"]["q"], &document["outcome"]["qdot"]].map(|all| ranges(all)[0]);
    assert!(lo < 2.7 && 3.3 < hi && hi - lo < 0.7, "{lo}, {hi}");
    assert!(
        slow < 1.8 && 2.2 < fast && fast - slow < 0.5,
        "{slow}, {fast}"
    );
    let (_, document) = self::document(FREE, "--certify-within a=0.9..1.1 --initial x=0.5,x_dot=1");
    let [lo, hi] = ranges(&document["outcome"]["q"])[0];
    assert!(lo <= 1.5 && 1.5 <= hi && hi - lo < 1e-14, "{lo}, {hi}");
}

/// A start that satisfies the constraints for one value of a parameter only is no start of motions with other values.
#[test]
fn a_start_for_one_value_of_a_parameter_is_refused() {
    let on_circle = "M {
        coordinates { x; y; }
        parameters { r > 0 = 1; m > 0 = 1; }
        lagrangian = m*(dot(x)^2 + dot(y)^2)/2 - m*y;
        constraints { c: x^2 + y^2 = r^2; }
        initial { x = 0.6; dot(x) = 2; until = 0.1; }
    }";
    let geared = "M {
        coordinates { x; y; }
        parameters { k = 1; m > 0 = 1; }
        lagrangian = m*(dot(x)^2 + dot(y)^2)/2;
        constraints { c: dot(x) = k*dot(y); }
        initial { x = 1; dot(x) = 2; until = 1; }
    }";
    // `dot(x)` and `dot(y)` follow from `dot(z)` and the constraint, which leaves one of them free.
    let completed = "M {
        coordinates { x; y; z; }
        parameters { k = 1; m > 0 = 1; }
        lagrangian = m*(dot(x)^2 + dot(y)^2 + dot(z)^2)/2;
        constraints { c: dot(z) = dot(x) + k*dot(y); }
        initial { dot(z) = 1; until = 1; }
    }";
    for (text, parameter) in [(on_circle, "r"), (geared, "k"), (completed, "k")] {
        let errors = certify(text, &format!("--certify-within {parameter}=0.9..1.1")).errors;
        let told = format!("the start depends on `{parameter}`");
        assert!(errors.contains(&told), "{errors}");
        // The mass is no part of the constraint.
        assert_eq!(
            certify(text, "--certify-within m=0.9..1.1").exit,
            Exit::Reached
        );
    }
    // With `dot(y)`, the quasi-velocity of the frame, the start is the same for all gears.
    let flags = "--certify-within k=0.9..1.1 --initial x_dot=2,y_dot=2 --certify-within y_dot=2..2";
    let (exit, document) = document(geared, flags);
    assert_eq!(exit, Exit::Reached);
    let [slow, fast] = ranges(&document["outcome"]["qdot"])[0];
    assert!(slow <= 1.8 && 2.2 <= fast, "{slow}, {fast}");
}

#[test]
fn quasi_velocities_have_ranges() {
    let flags = "--until 1 --certify-within omega=0.49..0.51 --certify-within x=-0.01..0.01";
    let (exit, document) = document(SLEIGH, flags);
    assert_eq!(
        (exit, &document["form"]),
        (Exit::Reached, &"reduced".into())
    );
    let q = ranges(&document["outcome"]["q"]);
    let line = "simulate - --initial x=-0.01 --until 1 --tol 1e-13 --samples 2 --json -";
    let run = run_on(SLEIGH, &line.split(' ').collect::<Vec<_>>()).json();
    let sample = numbers(&run["outcome"]["q"]);
    assert_eq!(q.len(), sample.len());
    for ([lo, hi], q) in q.iter().zip(sample) {
        assert!(lo - 1e-9 < q && q < hi + 1e-9);
    }
    assert!(q[0][1] - q[0][0] > 0.02);
}

/// After a map that does not change the gap, the motion is on the surface, whatever the rounding of the gap: it crosses the
/// surface, or leaves it.
#[test]
fn motion_goes_on_from_the_surface_of_a_map() {
    let section = "M {
        coordinates { x; y; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2;
        impacts { s: x <= 1 => reset { dot(y) = dot(y) + 1; }; }
        initial { dot(x) = 1; until = 2; }
    }";
    // At the step the potential rises by V: the motion is refracted for V = 0.4, and reflected for V = 0.55.
    let step = "M {
        coordinates { x; y; }
        parameters { V = 0.4; }
        modes {
            left { lagrangian = (dot(x)^2 + dot(y)^2)/2; initial { x = -1; dot(x) = 1; dot(y) = 0.3; until = 4; } }
            right { lagrangian = (dot(x)^2 + dot(y)^2)/2 - V; }
        }
        transitions { up: left -> right when x >= 0; down: right -> left when x <= 0; }
    }";
    // Both modes have surfaces with the gap of the transition and with its negative.
    let sides = "M {
        coordinates { x; y; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2;
        modes {
            still { initial { x = -1; dot(x) = 1; until = 2; } }
            pulled { forces { pull: d(x); } }
        }
        transitions {
            one: still -> pulled when x >= 0;
            two: still -> pulled when x <= 0;
            three: pulled -> still when x >= 0;
            four: pulled -> still when x <= 0;
        }
    }";
    for (text, flags, right) in [
        (section, "", [2.0, 1.0]),
        (step, "", [3.0 * 0.2_f64.sqrt(), 1.2]),
        (step, "--set V=0.55", [-3.0, 1.2]),
        (sides, "", [1.5, 0.0]),
    ] {
        let (exit, document) = document(text, flags);
        assert_eq!(exit, Exit::Reached, "{text}, {flags}: {document}");
        assert_eq!(document["events"].as_array().unwrap().len(), 1);
        let found = ranges(&document["outcome"]["q"]);
        for ([lo, hi], right) in found.into_iter().zip(right) {
            assert!(
                lo <= right && right <= hi && hi - lo < 1e-12,
                "{lo}, {hi}, {right}"
            );
        }
    }
}

#[test]
fn motion_from_mode_to_mode_is_certified() {
    let (exit, document) = document(WALKER, "--impacts 2");
    assert_eq!(exit, Exit::Reached);
    let events = document["events"].as_array().unwrap();
    let modes: Vec<[&str; 2]> = events
        .iter()
        .map(|event| ["mode_minus", "mode_plus"].map(|key| event[key].as_str().unwrap()))
        .collect();
    assert_eq!(modes, [["single", "double"], ["double", "single"]]);
    assert_eq!(document["outcome"]["mode"], "single");
    // The mode does not have the coordinate of this foot.
    assert_eq!(document["outcome"]["q"][3], Value::Null);
    assert!(events.iter().all(|event| range(&event["t"])[1] < 1.0));
    let done = certify(WALKER, "--impacts 2");
    assert!(
        done.output.contains("touch_down, single to double"),
        "{}",
        done.output
    );
    assert!(
        done.output.contains("\n  mode        single\n"),
        "{}",
        done.output
    );
    let done = certify(WALKER, "--certify-within x=0..1");
    assert!(
        done.errors.contains("from a single start only"),
        "{}",
        done.errors
    );
}

#[test]
fn first_order_systems_are_certified() {
    let (exit, document) = document(DRAIN, "--certify-within x=1..2");
    assert_eq!(exit, Exit::Reached);
    let [lo, hi] = ranges(&document["outcome"]["q"])[0];
    let least = (-1_f64).exp();
    assert!(lo <= least && 2.0 * least <= hi && hi - lo < 1.0001 * least);
}

#[test]
fn motion_that_is_lost_says_where_and_why() {
    let done = certify(PLANE, "--initial y_dot=1");
    assert_eq!(done.exit, Exit::Other);
    let line = done
        .output
        .lines()
        .find(|line| line.contains("lost"))
        .unwrap();
    assert!(line.contains("certified up to t = 0.99"), "{line}");
    let reason = "and no further: the motion may hit surfaces `right` and `upper` at one time, or in either order";
    assert!(line.ends_with(reason), "{line}");
    let (exit, document) = document(PLANE, "--certify-within x_dot=0.4..1");
    assert_eq!(exit, Exit::Other);
    assert_eq!(document["outcome"]["kind"], "lost");
    assert_eq!(document["outcome"]["reason"], "may_meet_together");
    let done = certify(BALL, "--law impact_plastic");
    assert_eq!(done.exit, Exit::Other);
    assert!(
        done.output
            .contains("the motion may stay on surface `floor`"),
        "{}",
        done.output
    );
}

#[test]
fn models_that_no_motion_is_certified_of_say_so() {
    let done = certify(SLEIGH, "--form global");
    assert_eq!(done.exit, Exit::Refused);
    let text = "--certify: certified motion of this model needs the reduced form";
    assert!(done.errors.contains(text), "{}", done.errors);
    let done = certify(SCENES, "--scene free");
    assert_eq!(done.exit, Exit::Refused);
    let text = "--certify: certified motion needs `variations`";
    assert!(done.errors.contains(text), "{}", done.errors);
    let done = certify(SCENES, "--scene lively --input push=-1");
    assert!(done.output.contains("impacts     1;"), "{}", done.output);
    let by_hand = ["simulate", "oscillator", "--set", "k=4", "--certify"];
    let done = run_over(&[systems::made_by_hand()], "", &by_hand);
    assert_eq!(done.exit, Exit::Refused);
    assert!(
        done.errors.contains("give the file of its declaration"),
        "{}",
        done.errors
    );
}

/// The form that motion is certified of comes from the text of the declaration.
#[test]
fn motion_of_compiled_models_is_certified() {
    let arguments = ["simulate", "compiled_ball", "--certify"];
    let [compiled, loaded] = [
        Entry::of::<CompiledBall>(),
        Entry::of_text("compiled_ball", CompiledBall::DESCRIPTION.source.value()),
    ]
    .map(|entry| run_over(&[entry], "", &arguments));
    assert_eq!(compiled.exit, Exit::Reached, "{}", compiled.errors);
    assert_eq!(compiled.output, loaded.output);
}

#[test]
fn flags_of_runs_do_not_go_together_with_it() {
    for flags in [
        "--csv a.csv",
        "--plot a.svg",
        "--verify",
        "--integrator taylor",
        "--step 0.1",
        "--max-step 0.1",
        "--tol 1e-8",
        "--steps 10",
        "--samples 5",
        "--rest contact",
        "--projection on",
    ] {
        let done = certify(BALL, flags);
        assert_eq!(done.exit, Exit::Refused, "{flags}");
        let (flag, _) = flags.split_once(' ').unwrap_or((flags, ""));
        let text = format!("'--certify' cannot be used with '{flag}");
        assert!(done.errors.contains(&text), "{}", done.errors);
    }
    let done = run("simulate oscillator --certify-within k=1..2");
    assert_eq!(done.exit, Exit::Refused);
    assert!(done.errors.contains("--certify"), "{}", done.errors);
}

#[test]
fn ranges_that_are_none_are_refused() {
    let refused = |text: &str, flags: &str| {
        let done = certify(text, flags);
        assert_eq!(
            (done.exit, done.output.as_str()),
            (Exit::Refused, ""),
            "{flags}"
        );
        done.errors
    };
    let errors = refused(BALL, "--certify-within x");
    assert!(errors.contains("--certify-within: `x` is not accepted; expected NAME=LO..HI"));
    let errors = refused(BALL, "--certify-within y=1..2");
    assert!(errors.contains("unknown coordinate, velocity or parameter `y`"));
    assert!(errors.contains("accepted: x, x_dot, m, g"));
    for range in ["2..1", "1", "1..", "1..inf", "nan..1", "1...2"] {
        let errors = refused(BALL, &format!("--certify-within x={range}"));
        assert!(
            errors.contains("expected LO..HI with LO not above HI"),
            "{errors}"
        );
    }
    let errors = refused(BALL, "--certify-within g=-1..1");
    assert!(
        errors.contains(
            "--certify-within g: `-1..1` is not accepted; expected a range of values > 0"
        ),
        "{errors}"
    );
    let errors = refused(BALL, "--q 1 --p 0 --certify-within x_dot=0..1");
    assert!(errors.contains("need --qdot in place of --p"), "{errors}");
    let errors = refused(SLEIGH, "--form global --certify-within x=0..1");
    assert!(
        errors.contains("only parameters may have ranges"),
        "{errors}"
    );
}
