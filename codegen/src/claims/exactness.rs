//! Existence of a local density: ranks of the hull of the demands (their closure under brackets) at random points
//! modulo primes. A demand is an equation `X(G) = c` that a density `exp(G)` must satisfy.
//!
//! The rank at a point is at most the generic rank of its branch, so the largest rank of a few samples of each branch
//! counts. If the hull contains all components, an obstruction at one point is a proof. Every other answer is wrong
//! with a probability below the stated bound.

use std::collections::BTreeMap;

use dalembert_expr::{
    Branches, ExprId, Frozen, JetSpace, Jets, ModularPoint, Pool, Profile, SamplePoints, SymbolId,
};

use super::closure::{Hull, Until, close};
use super::fit::{
    Certified, certify, fit, fit_with_parameters, has_points, solve_for_coefficients,
};
use super::frame::frame;
use super::global::{self, Global};
use super::leaf;
use super::locus::Choice;
use super::potential::{Allowed, Candidates, Potential, Term};
use super::problem::Problem;
use super::regularity;
use super::smoothness::{HOLES, cuts};
use super::undecided::{LARGEST_CHANCE, Undecided};
use crate::model::Model;

/// Number of points sampled on each branch, each modulo the next prime.
const SAMPLES: usize = 3;
/// Largest number of monomials of a series. Orders with more monomials are not tried.
const MONOMIALS: usize = 20_000;
/// Order of the first attempt. Most hulls are closed within three brackets.
const FIRST_ORDER: usize = 3;
/// Reason why growth along a loop leaves the question open under position equations.
const CLOSED: &str =
    "it grows along a loop of other positions than those that satisfy the position equations";

/// Conditions on parameters: values to which symbols are fixed.
pub(super) type Conditions = [(SymbolId, Fixed)];

/// Value to which a symbol is fixed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Fixed {
    /// A fraction.
    Value(i64, i64),
    /// The value of another symbol.
    Same(SymbolId),
}

/// Existence of a local density, as the largest hull of the demands among the sampled points decides it.
#[derive(Debug, Clone, PartialEq)]
pub struct Local {
    /// True if a local density exists near generic points.
    pub exists: bool,
    /// Rank of the hull of D, drift included.
    pub rank: usize,
    /// Rank of the hull of the demands. It is larger by 1 if there is an obstruction.
    pub extended_rank: usize,
    /// Rank after each depth of brackets, from depth 0 (D itself).
    pub growth: Vec<usize>,
    /// True if only some branches have an obstruction.
    pub is_partial: bool,
    /// True if an obstruction is proved. False if it is only certain up to the probability `error`.
    pub is_proof: bool,
    /// Upper bound of the probability that the answer is wrong.
    pub error: f64,
    /// Number of sampled points.
    pub points: usize,
    /// The primes in use.
    pub primes: Vec<u64>,
    pub(super) hull: Hull,
    pub(super) dependent: Vec<usize>,
}

impl Local {
    /// The dependent velocities of the frame in which brackets were computed.
    pub fn dependent(&self) -> &[usize] {
        &self.dependent
    }
}

/// Decides whether a local density exists. `seed` gives the random points.
///
/// # Errors
/// [`Undecided`] with the reason.
pub fn decide_local(pool: &Pool, problem: &Problem, seed: u64) -> Result<Local, Undecided> {
    decide_local_where(pool, problem, seed, &[])
}

/// Same as [`decide_local`], in the frame of D with the given dependent velocities. Verdict and ranks are the same.
/// Brackets and obstruction belong to this frame.
///
/// # Errors
/// [`Undecided`] with the reason; also if the given velocities cannot be expressed by the others, so that there is no
/// regular point.
pub fn decide_local_in(
    pool: &Pool,
    problem: &Problem,
    dependent: &[usize],
    seed: u64,
) -> Result<Local, Undecided> {
    decide_local_from(pool, problem, seed, &[], Some(dependent))
}

/// Same as [`decide_local`], under conditions on symbols.
pub(super) fn decide_local_where(
    pool: &Pool,
    problem: &Problem,
    seed: u64,
    conditions: &Conditions,
) -> Result<Local, Undecided> {
    decide_local_from(pool, problem, seed, conditions, None)
}

