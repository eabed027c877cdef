//! The audit confirms runs with correct impacts, and finds an impact that a run has missed, with every integrator.
#![allow(missing_docs, clippy::unwrap_used, reason = "tests")]

use dalembert::audit::{Audit, Finding};
use dalembert::effects::{Moment, StepView};
use dalembert::integrate::Chosen;
use dalembert::{
    Dla2, Dop853, DormandPrince5, Effect, Event, EventLog, Gauss4, Gauss6, Impacting, Impacts,
    Lagrangian, Law, NoForces, Observer, Outcome, Policies, Rest, Rk4, Simulation, StateVector,
    Stepper, Taylor, TaylorField, Tolerance,
};

dalembert::model! {
    /// Two wheels joined by a rod of variable length.
    pub TwoWheelsRod {
        coordinates { x1; x2; theta1; theta2; }
        parameters { r1 > 0 = 1/2; r2 > 0 = 1; a > 0 = 1; b > 0 = 3; }
        let length = sqrt((r2 - r1)^2 + (x2 - x1)^2);
        lagrangian = 1/2*(dot(x1)^2 + dot(x2)^2 + dot(theta1)^2 + dot(theta2)^2);
        constraints { wheel1: d(x1) - r1*d(theta1) = 0; wheel2: d(x2) - r2*d(theta2) = 0; }
        impacts { rod_max: b - length >= 0; rod_min: length - a >= 0; }
    }
}

dalembert::model! {
    /// The same with a rod that is arrested at its extreme lengths.
    pub TwoWheelsArrested {
        coordinates { x1; x2; theta1; theta2; }
        parameters { r1 > 0 = 1/2; r2 > 0 = 1; a > 0 = 1; b > 0 = 3; }
        let length = sqrt((r2 - r1)^2 + (x2 - x1)^2);
        lagrangian = 1/2*(dot(x1)^2 + dot(x2)^2 + dot(theta1)^2 + dot(theta2)^2);
        constraints { wheel1: d(x1) - r1*d(theta1) = 0; wheel2: d(x2) - r2*d(theta2) = 0; }
        modes { sliding { initial { x2 = 2; } } arrested { constraints { rod: d(x2 - x1) = 0; } } }
        transitions {
            longest: sliding -> arrested when length >= b;
            shortest: sliding -> arrested when length <= a;
        }
    }
}

