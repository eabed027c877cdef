//! Figures of the papers that the models come from, drawn anew: what `dalembert gallery` shows besides every model's own
//! motion.
//!
//! The papers do not state every parameter; what was chosen here is said in the captions.

mod density;
mod rolling_disk;
mod work;
mod zeno;

use dalembert_cli::gallery::{Figure, Panel, Picture};

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

/// A picture that `simulate` draws beside others.
fn simulated(name: &str, title: impl Into<String>, flags: &str) -> Panel {
    Panel {
        name: name.to_owned(),
        title: title.into(),
        picture: Picture::Simulate(format!("{flags} --plot-width 480")),
    }
}
