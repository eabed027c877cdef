//! A map of cells, coloured by class or by a number, with axes, a legend and contour lines on top.

use plotters::style::RGBColor;

use super::bar::{self, Bar};
use super::canvas::{Area, px};
use super::contour::{Window, contours};
use super::image;
use super::legend::{Item, Symbol};
use super::plane::{self, Head, Plane, Words};
use super::portrait::draw_contours;
use super::style::{self, PALETTE};
use crate::map::request::{Colours, Request};
use crate::map::{Cells, Sums};
use crate::symbols;
use dalembert_driver::ensemble::Quantity;
use dalembert_driver::padded;

/// Width of the picture, in pixels.
const WIDTH: f64 = 560.0;

/// Radius of the dot of a cell, in pixels, and the margin around all dots as a fraction of their range.
const DOT: f64 = 1.5;
const DOTS_ROOM: f64 = 0.04;

/// Fraction of the numbers below the colour scale, and fraction above it.
const BEYOND: f64 = 0.005;

/// Colours of classes, in the order of the legend.
const CLASSES: [RGBColor; 6] = [
    PALETTE[0], PALETTE[2], PALETTE[3], PALETTE[5], PALETTE[4], PALETTE[7],
];

/// Classes that have the same colour in every map.
const FIXED: [(&str, RGBColor); 3] = [
    ("failed at once", PALETTE[1]),
    ("failed", RGBColor(206, 210, 216)),
    ("unsettled", PALETTE[6]),
];

/// Colours of contour lines.
const LINES: [RGBColor; 4] = [RGBColor(0, 160, 60), style::INK, PALETTE[3], PALETTE[4]];

/// Largest number of classes that are coloured: as many as the palette has room for.
const MOST: usize = 255;

/// Largest number of orbits whose returns are marked.
const MARKED: usize = 8;

/// A varied quantity along an axis.
#[derive(Debug, Clone)]
pub struct Axis {
    /// Its name.
    pub name: String,
    /// The quantity.
    pub quantity: Quantity,
    /// Its first and last value.
    pub ends: [f64; 2],
    /// Number of values.
    pub count: usize,
}

impl Axis {
    /// The range that the cells cover: each cell extends by half a step to both sides of its value.
    fn range(&self) -> [f64; 2] {
        let half = 0.5 * (self.ends[1] - self.ends[0]) / (self.count - 1) as f64;
        [self.ends[0] - half, self.ends[1] + half]
    }

    /// The index of the quantity among the components of a state; `None` for a parameter.
    fn component(&self, request: &Request) -> Option<usize> {
        let components = &request.components;
        let index = match self.quantity {
            Quantity::Position(index) => index,
            Quantity::Velocity(index) => components.coordinates() + index,
            Quantity::Parameter(_) => return None,
        };
        (index < components.names.len()).then_some(index)
    }
}

/// A map to be drawn.
pub struct Chart<'a> {
    /// First line of the title.
    pub title: &'a str,
    /// Second line of the title.
    pub subtitle: &'a str,
    /// One axis or two.
    pub axes: &'a [Axis],
    /// The request for every run.
    pub request: &'a Request,
    /// Sums over all cells.
    pub sums: &'a Sums,
    /// The data of each cell.
    pub cells: &'a Cells,
}

/// Draws the map.
///
/// # Errors
/// An error of the drawing library.
pub fn draw(chart: &Chart<'_>) -> Result<String, String> {
    let painted = chart.painted();
    if let Some(names) = &chart.request.plane {
        return chart.draw_ends(&painted, names);
    }
    let (x, y) = (&chart.axes[0], chart.axes.get(1));
    let window = Window {
        x: x.range(),
        y: y.map_or([0.0, 1.0], Axis::range),
    };
    let plane = match y {
        Some(_) => Plane::free_scales(window, WIDTH),
        None => Plane::strip(window, WIDTH),
    };
    let marks = chart.marks();
    let ordinate = y.map_or_else(String::new, |y| symbols::text(&y.name));
    let words = Words {
        title: chart.title,
        subtitle: chart.subtitle,
        axes: [&symbols::text(&x.name), &ordinate],
        head: &chart.head(&painted, !marks.is_empty()),
    };
    let svg = plane.sheet(
        &words,
        |_| Ok(()),
        |drawn| {
            image::draw_place(drawn, window)?;
            for (index, values) in chart.cells.contours.iter().enumerate() {
                let lines = chart.lines(values);
                draw_contours(drawn, &lines, LINES[index % LINES.len()])?;
            }
            plane::dots(drawn, marks.iter().map(|&at| (at, style::INK)), 4.0)
        },
    )?;
    let rows = y.map_or(1, |y| y.count);
    let indices = (0..rows)
        .rev()
        .flat_map(|j| (0..x.count).map(move |i| i * rows + j));
    let pixels: Vec<u8> = indices
        .map(|index| painted.pixels.get(index).copied().unwrap_or(0))
        .collect();
    image::put(
        &svg,
        &image::data_address(x.count, &painted.palette, &pixels)?,
    )
}

