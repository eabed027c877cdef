//! Stage 1, parse: turns tokens into a syntax tree with the source location of every part.
//!
//! ```text
//! model      = docs visibility Name { declaration* }
//! declaration = section { (entry ;)* } | let .. = e ; | const N = e ; | lagrangian = e ;
//! ```
//!
//! After an error in an entry, parsing continues after the next `;`, so that later errors are reported as well.

mod ast;
mod cursor;
mod display;
mod keyword;
mod limits;
mod literal;
mod parse;
mod scalar;
mod slips;

pub use ast::*;
pub use keyword::{
    EXTRAS, FUNCTIONS, INSTANTANEOUS, INTEGRAL, LAGRANGIAN, LAWS, PIECEWISE, RESET, SECTIONS, STOP,
    WHOLE, foreign_function, is_function, is_not_differentiable, is_rust_keyword,
};
pub use limits::{
    COORDINATES, EXPONENT, EXPONENT_DENOMINATOR_BITS, EXPRESSIONS, FAMILY, NUMBER_BITS, PARAMETERS,
    RESOLVED_DEPTH, RESOLVED_PARTS, SCENES, STEPS, SURFACES, is_a_double,
};
pub use parse::{add_claim, camel_case, mode_help, parse, read};
