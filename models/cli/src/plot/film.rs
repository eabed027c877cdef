//! Curves of runs that are repeated for a picture.

use dalembert_driver::{AnyModel, Contact, Impact, Origin, Piece, Settings, Watch};

use super::quantity::Quantity;
use super::trace::{Source, Trace};
use crate::error::CliError;

/// The quantities along a run, and before its impacts. `start` is the energy at the start.
///
/// # Errors
/// A run that cannot be repeated.
pub fn curve(
    model: &dyn AnyModel,
    origin: &Origin,
    settings: &Settings,
    quantities: &[Quantity],
    start: f64,
) -> Result<[Vec<Vec<f64>>; 2], CliError> {
    let mut camera = Camera {
        trace: Trace::of(Source::Quantities(quantities.to_vec())),
        corners: Vec::new(),
        quantities,
        start,
    };
    let ending = model.simulate(origin, settings, &mut camera);
    ending.map_err(|refusal| CliError::refused(model, &refusal))?;
    let points = camera.trace.points().iter();
    let points = points.map(|mark| mark.values.clone()).collect();
    Ok([points, camera.corners])
}

/// Keeps the curve of a run and the places of its impacts.
struct Camera<'a> {
    trace: Trace,
    corners: Vec<Vec<f64>>,
    quantities: &'a [Quantity],
    start: f64,
}

impl Watch for Camera<'_> {
    fn step(&mut self, piece: &dyn Piece) {
        self.trace.follow(piece);
    }

    fn impact(&mut self, impact: Impact) {
        self.trace.corner(impact.t, &impact.before);
        self.trace.corner(impact.t, &impact.after);
        let quantities = self.quantities.iter();
        let values = quantities.map(|it| it.value(impact.t, &impact.before, self.start));
        self.corners.push(values.collect());
    }

    fn contact(&mut self, contact: Contact) {
        self.trace.corner(contact.t, &contact.at);
    }
}