/// The colours of the cells.
struct Painted<'a> {
    /// The transparent colour, then the colours of classes or numbers.
    palette: Vec<RGBColor>,
    /// The index of the colour of each cell, in the order of the cells.
    pixels: Vec<u8>,
    /// The colour bar, if colours show numbers.
    bar: Option<Bar<'a>>,
    /// The legend of the classes.
    items: Vec<Item>,
}

impl Chart<'_> {
    /// Draws a dot for each cell in the plane of two columns.
    fn draw_ends(&self, painted: &Painted<'_>, names: &[String; 2]) -> Result<String, String> {
        let places = &self.cells.places;
        let finite = |place: &&[f64; 2]| place.iter().all(|value| value.is_finite());
        let range = |axis: usize| {
            let values = places.iter().filter(finite).map(move |place| place[axis]);
            padded(values, DOTS_ROOM)
        };
        let window = Window {
            x: range(0),
            y: range(1),
        };
        let [x, y] = names.each_ref().map(|name| {
            let shown = name
                .split_once('.')
                .map_or(name.as_str(), |(_, shown)| shown);
            symbols::text(shown)
        });
        let words = Words {
            title: self.title,
            subtitle: self.subtitle,
            axes: [&x, &y],
            head: &self.head(painted, false),
        };
        Plane::free_scales(window, WIDTH).sheet(
            &words,
            |_| Ok(()),
            |drawn| {
                let colours = painted.pixels.iter();
                let colours = colours.map(|&shade| painted.palette[usize::from(shade)]);
                plane::dots(drawn, places.iter().copied().zip(colours), DOT)
            },
        )
    }

    fn painted(&self) -> Painted<'_> {
        match &self.request.colours {
            Colours::End => self.by_class(),
            Colours::Returns => self.by_number("returns", 0.0),
            Colours::Exponent => self.by_number("exponent per return", BEYOND),
            Colours::Value(value) if value.expression.is_inequality() => {
                let holds = |number: f64| match number.is_nan() {
                    true => 0,
                    false => 1 + u8::from(!value.expression.holds(number)),
                };
                let text = value.expression.text();
                let items = [
                    (text.to_owned(), CLASSES[0]),
                    ("otherwise".to_owned(), FIXED[1].1),
                ];
                Painted {
                    palette: vec![RGBColor(255, 255, 255), CLASSES[0], FIXED[1].1],
                    pixels: self.cells.numbers.iter().copied().map(holds).collect(),
                    bar: None,
                    items: items
                        .map(|(text, colour)| Item::new(Symbol::Square, colour, text))
                        .into(),
                }
            }
            Colours::Value(value) => self.by_number(value.expression.text(), BEYOND),
        }
    }

    fn by_class(&self) -> Painted<'_> {
        let sums = self.sums;
        let mut palette = vec![RGBColor(255, 255, 255)];
        let mut shades = vec![0_u8; sums.classes.len()];
        let (mut items, mut next) = (Vec::new(), 0);
        for class in sums.sorted_classes().into_iter().take(MOST) {
            let (name, cells) = &sums.classes[class];
            let fixed = FIXED.iter().find(|(word, _)| word == name);
            let colour = fixed.map_or_else(
                || {
                    next += 1;
                    class_colour(next - 1)
                },
                |(_, colour)| *colour,
            );
            shades[class] = palette.len() as u8;
            palette.push(colour);
            let share = 100.0 * *cells as f64 / sums.cells.max(1) as f64;
            items.push(Item::new(
                Symbol::Square,
                colour,
                format!("{name}, {share:.1} %"),
            ));
        }
        Painted {
            palette,
            pixels: self
                .cells
                .classes
                .iter()
                .map(|&class| shades[class])
                .collect(),
            bar: None,
            items,
        }
    }

    /// Colours cells by numbers. The colour scale leaves out a fraction `beyond` of the numbers at either end; they
    /// have the colour of that end.
    fn by_number<'s>(&'s self, name: &'s str, beyond: f64) -> Painted<'s> {
        let numbers = self.cells.numbers.iter().copied();
        let mut sorted: Vec<f64> = numbers.clone().filter(|value| value.is_finite()).collect();
        sorted.sort_by(f64::total_cmp);
        let end = (beyond * sorted.len() as f64) as usize;
        let ends = [
            sorted.get(end),
            sorted.get(sorted.len().saturating_sub(1 + end)),
        ];
        let ends = ends.map(|end| end.copied().unwrap_or(0.0));
        let range = match ends[0] < ends[1] {
            true => ends,
            false => padded(ends.into_iter(), 0.0),
        };
        let bar = Bar { name, range };
        let shade = |value: f64| match value.is_nan() {
            true => 0,
            false => bar.shade(value),
        };
        Painted {
            palette: bar::palette(),
            pixels: numbers.map(shade).collect(),
            bar: Some(bar),
            items: Vec::new(),
        }
    }

    /// The colour bar and the legend, which includes the contour lines.
    fn head<'s>(&self, painted: &'s Painted<'_>, is_marked: bool) -> Top<'s> {
        let mut items = painted.items.clone();
        if is_marked {
            items.push(Item::new(Symbol::Dot, style::INK, "a return of each orbit"));
        }
        let lines = self.request.contours.iter().enumerate();
        items.extend(lines.map(|(index, line)| {
            let colour = LINES[index % LINES.len()];
            Item::new(Symbol::Line, colour, line.expression.text())
        }));
        Top {
            bar: painted.bar.as_ref(),
            items,
        }
    }

    /// One return of each orbit, if both axes are components of the state and there are not too many orbits.
    fn marks(&self) -> Vec<[f64; 2]> {
        let places: Vec<Option<usize>> = self
            .axes
            .iter()
            .map(|axis| axis.component(self.request))
            .collect();
        let &[Some(x), Some(y)] = places.as_slice() else {
            return Vec::new();
        };
        let orbits = self.sums.orbits.all();
        let inside = |at: &[f64; 2]| {
            let ranges = self.axes.iter().map(Axis::range);
            ranges
                .zip(at)
                .all(|([low, high], &value)| low <= value && value <= high)
        };
        match orbits.len() {
            1..=MARKED => orbits
                .iter()
                .map(|orbit| [orbit.point[x], orbit.point[y]])
                .filter(inside)
                .collect(),
            _ => Vec::new(),
        }
    }

    /// The lines on which an expression is 0, from its values at the cells. A strip has none.
    fn lines(&self, values: &[f64]) -> Vec<super::contour::Contour> {
        let [x, y] = self.axes else {
            return Vec::new();
        };
        let inner = Window {
            x: x.ends,
            y: y.ends,
        };
        let value = |i: usize, j: usize| values.get(i * y.count + j).copied().unwrap_or(f64::NAN);
        let place = |at: f64, axis: &Axis| {
            let share = (at - axis.ends[0]) / (axis.ends[1] - axis.ends[0]);
            let place = share.clamp(0.0, 1.0) * (axis.count - 1) as f64;
            // Values at the cells are exact; only values between them are interpolated.
            let nearest = place.round();
            let place = if (place - nearest).abs() < 1e-9 {
                nearest
            } else {
                place
            };
            let index = (place as usize).min(axis.count - 2);
            (index, place - index as f64)
        };
        let squares = x.count.max(y.count) - 1;
        contours(inner, squares, |at| {
            let ((i, a), (j, b)) = (place(at[0], x), place(at[1], y));
            let along = |j: usize| (1.0 - a) * value(i, j) + a * value(i + 1, j);
            (1.0 - b) * along(j) + b * along(j + 1)
        })
    }
}

/// The colour of a class without a fixed one.
fn class_colour(index: usize) -> RGBColor {
    let RGBColor(r, g, b) = CLASSES[index % CLASSES.len()];
    let times = index / CLASSES.len() % 3;
    let lighter = |part: u8| (0..times).fold(part, |part, _| part + (255 - part) / 2);
    RGBColor(lighter(r), lighter(g), lighter(b))
}

/// A colour bar above a legend.
pub(super) struct Top<'a> {
    pub bar: Option<&'a Bar<'a>>,
    pub items: Vec<Item>,
}

impl Head for Top<'_> {
    fn height(&self, width: f64) -> f64 {
        self.bar.map_or(0.0, |bar| bar.height(width)) + self.items.height(width)
    }

    fn draw(&self, area: &Area<'_>, width: f64) -> Result<(), String> {
        let Some(bar) = self.bar else {
            return self.items.draw(area, width);
        };
        let (top, below) = area.split_vertically(px(bar.height(width)));
        bar.draw(&top, width)?;
        self.items.draw(&below, width)
    }
}
