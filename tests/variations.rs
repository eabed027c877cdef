//! First variations: against independent augmented differentials, closed forms, and differences of runs.

use dalembert::contract::Variational;
use dalembert::law::Law;
use dalembert::numbers::{Numbers, Row};
use dalembert::variations::Dual;
use dalembert::{
    Described, Dop853, Event, Impacting, Observer, Scene, SceneEffects, Simulation, StateVector,
    Stepper, System, Tangent, Taylor, Tolerance, Variations,
};
use dalembert_models::{
    BouncingBall, ChaplyginSleigh, DimensionlessWalker, MovingWallDisk, PointBilliard,
    RollingBallEuler, RollingDisk, TwoWheelsRod, WalkerFootSlip,
};
use dalembert_tests::differences;
use dalembert_tests::reference::{number, numbers, read};
use dalembert_tests::systems::{
    AffineSleigh, DampedSleigh, IntegrableBead, MagneticDisk, Rheonomic, TableWall,
};
use serde_json::Value;

/// The largest error of an entry of an augmented differential, in units of the largest entry.
const TOLERANCE: f64 = 1e-11;

dalembert::model! {
    /// A ball over a floor that swings, whose law loses speed by a parameter.
    pub SwungFloor {
        coordinates { x; }
        parameters { m > 0 = 3/2; g > 0 = 1; e in [0, 1] = 3/4; A = 1/5; w > 0 = 2; }
        lagrangian = m/2*dot(x)^2 - m*g*x;
        impacts { floor: x >= A*sin(w*t) => newton(e^2 + 1/10); }
        initial { x = 1; dot(x) = 0; until = 4; }
    }
}

dalembert::model! {
    /// A point between two lines that bend, by a law of restitution.
    pub Bent {
        coordinates { x; y; }
        parameters { k = 1/2; e in [0, 1] = 4/5; b = 1/3; }
        lagrangian = (dot(x)^2 + (2 + sin(x))*dot(y)^2)/2 - k*x^2*y + y/4;
        impacts {
            low: y + 1 + b*abs(x) >= 0 => restitution(e);
            high: 1 + b*x^2 - y >= 0;
        }
        initial { x = 0.3; y = 0.1; dot(x) = -0.4; dot(y) = 0.9; until = 5; }
    }
}

dalembert::model! {
    /// Two coupled pendula that change places, at rates that depend on time.
    pub Swapped {
        coordinates { a: angle; b: angle; }
        parameters { k > 0 = 1/2; c = 1/2; }
        lagrangian = (dot(a)^2 + 2*dot(b)^2)/2 + k*cos(a - b)*dot(a)*dot(b);
        impacts { step: sin(a + b) <= c => reset { a = b - k; b = a; dot(a) = -dot(b) - t/8; dot(b) = -k*dot(a); }; }
        initial { a = 0.1; b = 0.1; dot(a) = 0.7; dot(b) = 0.3; until = 2; }
    }
}

/// Reads the parameters of a reference file into a system.
fn with_parameters<S: Described>(file: &Value) -> S {
    let mut system = S::with_defaults();
    for (k, info) in S::DESCRIPTION.parameters.iter().enumerate() {
        let name = info.name.trim_end_matches('_');
        if let Some(value) = file["system"]["parameters"].get(name) {
            system.set_parameter(k, number(value));
        }
    }
    system
}

/// Parameters, and a state that changes along a direction.
fn dual<S: Described + Variational>(
    system: &S,
    state: &S::State,
    direction: &S::State,
) -> (S::Parameters<Dual>, S::Row<Dual>) {
    let mut parameters = S::Parameters::<Dual>::zeros(S::Parameters::<Dual>::CAPACITY);
    for (entry, value) in parameters
        .as_mut_slice()
        .iter_mut()
        .zip(system.parameters().as_slice())
    {
        *entry = Dual::of(*value);
    }
    let mut row = S::Row::<Dual>::zeros(S::Row::<Dual>::CAPACITY);
    for (i, entry) in row.as_mut_slice().iter_mut().enumerate() {
        let (value, slope) = (state.as_slice()[i], direction.as_slice()[i]);
        *entry = Dual::new(value, [slope, 0.0, 0.0, 0.0]);
    }
    (parameters, row)
}

/// Positions and velocities of a state, and how they change along a direction.
fn unfolded<S: Described + Variational>(
    system: &S,
    t: f64,
    state: &S::State,
    direction: &S::State,
) -> Vec<f64> {
    let (parameters, row) = dual(system, state, direction);
    let velocities = system
        .velocities(&parameters, Dual::of(t), &row)
        .expect("velocities");
    let n = S::Vector::CAPACITY;
    let q = row.as_slice()[..n].iter();
    q.chain(velocities.as_slice())
        .map(|entry| entry.slopes()[0])
        .collect()
}

