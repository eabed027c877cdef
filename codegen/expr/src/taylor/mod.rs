//! Truncated Taylor series of expressions in several variables, modulo a prime or in double precision.
//!
//! | file | job |
//! |---|---|
//! | `arithmetic.rs` | the numbers: residues modulo a prime, doubles |
//! | `space.rs` | the monomials and their products |
//! | `jet.rs` | the series: products, powers, exponentials, circular functions |
//! | `expand.rs` | expressions at a point become series |

mod arithmetic;
mod expand;
mod jet;
mod space;

pub use arithmetic::{Arithmetic, Reals};
pub use expand::{ExpansionPoint, RealPoint};
pub use jet::{Jets, Series};
pub use space::JetSpace;
