//! Runs of a typed model, reported to a [`Watch`] that does not depend on the model's type.

/// Builds an adaptive integrator with the largest step of the settings. Returns from the calling function on a refusal.
macro_rules! limited {
    ($stepper:expr, $settings:expr) => {
        $stepper.with_max_step($settings.max_step.unwrap_or(f64::INFINITY))?
    };
}

mod abreast;
mod energy;
mod reading;
mod steered;
mod tally;

use std::cell::RefCell;
use std::ops::ControlFlow;

use dalembert::describe::Description;
use dalembert::integrate::{
    AUTOMATIC_STEPS, Chosen, Counters, Dla2, Dla4, Dop853, DormandPrince5, FixedStep, Gauss4,
    Gauss6, Method, Rk4, Taylor, Tolerance,
};
use dalembert::law::Law;
use dalembert::math::larger;
use dalembert::simulation::STEP_BUDGET;
use dalembert::{
    Event, Hold, Instance, Observer, Outcome, Policies, Run, Scene, SceneEffects, Segment,
    Simulation, StateVector,
};

use crate::integrator::{Form, Integrator};
use crate::model::Point;
use crate::refusal::Refusal;
use crate::typed::Model;
pub(crate) use abreast::abreast;
use energy::Balance;
use reading::{Integrals, Reading};
pub use steered::{Changes, Control, InputFunction, steer};
pub use tally::ImpactTally;

/// Settings of a run.
#[derive(Debug, Clone)]
pub struct Settings {
    /// The form of the equations.
    pub form: Form,
    /// The integrator.
    pub integrator: Integrator,
    /// The tolerance, relative and absolute.
    pub tol: f64,
    /// The step of a fixed-step integrator, if one is set.
    pub step: Option<f64>,
    /// The largest step of an adaptive integrator.
    pub max_step: Option<f64>,
    /// Stop after this many steps.
    pub steps: Option<u64>,
    /// The end time.
    pub until: f64,
    /// Stop after this many impacts.
    pub impacts: Option<u64>,
    /// Laws that replace the declared ones, by index of the surface. The last entry for a surface counts.
    pub laws: Vec<(usize, Law)>,
    /// Policies of impacts after which the law alone does not determine the motion.
    pub policies: Policies,
    /// Turns the projection onto the constraints after each step on or off; `None` for the default of the scene.
    pub projection: Option<bool>,
}

/// End of a run.
#[derive(Debug, Clone)]
pub struct Ending {
    /// The outcome.
    pub outcome: Outcome,
    /// The time at the end.
    pub t: f64,
    /// The initial state.
    pub first: Point,
    /// The last state.
    pub last: Point,
    /// Counters of the work: steps, evaluations, impacts and the like.
    pub counters: Counters,
    /// The step of a fixed-step integrator.
    pub step: Option<f64>,
    /// The law in force on each surface.
    pub laws: Vec<Option<Law>>,
    /// True if the run reached the requested time or number of impacts.
    pub reached: bool,
    /// Warnings about the accuracy of a fixed-step integrator.
    pub warnings: Vec<String>,
}

/// An impact; with `S = ()`, without its states.
#[derive(Debug, Clone, PartialEq)]
pub struct Impact<S = Point> {
    /// The time.
    pub t: f64,
    /// The index of the surface.
    pub surface: usize,
    /// The state before.
    pub before: S,
    /// The state after.
    pub after: S,
    /// True if another surface was hit at the same time.
    pub simultaneous: bool,
    /// True for a grazing impact: rounding may have decided that it happens.
    pub graze: bool,
}

/// A surface begins or ceases to hold the motion.
#[derive(Debug, Clone, PartialEq)]
pub struct Contact {
    /// The time.
    pub t: f64,
    /// The index of the surface.
    pub surface: usize,
    /// The state.
    pub at: Point,
    /// True if it begins to hold the motion.
    pub begins: bool,
    /// The time at which impacts accumulate, if the contact begins with an accumulation.
    pub accumulation: Option<f64>,
}

/// A stretch of smooth motion.
pub trait Piece {
    /// The times at its start and at its end.
    fn span(&self) -> (f64, f64);

    /// The state at a time of the stretch.
    fn at(&self, t: f64) -> Point;
}

