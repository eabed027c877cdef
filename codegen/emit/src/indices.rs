//! A module with the indices of the declared names: `rolling_disk::surface::leading_edge`.

use proc_macro2::{Ident, Span, TokenStream};
use quote::quote;

use super::{Context, doc, scene};
use dalembert_codegen::model::{Model, Name, Surface};

/// A declared name with its doc comment.
pub(super) type Entry<'a> = (&'a Name, &'a [String]);

/// The module of indices: a submodule for each kind of declared name, and the types of the scenes.
pub(super) fn emit_indices(context: &Context<'_>, scenes: &[Vec<Context<'_>>]) -> TokenStream {
    let model = context.form.model;
    let lists = emit_lists(model);
    let visibility: TokenStream = match model.visibility.as_str() {
        "" => quote!(pub(crate)),
        written => written.parse().unwrap_or_default(),
    };
    let module = Ident::new(&model.snake_name, Span::call_site());
    let title = format!(" Indices of the names declared in [`{}`].", model.name);
    let scenes = scene::emit_types(model, scenes);
    quote! {
        #[doc = #title]
        #[allow(dead_code, non_upper_case_globals)]
        #visibility mod #module { #lists #(#scenes)* }
    }
}

/// A module for each kind of names that a model declares.
pub(super) fn emit_lists(model: &Model) -> TokenStream {
    let coordinates = model.coordinates.iter();
    let constraints = model.constraints.iter();
    let quasi = model
        .frame
        .iter()
        .map(|item| (&item.name, item.documentation.as_slice()));
    let outputs = model.outputs.iter();
    let parts = [
        emit_entries(
            "coordinate",
            "coordinates",
            coordinates.map(|item| (&item.name, item.documentation.as_slice())),
        ),
        emit_entries(
            "constraint",
            "constraints",
            constraints.map(|item| (&item.name, item.documentation.as_slice())),
        ),
        emit_entries(
            "quasi_velocity",
            "quasi-velocities (component `n + index` of a state with `n` coordinates)",
            quasi,
        ),
        emit_surfaces(&model.surfaces),
        emit_entries(
            "output",
            "outputs",
            outputs.map(|item| (&item.name, item.documentation.as_slice())),
        ),
    ];
    quote!(#(#parts)*)
}

/// The module of the indices of impact surfaces.
pub(super) fn emit_surfaces(surfaces: &[Surface]) -> TokenStream {
    let surfaces = surfaces.iter();
    emit_entries(
        "surface",
        "impact surfaces",
        surfaces.map(|item| (&item.name, item.documentation.as_slice())),
    )
}

/// A module with the index of each entry; nothing without entries.
pub(super) fn emit_entries<'a>(
    module: &str,
    plural: &str,
    entries: impl Iterator<Item = Entry<'a>>,
) -> TokenStream {
    let entries: Vec<Entry<'a>> = entries.collect();
    if entries.is_empty() {
        return TokenStream::new();
    }
    let module = Ident::new(module, Span::call_site());
    let title = format!(" Indices of the {plural}, in order of declaration.");
    let is_first = |index: &usize| {
        let same = |(name, _): &Entry<'_>| name.field == entries[*index].0.field;
        !entries[..*index].iter().any(same)
    };
    let constants = (0..entries.len())
        .filter(is_first)
        .map(|first| emit_constant(first, &entries));
    quote!(#[doc = #title] pub mod #module { #(#constants)* })
}

/// The index of a name, or the indices of a family in the order of its members. Members may be declared in any order.
fn emit_constant(first: usize, entries: &[Entry<'_>]) -> TokenStream {
    let (name, _) = entries[first];
    let constant = Ident::new(&name.field, Span::call_site());
    let mut indices: Vec<usize> = (first..entries.len())
        .filter(|index| entries[*index].0.field == name.field)
        .collect();
    indices.sort_by_key(|index| entries[*index].0.member);
    let documentation = documentation(&indices, entries);
    let count = indices.len();
    match name.member {
        Some(_) => {
            quote!(#documentation pub const #constant: [usize; #count] = [#(#indices),*];)
        }
        None => quote!(#documentation pub const #constant: usize = #(#indices)*;),
    }
}

/// Documentation of the members, each text once; the name if there is none.
fn documentation(indices: &[usize], entries: &[Entry<'_>]) -> TokenStream {
    let mut texts: Vec<&[String]> = Vec::new();
    for index in indices {
        let (_, text) = entries[*index];
        if !text.is_empty() && !texts.contains(&text) {
            texts.push(text);
        }
    }
    match indices.first() {
        Some(first) if texts.is_empty() => doc::lines(&[format!("`{}`", entries[*first].0.field)]),
        _ => doc::lines(&texts.join(&String::new())),
    }
}
