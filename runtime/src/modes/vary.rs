//! Transitions and gaps of the whole over [`Numbers`], by those of its modes: what first variations need.
//!
//! Here a state belongs to one motion, so that its mode is that of the first lane.

use super::{Mode, Passage};
use crate::contract::Variational;
use crate::error::Fault;
use crate::kernels::{At, Declared, energy_over, enter_over, nearest_over};
use crate::law::Law;
use crate::numbers::{Interval, Numbers, Row};

/// A mode whose transitions can be computed in any [`Numbers`]. Implemented by `model!`.
pub trait VariationalMode: Mode + Variational + Declared {
    /// Whether the state holds momenta behind the positions: it is not reduced to the constraints, and of second order.
    const HOLDS_MOMENTA: bool;

    /// As [`System::state_nearest`](crate::System::state_nearest).
    ///
    /// # Errors
    /// [`Fault`].
    fn nearest<L: Numbers>(
        &self,
        parameters: &Self::Parameters<L>,
        t: L,
        q: &Self::Configuration<L>,
        qdot: &Self::Configuration<L>,
    ) -> Result<Self::Row<L>, Fault> {
        let places = [q.as_slice(), qdot.as_slice()];
        nearest_over::<Self, L, _>(self, (parameters.as_slice(), t), places)
    }

    /// As [`System::energy`](crate::System::energy).
    ///
    /// # Errors
    /// [`Fault`].
    fn energy_of<L: Numbers>(
        &self,
        parameters: &Self::Parameters<L>,
        t: L,
        state: &Self::Row<L>,
    ) -> Result<L, Fault> {
        energy_over::<Self, L>(self, (parameters.as_slice(), t), state.as_slice())
    }
}

/// The mode that a row of numbers is a state of.
#[inline]
pub fn index_of<L: Numbers>(state: &[L]) -> usize {
    let number = state.last().map_or(0.0, |number| number.lane(0));
    // NOTE: the conversion saturates.
    (number + 0.5) as usize
}

/// The first numbers of a row.
fn beginning<L: Numbers, R: Row<L>>(values: &[L]) -> R {
    let mut row = R::zeros(R::CAPACITY);
    for (own, value) in row.as_mut_slice().iter_mut().zip(values) {
        *own = *value;
    }
    row
}

/// Numbers of the mode at their places among those of the model, and this number elsewhere.
fn filled<L: Numbers, R: Row<L>>(values: &[L], places: &[usize], elsewhere: f64) -> R {
    let mut row = R::zeros(R::CAPACITY);
    row.as_mut_slice().fill(L::of(elsewhere));
    for (&place, value) in places.iter().zip(values) {
        row.as_mut_slice()[place] = *value;
    }
    row
}

/// The state of the model that is this one of the mode.
fn placed<M: Mode, L: Numbers, R: Row<L>>(own: &M::Row<L>) -> R {
    let mut state: R = beginning(own.as_slice());
    if let Some(last) = state.as_mut_slice().last_mut() {
        *last = L::of(M::INDEX as f64);
    }
    state
}

/// As [`Variational::velocities`].
///
/// # Errors
/// That of the mode.
pub fn velocities_of<M: VariationalMode, L: Numbers, R: Row<L>>(
    model: &M::Model,
    parameters: &[L],
    t: L,
    state: &[L],
) -> Result<R, Fault> {
    let velocities = M::of(model).velocities(&beginning(parameters), t, &beginning(state))?;
    Ok(filled(velocities.as_slice(), M::COORDINATES, 0.0))
}

/// As [`Variational::deviations`]: those of the mode, then the components of the state that it does not use and the number
/// of the mode, which no variation changes; zeros to the end.
///
/// # Errors
/// That of the mode.
pub fn deviations_of<M: VariationalMode, L: Numbers, R: Row<L>>(
    model: &M::Model,
    parameters: &[L],
    t: L,
    state: &[L],
) -> Result<R, Fault> {
    let deviations = M::of(model).deviations(&beginning(parameters), t, &beginning(state))?;
    let unused = &state[M::Row::<L>::CAPACITY..];
    let mut all = R::zeros(R::CAPACITY);
    let values = deviations.as_slice().iter().chain(unused);
    for (place, value) in all.as_mut_slice().iter_mut().zip(values) {
        *place = *value;
    }
    Ok(all)
}

