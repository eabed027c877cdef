//! Balls: a number of 256 bits and a bound of its distance from the number that is meant. They enclose what doubles lose by
//! cancellation, with 76 digits.
//!
//! | file | job |
//! |---|---|
//! | `wide.rs` | numbers of 256 bits: each operation states a bound of its error |
//! | `bound.rs` | bounds in double precision, rounded upwards |
//! | `number.rs` | balls: sums, products, quotients, roots |
//! | `functions.rs` | exponentials, logarithms, circular functions |
//!
//! Error bounds. A number of 256 bits is an integer below `2^256` times a power of 2. Sums and products cut off the exact
//! result: the error is below two units in the last place of the larger operand, or of the product. Exponentials and sines are Taylor polynomials
//! whose remainder is bounded by the first term that is left out. Quotients, roots, logarithms and arc tangents are approximated by
//! Newton's method, of which nothing is assumed: the error of the result is bounded by its residual, computed in balls.
//! Radii are doubles; after each operation they are rounded to the next double above.

mod bound;
mod functions;
mod number;
mod wide;

pub use number::Ball;
