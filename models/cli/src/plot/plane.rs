//! A plane with two linear axes, and the objects drawn on it: paths, impacts, the start and the end.

use std::collections::HashSet;
use std::hash::Hash;

use plotters::element::{Circle, EmptyElement, PathElement, Rectangle};
use plotters::prelude::{Cartesian2d, ChartBuilder, ChartContext, SVGBackend};
use plotters::style::{Color, RGBColor};

use super::canvas::{self, Area, DASHED, TITLE_HEIGHT, message, px, stroke, text};
use super::contour::Window;
use super::legend::{self, Item};
use super::style::{self, Axis};
use super::thin::thinned;

/// Least and greatest height of the plot itself, as fractions of the picture's width.
const HEIGHT: [f64; 2] = [0.29, 0.87];

/// Height of a plot whose axes have different units, as a fraction of the picture's width.
const FREE_HEIGHT: f64 = 0.6;

/// Height of a strip, in pixels.
const STRIP_HEIGHT: f64 = 60.0;

/// Room for axis labels, left and below, and the margins around, in pixels.
const LEFT: f64 = 62.0;
const BELOW: f64 = 40.0;
const EDGE: f64 = 12.0;
const RIGHT: f64 = 28.0;
const ABOVE: f64 = 10.0;

/// Tolerance in pixels for omitted points of a line.
const NEAR: f64 = 0.12;

/// Least distance of the labels on the axes along x and y, in pixels.
const LABELS: [f64; 2] = [72.0, 48.0];

/// A chart on a plane.
pub type Chart<'a, 'b> = ChartContext<'a, SVGBackend<'b>, Cartesian2d<Axis, Axis>>;

/// The texts of a picture, and the element above its plot.
pub struct Words<'a> {
    /// First line of the title.
    pub title: &'a str,
    /// Second line of the title.
    pub subtitle: &'a str,
    /// The names of both axes.
    pub axes: [&'a str; 2],
    /// The element above the plot.
    pub head: &'a dyn Head,
}

/// An element above a plot that explains it, such as a legend or a colour bar.
pub trait Head {
    /// Its height in pixels, in a picture of this width.
    fn height(&self, width: f64) -> f64;

    /// Draws it at the top of an area.
    ///
    /// # Errors
    /// An error of the drawing library.
    fn draw(&self, area: &Area<'_>, width: f64) -> Result<(), String>;
}

/// A legend.
impl Head for Vec<Item> {
    fn height(&self, width: f64) -> f64 {
        legend::height(self, width)
    }

    fn draw(&self, area: &Area<'_>, width: f64) -> Result<(), String> {
        legend::draw(area, self, width)
    }
}

/// A window on a plane, and the size of its plot.
#[derive(Debug, Clone, Copy)]
pub struct Plane {
    /// The visible rectangle.
    pub window: Window,
    /// Width of the picture, in pixels.
    width: f64,
    /// Size of the plot itself, in pixels.
    plot: (f64, f64),
    /// False if the y axis shows no quantity.
    has_ordinate: bool,
}

impl Plane {
    /// The window, extended to equal scales on both axes, in a picture of this width.
    pub fn equal_scales(window: Window, width: f64) -> Self {
        let (across, up) = (window.x[1] - window.x[0], window.y[1] - window.y[0]);
        let plot_width = width - EDGE - LEFT - RIGHT;
        let [least, greatest] = HEIGHT.map(|part| part * width);
        let plot_height = (plot_width * up / across).clamp(least, greatest).round();
        let scale = (plot_width / across).min(plot_height / up);
        Self {
            window: Window {
                x: around(window.x, 0.5 * plot_width / scale),
                y: around(window.y, 0.5 * plot_height / scale),
            },
            width,
            plot: (plot_width, plot_height),
            has_ordinate: true,
        }
    }

    /// The window on axes with different units.
    pub fn free_scales(window: Window, width: f64) -> Self {
        Self {
            window,
            width,
            plot: (width - EDGE - LEFT - RIGHT, (FREE_HEIGHT * width).round()),
            has_ordinate: true,
        }
    }

    /// The window as a strip, whose y axis shows no quantity.
    pub fn strip(window: Window, width: f64) -> Self {
        Self {
            window,
            width,
            plot: (width - EDGE - LEFT - RIGHT, STRIP_HEIGHT),
            has_ordinate: false,
        }
    }

    /// Draws a sheet: title, element above the plot, objects behind the grid, grid and axes, objects in front of them.
    ///
    /// # Errors
    /// An error of the drawing library.
    pub fn sheet(
        &self,
        words: &Words<'_>,
        behind: impl FnOnce(&mut Chart<'_, '_>) -> Result<(), String>,
        content: impl FnOnce(&mut Chart<'_, '_>) -> Result<(), String>,
    ) -> Result<String, String> {
        let strip = words.head.height(self.width);
        let height = TITLE_HEIGHT + strip + ABOVE + self.plot.1 + BELOW + EDGE;
        canvas::sheet((self.width, height), words.title, words.subtitle, |body| {
            let (top, area) = body.split_vertically(px(strip));
            words.head.draw(&top, self.width)?;
            let mut chart = self.chart(&area)?;
            behind(&mut chart)?;
            draw_some_axes(&mut chart, words.axes, self.has_ordinate)?;
            content(&mut chart)
        })
    }

    fn chart<'a, 'b>(&self, area: &'a Area<'b>) -> Result<Chart<'a, 'b>, String> {
        let x = Axis::new(self.window.x, (self.plot.0 / LABELS[0]) as usize);
        let y = Axis::new(self.window.y, (self.plot.1 / LABELS[1]) as usize);
        ChartBuilder::on(area)
            .margin_top(px(ABOVE))
            .margin_right(px(RIGHT))
            .margin_bottom(px(EDGE))
            .margin_left(px(EDGE))
            .x_label_area_size(px(BELOW))
            .y_label_area_size(px(LEFT))
            .build_cartesian_2d(x, y)
            .map_err(message)
    }

