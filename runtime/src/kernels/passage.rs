//! State at the entry into a mode: the declared one, or that of the transition principle.
//!
//! **Constraints change** (Cortes and Vinogradov, Definition 4.12). The Lagrangian is the same in both modes. The entry
//! state is the focusing point `P(p) + Q(Upsilon)`: its velocity is the nearest in the metric that satisfies the
//! constraints of the entered mode. The gap rates of the entered mode decide on which side the motion continues. A
//! transition that leads back is due at once. The sequence of both transitions is the admissible sequence at this
//! point.
//!
//! **The Lagrangian changes** (Definition 4.14). The constrained characteristic `p + c pi_D^* dh` through the momentum
//! belongs to the metric and the constraints of the mode that is left. Along it, the energy of the entered mode is
//! quadratic in `c`:
//!
//! ```text
//! H_+(p + c d) - H_-(p) + c d_t h = c^2 k/2 + c b + E,   d = pi_D^* dh,
//! k = d(g_+^{-1} d),   b = d(v_+(p)) + d_t h,   E = H_+(p) - H_-(p)
//! ```
//!
//! The root is the one for which the motion keeps its direction, `b + k c = -sqrt(b^2 - 2 k E)` (refraction). The
//! focusing point in the constraints of the entered mode follows. Without a real root the motion is reflected by the
//! elastic law and stays in its mode. If both are possible, both points are decisive points, and refraction takes
//! precedence.
//!
//! Reference: J. Cortes and A. M. Vinogradov, *Hamiltonian theory of constrained impulsive motion* (2006).

use super::{At, Declared, Form, HasSurfaces, Kernels, Part};
use super::{Passage, Transition};
use crate::contract::{Impacting, System};
use crate::error::{Fault, StateError};
use crate::law::{Landing, Law};
use crate::numbers::{Numbers, Row};
use crate::outcome::Outcome;
use crate::state::StateVector;

/// Largest discriminant that may be rounding error, relative to its terms. Below it the motion grazes the surface.
const GRAZE: f64 = 64.0 * f64::EPSILON;

/// The state in the mode that a surface leads to. `local` is the index of the surface in the mode that is left.
///
/// # Errors
/// The [`Outcome`] that ends the run: [`Outcome::Untaken`] where the surface has no transition, a fault, or a state
/// that is not finite, outside the chart of the entered mode or off its constraints.
pub(super) fn passage<S: Declared + HasSurfaces>(
    system: &S,
    (surface, local, transition): (usize, usize, Transition),
    t: f64,
    state: &S::State,
) -> Result<Landing<S::State>, Outcome> {
    let left = Part::of(system, state.as_slice());
    let entered = system.starting_in(transition.enters);
    if !system.takes(surface, t, state) {
        return Err(Outcome::Untaken { surface });
    }
    let after = match transition.passage {
        Passage::Declared => declared((&left, local), &entered, surface, t, state)?,
        Passage::Kept => Part::start(&entered).joined(state.as_slice(), &[]),
        Passage::Focused => focused(system, &entered, t, state)?,
        Passage::Refracted => return refracted(system, &left, &entered, surface, t, state),
    };
    Ok(Landing {
        state: checked(&entered, surface, t, after)?,
        is_graze: false,
        is_one_of_several: false,
    })
}

/// True if states of the part can violate its constraints.
fn can_leave_constraints<S: Declared>(part: &Part<'_, S>) -> bool {
    part.tables.form == Form::Global && part.tables.dimensions.constraints > 0
}

/// Returns the state if it is finite, inside the chart, and satisfies the position-level constraints.
fn checked<S: Declared>(
    entered: &S,
    surface: usize,
    t: f64,
    after: S::State,
) -> Result<S::State, Outcome> {
    let components = after.as_slice();
    if let Some(component) = components.iter().position(|value| !value.is_finite()) {
        return Err(Outcome::NonFinite { component });
    }
    if let Some(coordinate) = entered.outside_chart(&after) {
        return Err(Outcome::LeftChart { coordinate });
    }
    let mut fixed = entered.zero_vector();
    fixed.as_mut_slice().fill(1.0);
    let kept = entered.complete_position(t, &entered.position(&after), &fixed);
    kept.map_err(|error| off(error, surface))?;
    Ok(after)
}

