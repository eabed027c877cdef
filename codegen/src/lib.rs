//! Code generator of dalembert: a declared model in, specialised Rust out.
//!
//! ```text
//! TokenStream --spec::parse--> Spec --model::check--> Model --mechanics::derive--> Derivation
//!     --program::lower--> Program --emit::tokens--> TokenStream
//! ```
//!
//! Each stage takes the previous type and returns a new one. The first two can fail, with every mistake of the
//! stage at once, at the user's tokens; the others cannot.

#![forbid(unsafe_code)]

pub mod diagnostics;
pub mod emit;
pub mod mechanics;
pub mod model;
pub mod program;
pub mod report;
pub mod spec;

use proc_macro2::TokenStream;

/// The whole pipeline: the body of a `model!` in, Rust items out; on mistakes, compile errors and nothing else.
pub fn expand(input: TokenStream) -> TokenStream {
    match try_expand(input) {
        Ok(items) => items,
        Err(diagnostics) => diagnostics.into_compile_error(),
    }
}

/// The pipeline, with its diagnostics.
///
/// # Errors
/// Every mistake of the first stage that found any.
pub fn try_expand(input: TokenStream) -> Result<TokenStream, diagnostics::Diagnostics> {
    let spec = spec::parse(input)?;
    let mut model = model::check(&spec)?;
    let derivation = mechanics::derive(&mut model);
    let program = program::lower(&model, &derivation);
    Ok(emit::tokens(&model, &program))
}
