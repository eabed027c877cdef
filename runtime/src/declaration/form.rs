//! The form of a declared type as data: its tables, and its functions behind pointers.

use core::marker::PhantomData;

use super::{Described, Emitted};
use crate::contract::TaylorField;
use crate::erased::{Expanded, Form, Global, Held, Kinds, MOST_FIRSTS, SeriesTable};
use crate::error::Fault;
use crate::jet::{Jets, LENGTH};
use crate::kernels::{ConstantTable, KernelSet, KernelTable};
use crate::numbers::{Bent, ComplexInterval, Everywhere, Numbers, Rated, Row, TaylorModel};
use crate::variations::Dual;

/// The form of a type; `None` if it is too large for an erased system.
pub(super) const fn of<S: Emitted>() -> Option<&'static Form> {
    match Of::<S>::FORM.capacity() {
        Some(_) => Some(Of::<S>::FORM),
        None => None,
    }
}

/// The form of a mode's type, with the kernels of transitions. With `NARROW`, the rates of some mode may have narrow
/// features, and the form includes rates over intervals.
pub const fn of_mode<S: Emitted, const NARROW: bool>() -> &'static Form {
    OfMode::<S, NARROW>::FORM
}

/// The form of a mode's type.
struct OfMode<S, const NARROW: bool>(PhantomData<S>);

impl<S: Emitted, const NARROW: bool> OfMode<S, NARROW> {
    const FORM: &'static Form = &Of::<S>::form(Of::<S>::kernels_over(NARROW, Self::DUAL));

    const DUAL: &'static KernelTable<Dual> = &Of::<S>::kernels(KernelSet::OF_TRANSITIONS);
}

/// Functions of the form of a type, over slices.
struct Of<S>(PhantomData<S>);

impl<S: Emitted> Of<S> {
    const FORM: &'static Form =
        &Self::form(Self::kernels_over(S::TABLES.can_be_narrow, Self::DUAL));

    const DUAL: &'static KernelTable<Dual> = &Self::kernels(KernelSet::OF_VARIATIONS);

    const fn form(kernels_over: Kinds) -> Form {
        Form {
            tables: Held::Static(S::TABLES),
            documentation: Held::Static(S::DOCUMENTATION),
            kernels: Self::kernels(KernelSet::ALL),
            kernels_over,
            series: match S::HAS_MODES {
                true => SeriesTable::NONE,
                false => Self::series(),
            },
            series_over: Self::SERIES_OVER,
            work: Held::Static(&|| S::declared().work()),
            series_gaps: <<S as TaylorField>::Gaps<f64> as Row<f64>>::CAPACITY,
            firsts: match Self::BEGINS_AGAIN {
                true => Self::results() + 1,
                false => <S::Firsts<f64> as Row<f64>>::CAPACITY,
            },
            defaults: Held::Static(&Self::write_defaults),
            global: match S::HAS_GLOBAL {
                true => Global::OfType(|| <S::Global as Described>::FORM),
                false => Global::NotWritten,
            },
            forms: Held::Static(S::FORMS),
            room: <S::Room<f64> as Row<f64>>::CAPACITY,
        }
    }

    const fn kernels_over(is_narrow: bool, of_variations: &'static KernelTable<Dual>) -> Kinds {
        [
            match (S::TABLES.surfaces.value(), S::TABLES.can_lose_rank) {
                ([], false) => None,
                _ => Some(Held::Static(
                    const { &Self::kernels::<TaylorModel>(Self::ENCLOSED) },
                )),
            },
            match S::TABLES.surfaces.value() {
                [] => None,
                _ => Some(Held::Static(
                    const { &Self::kernels::<Bent>(KernelSet::OF_GAPS) },
                )),
            },
            match S::TABLES.surfaces.value() {
                [] => None,
                _ => Some(Held::Static(
                    const { &Self::kernels::<ComplexInterval>(KernelSet::OF_GAPS) },
                )),
            },
            match is_narrow {
                false => None,
                true => Some(Held::Static(
                    const { &Self::kernels::<Rated>(KernelSet::OF_RATES) },
                )),
            },
            match S::TABLES.varies {
                false => None,
                true => Some(Held::Static(of_variations)),
            },
            // NOTE: certified motion needs kernels over intervals, which take more time to compile than all others.
            // Only forms that are loaded at run time have them.
            None,
            match is_narrow {
                false => None,
                true => Some(Held::Static(
                    const { &Self::kernels::<Everywhere>(KernelSet::OF_RATES) },
                )),
            },
        ]
    }

