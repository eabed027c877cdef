//! `Impacting` for every declared model with surfaces.

use super::part::{has_modes, number_of};
use super::passage::passage;
use super::system::{coefficient, with_places};
use super::{At, Declared, Form, HasSurfaces, Kernels, Part};
use super::{Beside, Condition, Passage, Surface, Tables};
use crate::contract::{Along, Impacting, System, VectorField, after_reset};
use crate::error::Fault;
use crate::generated::{OverNumbers, certain};
use crate::law::{Blow, Contact, Jump, Landing, Law};
use crate::numbers::{Bent, ComplexInterval, Interval, Numbers, Row, TaylorModel};
use crate::outcome::Outcome;
use crate::state::StateVector;

/// Number of surfaces up to which all gaps are evaluated together where one is asked for.
const TOGETHER: usize = 4;

/// Bit of a coordinate in a mask. All coordinates from the last bit on share that bit.
#[inline(always)]
fn place(coordinate: usize) -> u64 {
    1 << coordinate.min(63)
}

impl<S: Declared + HasSurfaces> OverNumbers for S {
    fn gap_over<L: Numbers>(&self, surface: usize, t: L, component: &dyn Fn(usize) -> L) -> L {
        gap_over(self, surface, t, component)
    }
}

/// A gap over any kind of number, from the coordinates that it depends on. The gap of a surface that the mode does not
/// have is 1.
fn gap_over<S: Declared, L: Numbers>(
    system: &S,
    surface: usize,
    t: L,
    component: &dyn Fn(usize) -> L,
) -> L {
    let number = match has_modes(system) {
        true => number_of(Some(&component(system.state_len() - 1))),
        false => 0,
    };
    let part = Part::numbered(system, number);
    let local = part.surface(surface);
    let Some((local, declared)) =
        local.and_then(|local| Some((local, part.tables.surfaces.get(local)?)))
    else {
        return L::of(1.0);
    };
    with_places(system, part.lengths()[0], |q, parameters| {
        for (i, entry) in q.iter_mut().enumerate() {
            if declared.takes & place(i) != 0 {
                *entry = component(i);
            }
        }
        let at = At {
            parameters,
            t,
            first: q,
            second: &[],
        };
        let mut gap = [L::ZERO];
        // The kernel of a gap has no guards, so it does not fail.
        let _ = part.kernels.gap(local, at, &mut gap);
        gap[0]
    })
}

/// True if all conditions of a list hold. Their margins are the first of `margins`; the remaining margins are returned.
#[inline(always)]
fn hold<'m>(conditions: &[Condition], margins: &'m [f64]) -> (bool, &'m [f64]) {
    let (listed, rest) = margins.split_at(conditions.len());
    let all = conditions.iter().zip(listed).all(|(condition, &margin)| {
        let is_closed = condition.is_closed;
        margin > 0.0 || (is_closed && margin >= 0.0)
    });
    (all, rest)
}

/// The first value is true if all conditions of a surface's own list hold, the second if all conditions of one of its
/// other lists hold.
fn conditions<S: Declared>(
    part: &Part<'_, S>,
    (local, surface): (usize, &Surface),
    t: f64,
    state: &S::State,
) -> [bool; 2] {
    if lists(surface).all(<[Condition]>::is_empty) {
        return [true, false];
    }
    let count = signs(surface);
    let kernel = (
        |kernels: &S::Kernels, at: At<'_, f64>, values: &mut [f64]| {
            kernels.conditions(local, at, values)
        },
        count,
    );
    // The kernel of the conditions has no guards, so it does not fail.
    let Ok(margins) = part.several(kernel, t, [state.as_slice(), &[]]) else {
        return [false; 2];
    };
    let (holds, mut rest) = hold(&surface.conditions, &margins.as_slice()[..count]);
    let mut other = false;
    for list in &surface.others {
        let (found, behind) = hold(list, rest);
        other |= found;
        rest = behind;
    }
    [holds, other]
}

