//! The curves of bifurcations in the plane of two parameters, as a picture.

use dalembert_driver::{Branch, Extent};

use super::Followed;
use crate::plot::branch::mark;
use crate::plot::curves::{self, Chart, Curve};
use crate::symbols;

/// Width of the picture, in pixels.
const WIDTH: u32 = 560;

/// Draws the curves, one colour for each kind of bifurcation.
///
/// # Errors
/// A branch without curves, or an error of the drawing library.
pub fn draw(followed: &Followed<'_>, branch: &Branch, across: &Extent) -> Result<String, String> {
    let points = branch.curves.iter().flat_map(|curve| &curve.points);
    if points.count() == 0 {
        return Err("no bifurcation was followed".to_owned());
    }
    let names = [Some(followed.name()), followed.across()];
    let names = names.map(|name| symbols::text(name.unwrap_or_default()));
    let [first, last] = across.range;
    let section = super::super::summary::section(&followed.finished);
    let mut drawn: Vec<Curve> = Vec::new();
    for curve in &branch.curves {
        let (label, colour) = mark(curve.bifurcation);
        let places = curve.points.iter();
        let places = places.filter_map(|it| Some([it.parameter, it.second?]));
        let stretch: Vec<[f64; 2]> = places.collect();
        match drawn.iter_mut().find(|known| known.label == label) {
            Some(known) => known.stretches.push(stretch),
            None => drawn.push(Curve {
                label: label.to_owned(),
                colour,
                stretches: vec![stretch],
                points: Vec::new(),
            }),
        }
    }
    curves::draw(&Chart {
        title: &super::super::summary::title(&followed.finished),
        subtitle: &format!("section {section}, {} from {first} to {last}", names[1]),
        axes: [&names[0], &names[1]],
        values: &followed.request.extent.range,
        curves: drawn,
        width: WIDTH,
    })
}
