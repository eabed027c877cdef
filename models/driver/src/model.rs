//! Object-safe traits of a model with an erased type.

use dalembert::describe::{Description, Instance, Report};
use dalembert::jet::Work;
use dalembert::law::Law;
use dalembert::{Fault, OrbitError, ParameterError, StateError, StateVector};

use crate::accuracy::{Plan, Study, Verified};
use crate::certify::{Certification, Certified, Strike};
use crate::connect::{Boundary, Connected, Stage, Unjoined};
use crate::continuation::{Branch, Continuation, Member};
use crate::control::{Controlled, Task, Unsought};
use crate::dynamic::{Landing, Leg, Unlanded};
use crate::integrator::Form;
use crate::linearisation::{Linearisation, Place, Unlinear};
use crate::orbit::{Found, Growth, Search};
use crate::refusal::Refusal;
use crate::run::{Control, Ending, Settings, Watch};

/// Velocities or momenta, one per coordinate.
#[derive(Debug, Clone, PartialEq)]
pub enum Rates {
    /// qdot.
    Velocities(Vec<f64>),
    /// p.
    Momenta(Vec<f64>),
}

/// Policy for positions or velocities that violate the constraints.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum OffConstraint {
    /// Refuse them if the residual exceeds 1e-9 of the sum of the absolute values of the constraint's terms.
    Error,
    /// Replace the positions by nearby allowed ones, and the velocity by the nearest allowed one in the metric.
    Project,
    /// Start there; the residual persists along the motion.
    Keep,
}

impl OffConstraint {
    /// All policies.
    pub const fn every() -> &'static [Self] {
        &[Self::Error, Self::Project, Self::Keep]
    }

    /// The name on the command line and in files.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Error => "error",
            Self::Project => "project",
            Self::Keep => "keep",
        }
    }

    /// The setting of the projection onto the constraints after each step, from the one that is `wanted`; `None` for the
    /// default of the scene. [`Self::Keep`] does not project by itself: the residual would be lost after one step.
    #[must_use]
    pub fn projection(self, wanted: Option<bool>) -> Option<bool> {
        wanted.or((self == Self::Keep).then_some(false))
    }
}

/// A given state, before its checks.
#[derive(Debug, Clone)]
pub struct Origin {
    /// Positions, one per coordinate.
    pub q: Vec<f64>,
    /// Velocities or momenta.
    pub rates: Rates,
    /// Policy if it is off the constraints.
    pub policy: OffConstraint,
}

/// The declared initial condition.
#[derive(Debug, Clone)]
pub struct Start {
    /// Positions, one per coordinate.
    pub q: Vec<f64>,
    /// Velocities, one per coordinate.
    pub qdot: Vec<f64>,
    /// True for each position that is given; holonomic constraints may determine the others.
    pub placed: Vec<bool>,
    /// True for each velocity that is given; the constraints may determine the others.
    pub named: Vec<bool>,
    /// The declared end of a run.
    pub until: Option<f64>,
}

/// Values of a state for tables and plots; NaN if a quantity does not exist.
#[derive(Debug, Clone, PartialEq)]
pub struct Point {
    /// The name of the mode; `None` for a model without modes.
    pub mode: Option<&'static str>,
    /// Positions, one per coordinate.
    pub q: Vec<f64>,
    /// Velocities, one per coordinate.
    pub qdot: Vec<f64>,
    /// Momenta, one per coordinate.
    pub p: Vec<f64>,
    /// Kinetic plus potential energy.
    pub energy: f64,
    /// The declared outputs, in order. Integrals are taken from the start of the run.
    pub outputs: Vec<f64>,
    /// The point that the declared view shows.
    pub view: Option<[f64; 2]>,
}

impl Point {
    /// A point whose values are all undefined.
    pub fn undefined(description: &Description) -> Self {
        let nothing = vec![f64::NAN; description.coordinates.len()];
        Self {
            mode: None,
            q: nothing.clone(),
            qdot: nothing.clone(),
            p: nothing,
            energy: f64::NAN,
            outputs: vec![f64::NAN; description.outputs.len()],
            view: None,
        }
    }
}

