//! Rust identifiers for the user's names.

use std::collections::BTreeSet;

use proc_macro2::{Ident, Span, TokenStream};
use quote::quote;

use crate::model::{Model, Name};
use crate::program::{Function, Input, Op};

/// Identifiers of a model's quantities inside generated functions.
pub(super) struct Names {
    /// The type.
    pub type_name: Ident,
    /// The module of indices.
    pub module: Ident,
    /// Locals that hold coordinates.
    pub coordinates: Vec<Ident>,
    /// Locals that hold momenta.
    pub momenta: Vec<Ident>,
    /// Locals that hold velocities.
    pub velocities: Vec<Ident>,
    /// Places of parameters: `self.m`, `self.m[2]`.
    pub parameters: Vec<TokenStream>,
}

/// Names that generated functions use for their own arguments.
const ARGUMENTS: [&str; 23] = [
    "t",
    "state",
    "rate",
    "q",
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
    "unit",
    "order",
    "coefficients",
    "jets",
    "gaps",
    "k",
    "weight",
    "inverse",
    "step",
];

impl Names {
    pub fn of(model: &Model) -> Self {
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
        Self {
            type_name: Ident::new(&model.name, Span::call_site()),
            module: Ident::new(&model.snake_name, Span::call_site()),
            coordinates,
            momenta,
            velocities,
            parameters: model
                .parameters
                .iter()
                .map(|parameter| place(&parameter.name))
                .collect(),
        }
    }

    /// The names that locals of a function must avoid: those of its arguments.
    pub fn taken(&self, function: &Function) -> BTreeSet<String> {
        let mut taken = arguments();
        taken.extend(function.ops.iter().filter_map(|op| match op {
            Op::Input(Input::Coordinate(i)) => Some(self.coordinates[*i].to_string()),
            Op::Input(Input::Momentum(i)) => Some(self.momenta[*i].to_string()),
            Op::Input(Input::Velocity(i)) => Some(self.velocities[*i].to_string()),
            _ => None,
        }));
        taken
    }
}

fn arguments() -> BTreeSet<String> {
    ARGUMENTS.iter().map(|name| (*name).to_string()).collect()
}

/// The place of a parameter in the struct.
fn place(name: &Name) -> TokenStream {
    let field = Ident::new(&name.field, Span::call_site());
    match name.member {
        Some(member) => {
            let index = proc_macro2::Literal::usize_unsuffixed(member - 1);
            quote!(self.#field[#index])
        }
        None => quote!(self.#field),
    }
}

/// A fresh local name close to the wished one: lower case, so that it is never taken for a constant.
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

/// Whether Rust would not take the name as a local.
fn is_keyword(name: &str) -> bool {
    name == "_" || crate::spec::is_rust_keyword(name)
}
