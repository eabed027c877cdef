//! The state of a mode in that of the model, and what the model answers by asking the mode.
//!
//! What a mode does not have is 0: its coordinates, velocities and momenta. Gaps of surfaces that it does not have are 1, their
//! rates 0, so that they are neither met nor neared.

use super::{Mode, StateOf};
use crate::contract::{Impacting, Keep, RankDrop};
use crate::describe::{Initial, Report};
use crate::error::{Fault, StateError};
use crate::generated::OverNumbers;
use crate::law::{Blow, Contact, Landing};
use crate::numbers::{Numbers, Row};
use crate::outcome::Outcome;
use crate::state::StateVector;

/// The mode that a state is of.
#[inline(always)]
pub fn index<S: StateVector>(state: &S) -> usize {
    let number = state.as_slice().last().copied().unwrap_or(0.0);
    // NOTE: the conversion saturates. A step that estimates derivatives may move every component a little.
    (number + 0.5) as usize
}

/// The longest of several lengths.
pub const fn longest(lengths: &[usize]) -> usize {
    let (mut longest, mut k) = (0, 0);
    while k < lengths.len() {
        if lengths[k] > longest {
            longest = lengths[k];
        }
        k += 1;
    }
    longest
}

/// What a mode knows at a moment besides rates and gaps.
pub const fn rest<M: Mode>() -> usize {
    M::Firsts::<f64>::CAPACITY - M::Row::<f64>::CAPACITY - M::Gaps::<f64>::CAPACITY
}

/// Writes values to where they belong; both have the same length.
#[inline(always)]
pub fn write<T: Copy>(to: &mut [T], values: &[T]) {
    for (to, value) in to.iter_mut().zip(values) {
        *to = *value;
    }
}

/// The state of the mode in a state of the model.
#[inline(always)]
pub fn taken<M: Mode>(state: &StateOf<M>) -> M::State {
    let mut own = M::State::zeros(M::State::CAPACITY);
    for (own, value) in own.as_mut_slice().iter_mut().zip(state.as_slice()) {
        *own = *value;
    }
    own
}

/// The state of the model that is this one of the mode.
#[inline(always)]
pub fn placed<M: Mode>(own: &M::State) -> StateOf<M> {
    let mut state = StateOf::<M>::zeros(StateOf::<M>::CAPACITY);
    for (value, own) in state.as_mut_slice().iter_mut().zip(own.as_slice()) {
        *value = *own;
    }
    if let Some(last) = state.as_mut_slice().last_mut() {
        *last = M::INDEX as f64;
    }
    state
}

/// Values of the mode at their places among those of the model; 0 elsewhere.
#[inline(always)]
fn scattered<V: StateVector>(values: &[f64], places: &[usize]) -> V {
    filled(values, places, 0.0)
}

/// Values of the mode at their places among those of the model, and this number elsewhere.
#[inline(always)]
fn filled<V: StateVector>(values: &[f64], places: &[usize], elsewhere: f64) -> V {
    let mut all = V::zeros(V::CAPACITY);
    all.as_mut_slice().fill(elsewhere);
    for (&place, value) in places.iter().zip(values) {
        all.as_mut_slice()[place] = *value;
    }
    all
}

/// Those of the model's values that the mode has.
#[inline(always)]
fn gathered<V: StateVector>(values: &impl StateVector, places: &[usize]) -> V {
    let mut own = V::zeros(V::CAPACITY);
    for (own, &place) in own.as_mut_slice().iter_mut().zip(places) {
        *own = values.as_slice()[place];
    }
    own
}

/// The first components of a longer vector.
#[inline(always)]
fn beginning<V: StateVector>(values: &impl StateVector) -> V {
    let mut own = V::zeros(V::CAPACITY);
    for (own, value) in own.as_mut_slice().iter_mut().zip(values.as_slice()) {
        *own = *value;
    }
    own
}

