//! Optimal motions of a ball: W. Clark, thesis, section 9.6.

use dalembert_cli::gallery::{Figure, Panel, Picture};

use super::{HALF, QUARTER, THIRD, chapters};

/// The grids of dynamic programming, with inputs weaker than gravity and with strong ones.
const WEAK: &str = "--dp x=0..3:41,y=-5.5..5.5:41,u=-1..1:9 --steps 60";
const STRONG: &str = "--dp x=0..3:41,y=-6..6:41,u=-4..4:13 --steps 60";

/// Starts of paths.
const STARTS: &str = "--path x=0.25 --path x=0.5 --path x=1 --path x=1.5 --path x=2 --path x=2.5";

/// All figures, in the order of the thesis.
pub fn figures() -> Vec<Figure> {
    vec![
        weak_forces(),
        displacement(),
        controlled_ball(),
        least_cost(),
        sections(),
        impacts(),
        restitution(),
    ]
}

fn panel(name: &str, title: &str, flags: impl Into<String>) -> Panel {
    Panel {
        name: name.to_owned(),
        title: title.to_owned(),
        picture: Picture::Control(flags.into()),
    }
}

fn weak_forces() -> Figure {
    let paths = |more: &str| format!("{more}{WEAK} {STARTS} --axes t,x,u {HALF}");
    Figure {
        model: "controlled_ball",
        name: "weak",
        title: "A force too weak to hold a ball brings it to a height",
        chapter: chapters::VARIATIONS,
        highlight: None,
        caption: "Paths of least cost from six heights, by dynamic programming, with $m = 2$, $g = 1$ and $T = 5$. The \
                  force lies between -1 and 1, half of the weight, so the ball rises only by bounces. In the left \
                  picture the height 1 at the end has a hundred times the weight of the right one: $alpha = 1000$ and \
                  $alpha = 10$. In the thesis the force of the left picture costs nothing, so it is not determined. \
                  The grid has 41 by 41 nodes, 9 forces and 60 steps; the force is constant in each step."
            .to_owned(),
        source: Some("W. Clark, thesis, Figs. 9.1 and 9.2"),
        panels: vec![
            panel("free", "Large weight of the height", paths("--set alpha=1000 ")),
            panel("dear", "Small weight of the height", paths("")),
        ],
    }
}

fn displacement() -> Figure {
    let paths = format!("{STRONG} --path x=2 --path x=1.85 --axes t,x,y {THIRD}");
    Figure {
        model: "controlled_ball",
        name: "displacement",
        title: "A motion with a jump, and a neighbouring motion",
        chapter: chapters::VARIATIONS,
        highlight: None,
        caption: "Two paths of least cost from rest at the heights 2 and 1.85, with $m = 2$, $g = 1$, $T = 5$ and \
                  $alpha = 10$. The momentum changes its sign at the impact. The neighbouring motion has its impact \
                  earlier: a variation changes the time of a jump as well as the states on both sides. Therefore the \
                  costate satisfies two conditions there, one for the states and one for the time."
            .to_owned(),
        source: Some("W. Clark, thesis, Fig. 9.3"),
        panels: vec![panel("", "", paths)],
    }
}

fn least_cost() -> Figure {
    let map = |name: &str, title: &str, t: &str| {
        let flags = format!("{STRONG} --at {t} {THIRD}");
        panel(name, title, flags)
    };
    Figure {
        model: "controlled_ball",
        name: "least",
        title: "The least cost to the end",
        chapter: chapters::VARIATIONS,
        highlight: None,
        caption: "The least cost from a height x and a momentum y to the end at $T = 5$, by dynamic programming, with \
                  $m = 2$, $g = 1$, $alpha = 10$ and forces from -4 to 4. At earlier times the cost has more folds. \
                  Dark valleys are motions that need almost no force with one number of impacts. From white states \
                  every motion leaves the grid. The line is the path from rest at 1/2."
            .to_owned(),
        source: Some("W. Clark, thesis, Fig. 9.5"),
        panels: vec![
            map("late", "One second before the end", "4"),
            map("half", "Half the time before the end", "2.5"),
            map("first", "At the start", "0"),
        ],
    }
}

