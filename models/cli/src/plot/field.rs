//! Numbers at the nodes of a rectangle as colours, with paths on top.

use plotters::style::RGBColor;

use super::bar::{self, Bar};
use super::contour::Window;
use super::image;
use super::legend::{Item, Symbol};
use super::map::Top;
use super::plane::{self, Chart, Plane, Words};
use super::style;
use dalembert_driver::padded;

/// Fraction of the numbers that the colour scale covers; larger numbers have the last colour.
const SHOWN: f64 = 0.95;

/// Largest number of impacts with a colour of its own.
const MOST: usize = 12;

/// Colour of a path over a map of numbers.
const BRIGHT: RGBColor = RGBColor(255, 110, 60);

/// Colour behind the marks at the ends of a path.
const HALO: RGBColor = RGBColor(250, 250, 250);

/// Meaning of the numbers.
#[derive(Debug, Clone, Copy)]
pub enum Meaning<'a> {
    /// A quantity of this name.
    Number(&'a str),
    /// Numbers of impacts; interpolated numbers are rounded.
    Impacts,
}

/// The parts of a path between its jumps.
pub type Stretches = Vec<Vec<[f64; 2]>>;

/// Content of a picture.
pub struct Field<'a> {
    /// First line of the title.
    pub title: &'a str,
    /// Second line of the title.
    pub subtitle: &'a str,
    /// The names of the axes.
    pub names: [String; 2],
    /// Its width, in pixels.
    pub width: f64,
    /// The rectangle that the cells around all nodes cover.
    pub window: Window,
    /// Number of nodes along each axis.
    pub counts: [usize; 2],
    /// A number for each node; the index along the second axis changes fastest. NaN stands for an unknown number.
    pub values: &'a [f64],
    /// Their meaning.
    pub meaning: Meaning<'a>,
    /// The paths.
    pub paths: &'a [Stretches],
}

/// Draws the picture.
///
/// # Errors
/// An error of the drawing library.
pub fn draw(field: &Field<'_>) -> Result<String, String> {
    let painted = field.painted();
    let top = Top {
        bar: painted.bar.as_ref(),
        items: painted.items,
    };
    let plane = Plane::free_scales(field.window, field.width);
    let words = Words {
        title: field.title,
        subtitle: field.subtitle,
        axes: field.names.each_ref().map(String::as_str),
        head: &top,
    };
    let svg = plane.sheet(
        &words,
        |_| Ok(()),
        |chart| {
            image::draw_place(chart, field.window)?;
            let mut paths = field.paths.iter();
            paths.try_for_each(|stretches| draw_path(chart, &plane, stretches, field.ink()))
        },
    )?;
    let [columns, rows] = field.counts;
    let indices = (0..rows)
        .rev()
        .flat_map(|j| (0..columns).map(move |i| i * rows + j));
    let pixels: Vec<u8> = indices
        .map(|index| (painted.shade)(field.values[index]))
        .collect();
    image::put(
        &svg,
        &image::data_address(columns, &painted.palette, &pixels)?,
    )
}

/// Draws a path, its jumps and its ends.
fn draw_path(
    chart: &mut Chart<'_, '_>,
    plane: &Plane,
    stretches: &Stretches,
    ink: RGBColor,
) -> Result<(), String> {
    for stretch in stretches.iter().filter(|it| it.len() > 1) {
        plane.path(chart, stretch, ink)?;
    }
    let jumps = stretches.windows(2);
    let jumps = jumps.filter_map(|pair| Some([*pair[0].last()?, *pair[1].first()?]));
    plane::dashes(chart, jumps, ink)?;
    let points = stretches.iter().flatten();
    let (Some(first), Some(last)) = (points.clone().next(), points.last()) else {
        return Ok(());
    };
    let halo = [*first, *last].into_iter().map(|at| (at, HALO));
    plane::dots(chart, halo, 6.5)?;
    plane::ends(chart, *first, *last)
}

/// The colours of the numbers.
struct Painted<'a> {
    palette: Vec<RGBColor>,
    shade: Box<dyn Fn(f64) -> u8 + 'a>,
    bar: Option<Bar<'a>>,
    items: Vec<Item>,
}

impl Field<'_> {
    /// The colour of paths.
    fn ink(&self) -> RGBColor {
        match self.meaning {
            Meaning::Number(_) => BRIGHT,
            Meaning::Impacts => style::INK,
        }
    }

    fn painted(&self) -> Painted<'_> {
        let mut painted = match self.meaning {
            Meaning::Number(name) => self.by_number(name),
            Meaning::Impacts => self.by_impacts(),
        };
        if !self.paths.is_empty() {
            let ways = [
                Item::new(Symbol::Line, self.ink(), "path of least cost"),
                Item::new(Symbol::Ring, style::INK, "start"),
                Item::new(Symbol::Square, style::INK, "end"),
            ];
            painted.items.extend(ways);
        }
        painted
    }

    fn by_number<'s>(&'s self, name: &'s str) -> Painted<'s> {
        let known = self.values.iter().copied().filter(|it| it.is_finite());
        let mut sorted: Vec<f64> = known.collect();
        sorted.sort_by(f64::total_cmp);
        let last = (SHOWN * sorted.len().saturating_sub(1) as f64) as usize;
        let ends = [sorted.first(), sorted.get(last)].map(|it| it.copied().unwrap_or(0.0));
        let range = match ends[0] < ends[1] {
            true => ends,
            false => padded(ends.into_iter(), 0.0),
        };
        let shade = move |value: f64| match value.is_nan() {
            true => 0,
            false => Bar { name: "", range }.shade(value),
        };
        Painted {
            palette: bar::palette(),
            shade: Box::new(shade),
            bar: Some(Bar { name, range }),
            items: Vec::new(),
        }
    }

    fn by_impacts(&self) -> Painted<'_> {
        let shade = |value: f64| match value.is_nan() {
            true => 0,
            false => 1 + (value.round() as usize).min(MOST) as u8,
        };
        let mut palette = vec![RGBColor(255, 255, 255)];
        palette.extend((0..=MOST).map(style::curve));
        let mut counts = [0; MOST + 2];
        let shades = self.values.iter().map(|value| shade(*value));
        shades.for_each(|shade| counts[usize::from(shade)] += 1);
        let known = (0..=MOST).filter(|impacts| counts[1 + impacts] > 0);
        let items = known.map(|impacts| {
            let plural = if impacts == 1 { "" } else { "s" };
            let more = if impacts == MOST { " or more" } else { "" };
            let label = format!("{impacts} impact{plural}{more}");
            Item::new(Symbol::Square, style::curve(impacts), label)
        });
        Painted {
            items: items.collect(),
            palette,
            shade: Box::new(shade),
            bar: None,
        }
    }
}
