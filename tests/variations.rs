//! First variations, compared with independent differentials of impacts and with differences of runs.

use dalembert::contract::Variational;
use dalembert::law::Law;
use dalembert::math::larger;
use dalembert::numbers::{Numbers, Row};
use dalembert::variations::Dual;
use dalembert::{Described, Event, Impacting, Instance, System, Tangent, TaylorField, VectorField};
use dalembert_cli::Integrator;
use dalembert_stability::course::{
    Course, Driven, declared, is_discrete, state as state_of, vector,
};
use dalembert_stability::text::{Large, Model, Text, shipped};
use dalembert_stability::varied::Varied;
use dalembert_tests::differences;
use dalembert_tests::reference::{number, numbers, read};
use dalembert_tests::systems::{
    AffineSleigh, DampedSleigh, IntegrableBead, MagneticDisk, Rheonomic, TableWall,
};
use serde_json::Value;

type State = <Large as VectorField>::State;

/// Bound on the error of an augmented differential, relative to its largest entry.
const TOLERANCE: f64 = 1e-11;

/// A ball over an oscillating floor whose coefficient of restitution depends on a parameter.
static SWUNG_FLOOR: Text = Text::new(
    "SwungFloor {
        coordinates { x; }
        parameters { m > 0 = 3/2; g > 0 = 1; e in [0, 1] = 3/4; A = 1/5; w > 0 = 2; }
        lagrangian = m/2*dot(x)^2 - m*g*x;
        impacts { floor: x >= A*sin(w*t) => newton(e^2 + 1/10); }
        initial { x = 1; dot(x) = 0; until = 4; }
    }",
);

/// A point between two bent walls, one with restitution.
static BENT: Text = Text::new(
    "Bent {
        coordinates { x; y; }
        parameters { k = 1/2; e in [0, 1] = 4/5; b = 1/3; }
        lagrangian = (dot(x)^2 + (2 + sin(x))*dot(y)^2)/2 - k*x^2*y + y/4;
        impacts {
            low: y + 1 + b*abs(x) >= 0 => restitution(e);
            high: 1 + b*x^2 - y >= 0;
        }
        initial { x = 0.3; y = 0.1; dot(x) = -0.4; dot(y) = 0.9; until = 5; }
    }",
);

/// Two coupled pendula that change places. Their velocities after the reset depend on time.
static SWAPPED: Text = Text::new(
    "Swapped {
        coordinates { a: angle; b: angle; }
        parameters { k > 0 = 1/2; c = 1/2; }
        lagrangian = (dot(a)^2 + 2*dot(b)^2)/2 + k*cos(a - b)*dot(a)*dot(b);
        impacts { step: sin(a + b) <= c => reset { a = b - k; b = a; dot(a) = -dot(b) - t/8; dot(b) = -k*dot(a); }; }
        initial { a = 0.1; b = 0.1; dot(a) = 0.7; dot(b) = 0.3; until = 2; }
    }",
);

/// A point that meets a round peg and leaves it after every impulse. After a plastic one it leaves along the tangent.
static GLANCE: Text = Text::new(
    "Glance {
        coordinates { x; y; }
        parameters { r > 0 = 1; k = 1/2; }
        lagrangian = (dot(x)^2 + 2*dot(y)^2)/2 + k*x*dot(x)*dot(y)/3;
        impacts { peg: x^2 + y^2 >= r^2; }
    }",
);

/// Reads the parameters of a reference file into a system.
fn with_parameters(text: &Text, file: &Value) -> Large {
    let mut system: Large = text.sized();
    for (k, info) in text.description().parameters.iter().enumerate() {
        let name = info.name.trim_end_matches('_');
        if let Some(value) = file["system"]["parameters"].get(name) {
            system.set_parameter(k, number(value));
        }
    }
    system
}

type Duals = (
    <Large as TaylorField>::Parameters<Dual>,
    <Large as TaylorField>::Row<Dual>,
);

/// Parameters, and a state with derivatives along a direction, as dual numbers.
fn dual(system: &Large, state: &State, direction: &State) -> Duals {
    let values = system.parameters();
    let mut parameters = Row::zeros(values.as_ref().len());
    let entries = Row::<Dual>::as_mut_slice(&mut parameters).iter_mut();
    for (entry, value) in entries.zip(values.as_ref()) {
        *entry = Dual::of(*value);
    }
    let mut row = Row::zeros(system.state_len());
    for (i, entry) in Row::<Dual>::as_mut_slice(&mut row).iter_mut().enumerate() {
        let (value, slope) = (state.as_ref()[i], direction.as_ref()[i]);
        *entry = Dual::new(value, [slope, 0.0, 0.0, 0.0]);
    }
    (parameters, row)
}

