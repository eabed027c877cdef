//! Points on a table: a scatter plot over the region of a view.

use super::Table;
use super::canvas::message;
use super::legend::{Item, Symbol};
use super::plane::{self, Words};
use super::portrait::{draw_boundary, fill_region};
use super::style;

/// Width of the picture, in pixels.
const WIDTH: f64 = 400.0;

/// Points to be drawn.
pub struct Cloud<'a> {
    /// The table under the points.
    pub table: &'a Table<'a>,
    /// First line of the title.
    pub title: &'a str,
    /// Second line of the title.
    pub subtitle: &'a str,
    /// The points.
    pub points: &'a [[f64; 2]],
    /// The point of the start that is not scattered.
    pub middle: Option<[f64; 2]>,
}

/// Draws the points.
///
/// # Errors
/// An error of the drawing library, or a model without a region in a plane.
pub fn draw(cloud: &Cloud<'_>) -> Result<String, String> {
    let (plane, boundary) = cloud.table.plane(WIDTH)?;
    let items = vec![
        Item::new(
            Symbol::Dot,
            style::PATH,
            format!("scattered starts ({})", cloud.points.len()),
        ),
        Item::new(Symbol::Ring, style::INK, "unscattered start"),
    ];
    let labels = cloud.table.labels();
    let words = Words {
        title: cloud.title,
        subtitle: cloud.subtitle,
        axes: labels.each_ref().map(String::as_str),
        head: &items,
    };
    plane.sheet(
        &words,
        |chart| fill_region(chart, &boundary),
        |chart| {
            draw_boundary(chart, &boundary)?;
            let points = cloud.points.iter().map(|&at| (at, style::PATH));
            plane::dots(chart, points, 2.4)?;
            match cloud.middle {
                Some(at) => chart
                    .draw_series([plane::ring(at)])
                    .map_err(message)
                    .map(drop),
                None => Ok(()),
            }
        },
    )
}
