//! The figure that every model has: its motion from the declared start.

use dalembert::describe::Description;

use super::{Figure, Panel, Picture};
use crate::names;

/// Width of a picture beside others, in pixels.
const WIDTH: &str = "--plot-width 480";

/// The motion of a model from its declared start: the declared view, or coordinates and velocities against time; the first
/// coordinate that moves with its velocity; the error of the energy.
pub fn figure(description: &Description) -> Figure {
    let mut panels = match description.view {
        Some(_) => vec![panel("path", "The declared view", "")],
        None => vec![
            panel("positions", "Coordinates", "--axes t,q"),
            panel("velocities", "Velocities", "--axes t,qdot"),
        ],
    };
    if let Some(first) = names::coordinates(description).next() {
        let velocity = names::velocity(first);
        panels.push(panel(
            "phase",
            &format!("Phase portrait of {first}"),
            &format!("--axes {first},{velocity}"),
        ));
    }
    panels.push(panel(
        "energy",
        "Change of the energy, as a share of it",
        "--axes t,energy_error",
    ));
    Figure {
        model: description.name,
        name: "motion",
        title: "Motion from the declared start",
        caption: "Parameters and state are those that the model declares. Where the energy is kept, its change is the error of \
                  the run."
            .to_owned(),
        source: None,
        panels,
    }
}

fn panel(name: &str, title: &str, flags: &str) -> Panel {
    let flags = [flags, WIDTH].join(" ");
    Panel {
        name: name.to_owned(),
        title: title.to_owned(),
        picture: Picture::Simulate(flags.trim().to_owned()),
    }
}
