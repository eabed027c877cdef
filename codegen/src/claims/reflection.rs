//! Periods that are 0 by symmetry: exact where a converged sum would only be small.
//!
//! Let `beta` be the closed form with `beta(X_i) = c_i` and the circle of an angle a loop. The growth of `G` along it does not
//! depend on the values of the other coordinates. A map that reflects coordinates, or turns angles by half a circle, takes
//! such a loop to another one. If `beta` along the loop changes its sign under it, the growth is its own opposite: 0.
//! Whether it does is an identity, tested modulo primes.

use dalembert_expr::{ExprId, ModularPoint, Modulus, SymbolId};

use super::elimination::first_relation;
use super::exactness::{Local, sample_points};
use super::obstruction::elements_at;
use super::problem::Problem;
use crate::model::{Model, Topology};

/// Points at which an identity must hold.
const POINTS: usize = 3;
/// Maps that are tried.
const MAPS: usize = 256;

/// `q -> half_turns pi + q` or, reflected, `half_turns pi - q`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Move {
    half_turns: i64,
    is_reflected: bool,
}

const STAYS: Move = Move::new(0, false);
const REFLECTED: Move = Move::new(0, true);
const SUPPLEMENT: Move = Move::new(1, true);
const OPPOSITE: Move = Move::new(1, false);

impl Move {
    const fn new(half_turns: i64, is_reflected: bool) -> Self {
        Self {
            half_turns,
            is_reflected,
        }
    }
}

/// True if the growth of `G` along the circle of a coordinate is 0 by a symmetry; D must connect all configurations.
pub(super) fn has_no_period(
    model: &Model,
    problem: &Problem,
    local: &Local,
    angle: usize,
    seed: u64,
) -> bool {
    let maps = maps(model, problem, angle);
    let roots = problem.roots();
    let profile = model.pool.profile_of(&roots);
    if profile.branches {
        return false;
    }
    let Ok(mut points) = sample_points(&model.pool, &roots, &profile, seed) else {
        return false;
    };
    let mut left = maps;
    for _ in 0..POINTS {
        let kept = points.find(|point| {
            let slope = slope(model, problem, local, angle, &mut point.clone())?;
            let field = point.modulus();
            let changes_sign = |map: &Vec<(SymbolId, Move)>| {
                let image = image(model, point, map)
                    .and_then(|mut point| self::slope(model, problem, local, angle, &mut point));
                image.is_some_and(|image| field.add(slope, image) == 0)
            };
            Some(
                left.iter()
                    .filter(|map| changes_sign(map))
                    .cloned()
                    .collect(),
            )
        });
        left = kept.unwrap_or_default();
        if left.is_empty() {
            return false;
        }
    }
    true
}

/// The maps that move the angle, or leave it, and each of the other coordinates on which anything depends.
fn maps(model: &Model, problem: &Problem, angle: usize) -> Vec<Vec<(SymbolId, Move)>> {
    let first = [REFLECTED, SUPPLEMENT, OPPOSITE, STAYS];
    let symbol = model.coordinates[angle].q;
    let mut maps: Vec<Vec<_>> = first.iter().map(|moved| vec![(symbol, *moved)]).collect();
    let others = problem.variables.iter().copied();
    for i in others.filter(|i| *i != angle && *i < problem.coordinates) {
        let moves: &[Move] = match model.coordinates[i].topology {
            Topology::Line => &[STAYS, REFLECTED],
            Topology::Angle => &[STAYS, REFLECTED, SUPPLEMENT, OPPOSITE],
            // The charts of Euler angles are `(0, pi)` mostly; another one is not mapped to itself.
            Topology::Interval { low, high } => match is_half_circle(model, low, high) {
                true => &[STAYS, SUPPLEMENT],
                false => &[STAYS],
            },
        };
        let symbol = model.coordinates[i].q;
        let longer = moves.iter().flat_map(|moved| {
            let with = |map: &Vec<_>| [map.clone(), vec![(symbol, *moved)]].concat();
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
            .move_symbol(*symbol, assumption, moved.half_turns, moved.is_reflected)
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
