//! Systems with surfaces.

use super::System;
use super::landing::after_reset;
use crate::error::Fault;
use crate::law::{Blow, Contact, Jump, Landing, Law};
use crate::numbers::{Bent, ComplexInterval, TaylorModel};
use crate::outcome::Outcome;
use crate::state::StateVector;

/// Time and components of a state along a part of the motion, as in [`Impacting::gap_along`].
pub type Along<'a> = (TaylorModel, &'a dyn Fn(usize) -> TaylorModel);

/// A system with impact surfaces `h_s >= 0`.
///
/// # Examples
///
/// ```
/// use dalembert::{Impacting, Law, System};
///
/// dalembert::model! {
///     pub Ball {
///         coordinates { x; }
///         lagrangian = dot(x)^2/2 - x;
///         impacts { floor: x >= 0; }
///         initial { x = 1; }
///     }
/// }
///
/// let ball = Ball::default();
/// let falling = ball.state(0.0, &[0.5].into(), &[-2.0].into())?;
/// assert_eq!(ball.gaps(0.0, &falling)[0], 0.5);
/// assert_eq!(ball.gap_rates(0.0, &falling)?[0], -2.0);
///
/// // The impulse of an elastic impact reverses the velocity of a mass of 1.
/// let contact = ball.contact(0, 0.0, &falling)?;
/// assert_eq!(contact.impulse(Law::Elastic), 4.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[diagnostic::on_unimplemented(
    message = "`{Self}` has no impact surfaces: declare `impacts {{ .. }}` in its `model!`"
)]
pub trait Impacting: System {
    /// S numbers, one per surface, in the order of declaration.
    type Gaps: StateVector;

    /// S, the number of surfaces. The default is correct for gaps of fixed length.
    #[inline(always)]
    fn surface_count(&self) -> usize {
        Self::Gaps::CAPACITY
    }

    /// Gaps with S zeros.
    #[inline(always)]
    fn zero_gaps(&self) -> Self::Gaps {
        StateVector::zeros(self.surface_count())
    }

    /// The gaps `h_s`, S numbers. Motion is allowed where they are not negative. At a surface with a reset it is
    /// allowed everywhere.
    fn gaps(&self, t: f64, state: &Self::State) -> Self::Gaps;

    /// The gap of one surface, with the bits of [`Impacting::gaps`].
    #[inline(always)]
    fn gap(&self, surface: usize, t: f64, state: &Self::State) -> f64 {
        self.gaps(t, state).as_slice()[surface]
    }

    /// The gap of one surface along a part of the motion. `component(i)` returns component `i` of the state along it; a
    /// gap depends on positions only.
    fn gap_along(
        &self,
        surface: usize,
        t: TaylorModel,
        component: &dyn Fn(usize) -> TaylorModel,
    ) -> TaylorModel;

    /// The gap of one surface along straight lines through a box, with the arguments of [`Impacting::gap_along`]. For
    /// most steps its bounds make a tighter enclosure unnecessary. An [`Audit`](crate::audit::Audit) requires it: with
    /// the default, no run is confirmed.
    fn gap_about(&self, surface: usize, t: Bent, component: &dyn Fn(usize) -> Bent) -> Bent {
        let _ = (surface, t, component);
        Bent::ANYTHING
    }

    /// The gap of one surface on a box of complex positions and times, with the arguments of [`Impacting::gap_along`].
    /// For most steps of power series its bounds make a tighter enclosure unnecessary.
    fn gap_complex(
        &self,
        surface: usize,
        t: ComplexInterval,
        component: &dyn Fn(usize) -> ComplexInterval,
    ) -> ComplexInterval {
        let _ = (surface, t, component);
        ComplexInterval::ANYTHING
    }

    /// The gap rates `dh_s(qdot) + d_t h_s`.
    ///
    /// # Errors
    /// A [`Fault`] where the velocities do not exist.
    fn gap_rates(&self, t: f64, state: &Self::State) -> Result<Self::Gaps, Fault>;

    /// The second rates `d^2h_s/dt^2` if the momenta or quasi-velocities change at the rates `motion`. `None` for a
    /// system that does not provide them. Such a system cannot move along a surface.
    ///
    /// # Errors
    /// A [`Fault`] where they do not exist.
    fn gap_accelerations(
        &self,
        t: f64,
        state: &Self::State,
        motion: &Self::Impulse,
    ) -> Result<Option<Self::Gaps>, Fault> {
        let _ = (t, state, motion);
        Ok(None)
    }

    /// Change of the gap rates by the impulse `motion`. `None` in the same cases as [`Impacting::gap_accelerations`].
    ///
    /// # Errors
    /// A [`Fault`] where they do not exist.
    fn gap_responses(
        &self,
        t: f64,
        state: &Self::State,
        motion: &Self::Impulse,
    ) -> Result<Option<Self::Gaps>, Fault> {
        let _ = (t, state, motion);
        Ok(None)
    }

    /// True if the surface counts here: all its `when` conditions hold. The last of several transitions with one gap
    /// also counts where no transition's conditions hold; see [`Impacting::takes`].
    fn surface_active(&self, surface: usize, t: f64, state: &Self::State) -> bool {
        let _ = (surface, t, state);
        true
    }

