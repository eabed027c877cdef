//! One motion from given unknowns: its sequence of impacts, its end, its derivatives, its action.

use dalembert::contract::{TaylorField, Variational};
use dalembert::integrate::{Chosen, Taylor};
use dalembert::math::larger;
use dalembert::numbers::{Numbers, Row};
use dalembert::simulation::STEP_BUDGET;
use dalembert::variations::{Dual, Tangent};
use dalembert::{
    Action, Instance, Observer, Outcome, Run, Scene, SceneEffects, Simulation, StateError,
    StateVector, Undefined, Variations,
};

use super::aim::{Aim, Course, Shot};
use super::conjugate::{self, Mark};
use super::observers::{Determinants, Film, Marksman, Stand};
use super::units::{Units, unit, units};
use super::{Boundary, Conjugate, Connection, Unjoined};
use crate::domain;
use crate::linear::determinant;
use crate::model::Point;
use crate::model::point;
use crate::refusal::Refusal;
use crate::typed::vector;
use crate::variation::constant;

/// Impacts within this fraction of the time after the start or before the end belong to a configuration on a surface.
const AT_ENDS: f64 = 1e-9;

/// Largest determinant that counts as 0, as a fraction of the largest along the motion.
const SINGULAR: f64 = 1e-7;

/// Number of steps after which a motion is given up: a minimum, and a multiple of the steps of the motion from rest.
const STEPS: [u64; 2] = [4000, 50];

/// Largest distance behind a surface that counts as rounding, relative to the largest coordinate (or to 1).
const ROUNDING: f64 = 1e-9;

/// The motions of a system between two configurations.
pub(super) struct Shooter<'a, S: Instance + Scene + Variational> {
    system: &'a S,
    boundary: &'a Boundary,
    /// The start with all unknowns 0.
    rest: S::State,
    /// Index of the first unknown among the components of a state, and their number.
    motion: [usize; 2],
    /// The indices of the given coordinates of the end.
    given: Vec<usize>,
    runs: u64,
    steps: u64,
    /// Number of steps after which a motion is given up.
    budget: u64,
}

impl<'a, S: Instance + Scene + Variational> Shooter<'a, S> {
    /// The motions of a system, after all checks of the configurations.
    ///
    /// # Errors
    /// [`Refusal`] for a start that the system refuses; the inner error for a problem that cannot be solved.
    pub fn aimed(system: &'a S, boundary: &'a Boundary) -> Result<Result<Self, Unjoined>, Refusal> {
        let description = system.description();
        if description.is_first_order {
            return Ok(Err(Unjoined::FirstOrder));
        }
        let is_free = description.constraints.is_empty();
        if !is_free && description.quasi_velocities.is_empty() {
            return Ok(Err(Unjoined::Unreduced));
        }
        let zero = system.zero_vector();
        let mut placed = system.zero_vector();
        placed.as_mut_slice().fill(1.0);
        let q = system.complete_position(0.0, &vector(&zero, &boundary.from), &placed)?;
        system.checked(0.0, &q, &zero)?;
        let mut rest = system
            .state_unchecked(0.0, &q, &zero)
            .map_err(StateError::from)?;
        let start = system.motion_start(&rest);
        let unknowns = system.impulse_len();
        rest.as_mut_slice()[start..start + unknowns].fill(0.0);
        let given = boundary.to.iter().enumerate();
        let given = given.filter_map(|(index, to)| to.map(|_| index)).collect();
        let shooter = Self {
            system,
            boundary,
            rest,
            motion: [start, unknowns],
            given,
            runs: 0,
            steps: 0,
            budget: STEP_BUDGET,
        };
        Ok(shooter.check().map(|()| shooter.with_budget()))
    }

    /// Limits the steps of a motion.
    fn with_budget(mut self) -> Self {
        let rest = self.run(
            &vec![0.0; self.motion[1]],
            self.boundary.time,
            f64::INFINITY,
            &mut (),
        );
        let steps = rest.map_or(0, |run| run.counters.accepted);
        self.budget = STEPS[0].max(STEPS[1].saturating_mul(steps));
        self
    }