/// As [`VectorField::rate`](crate::VectorField::rate).
#[inline(always)]
pub fn rate<M: Mode>(
    model: &M::Model,
    t: f64,
    state: &StateOf<M>,
    rate: &mut StateOf<M>,
) -> Result<(), Fault> {
    let mut own = M::State::zeros(M::State::CAPACITY);
    M::of(model).rate(t, &taken::<M>(state), &mut own)?;
    *rate = beginning(&own);
    Ok(())
}

/// As [`VectorField::scale`](crate::VectorField::scale); 1 for what the mode does not have.
#[inline(always)]
pub fn scale<M: Mode>(model: &M::Model, t: f64, state: &StateOf<M>) -> StateOf<M> {
    let own = M::of(model).scale(t, &taken::<M>(state));
    let mut scale = StateOf::<M>::zeros(StateOf::<M>::CAPACITY);
    scale.as_mut_slice().fill(1.0);
    for (value, own) in scale.as_mut_slice().iter_mut().zip(own.as_slice()) {
        *value = *own;
    }
    scale
}

/// As [`System::position`](crate::System::position).
#[inline(always)]
pub fn position<M: Mode, V: StateVector>(model: &M::Model, state: &StateOf<M>) -> V {
    let own = M::of(model).position(&taken::<M>(state));
    scattered(own.as_slice(), M::COORDINATES)
}

/// As [`System::velocity`](crate::System::velocity).
///
/// # Errors
/// That of the mode.
#[inline(always)]
pub fn velocity<M: Mode, V: StateVector>(
    model: &M::Model,
    t: f64,
    state: &StateOf<M>,
) -> Result<V, Fault> {
    let own = M::of(model).velocity(t, &taken::<M>(state))?;
    Ok(scattered(own.as_slice(), M::COORDINATES))
}

/// As [`System::momentum`](crate::System::momentum).
///
/// # Errors
/// That of the mode.
pub fn momentum<M: Mode, V: StateVector>(
    model: &M::Model,
    t: f64,
    state: &StateOf<M>,
) -> Result<V, Fault> {
    let own = M::of(model).momentum(t, &taken::<M>(state))?;
    Ok(scattered(own.as_slice(), M::COORDINATES))
}

/// As [`System::energy`](crate::System::energy).
///
/// # Errors
/// That of the mode.
#[inline(always)]
pub fn energy<M: Mode>(model: &M::Model, t: f64, state: &StateOf<M>) -> Result<f64, Fault> {
    M::of(model).energy(t, &taken::<M>(state))
}

/// As [`System::kick`](crate::System::kick).
#[inline(always)]
pub fn kick<M: Mode>(
    model: &M::Model,
    state: &mut StateOf<M>,
    size: f64,
    direction: &impl StateVector,
) {
    let mut own = taken::<M>(state);
    M::of(model).kick(&mut own, size, &beginning(direction));
    *state = placed::<M>(&own);
}

/// As [`System::outside_chart`](crate::System::outside_chart).
#[inline(always)]
pub fn outside_chart<M: Mode>(model: &M::Model, state: &StateOf<M>) -> Option<usize> {
    let own = M::of(model).outside_chart(&taken::<M>(state))?;
    M::COORDINATES.get(own).copied()
}

/// As [`System::rank_drop`](crate::System::rank_drop), along motion in the mode.
pub fn rank_drop<M: Mode>(
    model: &M::Model,
    motion: impl Fn(f64) -> (f64, StateOf<M>),
    reach: f64,
) -> Option<RankDrop> {
    let own = |theta: f64| {
        let (t, state) = motion(theta);
        (t, taken::<M>(&state))
    };
    M::of(model).rank_drop(own, reach)
}

/// The state of the model that the mode makes of these of its coordinates and their rates or momenta.
fn made<M: Mode, V: StateVector>(
    given: [&V; 2],
    make: impl FnOnce(&M::Vector, &M::Vector) -> Result<M::State, Fault>,
) -> Result<StateOf<M>, Fault> {
    let [q, rates] = given.map(|values| gathered(values, M::COORDINATES));
    Ok(placed::<M>(&make(&q, &rates)?))
}

