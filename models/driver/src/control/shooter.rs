//! One extremal from a costate at the start: its sequence of impacts, its end and its derivatives.

use std::ops::ControlFlow;

use dalembert::contract::Variational;
use dalembert::integrate::{Chosen, Taylor};
use dalembert::math::larger;
use dalembert::simulation::STEP_BUDGET;
use dalembert::variations::Tangent;
use dalembert::{
    Event, Fault, Instance, Observer, Outcome, Run, Scene, SceneEffects, Simulation, StateError,
    StateVector, Variations,
};

use super::multiple_shooting::{Chain, GUESSES};
use super::second_order::{self, Flow, SecondOrder};
use super::{Extremal, Kick, Moment, Task, Unsought};
use crate::connect::aim::{Aim, Course, Shot};
use crate::connect::observers::Marksman;
use crate::connect::units::Units;
use crate::domain;
use crate::linear::norm;
use crate::refusal::Refusal;
use crate::typed::vector;

/// A motion with an impact within this fraction of the time from its start or end is not accepted.
const AT_ENDS: f64 = 1e-9;

/// Rounding errors of the residuals of a motion, relative to their terms.
const ROUNDING: f64 = 64.0 * f64::EPSILON;

/// Number of steps after which a motion is given up: a minimum, and a multiple of the steps with costate 0 at the
/// start.
const STEPS: [u64; 2] = [4000, 50];
/// As [`STEPS`], for three unknowns or more without surfaces: many motions of such a scan diverge.
const STEPS_IN_SPACE: [u64; 2] = [500, 10];

/// Numbers of stretches of the second-order test, tried in order. Short stretches resolve conjugate points. Over long
/// stretches, an input also controls states on which it acts only through other states.
const STRETCHES: [usize; 4] = [64, 32, 16, 8];

/// Positions of the outputs of a model of extremals: inputs, `H*`, terminal cost, its gradient, its second derivative,
/// and one minor per input. All minors are positive if the optimal inputs minimise the Hamiltonian.
#[derive(Debug, Clone, Copy)]
struct Layout {
    inputs: usize,
    states: usize,
}

impl Layout {
    fn of(components: usize, outputs: usize) -> Option<Self> {
        let states = components.checked_sub(1)? / 2;
        let twice = outputs.checked_sub(2 + states + states * states)?;
        let fits = components == 2 * states + 1 && states > 0 && twice % 2 == 0;
        let inputs = twice / 2;
        fits.then_some(Self { inputs, states })
    }

    fn terminal(self) -> usize {
        self.inputs + 1
    }

    fn slope(self, index: usize) -> usize {
        self.inputs + 2 + index
    }

    /// True if the optimal inputs are finite and minimise the Hamiltonian.
    fn is_best(self, values: &[f64]) -> bool {
        let minors = &values[values.len() - self.inputs..];
        let chosen = &values[..=self.inputs];
        minors.iter().all(|minor| *minor > 0.0) && chosen.iter().all(|it| it.is_finite())
    }

    fn curvature(self, row: usize, column: usize) -> usize {
        self.inputs + 2 + self.states * (1 + row) + column
    }
}

/// The extremals of a system from one state.
pub(super) struct Shooter<'a, S: Instance + Scene + Variational> {
    system: &'a S,
    task: &'a Task,
    layout: Layout,
    /// The start with costate 0.
    rest: S::State,
    /// Typical sizes of the components of state and costate.
    sizes: Vec<f64>,
    runs: u64,
    steps: u64,
    budget: u64,
}

impl<'a, S: Instance + Scene + Variational> Shooter<'a, S> {
    /// The extremals of a system, after all checks of the task.
    ///
    /// # Errors
    /// [`Refusal`] for a start that the system refuses; the inner error for a problem that cannot be solved.
    pub fn aimed(system: &'a S, task: &'a Task) -> Result<Result<Self, Unsought>, Refusal> {
        let outputs = system.description().outputs.len();
        let Some(layout) = Layout::of(system.coordinate_count(), outputs) else {
            return Ok(Err(Unsought::Other));
        };
        let zero = system.zero_vector();
        let mut components = vec![0.0; system.coordinate_count()];
        components[..layout.states].copy_from_slice(&task.from);
        let start = vector(&zero, &components);
        system.checked(0.0, &start, &zero)?;
        let rest = system
            .state_unchecked(0.0, &start, &zero)
            .map_err(StateError::from)?;
        let mut shooter = Self {
            sizes: vec![1.0; 2 * layout.states],
            system,
            task,
            layout,
            rest,
            runs: 0,
            steps: 0,
            budget: STEP_BUDGET,
        };
        Ok(shooter.check().map(|()| {
            shooter.measure();
            shooter
        }))
    }

