//! Reasons for which a claim stays undecided, with their messages.

use std::fmt;

/// Largest chance of error of a proof.
pub(super) const LARGEST_CHANCE: f64 = 1e-12;

/// Reason for which there is no answer.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Undecided {
    /// At no point that was tried are metric, constraints and all expressions regular.
    Degenerate,
    /// At no real state that was tried do the equations of motion have values: without states, any claim would hold.
    Stateless,
    /// The constraints are not linear in the velocities.
    Nonlinear,
    /// Brackets of vector fields in D up to this depth did not close the involutive hull of D. Deeper brackets are not
    /// computed.
    Depth(usize),
    /// The equations that positions satisfy are not solved for coordinates.
    Positions,
    /// The divergence of the forces is not known to be linear in the velocities.
    Forces,
    /// The coefficients inside sin, cos and exp have no small common denominator.
    Denominators,
    /// Roots and absolute values have more branches than are examined.
    Branches,
    /// Residues are 0, but the chance that they are 0 by accident is too large.
    Chance,
    /// Identities between these subexpressions may exist that residues modulo primes do not show.
    Relations(Vec<String>),
}

impl fmt::Display for Undecided {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Degenerate => write!(
                f,
                "at none of the points that were tried are the metric, the constraints and all expressions regular"
            ),
            Self::Stateless => write!(
                f,
                "at none of the real states that were tried do metric, forces and constraints all have values"
            ),
            Self::Nonlinear => write!(
                f,
                "claims are examined only where constraints are linear in the velocities"
            ),
            Self::Depth(depth) => write!(
                f,
                "brackets up to depth {depth} did not close the hull of D, deeper ones are out of reach"
            ),
            Self::Positions => write!(
                f,
                "the equations of its positions are not solved: each must be a polynomial of degree 1 or 2 in a coordinate \
                 that follows from the others, with a leading coefficient that is never 0"
            ),
            Self::Forces => write!(
                f,
                "it is not known whether the forces change volumes at a rate that is linear in the velocities"
            ),
            Self::Denominators => write!(
                f,
                "the coefficients inside sin, cos and exp have no small common denominator"
            ),
            Self::Branches => write!(
                f,
                "roots and absolute values have more combinations of signs than are examined"
            ),
            Self::Chance => write!(
                f,
                "with so many roots and such degrees, values at random points modulo 61-bit primes leave too large a chance of error"
            ),
            Self::Relations(atoms) if atoms.is_empty() => {
                write!(f, "values at real points do not confirm the residues")
            }
            Self::Relations(atoms) => write!(
                f,
                "values at real points do not confirm the residues, as these may be related: {}",
                atoms.join(", ")
            ),
        }
    }
}

impl std::error::Error for Undecided {}
