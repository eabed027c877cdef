//! Gaits and falls of a walker with foot slip (W. Clark, thesis, Figures 4.4, 4.5, 10.1 and 10.2), and gaits that
//! double their period.

use dalembert_cli::gallery::{Figure, Panel, Picture};

use super::chapters;

/// As in the thesis, a walk counts as periodic after fifty steps, and a walker falls when its leg passes the horizontal.
const WALK: &str = "--returns 50 --fail 'theta > pi/2' --tol 1e-7";

pub fn figures() -> Vec<Figure> {
    vec![gaits(), basin(), doubling()]
}

/// Tongues (Figures 10.1 and 10.2).
pub fn tongues() -> Vec<Figure> {
    vec![mathieu(), fixed_start()]
}

fn mapped(name: &str, title: &str, flags: String) -> Panel {
    Panel {
        name: name.to_owned(),
        title: title.to_owned(),
        picture: Picture::Map(flags),
    }
}

fn gaits() -> Figure {
    // The steady gait of a walker whose foot does not slip.
    let start = "--start 'xi = -cos(2*delta)/sin(2*delta)*sqrt(4*mu/(eps*(1 + mu))*sin(delta)*sin(alpha))' \
                 --start 'eta = cos(delta)*cos(2*delta)/sin(2*delta)*sqrt(4*mu/(eps*(1 + mu))*sin(delta)*sin(alpha))'";
    let panel = |name: &str, eps: &str| {
        let title = format!("ε = {eps}");
        let axes = "--vary alpha=0.01..0.8:96 --vary delta=0.02..0.76:96";
        let flags = format!("{axes} --set eps={eps} {start} {WALK} --lyapunov 2 --class lyapunov");
        mapped(name, &title, flags)
    };
    Figure {
        model: "dimensionless_walker",
        name: "gaits",
        title: "Slopes and steps for which a walker finds a gait",
        chapter: chapters::WALKERS,
        highlight: None,
        caption: "Colours show the mean logarithm of the growth of a small deviation per step, which is the logarithm \
                  of the largest multiplier of the gait. White cells are walkers that fall within 50 steps. Each \
                  walker begins with the gait of a foot that does not slip, as in Appendix A of the thesis, with $mu = \
                  5/2$. Longer steps lead faster to the gait. The thesis does not state its axes, and its equations \
                  have a wrong sign in the centripetal term. With the right sign, short steps do not lead to falls if \
                  friction is large (small $eps$)."
            .to_owned(),
        source: Some("W. Clark, thesis, Fig. 4.4"),
        panels: vec![panel("friction", "0.1"), panel("slip", "2")],
    }
}

fn basin() -> Figure {
    Figure {
        model: "dimensionless_walker",
        name: "basin",
        title: "Starts from which a walker keeps walking or falls",
        chapter: chapters::WALKERS,
        highlight: Some(0),
        caption: "The blue starts lead to the gait, which the dot marks. From the other starts the walker falls \
                  before its first step. The parameters are $mu = 5/2$, $eps = 1/2$ and $alpha = delta = 0.4$. The line \
                  consists of the starts in the stable plane of the upright equilibrium, which has the eigenvalues \
                  0.688755, -0.478938 and -2.747673. The thesis takes this line for the boundary; it is the boundary \
                  near the equilibrium. With the right sign of the centripetal term no walker falls after its first \
                  step, and the tongues of the thesis do not appear."
            .to_owned(),
        source: Some("W. Clark, thesis, Fig. 4.5"),
        panels: vec![mapped(
            "",
            "Starts (η, ξ) after a step",
            format!(
                "--vary eta=-2..2:400 --vary xi=-3..1:400 {WALK} --contour 'xi = -0.988692*(sin(alpha) - eta)'"
            ),
        )],
    }
}

fn mathieu() -> Figure {
    Figure {
        model: "mathieu",
        name: "tongues",
        title: "Tongues of Mathieu's equation",
        chapter: chapters::TONGUES,
        highlight: None,
        caption: "Growth of the solutions of $dot(dot(x)) + (delta + eps*cos(t))*x = 0$ per period: the logarithm of \
                  the largest multiplier of $x = 0$. Dark cells are stable. Tongues of instability begin at $delta = \
                  1/4$ and 1. The lines are the boundaries of the first tongue, as series to third order in $eps$. The \
                  thesis shows the stable starts of the walker beside it, which are those of its Fig. 4.5 above."
            .to_owned(),
        source: Some("W. Clark, thesis, Fig. 10.1, right"),
        panels: vec![mapped(
            "",
            "Growth over the plane of parameters",
            "--vary delta=-0.5..1.75:120 --vary eps=0..1.2:96 --initial x=0 --returns 4 --until 1000 --tol 1e-8 --lyapunov 12 \
             --class lyapunov --contour 'delta = 1/4 - eps/2 - eps^2/8 + eps^3/32' --contour 'delta = 1/4 + eps/2 - eps^2/8 - eps^3/32'"
                .to_owned(),
        )],
    }
}

fn fixed_start() -> Figure {
    let panel = |name: &str, title: &str, axes: &str| {
        let start = "--initial xi=-1,eta=0 --start 'theta = delta'";
        mapped(
            name,
            title,
            format!("{axes} {start} {WALK} --lyapunov 2 --class lyapunov"),
        )
    };
    Figure {
        model: "dimensionless_walker",
        name: "tongues",
        title: "Slopes and steps for which a walker keeps walking from one start",
        chapter: chapters::TONGUES,
        highlight: None,
        caption: "The walker with $mu = 5/2$ and $eps = 1/2$ after a step with $xi = -1$, $eta = 0$. Colours show the \
                  mean logarithm of the growth of a small deviation per step; white cells are walkers that fall within \
                  50 steps. The boundary is one line: steps that are too long for the slope lead to falls. The thesis \
                  finds tongues of stability, with a wrong sign of the centripetal term in its equations. It states \
                  neither its axes nor its parameters."
            .to_owned(),
        source: Some("W. Clark, thesis, Fig. 10.2"),
        panels: vec![
            panel("all", "Slopes and steps", "--vary alpha=0.01..0.8:72 --vary delta=0.02..0.76:72"),
            panel("part", "Gentle slopes", "--vary alpha=0.005..0.1:72 --vary delta=0.02..0.4:72"),
        ],
    }
}

fn doubling() -> Figure {
    let panel = |name: &str, title: &str, flags: &str| Panel {
        name: name.to_owned(),
        title: title.to_owned(),
        picture: Picture::Branch(format!("--surface heel --axis theta {flags}")),
    };
    Figure {
        model: "compass_walker",
        name: "doubling",
        title: "Gaits of the simplest walker over the slope",
        chapter: chapters::WALKERS,
        highlight: None,
        caption: "Every point is a gait: the angle of the stance leg before the heel strikes. The long gait becomes \
                  unstable at a slope of $0.015088$, where a multiplier passes $-1$. A gait of two different steps \
                  branches off there; its period doubles at 0.017669."
            .to_owned(),
        source: Some("M. Garcia et al., J. Biomech. Eng. 120 (1998)"),
        panels: vec![
            panel("one", "One step", "--continue gamma=0.001..0.019"),
            panel(
                "two",
                "Two steps",
                "--period 2 --set gamma=0.017 --initial theta=0.25,phi=0.5,omega=-0.24,psi=-0.03 --continue gamma=0.0151..0.019",
            ),
        ],
    }
}