/// A model with values for its parameters. States are those of its global form, positions and momenta.
pub trait AnyModel: Runs {
    /// Kind of code behind the functions of the model.
    fn code(&self) -> Code;
    /// Names, shapes and documentation of the declared quantities.
    fn description(&self) -> &Description;
    /// The names of the inputs. Their values are parameters that follow those of the description.
    fn inputs(&self) -> &[&'static str];
    /// The value of a parameter. Inputs follow the parameters of the description.
    fn parameter(&self, index: usize) -> f64;
    /// Sets a parameter. Its value is checked when a state is made.
    fn set_parameter(&mut self, index: usize, value: f64);
    /// The work of expansions in this form; `None` if it is not known.
    fn work(&self, form: Form) -> Option<Work>;
    /// Sets the mode, by number, of states that are created after this call.
    fn set_mode(&mut self, mode: usize);
    /// The name of the mode in which states are made; `None` if [`mode_alone`](Self::mode_alone) returns `None`.
    fn present_mode(&self) -> Option<&'static str>;

    /// True if the equations, the surfaces or the resets may depend on time.
    fn depends_on_time(&self) -> bool;
    /// The mode in which states are made, as a model of its own with the same values of parameters; its runs end at transitions.
    /// `None` for a model without modes, and for a model without a form.
    fn mode_alone(&self) -> Option<Box<dyn AnyModel>>;
    /// Checks the parameters against their declaration.
    ///
    /// # Errors
    /// [`ParameterError`] for the first parameter whose value violates the declaration.
    fn check_parameters(&self) -> Result<(), ParameterError>;
    /// The declared initial condition.
    fn initial(&self) -> Start;
    /// Completes positions: holonomic constraints determine the positions that are not `placed`.
    fn complete_position(&self, q: &[f64], placed: &[bool]) -> Result<Vec<f64>, StateError>;
    /// Completes velocities: the constraints determine the velocities that are not `named`.
    fn complete_velocity(
        &self,
        q: &[f64],
        qdot: &[f64],
        named: &[bool],
    ) -> Result<Vec<f64>, StateError>;
    /// The state `(q, p)` of the global form.
    ///
    /// # Errors
    /// [`StateError`] under the same conditions as for the start of a run.
    fn state(&self, t: f64, origin: &Origin) -> Result<Vec<f64>, StateError>;
    /// The values of a given state at `t = 0`, declared outputs included.
    ///
    /// # Errors
    /// [`StateError`] under the same conditions as for the start of a run.
    fn point(&self, origin: &Origin) -> Result<Point, StateError>;
    /// The declared outputs at a time, positions and velocities; NaN for integrals along a run. `None` if the outputs
    /// do not exist there.
    fn outputs(&self, t: f64, q: &[f64], qdot: &[f64]) -> Option<Vec<f64>>;
    /// The function of the declared region, positive where motion is allowed; `None` if no region is declared.
    fn region(&self, t: f64, q: &[f64]) -> Option<f64>;
    /// Reports every derived quantity at a state of the global form.
    ///
    /// # Errors
    /// [`Fault`] if a quantity does not exist there.
    fn inspect(&self, t: f64, state: &[f64], report: &mut dyn Report) -> Result<(), Fault>;
    /// The law that a surface declares.
    fn law(&self, surface: usize) -> Option<Law>;
    /// The state of the global form after an impact with this law.
    ///
    /// # Errors
    /// [`Fault::NotDerived`] if the model has no global form.
    fn impact(&self, state: &[f64], contact: &Contacted, law: Law) -> Result<Vec<f64>, Fault>;
    /// The state of the global form after an impulse on its momenta.
    ///
    /// # Errors
    /// Same as [`AnyModel::impact`].
    fn kick(&self, state: &[f64], impulse: &[f64]) -> Result<Vec<f64>, Fault>;
}

/// The runs of a model with values for its parameters.
pub trait Runs {
    /// Makes a run from `t = 0`, observed by a watch.
    ///
    /// # Errors
    /// [`Refusal`] if the run does not start.
    fn simulate(
        &self,
        origin: &Origin,
        settings: &Settings,
        watch: &mut dyn Watch,
    ) -> Result<Ending, Refusal>;
    /// Makes a run with inputs that are functions of time and state. `None` for a model without a form, and in the
    /// cases of [`steer`](crate::steer).
    ///
    /// # Errors
    /// [`Refusal`] if the run does not start.
    fn steer(
        &self,
        origin: &Origin,
        settings: &Settings,
        control: &Control<'_>,
        watch: &mut dyn Watch,
    ) -> Option<Result<Ending, Refusal>>;
    /// Makes several runs at once in SIMD lanes, with Taylor series. Otherwise the same as [`Runs::simulate`] for each
    /// run. `looks_inside` is true if watches evaluate states inside steps.
    fn simulate_abreast(
        &self,
        runs: Vec<Together<'_>>,
        settings: &Settings,
        looks_inside: bool,
    ) -> Vec<Result<Ending, Refusal>>;
    /// Measures error and cost of integrators in runs from this state. Calls `tell` before each measurement.
    fn study(
        &self,
        origin: &Origin,
        base: &Settings,
        plan: &Plan,
        tell: &mut dyn FnMut(&str),
    ) -> Result<Study, Refusal>;
    /// Measures the error of the run that ended with `ending`.
    fn verify(
        &self,
        origin: &Origin,
        settings: &Settings,
        ending: &Ending,
    ) -> Result<Verified, Refusal>;
    /// Finds a periodic orbit near the first arrival at the section from this state; `None` for a scene without
    /// variations.
    fn orbit(
        &self,
        origin: &Origin,
        search: &Search,
    ) -> Result<Option<Result<Found, OrbitError>>, Refusal>;
    /// Continues the periodic orbit near the first arrival from this state in a parameter, and reports the points of
    /// the branch as they are found; `None` for a scene without variations. If the model's value of the parameter is
    /// outside the range, the orbit is first continued to the nearest end of the range. If it does not reach the range,
    /// the branch has no points.
    fn branch(
        &self,
        origin: &Origin,
        search: &Search,
        request: &Continuation,
        watch: &mut dyn FnMut(&Member),
    ) -> Result<Option<Result<Branch, OrbitError>>, Refusal>;
    /// The first arrival at the section after this state, and the return of the search from there; `None` for a scene
    /// without variations.
    fn returned(
        &self,
        origin: &Origin,
        search: &Search,
    ) -> Result<Option<Result<[Point; 2], OrbitError>>, Refusal>;
    /// The largest Lyapunov exponent per return, from the first arrival after this state. `None` for a scene without
    /// variations.
    fn exponent(
        &self,
        origin: &Origin,
        search: &Search,
        growth: Growth,
    ) -> Result<Option<Result<f64, OrbitError>>, Refusal>;
    /// Searches for all motions between two configurations; `None` for a scene without variations. Calls `tell` with
    /// the progress.
    ///
    /// # Errors
    /// [`Refusal`] for a start that the system refuses. The inner error explains why the search is not possible.
    fn connect(
        &self,
        boundary: &Boundary,
        tell: &mut dyn FnMut(Stage),
    ) -> Result<Option<Result<Connected, Unjoined>>, Refusal>;
    /// Linearises the equations of motion at this state, or at an equilibrium near it; `None` for a scene without variations.
    ///
    /// # Errors
    /// [`Refusal`] for a state that the system refuses. The inner error explains why there is no linearisation.
    fn linearise(
        &self,
        origin: &Origin,
        place: &Place,
    ) -> Result<Option<Result<Linearisation, Unlinear>>, Refusal>;
    /// Searches for all extremals of a model of extremals; `None` for a scene without variations. Calls `tell` with the
    /// progress.
    ///
    /// # Errors
    /// [`Refusal`] for a start that the system refuses. The inner error explains why the search is not possible.
    fn control(
        &self,
        task: &Task,
        tell: &mut dyn FnMut(Stage),
    ) -> Result<Option<Result<Controlled, Unsought>>, Refusal>;
    /// Computes the motion over one step from each of these states with each of the inputs, for a model with held
    /// inputs; `None` for a scene without variations. A motion that does not reach the end of the step is
    /// [`Unlanded`].
    ///
    /// # Errors
    /// [`Refusal`] for parameters that violate the declaration.
    fn legs(
        &self,
        leg: &Leg<'_>,
        from: &[[f64; 2]],
    ) -> Result<Option<Vec<Result<Landing, Unlanded>>>, Refusal>;
    /// Encloses the motion from this state on, and reports its impacts.
    ///
    /// # Errors
    /// [`Refusal`] if no motion of the model can be certified. [`Certified::lost`] explains an early end of the
    /// certification.
    fn certify(
        &self,
        origin: &Origin,
        request: &Certification,
        observer: &mut (dyn FnMut(&Strike) + Send),
    ) -> Result<Certified, Refusal>;
}

/// One of several runs that are made together.
pub struct Together<'w> {
    /// The values of all parameters.
    pub parameters: Vec<f64>,
    /// The initial state.
    pub origin: Origin,
    /// The observer of the run.
    pub watch: &'w mut dyn Watch,
}

