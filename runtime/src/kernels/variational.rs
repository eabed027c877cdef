//! `Variational` of every declared model whose runs can be varied.

use super::impacting::{counts, counts_throughout};
use super::{At, Declared, Form, HasVariations, Kernels};
use crate::contract::{TaylorField, Variational};
use crate::error::Fault;
use crate::law::Law;
use crate::numbers::{Interval, Numbers, Row};
use crate::state::StateVector;

/// A row whose numbers from a place on are those of a kernel, added to what is there.
fn added<S: Declared, L: Numbers, R: Row<L>>(
    system: &S,
    kernel: impl Fn(&S::Kernels, At<'_, L>, &mut [L]) -> Result<(), Fault>,
    arguments: (&[L], L),
    places: [&[L]; 2],
    to: &R,
) -> Result<Option<R>, Fault> {
    let (n, k) = (
        system.tables().dimensions.coordinates,
        system.tables().dimensions.motion,
    );
    let found: Result<S::Room<L>, Fault> =
        row_of::<S, L, S::Room<L>>(system, kernel, k, arguments, places);
    let found = match found {
        Err(Fault::NotDerived) => return Ok(None),
        found => found?,
    };
    let mut sum = *to;
    for (entry, added) in sum.as_mut_slice()[n..].iter_mut().zip(found.as_slice()) {
        *entry = *entry + *added;
    }
    Ok(Some(sum))
}

/// So many values of a kernel at the beginning of a row.
fn row_of<S: Declared, L: Numbers, R: Row<L>>(
    system: &S,
    kernel: impl Fn(&S::Kernels, At<'_, L>, &mut [L]) -> Result<(), Fault>,
    count: usize,
    (parameters, t): (&[L], L),
    [first, second]: [&[L]; 2],
) -> Result<R, Fault> {
    let at = At {
        parameters,
        t,
        first,
        second,
    };
    let mut values = R::zeros(count);
    kernel(&system.kernels(), at, &mut values.as_mut_slice()[..count])?;
    Ok(values)
}

/// Positions, and motion by a kernel of positions and velocities.
fn state_by<S: Declared, L: Numbers, R: Row<L>>(
    system: &S,
    kernel: impl Fn(&S::Kernels, At<'_, L>, &mut [L]) -> Result<(), Fault>,
    (parameters, t): (&[L], L),
    [q, qdot]: [&[L]; 2],
) -> Result<R, Fault> {
    let dimensions = &system.tables().dimensions;
    let mut state = R::zeros(dimensions.coordinates + dimensions.motion);
    let (positions, motion) = state.as_mut_slice().split_at_mut(q.len());
    positions.copy_from_slice(q);
    if system.tables().form != Form::FirstOrder {
        let at = At {
            parameters,
            t,
            first: q,
            second: qdot,
        };
        kernel(&system.kernels(), at, motion)?;
    }
    Ok(state)
}

/// As [`System::state_nearest`](crate::System::state_nearest), over numbers.
///
/// # Errors
/// [`Fault`].
pub fn nearest_over<S: Declared, L: Numbers, R: Row<L>>(
    system: &S,
    arguments: (&[L], L),
    places: [&[L]; 2],
) -> Result<R, Fault> {
    let tables = system.tables();
    let is_free = tables.form == Form::Global && tables.dimensions.constraints == 0;
    let kernel = match is_free {
        true => S::Kernels::motion,
        false => S::Kernels::nearest,
    };
    state_by::<S, L, R>(system, kernel, arguments, places)
}

/// Writes positions and velocities in the mode that a surface leads to, where they are declared.
///
/// # Errors
/// [`Fault`].
pub fn enter_over<S: Declared, L: Numbers>(
    system: &S,
    surface: usize,
    at: At<'_, L>,
    [q, qdot]: [&mut [L]; 2],
) -> Result<(), Fault> {
    let count = q.len() + qdot.len();
    let mut both = S::Room::<L>::zeros(count);
    let both = &mut both.as_mut_slice()[..count];
    match system.kernels().entry(surface, at, both) {
        Err(Fault::NotDerived) => return Ok(()),
        found => found?,
    }
    q.copy_from_slice(&both[..q.len()]);
    qdot.copy_from_slice(&both[count - qdot.len()..]);
    Ok(())
}

/// The same of a system.
///
/// # Errors
/// [`Fault`].
pub fn enter<S: Declared>(
    system: &S,
    surface: usize,
    t: f64,
    state: &<S as Declared>::State,
    after: [&mut [f64]; 2],
) -> Result<(), Fault> {
    let arguments = system.arguments();
    let at = At {
        parameters: arguments.as_ref(),
        t,
        first: state.as_slice(),
        second: &[],
    };
    enter_over::<S, f64>(system, surface, at, after)
}

/// As [`System::energy`](crate::System::energy), over numbers.
///
/// # Errors
/// [`Fault`].
pub fn energy_over<S: Declared, L: Numbers>(
    system: &S,
    (parameters, t): (&[L], L),
    state: &[L],
) -> Result<L, Fault> {
    let at = At {
        parameters,
        t,
        first: state,
        second: &[],
    };
    let mut energy = [L::ZERO];
    system.kernels().energy(at, &mut energy)?;
    Ok(energy[0])
}

impl<S: HasVariations> Variational for S {
    type Configuration<L: Numbers> = S::Positions<L>;
    type Clearances<L: Numbers> = <S as HasVariations>::Clearances<L>;
    type Collision<L: Numbers> = <S as HasVariations>::Collision<L>;
    type Deviations<L: Numbers> = <S as HasVariations>::Deviations<L>;
    type Columns = <S as HasVariations>::Columns;
    type Tangents = <S as HasVariations>::Tangents;

    fn columns() -> Self::Columns {
        <S as HasVariations>::columns()
    }

    fn tangents() -> Self::Tangents {
        <S as HasVariations>::tangents()
    }

    #[inline]
    fn counts(&self, surface: usize, t: f64, state: &<S as Declared>::State) -> bool {
        counts(self, surface, t, state)
    }

    fn counts_throughout(
        &self,
        parameters: &<S as TaylorField>::Parameters<Interval>,
        surface: usize,
        t: Interval,
        state: &<S as TaylorField>::Row<Interval>,
    ) -> Option<bool> {
        counts_throughout(self, parameters.as_slice(), surface, t, state.as_slice())
    }

    fn velocities<L: Numbers>(
        &self,
        parameters: &<S as TaylorField>::Parameters<L>,
        t: L,
        state: &<S as TaylorField>::Row<L>,
    ) -> Result<S::Positions<L>, Fault> {
        let arguments = (parameters.as_slice(), t);
        row_of::<S, L, _>(
            self,
            S::Kernels::velocity,
            self.tables().dimensions.coordinates,
            arguments,
            [state.as_slice(), &[]],
        )
    }

    fn composed<L: Numbers>(
        &self,
        parameters: &<S as TaylorField>::Parameters<L>,
        t: L,
        q: &S::Positions<L>,
        qdot: &S::Positions<L>,
    ) -> Result<<S as TaylorField>::Row<L>, Fault> {
        let arguments = (parameters.as_slice(), t);
        state_by::<S, L, _>(
            self,
            S::Kernels::motion,
            arguments,
            [q.as_slice(), qdot.as_slice()],
        )
    }

    fn deviations<L: Numbers>(
        &self,
        parameters: &<S as TaylorField>::Parameters<L>,
        t: L,
        state: &<S as TaylorField>::Row<L>,
    ) -> Result<<S as HasVariations>::Deviations<L>, Fault> {
        let dimensions = &self.tables().dimensions;
        let n = dimensions.coordinates;
        let arguments = (parameters.as_slice(), t);
        let state = state.as_slice();
        let off = match self.tables().form {
            Form::Global => dimensions.constraints,
            _ => 0,
        };
        let mut values = <S as HasVariations>::Deviations::<L>::zeros(off + dimensions.levels);
        if off > 0 {
            let qdot: S::Positions<L> =
                row_of::<S, L, _>(self, S::Kernels::velocity, n, arguments, [state, &[]])?;
            let places = [state, qdot.as_slice()];
            let both: S::Room<L> =
                row_of::<S, L, _>(self, S::Kernels::residuals, 2 * off, arguments, places)?;
            values.as_mut_slice()[..off].copy_from_slice(&both.as_slice()[..off]);
        }
        if dimensions.levels > 0 {
            let at = At {
                parameters: arguments.0,
                t,
                first: state,
                second: &[],
            };
            self.kernels()
                .levels(at, &mut values.as_mut_slice()[off..])?;
        }
        Ok(values)
    }

    fn clearances<L: Numbers>(
        &self,
        parameters: &<S as TaylorField>::Parameters<L>,
        t: L,
        state: &<S as TaylorField>::Row<L>,
    ) -> Result<<S as HasVariations>::Clearances<L>, Fault> {
        if self.tables().dimensions.surfaces == 0 {
            return Ok(Row::zeros(0));
        }
        let arguments = (parameters.as_slice(), t);
        let places = [state.as_slice(), &[][..]];
        row_of::<S, L, _>(
            self,
            S::Kernels::gaps,
            self.tables().dimensions.surfaces,
            arguments,
            places,
        )
    }

    fn collision<L: Numbers>(
        &self,
        parameters: &<S as TaylorField>::Parameters<L>,
        surface: usize,
        t: L,
        state: &<S as TaylorField>::Row<L>,
    ) -> Result<<S as HasVariations>::Collision<L>, Fault> {
        let arguments = (parameters.as_slice(), t);
        let found = row_of::<S, L, _>(
            self,
            |kernels: &S::Kernels, at: At<'_, L>, values: &mut [L]| {
                kernels.contact(surface, at, values)
            },
            5 + self.tables().dimensions.motion,
            arguments,
            [state.as_slice(), &[]],
        );
        found.map_err(|fault| super::impacting::no_impulse(self.tables(), fault, surface))
    }

    fn focus<L: Numbers>(
        &self,
        parameters: &<S as TaylorField>::Parameters<L>,
        surface: usize,
        t: L,
        state: &<S as TaylorField>::Row<L>,
    ) -> Result<Option<<S as TaylorField>::Row<L>>, Fault> {
        let arguments = (parameters.as_slice(), t);
        let places = [state.as_slice(), &[][..]];
        added::<S, L, _>(
            self,
            |kernels: &S::Kernels, at: At<'_, L>, values: &mut [L]| {
                kernels.focus(surface, at, values)
            },
            arguments,
            places,
            state,
        )
    }

    fn trace<L: Numbers>(
        &self,
        parameters: &<S as TaylorField>::Parameters<L>,
        surface: usize,
        t: L,
        state: &<S as TaylorField>::Row<L>,
        rate: &<S as TaylorField>::Row<L>,
    ) -> Result<Option<<S as TaylorField>::Row<L>>, Fault> {
        let arguments = (parameters.as_slice(), t);
        let motion = &rate.as_slice()[self.tables().dimensions.coordinates..];
        let places = [state.as_slice(), motion];
        added::<S, L, _>(
            self,
            |kernels: &S::Kernels, at: At<'_, L>, values: &mut [L]| {
                kernels.trace(surface, at, values)
            },
            arguments,
            places,
            rate,
        )
    }

    fn landing<L: Numbers>(
        &self,
        parameters: &<S as TaylorField>::Parameters<L>,
        surface: usize,
        t: L,
        state: &<S as TaylorField>::Row<L>,
    ) -> Result<Option<[S::Positions<L>; 2]>, Fault> {
        if !matches!(self.tables().surfaces.get(surface), Some(own) if own.law == Law::Reset) {
            return Ok(None);
        }
        let n = self.tables().dimensions.coordinates;
        let arguments = (parameters.as_slice(), t);
        let places = [state.as_slice(), &[][..]];
        let both: S::Room<L> = row_of::<S, L, _>(
            self,
            |kernels: &S::Kernels, at: At<'_, L>, values: &mut [L]| {
                kernels.reset(surface, at, values)
            },
            2 * n,
            arguments,
            places,
        )?;
        let mut landing = [S::Positions::<L>::zeros(n); 2];
        for (own, values) in landing
            .iter_mut()
            .zip(both.as_slice().chunks_exact(n.max(1)))
        {
            own.as_mut_slice().copy_from_slice(values);
        }
        Ok(Some(landing))
    }

    fn declared_law<L: Numbers>(
        &self,
        parameters: &<S as TaylorField>::Parameters<L>,
        surface: usize,
    ) -> (Law, L) {
        let Some(own) = self.tables().surfaces.get(surface) else {
            return (Law::Elastic, L::ZERO);
        };
        let at = At {
            parameters: parameters.as_slice(),
            t: L::ZERO,
            first: &[],
            second: &[],
        };
        let mut coefficient = [L::ZERO];
        // Coefficients have no guards.
        let _ = self.kernels().coefficient(surface, at, &mut coefficient);
        let value = coefficient[0].lane(0);
        let law = match own.law {
            Law::Restitution(_) => Law::Restitution(value),
            Law::Newton(_) => Law::Newton(value),
            law => law,
        };
        (law, coefficient[0])
    }
}
