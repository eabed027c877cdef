//! `Divergence` and `InvariantVolume`: density form, divergence of the motion, and the volume it keeps.

use proc_macro2::TokenStream;
use quote::quote;

use super::function::number;
use super::{Context, doc};
use crate::program::Function;

/// `impl InvariantVolume`, if a volume was found.
pub(super) fn emit_invariant_volume(context: &Context<'_>) -> TokenStream {
    let Some(volume) = &context.program.volume else {
        return TokenStream::new();
    };
    let type_name = &context.names.type_name;
    if context.is_wrapped() {
        return emit_delegated_volume(context);
    }
    let (independent, is_single_valued) = (&volume.independent, volume.is_single_valued);
    let density = context.position_body(&volume.log_density);
    let density_doc = match &volume.gradient {
        None => doc::formula("G", &volume.log_density.cost),
        Some((_, gradient)) => doc::formula(
            "G, numeric: the integral of dG from a configuration, by Gauss and Legendre's rule; at each of its nodes",
            &gradient.cost,
        ),
    };
    let (density_statements, log_density) = (density.statements, &density.outputs[0]);
    let total = context.position_body(&volume.log_volume);
    let total_doc = doc::formula("G + ln det g - ln |det A_dep|", &volume.log_volume.cost);
    let (total_statements, log_volume) = (total.statements, &total.outputs[0]);
    let is_integral = volume.gradient.is_some();
    let (integral, added) = match &volume.gradient {
        Some(gradient) => {
            let integral = emit_integral(context, gradient);
            let density = quote!(::dalembert::InvariantVolume::log_density(self, t, q)?);
            (quote!(+ #integral), quote!(+ #density))
        }
        None => (TokenStream::new(), TokenStream::new()),
    };
    let attributes = super::attributes();
    quote! {
        #attributes
        impl ::dalembert::InvariantVolume for #type_name {
            const INDEPENDENT: &'static [usize] = &[#(#independent),*];
            const IS_SINGLE_VALUED: bool = #is_single_valued;
            const IS_INTEGRAL: bool = #is_integral;

            #density_doc
            #[inline]
            fn log_density(&self, t: f64, q: &Self::Vector) -> ::core::result::Result<f64, ::dalembert::Fault> {
                #density_statements
                ::core::result::Result::Ok(#log_density #integral)
            }

            #total_doc
            #[inline]
            fn log_volume(&self, t: f64, q: &Self::Vector) -> ::core::result::Result<f64, ::dalembert::Fault> {
                #total_statements
                ::core::result::Result::Ok(#log_volume #added)
            }
        }
    }
}

/// That of the model, for the type that holds it: the volume depends on the configuration alone.
fn emit_delegated_volume(context: &Context<'_>) -> TokenStream {
    let (type_name, model) = (&context.names.type_name, &context.names.own);
    let attributes = super::attributes();
    let own = quote!(<#model as ::dalembert::InvariantVolume>);
    quote! {
        #attributes
        impl ::dalembert::InvariantVolume for #type_name {
            const INDEPENDENT: &'static [usize] = #own::INDEPENDENT;
            const IS_SINGLE_VALUED: bool = #own::IS_SINGLE_VALUED;
            const IS_INTEGRAL: bool = #own::IS_INTEGRAL;

            #[inline]
            fn log_density(&self, t: f64, q: &Self::Vector) -> ::core::result::Result<f64, ::dalembert::Fault> {
                #own::log_density(&self.0, t, q)
            }

            #[inline]
            fn log_volume(&self, t: f64, q: &Self::Vector) -> ::core::result::Result<f64, ::dalembert::Fault> {
                #own::log_volume(&self.0, t, q)
            }
        }
    }
}

/// `line_integral(..)?`, the part of `G` that has no closed form.
fn emit_integral(
    context: &Context<'_>,
    (reference, gradient): &(Vec<f64>, Function),
) -> TokenStream {
    let body = context.position_body(gradient);
    let (statements, beta) = (body.statements, body.outputs);
    let reference = reference.iter().map(|own| number(*own));
    quote! {
        ::dalembert::__private::line_integral([#(#reference),*], q, |q| {
            #statements
            ::core::result::Result::Ok(::dalembert::__private::vector([#(#beta),*]))
        })?
    }
}
