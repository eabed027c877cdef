//! A model behind a trait that knows nothing of its type.

use dalembert::describe::{Description, Report};
use dalembert::law::Law;
use dalembert::{Fault, ParameterError, StateError};

use crate::accuracy::{Plan, Study, Verified};
use crate::args::OffConstraint;
use crate::driver::{Ending, Settings, Watch};
use crate::orbit::{Found, Missed, Search};

/// Velocities or momenta, one per coordinate.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Rates {
    Velocities(Vec<f64>),
    Momenta(Vec<f64>),
}

/// A state as it is given.
#[derive(Debug, Clone)]
pub(crate) struct Origin {
    pub q: Vec<f64>,
    pub rates: Rates,
    /// What to do where it is off the constraints.
    pub policy: OffConstraint,
}

/// The declared initial condition.
#[derive(Debug, Clone)]
pub(crate) struct Start {
    pub q: Vec<f64>,
    pub qdot: Vec<f64>,
    /// Whether the position is given; equations of positions among the constraints may choose the others.
    pub placed: Vec<bool>,
    /// Whether the velocity is given; the constraints may choose the others.
    pub named: Vec<bool>,
    pub until: Option<f64>,
}

/// What tables and pictures show of a state; NaN where a quantity does not exist.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Point {
    /// The name of the mode, of a model with modes.
    pub mode: Option<&'static str>,
    pub q: Vec<f64>,
    pub qdot: Vec<f64>,
    pub p: Vec<f64>,
    pub energy: f64,
    pub outputs: Vec<f64>,
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
pub(crate) trait AnyModel: Runs {
    /// The way in which its functions are called.
    fn code(&self) -> Code;
    fn description(&self) -> Description;
    /// The names of the inputs, whose values are the parameters after those of the description.
    fn inputs(&self) -> &'static [&'static str];
    fn parameter(&self, index: usize) -> f64;
    fn set_parameter(&mut self, index: usize, value: f64);
    /// The mode, by number, that states are made in.
    fn set_mode(&mut self, mode: usize);
    fn check_parameters(&self) -> Result<(), ParameterError>;
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
    fn state(&self, t: f64, origin: &Origin) -> Result<Vec<f64>, StateError>;
    fn region(&self, t: f64, q: &[f64]) -> Option<f64>;
    fn inspect(&self, t: f64, state: &[f64], report: &mut dyn Report) -> Result<(), Fault>;
    /// The law that a surface declares.
    fn law(&self, surface: usize) -> Option<Law>;
    /// The state after the impact of a law.
    fn impact(&self, state: &[f64], contact: &Contacted, law: Law) -> Vec<f64>;
    /// The state after an impulse on its momenta.
    fn kick(&self, state: &[f64], impulse: &[f64]) -> Vec<f64>;
}

/// The runs of a model with values for its parameters.
pub(crate) trait Runs {
    fn simulate(
        &self,
        origin: &Origin,
        settings: &Settings,
        watch: &mut dyn Watch,
    ) -> Result<Ending, String>;
    /// As [`Runs::simulate`], with Taylor series, of several runs at once; `looks_inside` where watches look at
    /// states inside steps.
    fn simulate_abreast(
        &self,
        runs: Vec<Together<'_>>,
        settings: &Settings,
        looks_inside: bool,
    ) -> Vec<Result<Ending, String>>;
    /// What accuracy costs from this state on; `tell` hears what is about to be measured.
    fn study(
        &self,
        origin: &Origin,
        base: &Settings,
        plan: &Plan,
        tell: &mut dyn FnMut(&str),
    ) -> Result<Study, String>;
    /// The measured error of a run that ended so.
    fn verify(
        &self,
        origin: &Origin,
        settings: &Settings,
        ending: &Ending,
    ) -> Result<Verified, String>;
    /// A periodic orbit near the first arrival from this state; `None` for a scene without variations.
    fn orbit(
        &self,
        origin: &Origin,
        search: &Search,
    ) -> Result<Option<Result<Found, Missed>>, String>;
}

/// One of several runs that are made at once.
pub(crate) struct Together<'w> {
    /// The values of all parameters.
    pub parameters: Vec<f64>,
    pub origin: Origin,
    pub watch: &'w mut dyn Watch,
}

/// The data of a contact as `inspect` reports them.
#[derive(Debug, Clone)]
pub(crate) struct Contacted {
    pub gap_rate: f64,
    pub constrained_rate: f64,
    pub surface_rate: f64,
    pub constrained_compliance: f64,
    pub free_compliance: f64,
    pub direction: Vec<f64>,
}

/// The way in which the functions of a model are called. Speed depends on it, results do not.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Code {
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
