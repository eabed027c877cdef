//! `Impacting` of every declared model with surfaces.

use super::declared::{number, pair, several, vector, write};
use super::system::over_numbers;
use super::tables::{Beside, Condition, Surface, Tables};
use super::{At, Declared, Form, HasSurfaces, Kernels};
use crate::contract::{Impacting, System};
use crate::error::Fault;
use crate::generated::{OverNumbers, certain};
use crate::law::{Blow, Contact, Jump, Law};
use crate::numbers::{Bent, Interval, Numbers, Row, TaylorModel};
use crate::state::StateVector;

/// The bit of a coordinate; all from the last one on share it.
#[inline(always)]
fn place(coordinate: usize) -> u64 {
    1 << coordinate.min(63)
}

impl<S: Declared + HasSurfaces> OverNumbers for S {
    fn gap_over<L: Numbers>(&self, surface: usize, t: L, component: &dyn Fn(usize) -> L) -> L {
        gap_over(self, surface, t, component)
    }
}

/// A gap over any kind of number, from those coordinates that it takes.
fn gap_over<S: Declared, L: Numbers>(
    system: &S,
    surface: usize,
    t: L,
    component: &dyn Fn(usize) -> L,
) -> L {
    let Some(own) = system.tables().surfaces.get(surface) else {
        return L::of(1.0);
    };
    let mut q = S::Positions::<L>::zeros(system.coordinate_count());
    for (i, entry) in q.as_mut_slice().iter_mut().enumerate() {
        if own.takes & place(i) != 0 {
            *entry = component(i);
        }
    }
    let arguments: S::Arguments<L> = over_numbers(system);
    let at = At {
        parameters: arguments.as_slice(),
        t,
        first: q.as_slice(),
        second: &[],
    };
    let mut gap = [L::ZERO];
    // Gaps have no guards.
    let _ = system.kernels().gap(surface, at, &mut gap);
    gap[0]
}

/// Whether all conditions of a list hold, of which the margins come first; and the margins that follow.
#[inline(always)]
fn hold<'m>(conditions: &[Condition], margins: &'m [f64]) -> (bool, &'m [f64]) {
    let (own, rest) = margins.split_at(conditions.len());
    let all = conditions.iter().zip(own).all(|(condition, &margin)| {
        let is_closed = condition.is_closed;
        margin > 0.0 || (is_closed && margin >= 0.0)
    });
    (all, rest)
}

/// Whether the conditions of a surface hold, and those of some other list.
fn conditions<S: Declared>(
    system: &S,
    (index, surface): (usize, &Surface),
    t: f64,
    state: &S::State,
) -> [bool; 2] {
    let others = surface.others.iter().map(|own| own.len()).sum::<usize>();
    let count = surface.conditions.len() + others;
    if count == 0 {
        return [true, false];
    }
    let kernel = (
        |kernels: &S::Kernels, at: At<'_, f64>, values: &mut [f64]| {
            kernels.conditions(index, at, values)
        },
        count,
    );
    // Conditions have no guards.
    let Ok(margins) = several(system, kernel, t, [state.as_slice(), &[]]) else {
        return [false; 2];
    };
    let (holds, mut rest) = hold(surface.conditions, &margins.as_slice()[..count]);
    let mut other = false;
    for own in surface.others {
        let (found, behind) = hold(own, rest);
        other |= found;
        rest = behind;
    }
    [holds, other]
}

/// Whether a surface counts.
#[inline]
pub(super) fn counts<S: Declared>(system: &S, surface: usize, t: f64, state: &S::State) -> bool {
    let Some(own) = system.tables().surfaces.get(surface) else {
        return true;
    };
    let [holds, other] = conditions(system, (surface, own), t, state);
    match own.beside {
        Beside::Independent => holds,
        Beside::Otherwise => !other,
        Beside::Last => holds || !other,
    }
}