/// Derivatives of positions and velocities along a direction of the state.
fn unfolded(system: &Large, t: f64, state: &State, direction: &State) -> Vec<f64> {
    let (parameters, row) = dual(system, state, direction);
    let velocities = system
        .velocities(&parameters, Dual::of(t), &row)
        .expect("velocities");
    let n = system.coordinate_count();
    let q = row.as_ref()[..n].iter();
    q.chain(velocities.as_ref())
        .map(|entry| entry.slopes()[0])
        .collect()
}

/// Directions that span the states on the constraints, for systems whose states can violate at most one constraint.
fn allowed_directions(system: &Large, t: f64, state: &State) -> Vec<Tangent<Large>> {
    let deviation = |direction: &State| -> f64 {
        let (parameters, row) = dual(system, state, direction);
        let deviations = system
            .deviations(&parameters, Dual::of(t), &row)
            .expect("deviations");
        let deviations = Row::<Dual>::as_slice(&deviations);
        deviations.first().map_or(0.0, |first| first.slopes()[0])
    };
    let length = system.state_len();
    let components: Vec<Tangent<Large>> = (0..length).map(Tangent::of_component).collect();
    let deviations: Vec<f64> = components
        .iter()
        .map(|component| deviation(&component.state))
        .collect();
    let worst = (0..length).max_by(|&i, &j| deviations[i].abs().total_cmp(&deviations[j].abs()));
    let worst = worst.filter(|&i| deviations[i] != 0.0);
    let mut directions = components;
    for (i, direction) in directions.iter_mut().enumerate() {
        if let Some(worst) = worst {
            direction.state.as_mut()[worst] -= deviations[i] / deviations[worst];
        }
    }
    directions
}

/// Compares the augmented differentials of a reference file in the chart of positions and independent velocities.
/// Returns their number.
fn check_reference(text: &Text, name: &str) -> usize {
    let file = read(name);
    let system = with_parameters(text, &file);
    let names = file["system"]["coordinates"]
        .as_array()
        .expect("coordinates");
    let independent = file["system"]["independent_velocities"]
        .as_array()
        .expect("velocities");
    let chart: Vec<usize> = (0..names.len())
        .chain(independent.iter().map(|velocity| {
            names.len()
                + names
                    .iter()
                    .position(|name| name == velocity)
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
        let surface = system.description().surfaces.iter();
        let surface = surface
            .clone()
            .position(|surface| surface.name == impact["surface"])
            .expect("surface");
        let (q, qdot) = (
            vector(&numbers(&impact["q"])),
            vector(&numbers(&impact["qdot_minus"])),
        );
        let before = system.state(t, &q, &qdot).expect("a state");
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
        system.cross(&event, &mut columns).expect("a derivative");
        let size = rows
            .iter()
            .flatten()
            .fold(0.0, |size: f64, value| larger(size, value.abs()));
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
        check_reference(shipped("bouncing_ball"), "bouncing_ball_states"),
        check_reference(shipped("point_billiard"), "point_billiard_states"),
        check_reference(shipped("rolling_disk"), "rolling_disk"),
        check_reference(shipped("chaplygin_sleigh"), "chaplygin_sleigh"),
        check_reference(shipped("rolling_ball_euler"), "rolling_ball_euler"),
        check_reference(shipped("two_wheels_rod"), "cv64_two_wheels"),
        check_reference(shipped("moving_wall_disk"), "moving_wall_disk"),
        check_reference(
            &Text::new(AffineSleigh::DESCRIPTION.source.value()),
            "affine_sleigh",
        ),
        check_reference(
            &Text::new(TableWall::DESCRIPTION.source.value()),
            "table_wall",
        ),
        check_reference(
            &Text::new(MagneticDisk::DESCRIPTION.source.value()),
            "magnetic_disk",
        ),
        check_reference(
            &Text::new(DampedSleigh::DESCRIPTION.source.value()),
            "damped_sleigh",
        ),
        check_reference(
            &Text::new(IntegrableBead::DESCRIPTION.source.value()),
            "integrable_bead",
        ),
        check_reference(
            &Text::new(Rheonomic::DESCRIPTION.source.value()),
            "rheonomic",
        ),
    ];
    assert_eq!(seen, [3, 3, 6, 6, 3, 6, 6, 8, 4, 6, 3, 4, 4]);
}

/// A run with these laws.
fn course<'a, M: Driven>(
    system: &'a M,
    start: M::State,
    laws: &[(usize, Law)],
    until: f64,
) -> Course<'a, M> {
    let course = Course::from_state(system, start, until).tol(1e-15);
    let with = |course: Course<'a, M>, &(surface, law): &_| course.law(surface, law);
    laws.iter().fold(course, with)
}

/// Compares derivatives of a run with respect to its start and all parameters with differences of runs.
fn check_differences<M: Varied>(system: &M, start: M::State, laws: &[(usize, Law)], until: f64) {
    let length = system.state_len();
    let impacts = differences::check_differences(system, start, length, |system, start| {
        course(system, start, laws, until)
    });
    assert!(impacts > 0, "{}", system.description().name);
}

