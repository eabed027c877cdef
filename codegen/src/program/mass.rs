//! Factorisation of the constraint mass matrix `m^{ab} = eta^a(W^b)`, used where it is sparse.
//!
//! In a long chain each constraint meets two others. Then `m` is tridiagonal and its factorisation takes O(M)
//! operations, whereas orthogonal columns fill up. In return the condition number of the forms enters squared, so every
//! pivot has a guard. The ratio of a pivot to its diagonal entry `m^{aa}` is the squared sine of the angle between a
//! form and the forms eliminated before it. Its reciprocal bounds the growth of rounding errors at this pivot. Below
//! [`Guard::LEAST_PIVOT_RATIO`] the function ends with `SingularConstraint`, although orthogonalisation would still
//! work.
//!
//! Constraints are eliminated in minimum-degree order (Tinney and Walker, Proc. IEEE 55 (1967)).

use super::builder::Builder;
use super::linear::{Ldlt, Orthogonal};
use super::{Guard, Value};

/// Number of constraints below which orthogonalisation is always used, because its extra cost is small.
const LEAST: usize = 8;

/// Factorisation used to solve for the multipliers.
#[derive(Debug)]
pub enum ConstraintFactors {
    /// By orthogonal columns.
    Orthogonal(Orthogonal),
    /// By factors of `m^{ab}`.
    Sparse(SparseMass),
}

/// Factors of `m^{ab}`, in an order of elimination that keeps them sparse.
#[derive(Debug)]
pub struct SparseMass {
    /// `C_a = L^{-1} eta^a`
    columns: Vec<Vec<Value>>,
    /// Constraint eliminated at each step.
    order: Vec<usize>,
    /// The factors, in the order of elimination.
    factors: Ldlt,
}

impl ConstraintFactors {
    /// Factorises the columns `C_a = L^{-1} eta^a` of the constraints with the indices `which`. `independent` is true
    /// if their forms are proved to be independent.
    pub fn factor(
        builder: &mut Builder,
        metric: &Ldlt,
        columns: Vec<Vec<Value>>,
        which: &[usize],
        independent: bool,
    ) -> Self {
        if let Some(order) = sparse_order(builder, &columns) {
            return Self::Sparse(SparseMass::factor(builder, metric, columns, order, which));
        }
        let guard = |index: usize, squared, reference: Option<Value>| Guard::Constraint {
            constraint: which[index],
            squared,
            reference: reference.filter(|_| !independent),
        };
        Self::Orthogonal(Orthogonal::factor(builder, metric, columns, guard))
    }

    /// The M numbers whose product is `det m^{ab}`.
    pub fn squares(&self) -> &[Value] {
        match self {
            Self::Orthogonal(orthogonal) => &orthogonal.squares,
            Self::Sparse(sparse) => &sparse.factors.pivots,
        }
    }

    /// The remainder of `y` after its components along the columns are removed.
    pub fn project(&self, builder: &mut Builder, metric: &Ldlt, y: Vec<Value>) -> Vec<Value> {
        match self {
            Self::Orthogonal(orthogonal) => orthogonal.reduce(builder, metric, y).1,
            Self::Sparse(sparse) => sparse.project(builder, metric, y),
        }
    }

    /// The multipliers `lambda` with `m lambda = -(C^T D^{-1} y + s)`.
    pub fn solve(
        &self,
        builder: &mut Builder,
        metric: &Ldlt,
        y: Vec<Value>,
        s: &[Value],
    ) -> Vec<Value> {
        match self {
            Self::Orthogonal(orthogonal) => orthogonal.solve(builder, metric, y, s),
            Self::Sparse(sparse) => {
                let products = sparse.products(builder, metric, &y);
                let sums: Vec<Value> = products
                    .iter()
                    .zip(s)
                    .map(|(&product, &s)| builder.add(product, s))
                    .collect();
                let solution = sparse.solve(builder, &sums);
                solution
                    .into_iter()
                    .map(|component| builder.neg(component))
                    .collect()
            }
        }
    }

