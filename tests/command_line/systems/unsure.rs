//! Systems with an unsure event search: it evaluates gaps at nine points of a step and misses impacts between them.

use dalembert::audit::{Audit, Auditor};
use dalembert::describe::{Description, Initial, Instance, Report};
use dalembert::effects::{Moment, StepView};
use dalembert::error::ParameterError;
use dalembert::integrate::Stepper;
use dalembert::jet::{LENGTH, Work};
use dalembert::law::Law;
use dalembert::numbers::{Numbers, Rated};
use dalembert::{
    Effect, Event, Fault, Impacting, Lagrangian, NoForces, Observer, Outcome, RankDrop, Scene,
    SceneEffects, StateError, StateVector, System, TaylorField, VectorField,
};
use dalembert_driver::Model;

/// Value of a parameter for which runs fail.
const UNLUCKY: f64 = 13.0;

/// A model whose event search samples the gaps.
#[derive(Debug, Clone)]
pub struct Unsure<M> {
    system: M,
    description: &'static Description,
    fails: bool,
}

impl<M> Unsure<M> {
    pub fn of(system: M, description: &'static Description) -> Self {
        Self {
            system,
            description,
            fails: false,
        }
    }

    fn fail(&self) {
        assert!(!self.fails, "unlucky");
    }
}

impl<M: VectorField> VectorField for Unsure<M> {
    type State = M::State;

    fn state_len(&self) -> usize {
        self.system.state_len()
    }

    fn rate(&self, t: f64, state: &M::State, rate: &mut M::State) -> Result<(), Fault> {
        self.fail();
        self.system.rate(t, state, rate)
    }

    fn scale(&self, t: f64, state: &M::State) -> M::State {
        self.system.scale(t, state)
    }

    fn can_be_narrow(&self) -> bool {
        self.system.can_be_narrow()
    }

    fn has_narrow_rates(&self) -> bool {
        self.system.has_narrow_rates()
    }

    fn rates_along(
        &self,
        t: Rated,
        component: &dyn Fn(usize) -> Rated,
        rate: &mut dyn FnMut(usize, Rated),
    ) -> Result<(), Fault> {
        self.system.rates_along(t, component, rate)
    }
}

impl<M: TaylorField> TaylorField for Unsure<M> {
    type Parameters<L: Numbers> = M::Parameters<L>;
    type Row<L: Numbers> = M::Row<L>;
    type Gaps<L: Numbers> = M::Gaps<L>;
    type Firsts<L: Numbers> = M::Firsts<L>;
    type Jets<L: Numbers> = M::Jets<L>;

    fn series_gap_count(&self) -> usize {
        self.system.series_gap_count()
    }

    fn firsts_len(&self) -> usize {
        self.system.firsts_len()
    }

    fn work(&self) -> Option<Work> {
        self.system.work()
    }

    fn parameters(&self) -> M::Parameters<f64> {
        self.system.parameters()
    }

    fn begin<L: Numbers>(
        &self,
        parameters: &M::Parameters<L>,
        t: L,
        state: &M::Row<L>,
        firsts: &mut M::Firsts<L>,
    ) -> Result<(), Fault> {
        self.fail();
        self.system.begin(parameters, t, state, firsts)
    }

    fn advance<L: Numbers>(
        &self,
        parameters: &M::Parameters<L>,
        unit: L,
        order: usize,
        firsts: &M::Firsts<L>,
        coefficients: &mut [M::Row<L>; LENGTH],
        gaps: &mut [M::Gaps<L>; LENGTH],
        jets: &mut M::Jets<L>,
    ) {
        self.system
            .advance(parameters, unit, order, firsts, coefficients, gaps, jets);
    }
}

impl<M: System> System for Unsure<M> {
    type Vector = M::Vector;
    type Impulse = M::Impulse;

    fn coordinate_count(&self) -> usize {
        self.system.coordinate_count()
    }

    fn impulse_len(&self) -> usize {
        self.system.impulse_len()
    }

    fn position(&self, state: &M::State) -> M::Vector {
        self.system.position(state)
    }

    fn velocity(&self, t: f64, state: &M::State) -> Result<M::Vector, Fault> {
        self.system.velocity(t, state)
    }

