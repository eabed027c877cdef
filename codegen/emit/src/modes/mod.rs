//! Code of a model with modes: a type for each mode, as for scenes, and a type for the whole, which calls the kernels
//! of the current mode.

mod describe;
mod types;
mod whole;

use proc_macro2::{Ident, Span, TokenStream};
use quote::quote;

use super::kernels::Written;
use super::{Context, allowances, contexts_of_scene, forms, names};
use dalembert_codegen::CompiledModes;
use dalembert_codegen::model::{ModeGraph, Model};
use dalembert_codegen::tables;

/// Input of every emitter of the whole.
struct Whole<'a> {
    graph: &'a ModeGraph,
    /// The tables of the whole.
    known: tables::Whole<'a>,
    /// Contexts of each mode: that of its own form, then that of the global form where the two differ.
    contexts: Vec<Vec<Context<'a>>>,
}

/// The generated items of a model with modes.
pub fn tokens(compiled: &CompiledModes) -> TokenStream {
    let CompiledModes { graph, modes } = compiled;
    let model = &graph.modes[0].model;
    let contexts = graph
        .modes
        .iter()
        .zip(modes)
        .map(|(mode, compiled)| contexts_of_scene(model, &mode.scene, compiled));
    let contexts: Vec<Vec<Context<'_>>> = contexts.collect();
    let whole = Whole {
        graph,
        known: tables::Whole {
            graph,
            forms: contexts.iter().map(|contexts| forms_of(contexts)).collect(),
        },
        contexts,
    };
    let declarations = [types::emit_struct(&whole), types::emit_module(&whole)];
    let shadows = names::emit_shadows(graph.modes.iter().map(|mode| &mode.model));
    let allowances = allowances();
    let mut written = Written::default();
    let of_modes = whole.contexts.iter();
    let of_modes = of_modes.map(|contexts| forms(contexts, &[], &mut written));
    let of_modes: Vec<TokenStream> = of_modes.collect();
    let of_whole = [
        whole::emit_conversions(&whole),
        whole::emit_actuated(&whole),
        whole::emit_declared(&whole),
        whole::emit_taylor(&whole),
        whole::emit_variations(&whole),
        describe::emit_documented(&whole),
        describe::emit_scene(&whole),
    ];
    quote! {
        #(#declarations)*
        #allowances
        const _: () = {
            #shadows
            #(#of_modes)*
            #(#of_whole)*
        };
    }
}

fn forms_of<'a>(contexts: &[Context<'a>]) -> Vec<tables::FormOf<'a>> {
    contexts.iter().map(|context| context.form).collect()
}

impl Whole<'_> {
    /// The model of the first mode. Names and parameters of the whole are those of this model.
    fn model(&self) -> &Model {
        &self.graph.modes[0].model
    }

    /// The type of the whole.
    fn type_name(&self) -> Ident {
        Ident::new(&self.model().name, Span::call_site())
    }

    /// The types of the modes, in order.
    fn types(&self) -> Vec<&TokenStream> {
        self.mode_contexts()
            .map(|context| &context.names.type_name)
            .collect()
    }

    /// The contexts of the modes' own forms, in order.
    fn mode_contexts(&self) -> impl Iterator<Item = &Context<'_>> {
        self.contexts.iter().map(|contexts| &contexts[0])
    }
}
