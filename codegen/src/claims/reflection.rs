//! Periods that are 0 by symmetry. The proof is exact; a converged sum would only be small.
//!
//! Let `beta` be the closed form with `beta(X_i) = c_i`, and let a loop be the circle of an angle. The growth of `G`
//! along it does not depend on the values of the other coordinates. A map that reflects coordinates, or turns angles by
//! a part of a circle, takes the loop to another one with the same growth up to sign. If the sum of `beta` along the
//! loop and along its images under some maps is 0, the growth is 0. The sum is tested modulo primes.
//!
//! Without roots the images are those of all turns by `pi/12` and their reflections: this covers all trigonometric
//! polynomials of degree below 24. Roots have values at few images only, so one image is taken.

use dalembert_expr::{ExprId, ModularPoint, Modulus, SamplePoints, SymbolId};

use super::elimination::first_relation;
use super::exactness::{Local, branches_of, sample_points};
use super::obstruction::elements_at;
use super::problem::Problem;
use crate::model::{Model, Topology};

/// Numbers of points at which an identity must hold, without roots and with them.
const POINTS: (usize, usize) = (3, 64);
/// Largest number of maps that are tried.
const MAPS: usize = 64;

/// Twelfths of pi in a circle.
const CIRCLE: i64 = 24;

/// `q -> twelfths pi/12 + q` or, reflected, `twelfths pi/12 - q`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Move {
    twelfths: i64,
    is_reflected: bool,
}

const STAYS: Move = Move::new(0, false);
const REFLECTED: Move = Move::new(0, true);
const SUPPLEMENT: Move = Move::new(12, true);
const OPPOSITE: Move = Move::new(12, false);

/// Moves of the angle of a loop, if its images are not summed.
const ALONE: &[Move] = &[
    STAYS,
    REFLECTED,
    SUPPLEMENT,
    OPPOSITE,
    Move::new(6, false),
    Move::new(6, true),
    Move::new(4, false),
    Move::new(4, true),
];

impl Move {
    const fn new(twelfths: i64, is_reflected: bool) -> Self {
        Self {
            twelfths,
            is_reflected,
        }
    }
}

/// A map that moves each of these coordinates by itself.
type Map = Vec<(SymbolId, Move)>;

/// True if the growth of `G` along the circle of a coordinate is 0 by a symmetry that fixes every coordinate at whose
/// values Q may be cut. An image then lies in the same part of Q, in which D must connect all configurations.
pub(super) fn has_no_period(
    model: &Model,
    problem: &Problem,
    local: &Local,
    (angle, cuts): (usize, &[usize]),
    seed: u64,
) -> bool {
    let roots = problem.roots();
    let profile = model.pool.profile_of(&roots);
    let Ok(points) = sample_points(&model.pool, &roots, &profile, seed) else {
        return false;
    };
    // Signs inside absolute values may differ between a point and its image. Roots of squares have random signs at the
    // points.
    let branches = branches_of(&model.pool, &roots, &profile, &points);
    if !branches.is_some_and(|branches| branches.is_single()) {
        return false;
    }
    let circle = Circle {
        model,
        problem,
        local,
        angle,
        cuts,
        points,
    };
    let turns = turns(profile.denominator.unwrap_or(1));
    match profile.branches {
        true => circle.cancels(&[STAYS], ALONE, POINTS.1),
        false => {
            circle.cancels(&[STAYS], ALONE, POINTS.0) || circle.cancels(&turns, &[STAYS], POINTS.0)
        }
    }
}

/// The circle of an angle.
struct Circle<'c> {
    model: &'c Model,
    problem: &'c Problem,
    local: &'c Local,
    angle: usize,
    cuts: &'c [usize],
    points: SamplePoints,
}