    fn momentum(&self, t: f64, state: &M::State) -> Result<M::Vector, Fault> {
        self.system.momentum(t, state)
    }

    fn state_unchecked(&self, t: f64, q: &M::Vector, qdot: &M::Vector) -> Result<M::State, Fault> {
        self.system.state_unchecked(t, q, qdot)
    }

    fn state_from_momenta(&self, t: f64, q: &M::Vector, p: &M::Vector) -> Result<M::State, Fault> {
        self.system.state_from_momenta(t, q, p)
    }

    fn energy(&self, t: f64, state: &M::State) -> Result<f64, Fault> {
        self.system.energy(t, state)
    }

    fn conserves_energy(&self) -> bool {
        self.system.conserves_energy()
    }

    fn kick(&self, state: &mut M::State, size: f64, direction: &M::Impulse) {
        self.system.kick(state, size, direction);
    }

    fn check_parameters(&self) -> Result<(), ParameterError> {
        self.system.check_parameters()
    }

    fn motion_start(&self, state: &M::State) -> usize {
        self.system.motion_start(state)
    }

    fn mode(&self, state: &M::State) -> usize {
        self.system.mode(state)
    }

    fn outside_chart(&self, state: &M::State) -> Option<usize> {
        self.system.outside_chart(state)
    }

    fn can_lose_rank(&self) -> bool {
        self.system.can_lose_rank()
    }

    fn rank_drop(&self, motion: impl Fn(f64) -> (f64, M::State), reach: f64) -> Option<RankDrop> {
        self.system.rank_drop(motion, reach)
    }

    fn admit(&self, t: f64, q: &M::Vector, qdot: &M::Vector) -> Result<(), StateError> {
        self.system.admit(t, q, qdot)
    }

    fn state_nearest(&self, t: f64, q: &M::Vector, qdot: &M::Vector) -> Result<M::State, Fault> {
        self.system.state_nearest(t, q, qdot)
    }

    fn complete_position(
        &self,
        t: f64,
        q: &M::Vector,
        placed: &M::Vector,
    ) -> Result<M::Vector, StateError> {
        self.system.complete_position(t, q, placed)
    }

    fn complete_velocity(
        &self,
        t: f64,
        q: &M::Vector,
        qdot: &M::Vector,
        named: &M::Vector,
    ) -> Result<M::Vector, StateError> {
        self.system.complete_velocity(t, q, qdot, named)
    }
}

impl<M: Lagrangian> Lagrangian for Unsure<M> {
    type Reactions = M::Reactions;

    fn reaction_count(&self) -> usize {
        self.system.reaction_count()
    }

    fn force(&self, t: f64, q: &M::Vector, qdot: &M::Vector) -> M::Vector {
        self.fail();
        self.system.force(t, q, qdot)
    }

    fn reaction_force(&self, t: f64, q: &M::Vector, reactions: &M::Reactions) -> M::Vector {
        self.system.reaction_force(t, q, reactions)
    }

    fn constrained_velocity(
        &self,
        t: f64,
        q: &M::Vector,
        p: &M::Vector,
    ) -> Result<(M::Vector, M::Reactions), Fault> {
        self.system.constrained_velocity(t, q, p)
    }
}

impl<M> Instance for Unsure<M>
where
    M: Model + Impacting,
    M::Global: Model + Impacting,
{
    type Global = Unsure<M::Global>;

    fn global(&self) -> Option<Self::Global> {
        Some(Unsure {
            system: self.system.global()?,
            description: self.description,
            fails: self.fails,
        })
    }

    fn parameter(&self, index: usize) -> f64 {
        self.system.parameter(index)
    }

    fn set_parameter(&mut self, index: usize, value: f64) {
        self.fails |= value == UNLUCKY;
        self.system.set_parameter(index, value);
    }

    fn set_mode(&mut self, mode: usize) {
        self.system.set_mode(mode);
    }

    fn initial(&self) -> Initial<M::Vector> {
        self.system.initial()
    }

    fn outputs(&self, t: f64, state: &M::State, values: &mut [f64]) -> Result<(), Fault> {
        self.system.outputs(t, state, values)
    }

    fn view_path(&self, t: f64, state: &M::State) -> Option<[f64; 2]> {
        self.system.view_path(t, state)
    }

    fn view_region(&self, t: f64, q: &M::Vector) -> Option<f64> {
        self.system.view_region(t, q)
    }

    fn inspect(&self, t: f64, state: &M::State, report: &mut dyn Report) -> Result<(), Fault> {
        self.system.inspect(t, state, report)?;
        report.vector("samples", &PLACES);
        Ok(())
    }

    fn description(&self) -> &Description {
        self.description
    }
}

