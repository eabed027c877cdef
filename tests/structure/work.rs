//! The work of small runs of every integrator on every declared system, exactly: a change of these numbers is a change of
//! the method. `ACCEPT=1 cargo test --release -p dalembert-tests --test structure` stores them anew.

use std::fmt::Write as _;
use std::path::Path;

use dalembert::{
    Counters, Described, Dla2, Dla4, Dop853, DormandPrince5, Gauss4, Gauss6, Lagrangian, Rk4,
    Scene, Simulation, Stepper, Taylor, TaylorField, Tolerance,
};
use dalembert_tests::golden;
use dalembert_tests::sampling::{Visitor, states, visit_all};

/// How long the motions are followed, and the step of those that keep one.
const TIME: f64 = 1.0;
const STEP: f64 = 1.0 / 64.0;

/// Rate evaluations, coefficients of series, accepted and rejected steps, dense constructions, impacts, projections.
fn numbers(counters: Counters) -> String {
    let Counters {
        rate_evaluations,
        coefficients,
        accepted,
        rejected,
        dense_constructions,
        impacts,
        projections,
        ..
    } = counters;
    format!(
        "{rate_evaluations:6} {coefficients:6} {accepted:5} {rejected:4} {dense_constructions:4} {impacts:4} {projections:4}"
    )
}

#[derive(Default)]
struct Work(String);

impl Work {
    fn of<S: Described + Scene + Lagrangian, Step: Stepper<S>>(
        &mut self,
        system: &S,
        stepper: Step,
    ) {
        let state = states(system, 1, 7)[0];
        let run = Simulation::new(system, stepper, system.effects())
            .run(0.0, state, TIME, &mut ())
            .expect("a start");
        let (name, kind) = (S::DESCRIPTION.name, run.outcome.kind());
        let work = numbers(run.counters);
        writeln!(self.0, "{name:28} {:7} {work}  {kind}", Step::NAME).expect("a string");
    }
}

impl Visitor for Work {
    fn visit<S: Described + Scene + TaylorField + Lagrangian>(&mut self, system: S) {
        let tolerance = Tolerance::new(1e-9).expect("a tolerance");
        self.of(&system, Dop853::new(tolerance));
        self.of(&system, DormandPrince5::new(tolerance));
        self.of(&system, Taylor::new(tolerance));
        self.of(&system, Rk4::new(tolerance).with_step(STEP));
        self.of(&system, Gauss4::new(tolerance).with_step(STEP));
        self.of(&system, Gauss6::new(tolerance).with_step(STEP));
        self.of(&system, Dla2::new(tolerance).with_step(STEP));
        self.of(&system, Dla4::new(tolerance).with_step(STEP));
    }
}

#[test]
fn work_is_as_counted() {
    let mut work = Work::default();
    visit_all(&mut work);
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("golden/work.txt");
    golden::compare_file(&path, &work.0);
}
