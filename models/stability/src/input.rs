//! Section H: bad input at run time.

use core::ops::ControlFlow;
use std::panic::{AssertUnwindSafe, catch_unwind};

use dalembert::integrate::Chosen;
use dalembert::{
    Dop853, Event, EventLog, Instance, Observer, Outcome, Run as Ran, Scene, Segment, Simulation,
    StartError, StateError, StateVector, System, Tolerance, VectorField,
};
use dalembert_cli::suite::{Case, Report, Run, Setting};

use super::course::{Course, vector};
use super::ensembles;
use super::location::FALL;
use super::text::{Model, shipped};

/// The cases of this section.
pub const CASES: &[Case] = &[
    Case {
        id: "H01",
        title: "states and times that are not finite",
        right: "refused before a run, or `non_finite` in its first step",
        bound: "the error of its kind",
        run: Run::Once(not_finite),
        ..Case::QUICK
    },
    Case {
        id: "H02",
        title: "parameters that are not finite, or contradict their declarations",
        right: "refused, with the parameter named",
        bound: "the error of its kind",
        run: Run::Once(bad_parameters),
        ..Case::QUICK
    },
    Case {
        id: "H03",
        title: "an end time before the start time, and one equal to it",
        right: "refused; done at once",
        bound: "the error of its kind",
        run: Run::Once(backwards),
        ..Case::QUICK
    },
    Case {
        id: "H04",
        title: "tolerances that are zero, negative or not numbers",
        right: "refused",
        bound: "no tolerance of this value",
        run: Run::Once(tolerances),
        ..Case::QUICK
    },
    Case {
        id: "H05",
        title: "an empty ensemble",
        right: "an empty result",
        bound: "no error",
        run: Run::Once(ensembles::empty),
        ..Case::QUICK
    },
    Case {
        id: "H06",
        title: "one bad member among 1e4",
        right: "only that member fails",
        bound: "9999 are done",
        run: Run::Once(ensembles::one_bad_member),
        ..Case::QUICK
    },
    Case {
        id: "H07",
        title: "a start inside a wall",
        right: "no motion",
        bound: "`starts_inside` with the gap, at the start",
        run: Run::Steps(inside),
        ..Case::QUICK
    },
    Case {
        id: "H08",
        title: "a start off the constraints",
        right: "refused, projected or kept, as the caller says",
        bound: "each of the three",
        run: Run::Once(off_constraints),
        ..Case::QUICK
    },
    Case {
        id: "H09",
        title: "a log that is too small",
        right: "keeps the first impacts, counts all",
        bound: "exact counts",
        run: Run::Once(small_log),
        ..Case::QUICK
    },
    Case {
        id: "H10",
        title: "an observer that asks to stop, and one that panics",
        right: "`stopped` within the step; the simulation stays usable",
        bound: "the same run afterwards, to the bit",
        run: Run::Once(observers),
        ..Case::QUICK
    },
    Case {
        id: "H11",
        title: "a stop between any two steps",
        right: "`stopped` with the state at the end of that step",
        bound: "exact",
        run: Run::Integrators(stops),
        ..Case::QUICK
    },
];

type State = <Model as VectorField>::State;

/// A run of the ball over these times.
fn run(
    ball: &Model,
    [t0, t_end]: [f64; 2],
    state: State,
    observer: &mut dyn Observer<Model>,
) -> Result<Ran<State>, StartError> {
    let mut stepper = Dop853::new(Tolerance::new(1e-12).expect("a tolerance"));
    let stepper = Chosen::new(&mut stepper);
    Simulation::new(ball, stepper, ball.effects()).run(t0, state, t_end, &mut { observer })
}

fn not_finite(report: &mut Report) {
    let ball = shipped("bouncing_ball").model();
    for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let refused = ball.state(0.0, &vector(&[value]), &vector(&[0.0]));
        report.equal(
            format!("position {value}"),
            refused.err(),
            Some(StateError::NotFinite { component: 0 }),
        );
        let state = ball
            .state_unchecked(0.0, &vector(&[1.0]), &vector(&[value]))
            .expect("a state");
        let ended = run(&ball, [0.0, 1.0], state, &mut ());
        report.equal(
            format!("velocity {value}"),
            ended.map(|run| run.outcome.kind()).ok(),
            Some("non_finite"),
        );
        let good = ball
            .state(0.0, &vector(&[1.0]), &vector(&[0.0]))
            .expect("a state");
        for times in [[value, 1.0], [0.0, value]] {
            let run = run(&ball, times, good, &mut ());
            report.equal(
                format!("times {times:?}"),
                matches!(run, Err(StartError::Times { .. })),
                true,
            );
        }
    }
}

fn bad_parameters(report: &mut Report) {
    for m in [f64::NAN, f64::INFINITY, 0.0, -1.0] {
        let ball = shipped("bouncing_ball").with([("m", m)]);
        let refused = ball.state(0.0, &vector(&[1.0]), &vector(&[0.0]));
        let name = match refused {
            Err(StateError::Parameter(error)) => error.name,
            _ => "",
        };
        report.equal(format!("m = {m}"), name, "m");
        let state = ball.state_unchecked(0.0, &vector(&[1.0]), &vector(&[0.0]));
        let run = state.map(|state| run(&ball, [0.0, 1.0], state, &mut ()));
        report.equal(
            format!("run, m = {m}"),
            matches!(run, Ok(Err(StartError::Parameter(_))) | Err(_)),
            true,
        );
    }
}

