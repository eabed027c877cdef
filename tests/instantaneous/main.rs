//! Constraints that hold only in the moment of an impact: focusing, the impact law on them, and motion along the wall.

mod along;

use dalembert::law::Law;
use dalembert::{
    Described, EventLog, Impacting, Instance, Outcome, StateVector, System, VectorField,
};
use dalembert_cli::{Exit, Integrator};
use dalembert_codegen::compile;
use dalembert_codegen::program::{Input, Program, interpret::interpret};
use dalembert_stability::course::{Course, Driven, state, vector};
use dalembert_stability::text::{Large, Model, Text, shipped};
use dalembert_tests::command::dalembert;
use dalembert_tests::interpreted::input;
use dalembert_tests::numeric::assert_near;
use dalembert_tests::reference::{number, numbers, read};
use dalembert_tests::sampling::{Random, states};
use serde_json::Value;

type State = <Model as VectorField>::State;

/// The ball at a wall, with the sign of `no_slip` that is printed in the source. The sign fits a wall on the other side
/// of the ball.
static PRINTED_WALL: Text = Text::new(
    "PrintedWall {
        coordinates { x; y; phi: angle; theta in (0, pi); psi: angle; }
        parameters { r > 0 = 1; k > 0 = 2/3; }
        let omega_x = cos(psi)*dot(theta) + sin(psi)*sin(theta)*dot(phi);
        let omega_y = sin(psi)*dot(theta) - cos(psi)*sin(theta)*dot(phi);
        let spin = dot(phi)^2 + dot(psi)^2 + 2*cos(theta)*dot(phi)*dot(psi) + dot(theta)^2;
        lagrangian = 1/2*(dot(x)^2 + dot(y)^2) + k^2/2*spin;
        constraints {
            rolling_x: dot(x) - r*omega_y = 0;
            rolling_y: dot(y) + r*omega_x = 0;
        }
        impacts {
            wall: x <= 3 => elastic, instantaneous {
                no_slip: dot(y) - r*(cos(theta)*dot(phi) + dot(psi)) = 0;
            };
        }
    }",
);

/// A disk that falls on a floor with the slope angle `alpha` and does not slip on it.
static INCLINE: Text = Text::new(
    "Incline {
        coordinates { x; y; theta; }
        parameters { m > 0 = 2; r > 0 = 1/2; I > 0 = 1/8; g > 0 = 9.81; alpha = 1/5; e in [0, 1] = 1/2; belt = 0; }
        lagrangian = m/2*(dot(x)^2 + dot(y)^2) + I/2*dot(theta)^2 + m*g*(x*sin(alpha) - y*cos(alpha));
        impacts {
            floor: y >= r => newton(e), instantaneous { roll: dot(x) - r*dot(theta) = belt; };
        }
        scenes { dropped: floor; }
    }",
);

/// A rough wall on which a point can move only in one direction.
static RAIL: Text = Text::new(
    "Rail {
        coordinates { x; y; }
        parameters { slope != 0 = 1; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2;
        impacts { wall: y >= 0 => elastic, instantaneous { rail: dot(x) + slope*dot(y) = 0; }; }
    }",
);

dalembert::model! {
    /// A knife edge. At an impact, its tip sticks to a curved wall in a direction that depends on the state.
    #[global]
    pub Tip {
        coordinates { x; y; theta: angle; z; }
        parameters { m > 0 = 2; I > 0 = 1/3; a > 0 = 1/4; }
        lagrangian = m/2*(dot(x)^2 + dot(y)^2) + I/2*dot(theta)^2 + dot(z)^2/2 + a*dot(x)*dot(theta)*sin(theta);
        constraints { blade: sin(theta)*d(x) = cos(theta)*d(y); }
        impacts {
            wall: x + y^2/8 + sin(theta)/4 + z/3 >= 0 => elastic, instantaneous {
                stick: dot(z) = cos(y)*dot(theta);
                drag: d(y) + x*d(theta) - z*d(z) = 0;
            };
        }
    }
}

static TIP: Text = Text::new(Tip::DESCRIPTION.source.value());

