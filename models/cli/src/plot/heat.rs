//! A density over the region of a view: boxes coloured by value.

use super::bar::{Bar, palette};
use super::contour::Window;
use super::plane::Words;
use super::portrait::draw_boundary;
use super::{Table, image};

/// Width of the picture, in pixels.
const WIDTH: f64 = 440.0;

/// Fraction of the non-empty boxes that the colour scale covers; larger values have the last colour.
const SHOWN: f64 = 0.995;

/// A density to be drawn.
pub struct Map<'a> {
    /// The region under the density.
    pub table: &'a Table<'a>,
    /// First line of the title.
    pub title: &'a str,
    /// Second line of the title.
    pub subtitle: &'a str,
    /// The rectangle covered by the boxes.
    pub window: Window,
    /// Number of boxes along each side.
    pub boxes: usize,
    /// The densities of the boxes, row by row from below.
    pub densities: &'a [f64],
}

/// Draws the density.
///
/// # Errors
/// An error of the drawing library, or a model without a region in a plane.
pub fn draw(map: &Map<'_>) -> Result<String, String> {
    let (plane, boundary) = map.table.plane(WIDTH)?;
    let bar = Bar {
        name: "density",
        range: [0.0, map.most()],
    };
    let labels = map.table.labels();
    let words = Words {
        title: map.title,
        subtitle: map.subtitle,
        axes: labels.each_ref().map(String::as_str),
        head: &bar,
    };
    let svg = plane.sheet(
        &words,
        |_| Ok(()),
        |chart| {
            image::draw_place(chart, map.window)?;
            draw_boundary(chart, &boundary)
        },
    )?;
    image::put(&svg, &map.image(&bar)?)
}

impl Map<'_> {
    /// The value of the last colour.
    fn most(&self) -> f64 {
        let positive = self.densities.iter().copied().filter(|value| *value > 0.0);
        let mut values: Vec<f64> = positive.collect();
        values.sort_by(f64::total_cmp);
        let index = (SHOWN * values.len() as f64) as usize;
        let most = values.get(index.min(values.len().saturating_sub(1)));
        most.copied().unwrap_or(1.0)
    }

    /// The boxes as an image in a data URL.
    fn image(&self, bar: &Bar<'_>) -> Result<String, String> {
        let shade = |value: f64| match value {
            0.0 => 0,
            _ => bar.shade(value),
        };
        let rows = self.densities.chunks(self.boxes).rev();
        let pixels: Vec<u8> = rows.flatten().map(|&value| shade(value)).collect();
        image::data_address(self.boxes, &palette(), &pixels)
    }
}
