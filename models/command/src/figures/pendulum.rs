//! Starts from which a double pendulum turns over.

use dalembert_cli::gallery::{Figure, Panel, Picture};

use super::chapters;

pub fn flips() -> Figure {
    Figure {
        model: "double_pendulum",
        name: "flips",
        title: "Starts at rest from which the lower arm turns over",
        chapter: chapters::CHAOS,
        highlight: Some(0),
        caption: "Each cell is a start at rest. Its colour shows if the lower arm passes the upright position within \
                  20 units of time. Inside the line $2*cos(theta1) + cos(theta2) = 1$ the energy does not suffice. \
                  Near the boundary neighbouring starts have different results."
            .to_owned(),
        source: None,
        panels: vec![Panel {
            name: String::new(),
            title: "Starts (θ₁, θ₂) at rest".to_owned(),
            picture: Picture::Map(
                "--vary theta1=-3..3:160 --vary theta2=-3..3:160 --until 20 --tol 1e-8 --fail 'theta2^2 > pi^2' \
                 --contour '2*cos(theta1) + cos(theta2) = 1'"
                    .to_owned(),
            ),
        }],
    }
}
