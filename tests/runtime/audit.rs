//! The audit confirms runs with correct impacts and finds impacts that a run missed, with every integrator.
#![allow(missing_docs, clippy::unwrap_used, reason = "tests")]

use dalembert::audit::{Audit, Finding};
use dalembert::effects::{Moment, StepView};
use dalembert::integrate::Chosen;
use dalembert::{
    Dop853, Effect, Event, EventLog, Gauss6, Law, NoForces, Observer, Outcome, Policies, Rest,
    Simulation, Stepper, System, Taylor, Tolerance, VectorField,
};
use dalembert_cli::Integrator;
use dalembert_stability::course::{Course, vector};
use dalembert_stability::text::{Model, Text, shipped};

type State = <Model as VectorField>::State;

/// A point over a bump.
static BUMP: Text = Text::new(
    "Bump {
        coordinates { x; y; }
        parameters { s > 0 = 0.1; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2;
        impacts { wall: y - exp(-(x/s)^2) >= 0; }
    }",
);

/// A point that falls on a peg.
static PEG: Text = Text::new(
    "Peg {
        coordinates { x; y; }
        parameters { r > 0 = 0.5826313654547983; g > 0 = 1; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2 - g*y;
        impacts { peg: sqrt(x^2 + y^2) - r >= 0; }
    }",
);

/// A point over a ledge that counts only for `x <= 1`, and over the ground. A reset at `x = 4` moves it back by 4.
static COURSE: Text = Text::new(
    "Course {
        coordinates { x; y; }
        parameters { g >= 0 = 1; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2 - g*y;
        impacts {
            ledge: y >= 0 when x <= 1;
            ground: y + 1 >= 0;
            far: 4 - x >= 0 => reset { x = x - 4; };
        }
    }",
);

/// Positions and velocities at the start, and the end time.
#[derive(Clone, Copy)]
struct Start<'a> {
    q: &'a [f64],
    v: &'a [f64],
    until: f64,
}

/// A run with the result of its audit.
#[derive(Debug)]
#[allow(dead_code, reason = "printed where a test fails")]
struct Audited {
    integrator: Integrator,
    tol: f64,
    finding: Option<Finding>,
    outcome: Outcome,
    /// Time and surface of the first impact, and the number of impacts.
    first: Option<(f64, usize)>,
    impacts: usize,
}

/// The same run with every integrator, each with an audit of its impacts.
fn with_every_integrator(
    model: &Model,
    Start { q, v, until }: Start<'_>,
    set: impl for<'a> Fn(Course<'a, Model>) -> Course<'a, Model>,
) -> Vec<Audited> {
    let settings = Integrator::every().iter().flat_map(|&integrator| {
        let tolerances: &[f64] = match integrator {
            Integrator::Dop853 => &[1e-12, 1e-5],
            Integrator::Dopri5 => &[1e-8],
            Integrator::Taylor => &[1e-15, 1e-6],
            _ => &[1e-9],
        };
        tolerances.iter().map(move |&tol| (integrator, tol))
    });
    let run = |(integrator, tol): (Integrator, f64)| {
        let course = set(Course::new(model, q, v, until).tol(tol));
        let course = match integrator.is_adaptive() {
            true => course,
            false => course.step(until / 512.0),
        };
        let mut seen = (Audit::new(model), EventLog::<State, 1>::new());
        let run = course.observed(integrator, &mut seen);
        Audited {
            integrator,
            tol,
            finding: seen.0.finding(),
            outcome: run.outcome,
            first: seen.1.iter().next().map(|event| (event.t, event.surface)),
            impacts: seen.1.seen(),
        }
    };
    let runs = settings.map(run);
    // Integrators of the discrete principle do not run systems with modes.
    runs.filter(|run| run.outcome != Outcome::SeveralModes)
        .collect()
}

/// Asserts that every integrator finds the first impact, that the audit confirms the run, and that the audit finds the
/// impact in a run without impacts.
fn first_impact_is_audited(model: &Model, start: Start<'_>, (time, surface): (f64, usize)) {
    for run in with_every_integrator(model, start, |course| course) {
        assert_eq!(run.finding, None, "{run:?}");
        let (t, met) = run.first.unwrap_or_else(|| panic!("{run:?}"));
        assert!((t - time).abs() < 1e-3 && met == surface, "{run:?}");
    }
    for run in with_every_integrator(model, start, |course| course.alone()) {
        assert_eq!((run.outcome, run.impacts), (Outcome::Done, 0), "{run:?}");
        match run.finding {
            Some(Finding::MayBeMet { surface: met, t }) => {
                assert!((t - time).abs() < 1e-3 && met == surface, "{run:?}");
            }
            _ => panic!("{run:?}"),
        }
    }
}

#[test]
fn the_shortest_rod_is_not_passed() {
    let start = Start {
        q: &[0.0, 2.0, 0.0, 0.0],
        v: &[0.5, -0.25, 1.0, -0.25],
        until: 500.0,
    };
    first_impact_is_audited(&shipped("two_wheels_rod").model(), start, (1.512, 1));
}

#[test]
fn an_arrest_is_not_passed() {
    let start = Start {
        q: &[0.0, 2.0, 0.0, 0.0],
        v: &[0.5, -0.25, 1.0, -0.25],
        until: 1000.0,
    };
    let wheels = shipped("two_wheels_arrested").model();
    let shortest = 1;
    first_impact_is_audited(&wheels, start, (1.512, shortest));
}

