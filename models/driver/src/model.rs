//! A model behind a trait that knows nothing of its type.

use dalembert::describe::{Description, Report};
use dalembert::law::Law;
use dalembert::{Fault, OrbitError, ParameterError, StateError};

use crate::accuracy::{Plan, Study, Verified};
use crate::certify::{Certification, Certified, Strike};
use crate::orbit::{Found, Search};
use crate::refusal::Refusal;
use crate::run::{Ending, Settings, Watch};
use crate::variation::{Derivatives, Variable, VariationError};

/// Velocities or momenta, one per coordinate.
#[derive(Debug, Clone, PartialEq)]
pub enum Rates {
    /// qdot.
    Velocities(Vec<f64>),
    /// p.
    Momenta(Vec<f64>),
}

/// What to do with positions or a velocity that violate the constraints.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum OffConstraint {
    /// Refuse them, beyond 1e-9 of the sum of the absolute values of the constraint's terms.
    Error,
    /// Replace them by allowed positions near by and the nearest allowed velocity in the metric.
    Project,
    /// Start there; the motion keeps the residual.
    Keep,
}

impl OffConstraint {
    /// All of them.
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
}

/// A state as it is given.
#[derive(Debug, Clone)]
pub struct Origin {
    /// Positions, one per coordinate.
    pub q: Vec<f64>,
    /// Velocities or momenta.
    pub rates: Rates,
    /// What to do where it is off the constraints.
    pub policy: OffConstraint,
}

/// The declared initial condition.
#[derive(Debug, Clone)]
pub struct Start {
    /// Positions, one per coordinate.
    pub q: Vec<f64>,
    /// Velocities, one per coordinate.
    pub qdot: Vec<f64>,
    /// Whether the position is given; equations of positions among the constraints may choose the others.
    pub placed: Vec<bool>,
    /// Whether the velocity is given; the constraints may choose the others.
    pub named: Vec<bool>,
    /// The declared end of a run.
    pub until: Option<f64>,
}

/// What tables and pictures show of a state; NaN where a quantity does not exist.
#[derive(Debug, Clone, PartialEq)]
pub struct Point {
    /// The name of the mode, of a model with modes.
    pub mode: Option<&'static str>,
    /// Positions, one per coordinate.
    pub q: Vec<f64>,
    /// Velocities, one per coordinate.
    pub qdot: Vec<f64>,
    /// Momenta, one per coordinate.
    pub p: Vec<f64>,
    /// Kinetic plus potential energy.
    pub energy: f64,
    /// The declared outputs, in their order.
    pub outputs: Vec<f64>,
    /// The point that the declared view shows.
    pub view: Option<[f64; 2]>,
}

impl Point {
    /// A point of which nothing is known.
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
    /// The way in which its functions are called.
    fn code(&self) -> Code;
    /// Names, shapes and documentation of what is declared.
    fn description(&self) -> Description;
    /// The names of the inputs, whose values are the parameters after those of the description.
    fn inputs(&self) -> &'static [&'static str];
    /// The value of a parameter; inputs come after those of the description.
    fn parameter(&self, index: usize) -> f64;
    /// Sets a parameter. The value is checked where a state is made.
    fn set_parameter(&mut self, index: usize, value: f64);
    /// The mode, by number, that states are made in.
    fn set_mode(&mut self, mode: usize);
    /// Refuses values that the declaration rules out.
    ///
    /// # Errors
    /// The first of them.
    fn check_parameters(&self) -> Result<(), ParameterError>;
    /// The declared initial condition.
    fn initial(&self) -> Start;
    /// The positions with those that are not `placed` chosen by equations of positions among the constraints.
    fn complete_position(&self, q: &[f64], placed: &[bool]) -> Result<Vec<f64>, StateError>;
    /// The velocities with those that are not `named` chosen by the constraints.
    fn complete_velocity(
        &self,
        q: &[f64],
        qdot: &[f64],
        named: &[bool],
    ) -> Result<Vec<f64>, StateError>;
    /// The state `(q, p)` of the global form.
    ///
    /// # Errors
    /// As the states of a run are refused.
    fn state(&self, t: f64, origin: &Origin) -> Result<Vec<f64>, StateError>;
    /// The declared region's function, positive where motion is allowed; `None` without a region.
    fn region(&self, t: f64, q: &[f64]) -> Option<f64>;
    /// Shows everything that is derived at a state of the global form.
    ///
    /// # Errors
    /// Where something does not exist there.
    fn inspect(&self, t: f64, state: &[f64], report: &mut dyn Report) -> Result<(), Fault>;
    /// The law that a surface declares.
    fn law(&self, surface: usize) -> Option<Law>;
    /// The state after the impact of a law.
    fn impact(&self, state: &[f64], contact: &Contacted, law: Law) -> Vec<f64>;
    /// The state after an impulse on its momenta.
    fn kick(&self, state: &[f64], impulse: &[f64]) -> Vec<f64>;
}