    /// Refuses a wrong number of equations, and configurations that no motion joins.
    fn check(&self) -> Result<(), Unjoined> {
        let (equations, unknowns) = (self.given.len(), self.motion[1]);
        let description = self.system.description();
        let levels = description.constraints.iter();
        let levels = levels
            .filter(|constraint| constraint.level.is_some())
            .count();
        let is_whole = equations == description.coordinates.len();
        if equations != unknowns && !(is_whole && equations - levels == unknowns) {
            return Err(Unjoined::Count {
                equations,
                unknowns,
            });
        }
        if self.boundary.envelope > 0 && unknowns != 1 {
            return Err(Unjoined::Envelope { unknowns });
        }
        self.check_gaps(false, 0.0, &self.rest)?;
        if !is_whole {
            return Ok(());
        }
        let zero = self.system.zero_vector();
        let to: Vec<f64> = self
            .boundary
            .to
            .iter()
            .map(|to| to.unwrap_or(0.0))
            .collect();
        let (t, to) = (self.boundary.time, vector(&zero, &to));
        let mut placed = self.system.zero_vector();
        placed.as_mut_slice().fill(1.0);
        let to = self
            .system
            .complete_position(t, &to, &placed)
            .map_err(Unjoined::End)?;
        let end = self.system.checked(t, &to, &zero).map_err(Unjoined::End)?;
        self.check_levels(t, &end)?;
        self.check_gaps(true, t, &end)
    }

    /// Refuses an end at which the level of a constraint differs from its value at the start.
    fn check_levels(&self, t: f64, end: &S::State) -> Result<(), Unjoined> {
        let constraints = self.system.description().constraints.iter();
        let named = constraints.enumerate();
        let named: Vec<(usize, usize)> = named
            .filter_map(|(index, it)| Some((index, it.level?)))
            .collect();
        let [before, after] = [
            levels(self.system, 0.0, &self.rest, named.len())?,
            levels(self.system, t, end, named.len())?,
        ];
        for (constraint, level) in named {
            let difference = after[level] - before[level];
            let size = after[level].abs().max(before[level].abs()).max(1.0);
            if difference.abs() > ROUNDING * size {
                return Err(Unjoined::Level {
                    constraint,
                    difference,
                });
            }
        }
        Ok(())
    }

    /// Refuses a configuration behind a surface that a motion cannot pass.
    fn check_gaps(&self, is_end: bool, t: f64, state: &S::State) -> Result<(), Unjoined> {
        let q = self.system.position(state);
        let size = q
            .as_slice()
            .iter()
            .fold(1.0_f64, |most, q| most.max(q.abs()));
        for (surface, gap) in gaps(self.system, &self.effects(), t, state) {
            if gap < -ROUNDING * size {
                return Err(Unjoined::Behind {
                    is_end,
                    surface,
                    gap,
                });
            }
        }
        Ok(())
    }

    /// The effects with the laws and policies of the request. A limit ends runs with too many impacts.
    fn effects(&self) -> S::Effects {
        let mut effects = self.system.effects();
        for &(surface, law) in &self.boundary.laws {
            effects.set_law(surface, law);
        }
        effects.set_policies(self.boundary.policies);
        // One more impact may lie on the surface of the end, and one more shows that there are too many.
        let most = self.boundary.impacts[1] as u64 + 2;
        effects.set_impact_budget(Some(most));
        effects
    }

    /// Number of unknowns.
    pub fn unknowns(&self) -> usize {
        self.motion[1]
    }

    /// Number of motions that were computed.
    pub fn runs(&self) -> u64 {
        self.runs
    }

    /// The state with these unknowns.
    fn state(&self, w: &[f64]) -> S::State {
        let [start, count] = self.motion;
        let mut state = self.rest;
        state.as_mut_slice()[start..start + count].copy_from_slice(w);
        state
    }

