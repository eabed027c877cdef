//! The rolling disk on its table: W. Clark, thesis, Figures 6.2 to 6.4.

use dalembert_cli::gallery::{Figure, Panel, Picture, Starts};

use super::{QUARTER, THIRD, chapters, simulated};

/// Half axes of the table along x, from the circle to the ellipse of the thesis.
const CIRCLE: &str = "--set ta=0.2";
const NEARLY: &str = "--set ta=0.199";
const ELLIPSE: &str = "--set ta=0.15";

pub fn figures() -> Vec<Figure> {
    vec![paths(), starts(), momenta()]
}

fn paths() -> Figure {
    let plastic = "--law nonholonomic_plastic";
    Figure {
        model: "rolling_disk",
        name: "impacts",
        title: "The first 20 impacts, elastic and plastic",
        chapter: chapters::BILLIARDS,
        highlight: None,
        caption: "The path of the point of contact on a circular table (half axis 0.2) and on an elliptical one \
                  (0.15). Elastic impacts on the circle keep an order that is lost on the ellipse. The plastic law is \
                  the nonholonomic plastic one, which the thesis derives for the disk. On the circle its impacts tend \
                  to grazing: after 14 of them the disk runs on a circle that touches the rim, and has no further \
                  impact within the tolerance. Therefore that picture ends at a given time."
            .to_owned(),
        source: Some("W. Clark, thesis, Fig. 6.2"),
        panels: vec![
            simulated(
                "a",
                "(a) Elastic impacts on a circular table",
                &format!("--impacts 20 {CIRCLE} {QUARTER}"),
            ),
            simulated(
                "b",
                "(b) Plastic impacts on a circular table",
                &format!("--until 60 {CIRCLE} {plastic} {QUARTER}"),
            ),
            simulated(
                "c",
                "(c) Elastic impacts on an elliptical table",
                &format!("--impacts 20 {ELLIPSE} {QUARTER}"),
            ),
            simulated(
                "d",
                "(d) Plastic impacts on an elliptical table",
                &format!("--impacts 20 {ELLIPSE} {plastic} {QUARTER}"),
            ),
        ],
    }
}

fn starts() -> Figure {
    let panel = |name: &str, words: &str, table: &str, until: u32| Panel {
        name: format!("{name}-{until}"),
        title: format!("{words} table, t = {until}"),
        picture: Picture::Starts(Starts {
            flags: format!("{table} --until {until}"),
            members: 100,
            scatter: vec![("theta_dot", 10.0, 0.005), ("phi_dot", 0.2, 0.005)],
            seed: 1,
        }),
    };
    let times = [10, 20, 40, 80];
    let circle = times.map(|until| panel("circle", "Circular", CIRCLE, until));
    let ellipse = times.map(|until| panel("ellipse", "Elliptical", ELLIPSE, until));
    Figure {
        model: "rolling_disk",
        name: "starts",
        title: "100 starts near each other at various times",
        chapter: chapters::BILLIARDS,
        highlight: Some(7),
        caption: "The points of contact of 100 disks that start as in Fig. 6.2, except that $theta_dot$ and $phi_dot$ \
                  are scattered evenly by at most 0.005 rad/s. Impacts are elastic. On the ellipse nearby motions soon \
                  spread over the whole table. The thesis does not state its times."
            .to_owned(),
        source: Some("W. Clark, thesis, Fig. 6.3"),
        panels: circle.into_iter().chain(ellipse).collect(),
    }
}

fn momenta() -> Figure {
    let tables = [
        ("circle", "Circular table, half axes 0.2 and 0.2", CIRCLE),
        (
            "nearly",
            "Slightly elliptical table, half axes 0.199 and 0.2",
            NEARLY,
        ),
        (
            "ellipse",
            "Elliptical table, half axes 0.15 and 0.2",
            ELLIPSE,
        ),
    ];
    let plane = tables.map(|(name, title, table)| {
        let flags = format!("--impacts 100 {table} --axes p_theta,p_phi {THIRD}");
        simulated(name, title, &flags)
    });
    let time = tables.map(|(name, title, table)| {
        let flags = format!("--impacts 40 {table} --axes t,p_phi {THIRD}");
        simulated(
            &format!("{name}-time"),
            format!("{title}; over time"),
            &flags,
        )
    });
    Figure {
        model: "rolling_disk",
        name: "momentum",
        title: "The nonholonomic momentum from impact to impact",
        chapter: chapters::BILLIARDS,
        highlight: None,
        caption: "The momenta are constant between impacts, and the conserved energy keeps them on an ellipse. Every \
                  chord is an impact. On the circular table the momenta have period 2, on the slightly elliptical one \
                  nearly so, and on the elliptical one their order is lost. The momenta are those of the declared \
                  coordinates on the constraints, $p_theta = I*theta_dot$ and $p_phi = J*phi_dot$. The thesis does not \
                  state its slightly elliptical table."
            .to_owned(),
        source: Some("W. Clark, thesis, Fig. 6.4"),
        panels: plane.into_iter().chain(time).collect(),
    }
}
