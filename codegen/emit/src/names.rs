//! Rust identifiers for the user's names.

use std::collections::BTreeSet;

use proc_macro2::{Ident, Literal, Span, TokenStream};
use quote::quote;

use dalembert_codegen::mechanics::Frame;
use dalembert_codegen::model::{Model, Name, Scene};
use dalembert_codegen::program::{Function, Input, Op};
use dalembert_expr::Rational;

use super::function::number;

/// Identifiers of a model's quantities inside generated functions.
#[derive(Clone)]
pub(super) struct Names {
    /// The type whose functions are emitted: that of the model, of a scene, or of a global form.
    pub type_name: TokenStream,
    /// The type of the model or the scene itself.
    pub model_type: TokenStream,
    /// The type of the global form of the model or the scene, if it is a separate form and is emitted.
    pub global: Option<TokenStream>,
    /// The type of the value that `type_name` wraps: a scene wraps its model, a global form wraps a model or a scene.
    /// `None` for the type of a model, which has the parameters itself.
    pub held: Option<TokenStream>,
    /// Locals that hold coordinates.
    pub coordinates: Vec<Ident>,
    /// Locals that hold momenta.
    pub momenta: Vec<Ident>,
    /// Locals that hold velocities.
    pub velocities: Vec<Ident>,
    /// Locals that hold quasi-velocities.
    pub quasi: Vec<Ident>,
    /// Expressions of the parameters: `self.m`, `self.m[2]`.
    pub parameters: Vec<TokenStream>,
}

