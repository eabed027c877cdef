//! Reproductions of figures from the papers in which the models appear. `dalembert gallery` shows them before the motion
//! of every model.
//!
//! The papers do not state every parameter; the captions give the values that were chosen here.

mod chapters;
mod connections;
mod control;
mod density;
mod pendulum;
mod rolling_disk;
mod walker;
mod work;
mod zeno;

use dalembert_cli::gallery::{Figure, Panel, Picture};

/// Flags for the width of pictures of which two, three or four stand side by side.
const HALF: &str = "--plot-width 560";
const THIRD: &str = "--plot-width 480";
const QUARTER: &str = "--plot-width 400";

/// All figures, chapter by chapter.
pub fn all() -> Vec<Figure> {
    let mut figures = walker::figures();
    figures.extend(rolling_disk::figures());
    figures.extend(connections::figures());
    figures.extend(control::figures());
    figures.extend(walker::tongues());
    figures.extend([
        zeno::bouncing_ball(),
        density::of_the_sleigh(),
        density::of_the_disk(),
        pendulum::flips(),
    ]);
    figures.extend(work::figures());
    figures
}

/// A picture that `simulate` draws with these flags.
fn simulated(name: &str, title: impl Into<String>, flags: &str) -> Panel {
    Panel {
        name: name.to_owned(),
        title: title.into(),
        picture: Picture::Simulate(flags.to_owned()),
    }
}
