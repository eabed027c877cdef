//! Constraints that are not linear in the velocities: Chetaev's rule, projection, and quantities that are not defined.

use dalembert::law::Law;
use dalembert::math::larger;
use dalembert::projection::Projection;
use dalembert::{
    Constrained, Fault, Impacting, Instance, Lagrangian, Outcome, SceneEffects, StateError, System,
    VectorField,
};
use dalembert_cli::{Exit, Integrator};
use dalembert_codegen::compile;
use dalembert_stability::course::{Course, state, vector};
use dalembert_stability::text::{Large, Text, shipped};
use dalembert_tests::command::dalembert;
use dalembert_tests::numeric::assert_near;
use dalembert_tests::sampling::{Random, states};
use serde_json::{Value, json};

/// A nonlinear constraint with a metric that is not constant, forces, dependence on time, a linear constraint and an
/// integrable one.
static MIXED: Text = Text::new(
    "Mixed {
        coordinates { x; y; z; theta: angle; w; }
        parameters { m > 0 = 2; a > 0 = 1/2; }
        lagrangian = m/2*(dot(x)^2 + dot(y)^2*(1 + x^2/4)) + dot(z)^2/2 + dot(theta)^2/2 + dot(w)^2/2
            + a*dot(x)*dot(theta)*sin(theta)/4 + a*(x*dot(y) - y*dot(x)) - a*sin(t)*z - w*x/3;
        constraints {
            pace: dot(x)^2 + (1 + y^2/2)*dot(y)^2 + dot(z)*dot(theta)/3 = 1 + cos(t + theta)/4;
            slope: dot(z) = x*dot(theta) + a;
            circle: d(w - x*y/4) = 0;
        }
        forces { drag: -a*dot(x)*dot(y)*d(x) + cos(t)*d(theta); }
    }",
);

/// An affine constraint.
static BELT: Text = Text::new(
    "Belt {
        coordinates { x; y; theta: angle; }
        lagrangian = (dot(x)^2 + (1 + x^2)*dot(y)^2 + dot(theta)^2)/2 - y + x*dot(theta)/2;
        constraints { belt: cos(theta)*dot(x) + sin(theta)*dot(y) = 1 + x*t; }
    }",
);

/// The constraint of [`BELT`], written as an equation that is not linear.
static BENT_BELT: Text = Text::new(
    "BentBelt {
        coordinates { x; y; theta: angle; }
        lagrangian = (dot(x)^2 + (1 + x^2)*dot(y)^2 + dot(theta)^2)/2 - y + x*dot(theta)/2;
        constraints {
            belt: exp((cos(theta)*dot(x) + sin(theta)*dot(y) - 1 - x*t)*(2 + dot(theta)^2)) = 1;
        }
    }",
);

/// A point at constant speed between walls with resets. The reset at the top violates the constraint.
static RUNNER: Text = Text::new(
    "Runner {
        coordinates { x; y; }
        parameters { v > 0 = 1; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2;
        constraints { speed: dot(x)^2 + dot(y)^2 = v^2; }
        impacts {
            right: x <= 1 => reset { dot(x) = -dot(x); };
            top: y <= 5 => reset { dot(y) = -2*dot(y); };
            bottom: y >= -100 => reset { };
        }
    }",
);

/// A constraint without solutions.
static IMPOSSIBLE: Text = Text::new(
    "Impossible {
        coordinates { x; y; }
        parameters { k > 0 = 1; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2;
        constraints { c: dot(x)^2 + dot(y)^2 = -k; }
    }",
);

/// The residuals of the constraints.
fn residuals(system: &Large, t: f64, state: &State) -> Vec<f64> {
    let qdot = system.velocity(t, state).expect("a velocity");
    let (residuals, _) = system.residuals(t, &system.position(state), &qdot);
    residuals.as_ref().to_vec()
}

type State = <Large as VectorField>::State;

/// Random states on the constraints and near them.
fn near(system: &Large, count: usize) -> Vec<State> {
    let mut random = Random::new(17);
    let mut found = states(system, count, 3);
    found.extend(states(system, count, 4).into_iter().map(|state| {
        let (q, qdot) = (
            system.position(&state),
            system.velocity(0.0, &state).expect("one"),
        );
        let mut off = qdot;
        let shift = random.like(&qdot, -0.1, 0.1);
        for (component, shift) in off.as_mut().iter_mut().zip(shift.as_ref()) {
            *component += shift;
        }
        system.state_unchecked(0.0, &q, &off).expect("a state")
    }));
    found
}

/// The state moved along its rate.
fn moved(state: &State, rate: &State, step: f64) -> State {
    let mut moved = *state;
    for (component, rate) in moved.as_mut().iter_mut().zip(rate.as_ref()) {
        *component += step * rate;
    }
    moved
}

