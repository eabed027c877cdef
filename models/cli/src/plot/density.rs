//! A density as a colour map with axes and a colour bar.

use plotters::element::{PathElement, Rectangle};
use plotters::prelude::ChartBuilder;
use plotters::style::{Color, RGBColor};

use super::canvas::{self, Area, TITLE_HEIGHT, message, px, stroke, text};
use super::colours;
use super::plane::{self, Chart};
use super::style::{self, Axis};
use crate::symbols;
use dalembert_driver::ensemble::density::Density;

/// Width of the picture, in pixels.
const WIDTH: f64 = 900.0;

/// Least and greatest height of the map, in pixels.
const HEIGHT: [f64; 2] = [260.0, 760.0];

/// Room for axis labels, left and below, for the colour bar, and the margins around, in pixels.
const LEFT: f64 = 62.0;
const BELOW: f64 = 40.0;
const BAR: f64 = 100.0;
const EDGE: f64 = 12.0;
const ABOVE: f64 = 10.0;

/// Width of the colour bar, in pixels.
const BAR_WIDTH: f64 = 16.0;

/// Number of distinct colours.
const LEVELS: usize = 64;

/// Draws the counts of all cells as a density, under a title and a subtitle. Cells without a count stay white.
///
/// # Errors
/// An error of the drawing library.
pub fn draw(
    density: &Density,
    counts: &[u64],
    (title, subtitle): (&str, &str),
) -> Result<String, String> {
    let [x, y] = &density.axes;
    let span = |range: [f64; 2]| range[1] - range[0];
    let room = WIDTH - EDGE - LEFT - BAR;
    // Sides of similar length have equal scales; other sides fill the sheet.
    let ratio = span(y.range) / span(x.range);
    let is_alike = (0.2..=5.0).contains(&ratio);
    let height = match is_alike {
        true => (room * ratio).clamp(HEIGHT[0], HEIGHT[1]),
        false => 0.6 * room,
    };
    let width = match is_alike {
        true => (height / ratio).min(room),
        false => room,
    };
    let scale = Scale::of(density, counts);
    let size = (WIDTH, TITLE_HEIGHT + ABOVE + height + BELOW + EDGE);
    let mut cells = String::new();
    let svg = canvas::sheet(size, title, subtitle, |body| {
        let right = WIDTH - EDGE - LEFT - width;
        let mut chart = axes(&body, density, right)?;
        cells = paths(&chart, density, counts, &scale);
        bar(&body, &scale, [EDGE + LEFT + width, height])?;
        frame(&mut chart, density)
    })?;
    // NOTE: one path per colour, as text: the drawing library would write an element of a hundred bytes for every cell.
    let end = svg.rfind("</svg>").unwrap_or(svg.len());
    Ok(format!("{}{cells}{}", &svg[..end], &svg[end..]))
}

/// Scale of colours for densities.
struct Scale {
    /// The density of the last colour.
    top: f64,
    /// True if some densities exceed it.
    is_clipped: bool,
    /// The density of one count.
    unit: f64,
    /// True if some cells have no count.
    has_gaps: bool,
}

impl Scale {
    /// A scale that ends at the largest density. If a few cells far exceed the others, it ends at the density that 199
    /// of 200 non-empty cells do not exceed.
    fn of(density: &Density, counts: &[u64]) -> Self {
        let all: u64 = counts.iter().sum();
        let unit = 1.0 / (all.max(1) as f64 * density.cell_area());
        let mut sorted: Vec<u64> = counts.iter().copied().filter(|&count| count > 0).collect();
        sorted.sort_unstable();
        let largest = sorted.last().copied().unwrap_or(1);
        let usual = sorted
            .get(sorted.len() * 199 / 200)
            .copied()
            .unwrap_or(largest);
        let is_clipped = largest > 4 * usual;
        let top = if is_clipped { usual } else { largest };
        Self {
            top: top as f64 * unit,
            is_clipped,
            unit,
            has_gaps: sorted.len() < counts.len(),
        }
    }

    fn level(&self, count: u64) -> usize {
        let part = count as f64 * self.unit / self.top;
        ((part * LEVELS as f64) as usize).min(LEVELS - 1)
    }
}