/// An exact number as an expression: one double if that is exact, else the unevaluated sum of several doubles.
pub(super) fn rational(exact: &Rational) -> TokenStream {
    let parts = exact.to_parts();
    match parts[1] == 0.0 {
        true => {
            let constant = number(parts[0]);
            quote!(L::of(#constant))
        }
        false => {
            let parts = parts.map(number);
            quote!(L::constant([#(#parts),*]))
        }
    }
}

/// The number pi.
pub(super) fn pi() -> TokenStream {
    quote!(L::constant(::dalembert::numbers::PI))
}

/// Names that generated functions use for their own arguments and locals; `dalembert::__private::arguments` has each of them.
const ARGUMENTS: [&str; 35] = [
    "t",
    "state",
    "rate",
    "q",
    "placed",
    "from",
    "keep",
    "qdot",
    "p",
    "excess",
    "forms",
    "affine",
    "surface",
    "values",
    "report",
    "size",
    "direction",
    "motion",
    "inputs",
    "unit",
    "order",
    "coefficients",
    "jets",
    "parameters",
    "firsts",
    "gaps",
    "k",
    "weight",
    "inverse",
    "step",
    "visitor",
    "reach",
    "after_q",
    "after_qdot",
    "component",
];

/// The identifier of the type of the global form.
pub(super) fn global_name(type_name: &str) -> Ident {
    Ident::new(&format!("{type_name}Global"), Span::call_site())
}

impl Names {
    /// Identifiers for the model's own type.
    pub fn of(model: &Model, frame: Option<&Frame>) -> Self {
        let mut taken = arguments();
        let mut locals = |prefix: &str, suffix: &str| -> Vec<Ident> {
            let wished = |name: &Name| format!("{prefix}{}{suffix}", name.display);
            let names = model
                .coordinates
                .iter()
                .map(|coordinate| claim(&mut taken, &wished(&coordinate.name)));
            names
                .map(|name| Ident::new(&name, Span::call_site()))
                .collect()
        };
        let (coordinates, momenta, velocities) =
            (locals("", ""), locals("p_", ""), locals("", "_dot"));
        let quasi = frame.iter().flat_map(|frame| &frame.quasi);
        let quasi = quasi
            .map(|velocity| match velocity.coordinate {
                Some(i) => velocities[i].clone(),
                None => Ident::new(&claim(&mut taken, &velocity.name), Span::call_site()),
            })
            .collect();
        let type_name = Ident::new(&model.name, Span::call_site());
        let global = global_name(&model.name);
        Self {
            type_name: quote!(#type_name),
            model_type: quote!(#type_name),
            global: Some(quote!(#global)),
            held: None,
            coordinates,
            momenta,
            velocities,
            quasi,
            parameters: places(model, &quote!(self)),
        }
    }

    /// Identifiers for a scene of the model. The type of the scene is in the module of indices and holds the model.
    pub fn of_scene(self, model: &Model, scene: &Scene) -> Self {
        let module = Ident::new(&model.snake_name, Span::call_site());
        let type_name = Ident::new(&scene.type_name, Span::call_site());
        let global = global_name(&scene.type_name);
        Self {
            type_name: quote!(#module::#type_name),
            held: Some(self.model_type),
            model_type: quote!(#module::#type_name),
            global: Some(quote!(#module::#global)),
            parameters: places(model, &quote!(self.0)),
            ..self
        }
    }

    /// Identifiers for the type of the global form, which holds the model or the scene.
    pub fn of_global(&self, model: &Model) -> Self {
        let holder = match self.held {
            None => quote!(self.0),
            Some(_) => quote!(self.0.0),
        };
        Self {
            type_name: self.global.clone().unwrap_or_default(),
            global: None,
            held: Some(self.model_type.clone()),
            parameters: places(model, &holder),
            ..self.clone()
        }
    }

    /// The same identifiers, without a type for the global form.
    pub fn without_global(self) -> Self {
        Self {
            global: None,
            ..self
        }
    }

    /// Names that locals of a function must avoid: arguments of generated functions, and the inputs that this one
    /// reads.
    pub fn taken(&self, function: &Function) -> BTreeSet<String> {
        let mut taken = arguments();
        taken.extend(function.ops.iter().filter_map(|op| match op {
            Op::Input(Input::Coordinate(i)) => Some(self.coordinates[*i].to_string()),
            Op::Input(Input::Momentum(i)) => Some(self.momenta[*i].to_string()),
            Op::Input(Input::Velocity(i)) => Some(self.velocities[*i].to_string()),
            Op::Input(Input::Quasi(i)) => Some(self.quasi[*i].to_string()),
            _ => None,
        }));
        taken
    }
}

fn arguments() -> BTreeSet<String> {
    ARGUMENTS.iter().map(|name| (*name).to_string()).collect()
}

/// Functions that shadow constants in scope. In a pattern, Rust reads the name of a constant in scope as that constant,
/// and `use disk::coordinate::phi` imports one for an index. A pattern may rebind the name of a function.
pub(super) fn emit_shadows<'m>(models: impl Iterator<Item = &'m Model>) -> TokenStream {
    let names_of = |model: &'m Model| {
        (model.coordinates.iter().map(|item| &item.name))
            .chain(model.constraints.iter().map(|item| &item.name))
            .chain(model.frame.iter().map(|item| &item.name))
            .chain(model.surfaces.iter().map(|item| &item.name))
            .chain(model.outputs.iter().map(|item| &item.name))
    };
    let names: BTreeSet<&str> = models
        .flat_map(names_of)
        .map(|name| name.field.as_str())
        .collect();
    let names = names
        .into_iter()
        .map(|name| Ident::new(name, Span::call_site()));
    quote! {
        #[allow(unused_imports)]
        use ::dalembert::__private::arguments::*;
        #(#[allow(dead_code, non_snake_case)] fn #names() {})*
    }
}

/// Expressions that read the parameters from `holder`: `holder.m`, `holder.m[2]`.
pub(super) fn places(model: &Model, holder: &TokenStream) -> Vec<TokenStream> {
    let parameters = model.parameters.iter();
    parameters
        .map(|parameter| place(holder, &parameter.name))
        .collect()
}

fn place(holder: &TokenStream, name: &Name) -> TokenStream {
    let field = Ident::new(&name.field, Span::call_site());
    match name.member {
        Some(member) => {
            let index = Literal::usize_unsuffixed(member - 1);
            quote!(#holder.#field[#index])
        }
        None => quote!(#holder.#field),
    }
}

/// A fresh local name close to the wished one. Lower case keeps it apart from constants.
pub(super) fn claim(taken: &mut BTreeSet<String>, wished: &str) -> String {
    let mut name: String = wished
        .chars()
        .map(|c| if c.is_alphanumeric() { c } else { '_' })
        .flat_map(char::to_lowercase)
        .collect();
    if name.is_empty() || name.starts_with(|c: char| c.is_numeric()) {
        name.insert(0, 'v');
    }
    while is_keyword(&name) || !taken.insert(name.clone()) {
        name.push('_');
    }
    name
}

/// True if Rust refuses the name as a local.
fn is_keyword(name: &str) -> bool {
    name == "_" || dalembert_codegen::spec::is_rust_keyword(name)
}
