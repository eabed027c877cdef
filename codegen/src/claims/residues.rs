//! Residues of a sum at random states, modulo primes.

use dalembert_expr::{Branches, Covered, ExprId, Profile};

use super::evidence::Vanishing;
use super::exactness::{branches_of, sample_points};
use super::locus::{Choice, Locus};
use super::undecided::{LARGEST_CHANCE, Undecided};
use crate::model::Model;

/// Number of random states at which a sum must vanish, and number on each branch if there are several.
const STATES: (usize, usize) = (12, 3);

/// Observations at random points modulo primes; see [`Evidence`].
pub(super) struct Residues {
    /// True if all residues are 0; `None` if there were too few.
    pub(super) vanishes: Option<bool>,
    /// The number of random points.
    pub(super) points: usize,
    /// The primes.
    pub(super) primes: Vec<u64>,
    /// An upper bound of the probability of error.
    pub(super) error: f64,
    /// Reason to give if the question stays open.
    pub(super) open: Undecided,
}

impl Residues {
    /// No answer, for a reason.
    pub(super) fn open(reason: Undecided) -> Self {
        Self {
            vanishes: None,
            points: 0,
            primes: Vec::new(),
            error: 1.0,
            open: reason,
        }
    }

    /// Combines the observations on two parts of the states. The first that is not 0 everywhere decides.
    pub(super) fn and(mut self, other: Self) -> Self {
        if self.vanishes != Some(true) {
            return self;
        }
        if other.vanishes != Some(true) {
            return other;
        }
        self.primes.extend(&other.primes);
        self.primes.sort_unstable();
        self.primes.dedup();
        Self {
            points: self.points + other.points,
            error: self.error + other.error,
            ..self
        }
    }
}

/// Tests modulo primes whether a sum vanishes at states of all branches of its roots and absolute values. `choice`: see
/// [`Locus::settle`].
pub(super) fn residues(
    model: &Model,
    question: &impl Vanishing,
    (roots, profile): (&[ExprId], &Profile),
    choice: Choice,
    seed: u64,
) -> Residues {
    let mut primes = Vec::new();
    let is_zero = |residue| residue == 0;
    let covered = cover(
        model,
        question,
        (roots, profile),
        (choice, seed),
        (&mut primes, &is_zero),
    );
    let (covered, branches) = match covered {
        Ok(found) => found,
        Err(reason) => return Residues::open(reason),
    };
    let error = covered.error(&branches, chance_of_accident(model, profile.degree));
    // Zeros that may be accidental prove nothing.
    if covered.holds && error > LARGEST_CHANCE {
        return Residues::open(Undecided::Chance);
    }
    primes.sort_unstable();
    primes.dedup();
    Residues {
        vanishes: Some(covered.holds),
        points: covered.points,
        primes,
        error,
        open: Undecided::Relations(Vec::new()),
    }
}

/// True if a sum is 0 at none of the random states, on every component of their positions.
pub(super) fn vanishes_nowhere(model: &Model, question: &impl Vanishing, seed: u64) -> bool {
    let roots = question.roots();
    let profile = model.pool.profile_of(&roots);
    let choices = question.positions().map_or(vec![None], Locus::choices);
    choices.into_iter().all(|choice| {
        let (asked, place) = ((roots.as_slice(), &profile), (choice, seed));
        let differs = |residue| residue != 0;
        let covered = cover(model, question, asked, place, (&mut Vec::new(), &differs));
        covered.is_ok_and(|(covered, _)| covered.holds)
    })
}

/// Asks whether the residue of a sum `holds` at random states, and collects the primes. An error if a branch cannot be
/// sampled.
fn cover(
    model: &Model,
    question: &impl Vanishing,
    (roots, profile): (&[ExprId], &Profile),
    (choice, seed): (Choice, u64),
    (primes, holds): (&mut Vec<u64>, &dyn Fn(u64) -> bool),
) -> Result<(Covered, Branches), Undecided> {
    let mut points = sample_points(&model.pool, roots, profile, seed)?;
    let branches = branches_of(&model.pool, roots, profile, &points).ok_or(Undecided::Branches)?;
    let each = branches.points_of_each(STATES);
    let covered = points.cover(&model.pool, &branches, each, |point| {
        if let Some(positions) = question.positions() {
            positions.settle(&model.pool, point, choice)?;
        }
        question.settle(model, point)?;
        let terms = question.terms(model, point)?;
        primes.push(point.modulus().prime());
        let field = point.modulus();
        let sum = terms.into_iter().fold(0, |sum, term| field.add(sum, term));
        Some(holds(sum))
    });
    Ok((covered.ok_or(Undecided::Degenerate)?, branches))
}

/// Upper bound of the probability of an accidental zero: the degree of a rate, divided by the prime (Schwartz, Zippel).
/// The saddle system of acceleration and multipliers has N + M rows, and the numerators and denominators of its entries
/// have at most the degree d of the profile. A rate has degree below `64 (2 N + M)^3 d`.
fn chance_of_accident(model: &Model, degree: f64) -> f64 {
    let sizes = (2 * model.coordinates.len() + model.constraints.len()) as f64;
    let degree = 64.0 * sizes.powi(3) * degree.max(1.0);
    degree / 2f64.powi(60)
}