/// Number of values of the kernel of conditions: margins of all conditions, and arguments of absolute values in the gap.
fn signs(surface: &Surface) -> usize {
    lists(surface).map(<[Condition]>::len).sum::<usize>() + surface.kinks
}

/// Values of the kernel of conditions along a motion.
fn signs_along<S: Declared>(
    system: &S,
    part: &Part<'_, S>,
    (local, surface): (usize, &Surface),
    (t, component): Along<'_>,
) -> Option<S::Room<TaylorModel>> {
    let count = signs(surface);
    let mut values = S::Room::<TaylorModel>::zeros(count);
    let found = &mut values.as_mut_slice()[..count];
    with_places(system, part.lengths()[0], |q, parameters| {
        for (i, entry) in q.iter_mut().enumerate() {
            *entry = component(i);
        }
        let at = At {
            parameters,
            t,
            first: q,
            second: &[],
        };
        part.kernels.conditions(local, at, found)
    })
    .ok()?;
    Some(values)
}

/// True if a surface counts all along a motion, false if it counts nowhere on it; `None` if neither is certain. A
/// condition whose margin is within its rounding error counts as violated, also a closed one.
fn counts_along<S: Declared>(
    system: &S,
    surface: usize,
    along: Along<'_>,
    rounding: Along<'_>,
) -> Option<bool> {
    let number = match has_modes(system) {
        true => number_of(Some(&along.1(system.state_len() - 1))),
        false => 0,
    };
    let part = Part::numbered(system, number);
    let Some(surface) = part.surface(surface) else {
        return Some(false);
    };
    let Some(declared) = part.tables.surfaces.get(surface) else {
        return Some(true);
    };
    if lists(declared).all(<[Condition]>::is_empty) {
        return Some(true);
    }
    let margins = |moments| signs_along(system, &part, (surface, declared), moments);
    let (along, rounding) = (margins(along)?, margins(rounding)?);
    let mut holds = lists_hold(declared, |place, _| {
        let margin = along.as_slice()[place].range();
        let floor = rounding.as_slice()[place].range().width();
        let (is_true, is_false) = (margin.lo > floor, margin.hi <= floor);
        (is_true || is_false).then_some(is_true)
    });
    let own_holds = holds.next().flatten();
    let none = certain::none(holds);
    match declared.beside {
        Beside::Independent => own_holds,
        Beside::Otherwise => none,
        Beside::Last => certain::none([own_holds, none].into_iter()).map(|neither| !neither),
    }
}

/// True if a motion has passed a kink of a gap all along, false if it passes none; see [`Impacting::passes_kink`].
fn passes_kink<S: Declared>(
    system: &S,
    surface: usize,
    start: Along<'_>,
    along: Along<'_>,
    rounding: Along<'_>,
) -> Option<bool> {
    let number = match has_modes(system) {
        true => number_of(Some(&start.1(system.state_len() - 1))),
        false => 0,
    };
    let part = Part::numbered(system, number);
    let Some(declared) =
        (part.surface(surface)).and_then(|local| Some((local, part.tables.surfaces.get(local)?)))
    else {
        return Some(false);
    };
    let arguments = |moments| signs_along(system, &part, declared, moments);
    let (start, along, rounding) = (arguments(start)?, arguments(along)?, arguments(rounding)?);
    let count = signs(declared.1);
    let mut is_certain = true;
    for place in count - declared.1.kinks..count {
        let range = |values: &S::Room<TaylorModel>| values.as_slice()[place].range();
        let (before, now, floor) = (range(&start), range(&along), range(&rounding).width());
        let (is_above, is_below) = (before.lo > floor, before.hi < -floor);
        let (rises, falls) = (now.lo > floor, now.hi < -floor);
        if (rises && !is_above) || (falls && !is_below) {
            return Some(true);
        }
        is_certain &= (is_above || now.hi <= floor) && (is_below || now.lo >= -floor);
    }
    is_certain.then_some(false)
}

