//! A timed run from one state, with its impacts and its end as JSON.

use std::ops::ControlFlow;

use dalembert::{
    Dop853, Effect, Event, Observer, Outcome, Run, Simulation, StateVector, Stepper, System,
    Taylor, TaylorField, Tolerance,
};
use serde_json::{Value, json};

use crate::timing::timed;
use crate::{Plan, State};

/// A run of a system from a state to a time.
pub struct Course<'a, S: System, E> {
    pub work: &'static str,
    pub system: &'a S,
    pub effects: E,
    pub start: State<S>,
    pub until: f64,
    /// Further times at which the state is compared.
    pub probes: &'static [f64],
}

/// Times of impacts and states after them.
struct Impacts<S: System> {
    times: Vec<f64>,
    after: Vec<State<S>>,
}

impl<S: System> Impacts<S> {
    fn new() -> Self {
        const MANY: usize = 4096;
        Self {
            times: Vec::with_capacity(MANY),
            after: Vec::with_capacity(MANY),
        }
    }

    fn clear(&mut self) {
        self.times.clear();
        self.after.clear();
    }
}

impl<S: System> Observer<S> for Impacts<S> {
    fn event(&mut self, event: &Event<State<S>>) -> ControlFlow<()> {
        self.times.push(event.t);
        self.after.push(event.after);
        ControlFlow::Continue(())
    }
}

impl<S: TaylorField + System, E: Effect<S> + Clone> Course<'_, S, E> {
    /// Runs both integrators at every tolerance and prints the results, or makes a single run.
    pub fn measure(&self, plan: &Plan) {
        if let Some((integrator, value)) = plan.once {
            let tolerance = Tolerance::new(value).expect("a tolerance");
            match integrator {
                "dalembert-taylor" => self.run(Taylor::new(tolerance), self.until, &mut ()),
                _ => self.run(Dop853::new(tolerance), self.until, &mut ()),
            };
            return;
        }
        for &value in plan.tolerances {
            let tolerance = Tolerance::new(value).expect("a tolerance");
            self.report(value, "dalembert-taylor", Taylor::new(tolerance), plan);
            self.report(value, "dalembert-dop853", Dop853::new(tolerance), plan);
        }
    }

    fn report<T: Stepper<S> + Copy>(&self, tolerance: f64, peer: &str, stepper: T, plan: &Plan) {
        let mut impacts = Impacts::new();
        let mut run = self.run(stepper, self.until, &mut impacts);
        let times = (0..plan.repetitions).map(|_| {
            impacts.clear();
            let (time, last) = timed(|| self.run(stepper, self.until, &mut impacts));
            run = last;
            time.as_secs_f64()
        });
        let time = times.fold(f64::INFINITY, f64::min);
        let mut probes: Vec<Vec<f64>> = Vec::new();
        for &t in self.probes {
            probes.push(self.motion(&self.run(stepper, t, &mut ()).state));
        }
        let energies = [&self.start, &run.state].map(|state| self.energy(state));
        println!(
            "{}",
            json!({
                "peer": peer, "work": self.work, "tol": tolerance, "T": self.until, "time": time,
                "outcome": run.outcome.kind(), "accumulation": accumulation(run.outcome),
                "nf": run.counters.rate_evaluations, "expansions": run.counters.expansions,
                "acc": run.counters.accepted, "rej": run.counters.rejected, "nev": run.counters.impacts,
                "dE": (energies[1] - energies[0]) / energies[0].abs(),
                "y": self.motion(&run.state), "probe": probes, "tev": impacts.times,
                "yev": self.after(&impacts),
            })
        );
    }

    fn run<T: Stepper<S> + Copy>(
        &self,
        stepper: T,
        until: f64,
        observer: &mut impl Observer<S>,
    ) -> Run<State<S>> {
        Simulation::new(self.system, stepper, self.effects.clone())
            .run(0.0, self.start, until, observer)
            .expect("a start")
    }

    fn energy(&self, state: &State<S>) -> f64 {
        self.system.energy(0.0, state).expect("an energy")
    }

    /// Positions, then velocities, of a state.
    fn motion(&self, state: &State<S>) -> Vec<f64> {
        let qdot = self.system.velocity(0.0, state).expect("a velocity");
        let q = self.system.position(state);
        [q.as_slice(), qdot.as_slice()].concat()
    }

    /// Positions and velocities after impacts 1, 5, 10 and 20.
    fn after(&self, impacts: &Impacts<S>) -> Vec<Vec<f64>> {
        let states = [0, 4, 9, 19].map(|k| impacts.after.get(k));
        states
            .into_iter()
            .flatten()
            .map(|state| self.motion(state))
            .collect()
    }
}

/// Time at which impacts accumulate; null if the run ended otherwise.
fn accumulation(outcome: Outcome) -> Value {
    match outcome {
        Outcome::Zeno { t, .. } => json!(t),
        _ => Value::Null,
    }
}
