//! Runs whose inputs are functions of time and state.
//!
//! They run on [`Common`], so that this code is compiled only once.

use std::cell::Cell;
use std::ops::ControlFlow;

use dalembert::effects::{Moment, StepView};
use dalembert::erased;
use dalembert::forces::NoForces;
use dalembert::inputs::Steered;
use dalembert::integrate::{
    Chosen, Dop853, DormandPrince5, Gauss4, Gauss6, Rk4, Stepper, Tolerance,
};
use dalembert::simulation::STEP_BUDGET;
use dalembert::{
    Actuated, Effect, Event, Fault, Hold, Impacts, Instance, Observer, Outcome, Projection,
    SceneEffects, Segment, Simulation, StateVector, System, VectorField,
};

use super::{Bridge, Ending, Integrals, Reading, Settings, Solved, Watch, ending, stepping};
use crate::integrator::{Form, Integrator};
use crate::model::{Origin, Point, point};
use crate::owner::Common;
use crate::refusal::Refusal;
use crate::typed::prepare;

/// The state of that system.
type State<'f> = <Common<'f> as VectorField>::State;

/// Values of all inputs.
type Inputs = <Common<'static> as Actuated>::Inputs;

/// The system with inputs from a function.
type Driven<'f, 'c> = Steered<Common<'f>, &'c dyn Fn(f64, &State<'f>) -> Inputs>;

/// Values of all inputs, in order, from time, positions and velocities.
pub type InputFunction<'c> = dyn Fn(f64, &[f64], &[f64]) -> Vec<f64> + 'c;

/// Inputs as functions of time, positions and velocities.
pub struct Control<'c> {
    /// Values of all inputs, in order. The velocities of a first-order system are its rates with the stored values of
    /// the inputs.
    pub inputs: &'c InputFunction<'c>,
    /// The times at which the inputs change.
    pub changes: Changes<'c>,
}

/// Times at which inputs change.
#[derive(Debug, Clone, Copy)]
pub enum Changes<'c> {
    /// Inputs are evaluated wherever the motion is evaluated.
    Everywhere,
    /// Inputs are evaluated at multiples of this period, and constant in between.
    Held(f64),
    /// Inputs are evaluated wherever the motion is evaluated. They are smooth between these times, at which steps end.
    /// The cell holds the number of times that have passed.
    Pieces(&'c [f64], &'c Cell<usize>),
}

/// Makes a run with these inputs, as [`Runs::simulate`](crate::Runs::simulate) does. `values` are the values of all
/// parameters. Returns `None` for a form that is too large, and for `Taylor` and discrete principles, which do not
/// support input functions.
///
/// # Errors
/// [`Refusal`] if the run does not start.
// NOTE: a function and not a method of `Runs`, so that a program that does not call it is linked without it.
pub fn steer(
    form: &erased::Form,
    values: &[f64],
    origin: &Origin,
    settings: &Settings,
    control: &Control<'_>,
    watch: &mut dyn Watch,
) -> Option<Result<Ending, Refusal>> {
    let mut model = Common::of(form).ok()?;
    for (index, value) in values.iter().enumerate() {
        model.set_parameter(index, *value);
    }
    let system = match settings.form {
        Form::Reduced => model,
        Form::Global => model.global()?,
    };
    let state = match prepare(|| Ok(model), &system, 0.0, origin) {
        Ok(state) => state,
        Err(error) => return Some(Err(error.into())),
    };
    let taken = |t: f64, state: &State<'_>| -> Inputs {
        let q = system.position(state);
        let qdot = system.velocity(t, state).unwrap_or_else(|_| {
            let mut unknown = q;
            unknown.as_mut_slice().fill(f64::NAN);
            unknown
        });
        let values = (control.inputs)(t, StateVector::as_slice(&q), StateVector::as_slice(&qdot));
        let mut inputs = Inputs::all(values.len(), 0.0);
        inputs
            .as_mut()
            .iter_mut()
            .zip(&values)
            .for_each(|(entry, value)| *entry = *value);
        inputs
    };
    let held = Cell::new(Inputs::all(0, 0.0));
    let kept = |_: f64, _: &State<'_>| held.get();
    let clock = Clock {
        changes: control.changes,
        next: 0,
        due: None,
        held: &held,
        taken: &taken,
    };
    let clock = (!matches!(control.changes, Changes::Everywhere)).then_some(clock);
    let steered = Steered {
        system,
        inputs: match control.changes {
            Changes::Held(_) => &kept as &dyn Fn(f64, &State<'_>) -> Inputs,
            Changes::Everywhere | Changes::Pieces(..) => &taken,
        },
    };
    run_chosen(&steered, state, settings, clock, watch)
}

