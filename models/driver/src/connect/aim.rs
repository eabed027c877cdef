//! Questions of a search about the motions of a problem.

/// Course of a motion.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Course {
    /// It reaches the time of the end, with impacts on these surfaces.
    Reached(Vec<usize>),
    /// It has more impacts than allowed.
    Beyond,
    /// It takes too many steps to be followed.
    GivenUp,
    /// It ends early for another reason, or begins with an impact.
    Lost,
}

/// A motion from given unknowns.
#[derive(Debug, Clone)]
pub(crate) struct Shot {
    pub course: Course,
    /// Differences between the given coordinates of the end and those of the motion.
    pub misses: Vec<f64>,
    /// Derivatives of these differences, a column for each unknown; empty if they were not asked for or do not exist.
    pub slopes: Vec<Vec<f64>>,
}

/// Questions of a search about a model, for any type of system.
pub(crate) trait Aim {
    /// The motion from these unknowns, with derivatives if `with_slopes`.
    fn shoot(&mut self, w: &[f64], with_slopes: bool) -> Shot;

    /// Number of further starts that [`guess`](Self::guess) may know.
    fn guesses(&self) -> usize {
        0
    }

    /// Unknowns that another method finds from a guess with this index.
    fn guess(&mut self, index: usize) -> Option<Vec<f64>> {
        let _ = index;
        None
    }

    /// Number of steps of the integrator that were made.
    fn steps(&self) -> u64;
}
