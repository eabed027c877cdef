//! States after impacts, and the quantities from which the impact laws are evaluated.

use crate::state::StateVector;

pub use dalembert_numbers::law::Law;

/// The state after a reset or a transition.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Landing<S> {
    /// The state.
    pub state: S,
    /// True if rounding may have decided between two possible continuations.
    pub is_graze: bool,
    /// True if the motion could continue from other states as well.
    pub is_one_of_several: bool,
}

impl<S> From<S> for Landing<S> {
    fn from(state: S) -> Self {
        Self {
            state,
            is_graze: false,
            is_one_of_several: false,
        }
    }
}

/// Positions and velocities after a reset.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Jump<V> {
    /// q, N numbers.
    pub position: V,
    /// qdot, N numbers.
    pub velocity: V,
}

/// Effect of an impact law that is an impulse on a state.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Blow<V> {
    /// The impulse is `size * direction`.
    pub size: f64,
    /// Share of the gap rate that the impulse removes: 2 reverses it, 1 ends it.
    pub share: f64,
    /// Direction in the form of [`System::kick`](crate::System::kick); a multiple of [`Contact::direction`].
    pub direction: V,
}

/// Quantities of an impact at a state, sufficient to evaluate every law. Derived and emitted for each surface.
///
/// # Examples
///
/// ```
/// use dalembert::{Contact, Law};
/// use nalgebra::SVector;
///
/// // A ball of mass 2 that meets a wall across its path at speed 3: h = x.
/// let contact = Contact {
///     gap_rate: -3.0,
///     constrained_rate: -3.0,
///     surface_rate: 0.0,
///     constrained_compliance: 0.5,
///     free_compliance: 0.5,
///     direction: SVector::from([1.0]),
/// };
/// assert_eq!(contact.impulse(Law::Elastic), 12.0);
/// assert_eq!(contact.gap_rate_after(contact.impulse(Law::Newton(0.5))), 1.5);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Contact<V> {
    /// `dh(qdot) + d_t h` before the impact; negative at an impact.
    pub gap_rate: f64,
    /// `P(pi_D grad h)`: the momentum along the projected gradient.
    pub constrained_rate: f64,
    /// `d_t h`, the speed of a moving surface; 0 for a surface at rest.
    pub surface_rate: f64,
    /// `dh(pi_D grad h)`.
    pub constrained_compliance: f64,
    /// `dh(grad h)`.
    pub free_compliance: f64,
    /// Direction of the impulse, in the form of [`System::kick`](crate::System::kick): `pi_D^* dh` for momenta,
    /// `G_D^{-1} X^T dh` for quasi-velocities.
    pub direction: V,
}

impl<V: StateVector> Contact<V> {
    /// `rho = dh(pi_D grad h) / dh(grad h)`, in \[0, 1\]; 1 without constraints.
    pub fn rho(&self) -> f64 {
        self.constrained_compliance / self.free_compliance
    }

    /// Impulse of a law; NaN for laws that are no impulse.
    pub fn blow(&self, law: Law) -> Blow<V> {
        Blow {
            size: self.impulse(law),
            share: self.rate_taken(law) / self.gap_rate,
            direction: self.direction,
        }
    }

    /// Size `eps` of the impulse: `p+ = p + eps pi_D^* dh`. NaN for laws that are no impulse.
    pub fn impulse(&self, law: Law) -> f64 {
        -self.rate_taken(law) / self.constrained_compliance
    }

    /// Amount that a law subtracts from the gap rate; NaN for laws that are no impulse.
    pub fn rate_taken(&self, law: Law) -> f64 {
        let scalars = [
            self.gap_rate,
            self.constrained_rate,
            self.surface_rate,
            self.constrained_compliance,
            self.free_compliance,
        ];
        law.taken(law.coefficient().unwrap_or(0.0), &scalars)
    }

    /// The gap rate after an impulse of size `eps`.
    pub fn gap_rate_after(&self, eps: f64) -> f64 {
        self.gap_rate + eps * self.constrained_compliance
    }
}
