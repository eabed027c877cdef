//! `Divergence` and `InvariantVolume`: density form, divergence of the motion, and the volume it keeps.

use proc_macro2::TokenStream;
use quote::quote;

use super::Context;
use super::function::number;

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
    let is_integral = volume.gradient.is_some();
    let (integral, added) = match &volume.gradient {
        Some((reference, _)) => {
            let integral = emit_integral(reference);
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

            #[inline]
            fn log_density(&self, t: f64, q: &Self::Vector) -> ::core::result::Result<f64, ::dalembert::Fault> {
                let place = [::dalembert::StateVector::as_slice(q), &[]];
                let density = ::dalembert::__private::number(self, ::dalembert::kernels::Kernels::log_density, t, place)?;
                ::core::result::Result::Ok(density #integral)
            }

            #[inline]
            fn log_volume(&self, t: f64, q: &Self::Vector) -> ::core::result::Result<f64, ::dalembert::Fault> {
                let place = [::dalembert::StateVector::as_slice(q), &[]];
                let volume = ::dalembert::__private::number(self, ::dalembert::kernels::Kernels::log_volume, t, place)?;
                ::core::result::Result::Ok(volume #added)
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

/// `line_integral(..)?`, the part of `G` that has no closed form; `reference` is the configuration that it begins at.
fn emit_integral(reference: &[f64]) -> TokenStream {
    let reference = reference.iter().map(|own| number(*own));
    quote! {
        ::dalembert::__private::line_integral([#(#reference),*], q, |q| {
            let mut gradient = ::dalembert::System::zero_vector(self);
            let place = [::dalembert::StateVector::as_slice(q), &[]];
            let values = ::dalembert::StateVector::as_mut_slice(&mut gradient);
            ::dalembert::__private::write(self, ::dalembert::kernels::Kernels::density_gradient, t, place, values)?;
            ::core::result::Result::Ok(gradient)
        })?
    }
}
