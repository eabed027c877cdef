//! A colour bar with numbers, above a plot.

use plotters::element::Rectangle;
use plotters::style::{Color, RGBColor};

use super::canvas::{Area, INDENT, message, px, text, text_width};
use super::colours::colour;
use super::plane::Head;
use super::style::{self, Axis};

/// Height of the colour bar with its numbers, in pixels.
const HEIGHT: f64 = 40.0;

/// Number of colours besides the transparent one.
pub const SHADES: usize = 255;

/// Number of stripes of the colour bar.
const STRIPES: usize = 64;

/// A colour bar.
pub struct Bar<'a> {
    /// The name of the quantity.
    pub name: &'a str,
    /// The numbers that the first and the last colour show.
    pub range: [f64; 2],
}

impl Bar<'_> {
    /// The position of a number on the bar, from 0 to 1; numbers beyond the range count as its ends.
    pub fn share(&self, value: f64) -> f64 {
        let [low, high] = self.range;
        ((value - low) / (high - low)).clamp(0.0, 1.0)
    }

    /// The index of a number's colour in the [`palette`].
    pub fn shade(&self, value: f64) -> u8 {
        1 + ((self.share(value) * SHADES as f64) as usize).min(SHADES - 1) as u8
    }
}

/// The transparent colour, then all shades.
pub fn palette() -> Vec<RGBColor> {
    let shades = (0..SHADES).map(|index| colour(index as f64 / (SHADES - 1) as f64));
    std::iter::once(RGBColor(255, 255, 255))
        .chain(shades)
        .collect()
}

impl Head for Bar<'_> {
    fn height(&self, _width: f64) -> f64 {
        HEIGHT
    }

    fn draw(&self, area: &Area<'_>, width: f64) -> Result<(), String> {
        let left = INDENT + text_width(self.name, 12.0) + 12.0;
        let right = width - 2.0 * INDENT;
        let name = text(12.0, style::INK);
        area.draw_text(self.name, &name, (px(INDENT), px(5.0)))
            .map_err(message)?;
        let at = |share: f64| left + share * (right - left);
        for index in 0..STRIPES {
            // Each stripe extends to the right end, and later stripes cover it. This avoids visible seams.
            let share = index as f64 / STRIPES as f64;
            let corners = [(px(at(share)), px(4.0)), (px(right), px(18.0))];
            let fill = colour(share).filled();
            area.draw(&Rectangle::new(corners, fill)).map_err(message)?;
        }
        let axis = Axis::new(self.range, 4);
        for value in axis.ticks() {
            let label = axis.label(value);
            let from = at(self.share(value)) - 0.5 * text_width(&label, 11.0);
            area.draw_text(&label, &text(11.0, style::INK), (px(from), px(22.0)))
                .map_err(message)?;
        }
        Ok(())
    }
}
