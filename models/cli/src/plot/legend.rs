//! A legend, whose entries wrap into as many lines as they need.

use plotters::element::{Circle, PathElement, Rectangle};
use plotters::style::{Color, RGBColor};

use super::canvas::{Area, INDENT, message, px, shortened, stroke, text, text_width};
use super::style::INK;

/// Height of a line, in pixels.
const LINE: f64 = 20.0;

/// Size of the text, in pixels.
const SIZE: f64 = 12.0;

/// Room for the symbol before the text, in pixels.
const SYMBOL: f64 = 24.0;

/// Room between entries, in pixels.
const GAP: f64 = 18.0;

/// Symbol before the text of an entry.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Symbol {
    /// A curve.
    Line,
    /// A thin vertical line.
    Tick,
    /// A filled circle: an impact, or a point.
    Dot,
    /// A circle: the start.
    Ring,
    /// A filled square: the end, or a class.
    Square,
}

/// An entry of a legend.
#[derive(Debug, Clone)]
pub struct Item {
    /// Its symbol.
    pub symbol: Symbol,
    /// The symbol's colour.
    pub colour: RGBColor,
    /// Its text.
    pub label: String,
}

impl Item {
    /// An entry with this symbol, colour and text.
    pub fn new(symbol: Symbol, colour: RGBColor, label: impl Into<String>) -> Self {
        Self {
            symbol,
            colour,
            label: label.into(),
        }
    }
}

/// An entry with its left edge and the index of its line.
type Placed<'a> = (f64, usize, &'a Item);

/// Height in pixels of the legend at this width.
pub fn height(items: &[Item], width: f64) -> f64 {
    place(items, width)
        .last()
        .map_or(0.0, |(_, line, _)| LINE * (line + 1) as f64)
}

/// Draws the legend at the top of an area.
///
/// # Errors
/// An error of the drawing library.
pub fn draw(area: &Area<'_>, items: &[Item], width: f64) -> Result<(), String> {
    for (left, line, item) in place(items, width) {
        let middle = LINE * (line as f64 + 0.5);
        symbol(area, item, left, middle)?;
        let label = shortened(&item.label, width - 2.0 * INDENT - SYMBOL, SIZE);
        let corner = (px(left + SYMBOL), px(middle - 0.42 * SIZE));
        area.draw_text(&label, &text(SIZE, INK), corner)
            .map_err(message)?;
    }
    Ok(())
}

fn place(items: &[Item], width: f64) -> Vec<Placed<'_>> {
    let mut placed = Vec::with_capacity(items.len());
    let (mut left, mut line) = (INDENT, 0);
    for item in items {
        let needed = SYMBOL + text_width(&item.label, SIZE);
        if left > INDENT && left + needed > width - INDENT {
            (left, line) = (INDENT, line + 1);
        }
        placed.push((left, line, item));
        left += needed + GAP;
    }
    placed
}

fn symbol(area: &Area<'_>, item: &Item, left: f64, middle: f64) -> Result<(), String> {
    let at = |x: f64, y: f64| (px(left + x), px(middle + y));
    let line = |points: Vec<(i32, i32)>, width: f64| {
        area.draw(&PathElement::new(
            points,
            item.colour.stroke_width(stroke(width)),
        ))
    };
    match item.symbol {
        Symbol::Line => line(vec![at(0.0, 0.0), at(18.0, 0.0)], 2.0),
        Symbol::Tick => line(vec![at(9.0, -7.0), at(9.0, 7.0)], 1.2),
        Symbol::Dot => area.draw(&Circle::new(at(9.0, 0.0), px(3.5), item.colour.filled())),
        Symbol::Ring => area.draw(&Circle::new(
            at(9.0, 0.0),
            px(4.5),
            item.colour.stroke_width(stroke(1.6)),
        )),
        Symbol::Square => area.draw(&Rectangle::new(
            [at(5.0, -4.0), at(13.0, 4.0)],
            item.colour.filled(),
        )),
    }
    .map_err(message)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn entries_wrap_and_stay_inside() {
        let items: Vec<Item> = (0..20)
            .map(|i| Item::new(Symbol::Line, INK, format!("coordinate.{i}")))
            .collect();
        let placed = place(&items, 400.0);
        assert!(placed.iter().all(|(left, _, _)| *left < 300.0));
        assert_eq!(height(&items, 400.0), LINE * (placed[19].1 + 1) as f64);
        assert_eq!(height(&[], 400.0), 0.0);
    }
}
