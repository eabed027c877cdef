//! `Lagrangian`: the parts of Lagrange and d'Alembert's principle.

use proc_macro2::TokenStream;
use quote::{ToTokens, quote};

use super::function::Body;
use super::{Context, doc};
use crate::program::Constrained;

/// `impl Lagrangian`
pub(super) fn emit_lagrangian(context: &Context<'_>) -> TokenStream {
    let type_name = &context.names.type_name;
    let m = context.model.constraints.len();
    if context.is_first_order() {
        return emit_refusal(
            &context.names.type_name,
            &quote!(::dalembert::Fault::FirstOrder),
        );
    }
    if context.is_wrapped() {
        return emit_delegated(context);
    }
    let force = emit_force(context);
    let reactions = match &context.program.constrained {
        Some(_) if context.model.is_nonlinear() => super::nonlinear::emit_reactions(),
        Some(functions) => emit_reactions(context, functions),
        None => emit_no_reactions(),
    };
    let attributes = super::attributes();
    quote! {
        #attributes
        impl ::dalembert::Lagrangian for #type_name {
            type Reactions = ::dalembert::__private::SVector<f64, #m>;
            #force
            #reactions
        }
    }
}

/// The parts do not depend on the form of the state: the model's own.
fn emit_delegated(context: &Context<'_>) -> TokenStream {
    let (type_name, model) = (&context.names.type_name, &context.names.own);
    let attributes = super::attributes();
    quote! {
        #attributes
        impl ::dalembert::Lagrangian for #type_name {
            type Reactions = <#model as ::dalembert::Lagrangian>::Reactions;

            #[inline]
            fn force(&self, t: f64, q: &Self::Vector, qdot: &Self::Vector) -> Self::Vector {
                ::dalembert::Lagrangian::force(&self.0, t, q, qdot)
            }

            #[inline]
            fn reaction_force(&self, t: f64, q: &Self::Vector, reactions: &Self::Reactions) -> Self::Vector {
                ::dalembert::Lagrangian::reaction_force(&self.0, t, q, reactions)
            }

            #[inline]
            fn constrained_velocity(
                &self,
                t: f64,
                q: &Self::Vector,
                p: &Self::Vector,
            ) -> ::core::result::Result<(Self::Vector, Self::Reactions), ::dalembert::Fault> {
                ::dalembert::Lagrangian::constrained_velocity(&self.0, t, q, p)
            }
        }
    }
}

fn emit_force(context: &Context<'_>) -> TokenStream {
    let function = &context.program.force;
    let documentation = doc::formula("dL/dq + F", &function.cost);
    let Body {
        statements,
        outputs,
    } = context.velocity_body(function);
    quote! {
        #documentation
        #[inline]
        fn force(&self, t: f64, q: &Self::Vector, qdot: &Self::Vector) -> Self::Vector {
            #statements
            ::dalembert::__private::vector([#(#outputs),*])
        }
    }
}

fn emit_reactions(context: &Context<'_>, functions: &Constrained) -> TokenStream {
    let n = context.dimension();
    let reaction = context.position_body(&functions.reaction_force);
    let reaction_doc = doc::formula("lambda_a eta^a", &functions.reaction_force.cost);
    let (reaction_statements, covector) = (reaction.statements, reaction.outputs);
    let function = &functions.constrained_velocity;
    let bindings = [
        context.bind_coordinates(function),
        context.bind_momenta(function),
    ];
    let velocity = context.body(quote!(#(#bindings)*), function);
    let velocity_doc = doc::formula(
        "g^-1 (p - A + mu_a eta^a), m mu = -(eta(g^-1 (p - A)) + eta_0)",
        &functions.constrained_velocity.cost,
    );
    let velocity_statements = velocity.statements;
    let (qdot, mu) = velocity.outputs.split_at(n);
    quote! {
        #reaction_doc
        #[inline]
        fn reaction_force(&self, t: f64, q: &Self::Vector, reactions: &Self::Reactions) -> Self::Vector {
            #reaction_statements
            ::dalembert::__private::vector([#(#covector),*])
        }

        #velocity_doc
        #[inline]
        fn constrained_velocity(
            &self,
            t: f64,
            q: &Self::Vector,
            p: &Self::Vector,
        ) -> ::core::result::Result<(Self::Vector, Self::Reactions), ::dalembert::Fault> {
            #velocity_statements
            ::core::result::Result::Ok((
                ::dalembert::__private::vector([#(#qdot),*]),
                ::dalembert::__private::vector([#(#mu),*]),
            ))
        }
    }
}

/// Without constraints every velocity is allowed, and nothing reacts.
fn emit_no_reactions() -> TokenStream {
    quote! {
        #[inline]
        fn reaction_force(&self, t: f64, q: &Self::Vector, reactions: &Self::Reactions) -> Self::Vector {
            ::dalembert::System::zero_vector(self)
        }

        #[inline]
        fn constrained_velocity(
            &self,
            t: f64,
            q: &Self::Vector,
            p: &Self::Vector,
        ) -> ::core::result::Result<(Self::Vector, Self::Reactions), ::dalembert::Fault> {
            let state = <Self as ::dalembert::System>::state_from_momenta(self, t, q, p)?;
            let qdot = <Self as ::dalembert::System>::velocity(self, t, &state)?;
            ::core::result::Result::Ok((qdot, ::dalembert::Lagrangian::zero_reactions(self)))
        }
    }
}

/// `impl Lagrangian` of what has no principle that can be put to work: it answers this fault.
pub(super) fn emit_refusal(type_name: &impl ToTokens, fault: &TokenStream) -> TokenStream {
    let attributes = super::attributes();
    quote! {
        #attributes
        impl ::dalembert::Lagrangian for #type_name {
            type Reactions = ::dalembert::__private::SVector<f64, 0usize>;

            fn force(&self, t: f64, q: &Self::Vector, qdot: &Self::Vector) -> Self::Vector {
                ::dalembert::System::zero_vector(self)
            }

            fn reaction_force(&self, t: f64, q: &Self::Vector, reactions: &Self::Reactions) -> Self::Vector {
                ::dalembert::System::zero_vector(self)
            }

            fn constrained_velocity(
                &self,
                t: f64,
                q: &Self::Vector,
                p: &Self::Vector,
            ) -> ::core::result::Result<(Self::Vector, Self::Reactions), ::dalembert::Fault> {
                ::core::result::Result::Err(#fault)
            }
        }
    }
}