/// Observer of a run that does not depend on the type of the model.
pub trait Watch {
    /// Receives a stretch of smooth motion.
    fn step(&mut self, piece: &dyn Piece);

    /// Hears of an impact. True if the watch wants to receive it with its states, which cost time.
    fn hears(&mut self, impact: &Impact<()>) -> bool {
        let _ = impact;
        true
    }

    /// Receives an impact of which [`Watch::hears`] wanted the states.
    fn impact(&mut self, impact: Impact);

    /// Receives the beginning or the end of a contact.
    fn contact(&mut self, contact: Contact);

    /// True if the watch wants warnings about errors, which cost time.
    fn wants_warnings(&self) -> bool {
        false
    }

    /// True once the watch needs no more data. The run then ends.
    fn is_over(&self) -> bool {
        false
    }
}

/// A run that has ended, in the types of the model.
pub(crate) struct Solved<S> {
    pub run: Run<S>,
    /// The step of a fixed-step integrator.
    pub step: Option<f64>,
    /// The law in force on each surface.
    pub laws: Vec<Option<Law>>,
}

/// Runs a model from `t = 0` under a watch.
///
/// # Errors
/// [`Refusal`] if the runtime refuses to start.
pub(crate) fn simulate<M: Model>(
    model: &M,
    state: M::State,
    settings: &Settings,
    watch: &mut dyn Watch,
) -> Result<Ending, Refusal> {
    let wants_warnings = watch.wants_warnings();
    let is_doubtful = !settings.integrator.is_adaptive() && wants_warnings;
    let balance = is_doubtful.then(|| Balance::of(model, 0.0, &state));
    let mut bridge = Bridge {
        model,
        reading: model,
        integrals: Integrals::of(model),
        watch,
        balance: balance.flatten(),
        reach: wants_warnings.then_some(0.0),
    };
    bridge.follow(&model.position(&state));
    let first = bridge.point(0.0, &state);
    let solved = solve(model, &state, settings, &mut bridge)?;
    let last = bridge.point(solved.run.t, &solved.run.state);
    let warnings = match settings.integrator.is_adaptive() {
        true => bridge
            .reach
            .and_then(|reach| smallness(settings, reach))
            .into_iter()
            .collect(),
        false => warnings(settings, &solved, bridge.balance),
    };
    Ok(Ending {
        warnings,
        ..ending([first, last], solved, settings)
    })
}

/// Error of a step relative to the coordinates above which a run has a warning.
const COARSE: f64 = 1e-5;

/// Coordinates below which a body at rest may be by rounding.
const NOISE: f64 = 1e-20;

/// A warning about coordinates so small that the absolute tolerance is no small part of them. `reach` is the largest absolute
/// value of a coordinate in the run.
fn smallness(settings: &Settings, reach: f64) -> Option<String> {
    let part = settings.tol / reach;
    (reach > NOISE && part > COARSE).then(|| {
        format!(
            "no coordinate exceeds {reach:.1e}, and --tol {:e} is absolute below 1: a step may have errors of {part:.0e} of the \
             coordinates; use smaller units, or a smaller --tol",
            settings.tol
        )
    })
}

/// Warnings about the accuracy of a fixed-step integrator.
fn warnings<S>(settings: &Settings, solved: &Solved<S>, balance: Option<Balance>) -> Vec<String> {
    let Some(step) = solved.step else {
        return Vec::new();
    };
    let name = settings.integrator.name();
    let mut warnings = Vec::new();
    let has_steps = solved.run.counters.accepted > 0;
    if has_steps && settings.step.is_none() && 2.0 * settings.until >= step * AUTOMATIC_STEPS {
        warnings.push(format!(
            "{name} with step {step}, the shortest that is chosen for a run of this length: errors may be above --tol {:e}; set \
             a shorter one with --step, or take an integrator of higher order",
            settings.tol
        ));
    }
    if let Some((error, t, part)) = balance.and_then(|balance| balance.told()) {
        warnings.push(format!(
            "{name} with step {step}: the energy is off by {error:.1e} at t = {t}, {part:.1e} of its size; set a shorter \
             step with --step, or take an integrator that chooses its steps, such as --integrator dop853"
        ));
    }
    warnings
}

