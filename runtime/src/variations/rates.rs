//! Rates of a motion over any kind of number.

use crate::contract::TaylorField;
use crate::error::Fault;
use crate::integrate::taylor::expansion::Expansion;
use crate::numbers::{Numbers, Row};

/// The first and the second time derivative of a state, for these parameters. Over [`Dual`](super::Dual) numbers they
/// carry the derivatives of the equations of motion with respect to state and parameters.
///
/// # Errors
/// A [`Fault`] where the rate does not exist.
pub fn rates<F: TaylorField, L: Numbers>(
    system: &F,
    parameters: &F::Parameters<L>,
    t: L,
    state: &F::Row<L>,
) -> Result<[F::Row<L>; 2], Fault> {
    let mut expansion = Expansion::<F, L>::of(system);
    expansion.begin(system, parameters, t, state)?;
    expansion.advance(system, parameters, L::of(1.0), 2, state);
    let [_, first, mut second, ..] = expansion.coefficients;
    for entry in second.as_mut_slice() {
        *entry = *entry + *entry;
    }
    Ok([first, second])
}
