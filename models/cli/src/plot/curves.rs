//! Curves of one quantity over another, and separate points.

use dalembert_driver::padded;
use plotters::style::RGBColor;

use super::contour::Window;
use super::legend::{Item, Symbol};
use super::plane::{self, Plane, Words};
use super::style::PALETTE;

/// Radius of a point, in pixels.
const DOT: f64 = 1.8;

/// A curve with its points.
pub struct Curve {
    /// Its label in the legend.
    pub label: String,
    /// Index of its colour in the palette.
    pub colour: usize,
    /// Its connected parts.
    pub stretches: Vec<Vec<[f64; 2]>>,
    /// Points in its colour. They do not extend the picture.
    pub points: Vec<[f64; 2]>,
}

/// Curves to be drawn.
pub struct Chart<'a> {
    /// First line of the title.
    pub title: &'a str,
    /// Second line of the title.
    pub subtitle: &'a str,
    /// The names of both axes.
    pub axes: [&'a str; 2],
    /// Values along x that the picture must cover.
    pub values: &'a [f64],
    /// The curves.
    pub curves: Vec<Curve>,
    /// Width of the picture, in pixels.
    pub width: u32,
}

/// Draws the curves.
///
/// # Errors
/// An error of the drawing library.
pub fn draw(chart: &Chart<'_>) -> Result<String, String> {
    let stretches = chart.curves.iter().flat_map(|curve| &curve.stretches);
    let window = Window {
        x: padded(chart.values.iter().copied(), 0.02),
        y: padded(stretches.flatten().map(|at| at[1]), 0.06),
    };
    let plane = Plane::free_scales(window, f64::from(chart.width));
    let drawn_curves = chart.curves.iter().filter(|curve| !curve.is_empty());
    let legend = drawn_curves.map(|curve| Item::new(Symbol::Line, curve.colour(), &curve.label));
    let words = Words {
        title: chart.title,
        subtitle: chart.subtitle,
        axes: chart.axes,
        head: &legend.collect::<Vec<Item>>(),
    };
    let is_inside = |at: &[f64; 2]| window.y[0] <= at[1] && at[1] <= window.y[1];
    plane.sheet(
        &words,
        |_| Ok(()),
        |drawn| {
            for curve in &chart.curves {
                for stretch in &curve.stretches {
                    plane.path(drawn, stretch, curve.colour())?;
                }
                let points = curve.points.iter().copied().filter(is_inside);
                plane::dots(drawn, points.map(|at| (at, curve.colour())), DOT)?;
            }
            Ok(())
        },
    )
}

impl Curve {
    fn colour(&self) -> RGBColor {
        PALETTE[self.colour % PALETTE.len()]
    }

    fn is_empty(&self) -> bool {
        self.points.is_empty() && self.stretches.iter().all(Vec::is_empty)
    }
}
