//! What a command line works on.

use crate::entry::Entry;
use crate::suite::Case;

/// The models of a command line, and the hard cases of its `stability` command.
#[derive(Clone)]
pub struct Catalogue {
    models: Vec<Entry>,
    suite: Vec<Case>,
}

impl Catalogue {
    /// Models, as made by [`models!`](crate::models), and no cases.
    pub fn of(models: Vec<Entry>) -> Self {
        Self {
            models,
            suite: Vec::new(),
        }
    }

    /// With these cases.
    #[must_use]
    pub fn with_suite(mut self, suite: Vec<Case>) -> Self {
        self.suite = suite;
        self
    }

    /// The models.
    pub fn models(&self) -> &[Entry] {
        &self.models
    }

    /// The hard cases.
    pub fn suite(&self) -> &[Case] {
        &self.suite
    }
}