/// As [`Variational::counts_throughout`]; a surface that the mode does not have does not count.
pub fn counts_throughout_of<M: VariationalMode>(
    model: &M::Model,
    parameters: &[Interval],
    surface: usize,
    t: Interval,
    state: &[Interval],
) -> Option<bool> {
    match super::embed::own_surface::<M>(surface) {
        Some(own) => {
            M::of(model).counts_throughout(&beginning(parameters), own, t, &beginning(state))
        }
        None => Some(false),
    }
}

/// As [`Variational::clearances`]; 1 for surfaces that the mode does not have.
///
/// # Errors
/// That of the mode.
pub fn clearances_of<M: VariationalMode, L: Numbers, R: Row<L>>(
    model: &M::Model,
    parameters: &[L],
    t: L,
    state: &[L],
) -> Result<R, Fault> {
    let gaps = M::of(model).clearances(&beginning(parameters), t, &beginning(state))?;
    Ok(filled(gaps.as_slice(), M::SURFACES, 1.0))
}

/// As [`Variational::collision`].
///
/// # Errors
/// That of the mode.
pub fn collision_of<M: VariationalMode, L: Numbers, R: Row<L>>(
    model: &M::Model,
    parameters: &[L],
    surface: usize,
    t: L,
    state: &[L],
) -> Result<R, Fault> {
    let own = super::embed::known_surface::<M>(surface)?;
    let collision = M::of(model).collision(&beginning(parameters), own, t, &beginning(state))?;
    Ok(beginning(collision.as_slice()))
}

/// As [`Variational::focus`].
///
/// # Errors
/// That of the mode.
pub fn focus_of<M: VariationalMode, L: Numbers, R: Row<L>>(
    model: &M::Model,
    parameters: &[L],
    surface: usize,
    t: L,
    state: &[L],
) -> Result<Option<R>, Fault> {
    let own = super::embed::known_surface::<M>(surface)?;
    let focused = M::of(model).focus(&beginning(parameters), own, t, &beginning(state))?;
    Ok(focused.map(|focused| placed::<M, L, R>(&focused)))
}

/// As [`Variational::trace`]. Neither the mode nor what it does not use has a rate.
///
/// # Errors
/// That of the mode.
pub fn trace_of<M: VariationalMode, L: Numbers, R: Row<L>>(
    model: &M::Model,
    parameters: &[L],
    surface: usize,
    t: L,
    state: &[L],
    rate: &[L],
) -> Result<Option<R>, Fault> {
    let own = super::embed::known_surface::<M>(surface)?;
    let (state, rate) = (beginning(state), beginning(rate));
    let traced = M::of(model).trace(&beginning(parameters), own, t, &state, &rate)?;
    Ok(traced.map(|traced| beginning(traced.as_slice())))
}

/// As [`Variational::declared_law`]; `surface` is the place in the mode.
pub fn declared_law_of<M: VariationalMode, L: Numbers>(
    model: &M::Model,
    parameters: &[L],
    surface: usize,
) -> (Law, L) {
    M::of(model).declared_law(&beginning(parameters), surface)
}

/// As [`Variational::passed`], of a reset that stays in the mode.
///
/// # Errors
/// That of the mode.
pub fn passed_within<M: VariationalMode, L: Numbers, R: Row<L>>(
    model: &M::Model,
    parameters: &[L],
    surface: usize,
    t: L,
    state: &[L],
) -> Result<Option<R>, Fault> {
    let own = super::embed::known_surface::<M>(surface)?;
    let after = M::of(model).passed(&beginning(parameters), own, t, &beginning(state))?;
    Ok(after.map(|after| placed::<M, L, R>(&after)))
}

/// As [`Variational::passed`], at a surface that leads from the mode `M` to the mode `T`; `surface` is its place in `M`. `None`
/// where the Lagrangian changes and the state of one of both holds no momenta.
///
/// # Errors
/// Those of the modes.
pub fn passed_into<
    M: VariationalMode,
    T: VariationalMode<Model = M::Model>,
    L: Numbers,
    R: Row<L>,
