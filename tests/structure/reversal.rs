//! Reversible systems under symmetric methods: with velocities reversed they run back along their way.

use dalembert::{
    Described, Dla2, Dla4, Gauss4, Gauss6, Lagrangian, Outcome, Rk4, Simulation, StateVector,
    Stepper, Tolerance,
};
use dalembert_models::{ChaplyginSleigh, DoublePendulum};
use dalembert_tests::sampling::states;
use dalembert_tests::systems::{CurvedDual, IntegrableBead, MixedDisk, NonholonomicParticle};

/// How far the way back misses the start after 4 units of time.
fn miss<S: Described + Lagrangian, Step: Stepper<S> + Copy>(
    system: &S,
    state: S::State,
    stepper: Step,
) -> f64 {
    let run = |state: S::State| {
        let end = Simulation::new(system, stepper, ()).run(0.0, state, 4.0, &mut ());
        let end = end.expect("a start");
        // Where a step is made in parts, the way back may be made in others.
        assert_eq!((end.outcome, end.counters.rejected), (Outcome::Done, 0));
        end.state
    };
    let reversed = |state: &S::State| {
        let mut qdot = system.velocity(0.0, state).expect("a velocity");
        qdot.as_mut_slice().iter_mut().for_each(|v| *v = -*v);
        let state = system.state_unchecked(0.0, &system.position(state), &qdot);
        state.expect("a state")
    };
    let back = reversed(&run(reversed(&run(state))));
    let pairs = back.as_slice().iter().zip(state.as_slice());
    pairs.fold(0.0, |worst: f64, (a, b)| worst.max((a - b).abs()))
}

fn check<S: Described + Lagrangian>(system: &S) {
    let tolerance = Tolerance::new(1e-9).expect("a tolerance");
    let state = states(system, 1, 5)[0];
    macro_rules! miss {
        ($($method:ident)*) => { [$(miss(system, state, $method::new(tolerance).with_step(0.02))),*] };
    }
    let symmetric = miss!(Gauss4 Gauss6 Dla2 Dla4);
    let name = S::DESCRIPTION.name;
    println!("{name}: {symmetric:?}, rk4 {:.1e}", miss!(Rk4)[0]);
    assert!(
        symmetric.iter().all(|&miss| miss < 1e-11),
        "{name}: {symmetric:?}"
    );
}

#[test]
fn symmetric_methods_run_back_along_their_way() {
    check(&DoublePendulum::default());
    check(&ChaplyginSleigh::default());
    check(&IntegrableBead::default());
    check(&NonholonomicParticle::default());
    check(&CurvedDual::default());
    check(&MixedDisk::default());
}