#[test]
fn an_impact_after_a_long_flight_is_not_passed() {
    let start = Start {
        q: &[0.0, 500.0, 0.0, 0.0],
        v: &[0.5, -0.25, 1.0, -0.25],
        until: 2000.0,
    };
    let wheels = shipped("two_wheels_rod").with([("b", 1e7)]);
    first_impact_is_audited(&wheels, start, (665.512, 1));
}

#[test]
fn a_narrow_bump_is_not_passed() {
    let start = Start {
        q: &[-1.0, 0.5],
        v: &[1.0, 0.0],
        until: 2.0,
    };
    first_impact_is_audited(&BUMP.model(), start, (0.91674, 0));
    let flat = Start {
        q: &[-1.0, 1.5],
        ..start
    };
    for run in with_every_integrator(&BUMP.model(), flat, |course| course.alone()) {
        assert_eq!(run.finding, None, "{run:?}");
    }
}

#[test]
fn a_peg_is_not_passed() {
    let start = Start {
        q: &[0.31066917005121814, 16.26406912456683],
        v: &[0.0, 0.0],
        until: 7.7,
    };
    first_impact_is_audited(&PEG.model(), start, (5.616, 0));
}

#[test]
fn surfaces_that_do_not_count_and_resets_are_audited_as_what_they_are() {
    let course = COURSE.model();
    // The point passes the height of the ledge beyond its edge, bounces off the ground and is moved back once, above
    // the ledge.
    let start = Start {
        q: &[0.0, 1.0],
        v: &[1.0, 0.0],
        until: 5.0,
    };
    for run in with_every_integrator(&course, start, |course| course) {
        assert_eq!(run.finding, None, "{run:?}");
        assert_eq!((run.outcome, run.impacts), (Outcome::Done, 2), "{run:?}");
        let (t, met) = run.first.unwrap_or_else(|| panic!("{run:?}"));
        assert!((t - 2.0).abs() < 1e-3 && met == 1, "{run:?}");
    }
    // The point starts beyond the edge of the ledge and falls below the height of the ledge at the time 1.77. The whole
    // flight is above the ground. The audit finds only the reset.
    let beyond = Start {
        q: &[2.0, 0.5],
        v: &[1.0, 0.0],
        until: 2.5,
    };
    let slow = COURSE.with([("g", 0.32)]);
    for run in with_every_integrator(&slow, beyond, |course| course.alone()) {
        match run.finding {
            Some(Finding::MayBeMet { surface: 2, t }) => assert!((t - 2.0).abs() < 1e-6),
            _ => panic!("{run:?}"),
        }
    }
}

#[test]
fn hops_that_accumulate_and_rest_are_confirmed() {
    let course = COURSE.model();
    let start = Start {
        q: &[0.0, 1.0],
        v: &[0.0, 0.0],
        until: 50.0,
    };
    fn set(run: Course<'_, Model>) -> Course<'_, Model> {
        let policies = Policies {
            rest: Rest::Contact,
            ..Policies::default()
        };
        run.law(0, Law::Restitution(0.5)).policies(policies)
    }
    for run in with_every_integrator(&course, start, set) {
        assert_eq!((run.outcome, run.finding), (Outcome::Done, None), "{run:?}");
        assert!(run.impacts > 10, "{run:?}");
    }
}

/// Records an impact in the middle of every step.
struct Invented;

impl Effect<Model> for Invented {
    type Forces = NoForces;

    fn propose<Step: Stepper<Model>>(
        &mut self,
        _: &mut StepView<'_, Model, Step>,
    ) -> Result<Option<f64>, Outcome> {
        Ok(Some(0.5))
    }

    fn act<O: Observer<Model>>(
        &mut self,
        _: f64,
        now: &mut Moment<'_, Model>,
        observer: &mut O,
    ) -> Result<(), Outcome> {
        let _ = observer.event(&Event {
            t: now.t,
            surface: 0,
            law: Law::Elastic,
            before: *now.state,
            after: *now.state,
            simultaneous: false,
            graze: false,
        });
        Err(Outcome::Stopped)
    }
}

#[test]
fn an_impact_away_from_its_surface_is_found() {
    fn finding(stepper: &mut impl Stepper<Model>) -> Option<Finding> {
        let peg = PEG.model();
        let [q, v] = [[0.0, 2.0], [0.0, 0.0]].map(|pair| vector(&pair));
        let state = peg.state(0.0, &q, &v).unwrap();
        let mut audit = Audit::new(&peg);
        Simulation::new(&peg, Chosen::new(stepper), Invented)
            .run(0.0, state, 1.0, &mut audit)
            .unwrap();
        audit.finding()
    }
    let tolerance = Tolerance::new(1e-9).unwrap();
    let findings = [
        finding(&mut Taylor::new(tolerance)),
        finding(&mut Dop853::new(tolerance)),
        finding(&mut Gauss6::new(tolerance).with_step(1.0 / 512.0)),
    ];
    for finding in findings {
        let is_found = matches!(finding, Some(Finding::Misplaced { surface: 0, .. }));
        assert!(is_found, "{finding:?}");
    }
}