/// Directions that span those of the states on the constraints; there is one constraint at most that a state can be off.
fn allowed_directions<S: Described + Variational>(
    system: &S,
    t: f64,
    state: &S::State,
) -> Vec<Tangent<S>> {
    let deviation = |direction: &S::State| -> f64 {
        let (parameters, row) = dual(system, state, direction);
        let deviations = system
            .deviations(&parameters, Dual::of(t), &row)
            .expect("deviations");
        deviations
            .as_slice()
            .first()
            .map_or(0.0, |own| own.slopes()[0])
    };
    let components: Vec<Tangent<S>> = (0..S::State::CAPACITY).map(Tangent::of_component).collect();
    let deviations: Vec<f64> = components.iter().map(|own| deviation(&own.state)).collect();
    let worst = (0..S::State::CAPACITY)
        .max_by(|&i, &j| deviations[i].abs().total_cmp(&deviations[j].abs()));
    let worst = worst.filter(|&i| deviations[i] != 0.0);
    let mut directions = components;
    for (i, direction) in directions.iter_mut().enumerate() {
        if let Some(worst) = worst {
            direction.state.as_mut_slice()[worst] -= deviations[i] / deviations[worst];
        }
    }
    directions
}

/// All augmented differentials of a reference file, in the chart of positions and independent velocities.
fn check_reference<S>(name: &str) -> usize
where
    S: Described + Scene + Variational + Impacting,
{
    let file = read(name);
    let system: S = with_parameters(&file);
    let names = file["system"]["coordinates"]
        .as_array()
        .expect("coordinates");
    let independent = file["system"]["independent_velocities"]
        .as_array()
        .expect("velocities");
    let chart: Vec<usize> = (0..names.len())
        .chain(independent.iter().map(|own| {
            names.len()
                + names
                    .iter()
                    .position(|name| name == own)
                    .expect("a coordinate")
        }))
        .collect();
    let mut seen = 0;
    for impact in file["impacts"].as_array().expect("impacts") {
        let expected = &impact["laws"]["elastic"]["augmented_differential_chart(q,u)"];
        let Some(rows) = expected.as_array() else {
            continue;
        };
        let rows: Vec<Vec<f64>> = rows.iter().map(numbers).collect();
        let t = impact.get("t").map_or(0.0, number);
        let surface = S::DESCRIPTION.surfaces.iter();
        let surface = surface
            .clone()
            .position(|own| own.name == impact["surface"])
            .expect("surface");
        let mut before = S::State::zeros(S::State::CAPACITY);
        let (mut q, mut qdot) = (
            S::Vector::zeros(S::Vector::CAPACITY),
            S::Vector::zeros(S::Vector::CAPACITY),
        );
        q.as_mut_slice().copy_from_slice(&numbers(&impact["q"]));
        qdot.as_mut_slice()
            .copy_from_slice(&numbers(&impact["qdot_minus"]));
        before
            .as_mut_slice()
            .copy_from_slice(system.state(t, &q, &qdot).expect("a state").as_slice());
        let mut after = before;
        let blow = system.blow(surface, t, &before).expect("a blow");
        system.kick(&mut after, blow.size, &blow.direction);
        let event = Event {
            t,
            surface,
            law: Law::Elastic,
            before,
            after,
            simultaneous: false,
            graze: false,
        };
        let mut columns = allowed_directions(&system, t, &before);
        let directions = columns.clone();
        let mut variations = Variations::new(&system, &mut columns);
        let _ = Observer::<S>::event(&mut variations, &event);
        variations.tangents().expect("a derivative");
        let size = rows
            .iter()
            .flatten()
            .fold(0.0, |size: f64, own| size.max(own.abs()));
        for (direction, column) in directions.iter().zip(&columns) {
            let start = unfolded(&system, t, &before, &direction.state);
            let end = unfolded(&system, t, &after, &column.state);
            for (row, &place) in rows.iter().zip(&chart) {
                let parts = row.iter().zip(&chart);
                let wanted: f64 = parts.map(|(entry, &place)| entry * start[place]).sum();
                let error = (end[place] - wanted).abs() / size;
                assert!(
                    error <= TOLERANCE,
                    "{name}, {event:?}: {} for {wanted}",
                    end[place]
                );
            }
        }
        seen += 1;
    }
    seen
}

#[test]
fn augmented_differentials_are_those_of_the_references() {
    let seen = [
        check_reference::<BouncingBall>("bouncing_ball_states"),
        check_reference::<PointBilliard>("point_billiard_states"),
        check_reference::<RollingDisk>("rolling_disk"),
        check_reference::<ChaplyginSleigh>("chaplygin_sleigh"),
        check_reference::<RollingBallEuler>("rolling_ball_euler"),
        check_reference::<TwoWheelsRod>("cv64_two_wheels"),
        check_reference::<MovingWallDisk>("moving_wall_disk"),
        check_reference::<AffineSleigh>("affine_sleigh"),
        check_reference::<TableWall>("table_wall"),
        check_reference::<MagneticDisk>("magnetic_disk"),
        check_reference::<DampedSleigh>("damped_sleigh"),
        check_reference::<IntegrableBead>("integrable_bead"),
        check_reference::<Rheonomic>("rheonomic"),
    ];
    assert_eq!(seen, [3, 3, 6, 6, 3, 6, 6, 8, 4, 6, 3, 4, 4]);
}