/// Checks that the motion keeps the residual of every constraint, even if it is not 0.
fn check_kept(system: &Large) {
    for state in near(system, 8) {
        let (t, h) = (0.0, 1e-5);
        let mut rate = system.zero_state();
        system.rate(t, &state, &mut rate).expect("a rate");
        let ahead = residuals(system, t + h, &moved(&state, &rate, h));
        let behind = residuals(system, t - h, &moved(&state, &rate, -h));
        assert!(!ahead.is_empty());
        for (ahead, behind) in ahead.iter().zip(behind) {
            let slope = (ahead - behind) / (2.0 * h);
            assert!(slope.abs() < 1e-8, "{}: {slope}", system.description().name);
        }
    }
}

/// The systems of most checks.
fn systems() -> [Large; 3] {
    [
        shipped("constant_speed").sized(),
        shipped("appell_hamel").sized(),
        MIXED.sized(),
    ]
}

#[test]
fn the_field_keeps_the_value_of_every_constraint() {
    for system in systems() {
        check_kept(&system);
    }
}

/// Checks that the constraint force obeys Chetaev's rule, by finite differences of the constraints with respect to the
/// velocities.
fn check_rule(system: &Large) {
    let n = system.coordinate_count();
    for state in near(system, 8) {
        let (t, h) = (0.0, 1e-5);
        let (q, qdot) = (
            system.position(&state),
            system.velocity(t, &state).expect("one"),
        );
        let mut rate = system.zero_state();
        system.rate(t, &state, &mut rate).expect("a rate");
        let force = system.force(t, &q, &qdot);
        let multipliers = system.multipliers(t, &state).expect("multipliers");
        for k in 0..n {
            let at = |step: f64| {
                let mut qdot = qdot;
                qdot.as_mut()[k] += step;
                system.residuals(t, &q, &qdot).0
            };
            let (ahead, behind) = (at(h), at(-h));
            let slopes = ahead.as_ref().iter().zip(behind.as_ref());
            let reaction: f64 = slopes
                .zip(multipliers.as_ref())
                .map(|((ahead, behind), lambda)| lambda * (ahead - behind) / (2.0 * h))
                .sum();
            let pdot = rate.as_ref()[n + k];
            let expected = force.as_ref()[k] + reaction;
            assert!(
                (pdot - expected).abs() < 1e-8 * (1.0 + expected.abs()),
                "{}: {pdot} for {expected}",
                system.description().name
            );
        }
    }
}

#[test]
fn the_force_is_a_multiple_of_the_derivative_by_the_velocities() {
    for system in systems() {
        check_rule(&system);
    }
}

#[test]
fn an_affine_constraint_and_its_bent_form_have_the_same_field() {
    let (belt, bent) = (BELT.model(), BENT_BELT.model());
    let straight = belt.global().expect("the global form");
    for state in states(&straight, 12, 5) {
        let t = 0.7;
        let q = straight.position(&state);
        let qdot = straight.velocity(t, &state).expect("a velocity");
        let on = straight.state_projected(t, &q, &qdot).expect("a state");
        let qdot = straight.velocity(t, &on).expect("a velocity");
        let other = bent.state(t, &q, &qdot).expect("a state");
        let (mut rate, mut bent_rate) = (on, other);
        straight.rate(t, &on, &mut rate).expect("a rate");
        bent.rate(t, &other, &mut bent_rate).expect("a rate");
        assert_near("rate", rate.as_ref(), bent_rate.as_ref(), 1e-12);
        // On the constraint the bent form is `2 + thetadot^2` times the affine one, and `lambda eta` is the same.
        let factor = 2.0 + qdot.as_ref()[2].powi(2);
        let lambda = straight.multipliers(t, &on).expect("one").as_ref()[0];
        let bent_lambda = bent.multipliers(t, &other).expect("one").as_ref()[0];
        assert_near("lambda", &[bent_lambda * factor], &[lambda], 1e-12);
    }
}

