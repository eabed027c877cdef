//! Curves on two logarithmic axes. Power laws are straight lines on them; each curve may show its fitted exponent.

use plotters::element::{Circle, PathElement};
use plotters::prelude::{ChartBuilder, IntoLogRange};
use plotters::style::Color;

use super::canvas::{self, TITLE_HEIGHT, message, px, stroke, text};
use super::legend::{self, Item, Symbol};
use super::style;
use crate::suite::Curve;

/// Width of the picture and height of its plot, in pixels.
const WIDTH: f64 = 760.0;
const HEIGHT: f64 = 300.0;

/// Room for axis labels, and the margins around, in pixels.
const LABELS: f64 = 64.0;
const EDGE: f64 = 14.0;

/// Draws curves with common axes, with the exponent of each in the legend.
///
/// # Errors
/// An error of the drawing library.
pub fn draw(title: &str, subtitle: &str, curves: &[Curve]) -> Result<String, String> {
    let labels: Vec<String> = curves
        .iter()
        .map(|curve| label(curve, &drawable(curve)))
        .collect();
    draw_labelled((title, subtitle), curves, &labels, &[])
}

/// Draws curves with common axes under these labels, with rings around some points.
///
/// # Errors
/// An error of the drawing library.
pub fn draw_labelled(
    (title, subtitle): (&str, &str),
    curves: &[Curve],
    labels: &[String],
    rings: &[[f64; 2]],
) -> Result<String, String> {
    let drawn: Vec<Vec<[f64; 2]>> = curves.iter().map(drawable).collect();
    let items: Vec<Item> = labels
        .iter()
        .enumerate()
        .map(|(index, label)| Item::new(Symbol::Line, style::curve(index), label.as_str()))
        .collect();
    let strip = legend::height(&items, WIDTH);
    let size = (WIDTH, TITLE_HEIGHT + strip + HEIGHT);
    let axes = curves.first().map_or(["", ""], |curve| curve.axes);
    let ranges = [0, 1].map(|axis| range(drawn.iter().flatten().map(|point| point[axis])));
    canvas::sheet(size, title, subtitle, |body| {
        let (head, plot) = body.split_vertically(px(strip));
        legend::draw(&head, &items, WIDTH)?;
        let mut chart = ChartBuilder::on(&plot)
            .margin(px(EDGE))
            .x_label_area_size(px(LABELS))
            .y_label_area_size(px(LABELS))
            .build_cartesian_2d(
                (ranges[0][0]..ranges[0][1]).log_scale(),
                (ranges[1][0]..ranges[1][1]).log_scale(),
            )
            .map_err(message)?;
        chart
            .configure_mesh()
            .x_desc(axes[0])
            .y_desc(axes[1])
            .x_label_formatter(&|value| format!("{value:.0e}"))
            .y_label_formatter(&|value| format!("{value:.0e}"))
            .max_light_lines(0)
            .bold_line_style(style::GRID.stroke_width(stroke(0.8)))
            .axis_style(style::INK.stroke_width(stroke(0.8)))
            .label_style(text(11.0, style::INK))
            .axis_desc_style(text(13.0, style::INK))
            .draw()
            .map_err(message)?;
        for (index, points) in drawn.iter().enumerate() {
            let colour = style::curve(index);
            let points: Vec<(f64, f64)> = points.iter().map(|&[x, y]| (x, y)).collect();
            let marks = points
                .iter()
                .map(|&point| Circle::new(point, px(2.0), colour.filled()));
            chart.draw_series(marks).map_err(message)?;
            let line = PathElement::new(points.clone(), colour.stroke_width(stroke(1.4)));
            chart.draw_series([line]).map_err(message)?;
        }
        let rings = rings
            .iter()
            .map(|&[x, y]| Circle::new((x, y), px(6.0), style::INK.stroke_width(stroke(1.2))));
        chart.draw_series(rings).map_err(message)?;
        Ok(())
    })
}

/// The points with positive finite coordinates, which have logarithms.
fn drawable(curve: &Curve) -> Vec<[f64; 2]> {
    let exists = |point: &[f64; 2]| point.iter().all(|value| *value > 0.0 && value.is_finite());
    curve.points.iter().copied().filter(exists).collect()
}

fn label(curve: &Curve, points: &[[f64; 2]]) -> String {
    match exponent(points) {
        Some(exponent) => format!("{} (exponent {exponent:.2})", curve.name),
        None => curve.name.clone(),
    }
}

/// The exponent of the power law fitted to positive points by least squares on their logarithms; `None` for fewer than
/// three points.
pub fn exponent(points: &[[f64; 2]]) -> Option<f64> {
    let count = points.len() as f64;
    let mean = |axis: usize| points.iter().map(|point| point[axis].ln()).sum::<f64>() / count;
    let (x, y) = (mean(0), mean(1));
    let spread: f64 = points.iter().map(|point| (point[0].ln() - x).powi(2)).sum();
    let common: f64 = points
        .iter()
        .map(|point| (point[0].ln() - x) * (point[1].ln() - y))
        .sum();
    (points.len() >= 3 && spread > 0.0).then_some(common / spread)
}

/// The range of whole decades around the values.
fn range(values: impl Iterator<Item = f64>) -> [f64; 2] {
    let (low, high) = values.fold((f64::INFINITY, 0.0_f64), |(low, high), value| {
        (low.min(value), high.max(value))
    });
    if low > high {
        return [0.1, 10.0];
    }
    [
        10f64.powf(low.log10().floor()),
        10f64.powf(high.log10().floor() + 1.0),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn powers_have_their_exponents() {
        let points: Vec<[f64; 2]> = (1..9)
            .map(|k| [f64::from(k), 3.0 * f64::from(k).sqrt()])
            .collect();
        assert!((exponent(&points).unwrap_or(0.0) - 0.5).abs() < 1e-12);
        assert_eq!(exponent(&points[..2]), None);
    }

    #[test]
    fn curves_without_positive_points_are_drawn_empty() {
        let curve = Curve {
            name: "nothing".to_owned(),
            axes: ["n", "error"],
            points: vec![[1.0, 0.0], [0.0, 1.0]],
        };
        assert!(draw("title", "", &[curve]).is_ok());
    }
}
