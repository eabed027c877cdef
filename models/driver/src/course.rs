//! Defaults for values that the request of a run leaves open: the integrator, the form of the equations, the end time,
//! the laws of surfaces.

use dalembert::describe::Description;
use dalembert::integrate::ToleranceError;
use dalembert::law::Law;
use thiserror::Error;

use crate::integrator::{Form, Integrator};
use crate::model::AnyModel;

/// End time of a run to a number of impacts, unless the model's declared `until` is later.
const IMPACT_HORIZON: f64 = 3600.0;

/// The integrator that a request asks for.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum IntegratorChoice {
    /// The integrator with the least predicted work for the model and the tolerance ([`Integrator::automatic`]).
    #[default]
    Automatic,
    /// This one.
    Given(Integrator),
}

impl IntegratorChoice {
    /// The name of [`Self::Automatic`] on the command line and in files.
    pub const AUTOMATIC: &str = "auto";

    /// All choices.
    pub fn every() -> impl Iterator<Item = Self> {
        let integrators = Integrator::every().iter();
        core::iter::once(Self::Automatic).chain(integrators.map(|one| Self::Given(*one)))
    }

    /// The name on the command line and in files.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Automatic => Self::AUTOMATIC,
            Self::Given(integrator) => integrator.name(),
        }
    }

    /// True if the integrator controls its step size by the tolerance.
    pub const fn is_adaptive(self) -> bool {
        match self {
            Self::Automatic => true,
            Self::Given(integrator) => integrator.is_adaptive(),
        }
    }

    /// The same choice for a run whose inputs change within a step. Power series need inputs that do not.
    pub const fn with_changing_inputs(self) -> Self {
        match self {
            Self::Automatic => Self::Given(Integrator::Dop853),
            Self::Given(_) => self,
        }
    }

    /// The integrator for runs of a model in this form at this tolerance.
    ///
    /// # Errors
    /// [`ToleranceError`] for a tolerance out of range.
    pub fn settle(
        self,
        model: &dyn AnyModel,
        form: Form,
        tol: f64,
    ) -> Result<Integrator, ToleranceError> {
        match self {
            Self::Automatic => Integrator::automatic(tol, model.work(form)),
            Self::Given(integrator) => Ok(integrator),
        }
    }
}

/// Reasons why a form cannot be run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
pub enum FormError {
    /// The model has no reduced form.
    #[error("`{model}` has no form reduced to D")]
    Unreduced {
        /// The model.
        model: &'static str,
    },
    /// The reduced form is requested together with states off the constraints or a projection.
    #[error("the reduced form has no states off the constraints and needs no projection")]
    OnConstraints,
}

/// Reasons why a law cannot be used.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
pub enum LawError {
    /// The surface is a transition to another mode.
    #[error("a transition leads to another mode, and takes no law")]
    Transition,
    /// The model has no surfaces.
    #[error("the model has no impact surfaces")]
    NoSurfaces,
    /// The law is `reset` and the surface declares no reset.
    #[error("surface `{surface}` declares no reset")]
    NoReset {
        /// The surface.
        surface: &'static str,
    },
}

impl Form {
    /// The wanted form. If it is `None`: the reduced form if the model has it and nothing `needs_global`, else the global
    /// form.
    ///
    /// # Errors
    /// [`FormError`] if the wanted form does not exist or does not suit the request.
    pub fn choose(
        description: &Description,
        wanted: Option<Self>,
        needs_global: bool,
    ) -> Result<Self, FormError> {
        let has_reduced = !description.quasi_velocities.is_empty();
        match wanted {
            Some(Self::Reduced) if !has_reduced => Err(FormError::Unreduced {
                model: description.name,
            }),
            Some(Self::Reduced) if needs_global => Err(FormError::OnConstraints),
            Some(form) => Ok(form),
            None if has_reduced && !needs_global => Ok(Self::Reduced),
            None => Ok(Self::Global),
        }
    }
}

/// The end time of a run: the requested one, else the declared one. For a run to a number of impacts without a
/// requested end time, it is at least 3600. `None` if the request has neither, and the model declares no end time.
pub fn horizon(model: &dyn AnyModel, until: Option<f64>, impacts: Option<u64>) -> Option<f64> {
    let declared = model.initial().until;
    let declared = declared.filter(|until| until.is_finite() && *until > 0.0);
    match (until, impacts) {
        (Some(until), _) => Some(until),
        (None, Some(_)) => Some(declared.unwrap_or(0.0).max(IMPACT_HORIZON)),
        (None, None) => declared,
    }
}

/// Adds a law for one surface, or for all surfaces except transitions.
///
/// # Errors
/// [`LawError`] if the law does not suit the surface, or the model has no surfaces.
pub fn add_law(
    laws: &mut Vec<(usize, Law)>,
    model: &dyn AnyModel,
    surface: Option<usize>,
    law: Law,
) -> Result<(), LawError> {
    let surfaces = &model.description().surfaces;
    let is_wall = |surface: &usize| model.law(*surface) != Some(Law::Transition);
    let chosen = match surface {
        Some(surface) if is_wall(&surface) => surface..surface + 1,
        Some(_) => return Err(LawError::Transition),
        None if surfaces.is_empty() => return Err(LawError::NoSurfaces),
        None => 0..surfaces.len(),
    };
    for surface in chosen.filter(is_wall) {
        if law == Law::Reset && model.law(surface) != Some(Law::Reset) {
            let surface = surfaces[surface].name;
            return Err(LawError::NoReset { surface });
        }
        laws.push((surface, law));
    }
    Ok(())
}
