//! Long-run densities of billiards of rigid bodies: W. Clark and A. Bloch, Figures 7 and 8.

use dalembert_cli::gallery::{Density, Figure, Panel, Picture};

use super::chapters;

// The paper discards a thousand positions and then takes a million, one per unit of time.
const EVERY: f64 = 1.0;
const POSITIONS: u64 = 1_000_000;
const DISCARDED: u64 = 1000;

fn panel(name: String, title: String, flags: &str, boxes: usize) -> Panel {
    Panel {
        name,
        title,
        picture: Picture::Density(Density {
            flags: format!("{flags} --tol 1e-8"),
            every: EVERY,
            positions: POSITIONS,
            discarded: DISCARDED,
            boxes,
        }),
    }
}

pub fn of_the_sleigh() -> Figure {
    let tables = ["1", "1.5", "2"];
    let lengths = ["0.1", "0.25", "0.5"];
    let panels = tables.iter().flat_map(|tb| {
        lengths.map(|len| {
            panel(
                format!("{tb}-{len}").replace('.', "_"),
                format!("Half axis tb = {tb}, length len = {len}"),
                &format!("--set tb={tb} --set len={len}"),
                100,
            )
        })
    });
    Figure {
        model: "chaplygin_sleigh",
        name: "density",
        title: "Long-run density of the sleigh",
        chapter: chapters::DENSITIES,
        highlight: Some(0),
        caption: "The fraction of $10^6$ positions, one per unit of time, in each of 100 by 100 boxes, divided by the \
                  area of a box. The first 1000 positions are left out. Rows differ in the half axis of the table \
                  along y, columns in the length of the sleigh. The total variation between the first and the second \
                  half shows how far a picture has converged; chance alone leaves 0.07. The paper does not state its \
                  parameters; these are the model's own."
            .to_owned(),
        source: Some("W. Clark and A. Bloch, Fig. 7"),
        panels: panels.collect(),
    }
}

pub fn of_the_disk() -> Figure {
    let panels = ["0.05", "0.1", "0.15", "0.2"].map(|ta| {
        panel(
            ta.replace('.', "_"),
            format!("Half axis ta = {ta}"),
            &format!("--set ta={ta}"),
            200,
        )
    });
    Figure {
        model: "rolling_disk",
        name: "density",
        title: "Long-run density of the disk",
        chapter: chapters::DENSITIES,
        highlight: None,
        caption: "The fraction of $10^6$ positions, one per unit of time, in each of 200 by 200 boxes, divided by the \
                  area of a box, for several half axes of the table along x. The first 1000 positions are left out. \
                  The total variation between the first and the second half shows how far a picture has converged; \
                  chance alone leaves 0.14. The paper does not state its half axes. On the circle of the last picture \
                  the motion is regular."
            .to_owned(),
        source: Some("W. Clark and A. Bloch, Fig. 8"),
        panels: panels.into(),
    }
}