    /// Draws a path.
    ///
    /// # Errors
    /// An error of the drawing library.
    pub fn path(
        &self,
        chart: &mut Chart<'_, '_>,
        points: &[[f64; 2]],
        colour: RGBColor,
    ) -> Result<(), String> {
        let Window { x, y } = self.window;
        let scale = [self.plot.0 / (x[1] - x[0]), self.plot.1 / (y[1] - y[0])];
        let pixels: Vec<[f64; 2]> = points
            .iter()
            .map(|point| [(point[0] - x[0]) * scale[0], (point[1] - y[0]) * scale[1]])
            .collect();
        let kept: Vec<(f64, f64)> = thinned(&pixels, NEAR)
            .into_iter()
            .map(|index| (points[index][0], points[index][1]))
            .collect();
        let style = colour.stroke_width(stroke(1.2));
        let drawn = chart.draw_series([PathElement::new(kept, style)]);
        drawn.map_err(message).map(drop)
    }
}

/// Draws grid, axes and labels.
///
/// # Errors
/// An error of the drawing library.
pub fn draw_axes(chart: &mut Chart<'_, '_>, names: [&str; 2]) -> Result<(), String> {
    draw_some_axes(chart, names, true)
}

/// Draws grid, axes and labels; the y axis only if `has_ordinate`.
fn draw_some_axes(
    chart: &mut Chart<'_, '_>,
    names: [&str; 2],
    has_ordinate: bool,
) -> Result<(), String> {
    let mut mesh = chart.configure_mesh();
    if !has_ordinate {
        mesh.disable_y_mesh().disable_y_axis();
    }
    mesh.x_desc(names[0])
        .y_desc(names[1])
        .max_light_lines(0)
        .bold_line_style(style::GRID.stroke_width(stroke(0.8)))
        .axis_style(style::INK.stroke_width(stroke(0.8)))
        .set_all_tick_mark_size(px(4.0))
        .label_style(text(11.0, style::INK))
        .axis_desc_style(text(13.0, style::INK))
        .draw()
        .map_err(message)
}

/// Number of marks above which those at one place are drawn once.
const MANY: usize = 4096;

/// The place of a mark on a raster of half a pixel.
fn pixel((x, y): (i32, i32)) -> [i32; 2] {
    [x, y].map(|value| value / px(0.5))
}

/// The marks, each place once if there are many.
fn apart<T, K: Eq + Hash>(marks: impl Iterator<Item = T>, place: impl Fn(&T) -> K) -> Vec<T> {
    let mut marks: Vec<T> = marks.collect();
    if marks.len() > MANY {
        let mut seen = HashSet::new();
        marks.retain(|mark| seen.insert(place(mark)));
    }
    marks
}

/// Draws a dashed line between the points of each pair, unless they coincide or are not finite.
///
/// # Errors
/// An error of the drawing library.
pub fn dashes(
    chart: &mut Chart<'_, '_>,
    jumps: impl Iterator<Item = [[f64; 2]; 2]>,
    colour: RGBColor,
) -> Result<(), String> {
    let is_drawn = |ends: &[[f64; 2]; 2]| {
        ends[0] != ends[1] && ends.as_flattened().iter().all(|value| value.is_finite())
    };
    let style = colour.stroke_width(stroke(DASHED));
    let pixels = |[x, y]: [f64; 2]| pixel(chart.backend_coord(&(x, y)));
    let jumps = apart(jumps.filter(is_drawn), |ends| ends.map(pixels));
    let lines = jumps
        .into_iter()
        .map(|ends| PathElement::new(ends.map(|[x, y]| (x, y)), style));
    chart.draw_series(lines).map_err(message).map(drop)
}

/// Draws a dot at each point with finite coordinates.
///
/// # Errors
/// An error of the drawing library.
pub fn dots(
    chart: &mut Chart<'_, '_>,
    points: impl Iterator<Item = ([f64; 2], RGBColor)>,
    radius: f64,
) -> Result<(), String> {
    let finite = points.filter(|(at, _)| at.iter().all(|value| value.is_finite()));
    let pixels = |[x, y]: [f64; 2]| pixel(chart.backend_coord(&(x, y)));
    let points = apart(finite, |(at, colour)| (pixels(*at), colour.rgb()));
    let dots = points
        .into_iter()
        .map(|(at, colour)| Circle::new((at[0], at[1]), px(radius), colour.filled()));
    chart.draw_series(dots).map_err(message).map(drop)
}

/// Draws a ring at the start and a square at the end of a path.
///
/// # Errors
/// An error of the drawing library.
pub fn ends(chart: &mut Chart<'_, '_>, first: [f64; 2], last: [f64; 2]) -> Result<(), String> {
    chart.draw_series([ring(first)]).map_err(message)?;
    let square = Rectangle::new(
        [(px(-3.5), px(-3.5)), (px(3.5), px(3.5))],
        style::INK.filled(),
    );
    let end = EmptyElement::at((last[0], last[1])) + square;
    chart.draw_series([end]).map_err(message).map(drop)
}

/// A ring about a point.
pub fn ring([x, y]: [f64; 2]) -> Circle<(f64, f64), i32> {
    Circle::new((x, y), px(4.5), style::INK.stroke_width(stroke(1.6)))
}

/// A range with the middle of another range and the half length `half`.
pub fn around(range: [f64; 2], half: f64) -> [f64; 2] {
    let middle = 0.5 * (range[0] + range[1]);
    [middle - half, middle + half]
}
