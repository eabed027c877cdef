//! Systems with modes: at every time the motion is one of several, and transitions lead from one to another.
//!
//! The state of the whole is that of the present mode, filled up with zeros to the length of the longest, and behind it the number of
//! the mode, which no motion changes. So a run goes on through transitions with the same integrator, the same search for crossings and
//! the same effects as through impacts; a transition is a surface at which the state becomes one of another mode.
//!
//! Modes are told apart where kernels are asked ([`Part`](crate::kernels::Part)). Here stands what a mode does as a system of its own.
//!
//! | file | job |
//! |---|---|
//! | `list.rs` | the modes of a declared model, by their types |
//! | `series.rs` | power series of the whole, by those of the modes |
//! | `within.rs` | an effect of whatever mode the motion is in |

mod list;
pub(crate) mod series;
mod within;

pub use list::{ModeList, rank_drop};
pub use series::{Expansion, Lengths};
pub use within::InMode;

use crate::contract::TaylorField;
use crate::numbers::Row;

/// What a mode knows at a moment besides rates and gaps.
pub const fn rest<M: TaylorField>() -> usize {
    let [firsts, rates, gaps] = [
        <M::Firsts<f64> as Row<f64>>::CAPACITY,
        <M::Row<f64> as Row<f64>>::CAPACITY,
        <M::Gaps<f64> as Row<f64>>::CAPACITY,
    ];
    firsts - rates - gaps
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
