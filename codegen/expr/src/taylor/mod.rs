//! Truncated Taylor series of expressions in several variables, modulo a prime, in double precision, with 47 digits or in intervals.
//!
//! | file | job |
//! |---|---|
//! | `arithmetic.rs` | the numbers: residues modulo a prime, doubles |
//! | `extended.rs` | numbers and points of 47 digits |
//! | `enclosed.rs` | intervals, and boxes in place of points |
//! | `space.rs` | the monomials and their products |
//! | `jet.rs` | the series: products, powers, exponentials, circular functions |
//! | `expand.rs` | expressions at a point become series |

mod arithmetic;
mod enclosed;
mod expand;
mod extended;
mod jet;
mod space;

pub use arithmetic::{Arithmetic, Reals};
pub use enclosed::{EnclosedPoint, Enclosures};
pub use expand::{ExpansionPoint, RealPoint};
pub use extended::{ExtendedPoint, ExtendedReals, Real};
pub use jet::{Jets, Series};
pub use space::JetSpace;
