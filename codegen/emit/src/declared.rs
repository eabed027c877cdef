//! `Declared`: vector types of a form, and values of its parameters.

use proc_macro2::TokenStream;
use quote::quote;

use super::{Context, kernels};

/// `impl Declared`, and the marker traits for constraints, surfaces and divergence.
pub(super) fn emit_declared(context: &Context<'_>) -> TokenStream {
    let (type_name, kernels) = (&context.names.type_name, kernels::type_name(context));
    let places = &context.names.parameters;
    let (n, k) = (context.form.dimension(), context.form.motion_dimension());
    let (m, s) = (
        context.form.model.constraints.len(),
        context.form.model.surfaces.len(),
    );
    let [size, parameters, levels, room] = [
        n + k,
        places.len(),
        context.form.levels(),
        context.form.room(),
    ];
    let may_be_narrow = context.form.program.can_be_narrow;
    let hooks = super::constraint::emit_hooks(context);
    let parts = emit_parts(context);
    let attributes = super::attributes();
    let numbers = quote!(L: ::dalembert::numbers::Numbers);
    quote! {
        #attributes
        impl ::dalembert::kernels::Declared for #type_name {
            type State = ::dalembert::__private::SVector<f64, #size>;
            type Vector = ::dalembert::__private::SVector<f64, #n>;
            type Impulse = ::dalembert::__private::SVector<f64, #k>;
            type Gaps = ::dalembert::__private::SVector<f64, #s>;
            type Multipliers = ::dalembert::__private::SVector<f64, #m>;
            type Levels = ::dalembert::__private::SVector<f64, #levels>;
            type Positions<#numbers> = [L; #n];
            type Components<#numbers> = [L; #size];
            type Arguments<#numbers> = [L; #parameters];
            type Room<#numbers> = [L; #room];
            type Values<'a> = [f64; #parameters];
            type Kernels = #kernels;

            const MAY_BE_NARROW: bool = #may_be_narrow;

            #[inline(always)]
            fn kernels(&self) -> #kernels { #kernels }

            #[inline(always)]
            fn tables(&self) -> &'static ::dalembert::kernels::Tables {
                <Self as ::dalembert::declaration::Emitted>::TABLES
            }

            #[inline(always)]
            fn arguments(&self) -> [f64; #parameters] { [#(#places),*] }

            #hooks
        }

        #parts
    }
}

/// Marker traits of the form: `HasConstraints`, `HasSurfaces`, `HasDivergence`.
fn emit_parts(context: &Context<'_>) -> TokenStream {
    let type_name = &context.names.type_name;
    let program = context.form.program;
    let parts = [
        (program.constrained.is_some(), quote!(HasConstraints)),
        (program.impacting.is_some(), quote!(HasSurfaces)),
        (program.density.is_some(), quote!(HasDivergence)),
    ];
    let parts = parts.iter().filter(|(has, _)| *has).map(|(_, part)| part);
    quote!(#(impl ::dalembert::kernels::#parts for #type_name {})*)
}