/// As [`System::state_unchecked`](crate::System::state_unchecked), in this mode.
///
/// # Errors
/// That of the mode.
pub fn state_unchecked<M: Mode, V: StateVector>(
    model: &M::Model,
    t: f64,
    q: &V,
    qdot: &V,
) -> Result<StateOf<M>, Fault> {
    made::<M, V>([q, qdot], |q, qdot| {
        M::of(model).state_unchecked(t, q, qdot)
    })
}

/// As [`System::state_from_momenta`](crate::System::state_from_momenta), in this mode.
///
/// # Errors
/// That of the mode.
pub fn state_from_momenta<M: Mode, V: StateVector>(
    model: &M::Model,
    t: f64,
    q: &V,
    p: &V,
) -> Result<StateOf<M>, Fault> {
    made::<M, V>([q, p], |q, p| M::of(model).state_from_momenta(t, q, p))
}

/// As [`System::state_nearest`](crate::System::state_nearest), in this mode.
///
/// # Errors
/// That of the mode.
pub fn state_nearest<M: Mode, V: StateVector>(
    model: &M::Model,
    t: f64,
    q: &V,
    qdot: &V,
) -> Result<StateOf<M>, Fault> {
    made::<M, V>([q, qdot], |q, qdot| M::of(model).state_nearest(t, q, qdot))
}

/// As [`System::admit`](crate::System::admit), in this mode. A constraint is named by its place in the mode.
///
/// # Errors
/// That of the mode.
pub fn admit<M: Mode, V: StateVector>(
    model: &M::Model,
    t: f64,
    q: &V,
    qdot: &V,
) -> Result<(), StateError> {
    let [q, qdot] = [q, qdot].map(|values| gathered(values, M::COORDINATES));
    M::of(model).admit(t, &q, &qdot)
}

/// As [`System::carried`](crate::System::carried), of a state in this mode.
///
/// # Errors
/// That of the mode.
pub fn carried<M: Mode>(
    model: &M::Model,
    from: &M::Model,
    t: f64,
    state: &StateOf<M>,
    keep: Keep,
) -> Result<StateOf<M>, StateError> {
    let own = M::of(model).carried(&M::of(from), t, &taken::<M>(state), keep)?;
    Ok(placed::<M>(&own))
}

/// As [`System::complete_position`](crate::System::complete_position), in this mode.
///
/// # Errors
/// That of the mode.
pub fn complete_position<M: Mode, V: StateVector>(
    model: &M::Model,
    t: f64,
    q: &V,
    placed: &V,
) -> Result<V, StateError> {
    let [q, placed] = [q, placed].map(|values| gathered(values, M::COORDINATES));
    let own = M::of(model).complete_position(t, &q, &placed)?;
    Ok(scattered(own.as_slice(), M::COORDINATES))
}

/// As [`System::complete_velocity`](crate::System::complete_velocity), in this mode.
///
/// # Errors
/// That of the mode.
pub fn complete_velocity<M: Mode, V: StateVector>(
    model: &M::Model,
    t: f64,
    q: &V,
    qdot: &V,
    named: &V,
) -> Result<V, StateError> {
    let [q, qdot, named] = [q, qdot, named].map(|values| gathered(values, M::COORDINATES));
    let own = M::of(model).complete_velocity(t, &q, &qdot, &named)?;
    Ok(scattered(own.as_slice(), M::COORDINATES))
}

/// The place of a surface of the model in the mode, if it has it.
#[inline(always)]
pub(super) fn own_surface<M: Mode>(surface: usize) -> Option<usize> {
    M::SURFACES.iter().position(|&own| own == surface)
}

/// The place of a surface in the mode.
pub(super) fn known_surface<M: Mode>(surface: usize) -> Result<usize, Fault> {
    own_surface::<M>(surface).ok_or(Fault::SingularSurface { surface })
}

