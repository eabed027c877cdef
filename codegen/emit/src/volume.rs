//! `InvariantVolume`: the invariant volume that was proved for a model.

use proc_macro2::TokenStream;
use quote::quote;

use super::Context;

/// `impl InvariantVolume`, if an invariant volume was proved.
pub(super) fn emit_invariant_volume(context: &Context<'_>) -> TokenStream {
    let Some(volume) = &context.form.program.volume else {
        return TokenStream::new();
    };
    let type_name = &context.names.type_name;
    if context.form.is_wrapped() {
        return emit_delegated_volume(context);
    }
    let (independent, is_single_valued) = (&volume.independent, volume.is_single_valued);
    let is_integral = volume.gradient.is_some();
    let added =
        is_integral.then(|| quote!(+ ::dalembert::InvariantVolume::log_density(self, t, q)?));
    let attributes = super::attributes();
    quote! {
        #attributes
        impl ::dalembert::InvariantVolume for #type_name {
            const INDEPENDENT: &'static [usize] = &[#(#independent),*];
            const IS_SINGLE_VALUED: bool = #is_single_valued;
            const IS_INTEGRAL: bool = #is_integral;

            #[inline]
            fn log_density(&self, t: f64, q: &Self::Vector) -> ::core::result::Result<f64, ::dalembert::Fault> {
                ::dalembert::__private::log_density(self, t, q)
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

/// Implementation for a global form that wraps a reduced model or scene. It delegates to the reduced form, because the
/// volume depends on the configuration only.
fn emit_delegated_volume(context: &Context<'_>) -> TokenStream {
    let (type_name, model) = (&context.names.type_name, &context.names.model_type);
    let attributes = super::attributes();
    let delegate = quote!(<#model as ::dalembert::InvariantVolume>);
    quote! {
        #attributes
        impl ::dalembert::InvariantVolume for #type_name {
            const INDEPENDENT: &'static [usize] = #delegate::INDEPENDENT;
            const IS_SINGLE_VALUED: bool = #delegate::IS_SINGLE_VALUED;
            const IS_INTEGRAL: bool = #delegate::IS_INTEGRAL;

            #[inline]
            fn log_density(&self, t: f64, q: &Self::Vector) -> ::core::result::Result<f64, ::dalembert::Fault> {
                #delegate::log_density(&self.0, t, q)
            }

            #[inline]
            fn log_volume(&self, t: f64, q: &Self::Vector) -> ::core::result::Result<f64, ::dalembert::Fault> {
                #delegate::log_volume(&self.0, t, q)
            }
        }
    }
}
