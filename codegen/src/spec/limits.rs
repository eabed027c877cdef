//! Limits on the size of declarations. All are counts rather than times, so that a build gives the same result on every
//! machine.

use dalembert_expr::Rational;
use proc_macro2::{TokenStream, TokenTree};

use crate::diagnostics::{Diagnostics, Location};

/// Nesting depth of brackets, and of exponents.
pub const NESTING: usize = 256;
/// Characters of a name.
pub const NAME_LENGTH: usize = 64;
/// Digits of a literal.
pub const LITERAL_DIGITS: usize = 40;
/// Coordinates of a model, after the expansion of families.
pub const COORDINATES: usize = 64;
/// Parameters of a model, after the expansion of families.
pub const PARAMETERS: usize = 256;
/// Impact surfaces of a model, after the expansion of families.
pub const SURFACES: usize = 256;
/// Scenes of a model; each is derived and emitted like a model of its own.
pub const SCENES: usize = 32;
/// Magnitude of an exponent.
pub const EXPONENT: i64 = 4096;
/// Bits of the denominator of an exponent.
pub const EXPONENT_DENOMINATOR_BITS: u64 = 12;
/// Bits of an exact number.
pub const NUMBER_BITS: u64 = 4096;
/// Nodes of the shared expressions.
pub const EXPRESSIONS: usize = 1 << 20;
/// Steps of algebra for one model: one for each expression, for each of its operands and for each word of its numbers.
pub const STEPS: u64 = 1 << 22;
/// Members of a family of definitions, and terms of a `sum`.
pub const FAMILY: i64 = 4096;
/// Subexpressions visited while definitions and sums are expanded.
pub const RESOLVED_PARTS: usize = 1 << 20;
/// Nesting depth of an expression after the expansion of definitions.
pub const RESOLVED_DEPTH: usize = 1024;

/// True if the nearest double is finite, and not zero or denormal unless the number is zero.
pub fn is_a_double(value: &Rational) -> bool {
    let double = value.to_f64();
    value.is_zero() || double.is_normal()
}

/// Refuses brackets that are nested deeper than [`NESTING`]. The check does not recurse; later stages may.
pub(super) fn check_nesting(tokens: &TokenStream) -> Result<(), Diagnostics> {
    let mut deepest = 0;
    let mut culprit = None;
    let mut pending: Vec<(usize, TokenStream)> = vec![(0, tokens.clone())];
    while let Some((depth, stream)) = pending.pop() {
        deepest = deepest.max(depth);
        for token in stream {
            let TokenTree::Group(group) = token else {
                continue;
            };
            if depth + 1 == NESTING + 1 && culprit.is_none() {
                culprit = Some(Location::opening(&group));
            }
            pending.push((depth + 1, group.stream()));
        }
    }
    let mut diagnostics = Diagnostics::new();
    if let Some(at) = culprit {
        diagnostics
            .error(at, format!("nested {deepest} deep; the limit is {NESTING}"))
            .help("name the inner parts with `let`");
    }
    diagnostics.finish(())
}