    /// `m_ab`
    pub fn inverse_mass(&self, builder: &mut Builder) -> Vec<Vec<Value>> {
        match self {
            Self::Orthogonal(orthogonal) => orthogonal.inverse_mass(builder),
            Self::Sparse(sparse) => sparse.inverse(builder),
        }
    }
}

impl SparseMass {
    fn factor(
        builder: &mut Builder,
        metric: &Ldlt,
        columns: Vec<Vec<Value>>,
        order: Vec<usize>,
        which: &[usize],
    ) -> Self {
        let mass: Vec<Vec<Value>> = (0..order.len())
            .map(|i| {
                let entries = order[..=i].iter();
                entries
                    .map(|&b| metric.inner(builder, &columns[order[i]], &columns[b]))
                    .collect()
            })
            .collect();
        let guard = |builder: &mut Builder, place: usize, pivot: Value| {
            builder.guard(Guard::Mass {
                constraint: which[order[place]],
                pivot,
                diagonal: mass[place][place],
            });
        };
        let factors = Ldlt::factor_guarded(builder, &mass, &[], guard);
        Self {
            columns,
            order,
            factors,
        }
    }

    /// `C^T D^{-1} y`
    fn products(&self, builder: &mut Builder, metric: &Ldlt, y: &[Value]) -> Vec<Value> {
        let columns = self.columns.iter();
        columns
            .map(|column| metric.inner(builder, column, y))
            .collect()
    }

    /// `m^{-1} r`
    fn solve(&self, builder: &mut Builder, r: &[Value]) -> Vec<Value> {
        let placed: Vec<Value> = self.order.iter().map(|&a| r[a]).collect();
        let solution = self.factors.solve(builder, &placed);
        let mut result = vec![builder.zero(); r.len()];
        for (&a, value) in self.order.iter().zip(solution) {
            result[a] = value;
        }
        result
    }

    fn project(&self, builder: &mut Builder, metric: &Ldlt, y: Vec<Value>) -> Vec<Value> {
        let products = self.products(builder, metric, &y);
        let weights = self.solve(builder, &products);
        let mut rest = y;
        for (column, &weight) in self.columns.iter().zip(&weights) {
            for (entry, &component) in rest.iter_mut().zip(column) {
                *entry = builder.sub_product(*entry, weight, component);
            }
        }
        rest
    }

    fn inverse(&self, builder: &mut Builder) -> Vec<Vec<Value>> {
        let m = self.order.len();
        let unit = |builder: &mut Builder, a: usize| -> Vec<Value> {
            let entries = (0..m).map(|b| builder.integer(i64::from(a == b)));
            entries.collect()
        };
        let mut rows: Vec<Vec<Value>> = (0..m)
            .map(|a| {
                let unit = unit(builder, a);
                self.solve(builder, &unit)
            })
            .collect();
        // Entries (a, b) and (b, a) differ by rounding. One of them is used for both, so that the matrix is symmetric.
        for a in 0..m {
            for b in 0..a {
                rows[b][a] = rows[a][b];
            }
        }
        rows
    }
}

/// The order of elimination, if the factorisation of `m` takes less than half of the operations of orthogonal columns.
fn sparse_order(builder: &Builder, columns: &[Vec<Value>]) -> Option<Vec<usize>> {
    if columns.len() < LEAST {
        return None;
    }
    let patterns: Vec<Vec<bool>> = columns
        .iter()
        .map(|column| {
            column
                .iter()
                .map(|&entry| !builder.is_zero(entry))
                .collect()
        })
        .collect();
    let (order, sparse) = minimum_degree(&patterns);
    (2 * sparse < orthogonal_work(&patterns)).then_some(order)
}

/// Number of non-zero components that two columns have in common.
fn common(a: &[bool], b: &[bool]) -> usize {
    a.iter().zip(b).filter(|(a, b)| **a && **b).count()
}