>(
    model: &M::Model,
    parameters: &[L],
    passage: Passage,
    surface: usize,
    t: L,
    state: &[L],
) -> Result<Option<R>, Fault> {
    let (left, right) = (M::of(model), T::of(model));
    let before: M::Parameters<L> = beginning(parameters);
    let after: T::Parameters<L> = beginning(parameters);
    let own: M::Row<L> = beginning(state);
    let entered: T::Row<L> = match passage {
        Passage::Declared => {
            let [mut q, mut qdot] =
                [T::Configuration::<L>::zeros(T::Configuration::<L>::CAPACITY); 2];
            let at = At {
                parameters: before.as_slice(),
                t,
                first: own.as_slice(),
                second: &[],
            };
            enter_over::<M, L>(&left, surface, at, [q.as_mut_slice(), qdot.as_mut_slice()])?;
            right.composed(&after, t, &q, &qdot)?
        }
        Passage::Kept => beginning(own.as_slice()),
        Passage::Focused => {
            let qdot = left.velocities(&before, t, &own)?;
            let qdot = beginning(qdot.as_slice());
            right.nearest(&after, t, &beginning(own.as_slice()), &qdot)?
        }
        Passage::Refracted if M::HOLDS_MOMENTA && T::HOLDS_MOMENTA => {
            return refracted::<M, T, L, R>((&left, &before), (&right, &after), surface, t, &own);
        }
        Passage::Refracted => return Ok(None),
    };
    Ok(Some(placed::<T, L, R>(&entered)))
}

/// Refraction, or reflection where there is none, of momenta: the formulas are those of `passage.rs`. `None` where it is not certain
/// which.
fn refracted<M: VariationalMode, T: VariationalMode, L: Numbers, R: Row<L>>(
    (left, before): (&M, &M::Parameters<L>),
    (right, after): (&T, &T::Parameters<L>),
    surface: usize,
    t: L,
    own: &M::Row<L>,
) -> Result<Option<R>, Fault> {
    let n = M::Configuration::<L>::CAPACITY;
    let collision = left.collision(before, surface, t, own)?;
    // NOTE: the third number of a contact is the rate of the surface itself, behind the fifth comes the direction.
    let (surface_rate, direction) = (collision.as_slice()[2], &collision.as_slice()[5..]);
    let with_momenta = |momenta: &dyn Fn(usize) -> L| {
        let mut row: T::Row<L> = beginning(own.as_slice());
        for (i, p) in row.as_mut_slice()[n..].iter_mut().enumerate() {
            *p = momenta(i);
        }
        row
    };
    let through = |momenta: &dyn Fn(usize) -> L| -> Result<L, Fault> {
        let velocities = right.velocities(after, t, &with_momenta(momenta))?;
        let pairs = direction.iter().zip(velocities.as_slice());
        Ok(pairs.fold(L::ZERO, |sum, (d, v)| d.mul_add(*v, sum)))
    };
    let p = |i: usize| own.as_slice()[n + i];
    let rate = through(&p)? + surface_rate;
    let compliance = through(&|i| direction[i])? - through(&|_| L::ZERO)?;
    let excess = right.energy_of(after, t, &with_momenta(&p))? - left.energy_of(before, t, own)?;
    let discriminant = rate * rate - L::of(2.0) * compliance * excess;
    let Some(is_refracted) = (-discriminant).is_below_zero() else {
        return Ok(None);
    };
    if !is_refracted {
        let mut reflected = *own;
        Law::Elastic.strike(
            L::ZERO,
            collision.as_slice(),
            &mut reflected.as_mut_slice()[n..],
        );
        return Ok(Some(placed::<M, L, R>(&reflected)));
    }
    let root = discriminant.sqrt();
    let size = match rate.is_below_zero() {
        Some(true) => L::of(2.0) * excess / (root - rate),
        Some(false) => -(rate + root) / compliance,
        None => return Ok(None),
    };
    let beyond = with_momenta(&|i| size.mul_add(direction[i], p(i)));
    let entered = match T::CAN_LEAVE_CONSTRAINTS {
        true => {
            let qdot = right.velocities(after, t, &beyond)?;
            right.nearest(after, t, &beginning(own.as_slice()), &qdot)?
        }
        false => beyond,
    };
    Ok(Some(placed::<T, L, R>(&entered)))
}