#[test]
fn derivatives_are_limits_of_differences() {
    fn from_declared(text: &Text, until: f64) {
        let system = text.model();
        check_differences(&system, declared(&system), &[], until);
    }
    from_declared(&SWUNG_FLOOR, 4.0);
    from_declared(&BENT, 5.0);
    from_declared(&SWAPPED, 2.0);
    from_declared(shipped("dimensionless_walker"), 4.0);
    from_declared(shipped("walker_foot_slip"), 2.0);
    from_declared(shipped("chaplygin_sleigh"), 8.0);
    let disk = shipped("moving_wall_disk").model();
    let (q, qdot) = (vector(&[0.0, 0.0, 0.0, 0.3]), vector(&[0.0, 0.0, 8.0, 0.5]));
    let named = vector(&[0.0, 0.0, 1.0, 1.0]);
    let qdot = disk.complete_velocity(0.0, &q, &qdot, &named);
    let start = state_of(&disk, q.as_ref(), qdot.expect("velocities").as_ref());
    check_differences(&disk, start, &[], 1.2);
    let everything = Text::new(Rheonomic::DESCRIPTION.source.value()).model();
    let (q, qdot) = (vector(&[1.0, 0.1, 0.3]), vector(&[1.2, 0.0, 0.4]));
    let start = everything.state_projected(0.0, &q, &qdot).expect("a state");
    check_differences(&everything, start, &[(0, Law::Newton(0.75))], 1.5);
}

/// The laws that are impulses. `derivatives_are_limits_of_differences` checks declared resets, and nothing follows
/// a stop.
#[test]
fn every_law_has_its_derivative() {
    let laws = [
        Law::Elastic,
        Law::Restitution(0.5),
        Law::Newton(0.25),
        Law::NonholonomicPlastic,
        Law::ImpactPlastic,
        Law::TotallyPlastic,
    ];
    let names = laws.iter().map(Law::name).chain(["reset", "stop"]);
    let known = Law::NAMES.map(|(name, _)| name);
    assert_eq!(names.collect::<Vec<_>>(), known);
    for law in laws {
        let point = GLANCE.model();
        let start = state_of(&point, &[-2.0, 0.4], &[0.9, 0.1]);
        check_differences(&point, start, &[(0, law)], 3.0);
    }
    // After a plastic impact, the sleigh would stay at the edge of the table or still press against it.
    for &law in &laws[..4] {
        let sleigh = shipped("chaplygin_sleigh").model();
        check_differences(&sleigh, declared(&sleigh), &[(0, law), (1, law)], 3.0);
    }
}

/// Derivatives of the end of a run with respect to the components of its start.
fn tangents(
    system: &Model,
    until: f64,
    (integrator, step): (Integrator, Option<f64>),
) -> Vec<Tangent<Model>> {
    let components = 0..system.state_len();
    let mut columns: Vec<Tangent<Model>> = components.map(Tangent::of_component).collect();
    let mut course = course(system, declared(system), &[], until).tol(1e-13);
    if let Some(step) = step {
        course = course.step(step);
    }
    let (run, derived) = course.vary(integrator, &mut columns);
    assert!(run.outcome.is_done(), "{integrator:?}: {}", run.outcome);
    assert!(run.counters.impacts > 0, "{integrator:?}");
    derived.expect("derivatives");
    columns
}

#[test]
fn any_integrator_may_make_the_run() {
    let (walker, bent) = (shipped("dimensionless_walker").model(), BENT.model());
    for &integrator in Integrator::every() {
        // The walker is a first-order system, to which the discrete principle does not apply.
        let (system, until) = match is_discrete(integrator) {
            true => (&bent, 2.0),
            false => (&walker, 4.0),
        };
        // The bounds allow for the errors of the states of the run.
        let (step, bound) = match integrator {
            Integrator::Dla2 => (Some(1.0 / 512.0), 1e-4),
            Integrator::Rk4 | Integrator::Gauss4 | Integrator::Dla4 => (Some(1.0 / 128.0), 1e-8),
            Integrator::Gauss6 => (Some(1.0 / 128.0), 1e-10),
            Integrator::Dop853 | Integrator::Dopri5 | Integrator::Taylor => (None, 1e-11),
        };
        let known = match integrator {
            Integrator::Taylor => Integrator::Dop853,
            _ => Integrator::Taylor,
        };
        let (one, other) = (
            tangents(system, until, (integrator, step)),
            tangents(system, until, (known, None)),
        );
        for (one, other) in one.iter().zip(&other) {
            let (one, other) = (one.state.as_ref(), other.state.as_ref());
            let size = other
                .iter()
                .fold(0.0, |size: f64, value| larger(size, value.abs()));
            for (a, b) in one.iter().zip(other) {
                assert!(
                    (a - b).abs() <= bound * size,
                    "{integrator:?}: {one:?} {other:?}"
                );
            }
        }
    }
}
