//! Power series behind pointers.

use super::bounded::{Bounded, Wide};
use super::form::PARAMETERS;
use super::system::Erased;
use crate::contract::{TaylorField, VectorField};
use crate::error::Fault;
use crate::jet::{LENGTH, Work};
use crate::numbers::{Numbers, Row};

/// Writes what a series begins with at parameters, a time and a state: the rates, then the gaps.
pub type Begin<L> = fn(&[L], L, &[L], &mut [L]) -> Result<(), Fault>;

/// Takes the coefficients of an order: those of the state, those of the gaps.
pub type Expanded<'a, L> = &'a mut dyn FnMut(usize, &[L], &[L]);

/// A series from parameters, a time and a state, in a unit of time, up to an order.
pub type Advance<L> = fn(&[L], L, &[L], (L, usize), Expanded<'_, L>);

/// Power series over one kind of number.
#[derive(Debug, Clone, Copy)]
pub struct SeriesTable<L: Numbers> {
    /// See [`TaylorField::begin`].
    pub begin: Begin<L>,
    /// See [`TaylorField::advance`]; it begins by itself.
    pub advance: Advance<L>,
}

impl<const C: usize> TaylorField for Erased<C> {
    type Parameters<L: Numbers> = Bounded<L, PARAMETERS>;
    type Row<L: Numbers> = Bounded<L, C>;
    type Gaps<L: Numbers> = Bounded<L, C>;
    type Firsts<L: Numbers> = Wide<L, C, 3>;
    // NOTE: what a series computes on its way differs from model to model: it lies on the stack of the function that does.
    type Jets<L: Numbers> = ();

    fn work(&self) -> Option<Work> {
        (self.form().work)()
    }

    #[inline(always)]
    fn series_gap_count(&self) -> usize {
        self.form().tables.dimensions.surfaces
    }

    /// Rates, gaps, and the time that they are of.
    #[inline(always)]
    fn firsts_len(&self) -> usize {
        self.state_len() + self.series_gap_count() + 1
    }

    fn parameters(&self) -> Bounded<f64, PARAMETERS> {
        *self.values()
    }

    fn begin<L: Numbers>(
        &self,
        parameters: &Bounded<L, PARAMETERS>,
        t: L,
        state: &Bounded<L, C>,
        firsts: &mut Wide<L, C, 3>,
    ) -> Result<(), Fault> {
        let series = self.form().series::<L>().ok_or(Fault::NotDerived)?;
        let [own @ .., time] = firsts.as_mut_slice() else {
            return Err(Fault::NotDerived);
        };
        *time = t;
        (series.begin)(parameters.as_slice(), t, state.as_slice(), own)
    }

    fn advance<L: Numbers>(
        &self,
        parameters: &Bounded<L, PARAMETERS>,
        unit: L,
        order: usize,
        firsts: &Wide<L, C, 3>,
        coefficients: &mut [Bounded<L, C>; LENGTH],
        gaps: &mut [Bounded<L, C>; LENGTH],
        (): &mut (),
    ) {
        let (Some(series), Some(&t)) = (self.form().series::<L>(), firsts.as_slice().last()) else {
            // Nothing begins such a series.
            return;
        };
        let state = coefficients[0];
        let mut take = |k: usize, of_state: &[L], of_gaps: &[L]| {
            coefficients[k].as_mut_slice().copy_from_slice(of_state);
            gaps[k].as_mut_slice().copy_from_slice(of_gaps);
        };
        (series.advance)(
            parameters.as_slice(),
            t,
            state.as_slice(),
            (unit, order),
            &mut take,
        );
    }
}