/// Makes the run with the integrator of the settings.
fn run_chosen<'f>(
    steered: &Driven<'f, '_>,
    state: State<'f>,
    settings: &Settings,
    clock: Option<Clock<'_, 'f>>,
    watch: &mut dyn Watch,
) -> Option<Result<Ending, Refusal>> {
    let tolerance = match Tolerance::new(settings.tol) {
        Ok(tolerance) => tolerance,
        Err(error) => return Some(Err(error.into())),
    };
    let longest = settings.max_step.unwrap_or(f64::INFINITY);
    macro_rules! run {
        ($stepper:expr) => {{
            let mut stepper = $stepper;
            let stepper = Chosen::new(&mut stepper);
            run(steered, stepper, state, settings, clock, watch)
        }};
        (limited $stepper:expr) => {
            match $stepper.with_max_step(longest) {
                Ok(stepper) => run!(stepper),
                Err(error) => Err(error.into()),
            }
        };
    }
    Some(match settings.integrator {
        Integrator::Dop853 => run!(limited Dop853::new(tolerance)),
        Integrator::Dopri5 => run!(limited DormandPrince5::new(tolerance)),
        Integrator::Rk4 => run!(stepping(Rk4::new(tolerance), settings)),
        Integrator::Gauss4 => run!(stepping(Gauss4::new(tolerance), settings)),
        Integrator::Gauss6 => run!(stepping(Gauss6::new(tolerance), settings)),
        Integrator::Taylor | Integrator::Dla2 | Integrator::Dla4 => return None,
    })
}

fn run<'f, 'c>(
    steered: &Driven<'f, 'c>,
    stepper: Chosen<'_, Driven<'f, 'c>>,
    state: State<'f>,
    settings: &Settings,
    clock: Option<Clock<'_, 'f>>,
    watch: &mut dyn Watch,
) -> Result<Ending, Refusal> {
    let plain = &steered.system;
    let tables = &plain.form().tables;
    let mut impacts = (tables.dimensions.surfaces > 0).then(|| Impacts::declared(steered));
    for &(surface, law) in &settings.laws {
        impacts.set_law(surface, law);
    }
    if settings.impacts.is_some() {
        impacts.set_impact_budget(settings.impacts);
    }
    impacts.set_policies(settings.policies);
    let mut projection = tables.drifts.then(Projection::new);
    if let Some(on) = settings.projection {
        projection.set_projection(on);
    }
    let laws = (0..plain.description().surfaces.len())
        .map(|surface| impacts.law(steered, surface))
        .collect();
    let mut bridge = Driver(Bridge {
        model: plain,
        reading: Given(steered),
        integrals: Integrals::of(plain),
        watch,
        balance: None,
        reach: None,
    });
    let first = bridge.0.point(0.0, &state);
    let budget = settings.steps.unwrap_or(STEP_BUDGET);
    let effects = (projection, impacts, clock);
    let mut simulation = Simulation::new(steered, stepper, effects).with_step_budget(budget);
    let run = simulation.run(0.0, state, settings.until, &mut bridge)?;
    let ends = [first, bridge.0.point(run.t, &run.state)];
    let step = simulation.fixed_step();
    Ok(ending(ends, Solved { run, step, laws }, settings))
}

