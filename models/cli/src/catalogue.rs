//! The models, cases and figures of a command line.

use crate::entry::Entry;
use crate::gallery::Figure;
use crate::suite::Case;

/// The models of a command line, the hard cases of its `stability` command, and the figures of its `gallery`.
#[derive(Clone)]
pub struct Catalogue {
    models: Vec<Entry>,
    suite: Vec<Case>,
    figures: Vec<Figure>,
}

impl Catalogue {
    /// A catalogue of models, as made by [`models!`](crate::models), without cases, and with the figures that every
    /// model has.
    pub fn of(models: Vec<Entry>) -> Self {
        Self {
            models,
            suite: Vec::new(),
            figures: Vec::new(),
        }
    }

    /// Sets the hard cases.
    #[must_use]
    pub fn with_suite(mut self, suite: Vec<Case>) -> Self {
        self.suite = suite;
        self
    }

    /// Sets the figures that follow those that every model has.
    #[must_use]
    pub fn with_figures(mut self, figures: Vec<Figure>) -> Self {
        self.figures = figures;
        self
    }

    /// The catalogue with these models before the others; names may occur twice.
    pub(crate) fn with_models(&self, mut models: Vec<Entry>) -> Self {
        models.extend(self.models.iter().cloned());
        Self {
            models,
            ..self.clone()
        }
    }

    /// The models.
    pub fn models(&self) -> &[Entry] {
        &self.models
    }

    /// The hard cases.
    pub fn suite(&self) -> &[Case] {
        &self.suite
    }

    /// The added figures.
    pub fn figures(&self) -> &[Figure] {
        &self.figures
    }
}
