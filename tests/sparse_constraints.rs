//! Many constraints, each coupled to few others. A chain described by the positions of its masses, with rods as
//! constraints, is compared with the same chain described by the angles of its rods.

use dalembert::law::Law;
use dalembert::math::larger;
use dalembert::{Described, Fault, Impacting, Instance, System, VectorField};
use dalembert_codegen::compile;
use dalembert_models::Chain16;
use dalembert_tests::numeric::Reported;
use dalembert_tests::sampling::Random;

const LINKS: usize = 16;

dalembert::model! {
    /// Chain in the positions of its masses.
    pub Rods {
        const N = 16;
        coordinates { x[N]; y[N]; }
        parameters { m[N] > 0 = 1; g = 9.81; }
        lagrangian = sum(i in 1..=N: m[i]/2*(dot(x[i])^2 + dot(y[i])^2) - m[i]*g*y[i]);
        let X[0] = 0;
        let X[i in 1..=N] = x[i];
        let Y[0] = 0;
        let Y[i in 1..=N] = y[i];
        constraints {
            rod[i in 1..=N]: (X[i] - X[i-1])*(d(X[i]) - d(X[i-1])) + (Y[i] - Y[i-1])*(d(Y[i]) - d(Y[i-1])) = 0;
        }
        impacts { floor: y[N] + 20 >= 0; }
    }
}

/// Positions, velocities and accelerations of the masses from those of the angles: all `x`, then all `y`.
fn places(angles: &[f64], rates: &[f64], accelerations: &[f64]) -> [[f64; 2 * LINKS]; 3] {
    let mut places = [[0.0; 2 * LINKS]; 3];
    let mut end = [[0.0; 2]; 3];
    for i in 0..LINKS {
        let (sin, cos) = angles[i].sin_cos();
        let (rate, acceleration) = (rates[i], accelerations[i]);
        let links = [
            [sin, -cos],
            [cos * rate, sin * rate],
            [
                cos * acceleration - sin * rate * rate,
                sin * acceleration + cos * rate * rate,
            ],
        ];
        for (end, link) in end.iter_mut().zip(links) {
            end[0] += link[0];
            end[1] += link[1];
        }
        for (place, end) in places.iter_mut().zip(end) {
            place[i] = end[0];
            place[LINKS + i] = end[1];
        }
    }
    places
}

/// A random state of the chain in positions, and the accelerations that the chain in angles gives.
fn random_state(random: &mut Random) -> (<Rods as VectorField>::State, Vec<f64>) {
    let chain = Chain16::default();
    let angles = random.vector::<<Chain16 as System>::Vector>(-3.0, 3.0);
    let rates = random.vector::<<Chain16 as System>::Vector>(-1.0, 1.0);
    let state = chain.state(0.0, &angles, &rates).expect("a state");
    let mut reported = Reported::default();
    let done = chain.inspect(0.0, &state, &mut reported);
    done.expect("equations of motion");
    let accelerations = &reported.0["acceleration"];
    let [q, qdot, expected] = places(angles.as_slice(), rates.as_slice(), accelerations);
    let state = Rods::default().state(0.0, &q.into(), &qdot.into());
    (state.expect("a state"), expected.to_vec())
}

fn largest(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(0.0, |largest, value| larger(largest, value.abs()))
}

#[test]
fn rods_as_constraints_move_the_masses_as_angles_do() {
    let (rods, mut random) = (Rods::default(), Random::new(7));
    for _ in 0..20 {
        let (state, expected) = random_state(&mut random);
        let mut rate = state;
        rods.rate(0.0, &state, &mut rate).expect("a rate");
        // Masses are 1, so that the rate of a momentum is an acceleration.
        let errors = expected.iter().enumerate();
        let error = largest(errors.map(|(i, value)| rate[2 * LINKS + i] - value));
        let size = largest(expected.iter().copied());
        assert!(error <= 1e-11 * size, "{error:e} of {size}");
    }
}

#[test]
fn projections_and_impacts_keep_the_rods() {
    let (rods, mut random) = (Rods::default(), Random::new(8));
    for _ in 0..10 {
        let (state, _) = random_state(&mut random);
        let contact = rods.contact(0, 0.0, &state).expect("a contact");
        let mut after = state;
        rods.kick(
            &mut after,
            contact.impulse(Law::Newton(0.3)),
            &contact.direction,
        );
        let [q, before, qdot] = [
            rods.position(&after),
            rods.velocity(0.0, &state).expect("velocities"),
            rods.velocity(0.0, &after).expect("velocities"),
        ];
        let violation = rods.admit(0.0, &q, &qdot);
        assert!(violation.is_ok(), "{violation:?}");
        let last = 2 * LINKS - 1;
        assert!((qdot[last] + 0.3 * before[last]).abs() < 1e-11 * before.amax());
        // The projection of velocities is idempotent.
        let wild = random.vector::<<Rods as System>::Vector>(-1.0, 1.0);
        let near = rods.state_projected(0.0, &q, &wild).expect("a state");
        let near = rods.velocity(0.0, &near).expect("velocities");
        assert!(rods.admit(0.0, &q, &near).is_ok());
        let again = rods.state_projected(0.0, &q, &near).expect("a state");
        let again = rods.velocity(0.0, &again).expect("velocities");
        assert!((again - near).amax() < 1e-12);
    }
}

/// On a straight chain, the two rods at a light mass between heavy ones are nearly dependent constraints.
#[test]
fn a_solve_that_would_lose_its_digits_is_refused_with_its_condition() {
    let straight = [0.3; LINKS];
    let [q, qdot, _] = places(&straight, &[0.1; LINKS], &[0.0; LINKS]);
    let rate = |light: f64| {
        let mut rods = Rods::default();
        rods.m[7] = light;
        let state = rods.state(0.0, &q.into(), &qdot.into())?;
        let mut rate = state;
        rods.rate(0.0, &state, &mut rate)
            .map_err(dalembert::StateError::from)
    };
    assert!(rate(1e-4).is_ok());
    let refused = rate(1e-9);
    let Err(dalembert::StateError::Fault(Fault::SingularConstraint { condition, .. })) = refused
    else {
        panic!("{refused:?}");
    };
    assert!((1e4..1e6).contains(&condition), "{condition:e}");
}

/// No motion takes a rod to length 0, so that steps need no check of the rank.
#[test]
fn rods_cannot_become_dependent() {
    assert!(!Rods::default().can_lose_rank());
}

#[test]
fn operations_grow_with_the_number_of_rods() {
    let source = Rods::DESCRIPTION.source.value();
    let operations = |links: &str| {
        let source = source.replace("16", links);
        let compiled = compile(source.parse().expect("tokens")).expect("a model");
        let program = &compiled.programs.main;
        let constrained = program.constrained.as_ref().expect("constraints");
        [&program.rate, &constrained.multipliers].map(|function| function.cost.total())
    };
    let (short, long) = (operations("16"), operations("32"));
    for (short, long) in short.into_iter().zip(long) {
        assert!(long <= 2 * short + 40, "{short} and {long}");
        assert!(long <= 50 * 32, "{long}");
    }
}
