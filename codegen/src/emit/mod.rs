//! Stage 5, emit: the program as Rust. One file per emitted item; no decision of mathematics is taken here.
//!
//! Generated code names only public items of `::dalembert`, `::dalembert::__private` and `::core`.

mod constraint;
mod describe;
mod doc;
mod field;
mod function;
mod impact;
mod indices;
mod jet;
mod names;
mod parameters;
mod volume;

use proc_macro2::TokenStream;
use quote::quote;

use crate::model::Model;
use crate::program::Program;
use names::Names;

/// What every emitter reads.
struct Context<'a> {
    model: &'a Model,
    program: &'a Program,
    names: Names,
}

/// The generated items of a model.
pub fn tokens(model: &Model, program: &Program) -> TokenStream {
    let context = Context {
        model,
        program,
        names: Names::of(model),
    };
    let items = [
        parameters::emit_parameters(&context),
        indices::emit_indices(&context),
        field::emit_field(&context),
        field::emit_system(&context),
        jet::emit_taylor(&context),
        constraint::emit_constrained(&context),
        impact::emit_impacting(&context),
        volume::emit_divergence(&context),
        volume::emit_invariant_volume(&context),
        describe::emit_described(&context),
        describe::emit_scene(&context),
    ];
    quote!(#(#items)*)
}

/// What every generated item says of itself: it was not written by hand, so lints on style have nothing to say,
/// and a function need not use all that the contract hands it.
fn attributes() -> TokenStream {
    quote! {
        #[automatically_derived]
        #[allow(non_snake_case, unused_variables, clippy::all, clippy::pedantic, clippy::nursery)]
    }
}