/// As [`Impacting::gaps`].
#[inline(always)]
pub fn gaps<M: Mode + Impacting, G: StateVector>(
    model: &M::Model,
    t: f64,
    state: &StateOf<M>,
) -> G {
    let own = M::of(model).gaps(t, &taken::<M>(state));
    filled(own.as_slice(), M::SURFACES, 1.0)
}

/// As [`OverNumbers::gap_over`], of a surface of the mode; that of a state in another mode is never met.
pub fn gap_over<M: Mode + OverNumbers, L: Numbers>(
    model: &M::Model,
    surface: usize,
    t: L,
    component: &dyn Fn(usize) -> L,
) -> L {
    let number = component(StateOf::<M>::CAPACITY - 1).lane(0);
    match (number + 0.5) as usize == M::INDEX {
        true => M::of(model).gap_over(surface, t, component),
        false => no_gap(),
    }
}

/// The gap of a surface that the mode does not have.
pub fn no_gap<L: Numbers>() -> L {
    L::of(1.0)
}

/// Gaps of a mode without surfaces.
#[inline(always)]
pub fn no_gaps<G: StateVector>() -> G {
    filled(&[], &[], 1.0)
}

/// As [`Impacting::gap_rates`].
///
/// # Errors
/// That of the mode.
#[inline(always)]
pub fn gap_rates<M: Mode + Impacting, G: StateVector>(
    model: &M::Model,
    t: f64,
    state: &StateOf<M>,
) -> Result<G, Fault> {
    let own = M::of(model).gap_rates(t, &taken::<M>(state))?;
    Ok(scattered(own.as_slice(), M::SURFACES))
}

/// As [`Impacting::gap_accelerations`].
///
/// # Errors
/// That of the mode.
pub fn gap_accelerations<M: Mode + Impacting, G: StateVector>(
    model: &M::Model,
    t: f64,
    state: &StateOf<M>,
    motion: &impl StateVector,
) -> Result<Option<G>, Fault> {
    let own = M::of(model).gap_accelerations(t, &taken::<M>(state), &beginning(motion))?;
    Ok(own.map(|own| scattered(own.as_slice(), M::SURFACES)))
}

/// As [`Impacting::gap_responses`].
///
/// # Errors
/// That of the mode.
pub fn gap_responses<M: Mode + Impacting, G: StateVector>(
    model: &M::Model,
    t: f64,
    state: &StateOf<M>,
    motion: &impl StateVector,
) -> Result<Option<G>, Fault> {
    let own = M::of(model).gap_responses(t, &taken::<M>(state), &beginning(motion))?;
    Ok(own.map(|own| scattered(own.as_slice(), M::SURFACES)))
}

/// As [`Impacting::focus`].
///
/// # Errors
/// That of the mode.
pub fn focus<M: Mode + Impacting, I: StateVector>(
    model: &M::Model,
    surface: usize,
    t: f64,
    state: &StateOf<M>,
) -> Result<Option<I>, Fault> {
    let own = M::of(model).focus(known_surface::<M>(surface)?, t, &taken::<M>(state))?;
    Ok(own.map(|own| beginning(&own)))
}

/// As [`Impacting::trace`].
///
/// # Errors
/// That of the mode.
pub fn trace<M: Mode + Impacting, I: StateVector>(
    model: &M::Model,
    surface: usize,
    t: f64,
    state: &StateOf<M>,
    motion: &I,
) -> Result<Option<I>, Fault> {
    let own = M::of(model).trace(
        known_surface::<M>(surface)?,
        t,
        &taken::<M>(state),
        &beginning(motion),
    )?;
    Ok(own.map(|own| beginning(&own)))
}

/// As [`Impacting::surface_active`]; a surface that the mode does not have does not count.
#[inline(always)]
pub fn surface_active<M: Mode + Impacting>(
    model: &M::Model,
    surface: usize,
    t: f64,
    state: &StateOf<M>,
) -> bool {
    own_surface::<M>(surface)
        .is_some_and(|own| M::of(model).surface_active(own, t, &taken::<M>(state)))
}

