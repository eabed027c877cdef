//! Instantaneous constraints, which hold only at the moment of an impact and while their surface holds the motion.
//!
//! An impact first brings the state onto these constraints, by the smallest impulse in the metric. J. Cortes and A. M.
//! Vinogradov call the result the instantaneous focusing point. If that state still approaches the surface, the law
//! acts within the constraints.

use crate::contract::Impacting;
use crate::error::Fault;

/// The state after the impulse that establishes the instantaneous constraints of a surface; `None` if it has none.
pub(super) fn focused<Sys: Impacting>(
    system: &Sys,
    surface: usize,
    t: f64,
    state: &Sys::State,
) -> Result<Option<Sys::State>, Fault> {
    let Some(impulse) = system.focus(surface, t, state)? else {
        return Ok(None);
    };
    let mut focused = *state;
    system.kick(&mut focused, 1.0, &impulse);
    Ok(Some(focused))
}

/// True if a surface has instantaneous constraints.
pub(super) fn is_rough<Sys: Impacting>(
    system: &Sys,
    surface: usize,
    t: f64,
    state: &Sys::State,
) -> Result<bool, Fault> {
    Ok(system.focus(surface, t, state)?.is_some())
}
