//! Continuation: a branch of periodic orbits over one parameter, with its bifurcations, and the curves of these
//! bifurcations over two parameters.
//!
//! | file | job |
//! |---|---|
//! | `family` | one member of a branch and its neighbours, independent of the type of the system |
//! | `orbits` | the members that are periodic orbits of a section |
//! | `curves` | the members that are bifurcations over two parameters |
//! | `trace` | pseudo-arclength continuation with steps adapted to the branch |
//! | `indicator` | test functions of bifurcations |
//! | `locate` | zeros of the test functions |
//! | `rotated` | underdetermined linear equations |

pub(crate) mod curves;
pub(crate) mod family;
pub(crate) mod indicator;
mod locate;
pub(crate) mod orbits;
mod rotated;
pub(crate) mod trace;

use dalembert::{OrbitError, ParameterError};

use crate::model::Point;

/// A parameter and its range.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Extent {
    /// The index of the parameter.
    pub parameter: usize,
    /// Both ends of the range. The second one may be lower than the first.
    pub range: [f64; 2],
}

impl Extent {
    /// The length of the range, the unit of the parameter.
    pub fn width(&self) -> f64 {
        (self.range[1] - self.range[0]).abs()
    }

    /// The range in increasing order.
    pub(crate) fn limits(&self) -> [f64; 2] {
        let [first, last] = self.range;
        [f64::min(first, last), f64::max(first, last)]
    }
}

/// Request for a branch.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Continuation {
    /// The parameter over which the orbit is followed.
    pub extent: Extent,
    /// A second parameter, over which the bifurcations of the branch are followed.
    pub across: Option<Extent>,
    /// Maximum number of points in either direction.
    pub points: u32,
}

/// A branch of periodic orbits.
#[derive(Debug, Clone)]
pub struct Branch {
    /// Its points in order along the branch, from the side of the first end of the range.
    pub points: Vec<Member>,
    /// Both ends of the branch.
    pub ends: [BranchEnd; 2],
    /// The curves of its bifurcations over two parameters, if requested. A curve through several of them is listed
    /// once.
    pub curves: Vec<BifurcationCurve>,
}

/// A curve of bifurcations in the plane of two parameters.
#[derive(Debug, Clone)]
pub struct BifurcationCurve {
    /// The bifurcation.
    pub bifurcation: Bifurcation,
    /// Its points in order along the curve, from the side of the first end of the second range.
    pub points: Vec<Member>,
    /// Both ends of the curve.
    pub ends: [BranchEnd; 2],
}

/// A point of a branch.
#[derive(Debug, Clone)]
pub struct Member {
    /// The value of the parameter.
    pub parameter: f64,
    /// The value of the second parameter, on a curve of bifurcations.
    pub second: Option<f64>,
    /// The period.
    pub period: f64,
    /// The point of the section.
    pub before: Point,
    /// The state after the event at the section.
    pub after: Point,
    /// Distance between the point of the section and its image.
    pub residual: f64,
    /// The group element up to which the orbit closes: the flow time of each symmetry.
    pub element: Vec<f64>,
    /// The Floquet multipliers: real and imaginary parts.
    pub multipliers: Vec<[f64; 2]>,
    /// The stability by these multipliers.
    pub stability: Stability,
    /// The bifurcation at this point.
    pub bifurcation: Option<Bifurcation>,
    /// The state, in the components of its family.
    pub(crate) state: Vec<f64>,
}

/// Stability to first order.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stability {
    /// All multipliers lie inside the unit circle.
    Stable,
    /// No multiplier lies outside the unit circle, and some lie on it.
    Neutral,
    /// Some multiplier lies outside the unit circle.
    Unstable,
}

impl Stability {
    /// The name in tables and documents.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Stable => "stable",
            Self::Neutral => "neutral",
            Self::Unstable => "unstable",
        }
    }
}

/// A bifurcation of codimension one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Bifurcation {
    /// The branch turns back in the parameter; a multiplier is 1.
    Fold,
    /// A multiplier passes through -1: an orbit of twice the period branches off.
    Flip,
    /// A pair of complex multipliers crosses the unit circle: an invariant circle branches off.
    NeimarkSacker,
    /// A multiplier passes through 1 without a fold: another branch of orbits crosses this one.
    BranchPoint,
}

impl Bifurcation {
    /// The name in tables and documents.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Fold => "fold",
            Self::Flip => "flip",
            Self::NeimarkSacker => "neimark_sacker",
            Self::BranchPoint => "branch_point",
        }
    }
}

/// Reason why a branch ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum BranchEnd {
    /// The branch reaches an end of the range exactly.
    Range,
    /// The orbit grazes a surface.
    Grazing {
        /// The surface.
        surface: usize,
    },
    /// The orbit shrinks to an equilibrium: a Hopf bifurcation.
    Equilibrium {
        /// The value of the parameter at the equilibrium, extrapolated.
        parameter: f64,
    },
    /// The branch has returned to its first point.
    Closed,
    /// The declaration of the parameter refuses the next value.
    Parameter(ParameterError),
    /// The return map is not defined beyond this point.
    Missed(OrbitError),
    /// Multipliers or test functions of the next point are not finite, so that its stability is unknown.
    NotKnown,
    /// The two multipliers of a Neimark-Sacker bifurcation meet at 1 or -1: a strong resonance.
    Resonance,
    /// Newton's method does not converge at the smallest step.
    NotConverged,
    /// The maximum number of points was reached.
    Points,
    /// The branch turns back before it reaches the range.
    Turned,
}

impl BranchEnd {
    /// All kinds.
    pub const KINDS: [&'static str; 11] = [
        "range",
        "grazing",
        "equilibrium",
        "closed",
        "parameter",
        "missed",
        "not_known",
        "resonance",
        "not_converged",
        "points",
        "turned",
    ];

    /// The kind in snake case, as documents write it.
    pub const fn kind(&self) -> &'static str {
        match self {
            Self::Range => "range",
            Self::Grazing { .. } => "grazing",
            Self::Equilibrium { .. } => "equilibrium",
            Self::Closed => "closed",
            Self::Parameter(_) => "parameter",
            Self::Missed(_) => "missed",
            Self::NotKnown => "not_known",
            Self::Resonance => "resonance",
            Self::NotConverged => "not_converged",
            Self::Points => "points",
            Self::Turned => "turned",
        }
    }
}

#[cfg(test)]
mod tests {
    use dalembert::describe::Assumption;

    use super::*;

    #[test]
    fn all_kinds_of_ends_are_listed() {
        let error = ParameterError {
            name: "k",
            value: 0.0,
            expected: Assumption::Positive,
        };
        let ends = [
            BranchEnd::Range,
            BranchEnd::Grazing { surface: 0 },
            BranchEnd::Equilibrium { parameter: 0.0 },
            BranchEnd::Closed,
            BranchEnd::Parameter(error),
            BranchEnd::Missed(OrbitError::DependsOnTime),
            BranchEnd::NotKnown,
            BranchEnd::Resonance,
            BranchEnd::NotConverged,
            BranchEnd::Points,
            BranchEnd::Turned,
        ];
        assert_eq!(ends.map(|end| end.kind()), BranchEnd::KINDS);
    }
}
