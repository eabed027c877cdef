//! `focus` and `trace`, of `Impacting` and of `Variational`: constraints that hold in the moment of an impact only.

use proc_macro2::TokenStream;
use quote::quote;

use super::Context;
use crate::program::Function;

/// Both functions over numbers, where a surface has such constraints. They give states and rates, not what is added to them.
pub(super) fn emit_varied(context: &Context<'_>) -> TokenStream {
    let functions = context.program.impacting.iter();
    let functions = functions.filter(|own| own.focuses.iter().any(Option::is_some));
    let emitted = functions.map(|own| {
        let focus = emit_added(context, &own.focuses, &quote!(state));
        let trace = emit_added(context, &own.traces, &quote!(rate));
        let motion = context.dimension();
        over_numbers(&focus, &quote!(let motion = &rate[#motion..]; #trace))
    });
    emitted.collect()
}

/// Both functions of `Variational`, with these bodies.
pub(super) fn over_numbers(focus: &TokenStream, trace: &TokenStream) -> TokenStream {
    let result = quote! {
        ::core::result::Result<::core::option::Option<Self::Row<L>>, ::dalembert::Fault>
    };
    quote! {
        fn focus<L: ::dalembert::numbers::Numbers>(
            parameters: &Self::Parameters<L>,
            surface: usize,
            t: L,
            state: &Self::Row<L>,
        ) -> #result {
            #focus
        }

        fn trace<L: ::dalembert::numbers::Numbers>(
            parameters: &Self::Parameters<L>,
            surface: usize,
            t: L,
            state: &Self::Row<L>,
            rate: &Self::Row<L>,
        ) -> #result {
            #trace
        }
    }
}

/// `to` with what a surface's function adds to its momenta or quasi-velocities.
fn emit_added(
    context: &Context<'_>,
    functions: &[Option<Function>],
    to: &TokenStream,
) -> TokenStream {
    let arms = functions.iter().enumerate().filter_map(|(s, function)| {
        let body = context.varied_body(function.as_ref()?);
        let (statements, outputs) = (body.statements, body.outputs);
        Some(quote!(#s => { #statements [#(#outputs),*] }))
    });
    let motion = context.dimension();
    quote! {
        let added = match surface {
            #(#arms)*
            _ => return ::core::result::Result::Ok(::core::option::Option::None),
        };
        let mut sum = *#to;
        for (entry, added) in sum[#motion..].iter_mut().zip(added) {
            *entry = *entry + added;
        }
        ::core::result::Result::Ok(::core::option::Option::Some(sum))
    }
}
