//! Data of a form besides its functions, in the types that the runtime reads.
//!
//! | file | job |
//! |---|---|
//! | `form.rs` | sizes, conditions and laws of a form |
//! | `description.rs` | self-description of a model |
//! | `names.rs` | names, of which the program keeps one copy each |
//! | `modes.rs` | tables and self-description of a model with modes, with the indices of each mode's quantities in the model |
//!
//! `emit` writes the data down as constants; an interpreter of declarations uses them directly.
// NOTE: tables own their data, except names. Names are interned (`names.rs`), because errors carry them.

mod description;
mod form;
mod modes;
mod names;

use dalembert_expr::ExprId;
use dalembert_numbers::Held;

use crate::Compiled;
use crate::mechanics::Frame;
use crate::model::{Model, Parameter, Scene};
use crate::program::{Form, Program};
pub use description::text_of;
pub use modes::Whole;
use names::name;

/// One form of a model, of a scene or of a mode.
#[derive(Debug, Clone, Copy)]
pub struct FormOf<'a> {
    /// The model in use: the whole one, or its restriction to a scene.
    pub model: &'a Model,
    /// The scenes of the whole model.
    pub scenes: &'a [Scene],
    /// The frame, if the model has one.
    pub frame: Option<&'a Frame>,
    /// The functions.
    pub program: &'a Program,
}

impl<'a> FormOf<'a> {
    /// The forms of a model, of a scene or of a mode: first the form in which it is run, then the global form if that
    /// is a different one.
    pub fn all(compiled: &'a Compiled, scenes: &'a [Scene]) -> Vec<Self> {
        let Compiled {
            model,
            derivation,
            programs,
            ..
        } = compiled;
        let form = |program| Self {
            model,
            scenes,
            frame: derivation.frame.as_ref().ok(),
            program,
        };
        core::iter::once(&programs.main)
            .chain(&programs.global)
            .map(form)
            .collect()
    }

    /// True for the global form of a model or a scene whose own form is reduced.
    pub fn is_wrapped(&self) -> bool {
        self.frame.is_some() && self.program.form == Form::Global
    }

    /// Number of coordinates.
    pub fn dimension(&self) -> usize {
        self.model.coordinates.len()
    }

    /// Number of components of the state besides the positions.
    pub fn motion_dimension(&self) -> usize {
        match self.program.form {
            Form::Global => self.dimension(),
            Form::Reduced => self.frame.map_or(0, |frame| frame.quasi.len()),
            Form::FirstOrder => 0,
        }
    }

    /// Number of components of the state.
    pub fn state_dimension(&self) -> usize {
        self.dimension() + self.motion_dimension()
    }

    /// The names of the quasi-velocities.
    pub fn quasi_names(&self) -> Vec<String> {
        let quasi = self.frame.iter().flat_map(|frame| &frame.quasi);
        quasi.map(|velocity| velocity.name.clone()).collect()
    }

    /// Number of gaps with a power series: all of them, or none.
    pub fn series_gaps(&self) -> usize {
        self.program.jet.function.outputs.len() - self.state_dimension()
    }
}

/// The declared default of a parameter.
pub fn default_value(model: &Model, parameter: &Parameter) -> Option<f64> {
    parameter.default.map(|default| constant(model, default))
}

/// The value of an expression without symbols.
fn constant(model: &Model, expression: ExprId) -> f64 {
    model.pool.eval(&[expression], &|_| f64::NAN)[0]
}

/// Values as an owned table.
fn table<T>(values: impl IntoIterator<Item = T>) -> Held<[T]> {
    Held::Owned(values.into_iter().collect())
}

/// A text as an owned table.
fn text(text: impl Into<Box<str>>) -> Held<str> {
    Held::Owned(text.into())
}

/// Interned names as an owned table.
fn names<'n>(names: impl IntoIterator<Item = &'n str>) -> Held<[&'static str]> {
    table(names.into_iter().map(name))
}
