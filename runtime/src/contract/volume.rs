//! Volumes that motions conserve or change.

use super::System;
use crate::error::Fault;

/// A system whose divergence with respect to the natural volume `mu_C` ([`InvariantVolume`]) was derived.
///
/// # Examples
///
/// ```
/// use dalembert::Divergence;
///
/// dalembert::model! {
///     pub Particle {
///         coordinates { x; y; z; }
///         lagrangian = (dot(x)^2 + dot(y)^2 + dot(z)^2)/2;
///         constraints { c: dot(z) - y*dot(x) = 0; }
///         claims { density: exact; }
///     }
/// }
///
/// // theta = y/(1 + y^2) dy: the logarithm of the density has this gradient.
/// let theta = Particle::default().density_form(0.0, &[0.0, 1.0, 0.0].into())?;
/// assert!((theta[1] - 0.5).abs() < 1e-15);
/// # Ok::<(), dalembert::Fault>(())
/// ```
#[diagnostic::on_unimplemented(message = "the divergence of `{Self}` was not derived")]
pub trait Divergence: System {
    /// Divergence of the motion on D* with respect to `mu_C` (the Leray quotient of the Liouville volume).
    ///
    /// # Errors
    /// A [`Fault`] where the metric or the constraints are singular.
    fn divergence(&self, t: f64, state: &Self::State) -> Result<f64, Fault>;

    /// The density form `theta = m_ab L_{W^a} eta^b` at a position: N components. Here `W^a = g^-1 eta^a`, and `m_ab`
    /// is the inverse of `m^ab = eta^a(W^b)`.
    ///
    /// # Errors
    /// A [`Fault`] where the metric or the constraints are singular.
    fn density_form(&self, t: f64, q: &Self::Vector) -> Result<Self::Vector, Fault>;
}

/// A system whose motion conserves a volume `exp(G) mu_C`, with `G` a function of the configuration (and of `t`, if
/// the system depends on it).
///
/// ```text
/// mu_C = det g / |det A_dep|  dq dv_ind
/// ```
///
/// is the natural volume on the states that satisfy the constraints, the quotient of the Liouville volume by the
/// constraint momenta. `v_ind` are the velocities of [`InvariantVolume::INDEPENDENT`]; the other ones follow from them,
/// and `A_dep` are their columns of the constraint forms. Without constraints it is the Liouville volume
/// `det g dq dv = dq dp`. Impacts by the law `elastic` keep `exp(G) mu_C` as well where the constraints are linear.
///
/// Implemented for models with a proved claim `density: exact`, `density: locally_exact`, or `density = EXPR` where
/// `EXPR` does not depend on velocities; then `G = ln |EXPR|`. If `G` has no closed form, it is computed as an
/// integral. If `G` is not even determined up to a constant, the trait is not implemented, and the notes in the
/// model's documentation say so.
///
/// At given parameters both logarithms are determined up to a constant: only their differences between configurations
/// are meaningful. `G` depends on the choice of the constraint forms, the volume does not.
///
/// # Examples
///
/// ```
/// use dalembert::InvariantVolume;
///
/// dalembert::model! {
///     pub Particle {
///         coordinates { x; y; z; }
///         lagrangian = (dot(x)^2 + dot(y)^2 + dot(z)^2)/2;
///         constraints { c: dot(z) - y*dot(x) = 0; }
///         claims { density: exact; }
///     }
/// }
///
/// // The density relative to mu_C is sqrt(1 + y^2), up to a constant factor.
/// let particle = Particle::default();
/// let [low, high] = [0.0, 1.0].map(|y| particle.log_density(0.0, &[0.0, y, 0.0].into()));
/// assert!((high? - low? - 2.0_f64.ln() / 2.0).abs() < 1e-15);
/// # Ok::<(), dalembert::Fault>(())
/// ```
///
/// # References
/// W. Clark and A. Bloch, *Invariant forms in hybrid and impact systems and a taming of Zeno*, Theorem 2.8: with linear
/// constraints that do not depend on time and without forces that depend on velocities, `exp(G) mu_C` is invariant iff
/// `dG = theta` on all velocities that the constraints allow, `theta` being [`Divergence::density_form`].
#[diagnostic::on_unimplemented(
    message = "`{Self}` has no invariant volume: declare `claims {{ density: exact; }}` in its `model!`, \
               or state the density where none is found"
)]
pub trait InvariantVolume: System {
    /// Indices of the coordinates whose velocities, together with the positions, are the coordinates of the volume.
    /// They are in increasing order, one for each dimension that the constraints leave.
    const INDEPENDENT: &'static [usize];

    /// True if `G` is a function of the configuration. Otherwise it grows by a constant with each turn of some angle,
    /// which is stored unwrapped.
    const IS_SINGLE_VALUED: bool;

    /// True if `G` has no closed form. It is then the integral of `dG` along the straight line from a regular
    /// configuration, computed to rounding. A singularity on that line gives [`Fault::SingularConstraint`].
    const IS_INTEGRAL: bool;

    /// `G`, the logarithm of the density with respect to `mu_C`.
    ///
    /// # Errors
    /// A [`Fault`] where the metric or the constraints in `G` are singular.
    fn log_density(&self, t: f64, q: &Self::Vector) -> Result<f64, Fault>;

    /// `G + ln det g - ln |det A_dep|`, the logarithm of the density of the volume in positions and independent
    /// velocities.
    ///
    /// # Errors
    /// The errors of [`InvariantVolume::log_density`]; [`Fault::SingularConstraint`] where the independent velocities
    /// do not determine the others.
    fn log_volume(&self, t: f64, q: &Self::Vector) -> Result<f64, Fault>;
}
