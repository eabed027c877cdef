//! Times of single calls of generated and handwritten functions (rate, energy, impact), of a step, and of an impact in
//! a run.
//!
//! `cargo bench --package dalembert-benches --bench kernels [-- FILTER]`

use core::hint::black_box;
use core::time::Duration;

use criterion::measurement::WallTime;
use criterion::{BenchmarkGroup, Criterion, criterion_group, criterion_main};
use dalembert::integrate::Instant;
use dalembert::{
    Counters, Described, Dop853, DormandPrince5, Effect, Impacts, Outcome, Scene, Simulation,
    Stepper, System, Tolerance,
};
use dalembert_benches::hand::number::numbers;
use dalembert_benches::hand::{
    bead, bouncing_ball, chain, chaplygin_sleigh, double_pendulum, harmonic_oscillator,
    point_billiard, rolling_ball, rolling_disk, two_wheels,
};
use dalembert_benches::{State, generated};
use dalembert_models::chaplygin_sleigh::ChaplyginSleighGlobal as GlobalSleigh;
use dalembert_models::rolling_disk::RollingDiskGlobal as GlobalDisk;
use dalembert_models::{
    BallOnRotatingTable, BouncingBall, Chain4, Chain16, ChaplyginSleigh, DoublePendulum,
    HarmonicOscillator, HolonomicBeadOnEllipses, PointBilliard, RollingBallEuler, RollingDisk,
    TwoWheelsRod,
};
use dalembert_tests::sampling;

/// Number of states at which a kernel is called in turn.
const STATES: usize = 64;

/// Times functions of a state of one system, at the declared parameters.
struct Kernels<'c, S: Described> {
    group: BenchmarkGroup<'c, WallTime>,
    system: S,
    states: [State<S>; STATES],
}

impl<'c, S: Described> Kernels<'c, S> {
    fn new(criterion: &'c mut Criterion, kind: &str) -> Self {
        let system = S::with_defaults();
        let states = sampling::states(&system, STATES, 1);
        Self {
            group: criterion.benchmark_group(format!("{kind}/{}", S::DESCRIPTION.name)),
            system,
            states: states.try_into().expect("as many as asked for"),
        }
    }

    /// Times a function. The system is hidden from the optimiser, so that every call reads the parameters and computes
    /// their quotients.
    fn time<R>(mut self, form: &str, function: impl Fn(&S, &State<S>) -> R) -> Self {
        let mut k = 0;
        self.group.bench_function(form, |bencher| {
            bencher.iter(|| {
                k = (k + 1) % STATES;
                function(black_box(&self.system), &self.states[k])
            });
        });
        self
    }
}

/// Times a generated function of a state and handwritten functions of the components of the same state.
macro_rules! compare {
    ($criterion:ident, $kind:expr, $model:ty, $generated:expr, $($by_hand:path)|+) => {
        Kernels::<$model>::new($criterion, $kind)
            .time("generated", $generated)
            $(.time(stringify!($by_hand), |system, state| $by_hand(system, numbers(state))))+
    };
}

/// Same as `compare`, for the global form of a model that runs in another form.
macro_rules! compare_global {
    ($criterion:ident, $kind:expr, $model:ty, $generated:expr, $($by_hand:path)|+) => {
        Kernels::<$model>::new($criterion, $kind)
            .time("generated", $generated)
            $(.time(stringify!($by_hand), |system, state| $by_hand(&system.0, numbers(state))))+
    };
}

