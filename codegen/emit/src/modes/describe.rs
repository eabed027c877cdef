//! `Documented` and `Scene` of a model with modes, as a whole.

use proc_macro2::TokenStream;
use quote::quote;

use super::{Whole, types, whole};
use crate::describe as one;
use crate::{attributes, parameters};

/// `impl Documented`, and `impl Emitted` with the constants of the whole.
pub(super) fn emit_documented(whole: &Whole<'_>) -> TokenStream {
    let type_name = whole.type_name();
    let attributes = attributes();
    let documentation = one::with_shared_parameters(&whole.known.documentation());
    let first = types::first_mode(whole);
    let defaults = parameters::default_fields(whole.model());
    let places = crate::names::places(whole.model(), &quote!(self));
    let set = one::emit_set(&places);
    let (choice, inspection) = (whole::emit_choice(whole), whole::emit_inspection(whole));
    let (tables, forms) = (whole::emit_tables(whole), whole::emit_forms(whole));
    quote! {
        #attributes
        impl ::dalembert::kernels::Documented for #type_name {
            type Geometry = [f64; 0];
            type Global = Self;

            #[inline]
            fn documentation(&self) -> &'static ::dalembert::kernels::Documentation {
                <Self as ::dalembert::declaration::Emitted>::DOCUMENTATION
            }

            #[inline]
            fn globally(&self) -> ::core::option::Option<Self> { ::core::option::Option::Some(*self) }

            fn set_argument(&mut self, index: usize, value: f64) { #set }

            fn set_start(&mut self, mode: usize) { #choice }

            #inspection

            fn show_variational<Visitor: ::dalembert::describe::VariationalVisitor>(
                &self,
                visitor: Visitor,
            ) -> ::core::option::Option<Visitor::Output> {
                ::core::option::Option::Some(visitor.visit(self))
            }
        }

        #attributes
        impl ::dalembert::declaration::Emitted for #type_name {
            const TABLES: &'static ::dalembert::kernels::Tables = #tables;
            const DOCUMENTATION: &'static ::dalembert::kernels::Documentation = #documentation;
            const FORMS: &'static [::dalembert::erased::Shared<::dalembert::erased::Form>] = #forms;

            fn declared() -> Self { Self { #defaults mode: #first } }
        }
    }
}

/// `impl Scene`: impacts and transitions of the whole, and projection in the modes that need it.
pub(super) fn emit_scene(whole: &Whole<'_>) -> TokenStream {
    let type_name = whole.type_name();
    let attributes = attributes();
    let drifts = whole.known.tables().drifts;
    let projection = drifts.then(|| {
        (
            quote!(::dalembert::__private::modes::InMode<::dalembert::Projection<Self>>),
            quote!(::dalembert::__private::modes::InMode::new(
                ::dalembert::Projection::new()
            )),
        )
    });
    let impacts = (!whole.graph.surfaces.is_empty()).then(|| {
        (
            quote!(::dalembert::Impacts<Self>),
            quote!(::dalembert::Impacts::declared(self)),
        )
    });
    // Impacts come first, so that projection in a mode that is entered begins after the transition.
    let (effects, values): (Vec<_>, Vec<_>) = impacts.into_iter().chain(projection).unzip();
    quote! {
        #attributes
        impl ::dalembert::Scene for #type_name {
            type Effects = (#(#effects,)*);

            fn effects(&self) -> Self::Effects { (#(#values,)*) }
        }
    }
}
