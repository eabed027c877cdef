//! Power series whose functions are called through pointers.

use dalembert_numbers::Held;

use super::bounded::{Bounded, Wide};
use super::form::{ARGUMENTS, FIRSTS, Form};
use super::system::Erased;
use crate::contract::{TaylorField, VectorField};
use crate::error::Fault;
use crate::jet::{LENGTH, Work};
use crate::kernels::Mode;
use crate::modes::Lengths;
use crate::modes::series::{self, Expansion};
use crate::numbers::{Numbers, Row};

/// Writes the initial values of a series for parameters, a time and a state: the rates, then the gaps, then the
/// remaining values.
pub type Begin<L> = dyn Fn(&[L], L, &[L], &mut [L]) -> Result<(), Fault> + Send + Sync;

/// Receives an order and its coefficients: those of the state, then those of the gaps.
pub type Expanded<'a, L> = &'a mut dyn FnMut(usize, &[L], &[L]);

/// Computes a series up to an order, in a unit of time, from parameters, a state and the initial values at that state.
pub type Advance<L> = dyn Fn([&[L]; 3], (L, usize), Expanded<'_, L>) + Send + Sync;

/// Power series over one kind of number.
pub struct SeriesTable<L: Numbers> {
    /// See [`TaylorField::begin`].
    pub begin: Held<Begin<L>>,
    /// See [`TaylorField::advance`].
    pub advance: Held<Advance<L>>,
}

impl<L: Numbers> SeriesTable<L> {
    /// Table without series.
    pub const NONE: Self = Self {
        begin: Held::Static(&|_, _, _, _| Err(Fault::NotDerived)),
        advance: Held::Static(&|_, _, _| {}),
    };
}

impl<'f, const C: usize> Erased<'f, C> {
    /// Lengths of the rows of a model with modes.
    fn lengths(&self) -> Lengths {
        Lengths {
            state: self.state_len(),
            gaps: self.series_gap_count(),
        }
    }

    /// The modes by number, and the form of each.
    fn forms(&self) -> impl Iterator<Item = ((usize, &'f Mode), &'f Form)> + use<'f, C> {
        let form = self.form();
        let modes = form.tables.modes.iter().enumerate();
        modes.filter_map(|(number, mode)| Some(((number, mode), &**form.forms.get(mode.kernels)?)))
    }
}

/// Begins the series of a form.
fn begin<L: Numbers>(
    form: &Form,
    parameters: &[L],
    t: L,
    state: &[L],
    firsts: &mut [L],
) -> Result<(), Fault> {
    let series = form.series::<L>().ok_or(Fault::NotDerived)?;
    (series.begin)(parameters, t, state, firsts)
}

/// Writes the series of a form.
fn advance<L: Numbers, const C: usize>(
    form: &Form,
    parameters: &[L],
    to: (L, usize),
    firsts: &[L],
    coefficients: &mut [Bounded<L, C>; LENGTH],
    gaps: &mut [Bounded<L, C>; LENGTH],
) {
    let Some(series) = form.series::<L>() else {
        // `begin` has failed for such a form, so this is never reached.
        return;
    };
    let state = coefficients[0];
    let mut take = |k: usize, of_state: &[L], of_gaps: &[L]| {
        coefficients[k].as_mut_slice().copy_from_slice(of_state);
        gaps[k].as_mut_slice().copy_from_slice(of_gaps);
    };
    (series.advance)([parameters, state.as_slice(), firsts], to, &mut take);
}

impl<const C: usize> TaylorField for Erased<'_, C> {
    type Parameters<L: Numbers> = Wide<L, C, ARGUMENTS>;
    type Row<L: Numbers> = Bounded<L, C>;
    type Gaps<L: Numbers> = Bounded<L, C>;
    type Firsts<L: Numbers> = Wide<L, C, FIRSTS>;
    // NOTE: the number of intermediate values depends on the model. They are on the stack of the function that computes
    // the series.
    type Jets<L: Numbers> = ();

    const IS_BEHIND_POINTERS: bool = true;

    fn work(&self) -> Option<Work> {
        (self.form().work)()
    }

    #[inline(always)]
    fn series_gap_count(&self) -> usize {
        self.form().series_gaps
    }

    #[inline(always)]
    fn firsts_len(&self) -> usize {
        self.form().firsts
    }

    fn parameters(&self) -> Wide<f64, C, ARGUMENTS> {
        *self.values()
    }

    fn begin<L: Numbers>(
        &self,
        parameters: &Wide<L, C, ARGUMENTS>,
        t: L,
        state: &Bounded<L, C>,
        firsts: &mut Wide<L, C, FIRSTS>,
    ) -> Result<(), Fault> {
        let (parameters, state) = (parameters.as_slice(), state.as_slice());
        let firsts = firsts.as_mut_slice();
        if self.form().tables.modes.is_empty() {
            return begin(self.form(), parameters, t, state, firsts);
        }
        for (mode, form) in self.forms() {
            let known = form.firsts;
            series::begin::<L, Wide<L, C, ARGUMENTS>, Bounded<L, C>, Wide<L, C, FIRSTS>>(
                (mode, known),
                self.lengths(),
                (parameters, t, state),
                firsts,
                |parameters, t, state, firsts| {
                    let firsts = &mut firsts.as_mut_slice()[..known];
                    begin(form, parameters.as_slice(), t, state.as_slice(), firsts)
                },
            )?;
        }
        Ok(())
    }

    fn advance<L: Numbers>(
        &self,
        parameters: &Wide<L, C, ARGUMENTS>,
        unit: L,
        order: usize,
        firsts: &Wide<L, C, FIRSTS>,
        coefficients: &mut [Bounded<L, C>; LENGTH],
        gaps: &mut [Bounded<L, C>; LENGTH],
        (): &mut (),
    ) {
        let (parameters, firsts) = (parameters.as_slice(), firsts.as_slice());
        let to = (unit, order);
        if self.form().tables.modes.is_empty() {
            return advance(self.form(), parameters, to, firsts, coefficients, gaps);
        }
        let expansion = Expansion {
            lengths: self.lengths(),
            parameters,
            unit,
            order,
            firsts,
        };
        for (mode, form) in self.forms() {
            let known = form.firsts;
            series::advance::<L, Wide<L, C, ARGUMENTS>, Wide<L, C, FIRSTS>, _, _, _, _>(
                (mode, known),
                expansion,
                (coefficients, gaps),
                |parameters, unit, firsts, coefficients, own_gaps| {
                    let firsts = &firsts.as_slice()[..known];
                    let parameters = parameters.as_slice();
                    advance::<L, C>(
                        form,
                        parameters,
                        (unit, order),
                        firsts,
                        coefficients,
                        own_gaps,
                    );
                },
            );
        }
    }
}
