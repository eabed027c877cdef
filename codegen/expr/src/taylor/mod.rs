//! Truncated Taylor series of expressions in several variables, modulo a prime, in double precision or with 47 digits.
//!
//! | file | job |
//! |---|---|
//! | `arithmetic.rs` | the numbers: residues modulo a prime, doubles |
//! | `extended.rs` | numbers and points of 47 digits |
//! | `space.rs` | the monomials and their products |
//! | `jet.rs` | the series: products, powers, exponentials, circular functions |
//! | `expand.rs` | expressions at a point become series |

mod arithmetic;
mod expand;
mod extended;
mod jet;
mod space;

pub use arithmetic::{Arithmetic, Reals};
pub use expand::{ExpansionPoint, RealPoint};
pub use extended::{ExtendedPoint, ExtendedReals, Real};
pub use jet::{Jets, Series};
pub use space::JetSpace;