/// As [`Impacting::blow`].
///
/// # Errors
/// That of the mode.
#[inline(always)]
pub fn blow<M: Mode + Impacting, I: StateVector>(
    model: &M::Model,
    surface: usize,
    t: f64,
    state: &StateOf<M>,
) -> Result<Blow<I>, Fault> {
    let own = M::of(model).blow(known_surface::<M>(surface)?, t, &taken::<M>(state))?;
    Ok(Blow {
        size: own.size,
        share: own.share,
        direction: beginning(&own.direction),
    })
}

/// As [`Impacting::contact`].
///
/// # Errors
/// That of the mode.
pub fn contact<M: Mode + Impacting, I: StateVector>(
    model: &M::Model,
    surface: usize,
    t: f64,
    state: &StateOf<M>,
) -> Result<Contact<I>, Fault> {
    let own = M::of(model).contact(known_surface::<M>(surface)?, t, &taken::<M>(state))?;
    Ok(Contact {
        gap_rate: own.gap_rate,
        constrained_rate: own.constrained_rate,
        surface_rate: own.surface_rate,
        constrained_compliance: own.constrained_compliance,
        free_compliance: own.free_compliance,
        direction: beginning(&own.direction),
    })
}

/// As [`Impacting::landing`], of a reset that stays in the mode.
///
/// # Errors
/// That of the mode.
pub fn landing<M: Mode + Impacting>(
    model: &M::Model,
    surface: usize,
    t: f64,
    state: &StateOf<M>,
) -> Result<Landing<StateOf<M>>, Outcome> {
    let own = M::of(model).landing(known_surface::<M>(surface)?, t, &taken::<M>(state))?;
    Ok(Landing {
        state: placed::<M>(&own.state),
        is_graze: own.is_graze,
        is_one_of_several: own.is_one_of_several,
    })
}

/// As [`Instance::initial`](crate::describe::Instance::initial), of this mode.
pub fn initial<M: Mode, V: StateVector>(model: &M::Model) -> Initial<V> {
    let own = M::of(model).initial();
    let [q, qdot, placed, named] = [own.q, own.qdot, own.placed, own.named]
        .map(|values| scattered(values.as_slice(), M::COORDINATES));
    Initial {
        q,
        qdot,
        placed,
        named,
        until: own.until,
    }
}

/// As [`Instance::outputs`](crate::describe::Instance::outputs); NaN for what the mode does not have. `own` has room for the outputs
/// of the mode.
///
/// # Errors
/// That of the mode.
pub fn outputs<M: Mode>(
    model: &M::Model,
    t: f64,
    state: &StateOf<M>,
    values: &mut [f64],
    own: &mut [f64],
) -> Result<(), Fault> {
    M::of(model).outputs(t, &taken::<M>(state), own)?;
    values.fill(f64::NAN);
    for (&place, own) in M::OUTPUTS.iter().zip(own) {
        if let Some(value) = values.get_mut(place) {
            *value = *own;
        }
    }
    Ok(())
}

/// As [`Instance::view_path`](crate::describe::Instance::view_path).
pub fn view_path<M: Mode>(model: &M::Model, t: f64, state: &StateOf<M>) -> Option<[f64; 2]> {
    M::of(model).view_path(t, &taken::<M>(state))
}

/// As [`Instance::view_region`](crate::describe::Instance::view_region), of this mode.
pub fn view_region<M: Mode, V: StateVector>(model: &M::Model, t: f64, q: &V) -> Option<f64> {
    M::of(model).view_region(t, &gathered(q, M::COORDINATES))
}

/// As [`Instance::inspect`](crate::describe::Instance::inspect), with what the mode derives, in its own order.
///
/// # Errors
/// That of the mode.
pub fn inspect<M: Mode>(
    model: &M::Model,
    t: f64,
    state: &StateOf<M>,
    report: &mut dyn Report,
) -> Result<(), Fault> {
    M::of(model).inspect(t, &taken::<M>(state), report)
}
