//! Quantities against time, with impacts as vertical lines. By default one panel shows all coordinates and a second one
//! the outputs.

use std::collections::BTreeMap;

use plotters::element::PathElement;
use plotters::prelude::ChartBuilder;
use plotters::style::{Color, RGBColor};

use super::Picture;
use super::canvas::{self, Area, TITLE_HEIGHT, message, px, stroke};
use super::legend::{self, Item, Symbol};
use super::plane::{self, Chart};
use super::quantity::Quantity;
use super::style::{self, Axis};
use super::thin::thinned;
use super::trace::{Source, Trace};
use crate::{names, symbols};
use dalembert_driver::padded;

/// Height of a panel's plot as a fraction of the picture's width, and least height in pixels.
const HEIGHT: f64 = 0.32;
const LEAST_HEIGHT: f64 = 240.0;

/// Room for axis labels, left and below, and the margins around, in pixels.
const LEFT: f64 = 66.0;
const BELOW: f64 = 40.0;
const EDGE: f64 = 12.0;
const RIGHT: f64 = 28.0;
const ABOVE: f64 = 8.0;

/// Largest number of impacts that are drawn as lines over the whole height.
const FEW_IMPACTS: usize = 120;

/// Tolerance in pixels for omitted points of a line.
const NEAR: f64 = 0.12;

/// Several curves over a common time axis.
struct Panel {
    names: Vec<String>,
    /// Index of the first curve among a mark's values.
    offset: usize,
    legend: Vec<Item>,
}

impl Panel {
    fn new(names: Vec<String>, offset: usize, impacts: &[Item]) -> Self {
        let curves = names.iter().enumerate();
        let mut legend: Vec<Item> = curves
            .map(|(index, name)| Item::new(Symbol::Line, style::curve(index), name.as_str()))
            .collect();
        legend.extend_from_slice(impacts);
        Self {
            names,
            offset,
            legend,
        }
    }

    fn height(&self, width: f64) -> f64 {
        legend::height(&self.legend, width) + ABOVE + plot_height(width) + BELOW + EDGE
    }
}

fn plot_height(width: f64) -> f64 {
    (HEIGHT * width).max(LEAST_HEIGHT).round()
}

/// Draws the panels.
///
/// # Errors
/// An error of the drawing library.
pub fn draw(picture: &Picture<'_>) -> Result<String, String> {
    let (panels, width) = (panels(picture), picture.width);
    let heights = panels.iter().map(|panel| panel.height(width));
    let size = (width, TITLE_HEIGHT + heights.sum::<f64>());
    canvas::sheet(size, &picture.title, &picture.subtitle, |body| {
        let mut rest = body;
        for panel in &panels {
            let (area, below) = rest.split_vertically(px(panel.height(width)));
            draw_panel(&area, picture, panel)?;
            rest = below;
        }
        Ok(())
    })
}

fn panels(picture: &Picture<'_>) -> Vec<Panel> {
    let description = picture.model.description();
    let impacts = impact_items(picture);
    if let Source::Quantities(quantities) = picture.trace.source() {
        let name = |quantity: &Quantity| quantity.label(description);
        let names = quantities.iter().skip(1).map(name).collect();
        return vec![Panel::new(names, 1, &impacts)];
    }
    let coordinates: Vec<String> = names::coordinates(description).map(symbols::text).collect();
    let outputs: Vec<String> = description
        .outputs
        .iter()
        .map(|&name| name.replace('_', " "))
        .collect();
    let n = coordinates.len();
    let mut panels = vec![Panel::new(coordinates, 0, &impacts)];
    if !outputs.is_empty() {
        panels.push(Panel::new(outputs, n, &[]));
    }
    panels
}

fn impact_items(picture: &Picture<'_>) -> Vec<Item> {
    let counted = picture.impacts_by_surface();
    counted
        .map(|(index, name, count)| {
            Item::new(
                Symbol::Tick,
                style::surface(index),
                format!("impact: {name} ({count})"),
            )
        })
        .collect()
}

fn draw_panel(area: &Area<'_>, picture: &Picture<'_>, panel: &Panel) -> Result<(), String> {
    let width = picture.width;
    let (strip, plot) = area.split_vertically(px(legend::height(&panel.legend, width)));
    legend::draw(&strip, &panel.legend, width)?;
    let marks = picture.trace.points();
    let curves = panel.offset..panel.offset + panel.names.len();
    let values = marks
        .iter()
        .flat_map(|mark| mark.values[curves.clone()].iter().copied());
    let y = Axis::new(padded(values, 0.06), 6);
    let end = if picture.last.0 > 0.0 {
        picture.last.0
    } else {
        1.0
    };
    let t = Axis::new([0.0, end], (width / 80.0) as usize);
    let scale = [width / end, plot_height(width) / (y.range[1] - y.range[0])];

    let mut chart = ChartBuilder::on(&plot)
        .margin_top(px(ABOVE))
        .margin_right(px(RIGHT))
        .margin_bottom(px(EDGE))
        .x_label_area_size(px(BELOW))
        .y_label_area_size(px(LEFT))
        .build_cartesian_2d(t, y)
        .map_err(message)?;
    plane::draw_axes(&mut chart, ["t", ""])?;
    chart
        .draw_series(impact_lines(picture, y.range))
        .map_err(message)?;
    for (index, curve) in curves.enumerate() {
        draw_jumps(&mut chart, picture.trace, curve, style::curve(index))?;
        let stretches = picture.trace.stretches(|mark| [mark.t, mark.values[curve]]);
        let lines = stretches.iter().map(|points| {
            let pixel = |[t, value]: &[f64; 2]| [t * scale[0], (value - y.range[0]) * scale[1]];
            let pixels: Vec<[f64; 2]> = points.iter().map(pixel).collect();
            let kept = thinned(&pixels, NEAR).into_iter();
            let kept: Vec<(f64, f64)> = kept.map(|index| points[index].into()).collect();
            PathElement::new(kept, style::curve(index).stroke_width(stroke(1.4)))
        });
        chart.draw_series(lines).map_err(message)?;
    }
    Ok(())
}

/// Draws the jumps of a curve, dashed.
fn draw_jumps(
    chart: &mut Chart<'_, '_>,
    trace: &Trace,
    curve: usize,
    colour: RGBColor,
) -> Result<(), String> {
    let jumps = trace
        .jumps()
        .map(|ends| ends.map(|mark| [mark.t, mark.values[curve]]));
    plane::dashes(chart, jumps, colour)
}

/// Draws impacts as lines behind the curves; many impacts as marks along the lower edge.
fn impact_lines(
    picture: &Picture<'_>,
    range: [f64; 2],
) -> impl Iterator<Item = PathElement<(f64, f64)>> {
    let few = picture.impacts.len() <= FEW_IMPACTS;
    let top = if few {
        range[1]
    } else {
        range[0] + 0.04 * (range[1] - range[0])
    };
    // Impacts within a quarter of a pixel are drawn once.
    let raster = 4.0 * picture.width / picture.last.0;
    let mut drawn: BTreeMap<usize, i64> = BTreeMap::new();
    let shown = picture.impacts.iter().filter(move |impact| {
        let place = (impact.t * raster) as i64;
        drawn.insert(impact.surface, place) != Some(place)
    });
    shown.map(move |impact| {
        let colour = style::surface(impact.surface).mix(if few { 0.45 } else { 0.8 });
        PathElement::new(
            vec![(impact.t, range[0]), (impact.t, top)],
            colour.stroke_width(stroke(0.8)),
        )
    })
}