/// Observer of the system with input functions that forwards to an observer of the system without them.
struct Driver<'a, 'f, R>(Bridge<'a, Common<'f>, R>);

/// The values at states, with the inputs at these states.
struct Given<'a, 'f, 'c>(&'a Driven<'f, 'c>);

impl<'f> Reading<State<'f>> for Given<'_, 'f, '_> {
    fn point(&self, t: f64, state: &State<'f>) -> Point {
        point(&self.0.at(t, state), t, state)
    }

    fn outputs(&self, t: f64, state: &State<'f>, values: &mut [f64]) -> Result<(), Fault> {
        Instance::outputs(&self.0.at(t, state), t, state, values)
    }
}

impl<'f, 'c, R: Reading<State<'f>>> Observer<Driven<'f, 'c>> for Driver<'_, 'f, R> {
    fn step(&mut self, segment: &mut Segment<'_, State<'f>>) -> ControlFlow<()> {
        Observer::<Common<'f>>::step(&mut self.0, segment)
    }

    fn event(&mut self, event: &Event<State<'f>>) -> ControlFlow<()> {
        Observer::<Common<'f>>::event(&mut self.0, event)
    }

    fn hold(&mut self, hold: &Hold<State<'f>>) -> ControlFlow<()> {
        Observer::<Common<'f>>::hold(&mut self.0, hold)
    }
}

/// Effect that changes the inputs at given times, and ends steps there.
#[derive(Clone, Copy)]
struct Clock<'c, 'f> {
    changes: Changes<'c>,
    /// Number of changes that have passed.
    next: usize,
    /// The fraction of the present step at which the next change is due.
    due: Option<f64>,
    held: &'c Cell<Inputs>,
    taken: &'c dyn Fn(f64, &State<'f>) -> Inputs,
}

impl<'f> Clock<'_, 'f> {
    /// The time of the next change.
    fn time(&self) -> f64 {
        match self.changes {
            Changes::Everywhere => f64::INFINITY,
            Changes::Held(period) => (self.next + 1) as f64 * period,
            Changes::Pieces(times, _) => times.get(self.next).copied().unwrap_or(f64::INFINITY),
        }
    }

    /// Changes the inputs.
    fn change(&self, t: f64, state: &State<'f>) {
        match self.changes {
            Changes::Everywhere => {}
            Changes::Held(_) => self.held.set((self.taken)(t, state)),
            Changes::Pieces(_, passed) => passed.set(self.next),
        }
    }
}

impl<'f, 'c> Effect<Driven<'f, 'c>> for Clock<'_, 'f> {
    type Forces = NoForces;

    fn begin<O: Observer<Driven<'f, 'c>>>(
        &mut self,
        now: &mut Moment<'_, Driven<'f, 'c>>,
        _: &mut O,
    ) -> Result<(), Outcome> {
        if let Changes::Pieces(times, _) = self.changes {
            self.next = times.partition_point(|time| *time <= now.t);
        }
        self.change(now.t, now.state);
        Ok(())
    }

    fn propose<Step: Stepper<Driven<'f, 'c>>>(
        &mut self,
        step: &mut StepView<'_, Driven<'f, 'c>, Step>,
    ) -> Result<Option<f64>, Outcome> {
        let time = self.time();
        let theta = ((time - step.t_start()) / step.length()).max(f64::EPSILON);
        self.due = (time <= step.t_end()).then_some(theta.min(1.0));
        Ok(self.due)
    }

    fn act<O: Observer<Driven<'f, 'c>>>(
        &mut self,
        theta: f64,
        now: &mut Moment<'_, Driven<'f, 'c>>,
        _: &mut O,
    ) -> Result<(), Outcome> {
        if self.due.take() == Some(theta) {
            self.next += 1;
            self.change(now.t, now.state);
        }
        Ok(())
    }
}
