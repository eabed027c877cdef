//! Without a view: all coordinates against time, outputs in a second panel, impacts as vertical lines.

use plotters::element::PathElement;
use plotters::prelude::ChartBuilder;
use plotters::style::Color;

use super::Picture;
use super::canvas::{self, Area, TITLE_HEIGHT, message, px, stroke, text};
use super::legend::{self, Item, Symbol};
use super::style::{self, Axis};
use crate::names;

/// Width of the picture, in pixels.
const WIDTH: f64 = 960.0;

/// Height of a panel's plot, in pixels.
const HEIGHT: f64 = 300.0;

/// Room for axis labels, left and below, and the margins around, in pixels.
const LEFT: f64 = 66.0;
const BELOW: f64 = 40.0;
const EDGE: f64 = 12.0;
const RIGHT: f64 = 28.0;
const ABOVE: f64 = 8.0;

/// Up to this many impacts have a line each over the whole height.
const FEW_IMPACTS: usize = 120;

/// Several curves over the same time.
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

    fn height(&self) -> f64 {
        legend::height(&self.legend, WIDTH) + ABOVE + HEIGHT + BELOW + EDGE
    }
}

/// Draws the histories.
///
/// # Errors
/// What the drawing library says.
pub fn draw(picture: &Picture<'_>) -> Result<String, String> {
    let panels = panels(picture);
    let height = TITLE_HEIGHT + panels.iter().map(Panel::height).sum::<f64>();
    canvas::sheet((WIDTH, height), &picture.title, &picture.subtitle, |body| {
        let mut rest = body;
        for panel in &panels {
            let (area, below) = rest.split_vertically(px(panel.height()));
            draw_panel(&area, picture, panel)?;
            rest = below;
        }
        Ok(())
    })
}

fn panels(picture: &Picture<'_>) -> Vec<Panel> {
    let description = picture.model.description();
    let coordinates: Vec<String> = names::coordinates(&description)
        .map(str::to_owned)
        .collect();
    let outputs: Vec<String> = description
        .outputs
        .iter()
        .map(|&name| name.to_owned())
        .collect();
    let n = coordinates.len();
    let mut panels = vec![Panel::new(coordinates, 0, &impact_items(picture))];
    if !outputs.is_empty() {
        panels.push(Panel::new(outputs, n, &[]));
    }
    panels
}

fn impact_items(picture: &Picture<'_>) -> Vec<Item> {
    let surfaces = picture.model.description().surfaces.iter().enumerate();
    let counted = surfaces.map(|(index, surface)| {
        (
            index,
            surface,
            picture
                .impacts
                .iter()
                .filter(|impact| impact.surface == index)
                .count(),
        )
    });
    counted
        .filter(|(_, _, count)| *count > 0)
        .map(|(index, surface, count)| {
            Item::new(
                Symbol::Tick,
                style::surface(index),
                format!("impact: {} ({count})", surface.name),
            )
        })
        .collect()
}

fn draw_panel(area: &Area<'_>, picture: &Picture<'_>, panel: &Panel) -> Result<(), String> {
    let (strip, plot) = area.split_vertically(px(legend::height(&panel.legend, WIDTH)));
    legend::draw(&strip, &panel.legend, WIDTH)?;
    let marks = picture.trace.points();
    let curves = panel.offset..panel.offset + panel.names.len();
    let values = marks
        .iter()
        .flat_map(|mark| mark.values[curves.clone()].iter().copied());
    let y = Axis::new(style::padded(values, 0.06), 6);
    let end = if picture.last.0 > 0.0 {
        picture.last.0
    } else {
        1.0
    };
    let t = Axis::new([0.0, end], 10);

    let mut chart = ChartBuilder::on(&plot)
        .margin_top(px(ABOVE))
        .margin_right(px(RIGHT))
        .margin_bottom(px(EDGE))
        .x_label_area_size(px(BELOW))
        .y_label_area_size(px(LEFT))
        .build_cartesian_2d(t.range[0]..t.range[1], y.range[0]..y.range[1])
        .map_err(message)?;
    chart
        .configure_mesh()
        .x_desc("t")
        .x_labels(t.labels)
        .y_labels(y.labels)
        .x_label_formatter(&|value| t.label(*value))
        .y_label_formatter(&|value| y.label(*value))
        .max_light_lines(0)
        .bold_line_style(style::GRID.stroke_width(stroke(0.8)))
        .axis_style(style::INK.stroke_width(stroke(0.8)))
        .set_all_tick_mark_size(px(4.0))
        .label_style(text(11.0, style::INK))
        .axis_desc_style(text(13.0, style::INK))
        .draw()
        .map_err(message)?;
    chart
        .draw_series(impact_lines(picture, y.range))
        .map_err(message)?;
    for (index, curve) in curves.enumerate() {
        let points: Vec<(f64, f64)> = marks
            .iter()
            .map(|mark| (mark.t, mark.values[curve]))
            .collect();
        let line = PathElement::new(points, style::curve(index).stroke_width(stroke(1.4)));
        chart.draw_series([line]).map_err(message)?;
    }
    Ok(())
}

/// Impacts as lines behind the curves; where they are many, as marks along the lower edge.
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
    picture.impacts.iter().map(move |impact| {
        let colour = style::surface(impact.surface).mix(if few { 0.45 } else { 0.8 });
        PathElement::new(
            vec![(impact.t, range[0]), (impact.t, top)],
            colour.stroke_width(stroke(0.8)),
        )
    })
}