    /// True if a surface has conditions that [`Impacting::counts_along`] encloses. False by default: a run then checks
    /// only at the ends of its steps if a surface begins to count on the forbidden side.
    fn has_conditions(&self, surface: usize) -> bool {
        let _ = surface;
        false
    }

    /// True if the surface counts all along a part of the motion, false if it counts nowhere on it; `None` if neither
    /// is certain. `rounding` holds one moment of the motion, with its rounding errors. The range of a margin over it
    /// is as wide as the rounding error of the margin. A condition counts as satisfied if its margin exceeds this width.
    fn counts_along(&self, surface: usize, along: Along<'_>, rounding: Along<'_>) -> Option<bool> {
        let _ = (surface, along, rounding);
        None
    }

    /// True if the gap of a surface contains absolute values that [`Impacting::passes_kink`] encloses.
    fn has_kinks(&self, surface: usize) -> bool {
        let _ = surface;
        false
    }

    /// True if the argument of an absolute value in the gap has another sign all along a part of the motion than at
    /// `start`, false if no argument has another sign anywhere on it; `None` if neither is certain. `rounding` is as
    /// for [`Impacting::counts_along`]. An argument within its rounding error has no sign; it has another one where it
    /// leaves that error.
    fn passes_kink(
        &self,
        surface: usize,
        start: Along<'_>,
        along: Along<'_>,
        rounding: Along<'_>,
    ) -> Option<bool> {
        let _ = (surface, start, along, rounding);
        Some(false)
    }

    /// True if a surface that counts has a law here. If it has none, the run ends as
    /// [`Outcome::Untaken`](crate::Outcome::Untaken).
    fn takes(&self, surface: usize, t: f64, state: &Self::State) -> bool {
        let _ = (surface, t, state);
        true
    }

    /// The declared law of a surface, at the values of the parameters.
    fn law(&self, surface: usize) -> Law;

    /// Positions and velocities after the declared reset of a surface; `None` if its law is not a reset.
    ///
    /// # Errors
    /// A [`Fault`] of the velocities before the reset, or of the reset itself.
    fn reset(
        &self,
        surface: usize,
        t: f64,
        state: &Self::State,
    ) -> Result<Option<Jump<Self::Vector>>, Fault> {
        let _ = (surface, t, state);
        Ok(None)
    }

    /// The smallest impulse in the metric after which the instantaneous constraints of a surface hold; `None` if the
    /// surface has no such constraints. It acts before the law. The law then acts within those constraints:
    /// [`Impacting::blow`] and [`Impacting::contact`] of the surface include them among the constraints.
    ///
    /// # Errors
    /// [`Fault::SingularSurface`] where they depend on each other or on the constraints; another [`Fault`] where the
    /// metric or the constraints are singular.
    fn focus(
        &self,
        surface: usize,
        t: f64,
        state: &Self::State,
    ) -> Result<Option<Self::Impulse>, Fault> {
        let _ = (surface, t, state);
        Ok(None)
    }

    /// Correction of the rates `motion` of momenta or quasi-velocities that keeps the instantaneous constraints of a
    /// surface while the motion stays in contact with it; `None` if the surface has no such constraints.
    ///
    /// # Errors
    /// The errors of [`Impacting::focus`].
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

    /// True if motion is allowed on both sides of a surface, so that its gap may be negative: surfaces with a reset,
    /// and transitions that count from both sides.
    fn is_passable(&self, surface: usize) -> bool {
        self.law(surface) == Law::Reset
    }

    /// The transition that leads back from the mode that a transition enters, if both modes are first-order, meet at
    /// one surface and have the same state there; `None` otherwise. A sliding mode may exist at such a surface.
    fn opposite(&self, surface: usize) -> Option<usize> {
        let _ = surface;
        None
    }

    /// True if the state after the declared reset or the transition of a surface certainly lies on the surface `other`: on
    /// the same surface after a reset that does not change its gap, or on a surface of the entered mode with the same gap, or
    /// its negative, after a transition that keeps the positions.
    fn lands_on(&self, surface: usize, other: usize) -> bool {
        let _ = (surface, other);
        false
    }

    /// The state after the declared reset of a surface, or in the mode that the surface leads to.
    ///
    /// # Errors
    /// The [`Outcome`] that ends the run: a [`Fault`], a surface without reset or transition, or a state that is not
    /// finite, outside the chart or off the constraints.
    fn landing(
        &self,
        surface: usize,
        t: f64,
        state: &Self::State,
    ) -> Result<Landing<Self::State>, Outcome> {
        after_reset(self, surface, t, state).map(Landing::from)
    }

    /// The impulse of the declared law of a surface. The law must be an impulse.
    ///
    /// # Errors
    /// The errors of [`Impacting::contact`].
    fn blow(
        &self,
        surface: usize,
        t: f64,
        state: &Self::State,
    ) -> Result<Blow<Self::Impulse>, Fault> {
        Ok(self.contact(surface, t, state)?.blow(self.law(surface)))
    }

    /// Quantities of an impact on this surface, from which every law and the motion along the surface are evaluated.
    ///
    /// # Errors
    /// [`Fault::SingularSurface`] where `dh(pi_D grad h)` is not positive; the errors of [`Impacting::focus`];
    /// another [`Fault`] where the metric or the constraints are singular.
    fn contact(
        &self,
        surface: usize,
        t: f64,
        state: &Self::State,
    ) -> Result<Contact<Self::Impulse>, Fault>;
}
