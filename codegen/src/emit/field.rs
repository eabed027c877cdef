//! `VectorField` and `System`: the motion of the state `(q, p)`.

use proc_macro2::{Ident, TokenStream};
use quote::quote;

use super::Context;
use super::function::{Body, emit_body, joined, uses};
use crate::program::{Form, Function, Input};

impl Context<'_> {
    /// Number of coordinates.
    pub(super) fn dimension(&self) -> usize {
        self.model.coordinates.len()
    }

    /// Number of components of the state beside the positions.
    pub(super) fn motion_dimension(&self) -> usize {
        match self.program.form {
            Form::Global => self.dimension(),
            Form::Reduced => self.names.quasi.len(),
            Form::FirstOrder => 0,
        }
    }

    /// The names of the quasi-velocities.
    pub(super) fn quasi_names(&self) -> Vec<String> {
        let quasi = self.frame.iter().flat_map(|frame| &frame.quasi);
        quasi.map(|own| own.name.clone()).collect()
    }

    /// `let [x, _, p_x, p_y] = components(state);` with what the function uses.
    pub(super) fn bind_state(&self, function: &Function) -> TokenStream {
        bind(&self.state_patterns(function), &quote!(state))
    }

    /// `let [x, _, p_x, p_y] = *state;` with what the function uses.
    pub(super) fn bind_row(&self, function: &Function) -> TokenStream {
        let patterns = self.state_patterns(function);
        if !patterns.iter().any(|(_, any)| *any) {
            return TokenStream::new();
        }
        let parts = patterns.iter().map(|(tokens, _)| tokens);
        quote!(let [#(#parts),*] = *state;)
    }

    /// `let [x, _] = *source;` with those of some locals that the function uses, from an array called `q` or `qdot`.
    pub(super) fn bind_row_of(
        &self,
        function: &Function,
        locals: &[Ident],
        input: fn(usize) -> Input,
    ) -> TokenStream {
        let (pattern, any) = pattern(locals, |i| uses(function, |own| own == input(i)));
        let source = match input(0) {
            Input::Coordinate(_) => quote!(q),
            _ => quote!(qdot),
        };
        match any {
            true => quote!(let [#pattern, ..] = *#source;),
            false => TokenStream::new(),
        }
    }

    fn state_patterns(&self, function: &Function) -> [(TokenStream, bool); 2] {
        let coordinates = pattern(&self.names.coordinates, |i| {
            uses(function, |input| input == Input::Coordinate(i))
        });
        let motion = match self.program.form {
            Form::Global => self.momentum_pattern(function),
            Form::Reduced => pattern(&self.names.quasi, |i| {
                uses(function, |input| input == Input::Quasi(i))
            }),
            Form::FirstOrder => (TokenStream::new(), false),
        };
        [coordinates, motion]
    }

    fn momentum_pattern(&self, function: &Function) -> (TokenStream, bool) {
        pattern(&self.names.momenta, |i| {
            uses(function, |input| input == Input::Momentum(i))
        })
    }

    /// `let [x_dot, _] = components(qdot);` with the velocities that the function uses.
    pub(super) fn bind_velocities(&self, function: &Function) -> TokenStream {
        let velocities = pattern(&self.names.velocities, |i| {
            uses(function, |input| input == Input::Velocity(i))
        });
        bind(&[velocities], &quote!(qdot))
    }

    /// The statements of a function of `(t, q, p)` and its results; where it takes velocities too, they are computed
    /// first.
    pub(super) fn state_body(&self, function: &Function) -> Body {
        let state = self.bind_state(function);
        if !uses(function, |input| matches!(input, Input::Velocity(_))) {
            return self.body(state, function);
        }
        let velocities = self.bind_velocities(function);
        let compute = quote!(let qdot = &<Self as ::dalembert::System>::velocity(self, t, state)?;);
        self.body(quote!(#compute #velocities #state), function)
    }

    /// The statements of a function after what binds its arguments.
    pub(super) fn body(&self, bindings: TokenStream, function: &Function) -> Body {
        let Body {
            statements,
            outputs,
        } = emit_body(function, &self.names);
        Body {
            statements: joined([bindings, statements]),
            outputs,
        }
    }
}

/// A pattern of locals, `_` where nothing is used; and whether anything is.
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

fn bind(patterns: &[(TokenStream, bool)], source: &TokenStream) -> TokenStream {
    if !patterns.iter().any(|(_, any)| *any) {
        return TokenStream::new();
    }
    let parts = patterns.iter().map(|(tokens, _)| tokens);
    quote!(let [#(#parts),*] = ::dalembert::__private::components(#source);)
}

/// `rates_along`, where the rate may have narrow features.
pub(super) fn emit_rates_along() -> TokenStream {
    quote! {
        #[inline(always)]
        fn can_be_narrow(&self) -> bool { true }

        fn rates_along(
            &self,
            t: ::dalembert::numbers::Rated,
            component: &dyn ::core::ops::Fn(usize) -> ::dalembert::numbers::Rated,
            rate: &mut dyn ::core::ops::FnMut(usize, ::dalembert::numbers::Rated),
        ) -> ::core::result::Result<(), ::dalembert::Fault> {
            ::dalembert::__private::rates_along(self, t, component, rate)
        }
    }
}
