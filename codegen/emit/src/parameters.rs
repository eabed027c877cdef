//! Type of a model: a struct with the parameters as public fields, and its defaults.

use proc_macro2::{Ident, Span, TokenStream};
use quote::quote;

use super::{Context, doc, function::number, names};
use dalembert_codegen::model::{Assumption, Model, Parameter};
use dalembert_codegen::tables::default_value;

/// Emits the struct, `Default` if every parameter has a default, and the type of the global form of a reduced model.
pub(super) fn emit_parameters(context: &Context<'_>) -> TokenStream {
    let model = context.form.model;
    let type_name = &context.names.model_type;
    let visibility: TokenStream = model.visibility.parse().unwrap_or_default();
    let documentation = doc::lines(&documentation(context));
    let fields = emit_fields(model);
    let default = emit_default(context);
    let global = emit_global(context, &model.name, "model", &visibility);
    quote! {
        #documentation
        #[allow(non_snake_case, clippy::all, clippy::pedantic, clippy::nursery)]
        #[derive(Debug, Clone, Copy, PartialEq)]
        #visibility struct #type_name { #fields }
        #default
        #global
    }
}

/// A field for each parameter and for each family of parameters.
pub(super) fn emit_fields(model: &Model) -> TokenStream {
    let families = families(&model.parameters).into_iter();
    families
        .map(|family| emit_field_of(model, family))
        .collect()
}

/// Emits the type of the global form, if it is a separate form and is emitted.
pub(super) fn emit_global(
    context: &Context<'_>,
    type_name: &str,
    noun: &str,
    visibility: &TokenStream,
) -> TokenStream {
    if context.names.global.is_none() {
        return TokenStream::new();
    }
    let model_type = Ident::new(type_name, Span::call_site());
    let global = names::global_name(type_name);
    let title = format!(
        " [`{model_type}`] in its global form: the state `(q, p)` may also lie off the constraints."
    );
    let held = format!(" The {noun} with its parameters.");
    quote! {
        #[doc = #title]
        #[derive(Debug, Clone, Copy, PartialEq)]
        #visibility struct #global(
            #[doc = #held]
            pub #model_type,
        );
    }
}

/// Documentation lines for the type of a model or a scene.
pub(super) fn documentation(context: &Context<'_>) -> Vec<String> {
    let model = context.form.model;
    let mut lines = model.documentation.clone();
    lines.push(String::new());
    lines.push(format!(" State: `{}`.", doc::state_order(context)));
    for note in &model.notes {
        lines.push(String::new());
        lines.push(format!(" Note: {note}"));
    }
    lines
}

fn emit_field_of(model: &Model, family: &[Parameter]) -> TokenStream {
    let first = &family[0];
    let field = Ident::new(&first.name.field, Span::call_site());
    let mut lines = first.documentation.clone();
    lines.push(match first.is_input {
        true => " Input, held until it is set; 0 at first.".to_owned(),
        false => format!(" Parameter{}.", describe(model, first)),
    });
    let documentation = doc::lines(&lines);
    let count = family.len();
    match first.name.member {
        Some(_) => quote!(#documentation pub #field: [f64; #count],),
        None => quote!(#documentation pub #field: f64,),
    }
}

fn describe(model: &Model, parameter: &Parameter) -> String {
    let demand = match &parameter.assumption {
        Assumption::Finite => String::new(),
        Assumption::Positive => ", `> 0`".into(),
        Assumption::NonNegative => ", `>= 0`".into(),
        Assumption::NonZero => ", `!= 0`".into(),
        Assumption::Within { low, high } => format!(", in `[{low}, {high}]`"),
    };
    match default_value(model, parameter) {
        Some(value) => format!("{demand}; default {value}"),
        None => demand,
    }
}

/// Parameters in groups: single parameters and families.
pub(super) fn families(parameters: &[Parameter]) -> Vec<&[Parameter]> {
    parameters
        .chunk_by(|a, b| a.name.member.is_some() && a.name.field == b.name.field)
        .collect()
}

/// Struct expression with the declared defaults; NaN for parameters without a default.
pub(super) fn with_defaults(model: &Model) -> TokenStream {
    let fields = default_fields(model);
    quote!(Self { #fields })
}

/// Fields with the declared defaults, each followed by a comma.
pub(super) fn default_fields(model: &Model) -> TokenStream {
    let fields = families(&model.parameters).into_iter().map(|family| {
        let field = Ident::new(&family[0].name.field, Span::call_site());
        let values = family
            .iter()
            .map(|parameter| number(default_value(model, parameter).unwrap_or(f64::NAN)));
        match family[0].name.member {
            Some(_) => quote!(#field: [#(#values),*]),
            None => quote!(#field: #(#values)*),
        }
    });
    quote!(#(#fields,)*)
}

/// True if every parameter has a default.
pub(super) fn have_defaults(model: &Model) -> bool {
    let mut parameters = model.parameters.iter();
    parameters.all(|parameter| parameter.default.is_some())
}

fn emit_default(context: &Context<'_>) -> TokenStream {
    let model = context.form.model;
    if !have_defaults(model) {
        return TokenStream::new();
    }
    let type_name = &context.names.model_type;
    let value = with_defaults(model);
    let (attributes, allowances) = (super::attributes(), super::allowances());
    quote! {
        #attributes
        #allowances
        impl ::core::default::Default for #type_name {
            /// The declared defaults.
            fn default() -> Self { #value }
        }
    }
}
