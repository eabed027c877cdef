//! Pictures of runs as SVG: the declared view as a path in its plane, or all coordinates against time.

mod canvas;
pub mod contour;
mod history;
mod legend;
mod portrait;
mod region;
mod style;
pub mod trace;

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

/// Draws the picture.
///
/// # Errors
/// What the drawing library says.
pub fn draw(picture: &Picture<'_>) -> Result<String, String> {
    match picture.model.description().view {
        Some(view) => portrait::draw(picture, &view),
        None => history::draw(picture),
    }
}
