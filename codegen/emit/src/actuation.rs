//! `Actuated`: inputs that the caller supplies. `Powered`: the powers that change the energy, those of the named forces
//! one by one.

use dalembert_codegen::model::Model;
use proc_macro2::TokenStream;
use quote::{ToTokens, quote};

use super::Context;

/// `impl Actuated`, if inputs are declared.
pub(super) fn emit_actuated(context: &Context<'_>) -> TokenStream {
    let names = &context.names;
    emit_actuated_type(context.form.model, &names.type_name, &names.parameters)
}

/// Same, for a type that holds the parameters at these places.
pub(super) fn emit_actuated_type(
    model: &Model,
    type_name: impl ToTokens,
    places: &[TokenStream],
) -> TokenStream {
    let inputs: Vec<usize> = model.inputs().map(|(k, _)| k).collect();
    if inputs.is_empty() {
        return TokenStream::new();
    }
    let count = inputs.len();
    let set = inputs.iter().enumerate().map(|(index, &k)| {
        let place = &places[k];
        quote!(#place = inputs[#index];)
    });
    let attributes = super::attributes();
    quote! {
        #attributes
        impl ::dalembert::Actuated for #type_name {
            type Inputs = [f64; #count];

            #[inline(always)]
            fn set_inputs(&mut self, inputs: &Self::Inputs) {
                #(#set)*
            }
        }
    }
}

/// `impl Powered`, if forces are declared and the model is not first-order.
pub(super) fn emit_powered(context: &Context<'_>) -> TokenStream {
    let Some(powers) = &context.form.program.powers else {
        return TokenStream::new();
    };
    let (type_name, names) = (&context.names.type_name, &powers.names);
    let count = names.len();
    let attributes = super::attributes();
    quote! {
        #attributes
        impl ::dalembert::Powered for #type_name {
            type Powers = ::dalembert::__private::SVector<f64, #count>;
            const POWERS: &'static [&'static str] = &[#(#names),*];

            #[inline]
            fn powers(
                &self,
                t: f64,
                state: &Self::State,
            ) -> ::core::result::Result<Self::Powers, ::dalembert::Fault> {
                let mut powers = [0.0; #count];
                let place = [::dalembert::StateVector::as_slice(state), &[]];
                ::dalembert::__private::write(self, ::dalembert::kernels::Kernels::powers, t, place, &mut powers)?;
                ::core::result::Result::Ok(::dalembert::__private::vector(powers))
            }
        }
    }
}
