//! The models of the command line: Rust types, and texts that are loaded on first use.
//!
//! The commands use every model through [`AnyModel`].

use std::sync::{Arc, OnceLock};

use dalembert::declaration::{Described, SceneVisitor};
use dalembert::describe::Description;
use dalembert::erased::{Form, Shared};
use dalembert::{Lagrangian, Scene, TaylorField};
use dalembert_driver::{AnyModel, Code, Model, of_form, of_type};
use dalembert_jit::Loaded;

use crate::error::CliError;

/// One model in the list of [`run`](crate::run), with its scenes.
#[derive(Clone)]
pub struct Entry {
    name: &'static str,
    source: Source,
}

/// Source of a model.
#[derive(Clone)]
enum Source {
    /// A type, or a text that was loaded.
    Known(Box<Known>),
    /// A text that is loaded on first use. Clones of the entry share the loaded model.
    Text {
        text: &'static str,
        known: Arc<OnceLock<Known>>,
    },
}

/// The name of the scene that is the model itself.
const WHOLE: &str = "all";

/// A model with its scenes, `all` first.
#[derive(Clone)]
struct Known {
    scenes: Vec<(String, Build)>,
}

/// Constructor of a model with declared defaults.
#[derive(Debug, Clone)]
enum Build {
    /// A compiled form, run by code that all forms share.
    Erased(&'static Form),
    /// A form loaded from a text.
    Loaded(Arc<Form>),
    /// A type whose runs have code compiled for it alone, and its description.
    Typed(fn() -> Box<dyn AnyModel>, &'static Description),
}

impl Build {
    // NOTE: the match is evaluated at compile time. Therefore only kernels are compiled for a type that has a form.
    const fn of<M: Model + Described + 'static>() -> Self {
        match M::FORM {
            Some(form) if !cfg!(feature = "inlined") => Self::Erased(form),
            _ => Self::Typed(of_type::<M>, M::DESCRIPTION),
        }
    }

    fn build(&self) -> Box<dyn AnyModel> {
        match self {
            Self::Erased(form) => erased(Shared::Static(form), Code::Pointers),
            Self::Loaded(form) => erased(Arc::clone(form).into(), Code::Loaded),
            Self::Typed(build, _) => build(),
        }
    }

    fn description(&self) -> &Description {
        match self {
            Self::Erased(form) => &form.documentation.description,
            Self::Loaded(form) => &form.documentation.description,
            Self::Typed(_, description) => description,
        }
    }
}

/// The model of a form, which must fit the largest capacity.
fn erased(form: Shared<Form>, code: Code) -> Box<dyn AnyModel> {
    of_form(form, code).expect("a form within the largest capacity")
}

impl Entry {
    /// The entry of a model type with its scenes; the scene `all` is the model itself.
    pub fn of<M: Model + Described + 'static>() -> Self {
        let mut known = Known {
            scenes: vec![(WHOLE.to_owned(), const { Build::of::<M>() })],
        };
        M::visit_scenes(&mut known);
        Self::known_by(known)
    }

    /// The entry of a system that is made at run time: its description, and a function that makes the system with its
    /// declared defaults ([`of_system`](dalembert_driver::of_system)).
    pub fn of_system(description: &'static Description, build: fn() -> Box<dyn AnyModel>) -> Self {
        Self::known_by(Known {
            scenes: vec![(WHOLE.to_owned(), Build::Typed(build, description))],
        })
    }

    /// The entry of the model with this name that a text declares, such as `rolling_disk` for `RollingDisk { .. }`. The
    /// text is loaded once, when a property other than the name is first used.
    ///
    /// # Panics
    /// Loading panics unless the text declares exactly one model, with this name, that can be run without being
    /// compiled.
    pub fn of_text(name: &'static str, text: &'static str) -> Self {
        let known = Arc::default();
        Self {
            name,
            source: Source::Text { text, known },
        }
    }

    /// The entry of a model loaded from its text.
    pub(crate) fn loaded(model: &Loaded) -> Self {
        Self::known_by(Known::of(model))
    }

    fn known_by(known: Known) -> Self {
        Self {
            name: known.description().name,
            source: Source::Known(Box::new(known)),
        }
    }

    fn known(&self) -> &Known {
        match &self.source {
            Source::Known(known) => known,
            Source::Text { text, known } => known.get_or_init(|| load(self.name, text)),
        }
    }

    /// Refuses a model that exceeds the largest system.
    ///
    /// # Errors
    /// [`CliError::Large`] for such a model.
    pub(crate) fn check_size(&self) -> Result<(), CliError> {
        self.known().check_size()
    }

    /// The name of the model, as in its description.
    pub fn name(&self) -> &'static str {
        self.name
    }

    /// The description of the model.
    pub fn description(&self) -> &Description {
        self.known().description()
    }

    /// The names of the scenes, `all` first.
    pub fn scenes(&self) -> impl Iterator<Item = &str> + Clone {
        self.known().scenes.iter().map(|(name, _)| name.as_str())
    }

    /// The model in the scene of this index, with declared defaults.
    pub(crate) fn with_defaults(&self, scene: usize) -> Box<dyn AnyModel> {
        self.known().scenes[scene].1.build()
    }
}

/// Loads the one model of a text.
fn load(name: &str, text: &str) -> Known {
    let loaded = dalembert_jit::load(name, text);
    let models = loaded.unwrap_or_else(|refused| panic!("{refused}"));
    let [model] = models.as_slice() else {
        panic!("the text of `{name}` declares {} models", models.len());
    };
    let known = Known::of(model);
    assert_eq!(known.description().name, name, "the name of a text");
    if let Err(error) = known.check_size() {
        panic!("{error}");
    }
    known
}

impl Known {
    fn of(model: &Loaded) -> Self {
        let scenes = model.scenes.iter();
        let scenes = scenes.map(|(name, form)| (name.clone(), Build::Loaded(Arc::clone(form))));
        let whole = (WHOLE.to_owned(), Build::Loaded(Arc::clone(&model.form)));
        Self {
            scenes: [whole].into_iter().chain(scenes).collect(),
        }
    }

    /// The description of the model itself.
    fn description(&self) -> &Description {
        self.scenes[0].1.description()
    }

    fn check_size(&self) -> Result<(), CliError> {
        let excess = |(_, build): &(_, Build)| match build {
            Build::Erased(form) => form.excess(),
            Build::Loaded(form) => form.excess(),
            Build::Typed(..) => None,
        };
        match self.scenes.iter().find_map(excess) {
            None => Ok(()),
            Some(excess) => Err(CliError::Large {
                model: self.description().name,
                excess,
            }),
        }
    }
}

impl SceneVisitor for Known {
    fn visit<S>(&mut self, name: &'static str)
    where
        S: Described<Global: TaylorField + Lagrangian> + Scene + TaylorField + Lagrangian + 'static,
    {
        self.scenes
            .push((name.to_owned(), const { Build::of::<S>() }));
    }
}

/// A list of models for [`run`](crate::run), by their types: `models![Pendulum, RollingDisk]`.
#[macro_export]
macro_rules! models {
    ($($model:ty),* $(,)?) => { vec![$($crate::Entry::of::<$model>()),*] };
}