/// The lists of conditions that determine if a surface counts, its own list first.
fn lists(surface: &Surface) -> impl Iterator<Item = &[Condition]> {
    let others = surface.others.iter().map(|list| &**list);
    core::iter::once(&*surface.conditions).chain(others)
}

/// True for each list that holds. `holds` evaluates a condition, given its index among all of them.
fn lists_hold<'a>(
    surface: &'a Surface,
    holds: impl Fn(usize, &Condition) -> Option<bool> + 'a,
) -> impl Iterator<Item = Option<bool>> + 'a {
    let mut first = 0;
    lists(surface).map(move |list| {
        let places = first..;
        first += list.len();
        certain::all(
            places
                .zip(list)
                .map(|(place, condition)| holds(place, condition)),
        )
    })
}

/// True if a surface counts. A surface that the mode does not have never counts.
#[inline]
pub(super) fn counts<S: Declared>(system: &S, surface: usize, t: f64, state: &S::State) -> bool {
    let part = Part::of(system, state.as_slice());
    let Some(local) = part.surface(surface) else {
        return false;
    };
    let Some(declared) = part.tables.surfaces.get(local) else {
        return true;
    };
    let [holds, other] = conditions(&part, (local, declared), t, state);
    match declared.beside {
        Beside::Independent => holds,
        Beside::Otherwise => !other,
        Beside::Last => holds || !other,
    }
}

/// True if a surface counts at all times and states of a box, false if it counts at none; `None` if neither is certain.
pub(super) fn counts_throughout<S: Declared>(
    system: &S,
    parameters: &[Interval],
    surface: usize,
    t: Interval,
    state: &[Interval],
) -> Option<bool> {
    let part = Part::of(system, state);
    let Some(surface) = part.surface(surface) else {
        return Some(false);
    };
    let Some(declared) = part.tables.surfaces.get(surface) else {
        return Some(true);
    };
    if lists(declared).all(<[Condition]>::is_empty) {
        return Some(true);
    }
    let count = signs(declared);
    let at = At {
        parameters,
        t,
        first: state,
        second: &[],
    };
    let mut margins = S::Room::<Interval>::zeros(count);
    let margins = &mut margins.as_mut_slice()[..count];
    part.kernels.conditions(surface, at, margins).ok()?;
    let mut holds = lists_hold(declared, |place, condition| {
        certain::holds(margins[place], condition.is_closed)
    });
    let own_holds = holds.next().flatten();
    match declared.beside {
        Beside::Independent => own_holds,
        Beside::Otherwise => certain::none(holds),
        Beside::Last => certain::last(own_holds, certain::none(holds)),
    }
}

