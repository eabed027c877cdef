//! The interface between a search and the boundary-value problem that it solves.

/// Course of a motion.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Course {
    /// It reaches the end time, with impacts on these surfaces.
    Reached(Vec<usize>),
    /// It has more impacts than allowed.
    Beyond,
    /// It was given up after too many steps.
    GivenUp,
    /// It ends early for another reason, or begins with an impact.
    Lost,
}

/// The motion from given unknowns.
#[derive(Debug, Clone)]
pub(crate) struct Shot {
    pub course: Course,
    /// Residuals of the equations at the end. Those of `connect` are coordinates minus their given values.
    pub misses: Vec<f64>,
    /// Derivatives of the misses, one column per unknown; empty if they were not requested or do not exist.
    pub slopes: Vec<Vec<f64>>,
    /// Size of the misses that rounding alone may cause. Known only with the derivatives, else 0.
    pub rounding: f64,
}

/// Largest miss of a root, whatever the rounding.
pub(crate) const COARSE: f64 = 1e-6;

impl Shot {
    /// Largest miss of a root: `near`, or what rounding alone may cause, up to [`COARSE`].
    pub fn near(&self, near: f64) -> f64 {
        near.max(self.rounding.min(COARSE))
    }
}

/// A boundary-value problem as a search sees it, for any type of system.
pub(crate) trait Aim {
    /// The motion from these unknowns, with derivatives if `with_slopes`.
    fn shoot(&mut self, w: &[f64], with_slopes: bool) -> Shot;

    /// Number of starts that [`guess`](Self::guess) may find.
    fn guesses(&self) -> usize {
        0
    }

    /// Unknowns from which a search can start, found by another algorithm (such as multiple shooting) from its initial
    /// guess with this index. `None` if it finds none.
    fn guess(&mut self, index: usize) -> Option<Vec<f64>> {
        let _ = index;
        None
    }

    /// Number of integrator steps so far.
    fn steps(&self) -> u64;
}
