//! `--verify` and `accuracy` report no measured error for a run that misses an impact: it is not verified, even if
//! every run misses the same impact.

use dalembert_stability::text::Text;

use super::systems::missing;
use super::*;

static ROD: Text = Text::new(
    "/// Two wheels joined by a rod of variable length.
    pub TwoWheelsRod {
        coordinates { x1; x2; theta1; theta2; }
        parameters { r1 > 0 = 1/2; r2 > 0 = 1; a > 0 = 1; b > 0 = 3; }
        let length = sqrt((r2 - r1)^2 + (x2 - x1)^2);
        lagrangian = 1/2*(dot(x1)^2 + dot(x2)^2 + dot(theta1)^2 + dot(theta2)^2);
        constraints { wheel1: d(x1) - r1*d(theta1) = 0; wheel2: d(x2) - r2*d(theta2) = 0; }
        impacts { rod_max: b - length >= 0; rod_min: length - a >= 0; }
        initial { x2 = 2; dot(theta1) = 1; dot(theta2) = -0.25; }
    }",
);

static ARRESTED: Text = Text::new(
    "/// Two wheels joined by a rod that is arrested at its extreme lengths.
    pub TwoWheelsArrested {
        coordinates { x1; x2; theta1; theta2; }
        parameters { r1 > 0 = 1/2; r2 > 0 = 1; a > 0 = 1; b > 0 = 3; }
        let length = sqrt((r2 - r1)^2 + (x2 - x1)^2);
        lagrangian = 1/2*(dot(x1)^2 + dot(x2)^2 + dot(theta1)^2 + dot(theta2)^2);
        constraints { wheel1: d(x1) - r1*d(theta1) = 0; wheel2: d(x2) - r2*d(theta2) = 0; }
        modes {
            sliding { initial { x2 = 2; dot(theta1) = 1; dot(theta2) = -0.25; } }
            arrested { constraints { rod: d(x2 - x1) = 0; } }
        }
        transitions {
            longest: sliding -> arrested when length >= b;
            shortest: sliding -> arrested when length <= a;
        }
    }",
);