impl<M: Impacting> Scene for Unsure<M> {
    type Effects = NineSamples;

    fn effects(&self) -> NineSamples {
        NineSamples {
            found: None,
            left: None,
        }
    }
}

/// Impacts by the declared laws, found if a gap is not positive at one of nine points of a step.
#[derive(Debug, Clone)]
pub struct NineSamples {
    /// The surface at whose impact the step is cut.
    found: Option<usize>,
    /// The surface that was met last: its gap is 0 at the start of the step.
    left: Option<usize>,
}

/// Points of a step at which gaps are evaluated, as fractions of the step.
const PLACES: [f64; 9] = [0.0, 0.038, 0.146, 0.309, 0.5, 0.691, 0.854, 0.962, 1.0];

impl<M: Impacting> Effect<Unsure<M>> for NineSamples {
    type Forces = NoForces;

    fn propose<Step: Stepper<Unsure<M>>>(
        &mut self,
        step: &mut StepView<'_, Unsure<M>, Step>,
    ) -> Result<Option<f64>, Outcome> {
        step.prepare()?;
        let system = &step.system.system;
        let gap = |surface: usize, part: f64| {
            let (t, state) = (step.time(part), step.state(part));
            system.gaps(t, &state).as_slice()[surface]
        };
        let mut first: Option<(f64, usize)> = None;
        for surface in 0..system.surface_count() {
            let is_above =
                |part: f64| (part == 0.0 && self.left == Some(surface)) || gap(surface, part) > 0.0;
            let fall = PLACES
                .windows(2)
                .find(|ends| is_above(ends[0]) && !is_above(ends[1]));
            let Some(&[mut before, mut after]) = fall else {
                continue;
            };
            for _ in 0..60 {
                let middle = 0.5 * (before + after);
                match is_above(middle) {
                    true => before = middle,
                    false => after = middle,
                }
            }
            if first.is_none_or(|(part, _)| before < part) {
                first = Some((before, surface));
            }
        }
        self.found = first.map(|(_, surface)| surface);
        if first.is_none() {
            self.left = None;
        }
        Ok(first.map(|(part, _)| part))
    }

    fn act<O: Observer<Unsure<M>>>(
        &mut self,
        _: f64,
        now: &mut Moment<'_, Unsure<M>>,
        observer: &mut O,
    ) -> Result<(), Outcome> {
        let Some(surface) = self.found.take() else {
            return Ok(());
        };
        let (system, t, before) = (&now.system.system, now.t, *now.state);
        *now.state = match system.law(surface).is_map() {
            true => system.landing(surface, t, &before)?.state,
            false => {
                let blow = system.blow(surface, t, &before)?;
                let mut after = before;
                system.kick(&mut after, blow.size, &blow.direction);
                after
            }
        };
        self.left = Some(surface);
        now.counters.impacts += 1;
        let event = Event {
            t,
            surface,
            law: system.law(surface),
            before,
            after: *now.state,
            simultaneous: false,
            graze: false,
        };
        match observer.event(&event).is_break() {
            true => Err(Outcome::Stopped),
            false => Ok(()),
        }
    }
}

impl<M: Impacting> SceneEffects<Unsure<M>> for NineSamples {
    fn law(&self, system: &Unsure<M>, surface: usize) -> Option<Law> {
        (surface < system.system.surface_count()).then(|| system.system.law(surface))
    }

    fn audit(&self, system: &Unsure<M>, work: &mut dyn FnMut(&mut dyn Auditor<Unsure<M>>)) -> bool {
        work(&mut Audit::new(&system.system));
        true
    }
}
