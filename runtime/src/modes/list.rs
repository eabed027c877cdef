//! The modes of a declared model, by their types.

use super::series::{self, Expansion, Lengths};
use crate::contract::{RankDrop, TaylorField};
use crate::describe::{Instance, Report};
use crate::error::Fault;
use crate::jet::{Jets, LENGTH};
use crate::kernels::{Declared, Documented, Mode, Part};
use crate::numbers::{Numbers, Row};
use crate::state::StateVector;

/// The types of the modes of a model `W`, in order: `(First, (Second, ()))`. A method calls a function of one mode,
/// which is given by its number, or of all modes in which motions of the lanes are.
pub trait ModeList<W> {
    /// Storage for the coefficients of intermediate values of all modes.
    type Jets<L: Numbers>: Jets;

    /// Calls [`TaylorField::begin`] of every mode in which some lane is. `modes` are the modes of this list, with the
    /// number of the first.
    ///
    /// # Errors
    /// The [`Fault`] of a mode.
    fn begin<L: Numbers>(
        whole: &W,
        modes: (usize, &[Mode]),
        lengths: Lengths,
        at: (&[L], L, &[L]),
        firsts: &mut [L],
    ) -> Result<(), Fault>;

    /// Calls [`TaylorField::advance`] of every mode in which some lane is.
    fn advance<L: Numbers, R: Row<L>, G: Row<L>>(
        whole: &W,
        modes: (usize, &[Mode]),
        expansion: Expansion<'_, L>,
        coefficients: &mut [R; LENGTH],
        gaps: &mut [G; LENGTH],
        jets: &mut Self::Jets<L>,
    );

    /// Calls [`Instance::inspect`] of the mode of a state.
    ///
    /// # Errors
    /// The [`Fault`] of the mode.
    fn inspect(
        whole: &W,
        mode: usize,
        t: f64,
        state: &[f64],
        report: &mut dyn Report,
    ) -> Result<(), Fault>;

    /// Calls [`System::rank_drop`](crate::System::rank_drop) of a mode, along motion in it.
    fn rank_drop<V: StateVector>(
        whole: &W,
        mode: usize,
        motion: &dyn Fn(f64) -> (f64, V),
        reach: f64,
    ) -> Option<RankDrop>;
}

impl<W> ModeList<W> for () {
    type Jets<L: Numbers> = ();

    fn begin<L: Numbers>(
        _: &W,
        _: (usize, &[Mode]),
        _: Lengths,
        _: (&[L], L, &[L]),
        _: &mut [L],
    ) -> Result<(), Fault> {
        Ok(())
    }

    fn advance<L: Numbers, R: Row<L>, G: Row<L>>(
        _: &W,
        _: (usize, &[Mode]),
        _: Expansion<'_, L>,
        _: &mut [R; LENGTH],
        _: &mut [G; LENGTH],
        (): &mut (),
    ) {
    }

    fn inspect(_: &W, _: usize, _: f64, _: &[f64], _: &mut dyn Report) -> Result<(), Fault> {
        Ok(())
    }

    fn rank_drop<V: StateVector>(
        _: &W,
        _: usize,
        _: &dyn Fn(f64) -> (f64, V),
        _: f64,
    ) -> Option<RankDrop> {
        None
    }
}

impl<
    W: Copy,
    M: Documented + TaylorField<State = <M as Declared>::State> + From<W>,
    Rest: ModeList<W>,
