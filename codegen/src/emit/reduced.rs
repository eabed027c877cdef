//! States reduced to D: from velocities and momenta, and back.

use proc_macro2::TokenStream;
use quote::quote;

use super::{Context, doc};
use crate::program::Reduced;

/// What `System` asks for between the state `(q, u)` and velocities or momenta.
pub(super) fn emit_state_functions(context: &Context<'_>, functions: &Reduced) -> TokenStream {
    let momentum = context.state_body(&functions.momentum);
    let momentum_doc = doc::formula("p = g (X_0 + X u) + A", &functions.momentum.cost);
    let (momentum_statements, p) = (momentum.statements, momentum.outputs);
    let quasi = context.velocity_body(&functions.quasi);
    let quasi_doc = doc::formula("u = alpha(qdot)", &functions.quasi.cost);
    let (quasi_statements, u) = (quasi.statements, quasi.outputs);
    let nearest = emit_nearest(context, functions);
    quote! {
        #momentum_doc
        #[inline]
        fn momentum(
            &self,
            t: f64,
            state: &Self::State,
        ) -> ::core::result::Result<Self::Vector, ::dalembert::Fault> {
            #momentum_statements
            ::core::result::Result::Ok(::dalembert::__private::vector([#(#p),*]))
        }

        #quasi_doc
        #[inline]
        fn state_unchecked(
            &self,
            t: f64,
            q: &Self::Vector,
            qdot: &Self::Vector,
        ) -> ::core::result::Result<Self::State, ::dalembert::Fault> {
            #quasi_statements
            let u: Self::Impulse = ::dalembert::__private::vector([#(#u),*]);
            ::core::result::Result::Ok(::dalembert::__private::join(q, &u))
        }

        #nearest
    }
}

/// The states with the allowed velocities that are nearest in the metric.
fn emit_nearest(context: &Context<'_>, functions: &Reduced) -> TokenStream {
    let function = &functions.nearest_momenta;
    let bindings = [
        context.bind_coordinates(function),
        context.bind_momenta(function),
    ];
    let momenta = context.body(quote!(#(#bindings)*), function);
    let momenta_doc = doc::formula("G_D u = X^T (p - A - g X_0)", &function.cost);
    let (momenta_statements, from_momenta) = (momenta.statements, momenta.outputs);
    let function = &functions.nearest_velocities;
    let velocities = context.velocity_body(function);
    let velocities_doc = doc::formula("G_D u = X^T g (qdot - X_0)", &function.cost);
    let (velocity_statements, from_velocities) = (velocities.statements, velocities.outputs);
    quote! {
        #momenta_doc
        #[inline]
        fn state_from_momenta(
            &self,
            t: f64,
            q: &Self::Vector,
            p: &Self::Vector,
        ) -> ::core::result::Result<Self::State, ::dalembert::Fault> {
            #momenta_statements
            let u: Self::Impulse = ::dalembert::__private::vector([#(#from_momenta),*]);
            ::core::result::Result::Ok(::dalembert::__private::join(q, &u))
        }

        #velocities_doc
        #[inline]
        fn state_nearest(
            &self,
            t: f64,
            q: &Self::Vector,
            qdot: &Self::Vector,
        ) -> ::core::result::Result<Self::State, ::dalembert::Fault> {
            #velocity_statements
            let u: Self::Impulse = ::dalembert::__private::vector([#(#from_velocities),*]);
            ::core::result::Result::Ok(::dalembert::__private::join(q, &u))
        }
    }
}