/// The runs of a model with values for its parameters.
pub trait Runs {
    /// Makes a run from `t = 0`, and shows it to a watch.
    ///
    /// # Errors
    /// Why it does not begin.
    fn simulate(
        &self,
        origin: &Origin,
        settings: &Settings,
        watch: &mut dyn Watch,
    ) -> Result<Ending, Refusal>;
    /// As [`Runs::simulate`], with Taylor series, of several runs at once; `looks_inside` where watches look at
    /// states inside steps.
    fn simulate_abreast(
        &self,
        runs: Vec<Together<'_>>,
        settings: &Settings,
        looks_inside: bool,
    ) -> Vec<Result<Ending, Refusal>>;
    /// What accuracy costs from this state on; `tell` hears what is about to be measured.
    fn study(
        &self,
        origin: &Origin,
        base: &Settings,
        plan: &Plan,
        tell: &mut dyn FnMut(&str),
    ) -> Result<Study, Refusal>;
    /// The measured error of a run that ended so.
    fn verify(
        &self,
        origin: &Origin,
        settings: &Settings,
        ending: &Ending,
    ) -> Result<Verified, Refusal>;
    /// A periodic orbit near the first arrival from this state; `None` for a scene without variations.
    fn orbit(
        &self,
        origin: &Origin,
        search: &Search,
    ) -> Result<Option<Result<Found, OrbitError>>, Refusal>;
    /// Derivatives of the last state of a run with respect to these variables; `is_over` says where nobody wants to wait any longer.
    ///
    /// # Errors
    /// Why the run does not begin. The inner result says why it has no derivatives.
    fn differentiate(
        &self,
        origin: &Origin,
        settings: &Settings,
        variables: &[Variable],
        is_over: &mut dyn FnMut() -> bool,
    ) -> Result<Result<Derivatives, VariationError>, Refusal>;
    /// Encloses the motion from this state on, and shows its impacts.
    ///
    /// # Errors
    /// Why no motion of the model is certified. Where it is lost later is said by what is returned.
    fn certify(
        &self,
        origin: &Origin,
        request: &Certification,
        observer: &mut (dyn FnMut(&Strike) + Send),
    ) -> Result<Certified, Refusal>;
}

/// One of several runs that are made at once.
pub struct Together<'w> {
    /// The values of all parameters.
    pub parameters: Vec<f64>,
    /// The state that it begins with.
    pub origin: Origin,
    /// What is shown the run.
    pub watch: &'w mut dyn Watch,
}

/// The data of a contact as `inspect` reports them.
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

/// The way in which the functions of a model are called. Speed depends on it, results do not.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Code {
    /// They are inlined into what runs the model.
    Inlined,
    /// They are compiled, and behind pointers.
    Pointers,
    /// They were made from the text of the model when it was loaded, and are behind pointers.
    Loaded,
}

impl Code {
    /// The way, as it is printed after a time.
    pub fn name(self) -> &'static str {
        match self {
            Self::Inlined => "inlined",
            Self::Pointers => "behind pointers",
            Self::Loaded => "loaded from its text",
        }
    }
}
