//! Runs of a case. A run has a system, a start, an end and a setting.

use core::mem;
use core::ops::ControlFlow;

use dalembert::integrate::{Chosen, Counters};
use dalembert::law::Law;
use dalembert::simulation::STEP_BUDGET;
use dalembert::{
    Dla2, Dla4, Dop853, DormandPrince5, Event, Gauss4, Gauss6, Hold, Instance, Lagrangian,
    Observer, Outcome, Policies, Rest, Rk4, Run, Scene, SceneEffects, Segment, Simulation,
    StateVector, System, Taylor, TaylorField, Tolerance,
};
use dalembert_cli::Integrator;
use dalembert_cli::suite::Setting;

use super::by_hand::Point;
use super::text::{Large, Model};

/// Half a unit in the last place of 1.
pub const U: f64 = f64::EPSILON / 2.0;

/// Specification of a run.
pub struct Course<'a, M: Driven> {
    system: &'a M,
    t0: f64,
    state: M::State,
    until: f64,
    tolerance: [f64; 2],
    step: Option<f64>,
    order: Option<usize>,
    steps: u64,
    effects: M::Effects,
}

/// An impact.
#[derive(Debug, Clone)]
pub struct Hit {
    /// The time.
    pub t: f64,
    /// Index of the surface.
    pub surface: usize,
    /// Positions.
    pub q: Vec<f64>,
    /// Velocities before it.
    pub before: Vec<f64>,
    /// Velocities after it.
    pub after: Vec<f64>,
    /// True if another surface was hit at the same time.
    pub simultaneous: bool,
    /// True if flagged as a grazing impact.
    pub graze: bool,
}

/// An event at which a surface begins or ceases to hold the motion.
#[derive(Debug, Clone)]
pub struct Held {
    /// The time.
    pub t: f64,
    /// Index of the surface.
    pub surface: usize,
    /// Positions.
    pub q: Vec<f64>,
    /// True if it begins to hold the motion.
    pub begins: bool,
    /// The time at which impacts accumulate, if the contact begins with an accumulation.
    pub accumulation: Option<f64>,
}

/// End of a run.
#[derive(Debug, Clone)]
pub struct End {
    /// The outcome.
    pub outcome: Outcome,
    /// The time.
    pub t: f64,
    /// Positions at the end.
    pub q: Vec<f64>,
    /// Velocities at the end; empty if the metric is singular.
    pub qdot: Vec<f64>,
    /// Kinetic plus potential energy at the end.
    pub energy: f64,
    /// The impacts.
    pub hits: Vec<Hit>,
    /// The events at which surfaces begin or cease to hold the motion.
    pub holds: Vec<Held>,
    /// Counts of work.
    pub counters: Counters,
}

impl<'a, M: Driven> Course<'a, M> {
    /// A run from these positions and velocities at time 0 to `until`. Positions and velocities that violate the
    /// constraints are projected.
    ///
    /// # Panics
    /// If the system refuses the start. Cases of refused starts use other functions.
    pub fn new(system: &'a M, q: &[f64], qdot: &[f64], until: f64) -> Self {
        let state = system
            .state_projected(0.0, &vector(q), &vector(qdot))
            .expect("an admissible start");
        Self::from_state(system, state, until)
    }

    /// A run from a state at time 0.
    pub fn from_state(system: &'a M, state: M::State, until: f64) -> Self {
        Self {
            system,
            t0: 0.0,
            state,
            until,
            tolerance: [1e-12; 2],
            step: None,
            order: None,
            steps: STEP_BUDGET,
            effects: system.effects(),
        }
    }

    /// The initial state.
    pub fn start(&self) -> &M::State {
        &self.state
    }

    /// Sets the initial time.
    pub fn at(mut self, t0: f64) -> Self {
        self.t0 = t0;
        self
    }

    /// Sets the tolerance, `1e-12` by default.
    pub fn tol(self, tol: f64) -> Self {
        self.tols(tol, tol)
    }

    /// Sets a relative and an absolute tolerance.
    pub fn tols(mut self, relative: f64, absolute: f64) -> Self {
        self.tolerance = [relative, absolute];
        self
    }

    /// Sets the step size. For an adaptive integrator it is the largest step size, unless the setting has one.
    pub fn step(mut self, length: f64) -> Self {
        self.step = Some(length);
        self
    }

    /// Sets the order of power series. By default the integrator uses the order with the least work.
    pub fn order(mut self, order: usize) -> Self {
        self.order = Some(order);
        self
    }

