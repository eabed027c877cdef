//! Balls: a floating-point number with a mantissa of 256 bits, and a bound of its distance from the exact number. With
//! 76 digits, they enclose results that doubles lose by cancellation.
//!
//! | file | job |
//! |---|---|
//! | `wide.rs` | numbers with mantissas of 256 bits: each operation returns a bound of its error |
//! | `bound.rs` | bounds in double precision, rounded upwards |
//! | `number.rs` | balls: sums, products, quotients, roots |
//! | `functions.rs` | exponentials, logarithms, circular functions |
//!
//! Error bounds. The middle of a ball is an integer below `2^256` times a power of 2. Sums and products are truncated.
//! The error of a sum is below two units in the last place of the larger operand, the error of a product below one unit
//! in its last place. Exponentials, sines and cosines are Taylor polynomials; twice the first omitted term bounds their
//! remainder. Quotients, roots, logarithms and arc tangents are approximated by Newton's method. Its convergence is not
//! assumed: the residual, computed in balls, bounds the error of the result. Radii are doubles; each operation rounds
//! them to the next double above.

mod bound;
mod functions;
mod number;
mod wide;

pub use number::Ball;
