//! `focus` and `trace` of `Variational`: constraints that hold in the moment of an impact only.

use proc_macro2::TokenStream;
use quote::quote;

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
