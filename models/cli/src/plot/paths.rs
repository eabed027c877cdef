//! Several motions in one picture, with a panel for each ordinate and a colour for each number of impacts. Dots mark
//! the states before impacts, dashes the jumps, rings the starts and squares the ends.

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

/// Successive points, each with its quantities: the abscissa, then the ordinates.
pub type Stretch = Vec<Vec<f64>>;

/// A motion.
#[derive(Debug, Clone)]
pub struct Path {
    /// Its number of impacts.
    pub impacts: usize,
    /// The stretches between its impacts.
    pub stretches: Vec<Stretch>,
}

impl Path {
    fn points(&self) -> impl Iterator<Item = &Vec<f64>> {
        self.stretches.iter().flatten()
    }

    /// The points on both sides of its impacts.
    fn impacts(&self) -> impl Iterator<Item = [&Vec<f64>; 2]> {
        let pairs = self.stretches.windows(2);
        pairs.filter_map(|pair| Some([pair[0].last()?, pair[1].first()?]))
    }
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
    let mut values = sheet.paths.iter().flat_map(|path| path.points().flatten());
    if values.any(|value| value.abs() > LARGEST) {
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
    let points = paths.iter().flat_map(Path::points);
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
        let colour = style::curve(path.impacts);
        for stretch in &path.stretches {
            let points: Vec<[f64; 2]> = stretch.iter().map(at).collect();
            let line = PathElement::new(line(&points, scale), colour.stroke_width(stroke(1.4)));
            chart.draw_series([line]).map_err(message)?;
        }
        let jumps = path.impacts().map(|sides| sides.map(at));
        plane::dashes(&mut chart, jumps, colour)?;
        let corners = path.impacts().map(|[before, _]| (at(before), colour));
        plane::dots(&mut chart, corners, 3.0)?;
    }
    let points = sheet.envelope.iter();
    let points = points.map(|(impacts, point)| (at(point), style::curve(*impacts)));
    plane::dots(&mut chart, points, 1.4)?;
    let ends = paths
        .iter()
        .filter_map(|path| Some((path.points().next()?, path.points().last()?)));
    for (first, last) in ends {
        plane::ends(&mut chart, at(first), at(last))?;
    }
    Ok(())
}

/// The points of a line that remain after thinning; `scale` is in pixels per unit.
fn line(points: &[[f64; 2]], scale: [f64; 2]) -> Vec<(f64, f64)> {
    let pixels: Vec<[f64; 2]> = points
        .iter()
        .map(|[x, y]| [x * scale[0], y * scale[1]])
        .collect();
    let kept = thinned(&pixels, NEAR).into_iter();
    kept.map(|index| (points[index][0], points[index][1]))
        .collect()
}