dalembert::model! {
    /// A point over a bump.
    pub Bump {
        coordinates { x; y; }
        parameters { s > 0 = 0.1; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2;
        impacts { wall: y - exp(-(x/s)^2) >= 0; }
    }
}

dalembert::model! {
    /// A point that falls on a peg.
    pub Peg {
        coordinates { x; y; }
        parameters { r > 0 = 0.5826313654547983; g > 0 = 1; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2 - g*y;
        impacts { peg: sqrt(x^2 + y^2) - r >= 0; }
    }
}

dalembert::model! {
    /// A point among walls that count only in places, and a line that carries it back.
    pub Course {
        coordinates { x; y; }
        parameters { g >= 0 = 1; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2 - g*y;
        impacts {
            ledge: y >= 0 when x <= 1;
            ground: y + 1 >= 0;
            far: 4 - x >= 0 => reset { x = x - 4; };
        }
    }
}

/// A start: positions, velocities and the end.
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
    integrator: &'static str,
    finding: Option<Finding>,
    outcome: Outcome,
    /// Time and surface of the first impact, and the number of impacts.
    first: Option<(f64, usize)>,
    impacts: usize,
}

fn vector<V: StateVector>(components: &[f64]) -> V {
    V::of(components)
}

/// Runs a system with effects, under an audit of its surfaces.
fn audited<Sys: Impacting, E: Effect<Sys>>(
    system: &Sys,
    stepper: &mut impl Stepper<Sys>,
    effects: E,
    Start { q, v, until }: Start<'_>,
) -> Audited {
    let integrator = stepper.name();
    let state = system.state(0.0, &vector(q), &vector(v)).unwrap();
    let mut seen = (Audit::new(system), EventLog::<Sys::State, 1>::new());
    let run = Simulation::new(system, Chosen::new(stepper), effects)
        .run(0.0, state, until, &mut seen)
        .unwrap();
    Audited {
        integrator,
        finding: seen.0.finding(),
        outcome: run.outcome,
        first: seen.1.iter().next().map(|event| (event.t, event.surface)),
        impacts: seen.1.seen(),
    }
}

/// The same with every integrator.
fn with_every_integrator<Sys: Impacting + TaylorField + Lagrangian, E: Effect<Sys>>(
    system: &Sys,
    effects: impl Fn() -> E,
    start: Start<'_>,
) -> Vec<Audited> {
    let tolerance = |tol| Tolerance::new(tol).unwrap();
    macro_rules! runs {
        ($($stepper:expr),+) => { vec![$(audited(system, &mut $stepper, effects(), start)),+] };
    }
    let step = start.until / 512.0;
    runs![
        Dop853::new(tolerance(1e-12)),
        Dop853::new(tolerance(1e-5)),
        DormandPrince5::new(tolerance(1e-8)),
        Taylor::new(tolerance(1e-15)),
        Taylor::new(tolerance(1e-6)),
        Rk4::new(tolerance(1e-9)).with_step(step),
        Gauss4::new(tolerance(1e-9)).with_step(step),
        Gauss6::new(tolerance(1e-9)).with_step(step),
        Dla2::new(tolerance(1e-9)).with_step(step)
    ]
    .into_iter()
    // Discrete principles do not run systems with modes.
    .filter(|run| run.outcome != Outcome::SeveralModes)
    .collect()
}

/// Shows that the first impact is met, that the audit confirms it, and that it finds it in a run without impacts.
fn first_impact_is_audited<Sys: Impacting + TaylorField + Lagrangian>(
    system: &Sys,
    start: Start<'_>,
    (time, surface): (f64, usize),
) {
    for run in with_every_integrator(system, || Impacts::declared(system), start) {
        assert_eq!(run.finding, None, "{run:?}");
        let (t, met) = run.first.unwrap_or_else(|| panic!("{run:?}"));
        assert!((t - time).abs() < 1e-3 && met == surface, "{run:?}");
    }
    for run in with_every_integrator(system, || (), start) {
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
    first_impact_is_audited(&TwoWheelsRod::default(), start, (1.512, 1));
}

#[test]
fn an_arrest_is_not_passed() {
    let start = Start {
        q: &[0.0, 2.0, 0.0, 0.0],
        v: &[0.5, -0.25, 1.0, -0.25],
        until: 1000.0,
    };
    let wheels = TwoWheelsArrested::default();
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
    let wheels = TwoWheelsRod {
        b: 1e7,
        ..TwoWheelsRod::default()
    };
    first_impact_is_audited(&wheels, start, (665.512, 1));
}

#[test]
fn a_narrow_bump_is_not_passed() {
    let start = Start {
        q: &[-1.0, 0.5],
        v: &[1.0, 0.0],
        until: 2.0,
    };
    first_impact_is_audited(&Bump::default(), start, (0.91674, 0));
    let flat = Start {
        q: &[-1.0, 1.5],
        ..start
    };
    for run in with_every_integrator(&Bump::default(), || (), flat) {
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
    first_impact_is_audited(&Peg::default(), start, (5.616, 0));
}

#[test]
fn surfaces_that_do_not_count_and_resets_are_audited_as_what_they_are() {
    let course = Course::default();
    // Over the edge of the ledge, onto the ground, and carried back twice, the second time under the ledge.
    let start = Start {
        q: &[0.0, 1.0],
        v: &[1.0, 0.0],
        until: 5.0,
    };
    for run in with_every_integrator(&course, || Impacts::declared(&course), start) {
        assert_eq!(run.finding, None, "{run:?}");
    }
    // The surface that counts is found: only the reset, on the way through the ledge beyond its edge.
    let beyond = Start {
        q: &[2.0, 0.5],
        v: &[1.0, 0.0],
        until: 2.5,
    };
    let slow = Course { g: 0.1 };
    for run in with_every_integrator(&slow, || (), beyond) {
        match run.finding {
            Some(Finding::MayBeMet { surface: 2, t }) => assert!((t - 2.0).abs() < 1e-6),
            _ => panic!("{run:?}"),
        }
    }
}

#[test]
fn hops_that_accumulate_and_rest_are_confirmed() {
    let course = Course::default();
    let start = Start {
        q: &[0.0, 1.0],
        v: &[0.0, 0.0],
        until: 50.0,
    };
    let policies = Policies {
        rest: Rest::Contact,
        ..Policies::default()
    };
    let effects = || {
        Impacts::declared(&course)
            .with_law(0, Law::Restitution(0.5))
            .with_policies(policies)
    };
    for run in with_every_integrator(&course, effects, start) {
        assert_eq!((run.outcome, run.finding), (Outcome::Done, None), "{run:?}");
        assert!(run.impacts > 10, "{run:?}");
    }
}

/// Records an impact in the middle of every step.
struct Invented;

impl Effect<Peg> for Invented {
    type Forces = NoForces;

    fn propose<Step: Stepper<Peg>>(
        &mut self,
        _: &mut StepView<'_, Peg, Step>,
    ) -> Result<Option<f64>, Outcome> {
        Ok(Some(0.5))
    }

    fn act<O: Observer<Peg>>(
        &mut self,
        _: f64,
        now: &mut Moment<'_, Peg>,
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
    let start = Start {
        q: &[0.0, 2.0],
        v: &[0.0, 0.0],
        until: 1.0,
    };
    for run in with_every_integrator(&Peg::default(), || Invented, start) {
        let is_found = matches!(run.finding, Some(Finding::Misplaced { surface: 0, .. }));
        assert!(is_found, "{run:?}");
    }
}
