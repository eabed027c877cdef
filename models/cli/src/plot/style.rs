//! Colours, sizes and number formats shared by all pictures.

use std::ops::Range;

use plotters::coord::ranged1d::{KeyPointHint, NoDefaultFormatting, Ranged, ValueFormatter};
use plotters::style::{RGBColor, WHITE};

/// Colours that colour-blind people can distinguish: those of Okabe and Ito that are readable on white, a dark grey and
/// a brown.
pub const PALETTE: [RGBColor; 8] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(230, 159, 0),
    RGBColor(86, 180, 233),
    RGBColor(60, 60, 60),
    RGBColor(150, 100, 40),
];

/// The path in a portrait.
pub const PATH: RGBColor = PALETTE[0];

/// Text and axes.
pub const INK: RGBColor = RGBColor(50, 50, 50);

/// Secondary text.
pub const FAINT_INK: RGBColor = RGBColor(105, 105, 105);

/// Grid lines.
pub const GRID: RGBColor = RGBColor(226, 229, 233);

/// The allowed region.
pub const REGION: RGBColor = RGBColor(240, 244, 249);

/// The region's boundary.
pub const BOUNDARY: RGBColor = RGBColor(110, 120, 132);

/// Colours of pictures, each with the colour that replaces it on a dark page.
pub const DARK: [(RGBColor, RGBColor); 11] = [
    (WHITE, RGBColor(22, 24, 27)),
    (INK, RGBColor(220, 221, 224)),
    (FAINT_INK, RGBColor(155, 159, 166)),
    (GRID, RGBColor(51, 55, 61)),
    (REGION, RGBColor(31, 36, 43)),
    (BOUNDARY, RGBColor(138, 147, 158)),
    (PALETTE[0], RGBColor(86, 170, 230)),
    (PALETTE[1], RGBColor(240, 128, 48)),
    (PALETTE[2], RGBColor(40, 190, 145)),
    (PALETTE[6], RGBColor(200, 200, 200)),
    (PALETTE[7], RGBColor(196, 146, 84)),
];

/// A colour in hexadecimal notation.
pub fn hex(colour: RGBColor) -> String {
    format!("#{:02X}{:02X}{:02X}", colour.0, colour.1, colour.2)
}

/// The colour of a curve by its index; indices past the palette repeat it in lighter colours.
pub fn curve(index: usize) -> RGBColor {
    let RGBColor(r, g, b) = PALETTE[index % PALETTE.len()];
    let times = index / PALETTE.len() % 3;
    let lighter = |part: u8| (0..times).fold(part, |part, _| part + (255 - part) / 2);
    RGBColor(lighter(r), lighter(g), lighter(b))
}

/// The colour of the impacts on a surface, by the index of the surface. The first colour is reserved for the path.
pub const fn surface(index: usize) -> RGBColor {
    PALETTE[1 + index % (PALETTE.len() - 1)]
}

/// An axis: its range, and the distance of its labels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Axis {
    /// Least and greatest value.
    pub range: [f64; 2],
    /// Distance of the labels.
    step: f64,
}

impl Axis {
    /// An axis of this range with about `target` labels, at multiples of 1, 2 or 5 times a power of ten.
    pub fn new(range: [f64; 2], target: usize) -> Self {
        let length = range[1] - range[0];
        let raw = length / target.max(1) as f64;
        let decade = 10f64.powi(raw.log10().floor() as i32);
        let step = [1.0, 2.0, 5.0]
            .map(|digit| digit * decade)
            .into_iter()
            .find(|&step| step >= raw);
        let step = step.unwrap_or(10.0 * decade);
        Self { range, step }
    }

    /// The labelled values.
    pub fn ticks(&self) -> Vec<f64> {
        let [first, last] = self.range.map(|end| end / self.step);
        let count = (last.floor() - first.ceil()) as usize + 1;
        (0..count)
            .map(|index| (first.ceil() + index as f64) * self.step)
            .collect()
    }

    /// The label of a value, with as many decimals as the step needs, or with an exponent instead of many decimals.
    pub fn label(&self, value: f64) -> String {
        let largest = self.range[0].abs().max(self.range[1].abs());
        let decimals = (-self.step.log10()).ceil().max(0.0) as usize;
        // Rounding errors turn a label at zero into a tiny number.
        let value = if value.abs() < 1e-9 * largest {
            0.0
        } else {
            value
        };
        if decimals <= 5 && largest < 1e6 {
            format!("{value:.decimals$}")
        } else {
            shortest_exponent(value)
        }
    }
}

/// Gives the drawing library the labels of this axis in place of its own.
impl Ranged for Axis {
    type FormatOption = NoDefaultFormatting;
    type ValueType = f64;

    fn map(&self, value: &f64, (start, end): (i32, i32)) -> i32 {
        let [low, high] = self.range;
        let share = (value - low) / (high - low);
        start + (share * f64::from(end - start)).round() as i32
    }

    fn key_points<Hint: KeyPointHint>(&self, hint: Hint) -> Vec<f64> {
        match hint.weight().allow_light_points() {
            true => Vec::new(),
            false => self.ticks(),
        }
    }

    fn range(&self) -> Range<f64> {
        self.range[0]..self.range[1]
    }
}

impl ValueFormatter<f64> for Axis {
    fn format_ext(&self, value: &f64) -> String {
        self.label(*value)
    }
}

/// A number with an exponent and at most five significant digits: `2.5e-7`.
fn shortest_exponent(value: f64) -> String {
    let rounded: f64 = format!("{value:.4e}").parse().unwrap_or(value);
    if rounded == 0.0 {
        "0".to_owned()
    } else {
        format!("{rounded:e}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_have_as_many_decimals_as_they_need() {
        assert_eq!(Axis::new([0.0, 0.4], 8).label(0.05), "0.05");
        assert_eq!(Axis::new([0.0, 20.0], 8).label(15.0), "15");
        assert_eq!(Axis::new([-0.3, 0.3], 6).label(-1e-17), "0.0");
        assert_eq!(Axis::new([0.0, 3e-7], 6).label(2.5e-7), "2.5e-7");
    }

    #[test]
    fn ticks_lie_at_multiples_of_the_step() {
        assert_eq!(Axis::new([-0.5, 7.0], 4).ticks(), [0.0, 2.0, 4.0, 6.0]);
        assert_eq!(Axis::new([-4.0, 2.0], 3).ticks(), [-4.0, -2.0, 0.0, 2.0]);
        let small = Axis::new([1.0 - 1e-12, 1.0 + 1e-12], 4).ticks();
        assert!((2..=5).contains(&small.len()), "{small:?}");
    }
}
