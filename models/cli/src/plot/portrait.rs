//! The declared view: the path in its plane, with equal scales, the region behind it and impacts on it.

use dalembert::describe::ViewInfo;
use plotters::coord::types::RangedCoordf64;
use plotters::element::{Circle, EmptyElement, PathElement, Polygon, Rectangle};
use plotters::prelude::{Cartesian2d, ChartBuilder, ChartContext, SVGBackend, WHITE};
use plotters::style::{Color, RGBColor};

use super::Picture;
use super::canvas::{self, Area, TITLE_HEIGHT, message, px, stroke, text};
use super::contour::{Contour, Window};
use super::legend::{self, Item, Symbol};
use super::region::Region;
use super::style::{self, Axis};

/// Width of the picture, in pixels.
const WIDTH: f64 = 900.0;

/// Least and greatest height of the plot itself, in pixels.
const HEIGHT: [f64; 2] = [260.0, 780.0];

/// Room for axis labels, left and below, and the margins around, in pixels.
const LEFT: f64 = 62.0;
const BELOW: f64 = 40.0;
const EDGE: f64 = 12.0;
const RIGHT: f64 = 28.0;
const ABOVE: f64 = 10.0;

/// Points nearer to each other than this many pixels are drawn as one.
const NEAR: f64 = 0.3;

type Chart<'a, 'b> = ChartContext<'a, SVGBackend<'b>, Cartesian2d<RangedCoordf64, RangedCoordf64>>;

/// Draws the view.
///
/// # Errors
/// What the drawing library says.
pub fn draw(picture: &Picture<'_>, view: &ViewInfo) -> Result<String, String> {
    let points: Vec<[f64; 2]> = picture
        .trace
        .points()
        .iter()
        .map(|mark| [mark.values[0], mark.values[1]])
        .collect();
    let path = extent(&points);
    let region = Region::of(picture, path);
    let window = region
        .as_ref()
        .map_or(path.grown(0.06), |region| region.window(path));
    let (window, plot) = equal_scales(window);
    let boundary = region.map_or_else(Vec::new, |region| region.contours(window));

    let items = legend_items(picture);
    let strip = legend::height(&items, WIDTH);
    let size = (WIDTH, TITLE_HEIGHT + strip + ABOVE + plot.1 + BELOW + EDGE);
    canvas::sheet(size, &picture.title, &picture.subtitle, |body| {
        let (top, area) = body.split_vertically(px(strip));
        legend::draw(&top, &items, WIDTH)?;
        let mut chart = axes(&area, window, plot, view, &boundary)?;
        draw_path(&mut chart, &points, plot.0 / (window.x[1] - window.x[0]))?;
        draw_marks(&mut chart, picture, &points)
    })
}

/// The path's own rectangle; never without width or height.
fn extent(points: &[[f64; 2]]) -> Window {
    let x = style::padded(points.iter().map(|point| point[0]), 0.0);
    let y = style::padded(points.iter().map(|point| point[1]), 0.0);
    let tight = Window::around(points.iter().copied());
    // A straight path along an axis takes the other side's length, so that it is not magnified into noise.
    let side = |range: [f64; 2]| range[1] - range[0];
    match tight.map(|tight| (side(tight.x), side(tight.y))) {
        Some((w, h)) if w > 0.0 && h < 1e-6 * w => Window {
            x,
            y: around(y, 0.25 * w),
        },
        Some((w, h)) if h > 0.0 && w < 1e-6 * h => Window {
            x: around(x, 0.25 * h),
            y,
        },
        _ => Window { x, y },
    }
}

fn around(range: [f64; 2], half: f64) -> [f64; 2] {
    let middle = 0.5 * (range[0] + range[1]);
    [middle - half, middle + half]
}

/// Widens the window to the shape of a plot, whose size in pixels comes with it.
fn equal_scales(window: Window) -> (Window, (f64, f64)) {
    let (width, height) = (window.x[1] - window.x[0], window.y[1] - window.y[0]);
    let plot_width = WIDTH - EDGE - LEFT - RIGHT;
    let plot_height = (plot_width * height / width)
        .clamp(HEIGHT[0], HEIGHT[1])
        .round();
    let scale = (plot_width / width).min(plot_height / height);
    let x = around(window.x, 0.5 * plot_width / scale);
    let y = around(window.y, 0.5 * plot_height / scale);
    (Window { x, y }, (plot_width, plot_height))
}

fn legend_items(picture: &Picture<'_>) -> Vec<Item> {
    let mut items = vec![
        Item::new(Symbol::Line, style::PATH, "path"),
        Item::new(Symbol::Ring, style::INK, "start"),
        Item::new(Symbol::Square, style::INK, "end"),
    ];
    let surfaces = picture.model.description().surfaces;
    for (index, surface) in surfaces.iter().enumerate() {
        let count = picture
            .impacts
            .iter()
            .filter(|impact| impact.surface == index)
            .count();
        if count > 0 {
            items.push(Item::new(
                Symbol::Dot,
                style::surface(index),
                format!("{} ({count})", surface.name),
            ));
        }
    }
    items
}

