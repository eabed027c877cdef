//! A run allocates nothing, and gives the same bits when repeated. Its memory and stack do not depend on its length.

use dalembert::integrate::Chosen;
use dalembert::{
    Dla4, Dop853, DormandPrince5, Gauss4, Gauss6, Rk4, Scene, Section, Simulation, Stepper, System,
    Taylor, Tolerance,
};
use dalembert_cli::suite::Setting;
use dalembert_cli::{Exit, Integrator, Streams};
use dalembert_models::{ChaplyginSleigh, PointBilliard, RollingDisk};
use dalembert_stability::course::Course;
use dalembert_stability::text::shipped;
use dalembert_tests::allocation::{Counting, allocations, peak};

#[global_allocator]
static ALLOCATOR: Counting = Counting;

fn state_of<S: dalembert::Described>(system: &S) -> S::State {
    let initial = system.initial();
    let qdot = system
        .complete_velocity(0.0, &initial.q, &initial.qdot, &initial.named)
        .expect("velocities");
    system.state(0.0, &initial.q, &qdot).expect("a state")
}

/// The bits of the end of a run, and the number of its allocations.
fn run<S, Step>(system: &S, mut stepper: Step, until: f64) -> (Vec<u64>, u64)
where
    S: dalembert::Described + Scene,
    Step: Stepper<S>,
{
    let state = state_of(system);
    let stepper = Chosen::new(&mut stepper);
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
    // NOTE: at a smaller one, fixed steps of low order are short and many.
    let tolerance = Tolerance::new(1e-6).expect("a tolerance");
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

#[test]
fn a_search_for_an_orbit_allocates_nothing() {
    let table = PointBilliard::default();
    let start = table.state(0.0, &[0.05, 0.0].into(), &[0.02, 1.0].into());
    let (start, tolerance) = (start.expect("a state"), Tolerance::new(1e-14));
    let stepper = Taylor::new(tolerance.expect("a tolerance"));
    let mut section = Section::new(&table, stepper, table.effects(), 0, 100.0).with_returns(2);
    let mut dimension = None;
    let count = allocations(|| {
        let first = section.arrive(&start, &mut []).expect("an arrival");
        let orbit = section.periodic(&first.before, 50);
        dimension = orbit.ok().map(|orbit| orbit.dimension);
    });
    assert_eq!((dimension, count), (Some(3), 0));
}

/// Size of the stack in bytes, which is about half a byte for each step of the run.
const STACK: usize = 512 << 10;

#[test]
fn a_million_steps_need_no_more_stack_than_a_few() {
    let billiard = shipped("point_billiard").model();
    let (q, qdot) = ([0.05, 0.0], [0.02, 1.0]);
    let long = move || {
        let course = Course::new(&billiard, &q, &qdot, 1e3).tol(1e-9).step(1e-3);
        let end = course.run(Setting::free(Integrator::Rk4));
        let counters = end.counters;
        assert!(
            counters.accepted > 1_000_000 && counters.impacts > 100,
            "{counters:?}"
        );
    };
    let thread = std::thread::Builder::new().stack_size(STACK).spawn(long);
    thread.expect("a thread").join().expect("a run");
}

/// Largest number of bytes that a command holds.
fn held(line: &str) -> isize {
    let words: Vec<&str> = line.split_whitespace().collect();
    let mut exit = None;
    let bytes = peak(|| {
        let mut streams = Streams {
            input: &mut std::io::empty(),
            output: &mut std::io::sink(),
            errors: &mut std::io::sink(),
            terminal: false,
        };
        let models = dalembert_command::all();
        exit = Some(dalembert_cli::run_with(&words, &models, &mut streams));
    });
    assert_eq!(exit, Some(Exit::Reached), "{line}");
    bytes
}

/// Memory is kept for the printed rows, but not for steps and impacts.
#[test]
fn a_long_run_of_the_command_line_holds_no_more_than_a_short_one() {
    // The first run also loads the model.
    let [_, short, long] = [10, 10, 2000].map(|until| {
        let bytes = held(&format!(
            "dalembert simulate point_billiard --until {until}"
        ));
        bytes.cast_unsigned()
    });
    assert!(long <= short + 256, "{short} and {long} bytes");
}
