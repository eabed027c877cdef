//! Derivatives of a run with respect to its start and its parameters, across impacts, as plain data.
//!
//! They are computed on the erased system of the largest capacity, so that this code is compiled only once.

use std::ops::ControlFlow;

use dalembert::contract::{TaylorField, Variational};
use dalembert::describe::{Description, VariationalVisitor};
use dalembert::erased::{self, Excess};
use dalembert::integrate::{Chosen, Dop853, DormandPrince5, Stepper, Taylor, Tolerance};
use dalembert::numbers::{Numbers, Row};
use dalembert::simulation::STEP_BUDGET;
use dalembert::variations::{Dual, Tangent};
use dalembert::{
    Event, Fault, Hold, Instance, Observer, Outcome, Scene, Segment, Simulation, StateError,
    StateVector, System as _, Undefined, Variations,
};
use thiserror::Error;

use crate::integrator::{Form, Integrator};
use crate::model::Origin;
use crate::names::{self, Unknown};
use crate::owner::Common;
use crate::refusal::Refusal;
use crate::run::{Settings, effects};
use crate::typed::{global, prepare};

/// A variable of differentiation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Variable {
    /// An initial coordinate.
    Position(usize),
    /// An initial velocity, by the index of its coordinate. The constraints determine the dependent velocities.
    Velocity(usize),
    /// An initial quasi-velocity.
    Quasi(usize),
    /// A parameter. The initial positions and velocities, or quasi-velocities in the reduced form, stay constant.
    Parameter(usize),
}

/// The derivatives of the last state.
#[derive(Debug, Clone)]
pub struct Derivatives {
    /// The time of the last state.
    pub t: f64,
    /// Derivatives of all positions, one vector per variable.
    pub q: Vec<Vec<f64>>,
    /// Derivatives of all velocities, one vector per variable.
    pub qdot: Vec<Vec<f64>>,
}

/// Reasons why a run has no derivatives.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
#[non_exhaustive]
pub enum VariationError {
    /// The form exceeds the capacity for derivatives.
    #[error("derivatives: the model has {0} in this computation")]
    Large(Excess),
    /// The scene was declared without `variations`.
    #[error("the scene was declared without `variations`; add it to what the scene uses")]
    WithoutVariations,
    /// The integrator has a fixed step.
    #[error("derivatives need the integrator dop853, dopri5 or taylor")]
    FixedStep,
    /// The model has modes with constraints or frames.
    #[error("derivatives of a model with modes need modes without constraints and frames")]
    Modes,
    /// The mode in which the run begins does not have this coordinate.
    #[error("the mode in which the run begins does not have this coordinate")]
    Absent {
        /// The coordinate.
        coordinate: usize,
    },
    /// The form is the global one and the model has constraints.
    #[error("derivatives of a model with constraints need its reduced form")]
    Constrained,
    /// The constraints determine this velocity from the others.
    #[error("the velocity of this coordinate follows from the others")]
    Dependent {
        /// The coordinate.
        coordinate: usize,
    },
    /// The run ends before its time.
    #[error("the run ends before its time: {0}")]
    Ended(Outcome),
    /// The run has no derivative.
    #[error(transparent)]
    Undefined(#[from] Undefined),
}

impl VariationError {
    /// The reason why no run with these settings has derivatives, if there is one.
    fn beforehand(description: &Description, settings: &Settings) -> Option<Self> {
        let is_free = description.constraints.is_empty();
        match settings.form {
            Form::Reduced if !description.modes.is_empty() => Some(Self::Modes),
            Form::Global if !is_free => Some(Self::Constrained),
            _ if !settings.integrator.is_adaptive() => Some(Self::FixedStep),
            _ => None,
        }
    }
}

impl From<Fault> for VariationError {
    fn from(fault: Fault) -> Self {
        Self::Undefined(fault.into())
    }
}

impl Variable {
    /// The coordinate of the variable, if the mode does not have it.
    fn absent(self, description: &Description, mode: usize) -> Option<usize> {
        let (Self::Position(coordinate) | Self::Velocity(coordinate)) = self else {
            return None;
        };
        let mode = description.modes.get(mode)?;
        (!mode.coordinates.contains(&coordinate)).then_some(coordinate)
    }