    /// Refuses a start without an optimal input, and a start or an end behind a surface.
    fn check(&self) -> Result<(), Unsought> {
        let values = self.outputs(0.0, &self.rest)?;
        if !self.layout.is_best(&values) {
            return Err(Unsought::Input);
        }
        self.check_gaps(false, 0.0, &self.rest)?;
        let to: Option<Vec<f64>> = self.task.to.iter().copied().collect();
        match to {
            Some(to) => {
                let mut end = self.rest;
                end.as_mut_slice()[..self.layout.states].copy_from_slice(&to);
                self.check_gaps(true, self.task.time, &end)
            }
            None => Ok(()),
        }
    }

    fn check_gaps(&self, is_end: bool, t: f64, state: &S::State) -> Result<(), Unsought> {
        match self.behind(t, state) {
            Some((surface, gap)) => Err(Unsought::Behind {
                is_end,
                surface,
                gap,
            }),
            None => Ok(()),
        }
    }

    /// A surface behind which a state lies, with its gap.
    fn behind(&self, t: f64, state: &S::State) -> Option<(usize, f64)> {
        let size = domain::size(&state.as_slice()[..self.layout.states]);
        domain::behind(self.system, t, state, size).ok()?
    }

    /// True for a state that is not behind a surface and has an optimal input.
    fn is_valid(&self, t: f64, state: &S::State) -> bool {
        let values = self.outputs(t, state);
        self.behind(t, state).is_none() && values.is_ok_and(|values| self.layout.is_best(&values))
    }

    /// Determines the sizes of state and costate, and the limit of the steps of a motion. A component of the costate at
    /// the start that changes by its size moves the end by about the size of the state.
    fn measure(&mut self) {
        let n = self.layout.states;
        let still = vec![0.0; n];
        let (shot, run) = self.flight(&still, true);
        let steps = run.as_ref().map_or(0, |run| run.counters.accepted);
        let has_surfaces = !self.system.description().surfaces.is_empty();
        let [least, times] = match n < 3 || has_surfaces {
            true => STEPS,
            false => STEPS_IN_SPACE,
        };
        self.budget = least.max(times * steps);
        let end = run.map(|run| run.state);
        for index in 0..n {
            let values = [
                Some(self.task.from[index]),
                self.task.to[index],
                end.as_ref().map(|end| end.as_slice()[index]),
            ];
            let size = values.into_iter().flatten().filter(|it| it.is_finite());
            let size = size.fold(0.0_f64, |most, it| most.max(it.abs()));
            self.sizes[index] = if size > 0.0 { size } else { 1.0 };
        }
        for (index, column) in shot.columns.iter().enumerate() {
            let moved: Vec<f64> = column[..n]
                .iter()
                .zip(&self.sizes)
                .map(|(dx, size)| dx / size)
                .collect();
            let size = 1.0 / norm(&moved);
            if size.is_finite() && size > 0.0 {
                self.sizes[n + index] = size;
            }
        }
    }

    /// The units of the search: sizes of the costate, and the size of the costate that the problem suggests.
    pub fn units(&mut self) -> Units {
        let n = self.layout.states;
        let still = vec![0.0; n];
        let shot = self.shoot(&still, false);
        let suggested = norm(&shot.misses);
        let speed = match suggested > 0.0 && suggested.is_finite() {
            true => suggested,
            false => 1.0,
        };
        Units {
            unknowns: self.sizes[n..].to_vec(),
            speed,
            // A miss that is small beside the misses with costate 0.
            size: speed.min(1.0),
            has_surfaces: !self.system.description().surfaces.is_empty(),
        }
    }

    /// Number of motions that were computed.
    pub fn runs(&self) -> u64 {
        self.runs
    }

    /// Number of components of the state.
    pub fn state_count(&self) -> usize {
        self.layout.states
    }