#[test]
fn velocities_off_the_constraint_are_refused_or_moved_to_it() {
    let machine: Large = shipped("appell_hamel").sized();
    let given = [0.7, -0.4, -0.5];
    let (q, off) = (vector(&[0.1, 0.2, 0.3]), vector(&given));
    let refused = machine.state(0.0, &q, &off);
    assert!(
        matches!(
            refused,
            Err(StateError::OffConstraint { constraint: 0, .. })
        ),
        "{refused:?}"
    );
    let state = machine.state_projected(0.0, &q, &off).expect("a state");
    assert!(residuals(&machine, 0.0, &state)[0].abs() < 1e-15);
    let moved = machine.velocity(0.0, &state).expect("one");
    let pairs = moved.as_ref().iter().zip(given);
    assert!(
        pairs
            .map(|(found, given)| (found - given).abs())
            .fold(0.0, larger)
            < 0.2
    );
    let kept = machine.state_unchecked(0.0, &q, &off).expect("a state");
    assert!(residuals(&machine, 0.0, &kept)[0].abs() > 0.1);
    // At rest the constraint has no gradient.
    let rest = machine
        .state_projected(0.0, &q, &vector(&[0.0; 3]))
        .expect("a state");
    let mut rate = rest;
    let fault = machine.rate(0.0, &rest, &mut rate);
    assert!(
        matches!(fault, Err(Fault::SingularConstraint { constraint: 0, .. })),
        "{fault:?}"
    );
}

#[test]
fn velocities_that_are_not_named_follow_and_those_that_contradict_are_refused() {
    let particle = shipped("constant_speed").model();
    let complete = |qdot: [f64; 2], named: [f64; 2]| {
        particle.complete_velocity(0.0, &vector(&[0.0; 2]), &vector(&qdot), &vector(&named))
    };
    let both = complete([0.0; 2], [0.0; 2]).expect("velocities");
    assert_near("both", both.as_ref(), &[2.0_f64.sqrt(); 2], 1e-15);
    let one = complete([-1.2, 0.0], [1.0, 0.0]).expect("velocities");
    assert_near("one", one.as_ref(), &[-1.2, 1.6], 1e-15);
    for (qdot, named) in [([2.5, 0.0], [1.0, 0.0]), ([1.2, 1.5], [1.0, 1.0])] {
        let refused = complete(qdot, named);
        assert!(
            matches!(refused, Err(StateError::OffConstraint { .. })),
            "{refused:?}"
        );
    }
    let mixed: Large = MIXED.sized();
    let q = vector(&[0.3, -0.2, 0.1, 0.4, 0.0]);
    let completed = mixed
        .complete_velocity(
            0.0,
            &q,
            &vector(&[0.2, 0.0, 0.0, 0.0, 0.0]),
            &vector(&[1.0, 0.0, 0.0, 0.0, 0.0]),
        )
        .expect("velocities");
    assert!(mixed.state(0.0, &q, &completed).is_ok());
    assert_eq!(completed.as_ref()[0], 0.2);
}

#[test]
fn a_constraint_without_solutions_is_said_to_have_none() {
    let impossible = IMPOSSIBLE.model();
    let (q, qdot) = (vector(&[0.0; 2]), vector(&[0.3, 0.2]));
    let state = impossible.state_projected(0.0, &q, &qdot);
    let fault = Fault::ProjectionFailed { constraint: 0 };
    assert_eq!(state, Err(StateError::Fault(fault)));
    let completed = impossible.complete_velocity(0.0, &q, &qdot, &vector(&[1.0, 0.0]));
    assert!(
        matches!(
            completed,
            Err(StateError::OffConstraint { constraint: 0, .. })
        ),
        "{completed:?}"
    );
}

#[test]
fn projection_brings_a_coarse_run_back() {
    let mixed: Large = MIXED.sized();
    let (q, qdot) = ([0.3, -0.2, 0.1, 0.4, 0.5], [0.6, 0.5, 0.2, -0.1, 0.3]);
    let run = |on: bool| {
        let mut effects = (Some(Projection::new()), None, None);
        effects.set_projection(on);
        let run = Course::new(&mixed, &q, &qdot, 2.0)
            .tol(1e-13)
            .step(0.05)
            .effects(effects)
            .observed(Integrator::Rk4, &mut ());
        assert_eq!(run.outcome, Outcome::Done);
        let left = residuals(&mixed, run.t, &run.state);
        (
            left.iter()
                .fold(0.0, |worst: f64, value| larger(worst, value.abs())),
            mixed.levels(run.t, &mixed.position(&run.state)).as_ref()[0],
            run.counters.projections,
        )
    };
    let ((off, _, none), (on, level, some)) = (run(false), run(true));
    assert!(off > 1e-9 && none == 0, "{off}");
    assert!(on < 1e-13 && some > 10, "{on} after {some}");
    assert_near("level", &[level], &[0.515], 1e-13);
}

