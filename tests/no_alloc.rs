//! A run allocates nothing, and the same run gives the same bits twice.

use dalembert::{
    Dla4, Dop853, DormandPrince5, Gauss4, Gauss6, Rk4, Scene, Simulation, Stepper, Taylor,
    Tolerance,
};
use dalembert_models::{ChaplyginSleigh, RollingDisk};
use dalembert_tests::allocation::{Counting, allocations};

#[global_allocator]
static ALLOCATOR: Counting = Counting;

fn state_of<S: dalembert::Described>(system: &S) -> S::State {
    let initial = system.initial();
    let qdot = system
        .complete_velocity(0.0, &initial.q, &initial.qdot, &initial.named)
        .expect("velocities");
    system.state(0.0, &initial.q, &qdot).expect("a state")
}

/// The bits of a run's end, and the allocations it made.
fn run<S, Step>(system: &S, stepper: Step, until: f64) -> (Vec<u64>, u64)
where
    S: dalembert::Described + Scene,
    Step: Stepper<S>,
{
    let state = state_of(system);
    let mut simulation = Simulation::new(system, stepper, system.effects());
    let mut end = None;
    let count = allocations(|| end = simulation.run(0.0, state, until, &mut ()).ok());
    let end = end.expect("a start");
    assert!(end.counters.impacts > 3, "{:?}", end.counters);
    let numbers = dalembert::StateVector::as_slice(&end.state)
        .iter()
        .chain([&end.t]);
    (numbers.map(|number| number.to_bits()).collect(), count)
}

#[test]
fn the_counter_counts() {
    assert!(allocations(|| drop(std::hint::black_box(vec![1_u8; 64]))) >= 1);
}

#[test]
fn a_run_with_impacts_and_projection_allocates_nothing_and_repeats_to_the_bit() {
    let tolerance = Tolerance::new(1e-10).expect("a tolerance");
    let disk = RollingDisk::default();
    let sleigh = ChaplyginSleigh::default();
    let runs = || {
        macro_rules! runs {
            ($($method:ident)*) => {
                [$(run(&disk, $method::new(tolerance), 50.0), run(&sleigh, $method::new(tolerance), 50.0)),*]
            };
        }
        runs!(Dop853 DormandPrince5 Taylor Rk4 Gauss4 Gauss6 Dla4)
    };
    let (first, second) = (runs(), runs());
    assert!(first.iter().all(|(_, count)| *count == 0), "{first:?}");
    assert_eq!(first, second);
}
