//! Compares the reduced form on D with independent values of 50 digits and with the global form.

use dalembert::erased::Bounded;
use dalembert::integrate::Chosen;
use dalembert::math::larger;
use dalembert::{
    Constrained, Dop853, Fault, Instance, Simulation, StateVector, System, Tolerance, VectorField,
};
use dalembert_cli::Exit;
use dalembert_cli::Integrator;
use dalembert_cli::suite::Setting;
use dalembert_stability::course::Course;
use dalembert_stability::text::{Large, Model, shipped, value};
use dalembert_tests::command::dalembert;
use dalembert_tests::numeric::Reported;
use dalembert_tests::reference::{compare, read};
use dalembert_tests::sampling::{Random, every_system, states};
use serde_json::{Map, Value};

/// Names of the compared quantities, in the reference files and in the output of `eval`.
const QUANTITIES: [&str; 7] = [
    "u",
    "udot",
    "X_0",
    "X",
    "G_D",
    "multipliers",
    "mu_C_density_frame",
];

/// The frame of the angular velocity in space is singular at the singularities of the Euler angles. There the rates of
/// the angles do not exist, but the energy does.
#[test]
fn a_frame_ends_where_its_angles_do() {
    let ball = shipped("rolling_ball_euler").large([]);
    for theta in [0.0, core::f64::consts::PI] {
        let state = Bounded::of(&[0.1, 0.2, 0.3, theta, 0.4, 1.0, -0.5, 0.25]);
        let mut rate = state;
        let fault = Err(Fault::SingularFrame { quasi: 1 });
        assert_eq!(ball.rate(0.0, &state, &mut rate), fault);
        let energy = ball.energy(0.0, &state).expect("an energy");
        let (k, r) = (value(&ball, "k"), value(&ball, "r"));
        let square = k * k;
        let expected = 0.5 * ((square + r * r) * 1.25 + square * 0.0625);
        assert!((energy - expected).abs() < 1e-15 * expected.abs() * 4.0);
    }
}

#[test]
fn the_reduced_form_has_the_reference_values() {
    let files = [
        ("reduced_chaplygin_sleigh", "chaplygin_sleigh"),
        ("reduced_affine_sleigh", "affine_sleigh"),
        ("reduced_damped_sleigh", "damped_sleigh"),
        ("reduced_magnetic_disk", "magnetic_disk"),
        ("reduced_rheonomic", "rheonomic"),
        ("reduced_rolling_disk", "rolling_disk"),
        ("reduced_rotating_table", "ball_on_rotating_table"),
    ];
    let mut compared = 0;
    for (file, model) in files {
        let reference = read(file);
        let states = reference["states"].as_array().expect("states");
        let given: Vec<Value> = states.iter().map(input).collect();
        let mut arguments = vec!["eval".to_owned(), model.to_owned()];
        let parameters = reference["system"]["parameters"].as_object();
        for (name, value) in parameters.expect("parameters") {
            let value = value.as_str().expect("a number");
            // `d` is a reserved word of the language.
            let name = if name == "d" { "d_" } else { name };
            arguments.extend(["--set".to_owned(), format!("{name}={value}")]);
        }
        let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
        let finished = dalembert(&arguments, &Value::from(given).to_string());
        assert_eq!(finished.exit, Exit::Reached, "{file}: {}", finished.errors);
        let printed: Value = serde_json::from_str(&finished.output).expect("JSON");
        for (k, state) in states.iter().enumerate() {
            for quantity in QUANTITIES {
                let actual = &printed[k][quantity];
                let path = format!("{file} {k} {quantity}");
                if let Err(error) = compare(&path, actual, &state[quantity], 1e-12) {
                    panic!("{error}");
                }
                compared += 1;
            }
        }
    }
    assert!(compared > 7 * 7 * 5, "{compared}");
}

/// The state as `eval` takes it.
fn input(state: &Value) -> Value {
    let names = ["q", "qdot", "t"].into_iter();
    let given = names.filter_map(|name| Some((name.to_owned(), state.get(name)?.clone())));
    given.collect::<Map<String, Value>>().into()
}

/// Checks that the reduced and the global form of a model have the same motion: the same accelerations at the same
/// velocities.
#[derive(Default)]
struct SameMotion {
    models: usize,
}

impl SameMotion {
    fn compare(&mut self, system: &Large) {
        let quasi = system.description().quasi_velocities.len();
        if quasi == 0 {
            return;
        }
        self.models += 1;
        let name = system.description().name;
        let global = system.global().expect("the global form");
        let t = 0.3;
        for state in states(system, 10, 5) {
            let (q, qdot) = (system.position(&state), system.velocity(t, &state));
            let qdot = qdot.expect("a velocity");
            let other = global.state_unchecked(t, &q, &qdot).expect("a state");
            let mut reported = Reported::default();
            global.inspect(t, &other, &mut reported).expect("a report");
            let expected = &reported.0["acceleration"];
            let mut rate = system.zero_state();
            system.rate(t, &state, &mut rate).expect("a rate");
            let actual = acceleration(system, t, &state, &rate);
            let size = expected
                .iter()
                .fold(1.0_f64, |size, value| larger(size, value.abs()));
            assert_eq!(actual.len(), expected.len(), "{name}");
            for (actual, expected) in actual.iter().zip(expected) {
                let error = (actual - expected).abs();
                assert!(error < 1e-7 * size, "{name}: {actual} for {expected}");
            }
            let energies = [system.energy(t, &state), global.energy(t, &other)];
            let [reduced, of_global] = energies.map(|energy| energy.expect("an energy"));
            assert!(
                (reduced - of_global).abs() <= 1e-13 * reduced.abs().max(1e-3),
                "{name}"
            );
            let momenta = system.momentum(t, &state).expect("momenta");
            let back = system.state_from_momenta(t, &q, &momenta).expect("a state");
            for (back, component) in back.as_slice().iter().zip(state.as_slice()) {
                assert!(
                    (back - component).abs() < 1e-11 * component.abs().max(1.0),
                    "{name}"
                );
            }
        }
    }
}