    /// The variable with this name: a coordinate, a velocity, a quasi-velocity of the reduced form, or a parameter.
    ///
    /// # Errors
    /// [`Unknown`] if no variable has this name.
    pub fn find(description: &Description, name: &str) -> Result<Self, Unknown> {
        let coordinates = names::coordinates(description).enumerate();
        let velocities = coordinates
            .clone()
            .map(|(index, name)| (names::velocity(name), Self::Velocity(index)));
        let quasi = description.quasi_velocities.iter().enumerate();
        let quasi = quasi.map(|(index, name)| ((*name).to_owned(), Self::Quasi(index)));
        let parameters = description.parameters.iter().enumerate();
        let parameters = parameters.map(|(index, it)| (it.name.to_owned(), Self::Parameter(index)));
        let all: Vec<(String, Self)> = coordinates
            .map(|(index, name)| (name.to_owned(), Self::Position(index)))
            .chain(quasi)
            .chain(velocities.filter(|_| !description.is_first_order))
            .chain(parameters)
            .collect();
        let accepted = all.iter().map(|(name, _)| name.as_str());
        let index = names::find("coordinate, velocity or parameter", name, accepted)?;
        Ok(all[index].1)
    }
}

/// Derivatives of the last state of a run with respect to these variables. `values` are the values of all parameters,
/// inputs included. The run begins in the mode with the number `mode`. It is abandoned once `is_over` returns true.
///
/// # Errors
/// [`Refusal`] if the run does not start. The inner error says why it has no derivatives.
// NOTE: a function and not a method of `Runs`, so that a program that does not call it is linked without it.
pub fn differentiate(
    form: &erased::Form,
    (values, mode): (&[f64], usize),
    origin: &Origin,
    settings: &Settings,
    variables: &[Variable],
    is_over: &mut dyn FnMut() -> bool,
) -> Varied {
    let description = &form.documentation.description;
    if let Some(error) = VariationError::beforehand(description, settings) {
        return Ok(Err(error));
    }
    let mut model = match Common::of(form) {
        Ok(model) => model,
        Err(excess) => return Ok(Err(VariationError::Large(excess))),
    };
    for (index, value) in values.iter().enumerate() {
        model.set_parameter(index, *value);
    }
    model.set_mode(mode);
    let absent = variables.iter().find_map(|it| it.absent(description, mode));
    if let Some(coordinate) = absent {
        return Ok(Err(VariationError::Absent { coordinate }));
    }
    let system = match settings.form {
        Form::Reduced => model,
        Form::Global => global(&model).map_err(StateError::from)?,
    };
    let state = prepare(|| Ok(model), &system, 0.0, origin)?;
    let q = system.position(&state);
    let qdot = system.velocity(0.0, &state).map_err(StateError::from)?;
    let differentiator = Differentiator {
        variables,
        settings,
        state: StateVector::as_slice(&state),
        q: StateVector::as_slice(&q),
        qdot: StateVector::as_slice(&qdot),
        is_over,
    };
    let varied = system.visit_variational(differentiator);
    varied.unwrap_or(Ok(Err(VariationError::WithoutVariations)))
}

/// Visitor that differentiates a run of any system.
struct Differentiator<'a> {
    variables: &'a [Variable],
    settings: &'a Settings,
    /// The state in the form of the settings.
    state: &'a [f64],
    /// Positions and velocities of that state.
    q: &'a [f64],
    qdot: &'a [f64],
    /// Returns true once the caller abandons the run.
    is_over: &'a mut dyn FnMut() -> bool,
}

/// Result of a differentiator. The inner error says why there are no derivatives, the outer one why no run starts.
type Varied = Result<Result<Derivatives, VariationError>, Refusal>;

