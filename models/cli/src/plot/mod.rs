//! Pictures of runs as SVG: the declared view as a path in its plane, all coordinates against time, or chosen
//! quantities against time or each other.

mod bar;
pub mod branch;
mod canvas;
pub mod cloud;
mod colours;
pub mod contour;
pub mod curves;
pub mod density;
pub mod field;
pub mod film;
pub mod heat;
mod history;
mod image;
mod legend;
pub mod logarithmic;
pub mod map;
pub mod paths;
mod phase;
mod plane;
pub mod player;
mod portrait;
pub mod quantity;
mod region;
pub mod style;
mod table;
mod thin;
pub mod trace;
pub mod work;

use dalembert_driver::{AnyModel, Impact, Point};
use plotters::style::RGBColor;

use legend::{Item, Symbol};
use quantity::Quantity;
pub use table::Table;
use trace::{Source, Trace};

/// Content of a picture.
pub struct Picture<'a> {
    /// The model.
    pub model: &'a dyn AnyModel,
    /// First line of the title.
    pub title: String,
    /// Second line of the title.
    pub subtitle: String,
    /// Its width, in pixels.
    pub width: f64,
    /// The curve.
    pub trace: &'a Trace,
    /// The marked impacts.
    pub impacts: &'a [Impact],
    /// The state at the start.
    pub first: &'a Point,
    /// The time at the end and the state there.
    pub last: (f64, &'a Point),
}

/// A picture of a run.
pub struct Drawn {
    /// The picture.
    pub svg: String,
    /// The outcome of the run, in words.
    pub outcome: String,
}

impl Picture<'_> {
    /// The legend of a path in a plane.
    fn legend(&self, path: &str, colour: RGBColor) -> Vec<Item> {
        let mut items = vec![
            Item::new(Symbol::Line, colour, path),
            Item::new(Symbol::Ring, style::INK, "start"),
            Item::new(Symbol::Square, style::INK, "end"),
        ];
        let counted = self.impacts_by_surface();
        items.extend(counted.map(|(index, name, count)| {
            Item::new(
                Symbol::Dot,
                style::surface(index),
                format!("{name} ({count})"),
            )
        }));
        items
    }

    /// The surfaces with impacts, each with its index, its name and its number of impacts.
    fn impacts_by_surface(&self) -> impl Iterator<Item = (usize, &'static str, usize)> {
        let surfaces = self.model.description().surfaces.iter().enumerate();
        let counted = surfaces.map(|(index, surface)| {
            let impacts = self.impacts.iter();
            let count = impacts.filter(|impact| impact.surface == index).count();
            (index, surface.name, count)
        });
        counted.filter(|(_, _, count)| *count > 0)
    }
}

/// Largest value that can be drawn. The drawing library computes ranges and ticks in `f64`, which must not overflow.
const LARGEST: f64 = 1e200;

/// Draws the picture.
///
/// # Errors
/// An error of the drawing library, or values too large to draw.
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
    match (picture.trace.source(), &picture.model.description().view) {
        (Source::View, Some(view)) => portrait::draw(picture, view),
        (Source::Quantities(quantities), _) if quantities[0] != Quantity::Time => {
            phase::draw(picture, quantities)
        }
        _ => history::draw(picture),
    }
}
