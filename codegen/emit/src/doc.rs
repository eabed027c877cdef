//! Doc comments of generated items.

use proc_macro2::TokenStream;
use quote::quote;

use super::Context;
use dalembert_codegen::program::{Cost, Form};

/// A doc comment with these lines.
pub(super) fn lines<S: AsRef<str>>(lines: &[S]) -> TokenStream {
    let lines = lines.iter().map(|line| {
        let text = line.as_ref();
        let text = if text.is_empty() || text.starts_with(' ') {
            text.to_string()
        } else {
            format!(" {text}")
        };
        quote!(#[doc = #text])
    });
    quote!(#(#lines)*)
}

/// A doc comment with a formula and its operation count.
pub(super) fn formula(text: &str, cost: &Cost) -> TokenStream {
    lines(&[format!("`{text}`"), String::new(), format!("{cost}.")])
}

/// The components of the state, in order: `x, y, p_x, p_y`, or `x, y, theta, v, omega`.
pub(super) fn state_order(context: &Context<'_>) -> String {
    let names = |prefix: &str| -> Vec<String> {
        let coordinates = context.form.model.coordinates.iter();
        coordinates
            .map(|coordinate| format!("{prefix}{}", coordinate.name.display))
            .collect()
    };
    let motion = match context.form.program.form {
        Form::Global => names("p_"),
        Form::Reduced => context.form.quasi_names(),
        Form::FirstOrder => Vec::new(),
    };
    [names(""), motion].concat().join(", ")
}
