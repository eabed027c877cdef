//! The work of small runs, exactly: a change of these numbers is a change of the method.

use dalembert::{
    Counters, Described, Dla2, Dla4, Gauss4, Gauss6, Lagrangian, Rk4, Scene, Simulation, Stepper,
    Tolerance,
};
use dalembert_models::{DoublePendulum, RollingDisk};

fn counters<S: Described + Scene + Lagrangian, Step: Stepper<S>>(
    system: &S,
    stepper: Step,
) -> Counters {
    let initial = system.initial();
    let qdot = system
        .complete_velocity(0.0, &initial.q, &initial.qdot, &initial.named)
        .expect("velocities");
    let state = system.state(0.0, &initial.q, &qdot).expect("a state");
    Simulation::new(system, stepper, system.effects())
        .run(0.0, state, 2.0, &mut ())
        .expect("a start")
        .counters
}

/// Evaluations, accepted and rejected steps, dense constructions, impacts, projections.
fn numbers(counters: Counters) -> [u64; 6] {
    [
        counters.rate_evaluations,
        counters.accepted,
        counters.rejected,
        counters.dense_constructions,
        counters.impacts,
        counters.projections,
    ]
}

/// The numbers of each method at steps of 1/64 over two units of time.
fn work<S: Described + Scene + Lagrangian>(system: &S) -> [[u64; 6]; 5] {
    let tolerance = Tolerance::new(1e-9).expect("a tolerance");
    macro_rules! work {
        ($($method:ident)*) => {
            [$(numbers(counters(system, $method::new(tolerance).with_step(1.0 / 64.0)))),*]
        };
    }
    work!(Rk4 Gauss4 Gauss6 Dla2 Dla4)
}

#[test]
fn work_is_as_counted() {
    // 4 per step and 1 at the start; of Gauss 9.2 and 7.8 iterations per step, of the principle 9.2 and 7.5 of each of its
    // one and five parts.
    assert_eq!(
        work(&DoublePendulum::default()),
        [
            [513, 128, 0, 0, 0, 0],
            [2477, 128, 0, 0, 0, 0],
            [3132, 128, 0, 0, 0, 0],
            [1301, 128, 0, 0, 0, 0],
            [4945, 128, 0, 0, 0, 0],
        ]
    );
    // One impact: a step cut, dense output by 2, 2, 4, 0 and 2 evaluations, one at the restart. In reduced form nothing is
    // projected.
    assert_eq!(
        work(&RollingDisk::default()),
        [
            [520, 129, 0, 1, 1, 0],
            [653, 129, 0, 1, 1, 0],
            [930, 129, 0, 1, 1, 0],
            [790, 129, 0, 1, 1, 0],
            [2871, 129, 0, 1, 1, 0],
        ]
    );
}
