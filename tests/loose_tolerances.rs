//! Impacts at loose tolerances have fewer digits, but none is invented and none is missed.
//!
//! The motion of the disk on its table is chaotic. At the tolerance 1e-3 a run soon follows another motion than the
//! exact one, and may have ten times as many impacts. The event search is still right: from the state after each
//! impact of the run, the exact motion must meet the same surface next, at the same time up to the error of one flight.

use core::ops::ControlFlow;

use dalembert::{Event, Impacting, Observer, VectorField};
use dalembert_cli::Integrator;
use dalembert_stability::course::{Course, state};
use dalembert_stability::text::{Model, shipped, value};

type State = <Model as VectorField>::State;

/// The model of the runs.
fn disk() -> Model {
    shipped("rolling_disk").model()
}

/// Allowed error of the times of impacts in seconds, divided by the tolerance. The edges of the disk move at 0.1 to 0.3
/// m/s, the error of a step may be the tolerance in metres, and impacts are oblique.
const LATE: f64 = 30.0;

/// One impact.
#[derive(Debug, Clone, Copy)]
struct Impact {
    t: f64,
    surface: usize,
    after: State,
}

/// Keeps the first `wanted` impacts of a run, and stops the run there.
struct First {
    impacts: Vec<Impact>,
    wanted: usize,
}

impl Observer<Model> for First {
    fn event(&mut self, event: &Event<State>) -> ControlFlow<()> {
        self.impacts.push(Impact {
            t: event.t,
            surface: event.surface,
            after: event.after,
        });
        match self.impacts.len() < self.wanted {
            true => ControlFlow::Continue(()),
            false => ControlFlow::Break(()),
        }
    }
}

fn impacts(
    (integrator, tol): (Integrator, f64),
    state: State,
    (t_end, wanted): (f64, usize),
) -> Vec<Impact> {
    let mut first = First {
        impacts: Vec::new(),
        wanted,
    };
    Course::from_state(&disk(), state, t_end)
        .tol(tol)
        .observed(integrator, &mut first);
    first.impacts
}

/// Integrator and tolerance of the motion with which others are compared.
const EXACT: (Integrator, f64) = (Integrator::Taylor, 1e-13);

/// The disk in the middle of the table, rolling and turning.
fn start(roll: f64) -> State {
    let disk = disk();
    let phi = core::f64::consts::FRAC_PI_2;
    let qdot = [0.0, value(&disk, "R") * roll, roll, 0.2];
    state(&disk, &[0.0, 0.0, 0.0, phi], &qdot)
}

/// Asserts that every flight of a run ends like the exact flight from the same state.
fn assert_flights_are_exact(integrator: Integrator, tol: f64) {
    let name = integrator.name();
    for roll in [10.0, 10.001, 9.7] {
        let run = impacts((integrator, tol), start(roll), (200.0, usize::MAX));
        assert!(run.len() > 100, "{name} at {tol}: {} impacts", run.len());
        for pair in run.windows(2) {
            let [from, to] = [pair[0], pair[1]];
            let flight = to.t - from.t;
            let exact = impacts(EXACT, from.after, (flight + 3.0, 1))
                .first()
                .copied();
            let exact = exact
                .unwrap_or_else(|| panic!("{name} at {tol}: nothing is met after t = {}", from.t));
            assert!(
                exact.surface == to.surface && (exact.t - flight).abs() <= LATE * tol,
                "{name} at {tol}, from t = {}: {flight} to surface {}, exactly {} to {}",
                from.t,
                to.surface,
                exact.t,
                exact.surface
            );
        }
    }
}

#[test]
fn flights_of_taylor_series_are_exact() {
    assert_flights_are_exact(Integrator::Taylor, 1e-3);
    assert_flights_are_exact(Integrator::Taylor, 1e-4);
}

#[test]
fn flights_of_dop853_are_exact() {
    assert_flights_are_exact(Integrator::Dop853, 1e-3);
    assert_flights_are_exact(Integrator::Dop853, 1e-4);
}

/// Allowed error of the gap in a loose run, divided by the tolerance. Gaps are 1 in the middle of the table, whose half
/// axes are 0.15 and 0.2, and the error of a step may be the tolerance in metres. A shallow hit may be late by more
/// than [`LATE`].
const WRONG: f64 = 30.0;

/// Number of moments of a flight that are compared.
const MOMENTS: usize = 64;

/// Asserts that in every flight of a run the exact motion stays inside, up to the tolerance, and ends on the surface of
/// the impact.
fn assert_flights_stay_inside(integrator: Integrator, tol: f64) {
    let (name, disk) = (integrator.name(), disk());
    let wrong = WRONG * tol;
    for roll in [10.0, 10.001, 9.7, 9.86, 10.62] {
        let run = impacts((integrator, tol), start(roll), (200.0, usize::MAX));
        assert!(run.len() > 100, "{name} at {tol}: {} impacts", run.len());
        for pair in run.windows(2) {
            let [from, to] = [pair[0], pair[1]];
            let flight = to.t - from.t;
            let label = format!("{name} at {tol}, roll {roll}, from t = {}", from.t);
            let (mut t, mut state) = (0.0, from.after);
            for moment in 1..=MOMENTS {
                let next = flight * moment as f64 / MOMENTS as f64;
                let (exact, tol) = EXACT;
                let ended = Course::from_state(&disk, state, next)
                    .at(t)
                    .tol(tol)
                    .alone()
                    .observed(exact, &mut ());
                (t, state) = (next, ended.state);
                let gaps = disk.gaps(t, &state);
                let least = gaps.as_ref().iter().copied().fold(f64::INFINITY, f64::min);
                assert!(least >= -wrong, "{label}: {least:e} at {t}");
            }
            let gap = disk.gaps(t, &state).as_ref()[to.surface];
            assert!(gap <= wrong, "{label}: an impact at a gap of {gap:e}");
        }
    }
}

#[test]
fn flights_of_dormand_prince_stay_inside() {
    assert_flights_stay_inside(Integrator::Dopri5, 1e-3);
    assert_flights_stay_inside(Integrator::Dopri5, 1e-4);
}