fn decide_local_from(
    pool: &Pool,
    problem: &Problem,
    seed: u64,
    conditions: &Conditions,
    dependent: Option<&[usize]>,
) -> Result<Local, Undecided> {
    problem.check_forces()?;
    let roots = problem.roots();
    let profile = pool.profile_of(&roots);
    let mut points = sample_points(pool, &roots, &profile, seed)?;
    let mut found_in: BTreeMap<(Choice, u64), (Hull, Vec<usize>)> = BTreeMap::new();
    let mut primes = Vec::new();
    let branches = branches_of(pool, &roots, &profile, &points).ok_or(Undecided::Branches)?;
    let (mut failure, mut is_free) = (None, false);
    let choices = problem.positions.choices();
    let covered = points.cover(pool, &branches, SAMPLES, |point| {
        fix(pool, point, conditions)?;
        for choice in &choices {
            problem.positions.settle(pool, point, *choice)?;
            let found = match sample(pool, problem, point, dependent, Until::Closed)? {
                Ok(found) => found,
                Err(depth) => {
                    failure = Some(Undecided::Depth(depth));
                    return Some(false);
                }
            };
            primes.push(point.modulus().prime());
            let pattern = (*choice, branches.pattern(pool, point)?);
            is_free |= found.0.rank == found.0.extended_rank;
            let ranks = |(hull, _): &(Hull, Vec<usize>)| (hull.rank, hull.extended_rank);
            let best = found_in.get(&pattern);
            if best.is_none_or(|best| ranks(best) < ranks(&found)) {
                found_in.insert(pattern, found);
            }
        }
        Some(true)
    });
    if let Some(failure) = failure {
        return Err(failure);
    }
    let covered = covered.ok_or(Undecided::Degenerate)?;
    // A density must exist on all branches, so an obstruction on one of them counts.
    let is_obstructed = |hull: &Hull| hull.rank < hull.extended_rank;
    let (hull, dependent) = found_in
        .into_values()
        .max_by_key(|(hull, _)| (is_obstructed(hull), hull.rank, hull.extended_rank))
        .ok_or(Undecided::Degenerate)?;
    primes.sort_unstable();
    primes.dedup();
    let chance = chance_of_accident(&profile, problem, hull.growth.len());
    let is_proof = hull.extended_rank > problem.components() && profile.is_exact();
    let error = match is_proof {
        true => 0.0,
        false => covered.error(&branches, chance),
    };
    if error > LARGEST_CHANCE {
        return Err(Undecided::Chance);
    }
    Ok(Local {
        exists: hull.rank == hull.extended_rank,
        rank: hull.rank,
        extended_rank: hull.extended_rank,
        growth: hull.growth.clone(),
        is_partial: is_free && is_obstructed(&hull),
        is_proof,
        error,
        points: covered.points,
        primes,
        hull,
        dependent,
    })
}

/// Points for the expressions of a problem.
pub(super) fn sample_points(
    pool: &Pool,
    roots: &[ExprId],
    profile: &Profile,
    seed: u64,
) -> Result<SamplePoints, Undecided> {
    SamplePoints::seeded(pool, roots, profile, seed).ok_or(Undecided::Denominators)
}

/// The branches of the expressions of a problem; `None` if there are too many.
pub(super) fn branches_of(
    pool: &Pool,
    roots: &[ExprId],
    profile: &Profile,
    points: &SamplePoints,
) -> Option<Branches> {
    match profile.branches {
        true => pool.branches(roots, points),
        false => Some(Branches::default()),
    }
}

/// Sets the symbols of conditions at a point; `None` if the prime divides a denominator.
fn fix(pool: &Pool, point: &mut ModularPoint, conditions: &Conditions) -> Option<()> {
    let field = point.modulus();
    for (symbol, fixed) in conditions {
        let value = match fixed {
            Fixed::Value(n, d) => field.mul(field.integer(*n), field.inv(field.integer(*d))?),
            Fixed::Same(other) => point.value(*other, pool.symbol_assumption(*other)),
        };
        point.set(*symbol, value);
    }
    Some(())
}

/// True if a function satisfies the demands near the first regular point under the conditions. `None` if `attempts`
/// points are singular, or if the hull is not closed within the largest order.
pub(super) fn screen(
    pool: &Pool,
    problem: &Problem,
    points: &mut SamplePoints,
    attempts: usize,
    conditions: &Conditions,
) -> Option<bool> {
    let mut left = attempts;
    let first = problem.positions.choices()[0];
    points
        .find(pool, |point| {
            left -= 1;
            let found = fix(pool, point, conditions)
                .and_then(|()| problem.positions.settle(pool, point, first))
                .and_then(|()| sample(pool, problem, point, None, Until::Obstructed));
            match found {
                None if left > 0 => None,
                other => Some(other),
            }
        })
        .flatten()
        .and_then(Result::ok)
        .map(|(hull, _)| hull.rank == hull.extended_rank)
}

