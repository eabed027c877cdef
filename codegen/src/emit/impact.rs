//! Gaps over numbers that enclose, of a model with modes.

use proc_macro2::TokenStream;
use quote::{ToTokens, quote};

/// The gaps along stretches of motion and in boxes, which [`emit_over_numbers`] writes once.
pub(super) fn emit_gap_along() -> TokenStream {
    quote! {
        fn gap_along(
            &self,
            surface: usize,
            t: ::dalembert::numbers::TaylorModel,
            component: &dyn ::core::ops::Fn(usize) -> ::dalembert::numbers::TaylorModel,
        ) -> ::dalembert::numbers::TaylorModel {
            ::dalembert::__private::OverNumbers::gap_over(self, surface, t, component)
        }

        fn gap_about(
            &self,
            surface: usize,
            t: ::dalembert::numbers::Bent,
            component: &dyn ::core::ops::Fn(usize) -> ::dalembert::numbers::Bent,
        ) -> ::dalembert::numbers::Bent {
            ::dalembert::__private::OverNumbers::gap_over(self, surface, t, component)
        }
    }
}

/// Every gap by itself, over any kind of number. `gaps` gives it with numbers of the kind `L`.
pub(super) fn emit_over_numbers(
    type_name: &impl ToTokens,
    gaps: impl Iterator<Item = TokenStream>,
) -> TokenStream {
    let arms = gaps
        .enumerate()
        .map(|(surface, gap)| quote!(#surface => #gap,));
    let attributes = super::attributes();
    quote! {
        #attributes
        impl ::dalembert::__private::OverNumbers for #type_name {
            fn gap_over<L: ::dalembert::numbers::Numbers>(
                &self,
                surface: usize,
                t: L,
                component: &dyn ::core::ops::Fn(usize) -> L,
            ) -> L {
                match surface {
                    #(#arms)*
                    _ => ::dalembert::__private::modes::no_gap(),
                }
            }
        }
    }
}