fn backwards(report: &mut Report) {
    let ball = shipped("bouncing_ball").model();
    let state = ball
        .state(0.0, &vector(&[1.0]), &vector(&[0.0]))
        .expect("a state");
    let run = |t_end| run(&ball, [1.0, t_end], state, &mut ());
    report.equal(
        "backwards",
        run(0.5).err(),
        Some(StartError::Times {
            t0: 1.0,
            t_end: 0.5,
        }),
    );
    let at_once = run(1.0).map(|run| (run.outcome, run.counters.accepted));
    report.equal("of no length", at_once.ok(), Some((Outcome::Done, 0)));
}

fn tolerances(report: &mut Report) {
    for value in [0.0, -1e-6, f64::NAN, f64::INFINITY] {
        report.equal(
            format!("tolerance {value}"),
            Tolerance::new(value).is_err(),
            true,
        );
    }
}

fn inside(setting: Setting, report: &mut Report) {
    let end = Course::new(&FALL.model(), &[-1e-9], &[1.0], 1.0).run(setting);
    report.class(&end.outcome, "starts_inside");
    report.equal(
        "outcome",
        end.outcome,
        Outcome::StartsInside {
            surface: 0,
            gap: -1e-9,
        },
    );
    report.equal("time", end.t, 0.0);
}

fn off_constraints(report: &mut Report) {
    let disk = shipped("rolling_disk").model();
    let (q, qdot) = (vector(&[0.0; 4]), vector(&[1.0, 0.0, 0.0, 0.0]));
    let refused = disk.state(0.0, &q, &qdot);
    report.equal(
        "refused",
        matches!(
            refused,
            Err(StateError::OffConstraint { constraint: 0, .. })
        ),
        true,
    );
    let projected = disk.state_projected(0.0, &q, &qdot).expect("a state");
    let velocity = disk.velocity(0.0, &projected).expect("a velocity");
    report.equal("projected", disk.admit(0.0, &q, &velocity).is_ok(), true);
    let global = disk.global().expect("the global form");
    let kept = global.state_unchecked(0.0, &q, &qdot).expect("a state");
    let velocity = global.velocity(0.0, &kept).expect("a velocity");
    report.near("kept", velocity.as_slice()[0], 1.0, 1e-15);
}

fn small_log(report: &mut Report) {
    let ball = shipped("bouncing_ball").model();
    let state = ball
        .state(0.0, &vector(&[0.0]), &vector(&[1.0]))
        .expect("a state");
    let mut log = EventLog::<State, 2>::new();
    let run = run(&ball, [0.0, 11.0], state, &mut log);
    report.equal(
        "outcome",
        run.map(|run| run.outcome).ok(),
        Some(Outcome::Done),
    );
    report.equal(
        "kept, seen, dropped",
        (log.iter().count(), log.seen(), log.dropped()),
        (2, 5, 3),
    );
}

/// Observer that panics or stops the run at the impact number `left`.
struct Fails {
    left: u32,
    panics: bool,
}

impl<M: System> Observer<M> for Fails {
    fn event(&mut self, _: &Event<M::State>) -> ControlFlow<()> {
        self.left -= 1;
        if self.left > 0 {
            return ControlFlow::Continue(());
        }
        if self.panics {
            // A panic that prints no message.
            std::panic::resume_unwind(Box::new("an observer that fails"));
        }
        ControlFlow::Break(())
    }
}

fn observers(report: &mut Report) {
    let ball = shipped("bouncing_ball").model();
    let state = ball
        .state(0.0, &vector(&[0.0]), &vector(&[1.0]))
        .expect("a state");
    let mut stepper = Dop853::new(Tolerance::new(1e-12).expect("a tolerance"));
    let stepper = Chosen::new(&mut stepper);
    let mut simulation = Simulation::new(&ball, stepper, ball.effects());
    let mut run =
        |observer: &mut dyn Observer<Model>| simulation.run(0.0, state, 11.0, &mut { observer });
    let untouched = run(&mut ());
    let stopped = run(&mut Fails {
        left: 2,
        panics: false,
    });
    let end = stopped.map(|run| (run.outcome, run.counters.impacts)).ok();
    report.equal("stopped", end, Some((Outcome::Stopped, 2)));
    report.equal("after a stop", run(&mut ()), untouched);
    let panicked = catch_unwind(AssertUnwindSafe(|| {
        run(&mut Fails {
            left: 2,
            panics: true,
        })
    }));
    report.equal("panicked", panicked.is_err(), true);
    report.equal("after a panic", run(&mut ()), untouched);
}

/// Observer that stops the run after a number of steps and keeps the last state.
struct StopsAfter<S> {
    left: u32,
    last: Option<(f64, S)>,
}

impl<M: System> Observer<M> for StopsAfter<M::State> {
    fn step(&mut self, segment: &mut Segment<'_, M::State>) -> ControlFlow<()> {
        self.left -= 1;
        self.last = Some((segment.t_end(), *segment.end()));
        if self.left == 0 {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    }
}

fn stops(setting: Setting, report: &mut Report) {
    let disk = shipped("rolling_disk").model();
    let start = disk.initial();
    let velocity = disk
        .complete_velocity(0.0, &start.q, &start.qdot, &start.named)
        .expect("velocities");
    let state = disk.state(0.0, &start.q, &velocity).expect("a state");
    for count in 1..=20 {
        let mut stop = StopsAfter {
            left: count,
            last: None,
        };
        let end = Course::from_state(&disk, state, 20.0).follow(setting, &mut stop);
        report.equal(
            format!("outcome after {count} steps"),
            end.outcome,
            Outcome::Stopped,
        );
        let (t, last) = stop.last.expect("a step");
        report.equal(format!("time after {count} steps"), end.t, t);
        report.equal(
            format!("place after {count} steps"),
            end.q,
            disk.position(&last).as_slice().to_vec(),
        );
    }
}
