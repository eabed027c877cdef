//! Work-precision diagrams, measured on the machine that makes the gallery.

use dalembert_cli::gallery::{Figure, Panel, Picture};

use super::chapters;

/// Runs that are neither trivial nor chaotic within their time, with and without constraints and impacts.
const RUNS: [(&str, &str); 3] = [
    ("chaplygin_sleigh", "--until 5"),
    ("double_pendulum", "--until 3"),
    ("rolling_disk", "--until 5"),
];

pub fn figures() -> Vec<Figure> {
    let figure = |(model, flags): (&'static str, &str)| {
        Figure {
        model,
        name: "work",
        title: "Work and precision of the integrators",
        chapter: chapters::COST,
        highlight: (model == "double_pendulum").then_some(0),
        caption: "Time on this machine against the measured error of the positions, for every integrator at several \
                  tolerances or steps. Rings mark the fastest case of each decade. Only these pictures differ from one \
                  gallery to the next, because their times are measured."
            .to_owned(),
        source: None,
        panels: vec![Panel {
            name: String::new(),
            title: format!("{model} {flags}").replace("--", ""),
            picture: Picture::Accuracy(format!("{flags} --rounds 3 --patience 0.3")),
        }],
    }
    };
    RUNS.map(figure).into()
}
