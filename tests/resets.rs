//! Compares the emitted law `reset` with the interpreter, and checks it in both forms, in claims and on the command
//! line.

use dalembert::declaration::Described;
use dalembert::law::Law;
use dalembert::{EventLog, Impacting, Instance, Outcome, Run, StateVector, System, VectorField};
use dalembert_cli::{Exit, Integrator};
use dalembert_codegen::claims::Verdict;
use dalembert_codegen::compile;
use dalembert_codegen::program::{Program, interpret::interpret};
use dalembert_emit::try_expand;
use dalembert_models::WalkerFootSlip;
use dalembert_stability::course::{Course, state};
use dalembert_stability::text::{Model, Text};
use dalembert_tests::claim::Declaration;
use dalembert_tests::command::{self, Finished};
use dalembert_tests::interpreted::{compare_report, input};
use dalembert_tests::sampling::states;
use serde_json::Value;

dalembert::model! {
    /// Two coupled pendula that change places where `sin(a + b)` reaches 1/2. The metric depends on the position.
    pub Swap {
        coordinates { a: angle; b: angle; }
        parameters { k > 0 = 1/2; }
        lagrangian = (dot(a)^2 + 2*dot(b)^2)/2 + k*cos(a - b)*dot(a)*dot(b);
        impacts { step: sin(a + b) <= 1/2 => reset { a = b; b = a; dot(a) = t + dot(b); dot(b) = k*dot(a); }; }
    }
}

dalembert::model! {
    /// A sleigh between walls that reflect it as a mirror does. The constraint holds after the reset.
    #[global]
    pub MirrorSleigh {
        coordinates { x; y; theta: angle; }
        parameters { m > 0 = 2; I > 0 = 1/3; a = 1/5; }
        let slip = dot(y)*cos(theta) - dot(x)*sin(theta);
        lagrangian = m/2*(dot(x)^2 + dot(y)^2) + (I + m*a^2)/2*dot(theta)^2 + a*m*dot(theta)*slip;
        constraints { blade: slip = 0; }
        impacts {
            left: x >= -1 => reset { theta = pi - theta; dot(x) = -dot(x); dot(theta) = -dot(theta); };
            right: x <= 1 => reset { theta = pi - theta; dot(x) = -dot(x); dot(theta) = -dot(theta); };
            counter: x >= 0 => reset { };
        }
        claims { conserved under left: energy; conserved under left: y; not conserved under right: dot(x); }
    }
}

