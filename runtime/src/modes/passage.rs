//! The state that a mode is entered with: as declared, or by the transition principle.
//!
//! **Constraints change** (Cortes and Vinogradov, Definition 4.12). The Lagrangian is the same on both sides. The mode is
//! entered with the focusing point `P(p) + Q(Upsilon)`: the velocity nearest in the metric that satisfies its constraints.
//! Whether that state goes on into the mode or back out of it is seen from the gap rates of the mode that is entered; a
//! transition that leads back is then due at once, and the sequence of both is the admissible sequence there.
//!
//! **The Lagrangian changes** (Definition 4.14). Along the constrained characteristic `p + c pi_D^* dh` through the momentum,
//! with the metric and the constraints of the mode that is left, the energy of the mode that is entered is a quadratic:
//!
//! ```text
//! H_+(p + c d) - H_-(p) + c d_t h = c^2 k/2 + c b + E,   d = pi_D^* dh,
//! k = d(g_+^{-1} d),   b = d(v_+(p)) + d_t h,   E = H_+(p) - H_-(p)
//! ```
//!
//! Of its two roots that is taken which goes on in the direction of the motion, `b + k c = -sqrt(b^2 - 2 k E)`: refraction;
//! then follows the focusing point in the constraints of the mode that is entered. Without a real root the motion is
//! reflected, by the elastic law, and stays in the mode. Where both are possible both are decisive points, and refraction
//! comes first.

use super::{Mode, StateOf, placed, taken};
use crate::contract::{Impacting, System};
use crate::error::{Fault, StateError};
use crate::law::{Landing, Law};
use crate::math;
use crate::outcome::Outcome;
use crate::state::StateVector;

/// A discriminant this small a part of its terms may be rounding: the motion then grazes the surface.
const GRAZE: f64 = 64.0 * f64::EPSILON;

/// What is known of a transition when it is compiled.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Passage {
    /// The state is declared.
    Declared,
    /// First-order systems: the position stays.
    Kept,
    /// Both modes have the same Lagrangian: the focusing point.
    Focused,
    /// The Lagrangian changes: refraction or reflection.
    Refracted,
}

/// As [`Impacting::landing`], at a surface that leads from the mode `M` to the mode `T`; `surface` is its place in `M`.
///
/// # Errors
/// An [`Outcome`] that ends the run: a fault, a state that is not finite, outside the chart of the mode that is entered or off
/// its constraints.
pub fn passage<M, T>(
    model: &M::Model,
    passage: Passage,
    [surface, place]: [usize; 2],
    t: f64,
    state: &StateOf<M>,
) -> Result<Landing<StateOf<M>>, Outcome>
where
    M: Mode + Impacting,
    T: Mode<Model = M::Model>,
{
    let (left, entered) = (M::of(model), T::of(model));
    let own = taken::<M>(state);
    if !left.takes(surface, t, &own) {
        return Err(Outcome::Untaken { surface: place });
    }
    let after = match passage {
        Passage::Declared => declared(&left, &entered, [surface, place], t, &own)?,
        Passage::Kept => converted(&own),
        Passage::Focused => focused(&left, &entered, t, &own)?,
        Passage::Refracted => return refracted(&left, &entered, [surface, place], t, &own),
    };
    Ok(Landing {
        state: checked(&entered, place, t, after)?,
        is_graze: false,
        is_one_of_several: false,
    })
}

/// The same components, of a vector of another name.
fn converted<V: StateVector, W: StateVector>(values: &V) -> W {
    let mut converted = W::zeros(W::CAPACITY);
    for (own, value) in converted.as_mut_slice().iter_mut().zip(values.as_slice()) {
        *own = *value;
    }
    converted
}

/// The state of the model, if it is finite, inside the chart, and where the equations of positions among the constraints hold.
fn checked<T: Mode>(
    entered: &T,
    place: usize,
    t: f64,
    after: T::State,
) -> Result<StateOf<T>, Outcome> {
    let components = after.as_slice();
    if let Some(component) = components.iter().position(|value| !value.is_finite()) {
        return Err(Outcome::NonFinite { component });
    }
    if let Some(coordinate) = entered.outside_chart(&after) {
        return Err(Outcome::LeftChart {
            coordinate: T::COORDINATES[coordinate],
        });
    }
    let mut fixed = T::Vector::zeros(T::Vector::CAPACITY);
    fixed.as_mut_slice().fill(1.0);
    let kept = entered.complete_position(t, &entered.position(&after), &fixed);
    kept.map_err(|error| off(error, place))?;
    Ok(placed::<T>(&after))
}

/// The declared state; its velocities satisfy the constraints of the mode.
fn declared<M: Mode + Impacting, T: Mode>(
    left: &M,
    entered: &T,
    [surface, place]: [usize; 2],
    t: f64,
    own: &M::State,
) -> Result<T::State, Outcome> {
    let (mut q, mut qdot) = (
        T::Vector::zeros(T::Vector::CAPACITY),
        T::Vector::zeros(T::Vector::CAPACITY),
    );
    left.entry(surface, t, own, q.as_mut_slice(), qdot.as_mut_slice())?;
    let after = entered.state_unchecked(t, &q, &qdot)?;
    match entered.admit(t, &q, &qdot) {
        Err(error) => Err(off(error, place)),
        Ok(()) => Ok(after),
    }
}

