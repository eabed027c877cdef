//! Symmetric methods on reversible systems: with reversed velocities a run returns along its path.

use dalembert::integrate::Chosen;
use dalembert::math::larger;
use dalembert::{
    Dla2, Dla4, Gauss4, Gauss6, Instance, Outcome, Rk4, Simulation, StateVector, Stepper, System,
    Tolerance, VectorField,
};
use dalembert_stability::text::Large;
use dalembert_tests::sampling::{states, system};

type State = <Large as VectorField>::State;

/// Distance from the start after a run of 4 units of time and back.
fn miss(system: &Large, state: State, stepper: impl Stepper<Large> + Copy) -> f64 {
    let run = |state: State| {
        let mut stepper = stepper;
        let end =
            Simulation::new(system, Chosen::new(&mut stepper), ()).run(0.0, state, 4.0, &mut ());
        let end = end.expect("a start");
        // A divided step may be divided differently on the way back.
        assert_eq!((end.outcome, end.counters.rejected), (Outcome::Done, 0));
        end.state
    };
    let reversed = |state: &State| {
        let mut qdot = system.velocity(0.0, state).expect("a velocity");
        qdot.as_mut_slice().iter_mut().for_each(|v| *v = -*v);
        let state = system.state_unchecked(0.0, &system.position(state), &qdot);
        state.expect("a state")
    };
    let back = reversed(&run(reversed(&run(state))));
    let pairs = back.as_slice().iter().zip(state.as_slice());
    pairs.fold(0.0, |worst: f64, (a, b)| larger(worst, (a - b).abs()))
}

fn check(system: &Large) {
    let tolerance = Tolerance::new(1e-9).expect("a tolerance");
    let state = states(system, 1, 5)[0];
    macro_rules! miss {
        ($($method:ident)*) => { [$(miss(system, state, $method::new(tolerance).with_step(0.02))),*] };
    }
    let symmetric = miss!(Gauss4 Gauss6 Dla2 Dla4);
    let name = system.description().name;
    println!("{name}: {symmetric:?}, rk4 {:.1e}", miss!(Rk4)[0]);
    assert!(
        symmetric.iter().all(|&miss| miss < 1e-11),
        "{name}: {symmetric:?}"
    );
}

#[test]
fn symmetric_methods_run_back_along_their_way() {
    for name in [
        "double_pendulum",
        "chaplygin_sleigh",
        "integrable_bead",
        "nonholonomic_particle",
        "curved_dual",
        "mixed_disk",
    ] {
        check(&system(name));
    }
}
