//! Pictures of runs as SVG: the declared view as a path in its plane, or all coordinates against time.

mod canvas;
pub mod contour;
pub mod density;
mod history;
mod legend;
pub mod logarithmic;
mod portrait;
mod region;
pub mod style;
pub mod trace;
pub mod work;

use crate::driver::Impact;
use crate::entry::{AnyModel, Point};
use trace::Trace;

/// What a picture shows.
pub struct Picture<'a> {
    /// The model.
    pub model: &'a dyn AnyModel,
    /// First line of the title.
    pub title: String,
    /// Second line of the title.
    pub subtitle: String,
    /// The curve.
    pub trace: &'a Trace,
    /// The impacts to mark on it.
    pub impacts: &'a [Impact],
    /// The state at the start.
    pub first: &'a Point,
    /// The time at the end and the state there.
    pub last: (f64, &'a Point),
}

/// Greatest value that is drawn; the drawing library computes ranges and ticks in the same `f64`.
const LARGEST: f64 = 1e200;

/// Draws the picture.
///
/// # Errors
/// What the drawing library says, or that there are values too large to draw.
pub fn draw(picture: &Picture<'_>) -> Result<String, String> {
    let mut values = picture
        .trace
        .points()
        .iter()
        .flat_map(|mark| mark.values.iter().chain([&mark.t]));
    if values.any(|value| value.abs() > LARGEST) {
        return Err(format!(
            "the run has values beyond {LARGEST:e}, which cannot be drawn"
        ));
    }
    match picture.model.description().view {
        Some(view) => portrait::draw(picture, &view),
        None => history::draw(picture),
    }
}
