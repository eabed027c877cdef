//! The map of a reset on velocities, and what it does to the volume `mu_C`.
//!
//! Where positions stay and there are no constraints, the map in a fibre has the determinant `D = det(dqdot+/dqdot)`, and
//! the volume is multiplied by `|D G+/G-|`, G the gap rate before and after.

use dalembert_expr::{Arithmetic, ExpansionPoint, ExprId, Pool, Sign, SymbolId, Verdict as Zero};

use super::dynamics::Number;
use super::potential::factor_text;
use crate::mechanics::Derivation;
use crate::model::Model;

/// Velocities that a reset may set for its determinant to be expanded.
const LARGEST: usize = 6;

/// A declared reset.
#[derive(Debug)]
pub(super) struct ResetMap {
    /// The velocities after it.
    velocities: Vec<ExprId>,
    /// What it does to the volume.
    volume: Result<Change, String>,
}

/// The parts of `D G+/G-`.
#[derive(Debug)]
struct Change {
    determinant: ExprId,
    gap_rate_after: ExprId,
    /// `D G+/G-` where that does not depend on the velocities.
    factor: Option<ExprId>,
}

impl ResetMap {
    /// The reset of a surface, if that is its law.
    pub(super) fn of(model: &mut Model, derivation: &Derivation, surface: usize) -> Option<Self> {
        let reset = model.surfaces[surface].reset.clone()?;
        let symbols: Vec<SymbolId> = model.coordinates.iter().map(|own| own.qdot).collect();
        let velocities = symbols
            .iter()
            .zip(&reset.qdot)
            .map(|(&symbol, value)| value.unwrap_or_else(|| model.pool.variable(symbol)))
            .collect();
        let set: Vec<(SymbolId, ExprId)> = symbols
            .iter()
            .zip(&reset.qdot)
            .filter_map(|(&symbol, value)| Some((symbol, (*value)?)))
            .collect();
        let volume = if reset.moves() {
            Err("the change of a volume by a reset of positions is not known".to_owned())
        } else if !derivation.constraints.is_empty() {
            Err("the change of a volume by a reset within constraints is not known".to_owned())
        } else if set.len() > LARGEST {
            Err(format!("its reset sets more than {LARGEST} velocities"))
        } else {
            let gap_rate = derivation.surfaces[surface].gap_rate;
            Ok(Change::of(&mut model.pool, &set, &symbols, gap_rate))
        };
        Some(Self { velocities, volume })
    }

    /// Everything that is evaluated.
    pub(super) fn roots(&self) -> Vec<ExprId> {
        let parts = self.volume.iter();
        let parts = parts.flat_map(|own| [own.determinant, own.gap_rate_after]);
        self.velocities.iter().copied().chain(parts).collect()
    }

    /// Why it is not known what it does to a volume, if it is not.
    pub(super) fn open(&self) -> Option<&str> {
        self.volume.as_ref().err().map(String::as_str)
    }

    /// The velocities after the impact.
    pub(super) fn velocities_after<P: ExpansionPoint>(
        &self,
        model: &Model,
        point: &mut P,
    ) -> Option<Vec<Number<P>>> {
        let values = point.values(&model.pool, &model.pool.reachable(&self.velocities))?;
        Some(
            self.velocities
                .iter()
                .map(|id| values[id.index()])
                .collect(),
        )
    }

    /// By how much the volume is multiplied, up to its sign.
    pub(super) fn jacobian<P: ExpansionPoint>(
        &self,
        model: &Model,
        point: &mut P,
        gap_rate: ExprId,
    ) -> Option<Number<P>> {
        let own = self.volume.as_ref().ok()?;
        let field = point.field();
        let wanted = [own.determinant, own.gap_rate_after, gap_rate];
        let values = point.values(&model.pool, &model.pool.reachable(&wanted))?;
        let [determinant, after, before] = wanted.map(|id| values[id.index()]);
        Some(field.mul(determinant, field.mul(after, field.inv(before)?)))
    }

    /// The same as an expression of positions and parameters, if it is one.
    pub(super) fn factor_text(&self, pool: &Pool) -> Option<String> {
        let factor = self.volume.as_ref().ok()?.factor?;
        Some(match pool.sign(factor) {
            Sign::Positive | Sign::NonNegative => factor_text(pool, factor),
            _ => format!("|{}|", pool.text(factor)),
        })
    }
}

impl Change {
    fn of(
        pool: &mut Pool,
        set: &[(SymbolId, ExprId)],
        velocities: &[SymbolId],
        gap_rate: ExprId,
    ) -> Self {
        let rows: Vec<Vec<ExprId>> = set
            .iter()
            .map(|&(_, value)| set.iter().map(|&(by, _)| pool.diff(value, by)).collect())
            .collect();
        let determinant = determinant(pool, &rows, &(0..set.len()).collect::<Vec<_>>());
        let gap_rate_after = pool.substitute(gap_rate, set);
        let ratio = ratio(pool, gap_rate_after, gap_rate, velocities);
        let factor = ratio.map(|ratio| pool.mul(determinant, ratio));
        Self {
            determinant,
            gap_rate_after,
            factor: factor.filter(|&own| !pool.depends_on_any(own, velocities)),
        }
    }
}

/// `left / right` of two functions that are linear in the velocities, if it does not depend on them.
fn ratio(pool: &mut Pool, left: ExprId, right: ExprId, velocities: &[SymbolId]) -> Option<ExprId> {
    velocities.iter().find_map(|&velocity| {
        let slope = pool.diff(right, velocity);
        if pool.zero_test(slope) != Zero::Refuted {
            return None;
        }
        let above = pool.diff(left, velocity);
        let ratio = pool.div(above, slope);
        let scaled = pool.mul(ratio, right);
        let rest = pool.sub(left, scaled);
        let is_it = !pool.depends_on_any(ratio, velocities) && pool.zero_test(rest) == Zero::Proved;
        is_it.then_some(ratio)
    })
}

/// The determinant of the first rows in these columns, by its first row; that of no rows is 1.
fn determinant(pool: &mut Pool, rows: &[Vec<ExprId>], columns: &[usize]) -> ExprId {
    let Some((first, others)) = rows.split_first() else {
        return pool.one();
    };
    let mut total = pool.zero();
    for (place, &column) in columns.iter().enumerate() {
        if pool.is_syntactic_zero(first[column]) {
            continue;
        }
        let rest: Vec<usize> = columns
            .iter()
            .copied()
            .filter(|&own| own != column)
            .collect();
        let minor = determinant(pool, others, &rest);
        let term = pool.mul(first[column], minor);
        total = match place % 2 {
            0 => pool.add(total, term),
            _ => pool.sub(total, term),
        };
    }
    total
}
