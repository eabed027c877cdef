//! `Documented` and `Scene`: the self-description of a model, and its effects.

use dalembert_numbers::description::Documentation;
use proc_macro2::{Ident, Span, TokenStream};
use quote::quote;

use super::constants::{Constant, Record};
use super::{Context, parameters, scene};
use dalembert_codegen::program::Form;

/// `impl Documented`, and `impl Emitted` with the constants of the form.
pub(super) fn emit_documented(context: &Context<'_>, base: Option<&Context<'_>>) -> TokenStream {
    let type_name = &context.names.type_name;
    let model = context.form.model;
    let defaults = match &context.names.held {
        Some(held) => quote!(Self(<#held as ::dalembert::Described>::with_defaults())),
        None => parameters::with_defaults(model),
    };
    let (global_type, global, is_left_out) =
        match (&context.names.global, context.form.program.form) {
            (Some(global), _) => (quote!(#global), quote!(Some(#global(*self))), false),
            (None, Form::Reduced) => (quote!(Self), quote!(None), true),
            (None, Form::Global | Form::FirstOrder) => (quote!(Self), quote!(Some(*self)), false),
        };
    let has_global = is_left_out.then(|| {
        quote!(
            const HAS_GLOBAL: bool = false;
        )
    });
    let set = match &context.names.held {
        Some(held) => {
            quote!(<#held as ::dalembert::describe::Instance>::set_parameter(&mut self.0, index, value);)
        }
        None => emit_set(&context.names.parameters),
    };
    let tables = emit_tables(context, base);
    let documentation = emit_documentation(context, base);
    let numbers = context.form.program.geometry.function.outputs.len();
    let scenes = scene::emit_visit(context);
    let variational = super::variational::emit_visit(context);
    let attributes = super::attributes();
    quote! {
        #attributes
        impl ::dalembert::kernels::Documented for #type_name {
            type Geometry = [f64; #numbers];
            type Global = #global_type;

            #has_global

            #[inline]
            fn documentation(&self) -> &'static ::dalembert::kernels::Documentation {
                <Self as ::dalembert::declaration::Emitted>::DOCUMENTATION
            }

            #[inline]
            fn globally(&self) -> ::core::option::Option<Self::Global> {
                ::core::option::Option::#global
            }

            fn set_argument(&mut self, index: usize, value: f64) { #set }

            #variational
        }

        #attributes
        impl ::dalembert::declaration::Emitted for #type_name {
            const TABLES: &'static ::dalembert::kernels::Tables = #tables;
            const DOCUMENTATION: &'static ::dalembert::kernels::Documentation = #documentation;

            fn declared() -> Self { #defaults }

            #scenes
        }
    }
}

/// The tables of a form, as differences from those of `base` where there is one.
fn emit_tables(context: &Context<'_>, base: Option<&Context<'_>>) -> TokenStream {
    let tables = context.form.tables();
    match base {
        Some(base) => {
            let place = emitted(&base.names.type_name, "TABLES");
            tables.tokens_beside(&base.form.tables(), &place)
        }
        None => {
            let tables = tables.tokens();
            quote!(&#tables)
        }
    }
}

/// The self-description of a form, as differences from that of `base` where there is one.
fn emit_documentation(context: &Context<'_>, base: Option<&Context<'_>>) -> TokenStream {
    let documentation = context.form.documentation();
    match base {
        Some(base) => {
            let place = emitted(&base.names.type_name, "DOCUMENTATION");
            documentation.tokens_beside(&base.form.documentation(), &place)
        }
        None => with_shared_parameters(&documentation),
    }
}

/// Tokens of a reference to a self-description that takes its parameters from the tables instead of repeating them.
pub(super) fn with_shared_parameters(documentation: &Documentation) -> TokenStream {
    let tables = emitted(&quote!(Self), "TABLES");
    let description = &documentation.description;
    let description =
        description.tokens_with(&[("parameters", quote!(#tables.parameters.again()))]);
    let documentation = documentation.tokens_with(&[("description", description)]);
    quote!(&#documentation)
}

/// Path of a constant that a type has by the trait `Emitted`.
pub(super) fn emitted(type_name: &TokenStream, constant: &str) -> TokenStream {
    let constant = Ident::new(constant, Span::call_site());
    quote!(<#type_name as ::dalembert::declaration::Emitted>::#constant)
}

/// The statement that sets parameter `index` to `value`; `places` are the fields of the parameters, in order.
pub(super) fn emit_set(places: &[TokenStream]) -> TokenStream {
    let set = places
        .iter()
        .enumerate()
        .map(|(k, place)| quote!(#k => #place = value,));
    quote! {
        match index {
            #(#set)*
            _ => {}
        }
    }
}

/// `impl Scene`: the effects that the model needs.
pub(super) fn emit_scene(context: &Context<'_>) -> TokenStream {
    let type_name = &context.names.type_name;
    let (mut types, mut values) = (Vec::new(), Vec::new());
    if context.form.drifts() {
        types.push(quote!(::dalembert::Projection<Self>));
        values.push(quote!(::dalembert::Projection::new()));
    }
    if context.form.program.impacting.is_some() {
        types.push(quote!(::dalembert::Impacts<Self>));
        values.push(quote!(::dalembert::Impacts::declared(self)));
    }
    let attributes = super::attributes();
    quote! {
        #attributes
        impl ::dalembert::Scene for #type_name {
            type Effects = (#(#types,)*);

            fn effects(&self) -> Self::Effects { (#(#values,)*) }
        }
    }
}
