//! `Documented` and `Scene` of the whole.

use proc_macro2::TokenStream;
use quote::quote;

use super::{Whole, types, whole};
use crate::emit::describe as one;
use crate::emit::{attributes, doc, parameters};
use crate::spec::WHOLE;

/// `impl Documented`, and `impl Emitted` with all that is constant of the whole.
pub(super) fn emit_documented(whole: &Whole<'_>) -> TokenStream {
    let own = whole.type_name();
    let attributes = attributes();
    let description = emit_description(whole);
    let first = types::first_mode(whole);
    let defaults = parameters::default_fields(whole.model());
    let places = crate::emit::names::places(whole.model(), &quote!(self));
    let set = one::emit_set(&places);
    let (choice, inspection) = (whole::emit_choice(whole), whole::emit_inspection(whole));
    let (tables, forms) = (whole::emit_tables(whole), whole::emit_forms(whole));
    quote! {
        #attributes
        impl ::dalembert::kernels::Documented for #own {
            type Geometry = [f64; 0];
            type Global = Self;

            #[inline]
            fn documentation(&self) -> &'static ::dalembert::kernels::Documentation {
                &<Self as ::dalembert::declaration::Emitted>::DOCUMENTATION
            }

            #[inline]
            fn globally(&self) -> Self { *self }

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
        impl ::dalembert::declaration::Emitted for #own {
            const TABLES: ::dalembert::kernels::Tables = #tables;
            const DOCUMENTATION: ::dalembert::kernels::Documentation = ::dalembert::kernels::Documentation {
                description: #description,
                inputs: &[],
                placed: &[],
                named: &[],
                geometry: &[],
            };
            const FORMS: &'static [&'static ::dalembert::erased::Form] = #forms;

            fn declared() -> Self { Self { #defaults mode: #first } }
        }
    }
}

fn emit_description(whole: &Whole<'_>) -> TokenStream {
    let (graph, model) = (whole.graph, whole.model());
    let contexts: Vec<_> = whole.own().collect();
    let (type_name, name) = (&model.name, &model.snake_name);
    let documentation = doc::text(&model.documentation);
    let source = &model.source;
    let is_first_order = graph.is_first_order();
    let coordinates = graph.coordinates.iter().map(|entry| {
        let own = &graph.modes[entry.mode].model;
        one::emit_coordinate_info(own, &own.coordinates[entry.place])
    });
    let constraints = graph.constraints.iter().map(|entry| {
        let own = &graph.modes[entry.mode].model;
        one::emit_constraint_info(own, &own.constraints[entry.place], None)
    });
    let forces = graph.forces.iter().map(|entry| &entry.name.display);
    let surfaces = graph
        .surfaces
        .iter()
        .map(|entry| one::emit_surface_info(&graph.modes[entry.mode].model, entry.place));
    let outputs = graph.outputs.iter().map(|entry| &entry.name.display);
    let view = one::emit_view_info(contexts[0].model, &graph.modes[0].places.coordinates);
    let scenes = graph.modes.iter().map(|mode| mode.scene.name.as_str());
    let scenes = [WHOLE].into_iter().chain(scenes);
    let modes = graph.modes.iter().map(|mode| {
        let name = &mode.scene.name;
        let coordinates = &mode.places.coordinates;
        quote!(::dalembert::describe::ModeInfo { name: #name, coordinates: &[#(#coordinates),*] })
    });
    quote! {
        ::dalembert::describe::Description {
            type_name: #type_name,
            name: #name,
            documentation: #documentation,
            source: #source,
            is_first_order: #is_first_order,
            coordinates: &[#(#coordinates)*],
            parameters: <Self as ::dalembert::declaration::Emitted>::TABLES.parameters,
            constraints: &[#(#constraints)*],
            forces: &[#(#forces),*],
            quasi_velocities: &[],
            surfaces: &[#(#surfaces)*],
            outputs: &[#(#outputs),*],
            scenes: &[#(#scenes),*],
            modes: &[#(#modes),*],
            view: #view,
        }
    }
}

/// `impl Scene`: impacts and transitions of the whole, and projection in the modes that need it.
pub(super) fn emit_scene(whole: &Whole<'_>) -> TokenStream {
    let own = whole.type_name();
    let attributes = attributes();
    let drifts = whole.own().any(one::drifts);
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
    // Where a mode is entered, projection begins after the transition.
    let (effects, values): (Vec<_>, Vec<_>) = impacts.into_iter().chain(projection).unzip();
    quote! {
        #attributes
        impl ::dalembert::Scene for #own {
            type Effects = (#(#effects,)*);

            fn effects(&self) -> Self::Effects { (#(#values,)*) }
        }
    }
}
