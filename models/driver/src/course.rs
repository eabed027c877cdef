//! Choices that a run needs where its request is silent: the form of the equations, the last time, the laws of surfaces.

use dalembert::describe::Description;
use dalembert::law::Law;
use thiserror::Error;

use crate::integrator::Form;
use crate::model::AnyModel;

/// The time that a run to a number of impacts may take, unless the model's own `until` is longer.
const IMPACT_HORIZON: f64 = 3600.0;

/// Why a form cannot be run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
pub enum FormError {
    /// The model has no reduced form.
    #[error("`{model}` has no form reduced to D")]
    Unreduced {
        /// The model.
        model: &'static str,
    },
    /// States off the constraints, or a projection, were asked for.
    #[error("the reduced form holds no states off the constraints, and takes no projection")]
    OnConstraints,
}

/// Why a law cannot be used.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
pub enum LawError {
    /// The surface leads to another mode.
    #[error("a transition leads to another mode, and takes no law")]
    Transition,
    /// The model has no surfaces.
    #[error("the model has no impact surfaces")]
    NoSurfaces,
    /// The law `reset` for a surface without one.
    #[error("surface `{surface}` declares no reset")]
    NoReset {
        /// The surface.
        surface: &'static str,
    },
}

impl Form {
    /// The wanted form, else the reduced one where the model has it and nothing `needs_global`.
    ///
    /// # Errors
    /// [`FormError`].
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

/// The last time of a run: as asked for, else the declared one, which a number of impacts may extend. `None` where nothing ends it.
pub fn horizon(model: &dyn AnyModel, until: Option<f64>, impacts: Option<u64>) -> Option<f64> {
    let declared = model.initial().until;
    let declared = declared.filter(|until| until.is_finite() && *until > 0.0);
    match (until, impacts) {
        (Some(until), _) => Some(until),
        (None, Some(_)) => Some(declared.unwrap_or(0.0).max(IMPACT_HORIZON)),
        (None, None) => declared,
    }
}

/// Adds a law for one surface, or for all that are no transitions.
///
/// # Errors
/// [`LawError`].
pub fn add_law(
    laws: &mut Vec<(usize, Law)>,
    model: &dyn AnyModel,
    surface: Option<usize>,
    law: Law,
) -> Result<(), LawError> {
    let surfaces = model.description().surfaces;
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