    /// Sets the law of a surface.
    pub fn law(mut self, surface: usize, law: Law) -> Self {
        self.effects.set_law(surface, law);
        self
    }

    /// Ends the run after this many impacts.
    pub fn impacts(mut self, budget: u64) -> Self {
        self.effects.set_impact_budget(Some(budget));
        self
    }

    /// Ends the run after this many steps.
    pub fn steps(mut self, budget: u64) -> Self {
        self.steps = budget;
        self
    }

    /// Continues along surfaces that hold the motion, instead of ending there.
    pub fn resting(self) -> Self {
        self.policies(Policies {
            rest: Rest::Contact,
            ..Policies::default()
        })
    }

    /// Sets the policies.
    pub fn policies(mut self, policies: Policies) -> Self {
        self.effects.set_policies(policies);
        self
    }

    /// Sets projection on the constraints on or off.
    pub fn projection(mut self, on: bool) -> Self {
        self.effects.set_projection(on);
        self
    }

    /// Replaces the effects of the scene, and any that were set before.
    pub fn effects(mut self, effects: M::Effects) -> Self {
        self.effects = effects;
        self
    }

    /// Removes all effects: no impacts and no projection.
    pub fn alone(self) -> Self
    where
        M::Effects: Default,
    {
        self.effects(M::Effects::default())
    }

    /// Makes the run. The result lists all impacts and all holds.
    pub fn run(self, setting: Setting) -> End {
        let mut log = Log {
            system: self.system,
            hits: Vec::new(),
            holds: Vec::new(),
        };
        let mut end = self.follow(setting, &mut log);
        (end.hits, end.holds) = (log.hits, log.holds);
        end
    }

    /// Makes the run with an observer. The result lists no impacts and no holds.
    pub fn follow(self, setting: Setting, observer: &mut dyn Observer<M>) -> End {
        let system = self.system;
        let run = system.drive(&mut self.under(setting), observer);
        let velocity = system.velocity(run.t, &run.state);
        End {
            outcome: run.outcome,
            t: run.t,
            q: system.position(&run.state).as_slice().to_vec(),
            qdot: velocity
                .map(|velocity| velocity.as_slice().to_vec())
                .unwrap_or_default(),
            energy: system.energy(run.t, &run.state).unwrap_or(f64::NAN),
            hits: Vec::new(),
            holds: Vec::new(),
            counters: run.counters,
        }
    }

    /// Makes the run by an integrator with an observer, and returns the result of [`Simulation::run`].
    pub fn observed(self, integrator: Integrator, observer: &mut dyn Observer<M>) -> Run<M::State> {
        self.with_effects(integrator, observer).0
    }

    /// Same as [`Course::observed`], but also returns the effects after the run.
    pub fn with_effects(
        self,
        integrator: Integrator,
        observer: &mut dyn Observer<M>,
    ) -> (Run<M::State>, M::Effects) {
        let system = self.system;
        let mut drive = self.under(Setting::free(integrator));
        let run = system.drive(&mut drive, observer);
        (run, drive.effects)
    }

    /// The drive of this run under a setting.
    pub fn under(self, setting: Setting) -> Drive<M> {
        let [relative, absolute] = self.tolerance;
        Drive {
            setting,
            tolerance: Tolerance::of(relative, absolute).expect("a positive tolerance"),
            step: self.step,
            order: self.order,
            steps: self.steps,
            effects: self.effects,
            t0: self.t0,
            state: self.state,
            until: self.until,
        }
    }

    /// The system.
    pub fn system(&self) -> &'a M {
        self.system
    }
}

impl<'a, M: Driven + Instance> Course<'a, M> {
    /// A run from the declared start at time 0.
    ///
    /// # Panics
    /// If the system declares no start.
    pub fn declared(system: &'a M, until: f64) -> Self {
        Self::from_state(system, declared(system), until)
    }
}

/// The declared start of a system.
///
/// # Panics
/// If it declares none.
pub fn declared<M: Instance>(system: &M) -> M::State {
    let start = system.initial();
    let q = system
        .complete_position(0.0, &start.q, &start.placed)
        .expect("positions");
    let qdot = system
        .complete_velocity(0.0, &q, &start.qdot, &start.named)
        .expect("velocities");
    system.state(0.0, &q, &qdot).expect("a state")
}

