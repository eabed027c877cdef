//! Quantities against each other, such as phase portraits.

use super::Picture;
use super::contour::Window;
use super::legend::{Item, Symbol};
use super::plane::{self, Plane, Words};
use super::quantity::Quantity;
use super::style;
use dalembert_driver::padded;

/// Draws the ordinates against the abscissa, which is the first of the quantities.
///
/// # Errors
/// An error of the drawing library.
pub fn draw(picture: &Picture<'_>, quantities: &[Quantity]) -> Result<String, String> {
    let description = picture.model.description();
    let names: Vec<String> = quantities
        .iter()
        .map(|quantity| quantity.label(description))
        .collect();
    let marks = picture.trace.points();
    let values = |index: usize| marks.iter().map(move |mark| mark.values[index]);
    let ordinates = 1..quantities.len();
    let window = Window {
        x: padded(values(0), 0.06),
        y: padded(ordinates.clone().flat_map(values), 0.06),
    };
    let plane = Plane::free_scales(window, picture.width);

    let mut legend = picture.legend(&names[1], style::curve(0));
    let further = names.iter().enumerate().skip(2);
    let further = further.map(|(k, name)| Item::new(Symbol::Line, style::curve(k - 1), name));
    legend.splice(1..1, further);
    let words = Words {
        title: &picture.title,
        subtitle: &picture.subtitle,
        axes: [&names[0], if names.len() == 2 { &names[1] } else { "" }],
        head: &legend,
    };
    let energy = picture.first.energy;
    plane.sheet(
        &words,
        |_| Ok(()),
        |chart| {
            for index in ordinates {
                let point = |values: &[f64]| [values[0], values[index]];
                let colour = style::curve(index - 1);
                let stretches = picture.trace.stretches(|mark| point(&mark.values));
                for stretch in &stretches {
                    plane.path(chart, stretch, colour)?;
                }
                let jumps = picture.trace.jumps();
                let jumps = jumps.map(|ends| ends.map(|mark| point(&mark.values)));
                plane::dashes(chart, jumps, colour)?;
                let impacts = picture.impacts.iter().map(|impact| {
                    let value =
                        |quantity: Quantity| quantity.value(impact.t, &impact.after, energy);
                    let at = [value(quantities[0]), value(quantities[index])];
                    (at, style::surface(impact.surface))
                });
                plane::dots(chart, impacts, 2.8)?;
                if let [first, .., last] = stretches.concat().as_slice() {
                    plane::ends(chart, *first, *last)?;
                }
            }
            Ok(())
        },
    )
}
