//! Orthogonal rows or columns of a block of the constraint forms.
//!
//! Write each column as `c = f d`, with `f` the common factor of its entries. The component of a right-hand side `r`
//! along it, `c . r / (c . c)`, is `d . r / (f d . d)`. The block is singular exactly where a factor is 0, and no
//! division is by the square of a factor.

use dalembert_expr::{ExprId, Pool, Verdict};

use super::choice::squared_norm;
use crate::mechanics::common_factor::without_common_factor;
use crate::mechanics::constraint::amplitude;

/// A row or a column of a block, `factor * entries`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Axis {
    /// Common factor of all entries.
    pub factor: ExprId,
    /// The entries without `factor`.
    pub entries: Vec<ExprId>,
    /// Squared norm of the axis, never zero.
    pub squared: ExprId,
    /// Upper bound of `|factor|`, with sines and cosines counted as 1; `None` if the factor never vanishes.
    pub bound: Option<ExprId>,
}

/// The vectors as axes; `None` unless they are proved orthogonal, and vanish only with their common factors.
pub(super) fn orthogonal(pool: &mut Pool, vectors: &[Vec<ExprId>]) -> Option<Vec<Axis>> {
    let axes: Option<Vec<Axis>> = vectors.iter().map(|vector| axis(pool, vector)).collect();
    let axes = axes?;
    for (index, axis) in axes.iter().enumerate() {
        for other in &axes[index + 1..] {
            let pairs = axis.entries.iter().zip(&other.entries);
            let products: Vec<ExprId> = pairs.map(|(&a, &b)| pool.mul(a, b)).collect();
            let product = pool.sum(&products);
            if pool.zero_test(product) != Verdict::Proved {
                return None;
            }
        }
    }
    Some(axes)
}

/// A vector as a multiple of one that vanishes nowhere; `None` if this is not shown.
fn axis(pool: &mut Pool, vector: &[ExprId]) -> Option<Axis> {
    let (factor, entries) = without_common_factor(pool, vector);
    let squared = squared_norm(pool, &entries);
    let bound = match pool.sign(factor).is_nonzero() {
        true => None,
        false => Some(amplitude(pool, factor)),
    };
    let is_regular = pool.sign(squared).is_nonzero();
    is_regular.then_some(Axis {
        factor,
        entries,
        squared,
        bound,
    })
}