impl VariationalVisitor for Differentiator<'_> {
    type Output = Varied;

    fn visit<S: Instance + Scene + Variational>(self, system: &S) -> Varied {
        let tolerance = Tolerance::new(self.settings.tol)?;
        let longest = self.settings.max_step.unwrap_or(f64::INFINITY);
        match self.settings.integrator {
            Integrator::Dop853 => {
                let mut stepper = Dop853::new(tolerance).with_max_step(longest)?;
                self.differentiate(system, &mut stepper)
            }
            Integrator::Dopri5 => {
                let mut stepper = DormandPrince5::new(tolerance).with_max_step(longest)?;
                self.differentiate(system, &mut stepper)
            }
            Integrator::Taylor => {
                let mut stepper = Taylor::new(tolerance).with_max_step(longest)?;
                self.differentiate(system, &mut stepper)
            }
            _ => Ok(Err(VariationError::FixedStep)),
        }
    }
}

impl Differentiator<'_> {
    fn differentiate<S: Instance + Scene + Variational>(
        self,
        system: &S,
        stepper: &mut impl Stepper<S>,
    ) -> Varied {
        let directions = self.variables.iter();
        let directions: Result<Vec<Tangent<S>>, _> = directions
            .map(|variable| self.direction(system, *variable))
            .collect();
        let mut tangents = match directions {
            Ok(tangents) => tangents,
            Err(error) => return Ok(Err(error)),
        };
        let mut state = system.zero_state();
        state.as_mut_slice().copy_from_slice(self.state);
        let (effects, _) = effects(system, self.settings);
        let mut observer = Interruptible {
            variations: Variations::new(system, &mut tangents),
            is_over: self.is_over,
        };
        let observing: &mut dyn Observer<S> = &mut observer;
        let budget = self.settings.steps.unwrap_or(STEP_BUDGET);
        let mut simulation =
            Simulation::new(system, Chosen::new(stepper), effects).with_step_budget(budget);
        let until = self.settings.until;
        let run = simulation.run(0.0, state, until, &mut { observing })?;
        if run.outcome != Outcome::Done {
            return Ok(Err(VariationError::Ended(run.outcome)));
        }
        let carried = observer.variations.tangents();
        Ok(carried
            .map_err(VariationError::from)
            .and_then(|tangents| derivatives(system, run.t, &run.state, tangents)))
    }

    /// The tangent vector of a variable, in state and parameters.
    fn direction<S: Instance + Variational>(
        &self,
        system: &S,
        variable: Variable,
    ) -> Result<Tangent<S>, VariationError> {
        let n = self.q.len();
        let is_reduced = self.settings.form == Form::Reduced;
        match variable {
            Variable::Position(index) if is_reduced => Ok(Tangent::of_component(index)),
            Variable::Parameter(index) if is_reduced => Ok(Tangent::of_parameter(index)),
            Variable::Quasi(index) if is_reduced => Ok(Tangent::of_component(n + index)),
            Variable::Quasi(_) => Err(VariationError::Constrained),
            _ => self.composed(system, variable),
        }
    }

    /// The tangent vector of a variable, for a state that is computed from positions and velocities.
    fn composed<S: Instance + Variational>(
        &self,
        system: &S,
        variable: Variable,
    ) -> Result<Tangent<S>, VariationError> {
        let parameter = match variable {
            Variable::Parameter(index) => Tangent::of_parameter(index),
            _ => Tangent::zero(),
        };
        let mut q = constant::<S::Configuration<Dual>>(self.q);
        let mut qdot = constant::<S::Configuration<Dual>>(self.qdot);
        match variable {
            Variable::Position(index) => change(&mut q, index),
            Variable::Velocity(index) => change(&mut qdot, index),
            _ => {}
        }
        let parameters = parameters_along(system, &parameter);
        let state = system.composed(&parameters, Dual::of(0.0), &q, &qdot)?;
        let mut tangent = parameter;
        for (entry, value) in tangent
            .state
            .as_mut_slice()
            .iter_mut()
            .zip(state.as_slice())
        {
            *entry = value.slopes()[0];
        }
        if let Variable::Velocity(coordinate) = variable {
            let reached = system.velocities(&parameters, Dual::of(0.0), &state)?;
            // If the constraints determine the velocity, its derivative with respect to the given value is not 1.
            if (reached.as_slice()[coordinate].slopes()[0] - 1.0).abs() > 1e-9 {
                return Err(VariationError::Dependent { coordinate });
            }
        }
        Ok(tangent)
    }
}

