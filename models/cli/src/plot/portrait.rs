//! The declared view: the path in the plane of the view, with equal scales on both axes, the region behind it and the
//! impacts on it.

use dalembert::describe::ViewInfo;
use plotters::element::{PathElement, Polygon};
use plotters::prelude::WHITE;
use plotters::style::{Color, RGBColor};

use super::Picture;
use super::canvas::{message, stroke};
use super::contour::{Contour, Window};
use super::plane::{self, Chart, Plane, Words, around};
use super::region::{FINE, Region};
use super::style;
use super::trace::Mark;
use crate::symbols;
use dalembert_driver::padded;

/// Draws the view.
///
/// # Errors
/// An error of the drawing library.
pub fn draw(picture: &Picture<'_>, view: &ViewInfo) -> Result<String, String> {
    let at = |mark: &Mark| [mark.values[0], mark.values[1]];
    let stretches = picture.trace.stretches(at);
    let points = stretches.concat();
    let path = extent(&points);
    let region = Region::of(picture.model, picture.first, picture.last, path);
    let window = region
        .as_ref()
        .map_or(path.grown(0.06), |region| region.window(path));
    let plane = Plane::equal_scales(window, picture.width);
    let boundary = region.map_or_else(Vec::new, |region| region.contours(plane.window, FINE));
    let labels = view.labels.each_ref().map(|label| symbols::text(label));
    let words = Words {
        title: &picture.title,
        subtitle: &picture.subtitle,
        axes: labels.each_ref().map(String::as_str),
        head: &picture.legend("path", style::PATH),
    };
    plane.sheet(
        &words,
        |chart| fill_region(chart, &boundary),
        |chart| {
            draw_boundary(chart, &boundary)?;
            for stretch in &stretches {
                plane.path(chart, stretch, style::PATH)?;
            }
            let jumps = picture.trace.jumps();
            plane::dashes(chart, jumps.map(|ends| ends.map(at)), style::PATH)?;
            let impacts = picture.impacts.iter().filter_map(|impact| {
                let colour = style::surface(impact.surface);
                impact.after.view.map(|at| (at, colour))
            });
            plane::dots(chart, impacts, 2.8)?;
            match points.as_slice() {
                [first, .., last] => plane::ends(chart, *first, *last),
                _ => Ok(()),
            }
        },
    )
}

/// The bounding rectangle of the path, with positive width and height.
pub(super) fn extent(points: &[[f64; 2]]) -> Window {
    let x = padded(points.iter().map(|point| point[0]), 0.0);
    let y = padded(points.iter().map(|point| point[1]), 0.0);
    let tight = Window::around(points.iter().copied());
    // The shorter side of a path along an axis is extended to half of the longer one, so that rounding errors are not
    // magnified.
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

/// Fills the contours from the largest to the smallest, so that inner contours are painted over outer ones.
///
/// # Errors
/// An error of the drawing library.
pub fn fill_region(chart: &mut Chart<'_, '_>, boundary: &[Contour]) -> Result<(), String> {
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

/// Strokes the parts of contours inside the window.
///
/// # Errors
/// An error of the drawing library.
pub fn draw_boundary(chart: &mut Chart<'_, '_>, boundary: &[Contour]) -> Result<(), String> {
    draw_contours(chart, boundary, style::BOUNDARY)
}

/// Strokes the parts of contours inside the window in a colour.
///
/// # Errors
/// An error of the drawing library.
pub fn draw_contours(
    chart: &mut Chart<'_, '_>,
    boundary: &[Contour],
    colour: RGBColor,
) -> Result<(), String> {
    let style = colour.stroke_width(stroke(1.6));
    let elements = boundary
        .iter()
        .flat_map(strokes)
        .filter(|stroke| stroke.len() > 1)
        .map(|points| PathElement::new(points, style));
    chart.draw_series(elements).map_err(message).map(drop)
}

/// The parts of a contour inside the window.
pub(super) fn strokes(contour: &Contour) -> Vec<Vec<(f64, f64)>> {
    let corner = |index: usize| {
        let point = contour.points[index % contour.points.len()];
        (point[0], point[1])
    };
    // The first stroke starts after a side on the frame, so that no stroke is cut in two.
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
    strokes
}
