//! The types: the struct of the parameters and the start mode, and the module of indices and modes.

use proc_macro2::{Ident, Span, TokenStream};
use quote::quote;

use super::Whole;
use crate::indices::emit_entries;
use crate::{doc, parameters, scene};
use dalembert_codegen::model;

/// The struct, and its `Default` if every parameter has a default.
pub(super) fn emit_struct(whole: &Whole<'_>) -> TokenStream {
    let model = whole.model();
    let type_name = whole.type_name();
    let module = Ident::new(&model.snake_name, Span::call_site());
    let visibility: TokenStream = model.visibility.parse().unwrap_or_default();
    let documentation = doc::lines(&documentation(whole));
    let fields = parameters::emit_fields(model);
    let first = first_mode(whole);
    let default = parameters::have_defaults(model).then(|| {
        let values = parameters::default_fields(model);
        let (attributes, allowances) = (crate::attributes(), crate::allowances());
        quote! {
            #attributes
        #allowances
            impl ::core::default::Default for #type_name {
                /// The declared defaults; runs begin in the first mode.
                fn default() -> Self { Self { #values mode: #first } }
            }
        }
    });
    quote! {
        #documentation
        #[allow(non_snake_case, clippy::all, clippy::pedantic, clippy::nursery)]
        #[derive(Debug, Clone, Copy, PartialEq)]
        #visibility struct #type_name {
            #fields
            /// The mode in which a run begins. States made of positions and velocities are states of this mode.
            pub mode: #module::Mode,
        }
        #default
    }
}

/// The first mode, as a value.
pub(super) fn first_mode(whole: &Whole<'_>) -> TokenStream {
    let module = Ident::new(&whole.model().snake_name, Span::call_site());
    let first = Ident::new(&whole.graph.modes[0].scene.type_name, Span::call_site());
    quote!(#module::Mode::#first)
}

fn documentation(whole: &Whole<'_>) -> Vec<String> {
    let mut lines = whole.model().documentation.clone();
    lines.push(String::new());
    lines.push(" The modes, each with the components of its state in order. A state of the model consists of the state of the \
                current mode, zeros as padding, and the number of the mode:".to_owned());
    lines.push(String::new());
    for (mode, context) in whole.graph.modes.iter().zip(whole.mode_contexts()) {
        lines.push(format!(
            " * `{}`: `{}`",
            mode.scene.name,
            doc::state_order(context)
        ));
    }
    lines
}

/// The module of indices, with the type of each mode and a module of its own indices.
pub(super) fn emit_module(whole: &Whole<'_>) -> TokenStream {
    let (graph, model) = (whole.graph, whole.model());
    let visibility: TokenStream = match model.visibility.as_str() {
        "" => quote!(pub(crate)),
        written => written.parse().unwrap_or_default(),
    };
    let module = Ident::new(&model.snake_name, Span::call_site());
    let title = format!(
        " Indices of the names declared in [`{}`], and its modes.",
        model.name
    );
    let lists = [
        ("coordinate", "coordinates of all modes", &graph.coordinates),
        ("constraint", "constraints of all modes", &graph.constraints),
        (
            "surface",
            "surfaces and transitions of all modes",
            &graph.surfaces,
        ),
        ("output", "outputs of all modes", &graph.outputs),
    ];
    let lists = lists.map(|(name, plural, list)| {
        emit_entries(
            name,
            plural,
            list.iter()
                .map(|entry| (&entry.name, entry.documentation.as_slice())),
        )
    });
    let variants = emit_variants(whole);
    let modes = graph.modes.iter().zip(&whole.contexts);
    let modes = modes.map(|(mode, contexts)| emit_mode(whole, mode, &contexts[0]));
    quote! {
        #[doc = #title]
        #[allow(dead_code, non_upper_case_globals)]
        #visibility mod #module { #variants #(#lists)* #(#modes)* }
    }
}

/// `pub enum Mode { .. }`
fn emit_variants(whole: &Whole<'_>) -> TokenStream {
    let variants = whole.graph.modes.iter().map(|mode| {
        let name = Ident::new(&mode.scene.type_name, Span::call_site());
        let mut lines = mode.scene.documentation.clone();
        if lines.is_empty() {
            lines.push(format!(" `{}`", mode.scene.name));
        }
        let documentation = doc::lines(&lines);
        quote!(#documentation #name)
    });
    quote! {
        /// The modes, in order of declaration; `as usize` is the number of each.
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        pub enum Mode { #(#variants),* }
    }
}

/// `pub struct Rough(pub super::Ball);` and the module of its indices.
fn emit_mode(whole: &Whole<'_>, mode: &model::Mode, context: &crate::Context<'_>) -> TokenStream {
    let holder = whole.type_name();
    let model = &mode.model;
    let type_name = Ident::new(&mode.scene.type_name, Span::call_site());
    let module = Ident::new(&mode.scene.name, Span::call_site());
    let title = format!(
        " The mode `{}` of [`{holder}`](super::{holder}) by itself: a run of it ends where the mode is left.",
        mode.scene.name
    );
    let mut lines = mode.scene.documentation.clone();
    lines.extend([String::new(), title, String::new()]);
    lines.push(format!(" State: `{}`.", doc::state_order(context)));
    for note in &context.form.model.notes {
        lines.extend([String::new(), format!(" Note: {note}")]);
    }
    let documentation = doc::lines(&lines);
    let visibility = inner_visibility(&whole.model().visibility);
    let global = parameters::emit_global(context, &mode.scene.type_name, "mode", &visibility);
    let lists = crate::indices::emit_lists(model);
    let title = format!(
        " Indices of the names of the mode `{}`, in its own order.",
        mode.scene.name
    );
    let default = scene::emit_default(whole.model(), &holder, &type_name, "mode");
    quote! {
        #documentation
        #[allow(private_interfaces)]
        #[derive(Debug, Clone, Copy, PartialEq)]
        #visibility struct #type_name(
            /// The model with its parameters.
            pub super::#holder,
        );
        #default
        #global
        #[doc = #title]
        pub mod #module { #lists }
    }
}

/// The visibility of the model, written for the module of indices beside it. The interface of a mode names the model,
/// so a mode cannot be more visible.
fn inner_visibility(written: &str) -> TokenStream {
    let compact = written.replace(' ', "");
    match compact.as_str() {
        "" | "pub(self)" | "pub(inself)" => quote!(pub(super)),
        "pub(super)" => quote!(pub(in super::super)),
        // One level deeper, the path to an ancestor has one `super` more.
        path if path.starts_with("pub(insuper") => path
            .replacen("pub(in", "pub(in super::", 1)
            .parse()
            .unwrap_or_default(),
        _ => written.parse().unwrap_or_default(),
    }
}
