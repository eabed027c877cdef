//! The model and the start that members share, from flags.

use dalembert_driver::ensemble::runner::Common;
use dalembert_driver::words::Advice;
use dalembert_driver::{AnyModel, Beginning};

use crate::args::RunArgs;
use crate::entry::Entry;
use crate::error::ADVICE;
use crate::state_input;

/// The flags of a run, and the models from which they choose.
pub struct Flags<'a> {
    /// The models.
    pub models: &'a [Entry],
    /// The flags.
    pub run: &'a RunArgs,
}

impl Common for Flags<'_> {
    fn model(&self) -> Result<Box<dyn AnyModel>, String> {
        state_input::build_model(self.models, &self.run.model).map_err(|error| error.to_string())
    }

    fn beginning(&self, model: &dyn AnyModel) -> Result<Beginning, String> {
        state_input::beginning(model, &self.run.state).map_err(|error| error.to_string())
    }

    fn advice(&self) -> &Advice {
        &ADVICE
    }
}