/// The state with these positions and velocities at time 0.
///
/// # Panics
/// If they are refused.
pub fn state<M: System>(system: &M, q: &[f64], qdot: &[f64]) -> M::State {
    let state = system.state(0.0, &vector(q), &vector(qdot));
    state.expect("an admissible start")
}

/// Systems whose runs are compiled once, in this crate, and called by cases and tests.
pub trait Driven: Scene + TaylorField {
    /// Makes a run with an observer. Afterwards `drive` contains the effects in their final state.
    fn drive(&self, drive: &mut Drive<Self>, observer: &mut dyn Observer<Self>)
    -> Run<Self::State>;
}

/// Data of a run besides its system.
#[derive(Debug)]
pub struct Drive<M: Scene> {
    /// The setting.
    pub setting: Setting,
    /// The tolerance.
    pub tolerance: Tolerance,
    /// The step size; for an adaptive integrator, the largest step size.
    pub step: Option<f64>,
    /// The order of power series.
    pub order: Option<usize>,
    /// The largest number of steps.
    pub steps: u64,
    /// The effects: impacts, projection.
    pub effects: M::Effects,
    /// The first time.
    pub t0: f64,
    /// The first state.
    pub state: M::State,
    /// The last time.
    pub until: f64,
}

/// Implements [`Driven`] for types of systems, each with a function of [`Drive`] that selects its integrators.
macro_rules! driven {
    ($(impl[$($generics:tt)*] $system:ty: $integrators:ident),*) => {$(
        impl<$($generics)*> Driven for $system {
            fn drive(
                &self,
                drive: &mut Drive<Self>,
                observer: &mut dyn Observer<Self>,
            ) -> Run<Self::State> {
                drive.$integrators(self, observer)
            }
        }
    )*};
}
driven!(impl[] Model: every, impl[] Large: every, impl[const S: usize] Point<S>: adaptive);

/// Runs a drive with an integrator.
macro_rules! run {
    ($drive:ident, $stepper:expr, $system:ident, $observer:ident) => {{
        let mut stepper = $stepper;
        $drive.with($system, Chosen::new(&mut stepper), $observer)
    }};
}

impl<M: Scene + TaylorField + Lagrangian> Drive<M> {
    /// Runs with any integrator.
    fn every(&mut self, system: &M, observer: &mut dyn Observer<M>) -> Run<M::State> {
        // Integrators with a fixed step ignore an infinite step size and use their default.
        let (tolerance, step) = (self.tolerance, self.step.unwrap_or(f64::INFINITY));
        macro_rules! fixed {
            ($stepper:ident) => {
                run!(
                    self,
                    $stepper::new(tolerance).with_step(step),
                    system,
                    observer
                )
            };
        }
        match self.setting.integrator {
            Integrator::Rk4 => fixed!(Rk4),
            Integrator::Gauss4 => fixed!(Gauss4),
            Integrator::Gauss6 => fixed!(Gauss6),
            Integrator::Dla2 => fixed!(Dla2),
            Integrator::Dla4 => fixed!(Dla4),
            _ => self.adaptive(system, observer),
        }
    }
}

impl<M: Scene + TaylorField> Drive<M> {
    /// Runs with an adaptive integrator.
    fn adaptive(&mut self, system: &M, observer: &mut dyn Observer<M>) -> Run<M::State> {
        let (tolerance, setting) = (self.tolerance, self.setting);
        let longest = setting.max_step.or(self.step).unwrap_or(f64::INFINITY);
        macro_rules! bounded {
            ($stepper:expr) => {{
                let bounded = $stepper.with_max_step(longest);
                run!(self, bounded.expect("a positive step"), system, observer)
            }};
        }
        match (setting.integrator, self.order) {
            (Integrator::Dop853, _) => bounded!(Dop853::new(tolerance)),
            (Integrator::Dopri5, _) => bounded!(DormandPrince5::new(tolerance)),
            (Integrator::Taylor, None) => bounded!(Taylor::new(tolerance)),
            (Integrator::Taylor, Some(order)) => {
                bounded!(Taylor::new(tolerance).with_order(order))
            }
            (other, _) => {
                unreachable!("a system written by hand has no discrete principle: {other:?}")
            }
        }
    }

