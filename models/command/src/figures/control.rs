//! Optimal motions of a ball: W. Clark, thesis, section 9.6.

use dalembert_cli::gallery::{Figure, Panel, Picture};

use super::{QUARTER, THIRD, chapters};

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
    let paths = |more: &str| format!("{more}{WEAK} {STARTS} --axes t,x,u");
    Figure {
        model: "controlled_ball",
        name: "weak",
        title: "A force too weak to hold a ball brings it to a height",
        chapter: chapters::VARIATIONS,
        highlight: None,
        caption: "Paths of least cost from six heights, found by dynamic programming, with $m = 2$, $g = 1$, $T = 5$ and a force between \
                  -1 and 1, half the weight: the ball can rise by bounces alone. On the left the height 1 at the end counts a hundred times \
                  as much as on the right, $alpha = 1000$ and $alpha = 10$; the thesis lets the force cost nothing there, which does not determine \
                  it. The grid has 41 by 41 nodes, 9 forces and 60 steps, in which the force is held."
            .to_owned(),
        source: Some("W. Clark, thesis, Figs. 9.1 and 9.2"),
        panels: vec![
            panel("free", "The height counts", paths("--set alpha=1000 ")),
            panel("dear", "The force counts too", paths("")),
        ],
    }
}

fn displacement() -> Figure {
    let paths = format!("{STRONG} --path x=2 --path x=1.85 --axes t,x,y {THIRD}");
    Figure {
        model: "controlled_ball",
        name: "displacement",
        title: "A motion with a jump, and one beside it",
        chapter: chapters::VARIATIONS,
        highlight: None,
        caption: "Two paths of least cost from rest, at the heights 2 and 1.85, with $m = 2$, $g = 1$, $T = 5$ and $alpha = 10$. At the impact the momentum                   changes its sign. The neighbouring motion has its impact earlier: a variation moves the time of a jump as well as the states on both                   sides, so the costate there satisfies two conditions, one for the states and one for the time."
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
        title: "The least cost that is left",
        chapter: chapters::VARIATIONS,
        highlight: None,
        caption: "The least cost from a height x and a momentum y to the end at $T = 5$, by dynamic programming, with $m = 2$, $g = 1$, \
                  $alpha = 10$ and forces from -4 to 4. The earlier, the more folds: dark valleys are motions that need almost no force with \
                  one number of impacts. White: every motion leaves the grid. The line is the path from rest at 1/2."
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
        title: "Every cost that is left, at one height",
        chapter: chapters::VARIATIONS,
        highlight: None,
        caption: "The costs of all extremals found from the height $x = 1/2$ with a momentum y to the end at $T = 5$, with $m = 2$, $g = 1$ and \
                  $alpha = 10$. The cost has many values, the more the earlier; the line is the least of them, the section of the figure before. Colours are numbers \
                  of impacts, with no more than two until the end, and than one in its last second. The thesis shows what comes backwards from \
                  $x = 0.9$ to 1.1 and $y = -4$ to 4 at the end; here extremals to all ends are shown."
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
        title: "The number of impacts that costs least",
        chapter: chapters::VARIATIONS,
        highlight: None,
        caption: "The number of impacts of the best motion from a height x and a momentum y at $t = 0$, with $m = 2$, $g = 1$, $T = 5$ and \
                  $alpha = 10$. From rest at 1/2 two impacts are best, at 2 one is; a ball at rest near the floor takes more. Numbers are interpolated \
                  on the grid, so that bounds of regions are known to about a node."
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
        caption: "Extremals from rest at height 1 to rest at height 1 in time 5, with $m = 2$ and $g = 1$. The cheapest with one impact costs \
                  3.4667, 3.4923, 3.5841 and 3.7537 for the coefficients 1, 0.9, 0.8 and 0.7; to hold the ball costs $m^2*g^2*T/2 = 10$. \
                  With two impacts the costs are 0.2743, 0.3695, 0.6877 and 1.2648. \
                  The first picture has the costs of all extremals found over the coefficient."
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
        caption: "Extremals of the integral of $u^2/2$ and of $10*(x - 1)^2$ at the end, with $m = 2$, $g = 1$, $T = 5$, and no more than two \
                  impacts. The force is linear between impacts. From a height of 1/2 two impacts are cheapest, from 2 one is: costs \
                  0.2106 and 0.0363; on a grid of 41 by 41 nodes and 60 steps, in which the force is held, the same paths cost 0.2310 and 0.0370. With given ends the ball is held for a cost of 10, and thrown down for 3.4667."
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