/// Two walls with instantaneous constraints, one for each coordinate, and a floor without.
static CORNER: Text = Text::new(
    "Corner {
        const N = 2;
        coordinates { x[N]; z; w; }
        lagrangian = (dot(x[1])^2 + dot(x[2])^2 + dot(z)^2 + dot(w)^2)/2 - x[1] - x[2] - z;
        impacts {
            wall[i in 1..=N]: x[i] >= 0 => impact_plastic, instantaneous { slip: dot(w) = i*dot(z); };
            floor: z + w >= 0 => impact_plastic;
        }
    }",
);

/// An instantaneous constraint that depends on the other constraint at x = 0.
static DEGENERATE: Text = Text::new(
    "Degenerate {
        coordinates { x; y; z; }
        lagrangian = (dot(x)^2 + dot(y)^2 + dot(z)^2)/2;
        constraints { level: d(z) = 0; }
        impacts { wall: y >= 0 => elastic, instantaneous { stuck: x*d(x) + d(z) = 0; }; }
    }",
);

/// The state after an impact at `t = 0`, as a run computes it.
fn struck<S: Driven>(system: &S, law: Law, state: S::State) -> S::State {
    let mut events = EventLog::<_, 4>::new();
    Course::from_state(system, state, 0.0)
        .law(0, law)
        .observed(Integrator::Dop853, &mut events);
    events.iter().next().expect("an impact").after
}

/// Velocities of the ball from its quasi-velocities.
fn velocities(q: &[f64], [vx, vy, w1, w2, w3]: [f64; 5]) -> [f64; 5] {
    let ((s, c), (sp, cp)) = (q[3].sin_cos(), q[4].sin_cos());
    let theta = cp * w1 + sp * w2;
    let phi = (sp * w1 - cp * w2) / s;
    [vx, vy, phi, theta, w3 - c * phi]
}

fn check_ball(system: &Large, variant: &str) -> usize {
    let reference = read("cortes_vinogradov");
    let cases = reference["cv62_wall"]["cases"].as_array().expect("cases");
    let q = [
        3.0 - f64::from(u8::from(variant == "physical")),
        0.4,
        0.7,
        1.2,
        -0.6,
    ];
    let of = |value: &Value| velocities(&q, numbers(value).try_into().expect("five numbers"));
    for case in cases {
        let state = state(system, &q, &of(&case["velocity_minus"]));
        let energies = numbers(&case[variant]["energies"]);
        for (law, name, energy) in [
            (Law::Elastic, "elastic_velocity_plus", energies[1]),
            (Law::Newton(1.0), "elastic_velocity_plus", energies[1]),
            (
                Law::Restitution(0.0),
                "inelastic_velocity_plus",
                energies[2],
            ),
            (Law::ImpactPlastic, "inelastic_velocity_plus", energies[2]),
        ] {
            let after = struck(system, law, state);
            let actual = system.velocity(0.0, &after).expect("a velocity");
            let label = format!("{variant} {law}");
            assert_near(&label, actual.as_slice(), &of(&case[variant][name]), 1e-13);
            let actual = system.energy(0.0, &after).expect("an energy");
            assert_near(&label, &[actual], &[energy], 1e-13);
        }
    }
    cases.len()
}

#[test]
fn a_ball_leaves_a_wall_without_slip_as_the_references_say() {
    let ball: Large = shipped("rolling_ball_wall").sized();
    assert!(check_ball(&ball, "physical") >= 4);
    check_ball(&ball.global().expect("the global form"), "physical");
    let printed: Large = PRINTED_WALL.sized();
    check_ball(&printed, "printed");
    check_ball(&printed.global().expect("the global form"), "printed");
}

/// Random states of `Tip` on its wall that approach the wall.
fn at_the_wall(tip: &Model, count: usize, seed: u64) -> Vec<State> {
    let mut random = Random::new(seed);
    (0..count)
        .map(|_| {
            let mut at = random.like(&tip.zero_vector(), -1.0, 1.0);
            let q = at.as_mut();
            q[3] = -3.0 * (q[0] + q[1] * q[1] / 8.0 + q[2].sin() / 4.0);
            let mut qdot = random.like(&at, -1.0, 1.0);
            let state = tip.state_projected(0.0, &at, &qdot).expect("a state");
            if tip.gap_rates(0.0, &state).expect("rates").as_ref()[0] < 0.0 {
                return state;
            }
            qdot = tip.velocity(0.0, &state).expect("a velocity");
            qdot.as_mut()
                .iter_mut()
                .for_each(|component| *component = -*component);
            tip.state(0.0, &at, &qdot).expect("a state")
        })
        .collect()
}

