//! A ball whose impacts accumulate: W. Clark and A. Bloch, Figure 1.

use dalembert_cli::gallery::Figure;

use super::{THIRD, chapters, simulated};

pub fn bouncing_ball() -> Figure {
    let panel = |name: &str, title: &str, axes: &str| {
        let flags = format!("--law newton:0.75 --axes {axes} {THIRD}");
        simulated(name, title, &flags)
    };
    Figure {
        model: "bouncing_ball",
        name: "zeno",
        title: "Impacts that accumulate",
        chapter: chapters::DENSITIES,
        highlight: None,
        caption: "A ball with $m = g = 1$ and restitution $3/4$. Its impacts from height 1 accumulate at t = 7 sqrt(2) \
                  = 9.899.., where the run ends; position and energy tend to 0. The fourth picture of the paper, the \
                  infinitesimal volume against time, decreases at each impact by the factor 9/16, like the energy."
            .to_owned(),
        source: Some("W. Clark and A. Bloch, Fig. 1"),
        panels: vec![
            panel("phase", "The phase portrait", "x,p_x"),
            panel("position", "Position over time", "t,x"),
            panel("energy", "Energy over time", "t,energy"),
        ],
    }
}