impl<S: Declared> Part<'_, S> {
    /// Values of a kernel, one per surface of the model; 0 for surfaces that the part does not have.
    #[inline(always)]
    fn per_surface(
        &self,
        kernel: impl Fn(&S::Kernels, At<'_, f64>, &mut [f64]) -> Result<(), Fault>,
        t: f64,
        places: [&[f64]; 2],
        surfaces: usize,
    ) -> Result<S::Gaps, Fault> {
        let count = self.tables.dimensions.surfaces;
        if count == 0 {
            return Ok(S::Gaps::zeros(surfaces));
        }
        let values = self.vector((kernel, [surfaces, count]), t, places)?;
        Ok(self.of_surfaces(values, 0.0))
    }

    /// Values of a kernel, one per momentum or quasi-velocity of the part, as an impulse.
    #[inline(always)]
    fn impulse(
        &self,
        kernel: impl Fn(&S::Kernels, At<'_, f64>, &mut [f64]) -> Result<(), Fault>,
        t: f64,
        places: [&[f64]; 2],
        length: usize,
    ) -> Result<S::Impulse, Fault> {
        self.vector((kernel, [length, self.lengths()[1]]), t, places)
    }
}

impl<S: Declared + HasSurfaces> Impacting for S {
    type Gaps = S::Gaps;

    #[inline(always)]
    fn surface_count(&self) -> usize {
        self.tables().dimensions.surfaces
    }

    #[inline]
    fn gaps(&self, t: f64, state: &S::State) -> S::Gaps {
        let part = Part::of(self, state.as_slice());
        let mut gaps = self.zero_gaps();
        let entries = &mut gaps.as_mut_slice()[..part.tables.dimensions.surfaces];
        // The kernel of the gaps has no guards, so it does not fail.
        let _ = part.write(S::Kernels::gaps, t, [state.as_slice(), &[]], entries);
        part.of_surfaces(gaps, 1.0)
    }

    #[inline]
    fn gap(&self, surface: usize, t: f64, state: &S::State) -> f64 {
        let part = Part::of(self, state.as_slice());
        if part.tables.dimensions.surfaces <= TOGETHER {
            return self.gaps(t, state).as_slice()[surface];
        }
        let mut gap = [1.0];
        if let Some(local) = part.surface(surface) {
            // The kernel of a gap has no guards, so it does not fail.
            let kernel = |kernels: &S::Kernels, at: At<'_, f64>, values: &mut [f64]| {
                kernels.gap(local, at, values)
            };
            let _ = part.write(kernel, t, [state.as_slice(), &[]], &mut gap);
        }
        gap[0]
    }

    fn gap_along(
        &self,
        surface: usize,
        t: TaylorModel,
        component: &dyn Fn(usize) -> TaylorModel,
    ) -> TaylorModel {
        gap_over(self, surface, t, component)
    }

    fn gap_about(&self, surface: usize, t: Bent, component: &dyn Fn(usize) -> Bent) -> Bent {
        gap_over(self, surface, t, component)
    }

    fn gap_complex(
        &self,
        surface: usize,
        t: ComplexInterval,
        component: &dyn Fn(usize) -> ComplexInterval,
    ) -> ComplexInterval {
        gap_over(self, surface, t, component)
    }

    #[inline]
    fn gap_rates(&self, t: f64, state: &S::State) -> Result<S::Gaps, Fault> {
        let part = Part::of(self, state.as_slice());
        let places = [state.as_slice(), &[]];
        part.per_surface(S::Kernels::gap_rates, t, places, self.surface_count())
    }

    fn gap_accelerations(
        &self,
        t: f64,
        state: &S::State,
        motion: &S::Impulse,
    ) -> Result<Option<S::Gaps>, Fault> {
        let part = Part::of(self, state.as_slice());
        if part.tables.form == Form::FirstOrder || part.tables.dimensions.surfaces == 0 {
            return Ok(None);
        }
        let places = [state.as_slice(), motion.as_slice()];
        let kernel = S::Kernels::gap_accelerations;
        let rates = part.per_surface(kernel, t, places, self.surface_count());
        rates.map(Some)
    }

    fn gap_responses(
        &self,
        t: f64,
        state: &S::State,
        motion: &S::Impulse,
    ) -> Result<Option<S::Gaps>, Fault> {
        let part = Part::of(self, state.as_slice());
        if part.tables.form == Form::FirstOrder || part.tables.dimensions.surfaces == 0 {
            return Ok(None);
        }
        let places = [state.as_slice(), motion.as_slice()];
        let kernel = S::Kernels::gap_responses;
        let changes = part.per_surface(kernel, t, places, self.surface_count());
        changes.map(Some)
    }

    #[inline]
    fn surface_active(&self, surface: usize, t: f64, state: &S::State) -> bool {
        counts(self, surface, t, state)
    }

    fn has_conditions(&self, surface: usize) -> bool {
        let Some((part, local)) = Part::of_surface(self, surface) else {
            return false;
        };
        let declared = part.tables.surfaces.get(local);
        declared.is_some_and(|declared| lists(declared).any(|list| !list.is_empty()))
    }

    fn counts_along(&self, surface: usize, along: Along<'_>, rounding: Along<'_>) -> Option<bool> {
        counts_along(self, surface, along, rounding)
    }

    fn has_kinks(&self, surface: usize) -> bool {
        let Some((part, local)) = Part::of_surface(self, surface) else {
            return false;
        };
        let declared = part.tables.surfaces.get(local);
        declared.is_some_and(|declared| declared.kinks > 0)
    }

    fn passes_kink(
        &self,
        surface: usize,
        start: Along<'_>,
        along: Along<'_>,
        rounding: Along<'_>,
    ) -> Option<bool> {
        passes_kink(self, surface, start, along, rounding)
    }

    #[inline]
    fn takes(&self, surface: usize, t: f64, state: &S::State) -> bool {
        let part = Part::of(self, state.as_slice());
        let Some(local) = part.surface(surface) else {
            return true;
        };
        match part.tables.surfaces.get(local) {
            Some(declared) if declared.beside == Beside::Last => {
                conditions(&part, (local, declared), t, state)[0]
            }
            _ => true,
        }
    }

    #[inline]
    fn law(&self, surface: usize) -> Law {
        let Some(declared) = self.tables().surfaces.get(surface) else {
            return Law::Elastic;
        };
        match declared.law {
            Law::Restitution(_) => Law::Restitution(coefficient(self, surface)),
            Law::Newton(_) => Law::Newton(coefficient(self, surface)),
            law => law,
        }
    }

    #[inline]
    fn is_passable(&self, surface: usize) -> bool {
        let is_reset = || {
            self.tables()
                .surfaces
                .get(surface)
                .map(|declared| declared.law)
                == Some(Law::Reset)
        };
        let has_no_side = || {
            let (part, _) = Part::of_surface(self, surface)?;
            part.transition(surface)
                .map(|(_, transition)| transition.has_no_side)
        };
        is_reset() || has_modes(self) && has_no_side() == Some(true)
    }

    fn opposite(&self, surface: usize) -> Option<usize> {
        let (part, _) = Part::of_surface(self, surface)?;
        part.transition(surface)?.1.opposite
    }

    fn lands_on(&self, surface: usize, other: usize) -> bool {
        let Some((part, local)) = Part::of_surface(self, surface) else {
            return false;
        };
        match part.transition(surface) {
            Some((_, transition)) => {
                let is_met = other == surface || transition.meets.contains(&Some(other));
                is_met && transition.passage != Passage::Declared
            }
            None => other == surface && part.tables.surfaces[local].keeps_gap,
        }
    }

    fn reset(
        &self,
        surface: usize,
        t: f64,
        state: &S::State,
    ) -> Result<Option<Jump<S::Vector>>, Fault> {
        let part = Part::of(self, state.as_slice());
        let local = part.known(surface)?;
        if !matches!(part.tables.surfaces.get(local), Some(declared) if declared.law == Law::Reset)
        {
            return Ok(None);
        }
        let places = [state.as_slice(), &[][..]];
        let [position, velocity] = part.pair(
            |kernels: &S::Kernels, at: At<'_, f64>, values: &mut [f64]| {
                kernels.reset(local, at, values)
            },
            t,
            places,
        )?;
        Ok(Some(Jump { position, velocity }))
    }

    fn focus(&self, surface: usize, t: f64, state: &S::State) -> Result<Option<S::Impulse>, Fault> {
        let part = Part::of(self, state.as_slice());
        let local = part.known(surface)?;
        let kernel = |kernels: &S::Kernels, at: At<'_, f64>, values: &mut [f64]| {
            kernels.focus(local, at, values)
        };
        known(part.impulse(kernel, t, [state.as_slice(), &[]], self.impulse_len()))
    }

    fn trace(
        &self,
        surface: usize,
        t: f64,
        state: &S::State,
        motion: &S::Impulse,
    ) -> Result<Option<S::Impulse>, Fault> {
        let part = Part::of(self, state.as_slice());
        let local = part.known(surface)?;
        let kernel = |kernels: &S::Kernels, at: At<'_, f64>, values: &mut [f64]| {
            kernels.trace(local, at, values)
        };
        let places = [state.as_slice(), motion.as_slice()];
        known(part.impulse(kernel, t, places, self.impulse_len()))
    }

    fn landing(
        &self,
        surface: usize,
        t: f64,
        state: &S::State,
    ) -> Result<Landing<S::State>, Outcome> {
        let part = Part::of(self, state.as_slice());
        match part.transition(surface) {
            Some((local, transition)) => passage(self, (surface, local, transition), t, state),
            None => {
                let here = part.starting_here();
                after_reset(&here, surface, t, state).map(Landing::from)
            }
        }
    }

    #[inline]
    fn blow(&self, surface: usize, t: f64, state: &S::State) -> Result<Blow<S::Impulse>, Fault> {
        let part = Part::of(self, state.as_slice());
        let local = part.known(surface)?;
        let count = 2 + part.lengths()[1];
        let kernel = (
            |kernels: &S::Kernels, at: At<'_, f64>, values: &mut [f64]| {
                kernels.blow(local, at, values)
            },
            count,
        );
        let places = [state.as_slice(), &[][..]];
        let all = part
            .several(kernel, t, places)
            .map_err(|fault| no_impulse(part.tables, fault, surface))?;
        let [size, share, direction @ ..] = &all.as_slice()[..count] else {
            return Err(Fault::SingularSurface { surface });
        };
        Ok(Blow {
            size: *size,
            share: *share,
            direction: filled(self.zero_impulse(), direction),
        })
    }

    #[inline]
    fn contact(
        &self,
        surface: usize,
        t: f64,
        state: &S::State,
    ) -> Result<Contact<S::Impulse>, Fault> {
        let part = Part::of(self, state.as_slice());
        let local = part.known(surface)?;
        let count = 5 + part.lengths()[1];
        let kernel = (
            |kernels: &S::Kernels, at: At<'_, f64>, values: &mut [f64]| {
                kernels.contact(local, at, values)
            },
            count,
        );
        let places = [state.as_slice(), &[][..]];
        let all = part
            .several(kernel, t, places)
            .map_err(|fault| no_impulse(part.tables, fault, surface))?;
        let [
            gap_rate,
            constrained_rate,
            surface_rate,
            constrained_compliance,
            free_compliance,
            direction @ ..,
        ] = &all.as_slice()[..count]
        else {
            return Err(Fault::SingularSurface { surface });
        };
        Ok(Contact {
            gap_rate: *gap_rate,
            constrained_rate: *constrained_rate,
            surface_rate: *surface_rate,
            constrained_compliance: *constrained_compliance,
            free_compliance: *free_compliance,
            direction: filled(self.zero_impulse(), direction),
        })
    }
}

/// A vector with these components at its beginning, and those of `vector` after them.
#[inline(always)]
fn filled<V: StateVector>(mut vector: V, components: &[f64]) -> V {
    vector.as_mut_slice()[..components.len()].copy_from_slice(components);
    vector
}

/// The result, with `None` for a kernel that a surface does not have.
fn known<V>(found: Result<V, Fault>) -> Result<Option<V>, Fault> {
    match found {
        Err(Fault::NotDerived) => Ok(None),
        found => found.map(Some),
    }
}

/// The reason why a surface has no impulse, from the fault of the kernel.
#[cold]
pub(super) fn no_impulse(tables: &Tables, fault: Fault, surface: usize) -> Fault {
    match fault {
        Fault::NotDerived if tables.form == Form::FirstOrder => Fault::FirstOrder,
        Fault::NotDerived if !tables.is_linear => Fault::NonlinearConstraints,
        Fault::NotDerived => Fault::SingularSurface { surface },
        fault => fault,
    }
}
