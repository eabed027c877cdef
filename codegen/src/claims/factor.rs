//! Factor of a volume at a reset or a transition, as an expression if it does not depend on velocities.

use dalembert_expr::{ExprId, Pool, Sign, SymbolId, Verdict as Zero};

use super::passage::{Passage, Velocities};
use super::potential::factor_text;
use crate::mechanics::inverse::determinant;
use crate::model::Model;

/// Largest number of rows of an expanded determinant.
const LARGEST: usize = 6;

/// The factor of `mu_C`, up to its sign; `None` where there are constraints, or where no closed form is found.
pub(super) fn closed_form(model: &mut Model, passage: &Passage) -> Option<ExprId> {
    let n = passage.positions.len();
    let sides = [&passage.before, &passage.after];
    let is_free = sides.iter().all(|side| side.forms.is_empty());
    if passage.open.is_some() || !is_free || n > LARGEST {
        return None;
    }
    let rows = |pool: &mut Pool, rows: &[Vec<ExprId>]| {
        let columns: Vec<usize> = (0..rows.len()).collect();
        determinant(pool, rows, &columns)
    };
    let pool = &mut model.pool;
    let fibre = match &passage.velocities {
        Velocities::Refracted | Velocities::Nearest => return Some(pool.one()),
        Velocities::Rates => pool.one(),
        Velocities::Declared(_, slopes) => rows(pool, slopes),
    };
    let metric = match sides[0].metric == sides[1].metric {
        true => pool.one(),
        false => {
            let [before, after] = sides.map(|side| rows(pool, &side.metric));
            pool.div(after, before)
        }
    };
    let symbols: Vec<SymbolId> = model
        .coordinates
        .iter()
        .map(|coordinate| coordinate.qdot)
        .collect();
    let (bordered, gap_rate) = passage.bordered(model);
    let bordered = rows(&mut model.pool, &bordered);
    let moving: Vec<SymbolId> = match sides[0].rates {
        Some(_) => model
            .coordinates
            .iter()
            .map(|coordinate| coordinate.q)
            .collect(),
        None => symbols.clone(),
    };
    let pool = &mut model.pool;
    let flux = match pool.zero_test(gap_rate) {
        Zero::Refuted => quotient(pool, bordered, gap_rate, &moving)?,
        _ => return None,
    };
    let factor = pool.product(&[metric, fibre, flux]);
    let factor = pool.simplify(factor);
    (!pool.depends_on_any(factor, &symbols)).then_some(factor)
}

/// A factor as text, without its sign.
pub(super) fn size_text(pool: &Pool, factor: ExprId) -> String {
    match pool.sign(factor) {
        Sign::Positive | Sign::NonNegative => factor_text(pool, factor),
        _ if pool.as_number(factor).is_some() => pool
            .as_number(factor)
            .map_or_else(String::new, |number| number.abs().to_string()),
        _ => format!("|{}|", pool.text(factor)),
    }
}

/// `left / right`. If `right` depends on the symbols, this is the quotient of the slopes in one symbol; `None` unless
/// that quotient is free of the symbols.
fn quotient(pool: &mut Pool, left: ExprId, right: ExprId, symbols: &[SymbolId]) -> Option<ExprId> {
    if !pool.depends_on_any(right, symbols) {
        return Some(pool.div(left, right));
    }
    symbols.iter().find_map(|&symbol| {
        let slope = pool.diff(right, symbol);
        if pool.zero_test(slope) != Zero::Refuted {
            return None;
        }
        let above = pool.diff(left, symbol);
        let ratio = pool.div(above, slope);
        let scaled = pool.mul(ratio, right);
        let rest = pool.sub(left, scaled);
        let is_it = !pool.depends_on_any(ratio, symbols) && pool.zero_test(rest) == Zero::Proved;
        is_it.then_some(ratio)
    })
}
