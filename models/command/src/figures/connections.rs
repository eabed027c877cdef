//! Motions of a ball between two points: W. Clark, thesis, Figure 8.1.

use dalembert_cli::gallery::{Figure, Panel, Picture};

use super::chapters;

pub fn bouncing_ball() -> Figure {
    let panel = |name: &str, title: &str, flags: &str| Panel {
        name: name.to_owned(),
        title: title.to_owned(),
        picture: Picture::Connect(format!("--from x=0 --to x=0.2 --time 5 {flags}")),
    };
    Figure {
        model: "bouncing_ball",
        name: "connections",
        title: "Every motion from one point to another in a given time",
        chapter: chapters::VARIATIONS,
        highlight: Some(0),
        caption: "A ball with $m = g = 1$ goes from $x = 0$ to $x = 0.2$ in time 5, with no more than three impacts: once without an \
                  impact, twice with each other number, rising and falling at the end. The dots are conjugate points of other \
                  starts. They lie on the bounds of what k impacts reach, $x = g*t^2/(8*k*(k + 1))$, where both motions become \
                  one; the motions that touch a bound before their end are not least of action."
            .to_owned(),
        source: Some("W. Clark, thesis, Fig. 8.1"),
        panels: vec![
            panel("bounds", "Bounds of one, two and three impacts", "--impacts 1..3 --envelope 150"),
            panel("paths", "Motions with no more than three impacts", "--impacts 0..3"),
        ],
    }
}
