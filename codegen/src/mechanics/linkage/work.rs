//! Estimates of the operations of a rate, by the linkage and by the metric.

use std::collections::BTreeSet;

use dalembert_expr::{ExprId, Node, Pool};

use super::{Linkage, Part};
use crate::model::Model;

/// True if the linkage takes clearly fewer operations than the metric.
pub(super) fn is_shorter(model: &Model, linkage: &Linkage, force: &[ExprId]) -> bool {
    let pool = &model.pool;
    let n = force.len();
    let rows = model.lagrangian.metric.iter().enumerate();
    let metric: Vec<ExprId> = rows.flat_map(|(i, row)| row[..=i].to_vec()).collect();
    let by_metric = operations(pool, &[&metric, force].concat()) + elimination(pool, model, n);
    let terms = linkage.derived.iter().flat_map(|derived| &derived.terms);
    let terms = terms.map(|term| &term.factor);
    let coefficients = terms.chain(linkage.squares.iter().map(|square| &square.weight));
    let mut parts = linkage.force.clone();
    parts.extend(linkage.gradient.iter().map(|(_, derivative)| *derivative));
    let mut products = 0;
    for coefficient in coefficients {
        parts.push(coefficient.value);
        parts.extend(
            coefficient
                .gradient
                .iter()
                .map(|(_, derivative)| *derivative),
        );
        products += 3 + 2 * coefficient.gradient.len();
    }
    let by_linkage = operations(pool, &parts) + products + along(linkage, n);
    4 * by_linkage < 3 * by_metric
}

/// Operations of the expressions, each computed once.
fn operations(pool: &Pool, roots: &[ExprId]) -> usize {
    let of = |id: &ExprId| match pool.node(*id) {
        Node::Number(_) | Node::Pi | Node::Symbol(_) => 0,
        Node::Sum { terms, .. } => terms.len(),
        Node::Product(factors) => factors.len(),
        Node::Call(..) | Node::Atan2(..) => 1,
    };
    pool.reachable(roots).iter().map(of).sum()
}

/// Products of the elimination of the metric row by row, and of one solution.
fn elimination(pool: &Pool, model: &Model, n: usize) -> usize {
    let metric = &model.lagrangian.metric;
    let mut filled: Vec<BTreeSet<usize>> = Vec::with_capacity(n);
    let mut products = 0;
    for i in 0..n {
        let mut row: BTreeSet<usize> = (0..i)
            .filter(|&j| !pool.is_syntactic_zero(metric[i][j]))
            .collect();
        for j in 0..i {
            let shared = filled[j].iter().filter(|k| row.contains(k)).count();
            if shared > 0 {
                row.insert(j);
                products += shared;
            }
        }
        products += 4 * row.len();
        filled.push(row);
    }
    products
}

/// Products of the elimination along the linkage, and of one solution.
fn along(linkage: &Linkage, n: usize) -> usize {
    let mut met = vec![BTreeSet::<Part>::new(); n + linkage.derived.len()];
    let mut products = 0;
    for &part in &linkage.order {
        let beside = std::mem::take(&mut met[part]);
        let parts: BTreeSet<Part> = match part.checked_sub(n) {
            Some(w) => {
                let terms = linkage.derived[w].terms.iter().map(|term| term.part);
                let terms: BTreeSet<Part> = terms.collect();
                products += terms.len() * (terms.len() + 1 + beside.len());
                terms.union(&beside).copied().collect()
            }
            None => {
                products += beside.len() * (beside.len() + 7) / 2;
                beside
            }
        };
        for &a in &parts {
            met[a].remove(&part);
            for &b in &parts {
                if a != b {
                    met[a].insert(b);
                }
            }
        }
    }
    products
}