/// The colour of a level.
fn colour(level: usize) -> RGBColor {
    colours::colour(level as f64 / (LEVELS - 1) as f64)
}

fn axes<'a, 'b>(
    area: &'a Area<'b>,
    density: &Density,
    right: f64,
) -> Result<Chart<'a, 'b>, String> {
    let [x, y] = &density.axes;
    let mut chart = ChartBuilder::on(area)
        .margin_top(px(ABOVE))
        .margin_right(px(right))
        .margin_bottom(px(EDGE))
        .margin_left(px(EDGE))
        .x_label_area_size(px(BELOW))
        .y_label_area_size(px(LEFT))
        .build_cartesian_2d(Axis::new(x.range, 8), Axis::new(y.range, 8))
        .map_err(message)?;
    let names = [x, y].map(|axis| symbols::text(&axis.name));
    plane::draw_axes(&mut chart, names.each_ref().map(String::as_str))?;
    Ok(chart)
}

/// Draws a line around the map.
fn frame(chart: &mut Chart<'_, '_>, density: &Density) -> Result<(), String> {
    let [[left, right], [bottom, top]] = density.axes.each_ref().map(|axis| axis.range);
    let line = vec![(left, top), (right, top), (right, bottom)];
    let element = PathElement::new(line, style::INK.stroke_width(stroke(0.8)));
    chart.draw_series([element]).map_err(message).map(drop)
}

/// The cells as SVG paths, one per colour. Neighbours of the same colour along x form one rectangle.
fn paths(chart: &Chart<'_, '_>, density: &Density, counts: &[u64], scale: &Scale) -> String {
    let [x, y] = &density.axes;
    let mut levels = vec![String::new(); LEVELS];
    for (j, row) in counts.chunks(x.bins).enumerate() {
        let mut from = 0;
        while from < x.bins {
            let level = |i: usize| (row[i] > 0).then(|| scale.level(row[i]));
            let shade = level(from);
            let to = (from..x.bins)
                .find(|&i| level(i) != shade)
                .unwrap_or(x.bins);
            if let Some(shade) = shade {
                let (left, bottom) = chart.backend_coord(&(x.edge(from), y.edge(j)));
                let (right, top) = chart.backend_coord(&(x.edge(to), y.edge(j + 1)));
                levels[shade] += &format!("M{left} {top}H{right}V{bottom}H{left}z");
            }
            from = to;
        }
    }
    let drawn = levels
        .iter()
        .enumerate()
        .filter(|(_, path)| !path.is_empty());
    drawn
        .map(|(level, path)| {
            let RGBColor(r, g, b) = colour(level);
            format!(
                "<path shape-rendering=\"crispEdges\" fill=\"#{r:02X}{g:02X}{b:02X}\" d=\"{path}\"/>\n"
            )
        })
        .collect()
}

/// The colour bar to the right of the map, with densities beside it.
fn bar(area: &Area<'_>, scale: &Scale, [left, height]: [f64; 2]) -> Result<(), String> {
    let left = left + 18.0;
    let at = |x: f64, part: f64| (px(left + x), px(ABOVE + height * (1.0 - part)));
    for level in 0..LEVELS {
        // Every stripe extends to the top, and the next one covers it. This avoids visible seams.
        let corners = [at(0.0, 1.0), at(BAR_WIDTH, level as f64 / LEVELS as f64)];
        area.draw(&Rectangle::new(corners, colour(level).filled()))
            .map_err(message)?;
    }
    let write = |words: &str, (x, y): (i32, i32)| {
        area.draw_text(words, &text(11.0, style::INK), (x, y - px(5.0)))
            .map_err(message)
    };
    let axis = Axis::new([0.0, scale.top], 6);
    for value in axis.ticks() {
        let place = at(BAR_WIDTH + 5.0, value / scale.top);
        write(&axis.label(value), place)?;
    }
    if scale.is_clipped {
        write("and more", at(0.0, 1.0 + 8.0 / height))?;
    }
    if scale.has_gaps {
        write("white: none", at(0.0, -28.0 / height))?;
    }
    write("density", at(0.0, -14.0 / height))
}