dalembert::model! {
    /// A strip whose walls multiply velocities.
    pub Strip {
        coordinates { x; y; }
        parameters { al > 0 = 5/4; be > 0 = 2/3; s = 1/2; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2;
        impacts {
            left: x >= 0 => reset { dot(x) = -al*dot(x); dot(y) = be*dot(y); };
            right: x <= 1 => reset { dot(x) = -al*dot(x); dot(y) = dot(y)/al^2; };
            sheared: x >= -1 => reset { dot(x) = -dot(x); dot(y) = dot(y) + s*dot(x); };
            bent: x >= -2 => reset { dot(x) = -dot(x)^3; };
            elsewhere: x >= -3 => reset { y = y + 1; };
            counted: x >= -4 => reset { };
        }
        claims {
            density: exact;
            not conserved under left: energy;
            conserved under sheared: dot(x)^2;
            conserved under counted: energy + x*y;
            not conserved under elsewhere: y;
            conserved under elsewhere: energy;
        }
    }
}

static SWAP: Text = Text::new(Swap::DESCRIPTION.source.value());

static MIRROR_SLEIGH: Text = Text::new(MirrorSleigh::DESCRIPTION.source.value());

static STRIP: Text = Text::new(Strip::DESCRIPTION.source.value());

/// Asserts that emitted resets equal those of the interpreter to the bit. Returns the number of comparisons.
fn compare<S: Described + Impacting>(system: &S, program: &Program) -> usize {
    let (t, n) = (0.25, S::Vector::CAPACITY);
    let resets = &program.impacting.as_ref().expect("surfaces").resets;
    let mut compared = 0;
    for state in states(system, 5, 3) {
        for (surface, function) in resets.iter().enumerate() {
            let jump = system.reset(surface, t, &state).expect("a value");
            let Some(function) = function else {
                assert!(jump.is_none());
                continue;
            };
            let jump = jump.expect("a reset");
            let expected = interpret(function, &input(system, t, &state)).expect("a value");
            let (q, qdot) = expected.split_at(n);
            assert_eq!(
                (jump.position.as_slice(), jump.velocity.as_slice()),
                (q, qdot)
            );
            compared += 1;
        }
    }
    compared
}

#[test]
fn emitted_resets_are_what_the_interpreter_executes() {
    fn both<S: Described + Impacting>(system: &S) -> usize
    where
        S::Global: Described + Impacting,
    {
        let source = S::DESCRIPTION.source.value();
        let programs = compile(source.parse().expect("tokens"))
            .expect("a model")
            .programs;
        let global = system.global().expect("the global form");
        compare_report(&global, programs.global());
        compare(system, &programs.main) + compare(&global, programs.global())
    }
    let compared =
        both(&Swap::default()) + both(&MirrorSleigh::default()) + both(&Strip::default());
    assert_eq!(compared, 10 * (1 + 3 + 6));
}

#[test]
fn right_sides_take_the_values_before_the_impact() {
    let swap = Swap::default();
    let state = swap
        .state(0.5, &[0.3, -0.7].into(), &[2.0, 3.0].into())
        .expect("a state");
    let jump = swap
        .reset(0, 0.5, &state)
        .expect("a value")
        .expect("a reset");
    assert_eq!(jump.position.as_slice(), [-0.7, 0.3]);
    let velocities = jump.velocity.as_slice();
    assert!((velocities[0] - 3.5).abs() < 1e-14 && (velocities[1] - 1.0).abs() < 1e-14);
}

/// An impact: time, surface, and true if the state changed.
type Impact = (f64, usize, bool);

/// A run with its impacts.
fn run(
    system: &Model,
    q: &[f64],
    qdot: &[f64],
    until: f64,
) -> (Run<<Model as VectorField>::State>, Vec<Impact>) {
    let mut log = EventLog::<_, 64>::new();
    let run = Course::from_state(system, state(system, q, qdot), until)
        .observed(Integrator::Dop853, &mut log);
    let events = log
        .iter()
        .map(|event| (event.t, event.surface, event.before != event.after));
    (run, events.collect())
}

#[test]
fn both_forms_go_the_same_way_through_resets_of_positions() {
    let sleigh = MIRROR_SLEIGH.model();
    let global = sleigh.global().expect("the global form");
    let (q, qdot) = ([0.5, 0.0, 0.4], [0.4_f64.cos(), 0.4_f64.sin(), 0.7]);
    let reduced = run(&sleigh, &q, &qdot, 12.0);
    let whole = run(&global, &q, &qdot, 12.0);
    assert_eq!(
        (reduced.0.outcome, whole.0.outcome),
        (Outcome::Done, Outcome::Done)
    );
    let energy = |state: &_| sleigh.energy(0.0, state).expect("an energy");
    let start = state(&sleigh, &q, &qdot);
    assert!((energy(&reduced.0.state) - energy(&start)).abs() < 1e-10);
    let surfaces: Vec<usize> = reduced.1.iter().map(|impact| impact.1).collect();
    assert!(
        surfaces.contains(&0) || surfaces.contains(&1),
        "{surfaces:?}"
    );
    assert!(surfaces.contains(&2), "{surfaces:?}");
    assert_eq!(reduced.1.len(), whole.1.len());
    for (left, right) in reduced.1.iter().zip(&whole.1) {
        assert!((left.0 - right.0).abs() < 1e-8, "{left:?} {right:?}");
        assert_eq!((left.1, left.2), (right.1, right.2));
        // The counter leaves every digit of the state unchanged.
        assert_eq!(left.2, left.1 != 2);
    }
    let [left, right] = [
        sleigh.position(&reduced.0.state),
        global.position(&whole.0.state),
    ];
    let pairs = left.as_slice().iter().zip(right.as_slice());
    assert!(
        pairs
            .into_iter()
            .all(|(one, other)| (one - other).abs() < 1e-8),
        "{left:?} {right:?}"
    );
}

#[test]
fn the_declared_law_is_told_with_its_map() {
    let [left, .., counted] = Strip::DESCRIPTION.surfaces.value() else {
        panic!("surfaces")
    };
    assert_eq!(
        &*left.law,
        "reset { dot(x) = -al*dot(x); dot(y) = be*dot(y); }"
    );
    assert_eq!(&*counted.law, "reset { }");
    assert_eq!(Strip::default().law(0), Law::Reset);
    assert_eq!(MirrorSleigh::default().law(2), Law::Reset);
}

#[test]
fn what_a_reset_does_to_the_volume_is_said() {
    let found = Declaration::of(Strip::DESCRIPTION.source.value()).verdict("density: exact");
    let said = |surface: &str| {
        let start = format!("an impact at {surface} (reset {{ ");
        let remark = found
            .remarks
            .iter()
            .find(|remark| remark.starts_with(&start));
        let remark = remark.unwrap_or_else(|| panic!("{surface}: {:?}", found.remarks));
        remark.split_once("}) ").expect("an effect").1.to_owned()
    };
    assert_eq!(said("left"), "multiplies it by al^2*be");
    assert_eq!(said("right"), "keeps it");
    assert_eq!(said("sheared"), "keeps it");
    assert_eq!(said("counted"), "keeps it");
    assert_eq!(said("elsewhere"), "keeps it");
    let bent = "multiplies it by the determinant of its augmented differential";
    assert_eq!(said("bent"), bent);
}

/// The Jacobian is `det(dqdot+/dqdot) G+/G-` of the emitted reset, by differences.
#[test]
fn the_jacobian_is_what_is_said_of_it() {
    let strip = Strip::default();
    let q = [0.0, 0.3].into();
    let after = |surface: usize, qdot: [f64; 2]| {
        let state = strip.state(0.0, &q, &qdot.into()).expect("a state");
        let jump = strip
            .reset(surface, 0.0, &state)
            .expect("a value")
            .expect("a reset");
        [jump.velocity[0], jump.velocity[1]]
    };
    for (surface, expected) in [(0, strip.al.powi(2) * strip.be), (1, 1.0), (2, 1.0)] {
        let (u, h) = ([-0.7, 0.4], 1e-3);
        let slope = |i: usize| {
            let mut moved = [u, u];
            moved[0][i] += h;
            moved[1][i] -= h;
            let [above, below] = moved.map(|u| after(surface, u));
            [0, 1].map(|j| (above[j] - below[j]) / (2.0 * h))
        };
        let [left, right] = [slope(0), slope(1)];
        let determinant = left[0] * right[1] - left[1] * right[0];
        let value = (determinant * after(surface, u)[0] / u[0]).abs();
        assert!(
            (value - expected).abs() < 1e-11,
            "{surface}: {value} for {expected}"
        );
    }
}

#[test]
fn false_claims_about_a_reset_are_refuted_with_a_state() {
    let strip = Declaration::of(Strip::DESCRIPTION.source.value());
    for claim in [
        "conserved under left: energy",
        "conserved under elsewhere: y",
    ] {
        let found = strip.verdict(claim);
        let text = found.refusal().unwrap_or_else(|| panic!("{claim}")).0;
        assert!(
            text.contains("is refuted") && text.contains("after = "),
            "{text}"
        );
    }
}

#[test]
fn a_reset_off_the_constraints_is_refused_with_a_state() {
    let source = MirrorSleigh::DESCRIPTION
        .source
        .replace("theta = pi - theta;", "");
    assert_ne!(source, MirrorSleigh::DESCRIPTION.source.value());
    let refused = try_expand(source.parse().expect("tokens")).expect_err("off the constraint");
    let messages: Vec<&str> = refused.iter().map(|error| error.message()).collect();
    assert_eq!(messages.len(), 2, "{messages:?}");
    for (message, surface) in messages.iter().zip(["left", "right"]) {
        let start = format!("the reset of `{surface}` leaves the constraint `blade`");
        assert!(
            message.starts_with(&start) && message.contains("residual of blade after = "),
            "{message}"
        );
    }
}

/// The command line over the models of this file.
fn command(line: &str, given: &str) -> Finished {
    let models = [SWAP.entry(), MIRROR_SLEIGH.entry(), STRIP.entry()];
    command::line(models.to_vec(), line, given)
}

#[test]
fn eval_prints_declared_resets_beside_the_impulses() {
    let given = r#"[{"q": [0, 0.5], "qdot": [-2, 3]}]"#;
    let Finished {
        exit,
        output,
        errors,
    } = command("eval strip", given);
    assert_eq!(exit, Exit::Reached, "{errors}");
    let rows: Value = serde_json::from_str(&output).expect("JSON");
    let laws = &rows[0]["impacts"]["left"]["laws"];
    assert_eq!(laws["elastic"]["qdot_plus"].to_string(), "[2.0,3.0]");
    assert_eq!(laws["reset"]["qdot_plus"].to_string(), "[2.5,2.0]");
    assert_eq!(laws["reset"]["gap_rate_plus"], 2.5);
    assert_eq!(laws["reset"]["energy_plus"], 5.125);
    let moved = &rows[0]["impacts"]["elsewhere"]["laws"]["reset"];
    assert_eq!(moved["q_plus"].to_string(), "[0.0,1.5]");
}

#[test]
fn simulate_takes_reset_where_it_is_declared() {
    let start = "simulate strip --initial x=0.5,x_dot=-1,y_dot=1 --until 0.6 --json -";
    let Finished {
        exit,
        output,
        errors,
    } = command(&format!("{start} --law left=reset"), "");
    assert_eq!(exit, Exit::Reached, "{errors}");
    let document: Value = serde_json::from_str(&output).expect("JSON");
    assert_eq!(document["events"][0]["qdot_plus"][0], 1.25);
    assert!(document["events"][0].get("q_minus").is_none());
    let Finished { exit, .. } = command(&format!("{start} --law elastic --law left=reset"), "");
    assert_eq!(exit, Exit::Reached);
    let sleigh = "simulate mirror_sleigh --initial x=0.5,x_dot=1 --until 0.6 --json -";
    let Finished {
        exit,
        output,
        errors,
    } = command(sleigh, "");
    assert_eq!(exit, Exit::Reached, "{errors}");
    let document: Value = serde_json::from_str(&output).expect("JSON");
    assert_eq!(document["events"][0]["q_minus"][2], 0.0);
    assert_eq!(document["events"][0]["q"][2], core::f64::consts::PI);
}

#[test]
fn simulate_refuses_reset_where_it_is_not_declared() {
    let walls = "simulate bouncing_ball --until 1 --law floor=reset";
    let Finished {
        exit, errors: text, ..
    } = command::line(dalembert_command::all(), walls, "");
    assert_eq!(exit, Exit::Refused, "{text}");
    assert!(
        text.contains("--law: surface `floor` declares no reset"),
        "{text}"
    );
}

#[test]
fn derive_prints_the_map() {
    let Finished {
        exit,
        output,
        errors,
    } = command("derive strip", "");
    assert_eq!(exit, Exit::Reached, "{errors}");
    assert!(output.contains("surface left: reset {"), "{output}");
    assert!(output.contains("dot(x)+[left] = -al*dot(x)"), "{output}");
    assert!(
        output.contains("y+[elsewhere] = 1 + y") || output.contains("y+[elsewhere] = y + 1"),
        "{output}"
    );
}

/// On a surface a coordinate follows from the others, and so do functions of it.
#[test]
fn what_a_surface_ties_is_not_taken_for_independent() {
    let verdict = |surface: &str, reset: &str, claim: &str| {
        let source = format!(
            "P {{
                coordinates {{ x; y; }}
                parameters {{ w > 0 = 1/3; }}
                lagrangian = (dot(x)^2 + dot(y)^2)/2;
                impacts {{ wall: {surface} => reset {{ {reset}; }}; }}
            }}"
        );
        Declaration::of(&source).verdict(claim).verdict
    };
    let claim = "conserved under wall: y*cos(x)";
    let linear = |reset| verdict("x >= -w", reset, claim);
    assert!(matches!(linear("x = x + 2*w"), Verdict::Proved(_)));
    assert!(matches!(linear("x = x + w"), Verdict::Refuted(_)));
    // For `x^2 = w^2` no coordinate is determined uniquely.
    let quadratic = |reset| verdict("x^2 >= w^2", reset, claim);
    let open = quadratic("x = 2*x; y = y*cos(w)/cos(2*w)");
    assert!(matches!(open, Verdict::Undecided(_)), "{open:?}");
    assert!(matches!(quadratic("x = 2*x"), Verdict::Refuted(_)));
    assert!(matches!(quadratic("x = -x"), Verdict::Proved(_)));
    // The claim is about the velocity of the foot; on the surface the angle of the leg is known.
    let walker = Declaration::of(WalkerFootSlip::DESCRIPTION.source.value());
    let foot = "conserved under step: dot(x_c) + lf*dot(theta)*cos(theta)";
    assert!(matches!(walker.verdict(foot).verdict, Verdict::Proved(_)));
}