/// The declared entry state, with velocities that satisfy the constraints of the mode.
fn declared<S: Declared>(
    (left, local): (&Part<'_, S>, usize),
    entered: &S,
    surface: usize,
    t: f64,
    state: &S::State,
) -> Result<S::State, Outcome> {
    let part = Part::start(entered);
    let n = part.lengths()[0];
    let count = match part.tables.form {
        Form::FirstOrder => n,
        _ => 2 * n,
    };
    let kernel = |kernels: &S::Kernels, at: At<'_, f64>, values: &mut [f64]| {
        kernels.entry(local, at, values)
    };
    let both = left.several((kernel, count), t, [state.as_slice(), &[]])?;
    let (mut q, mut qdot) = (entered.zero_vector(), entered.zero_vector());
    let (positions, velocities) = both.as_slice()[..count].split_at(n);
    q.as_mut_slice()[..n].copy_from_slice(positions);
    qdot.as_mut_slice()[..count - n].copy_from_slice(velocities);
    let [q, qdot] = [part.spread(q), part.spread(qdot)];
    let after = entered.state_unchecked(t, &q, &qdot)?;
    match entered.admit(t, &q, &qdot) {
        Err(error) => Err(off(error, surface)),
        Ok(()) => Ok(after),
    }
}

/// The outcome of a run whose entry state is rejected.
fn off(error: StateError, surface: usize) -> Outcome {
    match error {
        StateError::OffConstraint { constraint, .. }
        | StateError::OffPosition { constraint, .. } => Outcome::ResetOffConstraint {
            surface,
            constraint,
        },
        StateError::Fault(fault) => fault.into(),
        // No other error can come from the constraints.
        _ => Outcome::NonFinite { component: 0 },
    }
}

/// The focusing point `P(p) + Q(Upsilon)`: the state nearest in the metric that satisfies the constraints of the
/// entered mode.
fn focused<S: Declared>(
    left: &S,
    entered: &S,
    t: f64,
    state: &S::State,
) -> Result<S::State, Fault> {
    let q = left.position(state);
    match can_leave_constraints(&Part::start(entered)) {
        true => entered.state_nearest(t, &q, &left.velocity(t, state)?),
        // NOTE: without constraints the momenta keep all their digits.
        false => entered.state_from_momenta(t, &q, &left.momentum(t, state)?),
    }
}

/// Refraction, or reflection if there is no refraction.
fn refracted<S: Declared + HasSurfaces>(
    system: &S,
    left: &Part<'_, S>,
    entered: &S,
    surface: usize,
    t: f64,
    state: &S::State,
) -> Result<Landing<S::State>, Outcome> {
    let contact = system.contact(surface, t, state)?;
    let q = system.position(state);
    let p = system.momentum(t, state)?;
    let direction = covector(system, left, &contact.direction, t, state)?;
    let along = Along::new(entered, t, &q, &p, &direction)?;
    let quadratic = Quadratic {
        rate: along.rate + contact.surface_rate,
        compliance: along.compliance,
        excess: along.energy - system.energy(t, state)?,
    };
    let is_graze = quadratic.is_graze();
    let root = quadratic.root();
    let root = root.ok_or(Outcome::NonFinite { component: 0 })?;
    let Some(size) = root else {
        let blow = contact.blow(Law::Elastic);
        let mut after = *state;
        system.kick(&mut after, blow.size, &blow.direction);
        return Ok(Landing {
            state: after,
            is_graze,
            is_one_of_several: false,
        });
    };
    let z = along.at(size);
    let off = entered.state_from_momenta(t, &q, &z)?;
    let after = match can_leave_constraints(&Part::start(entered)) {
        true => entered.state_nearest(t, &q, &entered.velocity(t, &off)?)?,
        false => off,
    };
    Ok(Landing {
        state: checked(entered, surface, t, after)?,
        is_graze,
        is_one_of_several: true,
    })
}

/// The change of energy along a characteristic, `c^2 k/2 + c b + E`.
pub(super) struct Quadratic<L> {
    /// `b`
    pub rate: L,
    /// `k`
    pub compliance: L,
    /// `E`
    pub excess: L,
}

impl<L: Numbers> Quadratic<L> {
    fn discriminant(&self) -> L {
        self.rate * self.rate - L::of(2.0) * self.compliance * self.excess
    }