/// The same at all times and states of a box; `None` where that is not certain.
pub(super) fn counts_throughout<S: Declared>(
    system: &S,
    parameters: &[Interval],
    surface: usize,
    t: Interval,
    state: &[Interval],
) -> Option<bool> {
    let Some(own) = system.tables().surfaces.get(surface) else {
        return Some(true);
    };
    let lists = || core::iter::once(own.conditions).chain(own.others.iter().copied());
    let count = lists().map(<[Condition]>::len).sum::<usize>();
    if count == 0 {
        return Some(true);
    }
    let at = At {
        parameters,
        t,
        first: state,
        second: &[],
    };
    let mut margins = S::Room::<Interval>::zeros(count);
    let margins = &mut margins.as_mut_slice()[..count];
    system.kernels().conditions(surface, at, margins).ok()?;
    let mut rest = &margins[..];
    let mut holds = lists().map(|list| {
        let (own, behind) = rest.split_at(list.len());
        rest = behind;
        certain::all(
            list.iter()
                .zip(own)
                .map(|(one, margin)| certain::holds(*margin, one.is_closed)),
        )
    });
    let own_holds = holds.next().flatten();
    match own.beside {
        Beside::Independent => own_holds,
        Beside::Otherwise => certain::none(holds),
        Beside::Last => certain::last(own_holds, certain::none(holds)),
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
        let mut gaps = self.zero_gaps();
        // Gaps have no guards.
        let _ = write(
            self,
            S::Kernels::gaps,
            t,
            [state.as_slice(), &[]],
            gaps.as_mut_slice(),
        );
        gaps
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

    #[inline]
    fn gap_rates(&self, t: f64, state: &S::State) -> Result<S::Gaps, Fault> {
        let kernel = (S::Kernels::gap_rates, self.surface_count());
        vector(self, kernel, t, [state.as_slice(), &[]])
    }

    fn gap_accelerations(
        &self,
        t: f64,
        state: &S::State,
        motion: &S::Impulse,
    ) -> Result<Option<S::Gaps>, Fault> {
        if self.tables().form == Form::FirstOrder {
            return Ok(None);
        }
        let kernel = (S::Kernels::gap_accelerations, self.surface_count());
        vector(self, kernel, t, [state.as_slice(), motion.as_slice()]).map(Some)
    }

    fn gap_responses(
        &self,
        t: f64,
        state: &S::State,
        motion: &S::Impulse,
    ) -> Result<Option<S::Gaps>, Fault> {
        if self.tables().form == Form::FirstOrder {
            return Ok(None);
        }
        let kernel = (S::Kernels::gap_responses, self.surface_count());
        vector(self, kernel, t, [state.as_slice(), motion.as_slice()]).map(Some)
    }

    #[inline]
    fn surface_active(&self, surface: usize, t: f64, state: &S::State) -> bool {
        counts(self, surface, t, state)
    }

    #[inline]
    fn takes(&self, surface: usize, t: f64, state: &S::State) -> bool {
        match self.tables().surfaces.get(surface) {
            Some(own) if own.beside == Beside::Last => {
                conditions(self, (surface, own), t, state)[0]
            }
            _ => true,
        }
    }

    #[inline]
    fn law(&self, surface: usize) -> Law {
        let Some(own) = self.tables().surfaces.get(surface) else {
            return Law::Elastic;
        };
        let coefficient = || {
            let kernel = |kernels: &S::Kernels, at: At<'_, f64>, values: &mut [f64]| {
                kernels.coefficient(surface, at, values)
            };
            number(self, kernel, 0.0, [&[], &[]]).unwrap_or(f64::NAN)
        };
        match own.law {
            Law::Restitution(_) => Law::Restitution(coefficient()),
            Law::Newton(_) => Law::Newton(coefficient()),
            law => law,
        }
    }

    fn reset(
        &self,
        surface: usize,
        t: f64,
        state: &S::State,
    ) -> Result<Option<Jump<S::Vector>>, Fault> {
        if !matches!(self.tables().surfaces.get(surface), Some(own) if own.law == Law::Reset) {
            return Ok(None);
        }
        let places = [state.as_slice(), &[][..]];
        let [position, velocity] = pair(
            self,
            |kernels: &S::Kernels, at: At<'_, f64>, values: &mut [f64]| {
                kernels.reset(surface, at, values)
            },
            t,
            places,
        )?;
        Ok(Some(Jump { position, velocity }))
    }

    fn focus(&self, surface: usize, t: f64, state: &S::State) -> Result<Option<S::Impulse>, Fault> {
        let kernel = (
            |kernels: &S::Kernels, at: At<'_, f64>, values: &mut [f64]| {
                kernels.focus(surface, at, values)
            },
            self.impulse_len(),
        );
        known(vector(self, kernel, t, [state.as_slice(), &[]]))
    }

    fn trace(
        &self,
        surface: usize,
        t: f64,
        state: &S::State,
        motion: &S::Impulse,
    ) -> Result<Option<S::Impulse>, Fault> {
        let kernel = (
            |kernels: &S::Kernels, at: At<'_, f64>, values: &mut [f64]| {
                kernels.trace(surface, at, values)
            },
            self.impulse_len(),
        );
        known(vector(
            self,
            kernel,
            t,
            [state.as_slice(), motion.as_slice()],
        ))
    }

    #[inline]
    fn blow(&self, surface: usize, t: f64, state: &S::State) -> Result<Blow<S::Impulse>, Fault> {
        let count = 2 + self.impulse_len();
        let kernel = (
            |kernels: &S::Kernels, at: At<'_, f64>, values: &mut [f64]| {
                kernels.blow(surface, at, values)
            },
            count,
        );
        let places = [state.as_slice(), &[][..]];
        let all = several(self, kernel, t, places)
            .map_err(|fault| no_impulse(self.tables(), fault, surface))?;
        let [size, share, direction @ ..] = &all.as_slice()[..count] else {
            return Err(Fault::SingularSurface { surface });
        };
        Ok(Blow {
            size: *size,
            share: *share,
            direction: S::Impulse::of(direction),
        })
    }

    #[inline]
    fn contact(
        &self,
        surface: usize,
        t: f64,
        state: &S::State,
    ) -> Result<Contact<S::Impulse>, Fault> {
        let count = 5 + self.impulse_len();
        let kernel = (
            |kernels: &S::Kernels, at: At<'_, f64>, values: &mut [f64]| {
                kernels.contact(surface, at, values)
            },
            count,
        );
        let places = [state.as_slice(), &[][..]];
        let all = several(self, kernel, t, places)
            .map_err(|fault| no_impulse(self.tables(), fault, surface))?;
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
            direction: S::Impulse::of(direction),
        })
    }
}

/// Nothing for a kernel that a surface does not have.
fn known<V>(found: Result<V, Fault>) -> Result<Option<V>, Fault> {
    match found {
        Err(Fault::NotDerived) => Ok(None),
        found => found.map(Some),
    }
}

/// Why a surface has no impulse.
#[cold]
pub(super) fn no_impulse(tables: &Tables, fault: Fault, surface: usize) -> Fault {
    match fault {
        Fault::NotDerived if tables.form == Form::FirstOrder => Fault::FirstOrder,
        Fault::NotDerived if !tables.is_linear => Fault::NonlinearConstraints,
        Fault::NotDerived => Fault::SingularSurface { surface },
        fault => fault,
    }
}
