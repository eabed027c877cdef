//! Optimal motions of a ball: W. Clark, thesis, section 9.6.

use dalembert_cli::gallery::{Figure, Panel, Picture};

use super::chapters;

pub fn controlled_ball() -> Figure {
    let panel = |name: &str, title: &str, flags: &str| Panel {
        name: name.to_owned(),
        title: title.to_owned(),
        picture: Picture::Control(flags.to_owned()),
    };
    Figure {
        model: "controlled_ball",
        name: "optimal",
        title: "The least force that brings a ball to a height",
        chapter: chapters::VARIATIONS,
        highlight: None,
        caption: "Extremals of the integral of $u^2/2$ and of $10*(x - 1)^2$ at the end, with $m = 2$, $g = 1$, $T = 5$, and no more than two \
                  impacts. The force is linear between impacts. From a height of 1/2 two impacts are cheapest, from 2 one is: costs \
                  0.2106 and 0.0363. With given ends the ball is held for a cost of 10, and thrown down for 3.4667."
            .to_owned(),
        source: Some("W. Clark, thesis, 9.6"),
        panels: vec![
            panel("low", "From a height of 1/2", "--initial x=0.5 --impacts 0..2"),
            panel("high", "From a height of 2", "--initial x=2 --impacts 0..2"),
            panel("fixed", "From 1 to 1, at rest at both ends", "--initial x=1 --end x=1,y=0 --impacts 0..1"),
        ],
    }
}