    /// The state at the start, the given components of the state at the end, and the sizes of the components.
    pub fn ends(&self) -> (&[f64], &[Option<f64>], &[f64]) {
        let sizes = &self.sizes[..self.layout.states];
        (&self.task.from, &self.task.to, sizes)
    }

    /// The seed of the search.
    pub fn seed(&self) -> u64 {
        self.task.seed
    }

    /// The motion from a state and a costate between two fractions of the time, with its derivatives with respect to
    /// both; `None` if it ends early or has no derivatives.
    pub fn stretch(&mut self, shares: [f64; 2], z: &[f64]) -> Option<Stretch<S>> {
        let n = self.layout.states;
        let (system, span) = (self.system, shares.map(|share| share * self.task.time));
        let mut state = self.rest;
        state.as_mut_slice()[..2 * n].copy_from_slice(z);
        let mut tangents: Vec<Tangent<S>> = (0..2 * n).map(Tangent::of_component).collect();
        let mut observer = Marksman {
            variations: Some(Variations::new(system, &mut tangents)),
            hits: Vec::new(),
        };
        let run = self.run_between(span, state, &mut observer);
        let run = run.filter(|run| run.outcome == Outcome::Done)?;
        let is_varied = observer
            .variations
            .is_some_and(|mut it| it.tangents().is_ok());
        is_varied.then(|| Stretch {
            end: run.state,
            columns: tangents
                .iter()
                .map(|it| it.state.as_slice()[..2 * n].to_vec())
                .collect(),
        })
    }

    /// The residuals of the equations at the end, and their derivatives with respect to state and costate at the start
    /// of the last stretch.
    pub fn arrival(&self, last: &Stretch<S>) -> Option<(Vec<f64>, Vec<Vec<f64>>)> {
        let values = self.outputs(self.task.time, &last.end).ok()?;
        let columns = last.columns.iter();
        let slopes = columns.map(|column| self.slopes(column, &values)).collect();
        Some((self.misses(&last.end, &values), slopes))
    }

    fn outputs(&self, t: f64, state: &S::State) -> Result<Vec<f64>, Fault> {
        let mut values = vec![f64::NAN; self.system.description().outputs.len()];
        self.system.outputs(t, state, &mut values)?;
        Ok(values)
    }

    fn state(&self, w: &[f64]) -> S::State {
        let n = self.layout.states;
        let mut state = self.rest;
        state.as_mut_slice()[n..2 * n].copy_from_slice(w);
        state
    }

    /// Runs from a costate at the start.
    fn run(&mut self, w: &[f64], observer: &mut dyn Observer<S>) -> Option<Run<S::State>> {
        self.run_between([0.0, self.task.time], self.state(w), observer)
    }

    fn run_between(
        &mut self,
        [from, to]: [f64; 2],
        state: S::State,
        mut observer: &mut dyn Observer<S>,
    ) -> Option<Run<S::State>> {
        self.runs += 1;
        let mut stepper = Taylor::new(self.task.tolerance);
        let mut effects = self.system.effects();
        effects.set_impact_budget(Some(self.task.impacts[1] as u64 + 2));
        let mut simulation = Simulation::new(self.system, Chosen::new(&mut stepper), effects)
            .with_step_budget(self.budget);
        let run = simulation.run(from, state, to, &mut observer);
        let run = run.ok()?;
        self.steps += run.counters.accepted;
        Some(run)
    }

    /// The sequence of impacts of a motion.
    fn course(&self, ended: Option<&Run<S::State>>, hits: &[(f64, usize)]) -> Course {
        let time = self.task.time;
        let is_at_end = |t: f64| t <= time * AT_ENDS || t >= time * (1.0 - AT_ENDS);
        let is_beyond = hits.len() > self.task.impacts[1];
        match ended.map(|run| run.outcome) {
            _ if hits.iter().any(|(t, _)| is_at_end(*t)) => Course::Lost,
            Some(Outcome::Done | Outcome::ImpactBudget) if is_beyond => Course::Beyond,
            Some(Outcome::Zeno { .. }) => Course::Beyond,
            Some(Outcome::StepBudget) => Course::GivenUp,
            Some(Outcome::Done) if ended.is_some_and(|run| self.is_valid(time, &run.state)) => {
                Course::Reached(hits.iter().map(|hit| hit.1).collect())
            }
            _ => Course::Lost,
        }
    }

