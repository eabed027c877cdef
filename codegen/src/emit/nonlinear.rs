//! What constraints that are not linear in the velocities emit otherwise: forms at given velocities, Newton's steps to the
//! constraints; and what they leave undefined.

use proc_macro2::TokenStream;
use quote::quote;

use super::function::Body;
use super::{Context, doc};
use crate::program::{Constrained, Return};

/// `constraint_forms` at rest, and `linearised_forms`.
pub(super) fn emit_forms(context: &Context<'_>, functions: &Constrained) -> TokenStream {
    let (n, m) = (context.dimension(), context.model.constraints.len());
    let Body {
        statements,
        outputs,
    } = context.velocity_body(&functions.forms);
    let (forms, affine) = outputs.split_at(n * m);
    quote! {
        #[inline(always)]
        fn is_linear(&self) -> bool { false }

        #[inline]
        fn constraint_forms(&self, t: f64, q: &Self::Vector, forms: &mut [f64], affine: &mut Self::Multipliers) {
            let rest = ::dalembert::System::zero_vector(self);
            ::dalembert::Constrained::linearised_forms(self, t, q, &rest, forms, affine);
        }

        /// `dphi^a/dqdot`, and `phi^a - (dphi^a/dqdot) qdot`.
        #[inline]
        fn linearised_forms(
            &self,
            t: f64,
            q: &Self::Vector,
            qdot: &Self::Vector,
            forms: &mut [f64],
            affine: &mut Self::Multipliers,
        ) {
            #statements
            for (entry, value) in forms.iter_mut().zip([#(#forms),*]) {
                *entry = value;
            }
            *affine = ::dalembert::__private::vector([#(#affine),*]);
        }
    }
}

/// `state_nearest`, by Newton's steps.
pub(super) fn emit_nearest(context: &Context<'_>, back: &Return) -> TokenStream {
    let documentation = doc::formula(
        "Newton's steps p + mu_a eta^a, m mu = -phi, eta = dphi/dqdot",
        &back.nearest.cost,
    );
    let Body {
        statements,
        outputs,
    } = context.velocity_body(&back.nearest);
    quote! {
        #documentation
        #[inline]
        fn state_nearest(
            &self,
            t: f64,
            q: &Self::Vector,
            qdot: &Self::Vector,
        ) -> ::core::result::Result<Self::State, ::dalembert::Fault> {
            ::dalembert::__private::nearest_by_steps(self, t, q, qdot, |qdot| {
                #statements
                let p = ::dalembert::__private::vector([#(#outputs),*]);
                ::core::result::Result::Ok(::dalembert::__private::join(q, &p))
            })
        }
    }
}

/// The parts of a discrete principle, which is not known for such constraints.
pub(super) fn emit_reactions() -> TokenStream {
    quote! {
        fn reaction_force(&self, t: f64, q: &Self::Vector, reactions: &Self::Reactions) -> Self::Vector {
            ::dalembert::System::zero_vector(self)
        }

        fn constrained_velocity(
            &self,
            t: f64,
            q: &Self::Vector,
            p: &Self::Vector,
        ) -> ::core::result::Result<(Self::Vector, Self::Reactions), ::dalembert::Fault> {
            ::core::result::Result::Err(::dalembert::Fault::NonlinearConstraints)
        }
    }
}

/// Impulses, of which none is defined.
pub(super) fn emit_contacts() -> TokenStream {
    quote! {
        fn contact(
            &self,
            surface: usize,
            t: f64,
            state: &Self::State,
        ) -> ::core::result::Result<::dalembert::impacts::law::Contact<Self::Impulse>, ::dalembert::Fault> {
            ::core::result::Result::Err(::dalembert::Fault::NonlinearConstraints)
        }
    }
}