/// A row of constants: dual numbers with derivative 0.
pub(crate) fn constant<R: Row<Dual>>(values: &[f64]) -> R {
    let mut row = R::zeros(values.len());
    for (entry, value) in row.as_mut_slice().iter_mut().zip(values) {
        *entry = Dual::of(*value);
    }
    row
}

/// Sets the derivative of one number to 1.
fn change<R: Row<Dual>>(row: &mut R, index: usize) {
    let entry = &mut row.as_mut_slice()[index];
    *entry = Dual::new(entry.value, [1.0, 0.0, 0.0, 0.0]);
}

/// The parameters, with their derivatives along a direction.
fn parameters_along<S: Variational>(system: &S, tangent: &Tangent<S>) -> S::Parameters<Dual> {
    let values = TaylorField::parameters(system);
    let mut row = constant::<S::Parameters<Dual>>(values.as_slice());
    let slopes = tangent.parameters.as_slice().iter();
    for (entry, slope) in row.as_mut_slice().iter_mut().zip(slopes) {
        *entry = Dual::new(entry.value, [*slope, 0.0, 0.0, 0.0]);
    }
    row
}

/// Derivatives of positions and velocities, from the derivatives of the state.
fn derivatives<S: Instance + Variational>(
    system: &S,
    t: f64,
    state: &S::State,
    tangents: &[Tangent<S>],
) -> Result<Derivatives, VariationError> {
    let n = system.coordinate_count();
    let mut found = Derivatives {
        t,
        q: Vec::new(),
        qdot: Vec::new(),
    };
    for tangent in tangents {
        let mut row = constant::<S::Row<Dual>>(StateVector::as_slice(state));
        let slopes = tangent.state.as_slice().iter();
        for (entry, slope) in row.as_mut_slice().iter_mut().zip(slopes) {
            *entry = Dual::new(entry.value, [*slope, 0.0, 0.0, 0.0]);
        }
        let parameters = parameters_along(system, tangent);
        let qdot = system.velocities(&parameters, Dual::of(t), &row)?;
        let slope = |value: &Dual| value.slopes()[0];
        // Positions are components of the state. The mode determines their indices.
        let mut moved = tangent.state;
        if !system.description().modes.is_empty()
            && let Some((last, mode)) = moved
                .as_mut_slice()
                .last_mut()
                .zip(StateVector::as_slice(state).last())
        {
            *last = *mode;
        }
        let positions = system.position(&moved);
        found
            .q
            .push(StateVector::as_slice(&positions)[..n].to_vec());
        found
            .qdot
            .push(qdot.as_slice()[..n].iter().map(slope).collect());
    }
    Ok(found)
}

/// Variations of a run that the caller may abandon.
struct Interruptible<'a, 'b, S: Variational> {
    variations: Variations<'a, S>,
    is_over: &'b mut dyn FnMut() -> bool,
}

impl<S: Variational> Observer<S> for Interruptible<'_, '_, S> {
    fn step(&mut self, segment: &mut Segment<'_, S::State>) -> ControlFlow<()> {
        match (self.is_over)() {
            true => ControlFlow::Break(()),
            false => self.variations.step(segment),
        }
    }

    fn event(&mut self, event: &Event<S::State>) -> ControlFlow<()> {
        self.variations.event(event)
    }

    fn hold(&mut self, hold: &Hold<S::State>) -> ControlFlow<()> {
        self.variations.hold(hold)
    }
}