/// Number of non-zero components of a column.
fn entries(column: &[bool]) -> usize {
    common(column, column)
}

/// Number of products in modified Gram-Schmidt for columns with these non-zero components, and for one full right-hand
/// side.
fn orthogonal_work(patterns: &[Vec<bool>]) -> usize {
    let mut filled: Vec<Vec<bool>> = Vec::new();
    let mut work = 0;
    for pattern in patterns {
        let mut pattern = pattern.clone();
        work += 2 * entries(&pattern);
        for earlier in &filled {
            let shared = common(earlier, &pattern);
            if shared > 0 {
                work += 2 * shared + entries(earlier);
                for (filled, &other) in pattern.iter_mut().zip(earlier) {
                    *filled |= other;
                }
            }
        }
        // Squared norm of the column, and removal of the right-hand side's component along it.
        work += 5 * entries(&pattern);
        filled.push(pattern);
    }
    work
}

/// Minimum-degree order, in which each step eliminates the constraint with the fewest remaining neighbours, and the
/// number of products that the entries of `m`, its factorisation in this order and one solution take.
fn minimum_degree(patterns: &[Vec<bool>]) -> (Vec<usize>, usize) {
    let m = patterns.len();
    let mut meets: Vec<Vec<bool>> = patterns
        .iter()
        .map(|pattern| {
            patterns
                .iter()
                .map(|other| common(pattern, other) > 0)
                .collect()
        })
        .collect();
    let mut work = 0;
    for (a, pattern) in patterns.iter().enumerate() {
        let products: usize = patterns[..=a]
            .iter()
            .map(|other| common(pattern, other))
            .sum();
        work += 2 * (products + entries(pattern));
    }
    let mut left: Vec<usize> = (0..m).collect();
    let mut order = Vec::with_capacity(m);
    while !left.is_empty() {
        let degree = |a: usize| left.iter().filter(|b| **b != a && meets[a][**b]).count();
        // The first of the constraints with the fewest neighbours, so that every build has the same order.
        let Some(place) = (0..left.len()).min_by_key(|place| degree(left[*place])) else {
            break;
        };
        let next = left.remove(place);
        let neighbours: Vec<usize> = left.iter().copied().filter(|b| meets[next][*b]).collect();
        work += 1 + neighbours.len() * (neighbours.len() + 7) / 2;
        for &a in &neighbours {
            for &b in &neighbours {
                meets[a][b] = true;
            }
        }
        order.push(next);
    }
    (order, work)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Columns with non-zero entries at these components.
    fn patterns(size: usize, columns: &[&[usize]]) -> Vec<Vec<bool>> {
        let column = |ones: &&[usize]| (0..size).map(|i| ones.contains(&i)).collect();
        columns.iter().map(column).collect()
    }

    #[test]
    fn a_chain_takes_work_in_proportion_to_its_length() {
        let work = |links: usize| {
            let columns: Vec<Vec<usize>> = (0..links).map(|a| vec![a, a + 1]).collect();
            let columns: Vec<&[usize]> = columns.iter().map(Vec::as_slice).collect();
            let patterns = patterns(links + 1, &columns);
            (minimum_degree(&patterns).1, orthogonal_work(&patterns))
        };
        let (short, long) = (work(16), work(32));
        assert!(long.0 - short.0 <= 16 * 16, "{short:?} {long:?}");
        assert!(long.1 > 3 * short.1, "{short:?} {long:?}");
    }

    #[test]
    fn the_middle_of_a_star_is_eliminated_last() {
        let patterns = patterns(4, &[&[0, 1, 2, 3], &[0], &[1], &[2], &[3]]);
        let (order, _) = minimum_degree(&patterns);
        // Then the centre and one ray are left, with one neighbour each.
        assert_eq!(order[..3], [1, 2, 3]);
    }
}
