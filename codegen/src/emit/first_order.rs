//! What `System` asks for of a first-order system: its state is the position, and of mechanics there is nothing.

use proc_macro2::TokenStream;
use quote::quote;

/// States, and momenta that are refused.
pub(super) fn emit_state_functions() -> TokenStream {
    quote! {
        fn momentum(
            &self,
            t: f64,
            state: &Self::State,
        ) -> ::core::result::Result<Self::Vector, ::dalembert::Fault> {
            ::core::result::Result::Err(::dalembert::Fault::FirstOrder)
        }

        /// The positions; velocities follow from them, and those given are not looked at.
        #[inline]
        fn state_unchecked(
            &self,
            t: f64,
            q: &Self::Vector,
            qdot: &Self::Vector,
        ) -> ::core::result::Result<Self::State, ::dalembert::Fault> {
            ::core::result::Result::Ok(*q)
        }

        fn state_from_momenta(
            &self,
            t: f64,
            q: &Self::Vector,
            p: &Self::Vector,
        ) -> ::core::result::Result<Self::State, ::dalembert::Fault> {
            ::core::result::Result::Err(::dalembert::Fault::FirstOrder)
        }

        /// The rates of the field.
        fn complete_velocity(
            &self,
            t: f64,
            q: &Self::Vector,
            qdot: &Self::Vector,
            named: &Self::Vector,
        ) -> ::core::result::Result<Self::Vector, ::dalembert::StateError> {
            let velocity = <Self as ::dalembert::System>::velocity(self, t, q)?;
            ::core::result::Result::Ok(velocity)
        }
    }
}

/// An energy that is refused.
pub(super) fn emit_energy() -> TokenStream {
    quote! {
        fn energy(&self, t: f64, state: &Self::State) -> ::core::result::Result<f64, ::dalembert::Fault> {
            ::core::result::Result::Err(::dalembert::Fault::FirstOrder)
        }
    }
}

/// What belongs to impulses, which there are none of.
pub(super) fn emit_contacts() -> TokenStream {
    quote! {
        fn contact(
            &self,
            surface: usize,
            t: f64,
            state: &Self::State,
        ) -> ::core::result::Result<::dalembert::impacts::law::Contact<Self::Impulse>, ::dalembert::Fault> {
            ::core::result::Result::Err(::dalembert::Fault::FirstOrder)
        }
    }
}
