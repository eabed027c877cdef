//! Several motions in one picture: a panel for each ordinate, a colour for each number of impacts, dots at the impacts, a
//! ring at the start and a square at the end.

use plotters::element::PathElement;
use plotters::prelude::ChartBuilder;
use plotters::style::Color;

use super::LARGEST;
use super::canvas::{self, Area, TITLE_HEIGHT, message, px, stroke};
use super::legend::{self, Item, Symbol};
use super::plane;
use super::style::{self, Axis};
use super::thin::thinned;
use dalembert_driver::padded;

/// Height of a panel's plot as a fraction of the picture's width.
const HEIGHT: f64 = 0.42;

/// Room for axis labels, left and below, and the margins around, in pixels.
const LEFT: f64 = 66.0;
const BELOW: f64 = 40.0;
const EDGE: f64 = 12.0;
const RIGHT: f64 = 28.0;
const ABOVE: f64 = 8.0;

/// Tolerance in pixels for omitted points of a line.
const NEAR: f64 = 0.12;

/// A motion.
#[derive(Debug, Clone)]
pub struct Path {
    /// Its number of impacts.
    pub impacts: usize,
    /// The quantities of its points: the abscissa, then the ordinates.
    pub points: Vec<Vec<f64>>,
    /// The same before its impacts.
    pub corners: Vec<Vec<f64>>,
}

/// Content of a picture.
#[derive(Debug)]
pub struct Sheet<'a> {
    /// First line of the title.
    pub title: &'a str,
    /// Second line of the title.
    pub subtitle: &'a str,
    /// The names of the quantities: the abscissa, then the ordinates.
    pub names: Vec<String>,
    /// Its width, in pixels.
    pub width: f64,
    /// The motions.
    pub paths: &'a [Path],
    /// Points of the envelope: the number of impacts before each, and its quantities.
    pub envelope: &'a [(usize, Vec<f64>)],
}

/// Draws the picture.
///
/// # Errors
/// An error of the drawing library, or values too large to draw.
pub fn draw(sheet: &Sheet<'_>) -> Result<String, String> {
    let values = sheet
        .paths
        .iter()
        .flat_map(|path| path.points.iter().flatten());
    if values.clone().any(|value| value.abs() > LARGEST) {
        return Err(format!(
            "a motion has values beyond {LARGEST:e}, which cannot be drawn"
        ));
    }
    let items = items(sheet);
    let strip = legend::height(&items, sheet.width);
    let panel = ABOVE + plot_height(sheet.width) + BELOW + EDGE;
    let panels = sheet.names.len() - 1;
    let size = (sheet.width, TITLE_HEIGHT + strip + panel * panels as f64);
    canvas::sheet(size, sheet.title, sheet.subtitle, |body| {
        let (top, mut rest) = body.split_vertically(px(strip));
        legend::draw(&top, &items, sheet.width)?;
        for ordinate in 1..=panels {
            let (area, below) = rest.split_vertically(px(panel));
            draw_panel(&area, sheet, ordinate)?;
            rest = below;
        }
        Ok(())
    })
}

fn plot_height(width: f64) -> f64 {
    (HEIGHT * width).round()
}

/// The legend, with a line for each number of impacts.
fn items(sheet: &Sheet<'_>) -> Vec<Item> {
    let mut items = Vec::new();
    for group in sheet
        .paths
        .chunk_by(|left, right| left.impacts == right.impacts)
    {
        let plural = if group[0].impacts == 1 { "" } else { "s" };
        let label = format!("{} impact{plural} ({})", group[0].impacts, group.len());
        items.push(Item::new(
            Symbol::Line,
            style::curve(group[0].impacts),
            label,
        ));
    }
    items.push(Item::new(Symbol::Ring, style::INK, "start"));
    items.push(Item::new(Symbol::Square, style::INK, "end"));
    items.push(Item::new(Symbol::Dot, style::INK, "impact"));
    if !sheet.envelope.is_empty() {
        items.push(Item::new(
            Symbol::Dot,
            style::FAINT_INK,
            "small: conjugate point of another start",
        ));
    }
    items
}

fn range(paths: &[Path], index: usize, margin: f64) -> [f64; 2] {
    let points = paths.iter().flat_map(|path| &path.points);
    padded(points.map(|point| point[index]), margin)
}

fn draw_panel(area: &Area<'_>, sheet: &Sheet<'_>, ordinate: usize) -> Result<(), String> {
    let (width, paths) = (sheet.width, sheet.paths);
    let x = Axis::new(range(paths, 0, 0.02), (width / 80.0) as usize);
    let y = Axis::new(range(paths, ordinate, 0.06), 6);
    let scale = [
        width / (x.range[1] - x.range[0]),
        plot_height(width) / (y.range[1] - y.range[0]),
    ];
    let mut chart = ChartBuilder::on(area)
        .margin_top(px(ABOVE))
        .margin_right(px(RIGHT))
        .margin_bottom(px(EDGE))
        .x_label_area_size(px(BELOW))
        .y_label_area_size(px(LEFT))
        .build_cartesian_2d(x, y)
        .map_err(message)?;
    plane::draw_axes(&mut chart, [&sheet.names[0], &sheet.names[ordinate]])?;
    let at = |point: &Vec<f64>| [point[0], point[ordinate]];
    for path in paths {
        let points: Vec<[f64; 2]> = path.points.iter().map(at).collect();
        let pixels: Vec<[f64; 2]> = points
            .iter()
            .map(|[x, y]| [x * scale[0], y * scale[1]])
            .collect();
        let kept = thinned(&pixels, NEAR).into_iter();
        let line: Vec<(f64, f64)> = kept
            .map(|index| (points[index][0], points[index][1]))
            .collect();
        let colour = style::curve(path.impacts);
        let element = PathElement::new(line, colour.stroke_width(stroke(1.4)));
        chart.draw_series([element]).map_err(message)?;
        let corners = path.corners.iter().map(|corner| (at(corner), colour));
        plane::dots(&mut chart, corners, 3.0)?;
    }
    let points = sheet.envelope.iter();
    let points = points.map(|(impacts, point)| (at(point), style::curve(*impacts)));
    plane::dots(&mut chart, points, 1.4)?;
    let ends = paths
        .iter()
        .filter_map(|path| Some((path.points.first()?, path.points.last()?)));
    for (first, last) in ends {
        plane::ends(&mut chart, at(first), at(last))?;
    }
    Ok(())
}