/// The region, then grid, axes and labels over it, then the region's boundary.
fn axes<'a, 'b>(
    area: &'a Area<'b>,
    window: Window,
    plot: (f64, f64),
    view: &ViewInfo,
    boundary: &[Contour],
) -> Result<Chart<'a, 'b>, String> {
    let mut chart = ChartBuilder::on(area)
        .margin_top(px(ABOVE))
        .margin_right(px(RIGHT))
        .margin_bottom(px(EDGE))
        .margin_left(px(EDGE))
        .x_label_area_size(px(BELOW))
        .y_label_area_size(px(LEFT))
        .build_cartesian_2d(window.x[0]..window.x[1], window.y[0]..window.y[1])
        .map_err(message)?;
    fill_region(&mut chart, boundary)?;
    let x = Axis::new(window.x, (plot.0 / 90.0) as usize);
    let y = Axis::new(window.y, (plot.1 / 60.0) as usize);
    chart
        .configure_mesh()
        .x_desc(view.labels[0])
        .y_desc(view.labels[1])
        .x_labels(x.labels)
        .y_labels(y.labels)
        .x_label_formatter(&|value| x.label(*value))
        .y_label_formatter(&|value| y.label(*value))
        .max_light_lines(0)
        .bold_line_style(style::GRID.stroke_width(stroke(0.8)))
        .axis_style(style::INK.stroke_width(stroke(0.8)))
        .set_all_tick_mark_size(px(4.0))
        .label_style(text(11.0, style::INK))
        .axis_desc_style(text(13.0, style::INK))
        .draw()
        .map_err(message)?;
    for contour in boundary {
        draw_boundary(&mut chart, contour)?;
    }
    Ok(chart)
}

/// Fills the contours from the largest to the smallest: what lies inside one is painted over it.
fn fill_region(chart: &mut Chart<'_, '_>, boundary: &[Contour]) -> Result<(), String> {
    let mut sorted: Vec<_> = boundary
        .iter()
        .map(|contour| (contour.signed_area(), contour))
        .collect();
    sorted.sort_by(|(first, _), (second, _)| second.abs().total_cmp(&first.abs()));
    let polygons = sorted.into_iter().map(|(area, contour)| {
        let colour = if area > 0.0 { style::REGION } else { WHITE };
        let points: Vec<(f64, f64)> = contour
            .points
            .iter()
            .map(|point| (point[0], point[1]))
            .collect();
        Polygon::new(points, colour.filled())
    });
    chart.draw_series(polygons).map_err(message).map(drop)
}

/// Strokes a contour where it runs inside the window.
fn draw_boundary(chart: &mut Chart<'_, '_>, contour: &Contour) -> Result<(), String> {
    let corner = |index: usize| {
        let point = contour.points[index % contour.points.len()];
        (point[0], point[1])
    };
    // Begin after a side on the frame, so that no stroke is cut in two.
    let count = contour.points.len();
    let begin = (0..count)
        .find(|&index| contour.on_frame[index])
        .map_or(0, |index| index + 1);
    let mut strokes = vec![vec![corner(begin)]];
    for index in begin..begin + count {
        if contour.on_frame[index % count] {
            strokes.push(vec![corner(index + 1)]);
        } else if let Some(stroke) = strokes.last_mut() {
            stroke.push(corner(index + 1));
        }
    }
    let style = style::BOUNDARY.stroke_width(stroke(1.6));
    let elements = strokes
        .into_iter()
        .filter(|stroke| stroke.len() > 1)
        .map(|points| PathElement::new(points, style));
    chart.draw_series(elements).map_err(message).map(drop)
}

fn draw_path(chart: &mut Chart<'_, '_>, points: &[[f64; 2]], scale: f64) -> Result<(), String> {
    let mut kept: Vec<(f64, f64)> = Vec::new();
    for &[x, y] in points {
        let far = kept
            .last()
            .is_none_or(|last| (x - last.0).hypot(y - last.1) * scale >= NEAR);
        if far {
            kept.push((x, y));
        }
    }
    let style = style::PATH.stroke_width(stroke(1.2));
    chart
        .draw_series([PathElement::new(kept, style)])
        .map_err(message)
        .map(drop)
}

fn draw_marks(
    chart: &mut Chart<'_, '_>,
    picture: &Picture<'_>,
    points: &[[f64; 2]],
) -> Result<(), String> {
    let impacts = picture
        .impacts
        .iter()
        .filter_map(|impact| impact.after.view.map(|at| (impact.surface, at)));
    let dots = impacts
        .filter(|(_, at)| at.iter().all(|value| value.is_finite()))
        .map(|(surface, at)| {
            Circle::new((at[0], at[1]), px(2.8), style::surface(surface).filled())
        });
    chart.draw_series(dots).map_err(message)?;
    let (Some(first), Some(last)) = (points.first(), points.last()) else {
        return Ok(());
    };
    let ring = Circle::new(
        (first[0], first[1]),
        px(4.5),
        style::INK.stroke_width(stroke(1.6)),
    );
    chart.draw_series([ring]).map_err(message)?;
    let square = |colour: RGBColor| {
        Rectangle::new([(px(-3.5), px(-3.5)), (px(3.5), px(3.5))], colour.filled())
    };
    let end = EmptyElement::at((last[0], last[1])) + square(style::INK);
    chart.draw_series([end]).map_err(message).map(drop)
}
