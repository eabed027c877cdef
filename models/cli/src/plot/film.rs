//! Curves of runs that are repeated for a picture.

use dalembert_driver::{AnyModel, Contact, Impact, Origin, Piece, Settings, Watch};

use super::paths::Stretch;
use super::quantity::Quantity;
use super::trace::{Mark, Source, Trace};
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
    let is_impact = |left: &Mark, right: &Mark| left.corner && right.corner && left.t == right.t;
    let marks = camera.0.points();
    let stretches = marks.chunk_by(|left, right| !is_impact(left, right));
    let is_whole = |mark: &&Mark| mark.values.iter().all(|value| value.is_finite());
    let whole = |stretch: &[Mark]| {
        stretch
            .iter()
            .filter(is_whole)
            .map(|it| it.values.clone())
            .collect()
    };
    Ok(stretches.map(whole).collect())
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
