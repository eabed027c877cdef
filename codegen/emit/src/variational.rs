//! Items of a form that variations need besides its kernels.

use proc_macro2::TokenStream;
use quote::quote;

use super::Context;
use dalembert_codegen::program::Form;

/// Items that variations need, if the form supports variations. The global form of a reduced model does not.
pub(super) fn emit_variations(context: &Context<'_>) -> TokenStream {
    if !context.form.varies() {
        return TokenStream::new();
    }
    let type_name = &context.names.type_name;
    let (n, k) = (context.form.dimension(), context.form.motion_dimension());
    let (surfaces, collision) = (context.form.model.surfaces.len(), 5 + k);
    let off = off_constraints(context) + context.form.levels();
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

/// `show_variational`, if the form supports variations.
pub(super) fn emit_visit(context: &Context<'_>) -> TokenStream {
    if !context.form.varies() {
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

/// Number of constraints that a state may violate.
fn off_constraints(context: &Context<'_>) -> usize {
    match (context.form.program.form, &context.form.program.constrained) {
        (Form::Global, Some(_)) => context.form.model.constraints.len(),
        _ => 0,
    }
}