/// The data of a contact, as reported by `inspect`.
#[derive(Debug, Clone)]
pub struct Contacted {
    /// `dh(qdot) + d_t h` before the impact.
    pub gap_rate: f64,
    /// `P(pi_D grad h)`: the momentum along the projected gradient.
    pub constrained_rate: f64,
    /// `d_t h`, the speed of a moving surface.
    pub surface_rate: f64,
    /// `dh(pi_D grad h)`.
    pub constrained_compliance: f64,
    /// `dh(grad h)`.
    pub free_compliance: f64,
    /// The direction of the impulse, in momenta.
    pub direction: Vec<f64>,
}

/// The way in which the functions of a model are called. It changes the speed, not the results.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Code {
    /// They are inlined into the code that runs the model.
    Inlined,
    /// They are compiled, and called through pointers.
    Pointers,
    /// They are generated from the text of the model when it is loaded, and called through pointers.
    Loaded,
}

impl Code {
    /// The name that is printed after a time.
    pub fn name(self) -> &'static str {
        match self {
            Self::Inlined => "inlined",
            Self::Pointers => "behind pointers",
            Self::Loaded => "loaded from its text",
        }
    }
}

/// Values of a state for tables and pictures; NaN for outputs that are integrals along a run.
pub(crate) fn point<M: Instance>(model: &M, t: f64, state: &M::State) -> Point {
    let description = model.description();
    let mode = description.modes.get(model.mode(state));
    // A mode may lack some coordinates of the model.
    let has = |index: usize| mode.is_none_or(|mode| mode.coordinates.contains(&index));
    let masked = |values: &[f64]| -> Vec<f64> {
        let numbered = values.iter().enumerate();
        numbered
            .map(|(index, &value)| if has(index) { value } else { f64::NAN })
            .collect()
    };
    let components = |values: Result<M::Vector, Fault>| match values {
        Ok(values) => masked(values.as_slice()),
        Err(_) => vec![f64::NAN; model.coordinate_count()],
    };
    let mut outputs = vec![f64::NAN; description.outputs.len()];
    if model.outputs(t, state, &mut outputs).is_err() {
        outputs.fill(f64::NAN);
    }
    for &index in description.integrals.iter() {
        outputs[index] = f64::NAN;
    }
    Point {
        mode: mode.map(|mode| mode.name),
        q: masked(model.position(state).as_slice()),
        qdot: components(model.velocity(t, state)),
        p: components(model.momentum(t, state)),
        energy: model.energy(t, state).unwrap_or(f64::NAN),
        outputs,
        view: model.view_path(t, state),
    }
}