    /// The root after which the gap rate is `-sqrt(b^2 - 2 k E)`, computed without cancellation. `Some(None)` if there
    /// is no real root, `None` if its existence is undecided.
    pub fn root(&self) -> Option<Option<L>> {
        let discriminant = self.discriminant();
        if !(-discriminant).is_below_zero()? {
            return Some(None);
        }
        let root = discriminant.sqrt();
        Some(Some(match self.rate.is_below_zero()? {
            true => L::of(2.0) * self.excess / (root - self.rate),
            false => -(self.rate + root) / self.compliance,
        }))
    }
}

impl Quadratic<f64> {
    /// True if the sign of the discriminant may be a rounding error.
    fn is_graze(&self) -> bool {
        let terms = self.rate * self.rate + 2.0 * (self.compliance * self.excess).abs();
        self.discriminant().abs() <= GRAZE * terms
    }
}

/// The covector `pi_D^* dh`: change of the momenta by a unit impulse at rest.
fn covector<S: Declared>(
    system: &S,
    left: &Part<'_, S>,
    direction: &S::Impulse,
    t: f64,
    state: &S::State,
) -> Result<S::Vector, Fault> {
    let here = left.starting_here();
    let q = system.position(state);
    let mut kicked = here.state_unchecked(t, &q, &system.zero_vector())?;
    let rest = system.momentum(t, &kicked)?;
    system.kick(&mut kicked, 1.0, direction);
    let mut covector = system.momentum(t, &kicked)?;
    for (entry, rest) in covector.as_mut_slice().iter_mut().zip(rest.as_slice()) {
        *entry -= rest;
    }
    Ok(covector)
}

/// Data of the energy of a mode along `p + c d`, in the mode's global form, which admits momenta off its constraints.
struct Along<V> {
    p: V,
    direction: V,
    /// `H_+(p)`
    energy: f64,
    /// `d(v_+(p))`
    rate: f64,
    /// `d(g_+^{-1} d)`
    compliance: f64,
}

impl<V: StateVector> Along<V> {
    fn new<S: Declared<Vector = V>>(
        entered: &S,
        t: f64,
        q: &V,
        p: &V,
        direction: &V,
    ) -> Result<Self, Fault> {
        let part = Part::start(entered).globally();
        let [q, own_p, d] = [q, p, direction].map(|values| part.gathered(values));
        let velocity_at = |p: &V| -> Result<V, Fault> {
            let state = pair::<S>(part.lengths()[0], &q, p);
            part.coordinates(S::Kernels::velocity, t, [state.as_slice(), &[]])
        };
        let (steep, still) = (velocity_at(&d)?, velocity_at(&d.zeroed())?);
        let pairs = steep.as_slice().iter().zip(still.as_slice());
        let pairs = direction.as_slice().iter().zip(pairs);
        let start = pair::<S>(part.lengths()[0], &q, &own_p);
        let places = [start.as_slice(), &[][..]];
        Ok(Self {
            p: *p,
            direction: *direction,
            energy: part.number_by(S::Kernels::energy, t, places)?,
            rate: product(direction, &velocity_at(&own_p)?),
            compliance: pairs.map(|(d, (steep, still))| d * (steep - still)).sum(),
        })
    }

    /// `p + c d`
    fn at(&self, c: f64) -> V {
        let mut p = self.p;
        for (entry, d) in p.as_mut_slice().iter_mut().zip(self.direction.as_slice()) {
            *entry += c * d;
        }
        p
    }
}

/// A vector of `n` positions followed by `n` momenta.
fn pair<S: Declared>(n: usize, q: &S::Vector, p: &S::Vector) -> S::Room<f64> {
    let mut both = S::Room::<f64>::zeros(2 * n);
    let (positions, momenta) = both.as_mut_slice()[..2 * n].split_at_mut(n);
    positions.copy_from_slice(&q.as_slice()[..n]);
    momenta.copy_from_slice(&p.as_slice()[..n]);
    both
}

fn product<V: StateVector>(covector: &V, vector: &V) -> f64 {
    let pairs = covector.as_slice().iter().zip(vector.as_slice());
    pairs.map(|(a, b)| a * b).sum()
}
