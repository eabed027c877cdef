//! Curves of runs that are repeated for a picture.

use dalembert_driver::{AnyModel, Contact, Impact, Origin, Piece, Settings, Watch};

use super::paths::Stretch;
use super::quantity::Quantity;
use super::trace::{Source, Trace};
use crate::error::CliError;

/// The quantities along a run, in stretches between its impacts.
///
/// # Errors
/// A run that cannot be repeated.
pub fn curve(
    model: &dyn AnyModel,
    origin: &Origin,
    settings: &Settings,
    quantities: &[Quantity],
) -> Result<Vec<Stretch>, CliError> {
    let mut camera = Camera(Trace::of(Source::Quantities(quantities.to_vec())));
    let ending = model.simulate(origin, settings, &mut camera);
    ending.map_err(|refusal| CliError::refused(model, &refusal))?;
    Ok(camera.0.stretches(|mark| mark.values.clone()))
}

/// Keeps the curve of a run.
struct Camera(Trace);

impl Watch for Camera {
    fn step(&mut self, piece: &dyn Piece) {
        self.0.follow(piece);
    }

    fn impact(&mut self, impact: Impact) {
        self.0.corner(impact.t, &impact.before);
        self.0.corner(impact.t, &impact.after);
    }

    fn contact(&mut self, contact: Contact) {
        self.0.corner(contact.t, &contact.at);
    }
}