/// True if a function satisfies the demands near a point. `None` at a singular point, or if the hull is not closed
/// within the largest order.
pub(super) fn exists_at(pool: &Pool, problem: &Problem, point: &mut ModularPoint) -> Option<bool> {
    let first = problem.positions.choices()[0];
    problem.positions.settle(pool, point, first)?;
    let (hull, _) = sample(pool, problem, point, None, Until::Obstructed)?.ok()?;
    Some(hull.rank == hull.extended_rank)
}

/// The hull at a point and the dependent velocities of its frame. The order of the series is increased until the hull
/// is closed. The inner error is the depth reached without closure. `None` at a singular point.
fn sample(
    pool: &Pool,
    problem: &Problem,
    point: &mut ModularPoint,
    dependent: Option<&[usize]>,
    until: Until,
) -> Option<Result<(Hull, Vec<usize>), usize>> {
    let field = point.modulus();
    let variables = problem.variables.len();
    // The hull of D is complete after as many depths as D lacks components. One more depth shows that it is closed.
    let deepest = problem.forms.len() + 2 + usize::from(problem.is_time_dependent());
    let mut order = FIRST_ORDER.min(deepest);
    loop {
        let Some(space) = JetSpace::new(variables, order, MONOMIALS) else {
            return Some(Err(order - 1));
        };
        let jets = Jets::new(field, &space);
        let frame = frame(pool, problem, &jets, point, dependent)?;
        let hull = close(jets.lower(), &problem.variables, &frame.demands, until);
        if hull.is_closed {
            return Some(Ok((hull, frame.dependent)));
        }
        order += 1;
    }
}

/// Upper bound of the probability that a minor of the hull vanishes at a random point although it is not identically 0
/// (Schwartz, Zippel): its degree divided by the smallest prime.
///
/// With entries of degree d in numerator and denominator, `W`, `m_ab` and the frame have common denominators of degree
/// below `8 (N + M)^3 d`. A bracket at most adds twice the degrees of both operands, so depth k has degree below `4^k`
/// times that of the frame. A minor has at most one row per component and one for the demand.
fn chance_of_accident(profile: &Profile, problem: &Problem, depth: usize) -> f64 {
    let sizes = (problem.coordinates + problem.forms.len()) as f64;
    let frame = 8.0 * sizes.powi(3) * profile.degree.max(1.0);
    let minor = (problem.components() + 1) as f64 * 4f64.powi(depth as i32) * frame;
    minor / 2f64.powi(60)
}

/// Result on the densities of a model that depend on the configuration only.
#[derive(Debug, Clone, PartialEq)]
pub struct Exactness {
    /// Result near generic points.
    pub local: Local,
    /// A density in closed form with its certificate, if one was found.
    pub density: Option<(Potential, Certified)>,
    /// Result on all of Q; `None` if no local density exists.
    pub global: Option<Global>,
}

/// Decides the existence of a density, and searches for a closed form.
///
/// # Errors
/// [`Undecided`].
pub fn decide(model: &mut Model, problem: &Problem, seed: u64) -> Result<Exactness, Undecided> {
    let mut exactness = decide_anywhere(model, problem, seed)?;
    // A density that is regular wherever the model is needs no solution of the equations.
    let is_regular = |term: &Term| matches!(term, Term::MassDeterminant | Term::MetricDeterminant);
    let is_everywhere = (exactness.density.iter())
        .any(|(found, _)| found.terms.iter().all(|(_, term)| is_regular(term)));
    if !problem.positions.is_solved() && !is_everywhere {
        return Err(Undecided::Positions);
    }
    let grows = matches!(exactness.global, Some(Global::Many { .. }));
    if grows && !problem.positions.is_everything() {
        exactness.global = Some(Global::Undecided(CLOSED));
    }
    Ok(exactness)
}

