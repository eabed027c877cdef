//! Truncated Taylor series of expressions in several variables, modulo a prime, in double precision, or in ranges.
//!
//! | file | job |
//! |---|---|
//! | `arithmetic.rs` | the numbers: residues modulo a prime, doubles |
//! | `enclosed.rs` | intervals, and boxes in place of points |
//! | `balls.rs` | points whose coordinates are balls, of 76 digits |
//! | `space.rs` | the monomials and their products |
//! | `jet.rs` | the series: products, powers, exponentials, circular functions |
//! | `expand.rs` | expressions at a point become series |

mod arithmetic;
mod balls;
mod enclosed;
mod expand;
mod jet;
mod space;

pub use arithmetic::{Arithmetic, Reals};
pub use balls::{BallPoint, Balls};
pub use enclosed::{EnclosedPoint, Enclosures, RangePoint};
pub use expand::{ExpansionPoint, RealPoint};
pub use jet::{Jets, Series};
pub use space::JetSpace;
