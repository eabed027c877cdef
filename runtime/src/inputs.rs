//! Systems with inputs, and inputs that are functions of time and state.

use crate::contract::{
    Along, Chart, Constrained, Impacting, Level, Powered, RankDrop, System, VectorField,
};
use crate::error::{Fault, ParameterError, StateError};
use crate::law::{Blow, Contact, Jump, Landing, Law};
use crate::numbers::{Bent, ComplexInterval, TaylorModel};
use crate::outcome::Outcome;

/// A system with declared `inputs`, whose values the caller supplies. It stores them like parameters; they are 0 until
/// they are set.
///
/// # Examples
///
/// ```
/// use dalembert::{Actuated, System, VectorField};
///
/// dalembert::model! {
///     pub Cart {
///         coordinates { x; }
///         lagrangian = dot(x)^2/2;
///         inputs { u; }
///         forces { push: u*d(x); }
///     }
/// }
///
/// // A feedback that acts like a spring.
/// let cart = Cart::default();
/// let steered = cart.with_inputs(|_t, state| [-4.0 * state[0]]);
/// let state = steered.state(0.0, &[0.5].into(), &[0.0].into())?;
/// let mut rate = steered.zero_state();
/// steered.rate(0.0, &state, &mut rate)?;
/// assert_eq!(rate[1], -2.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[diagnostic::on_unimplemented(
    message = "`{Self}` has no inputs: declare `inputs {{ u; }}` in its `model!`"
)]
pub trait Actuated: System + Copy {
    /// One number per input, in the order of declaration: `[f64; K]`.
    type Inputs: Copy;

    /// Sets all inputs.
    fn set_inputs(&mut self, inputs: &Self::Inputs);

    /// The system with inputs given by a function of time and state.
    fn with_inputs<F>(self, inputs: F) -> Steered<Self, F>
    where
        F: Fn(f64, &Self::State) -> Self::Inputs,
    {
        Steered {
            system: self,
            inputs,
        }
    }
}

/// A system whose inputs are given by a function; [`Actuated::with_inputs`] makes one.
///
/// The function is called wherever the motion is evaluated, also at trial states that no run accepts. It should be
/// smooth between impacts, as the integrators expect. Power series of the motion (`Taylor`) and the discrete
/// principle are not available for such a system, and neither are derivatives: for these, write the law in the
/// declaration, in place of the input. Effects are made for it as for any system: `Projection::new()`,
/// `Impacts::declared(&steered)`.
#[derive(Debug, Clone, Copy)]
pub struct Steered<Sys, F> {
    /// The system. The function replaces the values of its inputs.
    pub system: Sys,
    /// `(t, state) -> inputs`
    pub inputs: F,
}

impl<Sys: Actuated, F: Fn(f64, &Sys::State) -> Sys::Inputs> Steered<Sys, F> {
    /// The system with the input values at this instant.
    #[inline(always)]
    pub fn at(&self, t: f64, state: &Sys::State) -> Sys {
        let mut system = self.system;
        system.set_inputs(&(self.inputs)(t, state));
        system
    }
}

impl<Sys: Actuated, F: Fn(f64, &Sys::State) -> Sys::Inputs> VectorField for Steered<Sys, F> {
    type State = Sys::State;

    fn state_len(&self) -> usize {
        self.system.state_len()
    }

    #[inline]
    fn rate(&self, t: f64, state: &Self::State, rate: &mut Self::State) -> Result<(), Fault> {
        self.at(t, state).rate(t, state, rate)
    }

    fn scale(&self, t: f64, state: &Self::State) -> Self::State {
        self.system.scale(t, state)
    }
}

impl<Sys: Actuated, F: Fn(f64, &Sys::State) -> Sys::Inputs> System for Steered<Sys, F> {
    type Vector = Sys::Vector;
    type Impulse = Sys::Impulse;

    fn coordinate_count(&self) -> usize {
        self.system.coordinate_count()
    }

    fn impulse_len(&self) -> usize {
        self.system.impulse_len()
    }

    fn motion_start(&self, state: &Self::State) -> usize {
        self.system.motion_start(state)
    }

    fn mode(&self, state: &Self::State) -> usize {
        self.system.mode(state)
    }

    fn position(&self, state: &Self::State) -> Self::Vector {
        self.system.position(state)
    }

    fn velocity(&self, t: f64, state: &Self::State) -> Result<Self::Vector, Fault> {
        self.at(t, state).velocity(t, state)
    }

    fn momentum(&self, t: f64, state: &Self::State) -> Result<Self::Vector, Fault> {
        self.system.momentum(t, state)
    }

    fn state_unchecked(
        &self,
        t: f64,
        q: &Self::Vector,
        qdot: &Self::Vector,
    ) -> Result<Self::State, Fault> {
        self.system.state_unchecked(t, q, qdot)
    }