impl Circle<'_> {
    /// True if the sum of `beta` along the circle over its images under `turns` changes its sign under some map. A map
    /// moves the angle by one of `moves`, and every other coordinate by one of its own moves.
    fn cancels(&self, turns: &[Move], moves: &[Move], count: usize) -> bool {
        let (model, problem) = (self.model, self.problem);
        let mut points = self.points.clone();
        // Points with the sums there, found as the maps need them.
        let mut known: Vec<(ModularPoint, u64)> = Vec::new();
        let maps = maps(model, problem, (self.angle, moves), self.cuts);
        maps.iter().any(|map| {
            (0..count).all(|k| {
                if known.len() == k {
                    let found = points.find(&model.pool, |point| {
                        Some((point.clone(), self.summed(turns, point)?))
                    });
                    known.extend(found);
                }
                let Some((point, sum)) = known.get(k) else {
                    return false;
                };
                let moved = match map.iter().all(|(_, turn)| *turn == STAYS) {
                    true => Some(*sum),
                    false => image(model, point, map).and_then(|image| self.summed(turns, &image)),
                };
                moved.is_some_and(|moved| point.modulus().add(*sum, moved) == 0)
            })
        })
    }

    fn summed(&self, turns: &[Move], point: &ModularPoint) -> Option<u64> {
        let field = point.modulus();
        let symbol = self.model.coordinates[self.angle].q;
        turns.iter().try_fold(0, |sum, moved| {
            let mut image = image(self.model, point, &[(symbol, *moved)])?;
            let slope = slope(self.model, self.problem, self.local, self.angle, &mut image)?;
            Some(field.add(sum, slope))
        })
    }
}

/// Turns of a circle by angles that residues can represent, and their reflections.
fn turns(denominator: i64) -> Vec<Move> {
    let step = denominator.clamp(1, CIRCLE);
    let turns = (0..CIRCLE).step_by(step as usize);
    turns
        .flat_map(|twelfths| [false, true].map(|is_reflected| Move::new(twelfths, is_reflected)))
        .collect()
}

/// The maps: one of `moves` for the angle, and a move for each other coordinate on which the problem depends.
fn maps(
    model: &Model,
    problem: &Problem,
    (angle, moves): (usize, &[Move]),
    cuts: &[usize],
) -> Vec<Map> {
    let symbol = model.coordinates[angle].q;
    let mut maps: Vec<Map> = moves.iter().map(|moved| vec![(symbol, *moved)]).collect();
    let others = problem.variables.iter().copied();
    for i in others.filter(|i| *i != angle && *i < problem.coordinates) {
        let moves: &[Move] = match model.coordinates[i].topology {
            _ if cuts.contains(&i) => &[STAYS],
            Topology::Line => &[STAYS, REFLECTED],
            Topology::Angle => &[STAYS, REFLECTED, SUPPLEMENT, OPPOSITE],
            // The charts of Euler angles are mostly `(0, pi)`; another chart is not mapped to itself.
            Topology::Interval { low, high } => match is_half_circle(model, low, high) {
                true => &[STAYS, SUPPLEMENT],
                false => &[STAYS],
            },
        };
        let symbol = model.coordinates[i].q;
        let longer = moves.iter().flat_map(|moved| {
            let with = |map: &Map| [map.clone(), vec![(symbol, *moved)]].concat();
            maps.iter().map(with).collect::<Vec<_>>()
        });
        maps = longer.take(MAPS).collect();
    }
    maps
}

fn is_half_circle(model: &Model, low: ExprId, high: ExprId) -> bool {
    model.pool.is_syntactic_zero(low) && high == model.pool.pi()
}

fn image(model: &Model, point: &ModularPoint, map: &[(SymbolId, Move)]) -> Option<ModularPoint> {
    let mut image = point.clone();
    for (symbol, moved) in map.iter().filter(|(_, moved)| *moved != STAYS) {
        let assumption = model.pool.symbol_assumption(*symbol);
        image
            .move_symbol(*symbol, assumption, moved.twelfths, moved.is_reflected)
            .ok()?;
    }
    Some(image)
}

/// `beta` along the circle at a point.
fn slope(
    model: &Model,
    problem: &Problem,
    local: &Local,
    angle: usize,
    point: &mut ModularPoint,
) -> Option<u64> {
    let field: Modulus = point.modulus();
    let (hull, dependent) = (&local.hull, Some(local.dependent.as_slice()));
    let elements = elements_at(&model.pool, problem, hull, dependent, point)?;
    let width = problem.components();
    let rows = (0..width)
        .map(|i| {
            let basis = hull.basis.iter().map(|element| elements[*element][i]);
            basis.chain([u64::from(i == angle)]).collect()
        })
        .collect();
    let relation = first_relation(field, rows)?;
    if relation.len() != hull.basis.len() + 1 || relation.last() != Some(&1) {
        return None;
    }
    let mut slope = 0;
    for (coefficient, element) in relation.iter().zip(&hull.basis) {
        slope = field.sub(slope, field.mul(*coefficient, elements[*element][width]));
    }
    Some(slope)
}
