//! Work counters: what a run cost, part of its result.

/// How much of each kind of work a run did.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub struct Counters {
    /// Evaluations of the vector field, those of rejected steps included. A discrete principle evaluates the force and
    /// solves for a velocity instead, which is as much work and counts as one.
    pub rate_evaluations: u64,
    /// Expansions of the motion in a power series.
    pub expansions: u64,
    /// Orders of these expansions together: what they cost grows with their squares.
    pub coefficients: u64,
    /// Steps that were made: their error estimate passed, or they have none.
    pub accepted: u64,
    /// Trial steps thrown away: error too large, a fault, a number that is not finite, or an implicit step that was not
    /// solved.
    pub rejected: u64,
    /// Steps whose dense output was built.
    pub dense_constructions: u64,
    /// Evaluations of the vector of gaps.
    pub event_evaluations: u64,
    /// Enclosures of one gap along a part of a step.
    pub enclosures: u64,
    /// Roots of a gap that were located, in whichever direction motion then went on.
    pub crossings: u64,
    /// Impacts carried out.
    pub impacts: u64,
    /// Projections back to the constraints.
    pub projections: u64,
}