    fn state_from_momenta(
        &self,
        t: f64,
        q: &Self::Vector,
        p: &Self::Vector,
    ) -> Result<Self::State, Fault> {
        self.system.state_from_momenta(t, q, p)
    }

    fn energy(&self, t: f64, state: &Self::State) -> Result<f64, Fault> {
        self.system.energy(t, state)
    }

    fn kick(&self, state: &mut Self::State, size: f64, direction: &Self::Impulse) {
        self.system.kick(state, size, direction);
    }

    fn check_parameters(&self) -> Result<(), ParameterError> {
        self.system.check_parameters()
    }

    fn outside_chart(&self, state: &Self::State) -> Option<usize> {
        self.system.outside_chart(state)
    }

    fn chart(&self, state: &Self::State, number: usize) -> Option<Chart> {
        self.system.chart(state, number)
    }

    fn can_lose_rank(&self) -> bool {
        self.system.can_lose_rank()
    }

    fn keeps_rank(&self, along: Along<'_>) -> bool {
        self.system.keeps_rank(along)
    }

    fn rank_drop(
        &self,
        motion: impl Fn(f64) -> (f64, Self::State),
        reach: f64,
    ) -> Option<RankDrop> {
        self.system.rank_drop(motion, reach)
    }

    fn admit(&self, t: f64, q: &Self::Vector, qdot: &Self::Vector) -> Result<(), StateError> {
        self.system.admit(t, q, qdot)
    }

    fn state_nearest(
        &self,
        t: f64,
        q: &Self::Vector,
        qdot: &Self::Vector,
    ) -> Result<Self::State, Fault> {
        self.system.state_nearest(t, q, qdot)
    }

    fn state_moved(
        &self,
        from: &Self::State,
        t: f64,
        q: &Self::Vector,
        qdot: &Self::Vector,
    ) -> Result<Self::State, Fault> {
        self.system.state_moved(from, t, q, qdot)
    }

    fn complete_position(
        &self,
        t: f64,
        q: &Self::Vector,
        placed: &Self::Vector,
    ) -> Result<Self::Vector, StateError> {
        self.system.complete_position(t, q, placed)
    }

    fn complete_velocity(
        &self,
        t: f64,
        q: &Self::Vector,
        qdot: &Self::Vector,
        named: &Self::Vector,
    ) -> Result<Self::Vector, StateError> {
        self.system.complete_velocity(t, q, qdot, named)
    }
}

impl<Sys, F> Constrained for Steered<Sys, F>
where
    Sys: Actuated + Constrained,
    F: Fn(f64, &Sys::State) -> Sys::Inputs,
{
    type Multipliers = Sys::Multipliers;
    type Levels = Sys::Levels;

    fn constraint_count(&self) -> usize {
        self.system.constraint_count()
    }

    fn level_count(&self) -> usize {
        self.system.level_count()
    }

    fn is_reduced(&self) -> bool {
        self.system.is_reduced()
    }

    fn is_linear(&self) -> bool {
        self.system.is_linear()
    }

    fn multipliers(&self, t: f64, state: &Self::State) -> Result<Self::Multipliers, Fault> {
        self.at(t, state).multipliers(t, state)
    }

    fn residuals(
        &self,
        t: f64,
        q: &Self::Vector,
        qdot: &Self::Vector,
    ) -> (Self::Multipliers, Self::Multipliers) {
        self.system.residuals(t, q, qdot)
    }

    fn constraint_forms(
        &self,
        t: f64,
        q: &Self::Vector,
        forms: &mut [f64],
        affine: &mut Self::Multipliers,
    ) {
        self.system.constraint_forms(t, q, forms, affine);
    }

    fn linearised_forms(
        &self,
        t: f64,
        q: &Self::Vector,
        qdot: &Self::Vector,
        forms: &mut [f64],
        affine: &mut Self::Multipliers,
    ) {
        self.system.linearised_forms(t, q, qdot, forms, affine);
    }

    fn restore(&self, t: f64, state: &mut Self::State) -> Result<(), Fault> {
        self.system.restore(t, state)
    }

    fn declared_levels(&self) -> &[Level] {
        self.system.declared_levels()
    }

    fn level_scales(&self, t: f64, q: &Self::Vector) -> Self::Levels {
        self.system.level_scales(t, q)
    }

    fn levels(&self, t: f64, q: &Self::Vector) -> Self::Levels {
        self.system.levels(t, q)
    }

    fn level_correction(
        &self,
        t: f64,
        q: &Self::Vector,
        excess: &Self::Levels,
    ) -> Result<Self::Vector, Fault> {
        self.system.level_correction(t, q, excess)
    }
}

