//! A branch of orbits over its parameter: stable and unstable arcs, bifurcations and ends.

use dalembert::describe::Description;
use dalembert_driver::{Bifurcation, Branch, BranchEnd, Member, Stability, padded};
use plotters::style::RGBColor;

use super::canvas::message;
use super::contour::Window;
use super::legend::{Item, Symbol};
use super::plane::{self, Plane, Words};
use super::quantity::{Quantity, of_state};
use super::style::{self, PALETTE};
use crate::symbols;

/// Width of the picture, in pixels.
const WIDTH: f64 = 560.0;

/// Changes below this fraction of a value are rounding errors.
const CONSTANT: f64 = 1e-9;

/// Colours of arcs, in the order of the legend.
const ARCS: [(Stability, RGBColor); 3] = [
    (Stability::Stable, PALETTE[0]),
    (Stability::Unstable, PALETTE[1]),
    (Stability::Neutral, PALETTE[6]),
];

/// Label and index of the colour of each bifurcation, in the order of the legend.
const MARKS: [(Bifurcation, &str, usize); 4] = [
    (Bifurcation::Fold, "fold", 4),
    (Bifurcation::Flip, "flip", 3),
    (Bifurcation::NeimarkSacker, "Neimark-Sacker", 2),
    (Bifurcation::BranchPoint, "branch point", 7),
];

/// Quantity along y.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ordinate {
    /// The period.
    Period,
    /// A quantity of the state at the section, before its event.
    Before(Quantity),
}

impl Ordinate {
    /// The first coordinate or velocity that changes along a branch; the period if none does.
    pub fn first(branch: &Branch, description: &Description) -> Self {
        let changes = |ordinate: &Self| {
            let values = branch.points.iter().map(|member| ordinate.value(member));
            let range = values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], value| {
                [f64::min(low, value), f64::max(high, value)]
            });
            range[1] - range[0] > CONSTANT * f64::max(1.0, range[1].abs())
        };
        let is_component =
            |it: &Quantity| matches!(it, Quantity::Position(_) | Quantity::Velocity(_));
        let components = of_state(description).into_iter().filter(is_component);
        let mut ordinates = components.map(Self::Before);
        ordinates.find(changes).unwrap_or(Self::Period)
    }

    fn value(self, member: &Member) -> f64 {
        match self {
            Self::Period => member.period,
            Self::Before(quantity) => quantity.value(0.0, &member.before, 0.0),
        }
    }

    fn label(self, description: &Description) -> String {
        match self {
            Self::Period => "period".to_owned(),
            Self::Before(quantity) => quantity.label(description),
        }
    }
}

/// A branch to be drawn.
pub struct Chart<'a> {
    /// First line of the title.
    pub title: &'a str,
    /// Second line of the title.
    pub subtitle: &'a str,
    /// The name of the parameter.
    pub parameter: &'a str,
    /// Its range.
    pub range: [f64; 2],
    /// Quantity along y.
    pub ordinate: Ordinate,
    /// The model.
    pub description: &'a Description,
    /// The branch.
    pub branch: &'a Branch,
    /// Reasons why the branch ends, at its first and at its last point.
    pub ends: [String; 2],
}

