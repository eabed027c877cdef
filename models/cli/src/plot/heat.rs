//! A density on a table: boxes coloured by value.

use plotters::element::Rectangle;
use plotters::style::{Color, RGBColor};

use super::canvas::{Area, INDENT, message, px, text, text_width};
use super::colours::colour;
use super::contour::Window;
use super::plane::{Head, Words};
use super::portrait::draw_boundary;
use super::style::{self, Axis};
use super::{Table, image};

/// Width of the picture, in pixels.
const WIDTH: f64 = 440.0;

/// Height of the colour bar with its numbers, in pixels.
const BAR: f64 = 40.0;

/// Number of colours besides the transparent one.
const SHADES: usize = 255;

/// Number of stripes of the colour bar.
const STRIPES: usize = 64;

/// Fraction of the non-empty boxes below the value of the last colour; larger values share that colour.
const SHOWN: f64 = 0.995;

/// Colour of the placeholder of the boxes; no picture has this colour.
const PLACE: RGBColor = RGBColor(1, 2, 3);

/// A density to be drawn.
pub struct Map<'a> {
    /// The table under the density.
    pub table: &'a Table<'a>,
    /// First line of the title.
    pub title: &'a str,
    /// Second line of the title.
    pub subtitle: &'a str,
    /// The rectangle covered by the boxes.
    pub window: Window,
    /// Boxes along each side.
    pub boxes: usize,
    /// Their values, row by row from below.
    pub densities: &'a [f64],
}

/// Draws the density.
///
/// # Errors
/// An error of the drawing library, or a model without a region in a plane.
pub fn draw(map: &Map<'_>) -> Result<String, String> {
    let (plane, boundary) = map.table.plane(WIDTH)?;
    let most = map.most();
    let words = Words {
        title: map.title,
        subtitle: map.subtitle,
        axes: map.table.labels(),
        head: &Bar { most },
    };
    let Window { x, y } = map.window;
    let svg = plane.sheet(
        &words,
        |_| Ok(()),
        |chart| {
            let place = Rectangle::new([(x[0], y[0]), (x[1], y[1])], PLACE.filled());
            chart.draw_series([place]).map_err(message)?;
            draw_boundary(chart, &boundary)
        },
    )?;
    put_image(&svg, &map.image(most)?).ok_or_else(|| "the boxes found no place".to_owned())
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

    /// The boxes as the data address of an image.
    fn image(&self, most: f64) -> Result<String, String> {
        let shade = |value: f64| match value {
            0.0 => 0,
            _ => 1 + ((value / most * SHADES as f64) as usize).min(SHADES - 1) as u8,
        };
        let rows = self.densities.chunks(self.boxes).rev();
        let pixels: Vec<u8> = rows.flatten().map(|&value| shade(value)).collect();
        image::data_address(self.boxes, &palette(), &pixels)
    }
}

/// The transparent colour, then all shades.
fn palette() -> Vec<RGBColor> {
    let shades = (0..SHADES).map(|index| colour(index as f64 / (SHADES - 1) as f64));
    std::iter::once(RGBColor(255, 255, 255))
        .chain(shades)
        .collect()
}

/// Replaces the placeholder rectangle by the image, since the drawing library can only draw boxes one by one.
fn put_image(svg: &str, address: &str) -> Option<String> {
    let mark = format!("fill=\"{}\"", style::hex(PLACE));
    let middle = svg.find(&mark)?;
    let start = svg[..middle].rfind('<')?;
    let end = middle + svg[middle..].find("/>")? + 2;
    let attributes = svg[start..middle].strip_prefix("<rect")?;
    let image = format!(
        "<image{attributes}preserveAspectRatio=\"none\" style=\"image-rendering:pixelated\" href=\"{address}\"/>"
    );
    Some([&svg[..start], &image, &svg[end..]].concat())
}

/// The colour bar.
struct Bar {
    most: f64,
}

impl Head for Bar {
    fn height(&self, _width: f64) -> f64 {
        BAR
    }

    fn draw(&self, area: &Area<'_>, width: f64) -> Result<(), String> {
        const NAME: &str = "density";
        let left = INDENT + text_width(NAME, 12.0) + 12.0;
        let right = width - 2.0 * INDENT;
        let name = text(12.0, style::INK);
        area.draw_text(NAME, &name, (px(INDENT), px(5.0)))
            .map_err(message)?;
        let at = |share: f64| left + share * (right - left);
        for index in 0..STRIPES {
            // Each stripe extends below those to its right, which avoids visible seams.
            let share = index as f64 / STRIPES as f64;
            let corners = [(px(at(share)), px(4.0)), (px(right), px(18.0))];
            let fill = colour(share).filled();
            area.draw(&Rectangle::new(corners, fill)).map_err(message)?;
        }
        let axis = Axis::new([0.0, self.most], 4);
        for value in axis.ticks() {
            let label = axis.label(value);
            let from = at(value / self.most) - 0.5 * text_width(&label, 11.0);
            area.draw_text(&label, &text(11.0, style::INK), (px(from), px(22.0)))
                .map_err(message)?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_image_takes_the_place_of_its_rectangle() {
        let svg = "<svg><rect x=\"1\" width=\"2\" opacity=\"1\" fill=\"#010203\" stroke=\"none\"/><g/></svg>";
        let image = put_image(svg, "data:").unwrap();
        assert!(image.starts_with("<svg><image x=\"1\" width=\"2\" opacity=\"1\" preserve"));
        assert!(image.ends_with("href=\"data:\"/><g/></svg>"));
        assert_eq!(put_image("<svg/>", "data:"), None);
    }
}