> ModeList<W> for (M, Rest)
{
    type Jets<L: Numbers> = (<M as TaylorField>::Jets<L>, Rest::Jets<L>);

    #[inline]
    fn begin<L: Numbers>(
        whole: &W,
        (number, modes): (usize, &[Mode]),
        lengths: Lengths,
        at: (&[L], L, &[L]),
        firsts: &mut [L],
    ) -> Result<(), Fault> {
        let Some((mode, others)) = modes.split_first() else {
            return Ok(());
        };
        begin::<W, M, L>(whole, (number, mode), lengths, at, firsts)?;
        Rest::begin(whole, (number + 1, others), lengths, at, firsts)
    }

    #[inline]
    fn advance<L: Numbers, R: Row<L>, G: Row<L>>(
        whole: &W,
        (number, modes): (usize, &[Mode]),
        expansion: Expansion<'_, L>,
        coefficients: &mut [R; LENGTH],
        gaps: &mut [G; LENGTH],
        (jets, other_jets): &mut Self::Jets<L>,
    ) {
        let Some((mode, others)) = modes.split_first() else {
            return;
        };
        advance::<W, M, L, R, G>(whole, (number, mode), expansion, coefficients, gaps, jets);
        let rest = (number + 1, others);
        Rest::advance(whole, rest, expansion, coefficients, gaps, other_jets);
    }

    fn inspect(
        whole: &W,
        mode: usize,
        t: f64,
        state: &[f64],
        report: &mut dyn Report,
    ) -> Result<(), Fault> {
        match mode.checked_sub(1) {
            Some(mode) => Rest::inspect(whole, mode, t, state, report),
            None => {
                let system = M::from(*whole);
                let state = own_state(&system, state);
                Instance::inspect(&system, t, &state, report)
            }
        }
    }

    fn rank_drop<V: StateVector>(
        whole: &W,
        mode: usize,
        motion: &dyn Fn(f64) -> (f64, V),
        reach: f64,
    ) -> Option<RankDrop> {
        if let Some(mode) = mode.checked_sub(1) {
            return Rest::rank_drop(whole, mode, motion, reach);
        }
        let system = M::from(*whole);
        let along = |theta: f64| {
            let (t, state) = motion(theta);
            (t, own_state(&system, state.as_slice()))
        };
        system.rank_drop_along(along, reach)
    }
}

/// The state of a mode, from the beginning of a state of the model.
fn own_state<M: Declared>(mode: &M, state: &[f64]) -> <M as Declared>::State {
    <M as Declared>::State::of(&state[..mode.tables().dimensions.state])
}

// NOTE: the series of a mode are not inlined into those of the model. With many modes, one function would contain all
// of them and take minutes to compile.
#[inline(never)]
fn begin<
    W: Copy,
    M: Documented + TaylorField<State = <M as Declared>::State> + From<W>,
    L: Numbers,
>(
    whole: &W,
    mode: (usize, &Mode),
    lengths: Lengths,
    at: (&[L], L, &[L]),
    firsts: &mut [L],
) -> Result<(), Fault> {
    let system = M::from(*whole);
    let known = system.firsts_len();
    series::begin::<L, M::Parameters<L>, M::Row<L>, M::Firsts<L>>(
        (mode, known),
        lengths,
        at,
        firsts,
        |parameters, t, state, firsts| system.begin(parameters, t, state, firsts),
    )
}

#[inline(never)]
fn advance<
    W: Copy,
    M: Documented + TaylorField<State = <M as Declared>::State> + From<W>,
    L: Numbers,
    R: Row<L>,
    G: Row<L>,
>(
    whole: &W,
    mode: (usize, &Mode),
    expansion: Expansion<'_, L>,
    coefficients: &mut [R; LENGTH],
    gaps: &mut [G; LENGTH],
    jets: &mut M::Jets<L>,
) {
    let system = M::from(*whole);
    let known = system.firsts_len();
    let order = expansion.order;
    series::advance::<L, M::Parameters<L>, M::Firsts<L>, _, _, _, _>(
        (mode, known),
        expansion,
        (coefficients, gaps),
        |parameters, unit, firsts, state, own_gaps: &mut [<M as TaylorField>::Gaps<L>; LENGTH]| {
            system.advance(parameters, unit, order, firsts, state, own_gaps, jets);
        },
    );
}

/// Implementation of [`System::rank_drop`](crate::System::rank_drop) for a model with these modes.
pub fn rank_drop<W: Declared, List: ModeList<W>>(
    whole: &W,
    motion: impl Fn(f64) -> (f64, W::State),
    reach: f64,
) -> Option<RankDrop> {
    let (_, state) = motion(0.0);
    let part = Part::of(whole, state.as_slice());
    let drop = List::rank_drop(whole, part.number(), &motion, reach)?;
    Some(part.rank_drop(drop))
}
