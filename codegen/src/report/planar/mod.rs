//! Hypotheses of the Poincare-Bendixson theorem for planar hybrid systems (W. Clark, thesis, Theorem IV.26), with
//! verdicts for a model at given values of its parameters.
//!
//! | file | job |
//! |---|---|
//! | `mod.rs` | the hypotheses and their verdicts |
//! | `graph.rs` | modes, and the surfaces that lead from one to another |
//! | `cascade.rs` | a forward invariant set between two energies: the inequalities (4.13) |
//!
//! Numbers are intervals, rounded outwards: a hypothesis that holds is proved at the given values.

mod cascade;
mod graph;

pub use dalembert_expr::Interval;

use super::{ReportError, declaration};
use crate::claims::digits;
use crate::model::{self, Model};
use crate::spec::Declaration;
pub use cascade::{Cascade, Step};
use graph::Node;

/// Verdict on a hypothesis.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Decided {
    /// It holds.
    Holds,
    /// It does not hold.
    Fails,
    /// It is not decided.
    Open,
}

/// A hypothesis of the theorem.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Hypothesis {
    /// Its name in the thesis: `Q.1`.
    pub name: &'static str,
    /// Its statement.
    pub statement: &'static str,
    /// The verdict.
    pub decided: Decided,
    /// The reason.
    pub reason: String,
}

/// Verdicts on all hypotheses.
#[derive(Debug, Clone, PartialEq)]
pub struct Planar {
    /// The hypotheses, in order.
    pub hypotheses: Vec<Hypothesis>,
    /// The energies along the cycle of modes, if they are known.
    pub cascade: Option<Cascade>,
}

impl Planar {
    /// True if every limit set of the invariant set is a periodic orbit, by the theorem.
    pub fn concludes(&self) -> bool {
        let holds = |hypothesis: &Hypothesis| hypothesis.decided == Decided::Holds;
        self.hypotheses.iter().all(holds)
    }
}

/// The statements, in the order of the thesis.
const STATEMENTS: [(&str, &str); 6] = [
    (
        "Q.1",
        "the state space of every mode is a subset of the plane",
    ),
    ("Q.2", "every map at a surface is injective"),
    (
        "Q.3",
        "a compact set is forward invariant and free of equilibria",
    ),
    (
        "Q.4",
        "the invariant set in each mode has a part for each surface through which the mode is left",
    ),
    (
        "Q.5",
        "each part meets only its own surface, and meets it in an interval",
    ),
    (
        "Q.6",
        "the fields are transverse to surfaces and to their images",
    ),
];

/// Decides the hypotheses for a model at these values of its parameters.
///
/// # Errors
/// [`ReportError`]: a text that declares no model, or a declaration that is refused.
pub fn planar(source: &str, parameters: &[(&str, f64)]) -> Result<Planar, ReportError> {
    let refused = ReportError::Declaration;
    let modes: Vec<Model> = match declaration(source)?.without_claims() {
        Declaration::Model(spec) => vec![model::check(&spec).map_err(refused)?],
        Declaration::Modes(modes) => {
            let graph = model::check_modes(&modes).map_err(refused)?;
            graph.modes.into_iter().map(|mode| mode.model).collect()
        }
    };
    let mut nodes: Vec<Node> = modes
        .into_iter()
        .map(|model| Node::of(model, parameters))
        .collect();
    let edges = graph::edges(&mut nodes);
    let plane = graph::plane(&nodes);
    let cascade = match &plane {
        (Decided::Holds, _) => cascade::cascade(&nodes, &edges),
        _ => Err("Q.1 is not established".to_owned()),
    };
    let found = [
        plane,
        graph::injective(&edges),
        cascade::invariant(&cascade),
        graph::ways_out(&nodes, &edges),
        cascade::interval(&cascade),
        cascade::transverse(&cascade),
    ];
    let hypotheses = STATEMENTS.into_iter().zip(found);
    Ok(Planar {
        hypotheses: hypotheses
            .map(|((name, statement), (decided, reason))| Hypothesis {
                name,
                statement,
                decided,
                reason,
            })
            .collect(),
        cascade: cascade.ok(),
    })
}

/// A verdict with its reason.
type Reasoned = (Decided, String);

/// An interval as text: its middle with eight digits if its relative width is at most 1e-8, otherwise both ends.
pub fn shown(interval: Interval) -> String {
    let middle = 0.5 * interval.lo + 0.5 * interval.hi;
    match interval.hi - interval.lo <= 1e-8 * middle.abs() {
        true => {
            let rounded: f64 = format!("{middle:.7e}").parse().unwrap_or(middle);
            let text = digits(rounded);
            match text.contains('e') {
                true => format!("{rounded:e}"),
                false => text,
            }
        }
        false => format!("[{:?}, {:?}]", interval.lo, interval.hi),
    }
}