/// The forms of the instantaneous constraints of `Tip`, written by hand.
fn rough_forms(q: &[f64]) -> [[f64; 4]; 2] {
    [[0.0, 0.0, -q[1].cos(), 1.0], [0.0, 1.0, q[0], -q[3]]]
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// The vector that three covectors of four components annihilate.
fn across([a, b, c]: [[f64; 4]; 3]) -> [f64; 4] {
    std::array::from_fn(|skip| {
        let kept: Vec<usize> = (0..4).filter(|i| *i != skip).collect();
        let [i, j, k] = [kept[0], kept[1], kept[2]];
        let minor = a[i] * (b[j] * c[k] - b[k] * c[j]) - a[j] * (b[i] * c[k] - b[k] * c[i])
            + a[k] * (b[i] * c[j] - b[j] * c[i]);
        if skip % 2 == 0 { minor } else { -minor }
    })
}

#[test]
fn focusing_is_the_projection_on_all_constraints_and_the_law_acts_within_them() {
    let tip = TIP.model();
    let mut turned = 0;
    for before in at_the_wall(&tip, 200, 5) {
        let q = tip.position(&before);
        let q = q.as_ref();
        let blade = [q[2].sin(), -q[2].cos(), 0.0, 0.0];
        let [stick, drag] = rough_forms(q);
        let left = across([blade, stick, drag]);
        let focused = focused(&tip, &before);
        let qdot = tip.velocity(0.0, &focused).expect("a velocity");
        for form in [blade, stick, drag] {
            assert!(dot(&form, qdot.as_ref()).abs() < 1e-13);
        }
        // The impulse of these constraints has no component along the velocities that they allow.
        let [after, start] =
            [&focused, &before].map(|state| tip.momentum(0.0, state).expect("momenta"));
        assert!(dot(&left, &difference(after.as_ref(), start.as_ref())).abs() < 1e-13);
        // The constraints allow one direction, so that a law can only multiply the velocity by a factor.
        let rate = tip.gap_rates(0.0, &focused).expect("rates").as_ref()[0];
        let factor = if rate < 0.0 { -0.25 } else { 1.0 };
        turned += usize::from(rate >= 0.0);
        let expected: Vec<f64> = qdot
            .as_ref()
            .iter()
            .map(|component| component * factor)
            .collect();
        let after = struck(&tip, Law::Newton(0.25), before);
        let actual = tip.velocity(0.0, &after).expect("a velocity");
        assert_near("newton", actual.as_ref(), &expected, 1e-13);
        let global = tip.global().expect("the global form");
        let qdot = tip.velocity(0.0, &before).expect("one");
        let state = global.state_unchecked(0.0, &vector(q), &qdot);
        let after = struck(&global, Law::Newton(0.25), state.expect("a state"));
        let actual = global.velocity(0.0, &after).expect("a velocity");
        assert_near("global", actual.as_ref(), &expected, 1e-12);
    }
    assert!((2..198).contains(&turned), "{turned} of 200");
}

/// The state after the impulse that makes the constraints of the wall hold.
fn focused(tip: &Model, before: &State) -> State {
    let impulse = tip.focus(0, 0.0, before).expect("no fault");
    let mut focused = *before;
    tip.kick(&mut focused, 1.0, &impulse.expect("an impulse"));
    focused
}

fn difference(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a - b).collect()
}