    /// A motion, with its derivatives with respect to the costate at the start if requested.
    fn flight(&mut self, w: &[f64], with_slopes: bool) -> (Flight, Option<Run<S::State>>) {
        let (system, n) = (self.system, self.layout.states);
        let mut tangents: Vec<Tangent<S>> = match with_slopes {
            true => (n..2 * n).map(Tangent::of_component).collect(),
            false => Vec::new(),
        };
        let mut observer = Marksman {
            variations: with_slopes.then(|| Variations::new(system, &mut tangents)),
            hits: Vec::new(),
        };
        let run = self.run(w, &mut observer);
        let Marksman { variations, hits } = observer;
        let is_varied = variations.is_some_and(|mut it| it.tangents().is_ok());
        let columns = match is_varied {
            true => tangents
                .iter()
                .map(|it| it.state.as_slice()[..2 * n].to_vec())
                .collect(),
            false => Vec::new(),
        };
        let course = self.course(run.as_ref(), &hits);
        (Flight { course, columns }, run)
    }

    /// The residuals of the equations at the end. `values` are the outputs there.
    fn misses(&self, end: &S::State, values: &[f64]) -> Vec<f64> {
        let n = self.layout.states;
        let state = end.as_slice();
        let miss = |(index, to): (usize, &Option<f64>)| match to {
            Some(to) => state[index] - to,
            None => state[n + index] - values[self.layout.slope(index)],
        };
        self.task.to.iter().enumerate().map(miss).collect()
    }

    /// The derivatives of the residuals, from a column of derivatives of state and costate at the end.
    fn slopes(&self, column: &[f64], values: &[f64]) -> Vec<f64> {
        let n = self.layout.states;
        let slope = |(index, to): (usize, &Option<f64>)| match to {
            Some(_) => column[index],
            None => {
                let curvature = |j: usize| values[self.layout.curvature(index, j)];
                let moved: f64 = (0..n).map(|j| curvature(j) * column[j]).sum();
                column[n + index] - moved
            }
        };
        self.task.to.iter().enumerate().map(slope).collect()
    }

    /// Residuals in units of the state, or of the costate.
    fn scaled(&self, rows: &[f64]) -> Vec<f64> {
        let n = self.layout.states;
        let to = self.task.to.iter().enumerate();
        let sizes = to.map(|(index, to)| match to {
            Some(_) => self.sizes[index],
            None => self.sizes[n + index],
        });
        rows.iter()
            .zip(sizes)
            .map(|(row, size)| row / size)
            .collect()
    }

    /// The size of the terms in which the residuals are rounded: the components at the end, and the costate at the start
    /// times its effect on them. 0 without derivatives.
    fn rounded(&self, end: &S::State, w: &[f64], slopes: &[Vec<f64>]) -> f64 {
        if slopes.is_empty() {
            return 0.0;
        }
        let n = self.layout.states;
        let components = &end.as_slice()[..2 * n];
        let here = self.task.to.iter().enumerate().map(|(index, to)| match to {
            Some(_) => components[index] / self.sizes[index],
            None => components[n + index] / self.sizes[n + index],
        });
        let moved = slopes.iter().zip(w).map(|(column, w)| w * norm(column));
        norm(&here.chain(moved).collect::<Vec<f64>>())
    }

    /// State, costate, optimal inputs and Hamiltonian at a time.
    fn moment(&self, t: f64, state: &S::State) -> Result<Moment, Fault> {
        let n = self.layout.states;
        let values = self.outputs(t, state)?;
        let components = state.as_slice();
        Ok(Moment {
            t,
            state: components[..n].to_vec(),
            costate: components[n..2 * n].to_vec(),
            inputs: values[..self.layout.inputs].to_vec(),
            hamiltonian: values[self.layout.inputs],
        })
    }