/// The ending of a run in the names and types of the driver.
fn ending<S>([first, last]: [Point; 2], solved: Solved<S>, settings: &Settings) -> Ending {
    let Solved { run, step, laws } = solved;
    Ending {
        outcome: run.outcome,
        t: run.t,
        first,
        last,
        counters: run.counters,
        step,
        laws,
        reached: run.outcome.is_done()
            || (settings.impacts.is_some() && run.outcome == Outcome::ImpactBudget),
        warnings: Vec::new(),
    }
}

/// Runs a model from `t = 0` under an observer in the types of the model.
///
/// # Errors
/// The errors of [`simulate`].
pub(crate) fn solve<M: Model>(
    model: &M,
    state: &M::State,
    settings: &Settings,
    observer: &mut dyn Observer<M>,
) -> Result<Solved<M::State>, Refusal> {
    let tolerance = Tolerance::new(settings.tol)?;
    macro_rules! run {
        ($stepper:expr) => {{
            let mut stepper = $stepper;
            run(model, Chosen::new(&mut stepper), state, settings, observer)
        }};
    }
    match settings.integrator {
        Integrator::Dop853 => run!(limited!(Dop853::new(tolerance), settings)),
        Integrator::Dopri5 => run!(limited!(DormandPrince5::new(tolerance), settings)),
        Integrator::Taylor => run!(limited!(Taylor::new(tolerance), settings)),
        Integrator::Rk4 => run!(stepping(Rk4::new(tolerance), settings)),
        Integrator::Gauss4 => run!(stepping(Gauss4::new(tolerance), settings)),
        Integrator::Gauss6 => run!(stepping(Gauss6::new(tolerance), settings)),
        Integrator::Dla2 => run!(stepping(Dla2::new(tolerance), settings)),
        Integrator::Dla4 => run!(stepping(Dla4::new(tolerance), settings)),
    }
}

/// A fixed-step integrator with the step of the settings, if one is set.
fn stepping<S: StateVector, M: Method>(
    integrator: FixedStep<S, M>,
    settings: &Settings,
) -> FixedStep<S, M> {
    match settings.step {
        Some(step) => integrator.with_step(step),
        None => integrator,
    }
}

/// NOTE: integrator and observer are trait objects, so that the code that watches impacts is compiled once per model.
fn run<M: Model>(
    model: &M,
    stepper: Chosen<'_, M>,
    state: &M::State,
    settings: &Settings,
    mut observer: &mut dyn Observer<M>,
) -> Result<Solved<M::State>, Refusal> {
    let (effects, laws) = effects(model, settings);
    let budget = settings.steps.unwrap_or(STEP_BUDGET);
    let mut simulation = Simulation::new(model, stepper, effects).with_step_budget(budget);
    let run = simulation.run(0.0, *state, settings.until, &mut observer)?;
    Ok(Solved {
        run,
        step: simulation.fixed_step(),
        laws,
    })
}

/// The effects of a scene with the laws and policies of the settings, and the law in force on each surface.
pub(crate) fn effects<M: Instance + Scene>(
    model: &M,
    settings: &Settings,
) -> (M::Effects, Vec<Option<Law>>) {
    let mut effects = model.effects();
    for &(surface, law) in &settings.laws {
        effects.set_law(surface, law);
    }
    if settings.impacts.is_some() {
        effects.set_impact_budget(settings.impacts);
    }
    effects.set_policies(settings.policies);
    if let Some(projection) = settings.projection {
        effects.set_projection(projection);
    }
    let laws = (0..model.description().surfaces.len())
        .map(|surface| effects.law(model, surface))
        .collect();
    (effects, laws)
}

/// Forwards segments and events of the runtime to a [`Watch`].
struct Bridge<'a, M, R> {
    model: &'a M,
    reading: R,
    integrals: Integrals,
    watch: &'a mut dyn Watch,
    /// The energy balance, if the watch wants warnings about a fixed-step integrator.
    balance: Option<Balance>,
    /// The largest absolute value of a coordinate, if the watch wants warnings.
    reach: Option<f64>,
}

