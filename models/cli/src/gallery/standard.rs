//! The standard figure of each model: its motion from the declared start.

use dalembert::describe::Description;

use super::{Figure, Panel, Picture};
use crate::names;

/// The heading of these figures.
pub const MOTIONS: &str = "Motions of the models";

/// The motion of a model from its declared start. The pictures show the declared view (without one, coordinates and
/// velocities against time) and the phase portrait of the first coordinate. Unless the model is of first order, they
/// also show the change of the energy.
pub fn figure(description: &Description) -> Figure {
    let mut flags: Vec<(&str, String, String)> = Vec::new();
    let mut add = |name, title: &str, axes: String| flags.push((name, title.to_owned(), axes));
    if description.view.is_some() {
        add("path", "The declared view", String::new());
    } else {
        add("positions", "Coordinates", "--axes t,q ".to_owned());
        add("velocities", "Velocities", "--axes t,qdot ".to_owned());
    }
    if let Some(first) = names::coordinates(description).next() {
        let (title, velocity) = (format!("Phase portrait of {first}"), names::velocity(first));
        add("phase", &title, format!("--axes {first},{velocity} "));
    }
    if !description.is_first_order {
        let title = "Relative change of the energy";
        add("energy", title, "--axes t,energy_error ".to_owned());
    }

    // Small pictures, four side by side on a page.
    let width = 400;
    let panels = flags.into_iter().map(|(name, title, axes)| Panel {
        name: name.to_owned(),
        title,
        picture: Picture::Simulate(format!("{axes}--plot-width {width}")),
    });
    Figure {
        model: description.name,
        name: "motion",
        title: "Motion from the declared start",
        chapter: MOTIONS,
        highlight: None,
        caption: "Parameters and start are those of the declaration. A change of a conserved energy comes from the \
                  errors of the run."
            .to_owned(),
        source: None,
        panels: panels.collect(),
    }
}
