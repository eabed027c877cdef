//! Emits the methods that models with constraints override.

use proc_macro2::TokenStream;
use quote::quote;

use super::Context;

/// Emits `nearest_by_steps`: nearest admissible velocities by Newton's method.
pub(super) fn emit_nearest() -> TokenStream {
    quote! {
        fn nearest_by_steps(
            &self,
            t: f64,
            q: &Self::Vector,
            qdot: &Self::Vector,
        ) -> ::core::result::Result<Self::State, ::dalembert::Fault> {
            ::dalembert::__private::nearest_of_declared(self, t, q, qdot)
        }
    }
}

/// Emits `completed_position`: solves the position-level constraints for positions that are not given.
pub(super) fn emit_positions() -> TokenStream {
    quote! {
        fn completed_position(
            &self,
            t: f64,
            q: &Self::Vector,
            placed: &Self::Vector,
        ) -> ::core::result::Result<Self::Vector, ::dalembert::StateError> {
            ::dalembert::__private::complete_positions(self, t, q, placed)
        }
    }
}

/// Emits `admits`, which checks velocities, and `completed_velocity`, which computes velocities that are not given.
pub(super) fn emit_velocities() -> TokenStream {
    quote! {
        fn admits(
            &self,
            t: f64,
            q: &Self::Vector,
            qdot: &Self::Vector,
        ) -> ::core::result::Result<(), ::dalembert::StateError> {
            ::dalembert::__private::admit(self, t, q, qdot)
        }

        fn completed_velocity(
            &self,
            t: f64,
            q: &Self::Vector,
            qdot: &Self::Vector,
            named: &Self::Vector,
        ) -> ::core::result::Result<Self::Vector, ::dalembert::StateError> {
            ::dalembert::__private::complete_velocities(self, t, q, qdot, named)
        }
    }
}

/// Emits the methods of a form with constraints. They override defaults that accept every state.
pub(super) fn emit_hooks(context: &Context<'_>) -> TokenStream {
    let Some(functions) = &context.form.program.constrained else {
        return TokenStream::new();
    };
    let drop = functions.can_lose_rank.then(|| emit_rank_drop(context));
    let positions = functions.level_scales.is_some().then(emit_positions);
    let nearest = context.form.model.is_nonlinear().then(emit_nearest);
    let velocities = emit_velocities();
    quote!(#drop #positions #nearest #velocities)
}

/// Emits `rank_drop_along` for a system whose constraint forms may become dependent.
fn emit_rank_drop(context: &Context<'_>) -> TokenStream {
    let (m, n) = (
        context.form.model.constraints.len(),
        context.form.dimension(),
    );
    quote! {
        const MAY_LOSE_RANK: bool = true;

        fn rank_drop_along(
            &self,
            motion: impl ::core::ops::Fn(f64) -> (f64, Self::State),
            reach: f64,
        ) -> ::core::option::Option<::dalembert::RankDrop> {
            ::dalembert::__private::rank_drop::<Self, #m, #n>(self, motion, reach)
        }
    }
}
