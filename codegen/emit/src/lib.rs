//! The last stage, emit: writes the programs of a model as Rust code. There is one file per emitted item. Earlier
//! stages have made every mathematical decision.
//!
//! Generated code names only public items of `::dalembert`, `::dalembert::__private` and `::core`.

#![forbid(unsafe_code)]

mod actuation;
mod constants;
mod constraint;
mod declared;
mod describe;
mod doc;
mod file;
mod function;
mod indices;
mod jet;
mod kernels;
pub mod modes;
mod names;
mod parameters;
mod scene;
mod state;
mod variational;
mod volume;

use proc_macro2::TokenStream;
use quote::quote;

use dalembert_codegen::diagnostics::Diagnostics;
use dalembert_codegen::model::{Model, Scene};
use dalembert_codegen::spec::{self, Declaration};
use dalembert_codegen::tables::FormOf;
use dalembert_codegen::{Compiled, compile_modes, compile_spec, read};
use names::Names;

/// The whole pipeline: takes the body of a `model!` and returns Rust items. If the body has errors, returns compile
/// errors only.
pub fn expand(input: TokenStream) -> TokenStream {
    match try_expand(input) {
        Ok(items) => items,
        Err(diagnostics) => diagnostics.into_compile_error(),
    }
}

/// Same as [`expand`], but returns errors as diagnostics.
///
/// # Errors
/// All errors of the first stage that fails.
pub fn try_expand(input: TokenStream) -> Result<TokenStream, Diagnostics> {
    expand_declaration(read(input)?)
}

/// The whole pipeline for the models of a file. `input` is the body of a `model_file!`; its path is relative to
/// `folder`.
pub fn expand_file(input: TokenStream, folder: &std::path::Path) -> TokenStream {
    file::expand(input, folder)
}

fn expand_declaration(declaration: Declaration) -> Result<TokenStream, Diagnostics> {
    match declaration {
        Declaration::Model(spec) => {
            let mut compiled = compile_spec(&spec, spec::STEPS)?;
            if spec.global.is_none() {
                leave_out_global(&mut compiled);
            }
            compiled.note_findings();
            compiled.scenes.iter_mut().for_each(Compiled::note_findings);
            Ok(tokens(&compiled))
        }
        Declaration::Modes(declared) => {
            let mut compiled = compile_modes(&declared)?;
            compiled.modes.iter_mut().for_each(Compiled::note_findings);
            Ok(modes::tokens(&compiled))
        }
    }
}

/// Leaves out the global forms of a reduced model and of its scenes, for which the declaration does not ask.
fn leave_out_global(compiled: &mut Compiled) {
    compiled.programs.global = None;
    compiled.scenes.iter_mut().for_each(leave_out_global);
}

/// Input of every emitter.
struct Context<'a> {
    form: FormOf<'a>,
    names: Names,
}

/// The generated items of a model: the items of its type and of the types of its scenes. A type that is reduced to D
/// also has a type for its global form, if that form was compiled.
pub fn tokens(compiled: &Compiled) -> TokenStream {
    let model = &compiled.model;
    let contexts = contexts(compiled, &model.scenes, |names| names);
    let scenes: Vec<Vec<Context<'_>>> = model
        .scenes
        .iter()
        .zip(&compiled.scenes)
        .map(|(scene, compiled)| contexts_of_scene(model, scene, compiled))
        .collect();
    let declarations = [
        parameters::emit_parameters(&contexts[0]),
        indices::emit_indices(&contexts[0], &scenes),
    ];
    let shadows = names::emit_shadows(core::iter::once(model));
    let allowances = allowances();
    let mut written = kernels::Written::default();
    let mut items = forms(&contexts, &[], &mut written);
    for scene in &scenes {
        items.extend(forms(scene, &contexts, &mut written));
    }
    quote! {
        #(#declarations)*
        #allowances
        const _: () = {
            #shadows
            #items
        };
    }
}

/// Implementations for the types of a model, a scene or a mode. They share kernels with `base`.
fn forms(
    contexts: &[Context<'_>],
    base: &[Context<'_>],
    written: &mut kernels::Written,
) -> TokenStream {
    let items = contexts.iter().enumerate().flat_map(|(index, context)| {
        // A global form shares kernels with the global form of `base`; without a base, with its own reduced form.
        let base = base.get(index).or(base.first());
        let base = base.or(contexts[..index].first());
        implementations(context, base, written)
    });
    items.collect()
}

/// Contexts of a model or a scene: first its own form, then the global form if it is different.
fn contexts<'a>(
    compiled: &'a Compiled,
    scenes: &'a [Scene],
    own_names: impl FnOnce(Names) -> Names,
) -> Vec<Context<'a>> {
    let model = &compiled.model;
    let names = own_names(Names::of(model, compiled.derivation.frame.as_ref().ok()));
    let forms = FormOf::all(compiled, scenes);
    let names = match forms.len() {
        1 => vec![names.without_global()],
        _ => {
            let of_global = names.of_global(model);
            vec![names, of_global]
        }
    };
    let contexts = forms.into_iter().zip(names);
    contexts
        .map(|(form, names)| Context { form, names })
        .collect()
}

/// Contexts of a scene; see [`contexts`].
fn contexts_of_scene<'a>(
    model: &'a Model,
    scene: &'a Scene,
    compiled: &'a Compiled,
) -> Vec<Context<'a>> {
    contexts(compiled, &model.scenes, |names| {
        names.of_scene(model, scene)
    })
}

/// Implementations for a type of the model.
fn implementations(
    context: &Context<'_>,
    base: Option<&Context<'_>>,
    written: &mut kernels::Written,
) -> [TokenStream; 9] {
    [
        kernels::emit_kernels(context, base, written),
        declared::emit_declared(context),
        jet::emit_taylor(context),
        actuation::emit_actuated(context),
        actuation::emit_powered(context),
        volume::emit_invariant_volume(context),
        variational::emit_variations(context),
        describe::emit_documented(context, base),
        describe::emit_scene(context),
    ]
}

/// Attributes of every generated implementation.
fn attributes() -> TokenStream {
    quote!(#[automatically_derived])
}

/// Lints that generated code allows. Lints on style do not apply to generated code, and a function may leave arguments
/// of its trait unused.
fn allowances() -> TokenStream {
    quote! {
        #[allow(non_snake_case, unused_variables, clippy::all, clippy::pedantic, clippy::nursery)]
    }
}
