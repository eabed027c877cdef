//! The models of the command line: Rust types, and texts that are loaded on first use.
//!
//! The commands use every model through [`AnyModel`].

use std::sync::{Arc, OnceLock};

use dalembert::declaration::{Described, SceneVisitor};
use dalembert::describe::Description;
use dalembert::erased::{Form, Shared};
use dalembert::{Lagrangian, Scene, TaylorField};
use dalembert_driver::{
    AnyModel, Code, MakeWhole, Model, of_compiled, of_form, of_system, of_type,
};
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
#[derive(Clone)]
enum Build {
    /// A declared type or one of its scenes, and what makes its form from the text of the declaration.
    Compiled(Compiled, MakeWhole),
    /// A form loaded from a text.
    Loaded(Arc<Form>),
    /// A system that is made at run time, and its description.
    Made(fn() -> Box<dyn AnyModel>, &'static Description),
}

/// A declared type.
#[derive(Clone, Copy)]
enum Compiled {
    /// A compiled form, run by code that all forms share.
    Erased(&'static Form),
    /// A type whose runs have code compiled for it alone, and its description.
    Typed(fn(MakeWhole) -> Box<dyn AnyModel>, &'static Description),
    /// A type that is too large for a form, and its description. Everything is compiled for it alone.
    Large(fn() -> Box<dyn AnyModel>, &'static Description),
}

impl Compiled {
    // NOTE: the match is evaluated at compile time. Therefore only kernels are compiled for a type that has a form.
    const fn of<M: Model + Described + 'static>() -> Self {
        match M::FORM {
            Some(form) if !cfg!(feature = "inlined") => Self::Erased(form),
            Some(_) => Self::Typed(of_type::<M>, M::DESCRIPTION),
            None => Self::Large(|| of_system(M::with_defaults()), M::DESCRIPTION),
        }
    }
}

/// Message for a form that has no room, although the constructor of its entry refuses such forms.
const HAS_ROOM: &str = "a form within the largest capacity";

impl Build {
    fn build(&self) -> Box<dyn AnyModel> {
        match self {
            Self::Compiled(Compiled::Erased(form), whole) => {
                of_compiled(form, whole).expect(HAS_ROOM)
            }
            Self::Compiled(Compiled::Typed(build, _), whole) => build(Arc::clone(whole)),
            Self::Compiled(Compiled::Large(build, _), _) => build(),
            Self::Loaded(form) => of_form(Arc::clone(form).into(), Code::Loaded).expect(HAS_ROOM),
            Self::Made(build, _) => build(),
        }
    }

    fn description(&self) -> &Description {
        match self {
            Self::Compiled(Compiled::Erased(form), _) => &form.documentation.description,
            Self::Compiled(
                Compiled::Typed(_, description) | Compiled::Large(_, description),
                _,
            ) => description,
            Self::Loaded(form) => &form.documentation.description,
            Self::Made(_, description) => description,
        }
    }
}

/// The text of a compiled model. Its scenes share it, and it is loaded at most once.
#[derive(Default)]
struct Text {
    /// The forms of the model and of its scenes; `None` if the text cannot be loaded.
    forms: OnceLock<Option<Vec<Arc<Form>>>>,
}

impl Text {
    /// Returns the function that makes the form of a scene of a declaration.
    fn scene(self: &Arc<Self>, description: &'static Description, scene: usize) -> MakeWhole {
        let text = Arc::clone(self);
        Arc::new(move || {
            let forms = text.forms.get_or_init(|| {
                let models = dalembert_jit::load(description.name, &description.source).ok()?;
                let [model] = models.as_slice() else {
                    return None;
                };
                let scenes = model.scenes.iter().map(|(_, form)| Arc::clone(form));
                let forms = core::iter::once(Arc::clone(&model.form)).chain(scenes);
                Some(forms.collect())
            });
            Some(Shared::from(Arc::clone(forms.as_ref()?.get(scene)?)))
        })
    }
}

/// A declared type with its scenes.
struct Declaration {
    description: &'static Description,
    text: Arc<Text>,
    known: Known,
}

impl Declaration {
    fn add(&mut self, name: &str, compiled: Compiled) {
        let scenes = &mut self.known.scenes;
        let whole = self.text.scene(self.description, scenes.len());
        scenes.push((name.to_owned(), Build::Compiled(compiled, whole)));
    }
}

impl Entry {
    /// The entry of a model type with its scenes; the scene `all` is the model itself.
    pub fn of<M: Model + Described + 'static>() -> Self {
        let mut declaration = Declaration {
            description: M::DESCRIPTION,
            text: Arc::default(),
            known: Known { scenes: Vec::new() },
        };
        declaration.add(WHOLE, const { Compiled::of::<M>() });
        M::visit_scenes(&mut declaration);
        Self::known_by(declaration.known)
    }

    /// The entry of a system that is made at run time: its description, and a function that makes the system with its
    /// declared defaults ([`of_system`](dalembert_driver::of_system)).
    pub fn of_system(description: &'static Description, build: fn() -> Box<dyn AnyModel>) -> Self {
        Self::known_by(Known {
            scenes: vec![(WHOLE.to_owned(), Build::Made(build, description))],
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
            Build::Loaded(form) => form.excess(),
            Build::Compiled(..) | Build::Made(..) => None,
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

impl SceneVisitor for Declaration {
    fn visit<S>(&mut self, name: &'static str)
    where
        S: Described<Global: TaylorField + Lagrangian> + Scene + TaylorField + Lagrangian + 'static,
    {
        self.add(name, const { Compiled::of::<S>() });
    }
}

/// A list of models for [`run`](crate::run), by their types: `models![Pendulum, RollingDisk]`.
#[macro_export]
macro_rules! models {
    ($($model:ty),* $(,)?) => { vec![$($crate::Entry::of::<$model>()),*] };
}
