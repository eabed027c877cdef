//! Figures of the papers that the models come from, drawn anew: what `dalembert gallery` shows besides every model's own
//! motion.
//!
//! The papers do not state every parameter; what was chosen here is said in the captions.

mod density;
mod rolling_disk;
mod work;
mod zeno;

use dalembert_cli::gallery::{Figure, Panel, Picture};

/// Widths of pictures of which three or four stand beside each other.
const THIRD: &str = "--plot-width 480";
const QUARTER: &str = "--plot-width 400";

/// All of them, in the order of the models.
pub fn all() -> Vec<Figure> {
    let mut figures = rolling_disk::figures();
    figures.extend([
        density::of_the_sleigh(),
        density::of_the_disk(),
        zeno::bouncing_ball(),
    ]);
    figures.extend(work::figures());
    figures
}

/// A picture that `simulate` draws from these flags.
fn simulated(name: &str, title: impl Into<String>, flags: &str) -> Panel {
    Panel {
        name: name.to_owned(),
        title: title.into(),
        picture: Picture::Simulate(flags.to_owned()),
    }
}
