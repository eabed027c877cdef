//! What variations take of a form besides its kernels, where they are asked for.

use proc_macro2::TokenStream;
use quote::quote;

use super::Context;
use crate::program::Form;

/// What variations take of a form, where they are asked for. A type that holds a reduced model in its global form has none.
pub(super) fn emit_variations(context: &Context<'_>) -> TokenStream {
    if !is_variational(context) {
        return TokenStream::new();
    }
    let type_name = &context.names.type_name;
    let (n, k) = (context.dimension(), context.motion_dimension());
    let (surfaces, collision) = (context.model.surfaces.len(), 5 + k);
    let off = off_constraints(context) + levels(context);
    let state = n + k;
    let attributes = super::attributes();
    let numbers = quote!(L: ::dalembert::numbers::Numbers);
    quote! {
        #attributes
        impl ::dalembert::kernels::HasVariations for #type_name {
            type Clearances<#numbers> = [L; #surfaces];
            type Collision<#numbers> = [L; #collision];
            type Deviations<#numbers> = [L; #off];
            type Columns = [::dalembert::__private::SVector<f64, #state>; #state];
            type Tangents = [::dalembert::Tangent<Self>; #state];

            fn columns() -> Self::Columns {
                [::dalembert::StateVector::zeros(#state); #state]
            }

            fn tangents() -> Self::Tangents { [::dalembert::Tangent::zero(); #state] }
        }
    }
}

/// `show_variational`, of what is.
pub(super) fn emit_visit(context: &Context<'_>) -> TokenStream {
    if !is_variational(context) {
        return TokenStream::new();
    }
    quote! {
        fn show_variational<Visitor: ::dalembert::describe::VariationalVisitor>(
            &self,
            visitor: Visitor,
        ) -> ::core::option::Option<Visitor::Output> {
            ::core::option::Option::Some(visitor.visit(self))
        }
    }
}

/// True if runs of the form can be varied.
pub(super) fn is_variational(context: &Context<'_>) -> bool {
    context.model.extras.variations && !context.is_wrapped()
}

/// Constraints that a state may be off.
fn off_constraints(context: &Context<'_>) -> usize {
    match (context.program.form, &context.program.constrained) {
        (Form::Global, Some(_)) => context.model.constraints.len(),
        _ => 0,
    }
}

/// Constraints with a position level.
fn levels(context: &Context<'_>) -> usize {
    let functions = context.program.constrained.as_ref();
    functions.map_or(0, |functions| functions.levels.outputs.len())
}