static BUMP: Text = Text::new(
    "/// A point over a bump.
    pub Bump {
        coordinates { x; y; }
        parameters { s > 0 = 0.1; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2;
        impacts { wall: y - exp(-(x/s)^2) >= 0; }
        initial { x = -1; y = 1/2; dot(x) = 1; }
    }",
);

static PEG: Text = Text::new(
    "/// A point that falls on a peg.
    pub Peg {
        coordinates { x; y; }
        parameters { r > 0 = 0.5826313654547983; g > 0 = 1; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2 - g*y;
        impacts { peg: sqrt(x^2 + y^2) - r >= 0; }
        initial { x = 0.31066917005121814; y = 16.26406912456683; }
    }",
);

static SPRING: Text = Text::new(
    "/// A mass on a spring, with a wall slightly nearer than its amplitude.
    pub Spring {
        coordinates { x; }
        lagrangian = dot(x)^2/2 - x^2/2;
        impacts { wall: 0.9999 - x >= 0; }
        initial { dot(x) = 1; }
    }",
);

/// A command line with the first impact of the right run.
struct Case {
    line: &'static str,
    surface: &'static str,
    t: f64,
}

const CASES: [Case; 5] = [
    Case {
        line: "two_wheels_rod --integrator taylor --until 500",
        surface: "rod_min",
        t: 1.512,
    },
    Case {
        line: "two_wheels_arrested --integrator taylor --until 1000",
        surface: "shortest",
        t: 1.512,
    },
    Case {
        line: "two_wheels_rod --set b=1e7 --initial x2=500,theta1_dot=1,theta2_dot=-0.25 --until 2000",
        surface: "rod_min",
        t: 665.512,
    },
    Case {
        line: "bump --until 2.5",
        surface: "wall",
        t: 0.91674,
    },
    Case {
        line: "peg --integrator taylor --until 7.7",
        surface: "peg",
        t: 5.616,
    },
];

fn sure() -> Vec<Entry> {
    [&ROD, &ARRESTED, &BUMP, &PEG, &SPRING]
        .map(Text::entry)
        .to_vec()
}

/// The models of [`sure`] except the spring, with an event search that misses impacts.
fn unsure() -> Vec<Entry> {
    vec![
        missing!(ROD),
        missing!(ARRESTED),
        missing!(BUMP),
        missing!(PEG),
    ]
}

/// Runs a command over some models.
fn over(models: &[Entry], line: &str) -> Done {
    run_over(models, "", &line.split_whitespace().collect::<Vec<_>>())
}

/// The line of the summary with the error.
fn error_of(done: &Done) -> &str {
    let mut lines = done.output.lines();
    lines.find(|line| line.contains("  error ")).unwrap()
}

impl Case {
    /// True if the first impact of a document is the right one.
    fn is_right(&self, document: &Value) -> bool {
        let first = &document["events"][0];
        first["surface"] == self.surface
            && first["t"]
                .as_f64()
                .is_some_and(|t| (t - self.t).abs() < 1e-3)
    }

    fn simulate(&self, flags: &str) -> String {
        format!("simulate {} --verify {flags}", self.line)
    }
}

#[test]
fn runs_with_the_right_impacts_are_verified() {
    for case in CASES {
        let document = over(&sure(), &case.simulate("--samples 2 --json -")).json();
        assert!(case.is_right(&document), "{}: {document}", case.line);
        assert_eq!(document["error"]["verified"], true, "{document}");
        let done = over(&sure(), &case.simulate(""));
        assert_eq!(done.exit, Exit::Reached, "{}", done.output);
        assert!(error_of(&done).contains("reference"), "{}", done.output);
    }
}

#[test]
fn a_run_that_misses_an_impact_is_not_verified_by_others_that_miss_it() {
    for case in CASES {
        let document = over(&unsure(), &case.simulate("--samples 2 --json -")).json();
        assert!(!case.is_right(&document), "{}: {document}", case.line);
        let error = &document["error"];
        // All runs miss the impact, so that their comparison shows nothing.
        assert_eq!(error["ends_as_reference"], true, "{}: {error}", case.line);
        assert_eq!(error["verified"], false, "{}: {error}", case.line);
        assert!(error["measured"].is_null(), "{}: {error}", case.line);

        let done = over(&unsure(), &case.simulate(""));
        assert_eq!(done.exit, Exit::Other, "{}", done.output);
        let (line, met) = (
            error_of(&done),
            format!("may miss an impact on `{}` at t = ", case.surface),
        );
        let (_, rest) = line.split_once(&met).unwrap_or_else(|| panic!("{line}"));
        let t: f64 = rest.trim_end().parse().unwrap();
        assert!((t - case.t).abs() < 1e-3, "{}: {line}", case.line);
        assert!(line.contains("not verified"), "{line}");
    }
}

#[test]
fn nothing_is_measured_by_a_reference_that_misses_an_impact() {
    let line = "accuracy peg --until 7.7 --rounds 1 --patience 0.05 --integrator dop853";
    let done = over(&sure(), line);
    assert_eq!(done.exit, Exit::Reached, "{}", done.output);
    assert!(done.output.contains("dop853"), "{}", done.output);

    let done = over(&unsure(), line);
    assert_eq!(done.exit, Exit::Other, "{}", done.output);
    assert!(!done.output.contains("dop853"), "{}", done.output);
    let told =
        "the reference are not confirmed: the reference may miss an impact on `peg` at t = 5.6";
    assert!(done.output.contains(told), "{}", done.output);
    let document = over(&unsure(), &format!("{line} --wanted 1e-6 --json -")).json();
    assert_eq!(document["reference"]["confirmed"], false);
    assert_eq!(document["cases"].as_array().unwrap().len(), 0);
    let reason = document["wanted"]["reason"].as_str().unwrap();
    assert!(reason.contains("not confirmed"), "{reason}");
}

#[test]
fn runs_that_meet_other_surfaces_are_not_verified() {
    // Steps that are too long damp the motion, which then does not reach the wall.
    let line = "simulate spring --until 6 --integrator rk4 --step 0.5 --verify";
    let done = over(&sure(), line);
    assert_eq!(done.exit, Exit::Other, "{}", done.output);
    let told = "not verified: the runs differ at impact 1: the run has no further impact, the reference hits `wall` at t = 1.55";
    assert!(done.output.contains(told), "{}", done.output);
}

#[test]
fn a_run_to_its_last_impact_is_verified() {
    let line = "simulate two_wheels_rod --impacts 12 --tol 1e-9 --verify";
    let done = over(&sure(), line);
    assert_eq!(done.exit, Exit::Reached, "{}", done.output);
    assert!(error_of(&done).contains("reference"), "{}", done.output);
}

/// Between impacts the motion is a polynomial in time, so that all runs do the same arithmetic there.
#[test]
fn rounding_that_impacts_amplify_is_measured() {
    let billiard = "B { coordinates { x; y; } lagrangian = (dot(x)^2 + dot(y)^2)/2; \
        impacts { l: x >= -1; r: x <= 1; b: y >= -1; u: y <= 1; disk: x^2 + y^2 >= 1/4; } \
        initial { x = 0.7; y = 0.3; dot(x) = -1; dot(y) = 0.37; until = 60; } }";
    let map = "M { coordinates { c; x; } field { dot(c) = 1; dot(x) = 0; } \
        impacts { s: c <= 1 => reset { c = 0; x = 4*x*(1 - x); }; } initial { x = 0.3; until = 100.5; } }";
    let verify = |text: &str, flags: &str| {
        let line = format!("simulate - --verify {flags}");
        run_over(&[], text, &line.split_whitespace().collect::<Vec<_>>())
    };
    for (text, told) in [
        (billiard, "the runs differ at impact"),
        (map, "rounding grows along this motion"),
    ] {
        let done = verify(text, "");
        assert_eq!(done.exit, Exit::Other, "{}", done.output);
        assert!(error_of(&done).contains(told), "{}", done.output);
    }
    for (text, flags) in [(billiard, "--until 10"), (map, "--until 10.5")] {
        let done = verify(text, flags);
        assert_eq!(done.exit, Exit::Reached, "{}", done.output);
    }
    // An impact at the end of the run, up to rounding.
    let square = "S { coordinates { x; y; } lagrangian = (dot(x)^2 + dot(y)^2)/2; \
        impacts { a: x >= 0; b: x <= 1; c: y >= 0; u: y <= 1; } \
        initial { x = 1; y = 0.3; dot(x) = -0.7; dot(y) = 0.33; until = 1000; } }";
    let done = verify(square, "");
    assert_eq!(done.exit, Exit::Reached, "{}", done.output);
}

/// How many hops are carried out before their limit is up to rounding.
#[test]
fn hops_that_end_at_one_limit_are_one_motion() {
    for integrator in ["taylor", "dop853", "dopri5", "gauss6"] {
        for law in ["newton:0.3", "newton:0.5", "newton:0.8"] {
            for rest in ["stop", "contact"] {
                let line = format!(
                    "simulate bouncing_ball --law {law} --rest {rest} --until 30 --integrator {integrator} --verify"
                );
                let done = run(&line);
                let error = error_of(&done);
                assert!(!error.contains("not verified"), "{line}: {error}");
            }
        }
    }
}

#[test]
fn a_surface_that_begins_to_count_behind_the_motion_is_the_end_that_was_found() {
    static RISING: Text = Text::new(
        "Rising { coordinates { x; } lagrangian = dot(x)^2/2;
         impacts { lift: x + 1.389 - 0.43*t >= 0 when x > 0.523; }
         initial { x = -0.8100634180245905; dot(x) = 0.1838868429076268; } }",
    );
    for integrator in ["taylor", "dop853", "gauss6"] {
        let line = format!("simulate rising --until 10 --integrator {integrator} --verify");
        let done = over(&[RISING.entry()], &line);
        assert!(done.output.contains("begins_behind"), "{}", done.output);
        let error = error_of(&done);
        assert!(!error.contains("not verified"), "{integrator}: {error}");
    }
}
