//! Systems with surfaces.

use super::System;
use super::landing::after_reset;
use crate::error::Fault;
use crate::law::{Blow, Contact, Jump, Landing, Law};
use crate::numbers::{Bent, TaylorModel};
use crate::outcome::Outcome;
use crate::state::StateVector;

/// A system with impact surfaces `h_s >= 0`.
#[diagnostic::on_unimplemented(
    message = "`{Self}` has no impact surfaces: declare `impacts {{ .. }}` in its `model!`"
)]
pub trait Impacting: System {
    /// S numbers, one per surface, in the order of declaration.
    type Gaps: StateVector;

    /// S, the number of surfaces. Of gaps of fixed number it is known.
    #[inline(always)]
    fn surface_count(&self) -> usize {
        Self::Gaps::CAPACITY
    }

    /// S zeros.
    #[inline(always)]
    fn zero_gaps(&self) -> Self::Gaps {
        StateVector::zeros(self.surface_count())
    }

    /// The gaps `h_s`; motion is allowed where they are not negative, and everywhere at a surface with a reset.
    fn gaps(&self, t: f64, state: &Self::State) -> Self::Gaps;

    /// The gap of one surface along a stretch of motion. `component(i)` gives component `i` of the state along it; a gap takes positions
    /// only.
    fn gap_along(
        &self,
        surface: usize,
        t: TaylorModel,
        component: &dyn Fn(usize) -> TaylorModel,
    ) -> TaylorModel;

    /// The gap of one surface along straight lines through a box, with arguments as [`Impacting::gap_along`] has them. It saves most
    /// steps a closer look, and an [`Audit`](crate::audit::Audit) rests on it; without it nothing is known, and no run is confirmed.
    fn gap_about(&self, surface: usize, t: Bent, component: &dyn Fn(usize) -> Bent) -> Bent {
        let _ = (surface, t, component);
        Bent::ANYTHING
    }

    /// The gap rates `dh_s(qdot) + d_t h_s`.
    ///
    /// # Errors
    /// [`Fault`].
    fn gap_rates(&self, t: f64, state: &Self::State) -> Result<Self::Gaps, Fault>;

    /// The second rates `d^2h_s/dt^2` where the motion's part of the state, momenta or quasi-velocities, changes at the
    /// rates `motion`. `None` for a system that does not know them: it cannot go on along a surface.
    ///
    /// # Errors
    /// [`Fault`].
    fn gap_accelerations(
        &self,
        t: f64,
        state: &Self::State,
        motion: &Self::Impulse,
    ) -> Result<Option<Self::Gaps>, Fault> {
        let _ = (t, state, motion);
        Ok(None)
    }

    /// What the impulse `motion` changes the gap rates by. `None` as for [`Impacting::gap_accelerations`].
    ///
    /// # Errors
    /// [`Fault`].
    fn gap_responses(
        &self,
        t: f64,
        state: &Self::State,
        motion: &Self::Impulse,
    ) -> Result<Option<Self::Gaps>, Fault> {
        let _ = (t, state, motion);
        Ok(None)
    }

    /// Whether the surface counts here: all its `when` conditions hold. The last of several transitions of one gap counts also
    /// where the conditions of none hold; see [`Impacting::takes`].
    fn surface_active(&self, surface: usize, t: f64, state: &Self::State) -> bool {
        let _ = (surface, t, state);
        true
    }

    /// Whether a surface that counts has a law here; where it has none, the run ends as
    /// [`Outcome::Untaken`](crate::Outcome::Untaken).
    fn takes(&self, surface: usize, t: f64, state: &Self::State) -> bool {
        let _ = (surface, t, state);
        true
    }

    /// The declared law of a surface, at this system's parameters.
    fn law(&self, surface: usize) -> Law;

    /// Positions and velocities after the declared reset of a surface; `None` where its law is no reset.
    ///
    /// # Errors
    /// [`Fault`].
    fn reset(
        &self,
        surface: usize,
        t: f64,
        state: &Self::State,
    ) -> Result<Option<Jump<Self::Vector>>, Fault> {
        let _ = (surface, t, state);
        Ok(None)
    }

    /// The impulse after which the instantaneous constraints of a surface hold, the nearest one in the metric; `None`
    /// where it has none. It acts before the law, and then the law within those constraints: what
    /// [`Impacting::blow`] and [`Impacting::contact`] say of the surface has them among the constraints.
    ///
    /// # Errors
    /// [`Fault`]; [`Fault::SingularSurface`] where they depend on each other or on the constraints.
    fn focus(
        &self,
        surface: usize,
        t: f64,
        state: &Self::State,
    ) -> Result<Option<Self::Impulse>, Fault> {
        let _ = (surface, t, state);
        Ok(None)
    }

    /// What must be added to the rates `motion` of momenta or quasi-velocities for the instantaneous constraints of a
    /// surface to go on holding, as they do along it; `None` where it has none.
    ///
    /// # Errors
    /// As [`Impacting::focus`].
    fn trace(
        &self,
        surface: usize,
        t: f64,
        state: &Self::State,
        motion: &Self::Impulse,
    ) -> Result<Option<Self::Impulse>, Fault> {
        let _ = (surface, t, state, motion);
        Ok(None)
    }

    /// Whether motion is allowed on both sides of a surface, so that its gap may be negative: of surfaces with a reset, and of
    /// transitions that are counted from both sides.
    fn is_passable(&self, surface: usize) -> bool {
        self.law(surface) == Law::Reset
    }

    /// The transition that leads back at once from the mode that a transition leads to, where first-order modes meet at one
    /// surface and the state stays the same: there motions may slide.
    fn opposite(&self, surface: usize) -> Option<usize> {
        let _ = surface;
        None
    }

    /// The state after the declared reset of a surface, or in the mode that it leads to.
    ///
    /// # Errors
    /// The [`Outcome`] that ends the run: a [`Fault`], a state that is not finite, outside the chart or off the constraints.
    fn landing(
        &self,
        surface: usize,
        t: f64,
        state: &Self::State,
    ) -> Result<Landing<Self::State>, Outcome> {
        after_reset(self, surface, t, state).map(Landing::from)
    }

    /// The impulse of the declared law of a surface, where that is one.
    ///
    /// # Errors
    /// As [`Impacting::contact`].
    fn blow(
        &self,
        surface: usize,
        t: f64,
        state: &Self::State,
    ) -> Result<Blow<Self::Impulse>, Fault> {
        Ok(self.contact(surface, t, state)?.blow(self.law(surface)))
    }

    /// What an impact on this surface by any law needs, and motion along it.
    ///
    /// # Errors
    /// [`Fault`]; [`Fault::SingularSurface`] where `dh(pi_D grad h)` is not positive, and as [`Impacting::focus`].
    fn contact(
        &self,
        surface: usize,
        t: f64,
        state: &Self::State,
    ) -> Result<Contact<Self::Impulse>, Fault>;
}