fn sections() -> Figure {
    let section = |name: &str, left: &str, t: &str, most: u32| {
        let title = format!("At t = {t}");
        let flags = format!(
            "--initial x=0.5 --vary y=-4..4:81 --until {left} --impacts 0..{most} --starts 48 {THIRD}"
        );
        panel(name, &title, flags)
    };
    Figure {
        model: "controlled_ball",
        name: "sections",
        title: "The costs of all extremals from one height",
        chapter: chapters::VARIATIONS,
        highlight: None,
        caption: "The costs of all extremals that were found from the height $x = 1/2$ with a momentum y to the end at \
                  $T = 5$, with $m = 2$, $g = 1$ and $alpha = 10$. At earlier times the cost has more values. The line \
                  is the least of them, a section of the figure before. Colours show the number of impacts: at most \
                  two, and at most one in the last second. The thesis shows the motions that arrive between $x = 0.9$ \
                  and 1.1 with $y = -4$ to 4; here the ends are free."
            .to_owned(),
        source: Some("W. Clark, thesis, Fig. 9.5, right column"),
        panels: vec![
            section("late", "1", "4", 1),
            section("half", "2.5", "2.5", 2),
            section("first", "5", "0", 2),
        ],
    }
}

fn impacts() -> Figure {
    Figure {
        model: "controlled_ball",
        name: "impacts",
        title: "The number of impacts of the best motion",
        chapter: chapters::VARIATIONS,
        highlight: None,
        caption: "The number of impacts of the best motion from a height x and a momentum y at $t = 0$, with $m = 2$, \
                  $g = 1$, $T = 5$ and $alpha = 10$. From rest at 1/2 two impacts are best, from rest at 2 one impact \
                  is; a ball at rest near the floor takes more. Numbers are interpolated on the grid, so the \
                  boundaries of regions are accurate to about one node."
            .to_owned(),
        source: Some("W. Clark, thesis, Fig. 9.6"),
        panels: vec![panel("", "", format!("{STRONG} --show impacts --path x=0.5 --path x=2"))],
    }
}

fn restitution() -> Figure {
    let with = |e: &str| {
        let name = format!("e{}", e.replace('.', ""));
        let title = format!("Coefficient of restitution {e}");
        let flags =
            format!("--initial x=1 --end x=1,y=0 --impacts 1..2 --starts 24 --set e={e} {QUARTER}");
        panel(&name, &title, flags)
    };
    let curve = panel(
        "costs",
        "Costs over the coefficient",
        "--initial x=1 --end x=1,y=0 --impacts 0..2 --starts 48 --vary e=0.5..1:41",
    );
    Figure {
        model: "controlled_ball",
        name: "loss",
        title: "Impacts that lose energy still save force",
        chapter: chapters::VARIATIONS,
        highlight: None,
        caption: "Extremals from rest at height 1 to rest at height 1 in time 5, with $m = 2$ and $g = 1$. With one \
                  impact the least costs are 3.4667, 3.4923, 3.5841 and 3.7537 for the coefficients 1, 0.9, 0.8 and \
                  0.7. To hold the ball costs $m^2*g^2*T/2 = 10$. With two impacts the costs are 0.2743, 0.3695, \
                  0.6877 and 1.2648. The first picture shows the costs of all extremals that were found against the \
                  coefficient."
            .to_owned(),
        source: Some("W. Clark, thesis, Fig. 9.7"),
        panels: [curve]
            .into_iter()
            .chain(["1", "0.9", "0.8", "0.7"].map(with))
            .collect(),
    }
}

fn controlled_ball() -> Figure {
    Figure {
        model: "controlled_ball",
        name: "optimal",
        title: "The least force that brings a ball to a height",
        chapter: chapters::VARIATIONS,
        highlight: None,
        caption: "Extremals of the integral of $u^2/2$ plus $10*(x - 1)^2$ at the end, with $m = 2$, $g = 1$, $T = 5$, \
                  and at most two impacts. The force is linear in time between impacts. From a height of 1/2 two \
                  impacts are cheapest, from 2 one impact is; the costs are 0.2106 and 0.0363. On a grid of 41 by 41 \
                  nodes and 60 steps of constant force the same paths cost 0.2310 and 0.0370. With fixed ends it costs \
                  10 to hold the ball, and 3.4667 to throw it down."
            .to_owned(),
        source: Some("W. Clark, thesis, Fig. 9.4"),
        panels: vec![
            panel("low", "From a height of 1/2", "--initial x=0.5 --impacts 0..2"),
            panel("high", "From a height of 2", "--initial x=2 --impacts 0..2"),
            panel("grid", "From both by dynamic programming", format!("{STRONG} --path x=0.5 --path x=2 --axes t,x,y,u")),
            panel("fixed", "From 1 to 1, at rest at both ends", "--initial x=1 --end x=1,y=0 --impacts 0..1"),
        ],
    }
}