fn rates(criterion: &mut Criterion) {
    const KIND: &str = "rate";
    use generated::rate;
    compare!(criterion, KIND, BouncingBall, rate, bouncing_ball::rate);
    compare!(
        criterion,
        KIND,
        HarmonicOscillator,
        rate,
        harmonic_oscillator::rate
    );
    compare!(criterion, KIND, PointBilliard, rate, point_billiard::rate);
    compare!(criterion, KIND, DoublePendulum, rate, double_pendulum::rate);
    compare!(criterion, KIND, HolonomicBeadOnEllipses, rate, bead::rate);
    compare_global!(
        criterion,
        KIND,
        GlobalDisk,
        rate,
        rolling_disk::rate | rolling_disk::rate_in_closed_form
    );
    compare!(
        criterion,
        REDUCED_RATE,
        RollingDisk,
        rate,
        rolling_disk::reduced_rate
    );
    compare_global!(
        criterion,
        KIND,
        GlobalSleigh,
        rate,
        chaplygin_sleigh::rate | chaplygin_sleigh::rate_in_frame
    );
    compare!(
        criterion,
        REDUCED_RATE,
        ChaplyginSleigh,
        rate,
        chaplygin_sleigh::reduced_rate
    );
    compare!(
        criterion,
        REDUCED_RATE,
        RollingBallEuler,
        rate,
        rolling_ball::rate
    );
    compare!(
        criterion,
        REDUCED_RATE,
        BallOnRotatingTable,
        rate,
        rolling_ball::rate_on_table
    );
    compare!(
        criterion,
        REDUCED_RATE,
        TwoWheelsRod,
        rate,
        two_wheels::rate
    );
    Kernels::<Chain4>::new(criterion, KIND)
        .time("generated", generated::rate)
        .time("by hand", chain::rate)
        .time("by links", chain::rate_by_links);
    Kernels::<Chain16>::new(criterion, KIND)
        .time("generated", generated::rate)
        .time("by hand", chain::rate)
        .time("by links", chain::rate_by_links);
}

/// Rates on D.
const REDUCED_RATE: &str = "reduced rate";

fn energies(criterion: &mut Criterion) {
    const KIND: &str = "energy";
    use generated::energy;
    compare!(
        criterion,
        KIND,
        PointBilliard,
        energy,
        point_billiard::energy
    );
    compare!(
        criterion,
        KIND,
        DoublePendulum,
        energy,
        double_pendulum::energy
    );
    compare_global!(criterion, KIND, GlobalDisk, energy, rolling_disk::energy);
    compare_global!(
        criterion,
        KIND,
        GlobalSleigh,
        energy,
        chaplygin_sleigh::energy
    );
    Kernels::<Chain4>::new(criterion, KIND)
        .time("generated", generated::energy)
        .time("by hand", chain::energy)
        .time("by links", chain::energy_by_links);
    Kernels::<Chain16>::new(criterion, KIND)
        .time("generated", generated::energy)
        .time("by hand", chain::energy)
        .time("by links", chain::energy_by_links);
}

/// Elastic impacts. The surface is hidden from the optimiser, so that the kernels serve any surface.
fn impacts(criterion: &mut Criterion) {
    const KIND: &str = "impact";
    let surface = || black_box(0);
    macro_rules! compare {
        ($kind:expr, $model:ty, $by_hand:expr) => {
            Kernels::<$model>::new(criterion, $kind)
                .time("generated", |system, state| {
                    generated::impact(system, surface(), state)
                })
                .time("by hand", $by_hand)
        };
    }
    compare!(KIND, BouncingBall, |ball, state| {
        bouncing_ball::impact(ball, numbers(state))
    });
    compare!(KIND, PointBilliard, |point, state| {
        point_billiard::impact(point, numbers(state))
    });
    compare!(KIND, HolonomicBeadOnEllipses, |bead, state| {
        bead::impact(bead, numbers(state))
    });
    compare!(KIND, GlobalDisk, |disk, state| {
        rolling_disk::impact(&disk.0, surface(), numbers(state))
    });
    compare!(KIND, GlobalSleigh, |sleigh, state| {
        chaplygin_sleigh::impact(&sleigh.0, surface(), numbers(state))
    });
    const REDUCED: &str = "reduced impact";
    compare!(REDUCED, RollingDisk, |disk, state| {
        rolling_disk::reduced_impact(disk, surface(), numbers(state))
    });
    compare!(REDUCED, ChaplyginSleigh, |sleigh, state| {
        chaplygin_sleigh::reduced_impact(sleigh, surface(), numbers(state))
    });
    compare!(REDUCED, RollingBallEuler, |ball, state| {
        rolling_ball::impact(ball, numbers(state))
    });
    compare!(REDUCED, TwoWheelsRod, |wheels, state| {
        two_wheels::impact(wheels, numbers(state))
    });
}