    /// The properties of an extremal that was found.
    pub fn extremal(&mut self, w: &[f64]) -> Result<Extremal, Unsought> {
        let time = self.task.time;
        let mut film = Film { events: Vec::new() };
        let run = self.run(w, &mut film);
        let end = run.map_or(self.rest, |run| run.state);
        let values = self.outputs(time, &end)?;
        let terminal = values[self.layout.terminal()];
        let residual = self.misses(&end, &values);
        let kick = |event: &Event<S::State>| -> Result<Kick, Fault> {
            Ok(Kick {
                surface: event.surface,
                before: self.moment(event.t, &event.before)?,
                after: self.moment(event.t, &event.after)?,
            })
        };
        let kicks: Result<Vec<Kick>, Fault> = film.events.iter().map(kick).collect();
        let running = end.as_slice()[2 * self.layout.states];
        Ok(Extremal {
            first: self.moment(0.0, &self.state(w))?,
            last: self.moment(time, &end)?,
            kicks: kicks?,
            cost: running + terminal,
            terminal,
            residual: residual.iter().fold(0.0, |most, it| larger(most, it.abs())),
            second_order: self.second_order(w, &values),
        })
    }

    fn second_order(&mut self, w: &[f64], values: &[f64]) -> SecondOrder {
        let n = self.layout.states;
        let row = |i| {
            (0..n)
                .map(|j| values[self.layout.curvature(i, j)])
                .collect()
        };
        let terminal: Vec<Vec<f64>> = (0..n).map(row).collect();
        let free = self
            .task
            .to
            .iter()
            .enumerate()
            .filter(|(_, to)| to.is_none());
        let free: Vec<usize> = free.map(|(index, _)| index).collect();
        let told = STRETCHES.iter().find_map(|&count| {
            let flows = self.flows(w, count)?;
            let told = second_order::test(&flows, &terminal, &free);
            (told != SecondOrder::Open).then_some(told)
        });
        told.unwrap_or(SecondOrder::Open)
    }

    /// The derivatives of the flow over `count` equal stretches of an extremal; `None` if one of them does not exist.
    fn flows(&mut self, w: &[f64], count: usize) -> Option<Vec<Flow>> {
        let n = self.layout.states;
        let mut z = [&*self.task.from, w].concat();
        let mut flows = Vec::with_capacity(count);
        for index in 0..count {
            let share = |index: usize| index as f64 / count as f64;
            let stretch = self.stretch([index, index + 1].map(share), &z)?;
            z.copy_from_slice(&stretch.end.as_slice()[..2 * n]);
            flows.push(Flow {
                t: share(index + 1) * self.task.time,
                columns: stretch.columns,
            });
        }
        Some(flows)
    }
}

/// The end of a motion over a part of the time, and its derivatives with respect to state and costate at its start.
pub(super) struct Stretch<S: Instance + Scene + Variational> {
    pub end: S::State,
    pub columns: Vec<Vec<f64>>,
}

/// The sequence of impacts of a motion, and its derivatives at the end.
struct Flight {
    course: Course,
    columns: Vec<Vec<f64>>,
}

impl<S: Instance + Scene + Variational> Aim for Shooter<'_, S> {
    fn steps(&self) -> u64 {
        self.steps
    }

    fn guesses(&self) -> usize {
        GUESSES
    }

    fn guess(&mut self, index: usize) -> Option<Vec<f64>> {
        Chain::new(self).solve(index)
    }

    fn shoot(&mut self, w: &[f64], with_slopes: bool) -> Shot {
        let (flight, run) = self.flight(w, with_slopes);
        let end = run.and_then(|run| {
            let values = self.outputs(self.task.time, &run.state).ok()?;
            Some((run.state, values))
        });
        let Some((end, values)) = end else {
            return Shot {
                course: flight.course,
                misses: vec![f64::NAN; self.layout.states],
                slopes: Vec::new(),
                rounding: 0.0,
            };
        };
        let columns = flight.columns.iter();
        let columns = columns.map(|column| self.scaled(&self.slopes(column, &values)));
        let slopes: Vec<Vec<f64>> = columns.collect();
        Shot {
            rounding: ROUNDING * self.rounded(&end, w, &slopes),
            slopes,
            misses: self.scaled(&self.misses(&end, &values)),
            course: flight.course,
        }
    }
}

/// Records the impacts of a run.
struct Film<S> {
    events: Vec<Event<S>>,
}

impl<S: Instance> Observer<S> for Film<S::State> {
    fn event(&mut self, event: &Event<S::State>) -> ControlFlow<()> {
        self.events.push(*event);
        ControlFlow::Continue(())
    }
}
