//! Motions of a ball between two points and their action: W. Clark, thesis, Figures 8.1 to 8.5.

use dalembert_cli::gallery::{Figure, Panel, Picture};

use super::{HALF, chapters, simulated};

/// The flags of the abbreviated action, the integral of the momentum along the path.
const ALONG_THE_WAY: &str = "--output 'W = integral(momentum(x)*dot(x))' --axes x,W";

/// All figures, in the order of the thesis.
pub fn figures() -> Vec<Figure> {
    vec![bouncing_ball(), action(), oscillator(), nested()]
}

fn bouncing_ball() -> Figure {
    let panel = |name: &str, title: &str, flags: &str| Panel {
        name: name.to_owned(),
        title: title.to_owned(),
        picture: Picture::Connect(format!("--from x=0 --to x=0.2 --time 5 {flags} {HALF}")),
    };
    Figure {
        model: "bouncing_ball",
        name: "connections",
        title: "Every motion from one point to another in a given time",
        chapter: chapters::VARIATIONS,
        highlight: Some(0),
        caption: "A ball with $m = g = 1$ goes from $x = 0$ to $x = 0.2$ in time 5 with at most three impacts: once \
                  without an impact, and twice with each other number, rising or falling at the end. The dots are \
                  conjugate points of other starts. They lie on the boundary of the region that k impacts reach, $x = \
                  g*t^2/(8*k*(k + 1))$, where both motions coincide. A motion that touches a boundary before its end \
                  does not have least action."
            .to_owned(),
        source: Some("W. Clark, thesis, Fig. 8.1"),
        panels: vec![
            panel("bounds", "Bounds of one, two and three impacts", "--impacts 1..3 --envelope 150"),
            panel("paths", "Motions with no more than three impacts", "--impacts 0..3"),
        ],
    }
}

fn action() -> Figure {
    let section = |name: &str, time: f64| {
        // Initial speeds from just above `t/12`, with five impacts until `t`, to motions without an impact.
        let (slow, fast) = (time / 12.0 + 0.001, 0.5 * time + 0.45);
        let flags = format!(
            "--vary x_dot={slow:.3}..{fast:.3}:960 --set m=1 --initial x=0 --until {time} --returns 100 --class returns \
             --output 'S = integral(lagrangian)' --axes x,S --tol 1e-9"
        );
        Panel {
            name: name.to_owned(),
            title: format!("t = {time}"),
            picture: Picture::Map(flags),
        }
    };
    Figure {
        model: "bouncing_ball",
        name: "action",
        title: "The action of all motions from one point",
        chapter: chapters::VARIATIONS,
        highlight: None,
        caption: "The position at three times of a ball with $m = g = 1$ that starts at $x = 0$, and the action of its \
                  motion, for all initial speeds with at most five impacts. Colours show the number of impacts. The \
                  action has several values, because several motions lead to the same position. Branches join at \
                  corners on the left, where an impact happens at that time, and at cusps on the right, where $x = \
                  g*t^2/(8*k*(k + 1))$ is the farthest position that k impacts reach. The thesis shows the whole \
                  surface in its Figure 8.2."
            .to_owned(),
        source: Some("W. Clark, thesis, Figs. 8.2 and 8.3"),
        panels: vec![section("early", 2.0), section("middle", 3.5), section("late", 5.0)],
    }
}

fn level_sets(name: &str, flags: &str) -> Panel {
    let levels = ["0.25", "0.5", "1", "1.5"].map(|level| format!("--contour 'energy = {level}'"));
    Panel {
        name: name.to_owned(),
        title: "Levels of the energy".to_owned(),
        picture: Picture::Map(format!(
            "{flags} --until 1e-3 --class energy {}",
            levels.join(" ")
        )),
    }
}

fn oscillator() -> Figure {
    Figure {
        model: "harmonic_oscillator",
        name: "foliation",
        title: "The foliation of an oscillator, and the action along a leaf",
        chapter: chapters::VARIATIONS,
        highlight: None,
        caption: "Left: the levels of the energy with $m = k = 1$ are circles, Lagrangian submanifolds of the plane of position and momentum. Right: \
                  the integral of $p*d(x)$ along the leaf of energy 1/2, over two turns. It solves the stationary Hamilton-Jacobi equation and has \
                  many values: every turn adds the area $pi$ of the circle."
            .to_owned(),
        source: Some("W. Clark, thesis, Fig. 8.4"),
        panels: vec![
            level_sets("leaves", "--vary x=-2..2:160 --vary x_dot=-2..2:160"),
            simulated("action", "Action along the leaf of energy 1/2", &format!("--until 4*pi {ALONG_THE_WAY}")),
        ],
    }
}

fn nested() -> Figure {
    Figure {
        model: "bouncing_ball",
        name: "foliation",
        title: "The hybrid foliation of a bouncing ball, and the action along a leaf",
        chapter: chapters::VARIATIONS,
        highlight: None,
        caption: "Left: the levels of the energy with $m = g = 1$ are nested parabolas; an impact leads from the lower \
                  end of each to its upper end. Right: the integral of $p*d(x)$ along the leaf of energy 1, over five \
                  flights. The ball is a hybrid oscillator: if the impact joins both ends of each leaf, the leaves are \
                  circles. Every flight adds the area $4*sqrt(2)/3$ between the leaf and the floor."
            .to_owned(),
        source: Some("W. Clark, thesis, Fig. 8.5"),
        panels: vec![
            level_sets("leaves", "--vary x=0..2:160 --vary x_dot=-2..2:160"),
            simulated("action", "Action along the leaf of energy 1", &format!("--until 14 {ALONG_THE_WAY}")),
        ],
    }
}
