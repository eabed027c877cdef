//! Section D, third part: drift from the constraints and from closed forms.

use core::ops::ControlFlow;

use dalembert::{Constrained, Instance, Observer, Segment, StateVector, System, VectorField};
use dalembert_cli::Integrator;
use dalembert_cli::suite::{Case, Report, Run, Setting};

use super::constrained::{RADIUS, disk_at, wide_disk};
use super::course::{Course, Random, vector};
use super::text::Model;

/// The cases.
pub const CASES: &[Case] = &[
    Case {
        id: "D13",
        title: "the global field off the constraint",
        right: "eta(qdot) constant",
        bound: "1e-12 over 1e3 units of time, as a share of the terms",
        run: Run::Chosen(
            &[Integrator::Dop853, Integrator::Taylor],
            off_the_constraint,
        ),
        ..Case::QUICK
    },
    Case {
        id: "D13b",
        title: "the global field off the constraint, with the short steps of a low order",
        right: "eta(qdot) constant",
        bound: "1e-12 over 1e3 units of time, as a share of the terms",
        run: Run::Chosen(&[Integrator::Dopri5], off_the_constraint),
        ..Case::QUICK
    },
    Case {
        id: "D14",
        title: "the vertical disk over 1e6 units of time, from 32 starts",
        right: "D02; constraints kept",
        bound: "root mean square of the distance grows with exponent at most 0.6, or below 1e-9 of the path",
        run: Run::Once(long_disk),
        ..Case::NIGHTLY
    },
];

fn off_the_constraint(setting: Setting, report: &mut Report) {
    let disk = wide_disk().global().expect("the global form");
    let qdot = [0.7, -0.2, 1.5, 0.6];
    let state = disk
        .state_unchecked(0.0, &vector(&[0.0; 4]), &vector(&qdot))
        .expect("a state");
    let residuals = |state: &<Model as VectorField>::State| {
        let (q, qdot) = (disk.position(state), disk.velocity(0.0, state));
        disk.residuals(0.0, &q, &qdot.expect("a velocity")).0
    };
    let before = residuals(&state);
    report.equal("is off", before.as_slice()[0].abs() > 0.01, true);
    let mut last = Last(state);
    let end = Course::from_state(&disk, state, 1e3)
        .projection(false)
        .tol(1e-13)
        .follow(setting, &mut last);
    report.class(&end.outcome, "done");
    let after = residuals(&last.0);
    for (a, (before, after)) in before.as_slice().iter().zip(after.as_slice()).enumerate() {
        report.near(format!("eta {a}"), *after, *before, 1e-12 * 2.0);
    }
}

/// Records the last state of a run.
struct Last<S>(S);

impl<M: System> Observer<M> for Last<M::State> {
    fn step(&mut self, segment: &mut Segment<'_, M::State>) -> ControlFlow<()> {
        self.0 = *segment.end();
        ControlFlow::Continue(())
    }
}

fn long_disk(report: &mut Report) {
    let setting = Setting::free(Integrator::Dop853);
    let (disk, mut random) = (wide_disk(), Random::new(14));
    let marks = [1e3, 1e4, 1e5, 1e6];
    let mut squares = [0.0; 4];
    for _ in 0..32 {
        let start = [
            random.between(1.0, 3.0),
            random.between(0.3, 0.9),
            random.between(0.0, 6.0),
        ];
        let [roll, turn, phi] = start;
        let velocity = [
            RADIUS * phi.cos() * roll,
            RADIUS * phi.sin() * roll,
            roll,
            turn,
        ];
        for (t, square) in marks.into_iter().zip(&mut squares) {
            let end = Course::new(&disk, &[0.0, 0.0, 0.0, phi], &velocity, t).run(setting);
            let [x, y, path] = disk_at(start, t);
            *square += ((end.q[0] - x).hypot(end.q[1] - y) / path).powi(2) / 32.0;
        }
    }
    let points: Vec<[f64; 2]> = marks
        .iter()
        .zip(squares)
        .map(|(t, square)| [*t, square.sqrt() * t])
        .collect();
    let exponent = dalembert_cli::suite::exponent(&points).unwrap_or(f64::NAN);
    let bounded = squares[3].sqrt() < 1e-9;
    report.error("exponent", if bounded { 0.0 } else { exponent }, 0.6);
    report.curve(
        "distance from the closed form",
        ["time", "root mean square, times the time over the path"],
        points,
    );
}
