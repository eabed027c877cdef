//! Hybrid systems with modes: at every time the motion follows one mode, and transitions lead from one mode to
//! another.
//!
//! The state of the model is the state of the present mode, padded with zeros to the length of the longest mode and
//! followed by the number of the mode, which no motion changes. A transition is a surface at which the state becomes a
//! state of another mode. A run passes it with the same integrator, event location and effects as an impact.
//!
//! [`Part`](crate::kernels::Part) selects the mode for every kernel. This module contains the functions that treat a
//! mode as a separate system.
//!
//! | file | job |
//! |---|---|
//! | `list.rs` | the modes of a declared model, by their types |
//! | `series.rs` | power series of the model, from those of the modes |
//! | `within.rs` | an effect in the present mode |

mod list;
pub(crate) mod series;
mod within;

pub use list::{ModeList, rank_drop};
pub use series::{Expansion, Lengths};
pub use within::InMode;

use crate::contract::TaylorField;
use crate::numbers::Row;

/// Number of initial values of a mode's series besides rates and gaps.
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
