//! The `model!` macro of dalembert. Use it as `dalembert::model!`.

#![forbid(unsafe_code)]

use proc_macro::TokenStream;

/// Declares a mechanical system and generates its simulator.
///
/// The language, with an example of every declaration, is described in `docs/language.md`. The macro generates a
/// type with the parameters as public fields, and implementations of the traits in `dalembert::contract`. For a model
/// that runs in the form reduced to its constraints, `#[global]` asks for its global form as well. Its type has the
/// name of the model with `Global` at the end, and holds a value of the model.
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
    dalembert_emit::expand(input.into()).into()
}

/// Declares the models of a file: `dalembert::model_file!("src/disk.dal")`. The path begins at the folder of the crate.
///
/// The file holds the text between the braces of [`model!`], for one model or for several. The command line runs the
/// same file. The crate is built again when the file changes. `#[global]` asks for the global form of a model, either
/// before the model or, for a file with one model, before the path: `model_file!(#[global] "src/disk.dal")`.
#[proc_macro]
pub fn model_file(input: TokenStream) -> TokenStream {
    let folder = std::env::var_os("CARGO_MANIFEST_DIR").unwrap_or_default();
    dalembert_emit::expand_file(input.into(), folder.as_ref()).into()
}