    fn with(
        &mut self,
        system: &M,
        stepper: Chosen<'_, M>,
        observer: &mut dyn Observer<M>,
    ) -> Run<M::State> {
        let mut reader = Reader {
            dense: self.setting.dense,
            observer,
        };
        let effects = mem::replace(&mut self.effects, system.effects());
        let mut simulation = Simulation::new(system, stepper, effects).with_step_budget(self.steps);
        let run = simulation
            .run(self.t0, self.state, self.until, &mut reader)
            .expect("a start");
        mem::swap(&mut self.effects, simulation.effects());
        run
    }
}

/// True for an integrator of the discrete Lagrange-d'Alembert principle. Such an integrator does not apply to
/// first-order systems or to constraints that are not linear in the velocities.
pub const fn is_discrete(integrator: Integrator) -> bool {
    matches!(integrator, Integrator::Dla2 | Integrator::Dla4)
}

/// A vector of the system's type.
pub fn vector<V: StateVector>(values: &[f64]) -> V {
    V::of(values)
}

/// Observer that records every impact and every hold.
struct Log<'a, M> {
    system: &'a M,
    hits: Vec<Hit>,
    holds: Vec<Held>,
}

impl<M: Scene + TaylorField> Observer<M> for Log<'_, M> {
    fn event(&mut self, event: &Event<M::State>) -> ControlFlow<()> {
        let velocity = |state| match self.system.velocity(event.t, state) {
            Ok(velocity) => velocity.as_slice().to_vec(),
            Err(_) => Vec::new(),
        };
        self.hits.push(Hit {
            t: event.t,
            surface: event.surface,
            q: self.system.position(&event.before).as_slice().to_vec(),
            before: velocity(&event.before),
            after: velocity(&event.after),
            simultaneous: event.simultaneous,
            graze: event.graze,
        });
        ControlFlow::Continue(())
    }

    fn hold(&mut self, hold: &Hold<M::State>) -> ControlFlow<()> {
        self.holds.push(Held {
            t: hold.t,
            surface: hold.surface,
            q: self.system.position(&hold.state).as_slice().to_vec(),
            begins: hold.begins,
            accumulation: hold.accumulation,
        });
        ControlFlow::Continue(())
    }
}

/// Observer that evaluates the dense output in every step, if the setting requests it, and then forwards the step.
struct Reader<'a, M: Scene> {
    dense: bool,
    observer: &'a mut dyn Observer<M>,
}

impl<M: Scene + TaylorField> Observer<M> for Reader<'_, M> {
    fn step(&mut self, segment: &mut Segment<'_, M::State>) -> ControlFlow<()> {
        if self.dense {
            let middle = 0.5 * (segment.t_start() + segment.t_end());
            if segment.at(middle).is_err() {
                return ControlFlow::Break(());
            }
        }
        self.observer.step(segment)
    }

    fn event(&mut self, event: &Event<M::State>) -> ControlFlow<()> {
        self.observer.event(event)
    }

    fn hold(&mut self, hold: &Hold<M::State>) -> ControlFlow<()> {
        self.observer.hold(hold)
    }
}

impl End {
    /// The times of the impacts.
    pub fn times(&self) -> Vec<f64> {
        self.hits.iter().map(|hit| hit.t).collect()
    }

    /// Bound on the rounding errors of a gap: `32 u` times `terms`, where `terms` is the sum of the absolute values of
    /// the terms of the gap. Each step adds `u` times `terms` for rounding of the state.
    pub fn eta(&self, terms: f64) -> f64 {
        U * terms * (32.0 + self.counters.accepted as f64)
    }
}

/// Bound on the error in the time of an impact at which the gap has rounding errors `eta`, rate `rate` and second
/// derivative `bend`, plus four units in the last place of the time.
pub fn location(t: f64, eta: f64, rate: f64, bend: f64) -> f64 {
    let clear = rate * rate >= 2.0 * bend.abs() * eta;
    let spread = if clear {
        2.0 * eta / rate.abs()
    } else {
        2.0 * (2.0 * eta / bend.abs()).sqrt()
    };
    spread + 4.0 * U * t.abs()
}

/// A deterministic sequence of pseudorandom numbers: splitmix64.
#[derive(Debug, Clone)]
pub struct Random(u64);

impl Random {
    /// The sequence of a seed.
    pub const fn new(seed: u64) -> Self {
        Self(seed)
    }

    /// The next 64 bits.
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut bits = self.0;
        bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        bits ^ (bits >> 31)
    }

    /// The next number, uniform between `low` and `high`.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * ((self.bits() >> 11) as f64 / (1_u64 << 53) as f64)
    }
}