/// Tolerance of the steps and runs that are timed.
const TOLERANCE: f64 = 1e-9;

fn tolerance() -> Tolerance {
    Tolerance::new(TOLERANCE).expect("a tolerance")
}

/// The declared initial state.
fn start<S: Described>(system: &S) -> State<S> {
    let initial = system.initial();
    let qdot = system.complete_velocity(0.0, &initial.q, &initial.qdot, &initial.named);
    let qdot = qdot.expect("velocities that satisfy the constraints");
    system
        .state(0.0, &initial.q, &qdot)
        .expect("an admissible state")
}

/// Times an accepted step: the mean over smooth runs of ten seconds from the declared initial state, rejected steps
/// included.
fn step<S: Described, Step: Stepper<S>>(
    group: &mut BenchmarkGroup<'_, WallTime>,
    system: &S,
    mut stepper: Step,
) {
    const UNTIL: f64 = 10.0;
    let state = start(system);
    let mut counters = Counters::default();
    let name = format!("{}/{}", S::DESCRIPTION.name, stepper.name());
    group.bench_function(name, |bencher| {
        stepper
            .start(system, Instant::default(), &state, UNTIL, &mut counters)
            .expect("a start");
        bencher.iter(|| {
            if stepper.t_end() >= UNTIL {
                stepper
                    .start(system, Instant::default(), &state, UNTIL, &mut counters)
                    .expect("a start");
            }
            stepper
                .step(black_box(system), UNTIL, &mut counters)
                .expect("a step");
        });
    });
}

fn steps(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("step");
    macro_rules! steps {
        ($($model:ty),*) => {$(
            step(&mut group, &<$model>::default(), Dop853::new(tolerance()));
            step(&mut group, &<$model>::default(), DormandPrince5::new(tolerance()));
        )*};
    }
    steps!(
        RollingDisk,
        ChaplyginSleigh,
        DoublePendulum,
        Chain4,
        Chain16
    );
}

/// Times a run and asserts the number of its impacts.
fn flight<S: System, E: Effect<S> + Clone>(
    group: &mut BenchmarkGroup<'_, WallTime>,
    name: &str,
    system: &S,
    (state, until): (State<S>, f64),
    (effects, impacts): (E, u64),
) {
    let fly = || {
        Simulation::new(black_box(system), Dop853::new(tolerance()), effects.clone())
            .run(0.0, state, until, &mut ())
            .expect("a start")
    };
    let run = fly();
    assert_eq!(
        (run.outcome, run.counters.impacts),
        (Outcome::Done, impacts)
    );
    group.bench_function(name, |bencher| bencher.iter(fly));
}

/// Cost of one impact in a run: the difference between the times of `one impact` and `none`. It includes event
/// location, the impact, the restart and its steps. The table of `none` is so large that there is no impact. The run
/// `not watched` has no effects, and therefore no event search.
fn located(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("flight/point_billiard");
    let point = PointBilliard::default();
    let large = PointBilliard {
        ta: 150.0,
        tb: 100.0,
        ..point
    };
    let way = (start(&point), 1.5);
    flight(
        &mut group,
        "one impact",
        &point,
        way,
        (Impacts::declared(&point), 1),
    );
    flight(
        &mut group,
        "none",
        &large,
        way,
        (Impacts::declared(&large), 0),
    );
    flight(&mut group, "not watched", &point, way, ((), 0));
    group.finish();

    let mut group = criterion.benchmark_group("flight/rolling_disk");
    let disk = RollingDisk::default();
    let large = RollingDisk {
        ta: 15.0,
        tb: 20.0,
        ..disk
    };
    let way = (start(&disk), 2.2);
    flight(&mut group, "one impact", &disk, way, (disk.effects(), 1));
    flight(&mut group, "none", &large, way, (large.effects(), 0));
    flight(&mut group, "not watched", &disk, way, ((), 0));
}

fn configuration() -> Criterion {
    Criterion::default()
        .without_plots()
        .warm_up_time(Duration::from_millis(500))
        .measurement_time(Duration::from_secs(2))
}

criterion_group! {
    name = kernels;
    config = configuration();
    targets = rates, energies, impacts, steps, located
}
criterion_main!(kernels);
