//! A list of models of any types: each model behind one object-safe trait.
//!
//! | file | job |
//! |---|---|
//! | `model.rs` | the trait, and what its functions take and give |
//! | `typed.rs` | the trait for the type of a system |
//!
//! A model that has a form is run by the system of all forms, which is compiled here; any other is compiled with all that runs it where
//! [`Entry::of`] names its type. Everything else in this crate works on slices of numbers through [`AnyModel`], and is compiled once.

mod model;
mod typed;

use dalembert::declaration::{Described, SceneVisitor};
use dalembert::describe::Description;
use dalembert::erased::{Erased, Form};
use dalembert::{Lagrangian, Scene, TaylorField};
#[cfg(feature = "files")]
use dalembert_jit::Loaded;

#[cfg(feature = "files")]
use crate::error::CliError;
pub(crate) use model::{AnyModel, Code, Contacted, Origin, Point, Rates, Start, Together};
pub use typed::Model;
use typed::Typed;
pub(crate) use typed::point;

/// One model of the list handed to [`run`](crate::run), with its scenes.
#[derive(Clone)]
pub struct Entry {
    description: Description,
    scenes: Vec<(&'static str, Build)>,
}

/// A maker of a model with declared defaults.
#[derive(Debug, Clone, Copy)]
enum Build {
    /// A form, that the systems of all forms run.
    Erased(&'static Form),
    /// A type, which everything that runs a model is compiled for.
    Typed(fn() -> Box<dyn AnyModel>),
}

impl Build {
    // NOTE: evaluated while compiling, so that nothing but kernels is compiled of a type that has a form.
    const fn of<M: Model + Described>() -> Self {
        match M::FORM {
            Some(form) if !cfg!(feature = "inlined") => Self::Erased(form),
            _ => Self::Typed(typed::<M>),
        }
    }

    fn build(self) -> Box<dyn AnyModel> {
        match self {
            Self::Erased(form) => erased(form),
            Self::Typed(build) => build(),
        }
    }
}

fn typed<M: Model + Described>() -> Box<dyn AnyModel> {
    Box::new(Typed {
        model: M::with_defaults(),
        code: Code::Inlined,
    })
}

/// The system of a form, of the least capacity that it fits into.
fn erased(form: &'static Form) -> Box<dyn AnyModel> {
    fn with_room<const C: usize>(form: &'static Form) -> Option<Box<dyn AnyModel>> {
        let model = Erased::<C>::of(form)?;
        let code = Code::Pointers;
        Some(Box::new(Typed { model, code }))
    }
    let system = with_room::<4>(form)
        .or_else(|| with_room::<8>(form))
        .or_else(|| with_room::<32>(form));
    system.expect("a form that there is a capacity for")
}

impl Entry {
    /// The entry of a model type with its scenes; the model itself is the scene `all`.
    pub fn of<M: Model + Described>() -> Self {
        let mut entry = Self {
            description: M::DESCRIPTION,
            scenes: vec![("all", const { Build::of::<M>() })],
        };
        M::visit_scenes(&mut entry);
        entry
    }

    /// The entry of a model that was loaded from its text.
    #[cfg(feature = "files")]
    pub(crate) fn loaded(model: &Loaded) -> Self {
        let scenes = model.scenes.iter();
        let scenes = scenes.map(|(name, form)| (*name, Build::Erased(form)));
        let whole = ("all", Build::Erased(model.form));
        Self {
            description: model.form.documentation.description,
            scenes: [whole].into_iter().chain(scenes).collect(),
        }
    }

    /// Refuses a model that there is no system for.
    ///
    /// # Errors
    /// [`CliError::Large`].
    #[cfg(feature = "files")]
    pub(crate) fn check_size(&self) -> Result<(), CliError> {
        let has_room = |(_, build): &(_, Build)| match build {
            Build::Erased(form) => form.capacity().is_some(),
            Build::Typed(_) => true,
        };
        match self.scenes.iter().all(has_room) {
            true => Ok(()),
            false => Err(CliError::Large {
                model: self.description.name,
            }),
        }
    }

    /// What the model says of itself.
    pub fn description(&self) -> &Description {
        &self.description
    }

    /// The names of the scenes, `all` first.
    pub fn scenes(&self) -> impl Iterator<Item = &'static str> + Clone {
        self.scenes.iter().map(|(name, _)| *name)
    }

    /// The model in the scene of this index, with declared defaults.
    pub(crate) fn with_defaults(&self, scene: usize) -> Box<dyn AnyModel> {
        self.scenes[scene].1.build()
    }
}

impl SceneVisitor for Entry {
    fn visit<S>(&mut self, name: &'static str)
    where
        S: Described<Global: TaylorField + Lagrangian> + Scene + TaylorField + Lagrangian + 'static,
    {
        self.scenes.push((name, const { Build::of::<S>() }));
    }
}

/// A list of models for [`run`](crate::run), by their types: `models![Pendulum, RollingDisk]`.
#[macro_export]
macro_rules! models {
    ($($model:ty),* $(,)?) => { vec![$($crate::Entry::of::<$model>()),*] };
}
