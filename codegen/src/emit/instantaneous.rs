//! `focus` and `trace`, of `Impacting` and of `Variational`: constraints that hold in the moment of an impact only.

use proc_macro2::{Ident, Span, TokenStream};
use quote::quote;

use super::function::joined;
use super::{Context, doc};
use crate::program::{Function, Impacting};

/// Both functions, where a surface has such constraints.
pub(super) fn emit_instantaneous(context: &Context<'_>, functions: &Impacting) -> TokenStream {
    if functions.focuses.iter().all(Option::is_none) {
        return TokenStream::new();
    }
    let focus = emit(
        context,
        "focus",
        "The impulse after which the instantaneous constraints hold.",
        &TokenStream::new(),
        &functions.focuses,
    );
    let trace = emit(
        context,
        "trace",
        "The force under which the instantaneous constraints go on holding at these rates of momenta or quasi-velocities.",
        &quote!(motion: &Self::Impulse,),
        &functions.traces,
    );
    joined([focus, trace])
}

fn emit(
    context: &Context<'_>,
    name: &str,
    title: &str,
    argument: &TokenStream,
    functions: &[Option<Function>],
) -> TokenStream {
    let arms = functions.iter().enumerate().filter_map(|(s, function)| {
        let body = context.state_body(function.as_ref()?);
        let (statements, outputs) = (body.statements, body.outputs);
        Some(quote!(#s => { #statements ::dalembert::__private::vector([#(#outputs),*]) }))
    });
    let mut lines = vec![title.to_owned(), String::new()];
    for (surface, function) in context.model.surfaces.iter().zip(functions) {
        if let Some(function) = function {
            let names = surface.instantaneous.iter();
            let names: Vec<&str> = names.map(|own| own.name.display.as_str()).collect();
            let (surface, names) = (&surface.name.display, names.join("`, `"));
            lines.push(format!("* `{surface}`: `{names}`, {}.", function.cost));
        }
    }
    let (documentation, name) = (doc::lines(&lines), Ident::new(name, Span::call_site()));
    quote! {
        #documentation
        #[inline]
        fn #name(
            &self,
            surface: usize,
            t: f64,
            state: &Self::State,
            #argument
        ) -> ::core::result::Result<::core::option::Option<Self::Impulse>, ::dalembert::Fault> {
            let impulse = match surface {
                #(#arms)*
                _ => return ::core::result::Result::Ok(::core::option::Option::None),
            };
            ::core::result::Result::Ok(::core::option::Option::Some(impulse))
        }
    }
}

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