/// How a run ends where the mode that is entered refuses the state.
fn off(error: StateError, surface: usize) -> Outcome {
    match error {
        StateError::OffConstraint { constraint, .. }
        | StateError::OffPosition { constraint, .. } => Outcome::ResetOffConstraint {
            surface,
            constraint,
        },
        StateError::Fault(fault) => fault.into(),
        // Constraints refuse nothing else.
        _ => Outcome::NonFinite { component: 0 },
    }
}

/// `P(p) + Q(Upsilon)` in the constraints of the mode that is entered.
fn focused<M: Mode, T: Mode>(
    left: &M,
    entered: &T,
    t: f64,
    own: &M::State,
) -> Result<T::State, Fault> {
    let q = converted(&left.position(own));
    if T::CAN_LEAVE_CONSTRAINTS {
        let qdot = converted(&left.velocity(t, own)?);
        return entered.state_nearest(t, &q, &qdot);
    }
    // NOTE: without constraints momenta are kept to the last digit.
    entered.state_from_momenta(t, &q, &converted(&left.momentum(t, own)?))
}

/// Refraction, or reflection where there is none.
fn refracted<M, T>(
    left: &M,
    entered: &T,
    [surface, place]: [usize; 2],
    t: f64,
    own: &M::State,
) -> Result<Landing<StateOf<M>>, Outcome>
where
    M: Mode + Impacting,
    T: Mode<Model = M::Model>,
{
    let contact = left.contact(surface, t, own)?;
    let reflected = || {
        let blow = contact.blow(Law::Elastic);
        let mut after = *own;
        left.kick(&mut after, blow.size, &blow.direction);
        placed::<M>(&after)
    };
    let q: T::Vector = converted(&left.position(own));
    let p: T::Vector = converted(&left.momentum(t, own)?);
    let direction = covector(left, &contact.direction, t, own)?;
    let along = Along::new(entered, t, &q, &p, &converted(&direction))?;
    let rate = along.rate + contact.surface_rate;
    let excess = along.energy - left.energy(t, own)?;
    let terms = rate * rate + 2.0 * (along.compliance * excess).abs();
    let discriminant = rate * rate - 2.0 * along.compliance * excess;
    let is_graze = discriminant.abs() <= GRAZE * terms;
    if discriminant <= 0.0 {
        return Ok(Landing {
            state: reflected(),
            is_graze,
            is_one_of_several: false,
        });
    }
    let root = math::sqrt(discriminant);
    // The root with the rate `-root` after it, without cancellation.
    let size = match rate < 0.0 {
        true => 2.0 * excess / (root - rate),
        false => -(rate + root) / along.compliance,
    };
    let z = along.at(size);
    let after = match T::CAN_LEAVE_CONSTRAINTS {
        true => {
            let off = entered.state_from_momenta(t, &q, &z)?;
            let qdot = entered.velocity(t, &off)?;
            entered.state_nearest(t, &q, &qdot)?
        }
        false => entered.state_from_momenta(t, &q, &z)?,
    };
    Ok(Landing {
        state: checked(entered, place, t, after)?,
        is_graze,
        is_one_of_several: true,
    })
}

/// `pi_D^* dh` as a covector, from how an impulse changes the momenta at rest.
fn covector<M: Mode>(
    left: &M,
    direction: &M::Impulse,
    t: f64,
    own: &M::State,
) -> Result<M::Vector, Fault> {
    let q = left.position(own);
    let mut kicked = left.state_unchecked(t, &q, &M::Vector::zeros(M::Vector::CAPACITY))?;
    let rest = left.momentum(t, &kicked)?;
    left.kick(&mut kicked, 1.0, direction);
    let mut covector = left.momentum(t, &kicked)?;
    for (own, rest) in covector.as_mut_slice().iter_mut().zip(rest.as_slice()) {
        *own -= rest;
    }
    Ok(covector)
}

/// The energy of a mode along `p + c d`, off its constraints too.
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
    fn new<T: Mode<Vector = V>>(
        entered: &T,
        t: f64,
        q: &V,
        p: &V,
        direction: &V,
    ) -> Result<Self, Fault> {
        let global = entered.global();
        let start = global.state_from_momenta(t, q, p)?;
        let velocity_at = |p: &V| -> Result<V, Fault> {
            global.velocity(t, &global.state_from_momenta(t, q, p)?)
        };
        let (steep, still) = (
            velocity_at(direction)?,
            velocity_at(&V::zeros(V::CAPACITY))?,
        );
        let pairs = steep.as_slice().iter().zip(still.as_slice());
        let pairs = direction.as_slice().iter().zip(pairs);
        Ok(Self {
            p: *p,
            direction: *direction,
            energy: global.energy(t, &start)?,
            rate: product(direction, &global.velocity(t, &start)?),
            compliance: pairs.map(|(d, (steep, still))| d * (steep - still)).sum(),
        })
    }

    /// `p + c d`
    fn at(&self, c: f64) -> V {
        let mut p = self.p;
        for (own, d) in p.as_mut_slice().iter_mut().zip(self.direction.as_slice()) {
            *own += c * d;
        }
        p
    }
}

fn product<V: StateVector>(covector: &V, vector: &V) -> f64 {
    let pairs = covector.as_slice().iter().zip(vector.as_slice());
    pairs.map(|(a, b)| a * b).sum()
}
