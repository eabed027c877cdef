//! The `model!` macro of dalembert. Use it as `dalembert::model!`.

#![forbid(unsafe_code)]

use proc_macro::TokenStream;

/// Declares a mechanical system and generates its simulator.
///
/// The language, with an example of every declaration, is described in `docs/language.md`. What is generated: a
/// type with the parameters as public fields, and implementations of the traits in `dalembert::contract`.
///
/// ```ignore
/// dalembert::model! {
///     /// A ball that bounces on a floor.
///     pub BouncingBall {
///         coordinates { x; }
///         parameters  { m > 0 = 1; g = 1; }
///         lagrangian = m/2*dot(x)^2 - m*g*x;
///         impacts { floor: x >= 0; }
///     }
/// }
/// ```
#[proc_macro]
pub fn model(input: TokenStream) -> TokenStream {
    dalembert_codegen::expand(input.into()).into()
}
