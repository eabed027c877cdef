//! The models, cases, figures and errata of a command line.

use crate::entry::Entry;
use crate::errata::Erratum;
use crate::gallery::Figure;
use crate::suite::Case;

/// The models of a command line, the hard cases of its `stability` command, the figures of its `gallery`, and the errata
/// of the sources of its models.
#[derive(Clone)]
pub struct Catalogue {
    models: Vec<Entry>,
    suite: Vec<Case>,
    figures: Vec<Figure>,
    errata: &'static [Erratum],
}

impl Catalogue {
    /// A catalogue of models, as made by [`models!`](crate::models), without cases, and with the figures that every
    /// model has.
    pub fn of(models: Vec<Entry>) -> Self {
        Self {
            models,
            suite: Vec::new(),
            figures: Vec::new(),
            errata: &[],
        }
    }

    /// Sets the hard cases.
    #[must_use]
    pub fn with_suite(mut self, suite: Vec<Case>) -> Self {
        self.suite = suite;
        self
    }

    /// Sets the added figures, which come before the figures that every model has.
    #[must_use]
    pub fn with_figures(mut self, figures: Vec<Figure>) -> Self {
        self.figures = figures;
        self
    }

    /// Sets the errata of the sources.
    #[must_use]
    pub fn with_errata(mut self, errata: &'static [Erratum]) -> Self {
        self.errata = errata;
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

    /// The errata of the sources.
    pub fn errata(&self) -> &'static [Erratum] {
        self.errata
    }

    /// The added figures.
    pub fn figures(&self) -> &[Figure] {
        &self.figures
    }
}
