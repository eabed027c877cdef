//! The shipped models as texts for the `dalembert` command, with the [`figures`] and [`errata`] of the papers in which
//! they appear.
//!
//! By default no model is compiled: a command loads the text of its model. With the feature `inlined` all models are
//! compiled, and their functions are inlined into the code that runs them.

pub mod errata;
pub mod figures;

use std::sync::OnceLock;

use dalembert_cli::{Catalogue, Entry};
pub use dalembert_texts::TEXTS;

/// The entries of compiled models.
#[cfg(feature = "inlined")]
macro_rules! entries_of {
    ($($name:ident: $model:ident,)*) => {
        fn entries() -> Vec<Entry> {
            dalembert_cli::models![$(dalembert_models::$model),*]
        }
    };
}

#[cfg(feature = "inlined")]
dalembert_texts::shipped!(entries_of);

#[cfg(not(feature = "inlined"))]
fn entries() -> Vec<Entry> {
    let texts = TEXTS.iter();
    texts
        .map(|(name, text)| Entry::of_text(name, text))
        .collect()
}

/// The entries of all shipped models. Each text is loaded at most once per process.
pub fn all() -> Vec<Entry> {
    static MODELS: OnceLock<Vec<Entry>> = OnceLock::new();
    MODELS.get_or_init(entries).clone()
}

/// The catalogue of the `dalembert` command: every shipped model, and the figures and errata of the papers.
pub fn catalogue() -> Catalogue {
    Catalogue::of(all())
        .with_figures(figures::all())
        .with_errata(errata::ERRATA)
}