    /// Kernels over enclosures along steps.
    const ENCLOSED: KernelSet = match S::TABLES.can_lose_rank {
        true => KernelSet::OF_SURFACES.forms(),
        false => KernelSet::OF_SURFACES,
    };

    /// True if the quantities at the start of a series do not fit into an erased system. The series then keeps only the
    /// rates, the gaps and the time, and computes all quantities again in `advance`.
    const BEGINS_AGAIN: bool = <S::Firsts<f64> as Row<f64>>::CAPACITY > MOST_FIRSTS;

    /// Number of rates and gaps.
    const fn results() -> usize {
        S::TABLES.dimensions.state + <<S as TaylorField>::Gaps<f64> as Row<f64>>::CAPACITY
    }

    const SERIES_OVER: Kinds = [
        match S::TABLES.varies && !S::HAS_MODES {
            false => None,
            true => Some(Held::Static(const { &Self::series::<Dual>() })),
        },
        #[cfg(feature = "lanes")]
        match S::HAS_MODES {
            true => None,
            false => Some(Held::Static(const { &Self::series::<wide::f64x8>() })),
        },
        #[cfg(not(feature = "lanes"))]
        None,
        None,
        None,
        None,
        None,
        None,
    ];

    const fn kernels<L: Numbers>(which: KernelSet) -> KernelTable<L> {
        ConstantTable::of::<S::Kernels>(which).held()
    }

    const fn series<L: Numbers>() -> SeriesTable<L> {
        SeriesTable {
            begin: Held::Static(&Self::begin),
            advance: Held::Static(&Self::advance),
        }
    }

    fn write_defaults(values: &mut [f64]) {
        values.copy_from_slice(S::declared().arguments().as_ref());
    }

    fn begin<L: Numbers>(
        parameters: &[L],
        t: L,
        state: &[L],
        firsts: &mut [L],
    ) -> Result<(), Fault> {
        let system = S::declared();
        let mut known = S::Firsts::<L>::zeros(system.firsts_len());
        system.begin(&row(parameters), t, &row(state), &mut known)?;
        if Self::BEGINS_AGAIN
            && let [results @ .., time] = firsts
        {
            results.copy_from_slice(&known.as_slice()[..Self::results()]);
            *time = t;
            return Ok(());
        }
        firsts.copy_from_slice(known.as_slice());
        Ok(())
    }

    fn advance<L: Numbers>(
        [parameters, state, firsts]: [&[L]; 3],
        (unit, order): (L, usize),
        take: Expanded<'_, L>,
    ) {
        let system = S::declared();
        let mut coefficients = [row(state); LENGTH];
        let mut gaps = [<S as TaylorField>::Gaps::<L>::zeros(system.series_gap_count()); LENGTH];
        let mut jets = S::Jets::<L>::ZERO;
        let known = match firsts.last() {
            Some(&t) if Self::BEGINS_AGAIN => {
                let mut known = S::Firsts::<L>::zeros(system.firsts_len());
                // NOTE: the same call succeeded when the series began.
                let _ = system.begin(&row(parameters), t, &row(state), &mut known);
                known
            }
            _ => row(firsts),
        };
        system.advance(
            &row(parameters),
            unit,
            order,
            &known,
            &mut coefficients,
            &mut gaps,
            &mut jets,
        );
        for (k, (state, gaps)) in coefficients.iter().zip(&gaps).enumerate().take(order + 1) {
            take(k, state.as_slice(), gaps.as_slice());
        }
    }
}

/// Numbers as a row.
fn row<L: Numbers, R: Row<L>>(numbers: &[L]) -> R {
    let mut row = R::zeros(numbers.len());
    row.as_mut_slice().copy_from_slice(numbers);
    row
}