/// Same as [`decide`], with loops at any position.
fn decide_anywhere(
    model: &mut Model,
    problem: &Problem,
    seed: u64,
) -> Result<Exactness, Undecided> {
    problem.check_forces()?;
    if !regularity::is_real(model, problem) {
        return Err(Undecided::Degenerate);
    }
    let local = decide_local(&model.pool, problem, seed)?;
    if !local.exists {
        return Ok(Exactness {
            local,
            density: None,
            global: None,
        });
    }
    if let Some(certified) = certify(&model.pool, problem, &Potential::default(), seed)? {
        return Ok(Exactness {
            global: Some(regularity::restrict(model, problem, Global::Exists)),
            density: Some((Potential::default(), certified)),
            local,
        });
    }
    let candidates = Candidates::of(&mut model.pool, problem, &model.coordinates);
    let positions = problem.parameters(model).into_iter();
    let parameters: Vec<SymbolId> = positions.map(|i| model.parameters[i].symbol).collect();
    let mut singular: Option<(Potential, Certified)> = None;
    for allowed in [Allowed::Regular, Allowed::SingleValued, Allowed::All] {
        let pool = &mut model.pool;
        // Each list contains the one before it.
        if !has_points(pool, problem, &candidates, allowed, seed) {
            break;
        }
        let found = fit(pool, problem, &candidates, allowed, seed).or_else(|| {
            fit_with_parameters(pool, problem, &candidates, allowed, &parameters, seed)
        });
        let Some(found) = found else {
            continue;
        };
        let Some(certified) = certify(&model.pool, problem, &found, seed)? else {
            continue;
        };
        let is_regular =
            allowed == Allowed::Regular || regularity::is_regular(model, problem, &local, &found);
        if !is_regular {
            singular.get_or_insert((found, certified));
            continue;
        }
        let global = match allowed {
            Allowed::All => match global::from_angles(model, problem, &local, &found) {
                Global::Undecided(reason) => {
                    on_leaves(model, problem, &local, (singular.as_ref(), reason), seed)
                }
                decided => decided,
            },
            _ => Global::Exists,
        };
        return Ok(Exactness {
            global: Some(regularity::restrict(model, problem, global)),
            local,
            density: Some((found, certified)),
        });
    }
    let global = match &singular {
        Some(_) => on_leaves(
            model,
            problem,
            &local,
            (singular.as_ref(), regularity::SINGULAR),
            seed,
        ),
        None => without_closed_form(model, problem, &local, (&candidates, &parameters), seed),
    };
    // A density that grows along a loop of a leaf is not the closed form, which is singular on the leaf.
    let density = singular.filter(|_| !matches!(global, Global::Many { .. }));
    Ok(Exactness {
        global: Some(regularity::restrict(model, problem, global)),
        local,
        density,
    })
}

/// The answer on all of Q if no density is a sum of candidates.
fn without_closed_form(
    model: &mut Model,
    problem: &Problem,
    local: &Local,
    (candidates, parameters): (&Candidates, &[SymbolId]),
    seed: u64,
) -> Global {
    let cuts = cuts(model, problem, seed);
    let global = match global::from_periods(model, problem, local, cuts.as_deref()) {
        Global::Exists if cuts.is_none() => Global::Undecided(HOLES),
        other => other,
    };
    let is_open = matches!(global, Global::Undecided(_));
    match is_open && exists_for_each_parameter(model, problem, candidates, parameters, seed) {
        true => Global::Exists,
        false => global,
    }
}

/// Growth along a loop of a closed leaf on which a singular density vanishes; otherwise the reason why the question
/// stays open.
fn on_leaves(
    model: &mut Model,
    problem: &Problem,
    local: &Local,
    (singular, reason): (Option<&(Potential, Certified)>, &'static str),
    seed: u64,
) -> Global {
    singular
        .and_then(|(potential, _)| leaf::grown_on_leaf(model, problem, local, potential, seed))
        .unwrap_or(Global::Undecided(reason))
}

/// True if regular candidates give a density at random values of the parameters, and so at almost all. The dependence of
/// the coefficients on the parameters need not have one of the forms tried.
fn exists_for_each_parameter(
    model: &Model,
    problem: &Problem,
    candidates: &Candidates,
    parameters: &[SymbolId],
    seed: u64,
) -> bool {
    let terms = candidates.allowed(Allowed::Regular);
    let roots = problem.roots();
    let profile = model.pool.profile_of(&roots);
    let branches = sample_points(&model.pool, &roots, &profile, seed)
        .ok()
        .and_then(|points| branches_of(&model.pool, &roots, &profile, &points));
    if !branches.is_some_and(|branches| branches.is_single()) {
        return false;
    }
    (0..SAMPLES as u64).all(|k| {
        let seed = seed.wrapping_add(k);
        let mut frozen: Vec<Frozen> = parameters
            .iter()
            .map(|parameter| (*parameter, None))
            .collect();
        solve_for_coefficients(&model.pool, problem, &terms, &mut frozen, seed).is_some()
    })
}
