//! Work counters: the cost of a run, part of its result.

/// Amount of each kind of work in a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub struct Counters {
    /// Evaluations of the vector field, including those of rejected steps. In the discrete Lagrange-d'Alembert
    /// principle, a force together with the constrained velocity takes as much work and counts as one evaluation.
    pub rate_evaluations: u64,
    /// Expansions of the motion in a power series.
    pub expansions: u64,
    /// Sum of the orders of these expansions. Their cost grows with the squares of the orders.
    pub coefficients: u64,
    /// Accepted steps: their error estimate is within the tolerance, or they have none.
    pub accepted: u64,
    /// Rejected trial steps: error too large, a fault, a number that is not finite, or an implicit step that was not
    /// solved.
    pub rejected: u64,
    /// Steps whose dense output was built.
    pub dense_constructions: u64,
    /// Evaluations of the vector of gaps.
    pub event_evaluations: u64,
    /// Enclosures of one gap along a part of a step.
    pub enclosures: u64,
    /// Falls of a gap through 0 that were located, including those that are no impacts.
    pub crossings: u64,
    /// Impacts.
    pub impacts: u64,
    /// Projections onto the constraints.
    pub projections: u64,
}