/// Carnot's theorem for linear constraints (Cortes and Vinogradov, 5.7): the energy never grows, and focusing takes the
/// kinetic energy of the velocity that it removes.
#[test]
fn energy_is_lost_in_focusing_and_kept_by_an_elastic_wall_within_the_constraints() {
    let tip = TIP.model();
    let energy = |state: &State| tip.energy(0.0, state).expect("an energy");
    for before in at_the_wall(&tip, 60, 6) {
        let focused = focused(&tip, &before);
        let states = [&before, &focused];
        let [v, v_focused] = states.map(|state| tip.velocity(0.0, state).expect("one"));
        let [p, p_focused] = states.map(|state| tip.momentum(0.0, state).expect("one"));
        let velocity = difference(v.as_ref(), v_focused.as_ref());
        let momentum = difference(p.as_ref(), p_focused.as_ref());
        let taken = 0.5 * dot(&velocity, &momentum);
        assert!(taken > 1e-6);
        let after = struck(&tip, Law::Elastic, before);
        let lost = energy(&before) - energy(&after);
        assert_near("elastic", &[lost], &[taken], 1e-13);
        for law in [
            Law::Restitution(0.5),
            Law::Newton(0.9),
            Law::ImpactPlastic,
            Law::TotallyPlastic,
            Law::NonholonomicPlastic,
        ] {
            let lost = energy(&before) - energy(&struck(&tip, law, before));
            assert!(lost >= taken * (1.0 - 1e-12), "{law}: {lost} of {taken}");
        }
        // A state that already satisfies the constraints loses no energy.
        if tip.gap_rates(0.0, &focused).expect("rates").as_ref()[0] < 0.0 {
            let after = struck(&tip, Law::Elastic, focused);
            assert_near("focused", &[energy(&after)], &[energy(&focused)], 1e-14);
        }
    }
}

#[test]
fn constraints_may_turn_the_motion_round_before_the_law_does() {
    let rail = RAIL.model();
    for (velocity, expected) in [([3.0, -1.0], [-2.0, 2.0]), ([-3.0, -1.0], [-1.0, 1.0])] {
        let state = state(&rail, &[0.5, 0.0], &velocity);
        let after = struck(&rail, Law::Elastic, state);
        assert_near("rail", &after.as_ref()[2..], &expected, 1e-15);
    }
}

/// Compares emitted functions with the interpreted program that they were emitted from.
fn check_emission<S: Described + Impacting>(system: &S, program: &Program) {
    let functions = program.impacting.as_ref().expect("surfaces");
    for state in states(system, 4, 3) {
        let motion: S::Impulse = Random::new(4).vector(-1.0, 1.0);
        let of_state = input(system, 0.0, &state);
        let at = |input: Input| match input {
            Input::MotionRate(i) => motion.as_slice()[i],
            other => of_state(other),
        };
        let run = |function: &dalembert_codegen::program::Function| {
            interpret(function, &at).expect("a value")
        };
        let focus = system
            .focus(0, 0.0, &state)
            .expect("no fault")
            .expect("an impulse");
        assert_eq!(
            focus.as_slice(),
            run(functions.focuses[0].as_ref().expect("one"))
        );
        let trace = system
            .trace(0, 0.0, &state, &motion)
            .expect("no fault")
            .expect("a force");
        assert_eq!(
            trace.as_slice(),
            run(functions.traces[0].as_ref().expect("one"))
        );
        let contact = system.contact(0, 0.0, &state).expect("a contact");
        let interpreted = run(&functions.contacts[0]);
        assert_eq!(contact.constrained_compliance, interpreted[3]);
        assert_eq!(contact.direction.as_slice(), &interpreted[5..]);
    }
}

#[test]
fn emitted_functions_are_what_the_interpreter_executes() {
    let compiled = compile(Tip::DESCRIPTION.source.parse().expect("tokens")).expect("a model");
    check_emission(&Tip::default(), &compiled.programs.main);
    check_emission(&TipGlobal(Tip::default()), compiled.programs.global());
}

#[test]
fn integrators_agree_on_a_ball_that_rolls_against_its_wall() {
    let ball: Large = shipped("rolling_ball_wall").sized();
    let made = |integrator| {
        let run = Course::declared(&ball, 4.0)
            .tol(1e-13)
            .observed(integrator, &mut ());
        assert_eq!(run.counters.impacts, 1);
        run.state
    };
    let (steps, series) = (made(Integrator::Dop853), made(Integrator::Taylor));
    assert_near("state", steps.as_ref(), series.as_ref(), 1e-11);
}