/// The derivative of `qdot` along the rate of the state, by finite differences of the velocity.
fn acceleration<S: System>(system: &S, t: f64, state: &S::State, rate: &S::State) -> Vec<f64> {
    let h = 1e-4;
    let at = |k: f64| {
        let mut moved = *state;
        for (x, v) in moved.as_mut_slice().iter_mut().zip(rate.as_slice()) {
            *x += k * h * v;
        }
        let qdot = system.velocity(t + k * h, &moved).expect("a velocity");
        qdot.as_slice().to_vec()
    };
    let pair = |k: f64| -> Vec<f64> {
        let sides = at(k).into_iter().zip(at(-k));
        sides.map(|(right, left)| right - left).collect()
    };
    let pairs = pair(1.0).into_iter().zip(pair(2.0));
    pairs
        .map(|(first, second)| (8.0 * first - second) / (12.0 * h))
        .collect()
}

#[test]
fn both_forms_are_the_same_motion() {
    let mut visitor = SameMotion::default();
    for system in every_system() {
        visitor.compare(system);
    }
    assert!(visitor.models >= 12, "{}", visitor.models);
}

/// Both forms project a velocity that violates the constraints to the same nearest velocity.
#[test]
fn both_forms_project_to_the_same_velocity() {
    for system in every_system() {
        let global = system.global().expect("the global form");
        let mut random = Random::new(9);
        let zero = system.zero_vector();
        let (q, qdot) = (random.like(&zero, 0.2, 1.3), random.like(&zero, -1.0, 1.0));
        let reduced = system.state_nearest(0.1, &q, &qdot).expect("a state");
        let other = global.state_nearest(0.1, &q, &qdot).expect("a state");
        let [reduced, other] = [system.velocity(0.1, &reduced), global.velocity(0.1, &other)];
        let [reduced, other] = [reduced.expect("a velocity"), other.expect("a velocity")];
        for (reduced, other) in reduced.as_slice().iter().zip(other.as_slice()) {
            let name = system.description().name;
            assert!(
                (reduced - other).abs() < 1e-12,
                "{name}: {reduced} and {other}"
            );
        }
    }
}

/// Times of impacts, and the velocities after the last impact.
fn run(system: &Model, q: &[f64], qdot: &[f64], count: u64) -> (Vec<f64>, Vec<f64>) {
    let course = Course::new(system, q, qdot, 1e4).tol(1e-14).impacts(count);
    let end = course.run(Setting::free(Integrator::Dop853));
    (end.times(), end.qdot)
}

/// Both forms have the same impacts on the circular table, which amplifies errors slowly.
#[test]
fn both_forms_meet_the_same_impacts() {
    let disk = shipped("rolling_disk").with([("ta", 0.2), ("tb", 0.2)]);
    let radius = value(&disk, "R");
    let phi = core::f64::consts::FRAC_PI_2;
    let qdot = [
        10.0 * radius * phi.cos(),
        10.0 * radius * phi.sin(),
        10.0,
        0.2,
    ];
    let q = [0.0, 0.0, 0.0, phi];
    let (reduced, last) = run(&disk, &q, &qdot, 20);
    let (other, global_last) = run(&disk.global().expect("the global form"), &q, &qdot, 20);
    assert_eq!((reduced.len(), other.len()), (20, 20));
    for (reduced, other) in reduced.iter().zip(&other) {
        assert!((reduced - other).abs() < 1e-9, "{reduced} and {other}");
    }
    for (reduced, other) in last.iter().zip(&global_last) {
        assert!((reduced - other).abs() < 1e-8, "{reduced} and {other}");
    }
}

/// A reduced state lies on D by construction. Even a long run at a loose tolerance leaves only rounding errors.
#[test]
fn a_reduced_state_never_leaves_the_constraints() {
    let disk = shipped("rolling_disk").model();
    let start = disk.initial();
    let qdot = disk.complete_velocity(0.0, &start.q, &start.qdot, &start.named);
    let state = disk
        .state(0.0, &start.q, &qdot.expect("velocities"))
        .expect("a state");
    let mut stepper = Dop853::new(Tolerance::new(1e-3).expect("a tolerance"));
    let run = Simulation::new(&disk, Chosen::new(&mut stepper), ())
        .run(0.0, state, 1e4, &mut ())
        .expect("a start");
    let (q, qdot) = (disk.position(&run.state), disk.velocity(run.t, &run.state));
    let (residuals, scales) = disk.residuals(run.t, &q, &qdot.expect("a velocity"));
    for (residual, scale) in residuals.as_slice().iter().zip(scales.as_slice()) {
        assert!(residual.abs() <= 4.0 * f64::EPSILON * scale, "{residual:e}");
    }
}