impl<Sys, F> Impacting for Steered<Sys, F>
where
    Sys: Actuated + Impacting,
    F: Fn(f64, &Sys::State) -> Sys::Inputs,
{
    type Gaps = Sys::Gaps;

    fn surface_count(&self) -> usize {
        self.system.surface_count()
    }

    fn gaps(&self, t: f64, state: &Self::State) -> Self::Gaps {
        self.system.gaps(t, state)
    }

    fn gap(&self, surface: usize, t: f64, state: &Self::State) -> f64 {
        self.system.gap(surface, t, state)
    }

    fn gap_rates(&self, t: f64, state: &Self::State) -> Result<Self::Gaps, Fault> {
        self.at(t, state).gap_rates(t, state)
    }

    fn gap_along(
        &self,
        surface: usize,
        t: TaylorModel,
        component: &dyn Fn(usize) -> TaylorModel,
    ) -> TaylorModel {
        self.system.gap_along(surface, t, component)
    }

    fn gap_about(&self, surface: usize, t: Bent, component: &dyn Fn(usize) -> Bent) -> Bent {
        self.system.gap_about(surface, t, component)
    }

    fn gap_complex(
        &self,
        surface: usize,
        t: ComplexInterval,
        component: &dyn Fn(usize) -> ComplexInterval,
    ) -> ComplexInterval {
        self.system.gap_complex(surface, t, component)
    }

    fn gap_accelerations(
        &self,
        t: f64,
        state: &Self::State,
        motion: &Self::Impulse,
    ) -> Result<Option<Self::Gaps>, Fault> {
        self.system.gap_accelerations(t, state, motion)
    }

    fn gap_responses(
        &self,
        t: f64,
        state: &Self::State,
        motion: &Self::Impulse,
    ) -> Result<Option<Self::Gaps>, Fault> {
        self.system.gap_responses(t, state, motion)
    }

    fn surface_active(&self, surface: usize, t: f64, state: &Self::State) -> bool {
        self.system.surface_active(surface, t, state)
    }

    fn has_conditions(&self, surface: usize) -> bool {
        self.system.has_conditions(surface)
    }

    fn counts_along(&self, surface: usize, along: Along<'_>, rounding: Along<'_>) -> Option<bool> {
        self.system.counts_along(surface, along, rounding)
    }

    fn has_kinks(&self, surface: usize) -> bool {
        self.system.has_kinks(surface)
    }

    fn passes_kink(
        &self,
        surface: usize,
        start: Along<'_>,
        along: Along<'_>,
        rounding: Along<'_>,
    ) -> Option<bool> {
        self.system.passes_kink(surface, start, along, rounding)
    }

    fn takes(&self, surface: usize, t: f64, state: &Self::State) -> bool {
        self.system.takes(surface, t, state)
    }

    fn law(&self, surface: usize) -> Law {
        self.system.law(surface)
    }

    fn reset(
        &self,
        surface: usize,
        t: f64,
        state: &Self::State,
    ) -> Result<Option<Jump<Self::Vector>>, Fault> {
        self.at(t, state).reset(surface, t, state)
    }

    fn focus(
        &self,
        surface: usize,
        t: f64,
        state: &Self::State,
    ) -> Result<Option<Self::Impulse>, Fault> {
        self.system.focus(surface, t, state)
    }

    fn trace(
        &self,
        surface: usize,
        t: f64,
        state: &Self::State,
        motion: &Self::Impulse,
    ) -> Result<Option<Self::Impulse>, Fault> {
        self.system.trace(surface, t, state, motion)
    }

    fn is_passable(&self, surface: usize) -> bool {
        self.system.is_passable(surface)
    }

    fn opposite(&self, surface: usize) -> Option<usize> {
        self.system.opposite(surface)
    }

    fn lands_on(&self, surface: usize, other: usize) -> bool {
        self.system.lands_on(surface, other)
    }

    fn landing(
        &self,
        surface: usize,
        t: f64,
        state: &Self::State,
    ) -> Result<Landing<Self::State>, Outcome> {
        self.at(t, state).landing(surface, t, state)
    }

    fn blow(
        &self,
        surface: usize,
        t: f64,
        state: &Self::State,
    ) -> Result<Blow<Self::Impulse>, Fault> {
        self.system.blow(surface, t, state)
    }

    fn contact(
        &self,
        surface: usize,
        t: f64,
        state: &Self::State,
    ) -> Result<Contact<Self::Impulse>, Fault> {
        self.system.contact(surface, t, state)
    }
}

impl<Sys, F> Powered for Steered<Sys, F>
where
    Sys: Actuated + Powered,
    F: Fn(f64, &Sys::State) -> Sys::Inputs,
{
    type Powers = Sys::Powers;

    const POWERS: &'static [&'static str] = Sys::POWERS;

    fn powers(&self, t: f64, state: &Self::State) -> Result<Self::Powers, Fault> {
        self.at(t, state).powers(t, state)
    }
}