impl<M: Model, R: Reading<M::State>> Bridge<'_, M, R> {
    /// The values of a state, with the present values of the integrals.
    fn point(&self, t: f64, state: &M::State) -> Point {
        self.integrals.put(self.reading.point(t, state))
    }

    /// Takes note of the sizes of coordinates.
    fn follow(&mut self, q: &M::Vector) {
        if let Some(reach) = &mut self.reach {
            let sizes = q.as_slice().iter().map(|q| q.abs());
            *reach = sizes.fold(*reach, larger);
        }
    }

    /// Takes note of the sizes of the coordinates at the end of a segment and, by the cubic through both ends, in its middle:
    /// the ends of a hop are at the floor.
    fn follow_segment(&mut self, segment: &Segment<'_, M::State>) {
        if self.reach.is_none() {
            return;
        }
        let (from, to) = (segment.start(), segment.end());
        let [start, end] = [from, to].map(|state| self.model.position(state));
        self.follow(&end);
        let rates = [(segment.t_start(), from), (segment.t_end(), to)]
            .map(|(t, state)| self.model.velocity(t, state));
        let [Ok(leaving), Ok(arriving)] = rates else {
            return;
        };
        let eighth = 0.125 * (segment.t_end() - segment.t_start());
        let mut middle = end;
        for (i, middle) in middle.as_mut_slice().iter_mut().enumerate() {
            let bend = leaving.as_slice()[i] - arriving.as_slice()[i];
            *middle = 0.5 * (start.as_slice()[i] + *middle) + eighth * bend;
        }
        self.follow(&middle);
    }

    fn go_on(&self) -> ControlFlow<()> {
        match self.watch.is_over() {
            true => ControlFlow::Break(()),
            false => ControlFlow::Continue(()),
        }
    }
}

impl<M: Model, R: Reading<M::State>> Observer<M> for Bridge<'_, M, R> {
    fn step(&mut self, segment: &mut Segment<'_, M::State>) -> ControlFlow<()> {
        if let Some(balance) = &mut self.balance {
            balance.follow(self.model, segment);
        }
        self.follow_segment(segment);
        self.watch.step(&SegmentPiece {
            description: self.model.description(),
            reading: &self.reading,
            integrals: &self.integrals,
            segment: RefCell::new(&mut *segment),
        });
        self.integrals = self.integrals.at(segment.t_end(), &self.reading, segment);
        self.go_on()
    }

    fn event(&mut self, event: &Event<M::State>) -> ControlFlow<()> {
        if let Some(balance) = &mut self.balance {
            balance.jump();
        }
        let impact = Impact {
            t: event.t,
            surface: event.surface,
            before: (),
            after: (),
            simultaneous: event.simultaneous,
            graze: event.graze,
        };
        if self.watch.hears(&impact) {
            self.watch.impact(Impact {
                t: impact.t,
                surface: impact.surface,
                before: self.point(event.t, &event.before),
                after: self.point(event.t, &event.after),
                simultaneous: impact.simultaneous,
                graze: impact.graze,
            });
        }
        self.go_on()
    }

    fn hold(&mut self, hold: &Hold<M::State>) -> ControlFlow<()> {
        if let Some(balance) = &mut self.balance {
            balance.hold(hold.begins);
        }
        self.watch.contact(Contact {
            t: hold.t,
            surface: hold.surface,
            at: self.point(hold.t, &hold.state),
            begins: hold.begins,
            accumulation: hold.accumulation,
        });
        self.go_on()
    }
}

/// A segment of a run. The cell is needed because a query inside the segment prepares the dense output.
struct SegmentPiece<'a, 'b, S, R> {
    description: &'a Description,
    reading: &'a R,
    integrals: &'a Integrals,
    segment: RefCell<&'a mut Segment<'b, S>>,
}

impl<S: StateVector, R: Reading<S>> Piece for SegmentPiece<'_, '_, S, R> {
    fn span(&self) -> (f64, f64) {
        let segment = self.segment.borrow();
        (segment.t_start(), segment.t_end())
    }

    fn at(&self, t: f64) -> Point {
        let mut segment = self.segment.borrow_mut();
        match segment.at(t) {
            Ok(state) => {
                let integrals = self.integrals.at(t, self.reading, &mut segment);
                integrals.put(self.reading.point(t, &state))
            }
            Err(_) => Point::undefined(self.description),
        }
    }
}
