//! What the type of a declared model tells, before there is a model: its description, its declared values, its scenes.

mod form;

pub use form::of_mode;

use crate::contract::{Lagrangian, TaylorField};
use crate::describe::{Description, Instance};
use crate::effects::Scene;
use crate::erased::Form;
use crate::kernels::{Documentation, Documented, Given, Tables};

/// A declared model. Implemented by `model!` for every model.
#[diagnostic::on_unimplemented(
    message = "`{Self}` is not a model declared with `dalembert::model!`"
)]
pub trait Described: Instance {
    /// Names, docs, topology, parameters, surfaces, scenes, source text.
    const DESCRIPTION: Description;

    /// The inputs; their values are the parameters after those of the description.
    const INPUTS: &'static [&'static str] = &[];

    /// The model as data, for [`Erased`](crate::erased::Erased); `None` for one that only its own type can run.
    const FORM: Option<&'static Form> = None;

    /// Shows the type of each declared scene, in order; the model itself, the scene `all`, is not among them.
    fn visit_scenes<Visitor: SceneVisitor>(visitor: &mut Visitor) {
        let _ = visitor;
    }

    /// The system with declared defaults; a parameter without default is NaN until it is set.
    fn with_defaults() -> Self;
}

/// Sees the types of a model's scenes (see [`Described::visit_scenes`]).
pub trait SceneVisitor {
    /// A scene of this name: the model with what the scene leaves of its effects, and the parameters of the model.
    fn visit<S>(&mut self, name: &'static str)
    where
        S: Described<Global: TaylorField + Lagrangian> + Scene + TaylorField + Lagrangian + 'static;
}

/// A form of a declared model, or of a scene, of which everything but the values of parameters is constant: `model!` writes it.
pub trait Emitted: Documented<Kernels: Given, Global: Described> + TaylorField {
    /// What is known of the form.
    const TABLES: Tables;

    /// What it says of itself.
    const DOCUMENTATION: Documentation;

    /// Of a model with modes, the forms of the modes and their global forms ([`Form::forms`]).
    const FORMS: &'static [&'static Form] = &[];

    /// As [`Described::with_defaults`].
    fn declared() -> Self;

    /// As [`Described::visit_scenes`].
    fn show_scenes<Visitor: SceneVisitor>(visitor: &mut Visitor) {
        let _ = visitor;
    }
}

impl<S: Emitted> Described for S {
    const DESCRIPTION: Description = S::DOCUMENTATION.description;

    const INPUTS: &'static [&'static str] = S::DOCUMENTATION.inputs;

    const FORM: Option<&'static Form> = form::of::<S>();

    fn visit_scenes<Visitor: SceneVisitor>(visitor: &mut Visitor) {
        S::show_scenes(visitor);
    }

    fn with_defaults() -> S {
        S::declared()
    }
}