/// Draws the branch.
///
/// # Errors
/// An error of the drawing library.
pub fn draw(chart: &Chart<'_>) -> Result<String, String> {
    let points: Vec<[f64; 2]> = chart
        .branch
        .points
        .iter()
        .map(|it| chart.place(it))
        .collect();
    let ordinates = points
        .iter()
        .map(|at| at[1])
        .filter(|value| value.is_finite());
    let window = Window {
        x: padded(chart.range.into_iter(), 0.02),
        y: padded(ordinates, 0.06),
    };
    let plane = Plane::free_scales(window, WIDTH);
    let words = Words {
        title: chart.title,
        subtitle: chart.subtitle,
        axes: [
            &symbols::text(chart.parameter),
            &chart.ordinate.label(chart.description),
        ],
        head: &chart.legend(),
    };
    plane.sheet(
        &words,
        |_| Ok(()),
        |drawn| {
            for (stability, arc) in chart.arcs() {
                let path = points[arc].iter().copied().filter(is_finite);
                plane.path(drawn, &path.collect::<Vec<_>>(), colour(stability))?;
            }
            let marked = chart.branch.points.iter().zip(&points);
            let marked =
                marked.filter_map(|(it, at)| Some((*at, PALETTE[mark(it.bifurcation?).1])));
            plane::dots(drawn, marked, 4.5)?;
            let rings = chart.open_ends().map(|(_, at, _)| at).filter(is_finite);
            drawn.draw_series(rings.map(plane::ring)).map_err(message)?;
            Ok(())
        },
    )
}

fn is_finite(at: &[f64; 2]) -> bool {
    at.iter().all(|value| value.is_finite())
}

fn colour(stability: Stability) -> RGBColor {
    let found = ARCS.iter().find(|(known, _)| *known == stability);
    found.map_or(style::INK, |(_, colour)| *colour)
}

/// The label of a bifurcation, and the index of its colour.
pub fn mark(bifurcation: Bifurcation) -> (&'static str, usize) {
    let found = MARKS.iter().find(|(known, ..)| *known == bifurcation);
    let (_, words, colour) = found.copied().unwrap_or(MARKS[0]);
    (words, colour)
}

impl Chart<'_> {
    fn place(&self, member: &Member) -> [f64; 2] {
        [member.parameter, self.ordinate.value(member)]
    }

    /// The arcs of constant stability, each with the indices of its points. Neighbouring arcs share an end.
    fn arcs(&self) -> Vec<(Stability, std::ops::RangeInclusive<usize>)> {
        let points = &self.branch.points;
        let mut arcs: Vec<(Stability, std::ops::RangeInclusive<usize>)> = Vec::new();
        for (index, pair) in points.windows(2).enumerate() {
            // The stability of a bifurcation point differs from that of the arcs on both sides.
            let inside = pair.iter().find(|member| member.bifurcation.is_none());
            let stability = inside.unwrap_or(&pair[1]).stability;
            match arcs.last_mut() {
                Some((last, arc)) if *last == stability => *arc = *arc.start()..=index + 1,
                _ => arcs.push((stability, index..=index + 1)),
            }
        }
        arcs
    }

    /// The ends inside the range: kind, point and reason.
    fn open_ends(&self) -> impl Iterator<Item = (BranchEnd, [f64; 2], &str)> {
        let points = [self.branch.points.first(), self.branch.points.last()];
        let ends = self.branch.ends.iter().zip(points).zip(&self.ends);
        let open = ends.filter(|((end, _), _)| {
            !matches!(
                end,
                BranchEnd::Range | BranchEnd::Closed | BranchEnd::Points
            )
        });
        open.filter_map(|((end, member), text)| Some((*end, self.place(member?), text.as_str())))
    }

    fn legend(&self) -> Vec<Item> {
        let drawn: Vec<Stability> = self
            .arcs()
            .iter()
            .map(|(stability, _)| *stability)
            .collect();
        let arcs = ARCS
            .iter()
            .filter(|(stability, _)| drawn.contains(stability));
        let mut items: Vec<Item> = arcs
            .map(|(stability, colour)| Item::new(Symbol::Line, *colour, stability.name()))
            .collect();
        let points = &self.branch.points;
        for (bifurcation, text, colour) in MARKS {
            if points.iter().any(|it| it.bifurcation == Some(bifurcation)) {
                items.push(Item::new(Symbol::Dot, PALETTE[colour], text));
            }
        }
        let mut texts: Vec<&str> = self.open_ends().map(|(_, _, text)| text).collect();
        texts.dedup();
        items.extend(
            texts
                .into_iter()
                .map(|text| Item::new(Symbol::Ring, style::INK, text)),
        );
        items
    }
}