    /// The directions of the unknowns.
    pub fn tangents(&self) -> Vec<Tangent<S>> {
        let [start, count] = self.motion;
        (start..start + count).map(Tangent::of_component).collect()
    }

    /// Runs from these unknowns to a time.
    fn run(
        &mut self,
        w: &[f64],
        until: f64,
        longest: f64,
        mut observer: &mut dyn Observer<S>,
    ) -> Option<Run<S::State>> {
        self.runs += 1;
        let stepper = Taylor::new(self.boundary.tolerance).with_max_step(longest);
        let mut stepper = stepper.ok()?;
        let mut simulation =
            Simulation::new(self.system, Chosen::new(&mut stepper), self.effects())
                .with_step_budget(self.budget);
        let run = simulation.run(0.0, self.state(w), until, &mut observer);
        let run = run.ok()?;
        self.steps += run.counters.accepted;
        Some(run)
    }

    /// The sequence of impacts of a motion.
    fn course(&self, ended: Option<Outcome>, hits: &[(f64, usize)]) -> Course {
        let time = self.boundary.time;
        let mut counted = hits.iter().filter(|(t, _)| *t < time * (1.0 - AT_ENDS));
        let is_beyond = counted.clone().count() > self.boundary.impacts[1];
        match ended {
            _ if counted.clone().any(|(t, _)| *t <= time * AT_ENDS) => Course::Lost,
            Some(Outcome::Done | Outcome::ImpactBudget) | None if is_beyond => Course::Beyond,
            Some(Outcome::Done) => Course::Reached(counted.by_ref().map(|hit| hit.1).collect()),
            // Impacts that accumulate are too many as well.
            Some(Outcome::Zeno { .. }) => Course::Beyond,
            Some(Outcome::StepBudget) => Course::GivenUp,
            _ => Course::Lost,
        }
    }

    /// Derivatives of the configuration with respect to the unknowns, one column per unknown.
    fn columns(&self, tangents: &[Tangent<S>]) -> Vec<Vec<f64>> {
        let n = self.system.coordinate_count();
        let column = |tangent: &Tangent<S>| tangent.state.as_slice()[..n].to_vec();
        tangents.iter().map(column).collect()
    }

    /// The determinant of the derivative of the configuration with respect to the unknowns. If all coordinates of the
    /// end are given, the configuration is projected onto the velocities that the constraints allow.
    pub fn determinant(&self, t: f64, state: &S::State, tangents: &[Tangent<S>]) -> f64 {
        let columns = self.columns(tangents);
        self.projected(t, state, &columns)
    }

    /// The determinant of changes of the configuration, projected as in [`Self::determinant`].
    fn projected(&self, t: f64, state: &S::State, columns: &[Vec<f64>]) -> f64 {
        let n = self.system.coordinate_count();
        let rows: Vec<Vec<f64>> = match self.given.len() == n {
            true => self.frame(t, state),
            false => self.given.iter().map(|&index| unit(n, index)).collect(),
        };
        let product = |row: &[f64], column: &[f64]| -> f64 {
            row.iter()
                .zip(column)
                .map(|(row, column)| row * column)
                .sum()
        };
        let column = |column: &Vec<f64>| rows.iter().map(|row| product(row, column)).collect();
        determinant(columns.iter().map(column).collect())
    }

    /// The change of the velocity per unit of each unknown, at the position of a state.
    fn frame(&self, t: f64, state: &S::State) -> Vec<Vec<f64>> {
        let [start, count] = self.motion;
        let velocity = |index: Option<usize>| {
            let mut state = *state;
            state.as_mut_slice()[start..start + count].fill(0.0);
            if let Some(index) = index {
                state.as_mut_slice()[start + index] = 1.0;
            }
            self.system.velocity(t, &state)
        };
        let difference = |index: usize| match (velocity(Some(index)), velocity(None)) {
            (Ok(moved), Ok(rest)) => {
                let pairs = moved.as_slice().iter().zip(rest.as_slice());
                pairs.map(|(moved, rest)| moved - rest).collect()
            }
            _ => vec![f64::NAN; self.system.coordinate_count()],
        };
        (0..count).map(difference).collect()
    }

