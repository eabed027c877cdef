//! Models loaded from their texts, so that cases need no compiler.

use std::sync::OnceLock;

use dalembert::Instance;
use dalembert::describe::Description;
use dalembert::erased::Erased;
use dalembert_cli::Entry;
use dalembert_jit::Loaded;

/// A loaded model with values for its parameters, whose vectors have at most 8 components.
pub type Model = Erased<'static, 8>;

/// A loaded model whose vectors have at most 32 components.
pub type Large = Erased<'static, 32>;

/// The text of one model, loaded on first use:
///
/// ```
/// use dalembert_stability::text::Text;
///
/// static FALL: Text = Text::new("
///     Fall {
///         coordinates { x; }
///         parameters { g = 1; }
///         lagrangian = dot(x)^2/2 - g*x;
///     }
/// ");
/// let moon = FALL.with([("g", 1.62)]);
/// ```
pub struct Text {
    text: &'static str,
    // NOTE: the model of a case lives as long as the program, so that cases need not carry its lifetime.
    loaded: OnceLock<&'static Loaded>,
}

impl Text {
    /// The model of this text. The text is read on first use.
    pub const fn new(text: &'static str) -> Self {
        Self {
            text,
            loaded: OnceLock::new(),
        }
    }

    /// The model with its declared values.
    ///
    /// # Panics
    /// If the text is refused, or does not declare one model.
    pub fn model(&self) -> Model {
        self.sized()
    }

    /// The model with these values for some of its parameters, by name.
    ///
    /// # Panics
    /// The panics of [`Text::model`], and if there is no such parameter.
    pub fn with<const K: usize>(&self, values: [(&str, f64); K]) -> Model {
        self.sized_with(values)
    }

    /// Same as [`Text::with`], for vectors too long for [`Model`].
    ///
    /// # Panics
    /// The panics of [`Text::with`].
    pub fn large<const K: usize>(&self, values: [(&str, f64); K]) -> Large {
        self.sized_with(values)
    }

    fn sized_with<const C: usize, const K: usize>(
        &self,
        values: [(&str, f64); K],
    ) -> Erased<'static, C> {
        let mut model = self.sized();
        for (name, value) in values {
            set(&mut model, name, value);
        }
        model
    }

    /// The model with its declared values, in vectors of at most `C` components.
    ///
    /// # Panics
    /// The panics of [`Text::model`], and if a vector has more than `C` components.
    pub fn sized<const C: usize>(&self) -> Erased<'static, C> {
        Erased::of(&self.loaded().form).expect("vectors of no more components")
    }

    /// The scene with this name, with its declared values.
    ///
    /// # Panics
    /// The panics of [`Text::model`], and if there is no such scene.
    pub fn scene(&self, name: &str) -> Model {
        let mut scenes = self.loaded().scenes.iter();
        let scene = scenes.find(|(scene, _)| *scene == name);
        let (_, form) = scene.unwrap_or_else(|| panic!("no scene `{name}`"));
        Erased::of(form).expect("vectors of no more components")
    }

    /// The model for the command line.
    ///
    /// # Panics
    /// The panics of [`Text::model`].
    pub fn entry(&self) -> Entry {
        Entry::of_text(self.description().name, self.text)
    }

    /// The description of the model.
    ///
    /// # Panics
    /// The panics of [`Text::model`].
    pub fn description(&self) -> &'static Description {
        &self.loaded().form.documentation.description
    }

    fn loaded(&self) -> &'static Loaded {
        self.loaded.get_or_init(|| {
            let models = dalembert_jit::load("case", self.text);
            let mut models = models.unwrap_or_else(|refused| panic!("{refused}"));
            assert_eq!(models.len(), 1, "a text declares one model");
            Box::leak(Box::new(models.remove(0)))
        })
    }
}

/// The shipped model with this name, such as `rolling_disk`.
///
/// # Panics
/// If no shipped model has this name.
pub fn shipped(name: &str) -> &'static Text {
    static SHIPPED: OnceLock<Vec<(&str, Text)>> = OnceLock::new();
    let texts = dalembert_command::TEXTS.iter();
    let all = SHIPPED.get_or_init(|| texts.map(|&(name, text)| (name, Text::new(text))).collect());
    let found = all.iter().find(|(shipped, _)| *shipped == name);
    let (_, text) = found.unwrap_or_else(|| panic!("no shipped model `{name}`"));
    text
}

/// A mode of a model as a separate system.
///
/// # Panics
/// If there is no such mode.
pub fn mode<'f, const C: usize>(model: &Erased<'f, C>, number: usize) -> Erased<'f, C> {
    let form = model.form();
    let place = form.tables.modes[number].kernels;
    let mut mode = Erased::of(&form.forms[place]).expect("vectors of no more components");
    for index in 0..model.description().parameters.len() {
        mode.set_parameter(index, model.parameter(index));
    }
    mode
}

/// Sets a parameter by its name.
///
/// # Panics
/// If there is no such parameter.
pub fn set<const C: usize>(model: &mut Erased<'_, C>, name: &str, value: f64) {
    model.set_parameter(place(model, name), value);
}

/// The value of the parameter with this name.
///
/// # Panics
/// If there is no such parameter.
pub fn value<const C: usize>(model: &Erased<'_, C>, name: &str) -> f64 {
    model.parameter(place(model, name))
}

fn place<const C: usize>(model: &Erased<'_, C>, name: &str) -> usize {
    let mut parameters = model.description().parameters.iter();
    let place = parameters.position(|parameter| parameter.name == name);
    place.unwrap_or_else(|| panic!("no parameter `{name}`"))
}
