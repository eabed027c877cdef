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
mod lagrangian;
mod names;
mod parameters;
mod reduced;
mod volume;

use proc_macro2::TokenStream;
use quote::quote;

use crate::mechanics::{Derivation, Frame};
use crate::model::Model;
use crate::program::{Form, Lowered, Program};
use names::Names;

/// What every emitter reads.
struct Context<'a> {
    model: &'a Model,
    frame: Option<&'a Frame>,
    program: &'a Program,
    names: Names,
}

impl Context<'_> {
    /// Whether the type holds the model, whose parameters it has.
    fn is_wrapped(&self) -> bool {
        self.frame.is_some() && self.program.form == Form::Global
    }
}

/// The generated items of a model: those of its type, and where that one is reduced to D, those of the type of its
/// global form.
pub fn tokens(model: &Model, derivation: &Derivation, programs: &Lowered) -> TokenStream {
    let frame = derivation.frame.as_ref().ok();
    let names = Names::of(model, frame);
    let global = programs.global.as_ref().map(|program| Context {
        model,
        frame,
        program,
        names: names.of_global(model),
    });
    let context = Context {
        model,
        frame,
        program: &programs.main,
        names,
    };
    let own = [
        parameters::emit_parameters(&context),
        indices::emit_indices(&context),
    ];
    let shadows = names::emit_shadows(model);
    let contexts = [Some(context), global].into_iter().flatten();
    let items = contexts.flat_map(|context| implementations(&context));
    quote! {
        #(#own)*
        const _: () = {
            #shadows
            #(#items)*
        };
    }
}

/// What is implemented for a type of the model.
fn implementations(context: &Context<'_>) -> [TokenStream; 10] {
    [
        field::emit_field(context),
        field::emit_system(context),
        jet::emit_taylor(context),
        constraint::emit_constrained(context),
        lagrangian::emit_lagrangian(context),
        impact::emit_impacting(context),
        volume::emit_divergence(context),
        volume::emit_invariant_volume(context),
        describe::emit_described(context),
        describe::emit_scene(context),
    ]
}

/// What every generated item says of itself: it was not written by hand, so lints on style have nothing to say,
/// and a function need not use all that the contract hands it.
fn attributes() -> TokenStream {
    quote! {
        #[automatically_derived]
        #[allow(non_snake_case, unused_variables, clippy::all, clippy::pedantic, clippy::nursery)]
    }
}