    /// The determinant at a time; NaN where it does not exist.
    pub fn determinant_at(&mut self, w: &[f64], t: f64) -> f64 {
        let mut tangents = self.tangents();
        let system = self.system;
        let mut variations = Variations::new(system, &mut tangents);
        let run = self.run(w, t, f64::INFINITY, &mut variations);
        let Some(run) = run.filter(|run| run.outcome == Outcome::Done) else {
            return f64::NAN;
        };
        match variations.tangents() {
            Ok(tangents) => self.determinant(t, &run.state, tangents),
            Err(_) => f64::NAN,
        }
    }

    /// The state at a time.
    fn state_at(&mut self, w: &[f64], t: f64) -> Option<Point> {
        let run = self.run(w, t, f64::INFINITY, &mut ())?;
        Some(point(self.system, t, &run.state))
    }

    /// The properties of a motion that was found.
    pub fn connection(&mut self, w: &[f64]) -> Result<Connection, Unjoined> {
        let (system, time) = (self.system, self.boundary.time);
        let mut film = Film {
            action: Action::new(system),
            bounces: Vec::new(),
            system,
        };
        let ended = self.run(w, time, f64::INFINITY, &mut film);
        let Film {
            action,
            mut bounces,
            ..
        } = film;
        let last = ended.map_or_else(|| self.rest, |run| run.state);
        // An impact at the end does not count. The velocity at the end is then the one before this impact.
        let counted = bounces
            .iter()
            .take_while(|bounce| bounce.t < time * (1.0 - AT_ENDS))
            .count();
        let arrival = bounces.drain(counted..).next();
        let last = arrival.map_or_else(|| point(system, time, &last), |bounce| bounce.before);
        let shot = self.shoot(w, true);
        let marks = self.marks(w)?;
        let conjugate = self.conjugate(w, &marks);
        let free = self.projected(0.0, &self.rest, &self.frame(0.0, &self.rest));
        let end = marks.last().map_or(f64::NAN, |mark| mark.determinant);
        let determinant = end / (free * time.powi(self.motion[1] as i32));
        let largest = marks.iter().map(|mark| mark.determinant.abs());
        let largest = largest.fold(0.0, larger);
        Ok(Connection {
            first: point(system, 0.0, &self.state(w)),
            last,
            bounces,
            action: action.value()?,
            residual: shot
                .misses
                .iter()
                .fold(0.0, |most, miss| larger(most, miss.abs())),
            conjugate,
            determinant,
            is_isolated: end.abs() > SINGULAR * largest,
            family: 1,
        })
    }

    /// The determinant along a motion that was found, at the ends of short steps.
    fn marks(&mut self, w: &[f64]) -> Result<Vec<Mark>, Unjoined> {
        let (marks, undefined) = self.followed(w);
        match undefined {
            Some(undefined) => Err(undefined.into()),
            None => Ok(marks),
        }
    }

    /// The determinant along any motion, and the reason why it ends early.
    fn followed(&mut self, w: &[f64]) -> (Vec<Mark>, Option<Undefined>) {
        let (system, time) = (self.system, self.boundary.time);
        let mut tangents = self.tangents();
        let mut observer = Determinants {
            variations: Variations::new(system, &mut tangents),
            states: Vec::new(),
        };
        self.run(w, time, time * conjugate::LONGEST, &mut observer);
        let Determinants {
            mut variations,
            states,
        } = observer;
        let undefined = variations.tangents().err();
        let mark = |stand: Stand<S::State>| Mark {
            t: stand.t,
            determinant: self.projected(stand.t, &stand.state, &stand.columns),
            is_cut: stand.is_cut,
        };
        (states.into_iter().map(mark).collect(), undefined)
    }

