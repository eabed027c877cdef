//! The sheet of a picture.
//!
//! The drawing library works in whole pixels, so smooth curves would show steps. A sheet is therefore drawn
//! [`SUBPIXELS`] times as large, and the finished SVG is scaled to its intended size.

use plotters::coord::Shift;
use plotters::prelude::{DrawingArea, IntoDrawingArea, SVGBackend, WHITE};
use plotters::style::{IntoFont, RGBColor, TextStyle};

use super::style::{FAINT_INK, INK};

/// Units of the drawing library per pixel of the picture.
const SUBPIXELS: i32 = 10;

/// Converts pixels to units of the drawing library.
pub fn px(pixels: f64) -> i32 {
    (pixels * f64::from(SUBPIXELS)).round() as i32
}

/// Converts a line width in pixels to units of the drawing library.
pub fn stroke(pixels: f64) -> u32 {
    px(pixels).unsigned_abs().max(1)
}

/// A part of the sheet, in units of the drawing library.
pub type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;

/// A text style; sizes are in pixels.
pub fn text(size: f64, colour: RGBColor) -> TextStyle<'static> {
    ("sans-serif", px(size)).into_font().color(&colour)
}

/// Approximate width of a text in pixels. It is estimated, because no font is available.
pub fn text_width(text: &str, size: f64) -> f64 {
    0.56 * size * text.chars().count() as f64
}

/// Height of the two title lines, in pixels.
pub const TITLE_HEIGHT: f64 = 54.0;

/// Left edge of titles and legends, in pixels.
pub const INDENT: f64 = 20.0;

/// Width of dashed lines, in pixels. No other line has this width. The drawing library would write every dash as a line
/// of its own; therefore dashed lines are drawn as whole lines, and [`sheet`] adds the dashes.
pub const DASHED: f64 = 0.9;

/// Length of a dash and of the gap after it, in pixels.
const DASH: f64 = 4.0;

/// Draws a sheet of this size in pixels, with a title, and returns it as SVG.
///
/// # Errors
/// An error of the drawing library or of `content`.
pub fn sheet(
    size: (f64, f64),
    title: &str,
    subtitle: &str,
    content: impl FnOnce(Area<'_>) -> Result<(), String>,
) -> Result<String, String> {
    let units = (stroke(size.0), stroke(size.1));
    let mut svg = String::new();
    {
        let root = SVGBackend::with_string(&mut svg, units).into_drawing_area();
        root.fill(&WHITE).map_err(message)?;
        let (head, body) = root.split_vertically(px(TITLE_HEIGHT));
        head.draw_text(title, &text(17.0, INK), (px(INDENT), px(10.0)))
            .map_err(message)?;
        let room = size.0 - 2.0 * INDENT;
        let subtitle = shortened(subtitle, room, 12.0);
        head.draw_text(&subtitle, &text(12.0, FAINT_INK), (px(INDENT), px(33.0)))
            .map_err(message)?;
        content(body)?;
        root.present().map_err(message)?;
    }
    let drawn = format!("width=\"{}\" height=\"{}\"", units.0, units.1);
    let shown = format!("width=\"{}\" height=\"{}\"", size.0.round(), size.1.round());
    let width = format!("stroke-width=\"{}\"", stroke(DASHED));
    let dashed = format!("{width} stroke-dasharray=\"{}\"", px(DASH));
    Ok(svg.replacen(&drawn, &shown, 1).replace(&width, &dashed))
}

/// The text, shortened with an ellipsis if it is wider than `room` pixels.
pub fn shortened(text: &str, room: f64, size: f64) -> String {
    if text_width(text, size) <= room {
        return text.to_owned();
    }
    let letters = (room / text_width("x", size)).floor().max(1.0) as usize;
    text.chars().take(letters - 1).chain(['\u{2026}']).collect()
}

/// An error of the drawing library as text.
pub fn message(error: impl std::fmt::Display) -> String {
    error.to_string()
}
