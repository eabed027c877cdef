//! `Described`, `Instance` and `Scene` of the whole.

use proc_macro2::{Ident, Span, TokenStream};
use quote::quote;

use super::{Whole, types};
use crate::emit::describe as one;
use crate::emit::{attributes, doc, parameters};
use crate::spec::WHOLE;

/// `impl Described`, `impl Instance`
pub(super) fn emit_described(whole: &Whole<'_>) -> TokenStream {
    let own = whole.type_name();
    let attributes = attributes();
    let description = emit_description(whole);
    let first = types::first_mode(whole);
    let defaults = parameters::default_fields(whole.model());
    let instance = emit_instance(whole);
    quote! {
        #attributes
        impl ::dalembert::Described for #own {
            const DESCRIPTION: ::dalembert::describe::Description = #description;

            fn with_defaults() -> Self { Self { #defaults mode: #first } }
        }

        #instance
    }
}

/// `impl Instance`, where the mode answers.
fn emit_instance(whole: &Whole<'_>) -> TokenStream {
    let own = whole.type_name();
    let attributes = attributes();
    let places = crate::emit::names::places(whole.model(), &quote!(self));
    let access = one::emit_access(&places);
    let variants = emit_choice(whole);
    let ask = |function: TokenStream, arguments: TokenStream| {
        whole.of_state(
            |_, mode| quote!(::dalembert::__private::modes::#function::<#mode>(self, #arguments)),
        )
    };
    let initial =
        whole.of_start(|_, mode| quote!(::dalembert::__private::modes::initial::<#mode, _>(self)));
    let outputs = whole.of_state(|mode, own| {
        let count = mode.model.outputs.len();
        quote!(::dalembert::__private::modes::outputs::<#own>(self, t, state, values, &mut [0.0; #count]))
    });
    let path = ask(quote!(view_path), quote!(t, state));
    let region = whole.of_start(
        |_, mode| quote!(::dalembert::__private::modes::view_region::<#mode, _>(self, t, q)),
    );
    let inspect = ask(quote!(inspect), quote!(t, state, report));
    quote! {
        #attributes
        impl ::dalembert::describe::Instance for #own {
            type Global = Self;

            #[inline]
            fn description(&self) -> &'static ::dalembert::describe::Description {
                &<Self as ::dalembert::Described>::DESCRIPTION
            }

            #[inline]
            fn global(&self) -> Self { *self }

            #access

            fn set_mode(&mut self, mode: usize) {
                #variants
            }

            fn initial(&self) -> ::dalembert::describe::Initial<Self::Vector> { #initial }

            fn outputs(
                &self,
                t: f64,
                state: &Self::State,
                values: &mut [f64],
            ) -> ::core::result::Result<(), ::dalembert::Fault> {
                #outputs
            }

            fn view_path(&self, t: f64, state: &Self::State) -> ::core::option::Option<[f64; 2]> { #path }

            fn view_region(&self, t: f64, q: &Self::Vector) -> ::core::option::Option<f64> { #region }

            fn inspect(
                &self,
                t: f64,
                state: &Self::State,
                report: &mut dyn ::dalembert::describe::Report,
            ) -> ::core::result::Result<(), ::dalembert::Fault> {
                #inspect
            }

            fn visit_variational<Visitor: ::dalembert::describe::VariationalVisitor>(
                &self,
                visitor: Visitor,
            ) -> ::core::option::Option<Visitor::Output> {
                ::core::option::Option::Some(visitor.visit(self))
            }

        }
    }
}

/// Chooses the mode of a number; one past the end changes nothing.
fn emit_choice(whole: &Whole<'_>) -> TokenStream {
    let module = Ident::new(&whole.model().snake_name, Span::call_site());
    let arms = whole.graph.modes.iter().enumerate().map(|(index, mode)| {
        let variant = Ident::new(&mode.scene.type_name, Span::call_site());
        quote!(#index => self.mode = #module::Mode::#variant,)
    });
    quote!(match mode { #(#arms)* _ => {} })
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
    let parameters = one::emit_parameter_infos(model);
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
            parameters: &[#parameters],
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

/// `impl Scene`: impacts and transitions of the whole, and in each mode what belongs to it.
pub(super) fn emit_scene(whole: &Whole<'_>) -> TokenStream {
    let own = whole.type_name();
    let attributes = attributes();
    let within = whole
        .own()
        .filter(|context| one::drifts(context))
        .map(|context| {
            let mode = &context.names.type_name;
            let projection = quote!(::dalembert::Projection<#mode>);
            (
                quote!(::dalembert::__private::modes::Within<#mode, #projection>),
                quote!(::dalembert::__private::modes::Within::new(
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
    // Where a mode is entered, what belongs to it begins after the transition.
    let all: Vec<_> = impacts.into_iter().chain(within).collect();
    let nested = all.into_iter().rev().fold(
        (quote!(()), quote!(())),
        |(types, values), (own_type, own_value)| {
            (quote!((#own_type, #types)), quote!((#own_value, #values)))
        },
    );
    let (effects, values) = nested;
    quote! {
        #attributes
        impl ::dalembert::Scene for #own {
            type Effects = #effects;

            fn effects(&self) -> Self::Effects { #values }
        }
    }
}