    fn conjugate(&mut self, w: &[f64], marks: &[Mark]) -> Vec<Conjugate> {
        let time = self.boundary.time;
        let zeros = conjugate::zeros(marks, time, &mut |t| self.determinant_at(w, t));
        let cuts = marks.iter().filter(|mark| mark.is_cut);
        let impacts = |t: f64| cuts.clone().filter(|mark| mark.t < t).count();
        let point = |t: f64| {
            let at = self.state_at(w, t)?;
            let impacts = impacts(t);
            Some(Conjugate { t, at, impacts })
        };
        zeros.into_iter().filter_map(point).collect()
    }

    /// The conjugate points of any motion, as long as it has a derivative and not too many impacts.
    pub fn envelope(&mut self, w: &[f64]) -> Vec<Conjugate> {
        let marks = self.followed(w).0;
        let mut points = self.conjugate(w, &marks);
        points.retain(|point| point.impacts <= self.boundary.impacts[1]);
        points
    }

    /// The mechanical units of a search: the value of each unknown at kinetic energy 1/2, and the speed that the
    /// problem suggests.
    pub fn units(&self) -> Units {
        units(self.system, self.boundary, &self.rest, self.motion)
    }
}

impl<S: Instance + Scene + Variational> Aim for Shooter<'_, S> {
    fn steps(&self) -> u64 {
        self.steps
    }

    fn shoot(&mut self, w: &[f64], with_slopes: bool) -> Shot {
        let system = self.system;
        let mut tangents = match with_slopes {
            true => self.tangents(),
            false => Vec::new(),
        };
        let mut observer = Marksman {
            variations: with_slopes.then(|| Variations::new(system, &mut tangents)),
            hits: Vec::new(),
        };
        let ended = self.run(w, self.boundary.time, f64::INFINITY, &mut observer);
        let Marksman { variations, hits } = observer;
        let course = self.course(ended.map(|run| run.outcome), &hits);
        let columns = match variations.map(|mut variations| variations.tangents().is_ok()) {
            Some(true) => self.columns(&tangents),
            _ => Vec::new(),
        };
        let q = ended.map(|run| system.position(&run.state));
        let miss = |&index: &usize| {
            let to = self.boundary.to[index].unwrap_or(f64::NAN);
            q.as_ref().map_or(f64::NAN, |q| q.as_slice()[index] - to)
        };
        let rows = |column: &Vec<f64>| self.given.iter().map(|&index| column[index]).collect();
        Shot {
            course,
            misses: self.given.iter().map(miss).collect(),
            slopes: columns.iter().map(rows).collect(),
            rounding: 0.0,
        }
    }
}

/// The surfaces that count at a state and that a motion cannot pass, with their gaps.
fn gaps<S: Instance + Scene + Variational>(
    system: &S,
    effects: &S::Effects,
    t: f64,
    state: &S::State,
) -> Vec<(usize, f64)> {
    let gaps = domain::gaps(system, t, state).unwrap_or_default();
    let stops = |surface: usize| {
        let law = effects.law(system, surface);
        law.is_some_and(|law| !law.is_map())
    };
    gaps.into_iter()
        .filter(|(surface, _)| stops(*surface))
        .collect()
}

/// The levels of the constraints at a state.
fn levels<S: Instance + Scene + Variational>(
    system: &S,
    t: f64,
    state: &S::State,
    count: usize,
) -> Result<Vec<f64>, Unjoined> {
    let parameters = TaylorField::parameters(system);
    let parameters = constant::<S::Parameters<Dual>>(parameters.as_slice());
    let row = constant::<S::Row<Dual>>(StateVector::as_slice(state));
    let deviations = system.deviations(&parameters, Dual::of(t), &row)?;
    let deviations = deviations.as_slice();
    let levels = &deviations[deviations.len().saturating_sub(count)..];
    Ok(levels.iter().map(|level| level.value).collect())
}
