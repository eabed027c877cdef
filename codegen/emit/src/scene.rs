//! Scenes: one type per scene, in the module of indices. The type wraps the model with its parameters.

use proc_macro2::{Ident, Span, TokenStream};
use quote::quote;

use super::{Context, doc, indices, parameters};
use dalembert_codegen::model::{Model, Scene};

/// The types of all scenes with their additional items. `contexts` has the contexts of the scenes, in order.
pub(super) fn emit_types(model: &Model, contexts: &[Vec<Context<'_>>]) -> Vec<TokenStream> {
    let scenes = model.scenes.iter().zip(contexts);
    scenes
        .map(|(scene, contexts)| emit_type(model, scene, &contexts[0]))
        .collect()
}

/// `pub struct Billiard(pub super::RollingDisk);`, the type of its global form, and the indices of its surfaces.
fn emit_type(model: &Model, scene: &Scene, context: &Context<'_>) -> TokenStream {
    let holder = Ident::new(&model.name, Span::call_site());
    let type_name = Ident::new(&scene.type_name, Span::call_site());
    let module = Ident::new(&scene.name, Span::call_site());
    let used = model.used(&scene.parts);
    let mut lines = parameters::documentation(context);
    lines.insert(
        scene.documentation.len(),
        format!(
            " The scene `{}` of [`{holder}`](super::{holder}): {used}.",
            scene.name
        ),
    );
    lines.insert(scene.documentation.len(), String::new());
    let documentation = doc::lines(&lines);
    let global = parameters::emit_global(context, &scene.type_name, "scene", &quote!(pub));
    let indices = (!context.form.model.surfaces.is_empty()).then(|| {
        let surfaces = indices::emit_surfaces(&context.form.model.surfaces);
        let title = format!(" Indices of the surfaces of the scene `{}`.", scene.name);
        quote! {
            #[doc = #title]
            pub mod #module { #surfaces }
        }
    });
    let default = emit_default(model, &holder, &type_name, "scene");
    quote! {
        #documentation
        #[allow(private_interfaces)]
        #[derive(Debug, Clone, Copy, PartialEq)]
        pub struct #type_name(
            /// The model with its parameters.
            pub super::#holder,
        );
        #default
        #global
        #indices
    }
}

/// `Default` of a type that wraps the model, if every parameter has a default.
pub(super) fn emit_default(
    model: &Model,
    holder: &Ident,
    type_name: &Ident,
    noun: &str,
) -> TokenStream {
    if !parameters::have_defaults(model) {
        return TokenStream::new();
    }
    let documentation = format!(" The {noun} with the declared defaults.");
    quote! {
        impl ::core::default::Default for #type_name {
            #[doc = #documentation]
            fn default() -> Self { Self(<super::#holder as ::core::default::Default>::default()) }
        }
    }
}

/// `show_scenes` for the type of the model.
pub(super) fn emit_visit(context: &Context<'_>) -> TokenStream {
    if context.form.scenes.is_empty() || context.names.held.is_some() {
        return TokenStream::new();
    }
    let module = Ident::new(&context.form.model.snake_name, Span::call_site());
    let visits = context.form.scenes.iter().map(|scene| {
        let type_name = Ident::new(&scene.type_name, Span::call_site());
        let name = &scene.name;
        quote!(visitor.visit::<#module::#type_name>(#name);)
    });
    quote! {
        fn show_scenes<Visitor: ::dalembert::declaration::SceneVisitor>(visitor: &mut Visitor) {
            #(#visits)*
        }
    }
}