#[test]
fn walls_with_resets_are_the_only_ones_that_are_left() {
    let runner = RUNNER.model();
    let [right, top] = [0, 1];
    let run = |qdot: [f64; 2], law: Option<Law>| {
        let state = state(&runner, &[0.0; 2], &qdot);
        let mut course = Course::from_state(&runner, state, 10.0).tol(1e-13);
        if let Some(law) = law {
            course = course.law(right, law);
        }
        course.observed(Integrator::Dop853, &mut ())
    };
    let turned = run([1.0, 0.0], None);
    assert_eq!(turned.outcome, Outcome::Done);
    assert_near(
        "turned",
        turned.state.as_ref(),
        &[-8.0, 0.0, -1.0, 0.0],
        1e-12,
    );
    let wrong = run([0.0, 1.0], None).outcome;
    assert_eq!(
        wrong,
        Outcome::ResetOffConstraint {
            surface: top,
            constraint: 0
        }
    );
    let outcome = run([1.0, 0.0], Some(Law::Elastic)).outcome;
    assert_eq!(outcome, Outcome::NonlinearConstraints);
    let state = state(&runner, &[0.0; 2], &[1.0, 0.0]);
    assert_eq!(
        runner.contact(right, 0.0, &state).err(),
        Some(Fault::NonlinearConstraints)
    );
}

#[test]
fn the_discrete_principle_is_not_defined() {
    let particle = shipped("constant_speed").model();
    let state = state(&particle, &[0.0; 2], &[0.0, 2.0]);
    let run = Course::from_state(&particle, state, 1.0)
        .tol(1e-13)
        .step(0.1)
        .observed(Integrator::Dla2, &mut ());
    assert_eq!(run.outcome, Outcome::NonlinearConstraints);
}

#[test]
fn the_command_line_prints_what_there_is() {
    let given = json!([{ "q": [0, 0], "qdot": [0.6, 0.8] }]).to_string();
    let done = dalembert(&["eval", "constant_speed", "--set", "v=1"], &given);
    assert_eq!(done.exit, Exit::Reached, "{}", done.errors);
    let row: Value = serde_json::from_str(&done.output).expect("JSON");
    let row = &row[0];
    // m vdot = -m g e_y + 2 lambda v and vdot.v = 0 give lambda = m g vy/(2 v^2).
    assert_eq!(row["multipliers"], json!([0.4]));
    assert_eq!(row["divergence_mu_C"], Value::Null);
    assert_eq!(row["W"], json!([[1.2, 1.6]]));
    let done = dalembert(&["simulate", "constant_speed", "--json", "-"], "");
    assert_eq!(done.exit, Exit::Reached, "{}", done.errors);
    let text = dalembert(&["derive", "appell_hamel"], "").output;
    for expected in [
        "phi[machine] = ",
        "not linear in the velocities",
        "eta[machine] = ",
    ] {
        assert!(text.contains(expected), "{expected} in {text}");
    }
    let done = dalembert(&["check", "appell_hamel"], "");
    assert_eq!(done.exit, Exit::Reached, "{}", done.errors);
}

/// The messages of a refused model.
fn refused(declarations: &str) -> String {
    let model = format!(
        "P {{ coordinates {{ x; y; z; }} lagrangian = (dot(x)^2 + dot(y)^2 + dot(z)^2)/2;
         constraints {{ speed: dot(x)^2 + dot(y)^2 = 1; }} {declarations} }}"
    );
    let errors = compile(model.parse().expect("tokens")).expect_err("a refusal");
    errors
        .iter()
        .map(|error| error.message().to_owned())
        .collect()
}

#[test]
fn quantities_are_examined_and_what_needs_linear_constraints_is_refused() {
    let open =
        "is undecided: claims are examined only where constraints are linear in the velocities";
    for (claim, reason) in [
        (
            "not conserved: energy;",
            "is refuted: the rate of `energy` along the motion on D is 0",
        ),
        ("conserved: x;", "is refuted: `x` changes along the motion"),
        (
            "not conserved: dot(z);",
            "is refuted: the rate of `dot(z)` along the motion on D is 0",
        ),
    ] {
        let text = refused(&format!("claims {{ {claim} }}"));
        assert!(text.contains(reason), "{text}");
    }
    // A constraint of degree 3 in all velocities is solved for none of them.
    let text = refused(
        "constraints { c: dot(x)^3 + dot(y)^3 + dot(z)^3 = 1; } claims { conserved: dot(z); }",
    );
    assert!(text.contains(open), "{text}");
    let text =
        refused("impacts { w: x >= 0 => reset { x = 1; }; } claims { conserved under w: y; }");
    assert!(text.contains(open), "{text}");
    let text = refused("claims { assume density: exact; }");
    assert!(
        text.contains("only conserved quantities and invariant forms can be claimed"),
        "{text}"
    );
    let text = refused("scenes { a: volume; }");
    assert!(text.contains("no volume is known for it"), "{text}");
    let text =
        refused("constraints { c: d(z - x*y) = 0; } impacts { w: z >= 0 => reset { z = 1; }; }");
    assert!(
        text.contains("is not known to keep the level of `c`"),
        "{text}"
    );
}
