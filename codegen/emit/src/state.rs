//! Components of a state, and the locals that they are bound to.

use proc_macro2::{Ident, TokenStream};
use quote::quote;

use super::Context;
use super::function::uses;
use dalembert_codegen::program::{Form, Function, Input};

impl Context<'_> {
    /// `let [x, _, p_x, p_y] = *state;` with the components that the function uses.
    pub(super) fn bind_row(&self, function: &Function) -> TokenStream {
        let patterns = self.state_patterns(function);
        if !patterns.iter().any(|(_, any)| *any) {
            return TokenStream::new();
        }
        let parts = patterns.iter().map(|(tokens, _)| tokens);
        quote!(let [#(#parts),*] = *state;)
    }

    fn state_patterns(&self, function: &Function) -> [(TokenStream, bool); 2] {
        let coordinates = pattern(&self.names.coordinates, |i| {
            uses(function, |input| input == Input::Coordinate(i))
        });
        let motion = match self.form.program.form {
            Form::Global => pattern(&self.names.momenta, |i| {
                uses(function, |input| input == Input::Momentum(i))
            }),
            Form::Reduced => pattern(&self.names.quasi, |i| {
                uses(function, |input| input == Input::Quasi(i))
            }),
            Form::FirstOrder => (TokenStream::new(), false),
        };
        [coordinates, motion]
    }
}

/// A pattern of locals, `_` where nothing is used. True if anything is used.
fn pattern(locals: &[Ident], used: impl Fn(usize) -> bool) -> (TokenStream, bool) {
    let mut any = false;
    let parts = locals.iter().enumerate().map(|(i, local)| match used(i) {
        true => {
            any = true;
            quote!(#local)
        }
        false => quote!(_),
    });
    let parts: Vec<TokenStream> = parts.collect();
    (quote!(#(#parts),*), any)
}