/// The end of a run of a scene with these laws.
fn end<S, T>(
    system: &S,
    stepper: T,
    laws: &[(usize, Law)],
    start: &S::State,
    until: f64,
    seen: &mut impl Observer<S>,
) -> (S::State, u64)
where
    S: Described + Scene,
    T: Stepper<S>,
{
    let mut effects = system.effects();
    for &(surface, law) in laws {
        effects.set_law(surface, law);
    }
    let run = Simulation::new(system, stepper, effects)
        .run(0.0, *start, until, seen)
        .expect("a start");
    assert!(
        run.outcome.is_done(),
        "{}: {}",
        S::DESCRIPTION.name,
        run.outcome
    );
    (run.state, run.counters.impacts)
}

/// The state with these positions and, of the velocities, those of the coordinates from `first` on.
fn state<S: Described>(
    system: &S,
    positions: &[f64],
    first: usize,
    velocities: &[f64],
) -> S::State {
    let [mut q, mut qdot, mut named] = [S::Vector::zeros(S::Vector::CAPACITY); 3];
    q.as_mut_slice().copy_from_slice(positions);
    qdot.as_mut_slice()[first..].copy_from_slice(velocities);
    named.as_mut_slice()[first..].fill(1.0);
    let qdot = system
        .complete_velocity(0.0, &q, &qdot, &named)
        .expect("velocities");
    system.state(0.0, &q, &qdot).expect("a state")
}

/// The declared initial state.
fn declared<S: Described>(system: &S) -> S::State {
    let initial = system.initial();
    let qdot = system
        .complete_velocity(0.0, &initial.q, &initial.qdot, &initial.named)
        .expect("velocities");
    system.state(0.0, &initial.q, &qdot).expect("a state")
}

/// Derivatives of a run with respect to its start and all parameters, against differences of runs.
fn check_differences<S>(system: S, start: S::State, laws: &[(usize, Law)], until: f64)
where
    S: Described + Scene + Variational,
{
    let run = |system: &S, start: &S::State, mut seen: &mut dyn Observer<S>| {
        let stepper = Taylor::new(Tolerance::new(1e-15).expect("a tolerance"));
        end(system, stepper, laws, start, until, &mut seen)
    };
    let impacts = differences::check_differences(system, start, S::State::CAPACITY, run);
    assert!(impacts > 0, "{}", S::DESCRIPTION.name);
}

#[test]
fn derivatives_are_limits_of_differences() {
    fn from_declared<S: Described + Scene + Variational>(system: S, until: f64) {
        let start = declared(&system);
        check_differences(system, start, &[], until);
    }
    from_declared(SwungFloor::default(), 4.0);
    from_declared(Bent::default(), 5.0);
    from_declared(Swapped::default(), 2.0);
    from_declared(DimensionlessWalker::default(), 4.0);
    from_declared(WalkerFootSlip::default(), 2.0);
    from_declared(ChaplyginSleigh::default(), 8.0);
    let disk = MovingWallDisk::default();
    let start = state(&disk, &[0.0, 0.0, 0.0, 0.3], 2, &[8.0, 0.5]);
    check_differences(disk, start, &[], 1.2);
    let everything = Rheonomic::default();
    let (q, qdot) = ([1.0, 0.1, 0.3].into(), [1.2, 0.0, 0.4].into());
    let start = everything.state_projected(0.0, &q, &qdot).expect("a state");
    check_differences(everything, start, &[(0, Law::Newton(0.75))], 1.5);
}

#[test]
fn every_law_has_its_derivative() {
    let laws = [
        Law::Elastic,
        Law::Restitution(0.5),
        Law::Newton(0.25),
        Law::NonholonomicPlastic,
    ];
    for law in laws {
        let sleigh = ChaplyginSleigh::default();
        check_differences(sleigh, declared(&sleigh), &[(0, law), (1, law)], 3.0);
    }
}

#[test]
fn any_integrator_may_make_the_run() {
    let system = DimensionlessWalker::default();
    let (start, tolerance) = (
        declared(&system),
        Tolerance::new(1e-13).expect("a tolerance"),
    );
    let tangents = |taylor: bool| {
        let mut columns = [0, 1, 2].map(Tangent::of_component);
        let mut variations = Variations::new(&system, &mut columns);
        match taylor {
            true => end(
                &system,
                Taylor::new(tolerance),
                &[],
                &start,
                4.0,
                &mut variations,
            ),
            false => end(
                &system,
                Dop853::new(tolerance),
                &[],
                &start,
                4.0,
                &mut variations,
            ),
        };
        columns.map(|column| column.state)
    };
    let (one, other) = (tangents(true), tangents(false));
    for (one, other) in one.iter().zip(&other) {
        assert!((one - other).amax() <= 1e-11 * one.amax(), "{one} {other}");
    }
}
