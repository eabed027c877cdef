//! Motions over a step from many states, with each of several values of the input. The components of the first-order
//! model are the state, the held input and the cost.

use std::ops::ControlFlow;

use dalembert::contract::Variational;
use dalembert::describe::VariationalVisitor;
use dalembert::integrate::{Chosen, Taylor};
use dalembert::{
    Event, Instance, Observer, Outcome, Scene, SceneEffects, Simulation, StateError, StateVector,
    Tolerance,
};

use crate::domain;
use crate::refusal::Refusal;
use crate::typed::vector;

/// Maximum number of impacts in a step.
const IMPACTS: u64 = 64;

/// Maximum number of steps of the integrator in one step in time.
const STEPS: u64 = 4096;

/// Number of components of the state.
const STATE: usize = 2;

/// A step in time, with the values of the input for its motions.
#[derive(Debug, Clone, Copy)]
pub struct Leg<'a> {
    /// The times at its start and at its end.
    pub span: [f64; 2],
    /// The tolerance of the integrator, `Taylor`.
    pub tolerance: Tolerance,
    /// The values of the input.
    pub inputs: &'a [f64],
}

/// An impact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hit {
    /// The time.
    pub t: f64,
    /// The index of the surface.
    pub surface: usize,
    /// The states before and after.
    pub states: [[f64; 2]; 2],
}

/// The end of a motion over a step.
#[derive(Debug, Clone, PartialEq)]
pub struct Landing {
    /// The state.
    pub state: [f64; 2],
    /// The cost of the step.
    pub cost: f64,
    /// The impacts, in order of time.
    pub hits: Vec<Hit>,
}

/// Reason why a motion has no end.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Unlanded {
    /// There is no initial state, for example behind a surface.
    NoState,
    /// The motion does not reach the end of the step.
    Lost,
}

/// Visitor that computes motions of a model of any type.
pub(crate) struct Walker<'a> {
    pub leg: &'a Leg<'a>,
    pub from: &'a [[f64; 2]],
}

impl VariationalVisitor for Walker<'_> {
    /// The motions of the first state, one per input, then those of the next state.
    type Output = Result<Vec<Result<Landing, Unlanded>>, Refusal>;

    fn visit<S: Instance + Scene + Variational>(self, system: &S) -> Self::Output {
        system.check_parameters().map_err(StateError::from)?;
        let inputs = self.leg.inputs;
        let mut landings = Vec::with_capacity(self.from.len() * inputs.len());
        for from in self.from {
            let start = start(system, self.leg, *from);
            landings.extend(inputs.iter().map(|input| {
                let mut state = start.ok_or(Unlanded::NoState)?;
                state.as_mut_slice()[STATE] = *input;
                landing(system, self.leg, state).ok_or(Unlanded::Lost)
            }));
        }
        Ok(landings)
    }
}

/// The initial state of a motion; `None` if it lies behind a surface or does not exist.
fn start<S: Instance + Scene + Variational>(
    system: &S,
    leg: &Leg<'_>,
    from: [f64; 2],
) -> Option<S::State> {
    let zero = system.zero_vector();
    let t = leg.span[0];
    let components = vector(&zero, &from);
    system.checked(t, &components, &zero).ok()?;
    let state = system.state_unchecked(t, &components, &zero).ok()?;
    (!is_behind(system, t, &state)).then_some(state)
}

fn is_behind<S: Instance + Scene + Variational>(system: &S, t: f64, state: &S::State) -> bool {
    let size = domain::size(&state.as_slice()[..STATE]);
    domain::behind(system, t, state, size) != Ok(None)
}

fn landing<S: Instance + Scene + Variational>(
    system: &S,
    leg: &Leg<'_>,
    state: S::State,
) -> Option<Landing> {
    let mut stepper = Taylor::new(leg.tolerance);
    let mut effects = system.effects();
    effects.set_impact_budget(Some(IMPACTS));
    let mut simulation =
        Simulation::new(system, Chosen::new(&mut stepper), effects).with_step_budget(STEPS);
    let mut hits = Hits(Vec::new());
    let run = simulation.run(leg.span[0], state, leg.span[1], &mut hits);
    let run = run.ok().filter(|run| run.outcome == Outcome::Done)?;
    let cost = *run.state.as_slice().last()?;
    let is_finite = run.state.as_slice().iter().all(|it| it.is_finite());
    (is_finite && !is_behind(system, leg.span[1], &run.state)).then(|| Landing {
        state: first(&run.state),
        cost,
        hits: hits.0,
    })
}

fn first<V: StateVector>(state: &V) -> [f64; 2] {
    let state = state.as_slice();
    [state[0], state[1]]
}

/// Records the impacts of a run.
struct Hits(Vec<Hit>);

impl<S: Instance> Observer<S> for Hits {
    fn event(&mut self, event: &Event<S::State>) -> ControlFlow<()> {
        self.0.push(Hit {
            t: event.t,
            surface: event.surface,
            states: [first(&event.before), first(&event.after)],
        });
        ControlFlow::Continue(())
    }
}