/// Notes on a model with these claims, or its messages if it is refused.
fn told(claims: &str) -> Result<Vec<String>, Vec<String>> {
    let model = format!(
        "P {{ coordinates {{ x; y; }} lagrangian = (dot(x)^2 + dot(y)^2)/2;
         impacts {{ w: y >= 0 => elastic, instantaneous {{ s: dot(x) = 0; }}; }} claims {{ {claims} }} }}"
    );
    match compile(model.parse().expect("tokens")) {
        Ok(compiled) => Ok(compiled
            .findings
            .iter()
            .map(|finding| finding.note())
            .collect()),
        Err(errors) => Err(errors
            .iter()
            .map(|error| error.message().to_owned())
            .collect()),
    }
}

#[test]
fn claims_about_such_impacts_are_decided() {
    let refused = told("conserved under w: dot(x);").expect_err("refuted");
    assert!(
        refused[0].contains("is refuted") && refused[0].contains("dot(x) after = 0\n"),
        "{refused:?}"
    );
    assert!(told("conserved under w: energy;").is_err());
    let claims = "density: exact; conserved under w: dot(y)^2; not conserved under w: energy;";
    let notes = told(claims).expect("accepted");
    let volume = notes
        .iter()
        .find(|note| note.contains("density: exact"))
        .expect("a note");
    assert!(
        volume.contains("for the motion between impacts only"),
        "{volume}"
    );
    assert!(
        volume.contains("w maps it to 0, because of its instantaneous constraints"),
        "{volume}"
    );
}

#[test]
fn the_state_at_the_constraints_is_printed_beside_the_laws() {
    let q = [2.0, 0.0, 0.3, 1.0, -0.4];
    let qdot = velocities(&q, [1.0, -0.5, 0.5, 1.0, 2.0]);
    let given = serde_json::json!([{ "q": q, "qdot": qdot }]).to_string();
    let done = dalembert(&["eval", "rolling_ball_wall"], &given);
    assert_eq!(done.exit, Exit::Reached, "{}", done.errors);
    let rows: Value = serde_json::from_str(&done.output).expect("JSON");
    let wall = &rows[0]["impacts"]["wall"];
    let of = |value: &Value, name: &str| numbers(&value[name]);
    let focused = &wall["focused"];
    let (before, after) = (
        of(focused, "qdot_plus"),
        of(&wall["laws"]["elastic"], "qdot_plus"),
    );
    assert_near("focused", &[before[0]], &[after[0].abs()], 1e-13);
    let slip = |qdot: &[f64]| qdot[1] + qdot[2] * 1.0_f64.cos() + qdot[4];
    assert_near("slip", &[slip(&before), slip(&after)], &[0.0; 2], 1e-13);
    assert_near(
        "rate",
        &[number(&focused["gap_rate_plus"])],
        &[-before[0]],
        1e-13,
    );
    let text = dalembert(&["derive", "rolling_ball_wall"], "").output;
    let expected = "surface wall: elastic, instantaneous { no_slip }";
    assert!(text.contains(expected), "{text}");
    assert!(text.contains("psi[no_slip]"), "{text}");
}

/// Two modes: the surface of the first has no instantaneous constraint, the wall of the second has one.
static MODAL: Text = Text::new(
    "Modal {
        coordinates { x; y; }
        modes {
            free { impacts { side: x >= -9; } }
            rough {
                impacts { wall: y >= 0 => elastic, instantaneous { rail: dot(x) + dot(y) = 0; }; }
            }
        }
        transitions { enter: free -> rough when x >= 1; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2;
    }",
);

#[test]
fn a_mode_has_the_instantaneous_constraints_of_its_surfaces() {
    let modal = MODAL.model();
    let start = state(&modal, &[0.0, 1.0], &[3.0, -1.0]);
    let run = Course::from_state(&modal, start, 2.0).observed(Integrator::Dop853, &mut ());
    assert_eq!(run.outcome, Outcome::Done);
    let qdot = modal.velocity(run.t, &run.state).expect("a velocity");
    assert_near("rail", qdot.as_ref(), &[-2.0, 2.0], 1e-12);
}
