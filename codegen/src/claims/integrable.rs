//! `integrable: f, g, ..`: as many functions as D has dimensions, each conserved by the motion and at every surface, in
//! involution, with differentials that are independent at almost all states.
//!
//! Without constraints, forces and dependence on time, these are the hypotheses of the theorem of Liouville and Arnold.
//! A surface that keeps each function keeps their common level sets (W. Clark, thesis, VIII.6). With constraints, forces
//! or dependence on time, the claim says no more than the listed properties: forces do not enter the bracket, and with
//! constraints the bracket is almost Poisson.

use dalembert_expr::{ExprId, Node, Pool, Sign, Singularity};

use super::conserved::check_conserved;
use super::defaults::Defaults;
use super::evidence::{Vanishing, Wording, evidence};
use super::examine::explicit;
use super::expansion::{Part, Tangents, is_too_large};
use super::finding::{Certificate, Verdict, Witness};
use super::hybrid::Surroundings;
use super::impact::check_conserved_under;
use super::invariant::ACROSS;
use super::invariant::ranked_at_states;
use super::involution::check_involution;
use super::lie::Lie;
use super::residues::vanishes_nowhere;
use super::sample::ATTEMPTS;
use super::together::Together;
use super::undecided::Undecided;
use crate::model::{ExteriorForm, Model, StatedFunction};

/// A function of positions, velocities and time, with its text.
type Named<'n> = (ExprId, &'n str);

/// The functions of a claim, with energy and momenta written out.
fn written_out<'f>(model: &mut Model, functions: &'f [StatedFunction]) -> Vec<Named<'f>> {
    let functions = functions.iter();
    functions
        .map(|function| (explicit(model, function.value), &*function.written))
        .collect()
}

/// The verdict on `integrable: f, g, ..`.
pub(super) fn check_integrable(
    model: &mut Model,
    around: &Surroundings<'_>,
    declared: &[StatedFunction],
) -> Verdict {
    let names: Vec<String> = (declared.iter())
        .map(|function| format!("`{}`", function.written))
        .collect();
    let functions = &*written_out(model, declared);
    let all = Certificate::without_chance(names.join(", "), around.seed);
    let mut together = Together::of(all);
    let dynamics = std::slice::from_ref(around.dynamics);
    for function in functions {
        let verdict = check_conserved(model, dynamics, *function, true, around.seed);
        if let Some(refuted) = together.add(verdict) {
            return refuted;
        }
    }
    let involution = check_involution(model, around, declared);
    if let Some(refuted) = together.add(involution) {
        return refuted;
    }
    let independence = are_independent_at_defaults(model, around, functions);
    if let Some(refuted) = together.add(independence) {
        return refuted;
    }
    together.all.shown += match declared {
        [_] => " is conserved, and its differential vanishes at almost no state",
        _ => " are conserved, in involution and independent at almost all states",
    };
    for surface in model.acting_surfaces() {
        for StatedFunction { value, written } in declared {
            let stated = (*value, written.as_str());
            let verdict = check_conserved_under(model, around, surface, stated, true);
            if let Some(refuted) = together.add(verdict) {
                return of_surface(model, surface, refuted);
            }
        }
        let name = &model.surfaces[surface].name.display;
        let kept = if declared.len() == 1 { "it" } else { "them" };
        together.all.shown += &format!("; `{name}` keeps {kept}");
    }
    together.verdict()
}

/// The refutation at a surface, with advice.
fn of_surface(model: &Model, surface: usize, verdict: Verdict) -> Verdict {
    let Verdict::Refuted(witness) = verdict else {
        return verdict;
    };
    let name = &model.surfaces[surface].name.display;
    let help = format!("leave it out, or claim it for a scene that does not use `{name}`");
    Verdict::Refuted(Witness { help, ..witness })
}

/// The verdict on the independence of functions, for indeterminate parameters and at the declared defaults.
fn are_independent_at_defaults(
    model: &mut Model,
    around: &Surroundings<'_>,
    functions: &[Named<'_>],
) -> Verdict {
    let generic = are_independent(model, around, functions);
    let values: Vec<ExprId> = functions.iter().map(|(value, _)| *value).collect();
    let defaults = Defaults::of(model, &values);
    if defaults.is_empty() || !matches!(generic, Verdict::Proved(_)) {
        return generic;
    }
    let mut replaced = Vec::new();
    for (value, written) in functions {
        let value = model.pool.substitute(*value, defaults.replacements());
        replaced.push((value, *written));
    }
    let declared = are_independent(model, around, &replaced);
    defaults.confirmed(generic, declared)
}

/// The verdict on `df_1 ^ .. ^ df_k != 0` at almost all states: one component that is not 0 at one state proves it.
fn are_independent(
    model: &mut Model,
    around: &Surroundings<'_>,
    functions: &[Named<'_>],
) -> Verdict {
    let Some((tangents, leads_across)) = Tangents::of_states(model, around.dynamics) else {
        return Verdict::Undecided(Undecided::Degenerate.to_string());
    };
    if leads_across {
        return Verdict::Undecided(format!("whether they are independent: {ACROSS}"));
    }
    if let Some((_, written)) = functions
        .iter()
        .find(|(value, _)| !is_analytic(&model.pool, *value))
    {
        return Verdict::Undecided(format!(
            "`{written}` has an absolute value, or a root, logarithm or angle that may have a kink: independence at one state says nothing about the states beyond it"
        ));
    }
    let degree = functions.len();
    if is_too_large(tangents.dimension(), degree) {
        let text = "the differentials have more minors than are examined";
        return Verdict::Undecided(text.to_owned());
    }
    let one = model.pool.one();
    let mut form = ExteriorForm::function(&model.pool, one);
    for (value, _) in functions {
        let differential = ExteriorForm::differential(&model.pool, *value);
        form = form.wedge(&mut model.pool, &differential);
    }
    let mut question = Lie::of(model, around.dynamics, &tangents, &form).of_form();
    question.part = Part::All(around.seed);
    let all = evidence(model, &question, around.seed);
    if all.shows_that_it_vanishes() {
        return Verdict::Refuted(dependent(model, &question, functions));
    }
    // Functions may be dependent on one component of the positions and independent on another.
    let is_connected = around.dynamics.positions().is_everything();
    if !is_connected && !vanishes_nowhere(model, &question, around.seed) {
        let text = "whether they are independent on every component of the positions";
        return Verdict::Undecided(text.to_owned());
    }
    let open = all.open.to_string();
    let names = tangents.names(model);
    for places in ranked_at_states(model, &question) {
        let vectors: Vec<&str> = places.iter().map(|place| &*names[*place]).collect();
        question.shown = format!("determinant of the differentials on {}", vectors.join(", "));
        question.part = Part::One(places);
        let one = evidence(model, &question, around.seed);
        let proof = one.verdict(false, Wording::default(), around.seed);
        if matches!(proof, Verdict::Proved(_)) {
            return proof;
        }
    }
    Verdict::Undecided(format!("whether they are independent: {open}"))
}

/// True if a function is a single analytic function on its states: if it is not 0 at one state, it is not 0 at almost
/// all.
///
/// Roots and logarithms of functions that are positive everywhere have no branches.
fn is_analytic(pool: &Pool, function: ExprId) -> bool {
    let is_positive = |id: ExprId| pool.sign(id) == Sign::Positive;
    pool.reachable(&[function])
        .into_iter()
        .all(|id| match pool.node(id) {
            Node::Product(factors) => factors
                .iter()
                .all(|(base, exponent)| exponent.is_integer() || is_positive(*base)),
            Node::Call(function, argument) => match function.singularity() {
                Singularity::None | Singularity::Poles => true,
                Singularity::Logarithm { shift } => {
                    pool.sign_of_shifted(*argument, shift) == Sign::Positive
                }
                Singularity::Ends | Singularity::Kink => false,
            },
            Node::Atan2(..) => false,
            Node::Number(_) | Node::Pi | Node::Symbol(_) | Node::Sum { .. } => true,
        })
}

/// The relation of the differentials at a state.
fn dependent(model: &Model, question: &Lie<'_>, functions: &[Named<'_>]) -> Witness {
    let found = (0..ATTEMPTS).find_map(|attempt| {
        let (sample, mut point) = question.sample(model, attempt)?;
        let rows = question.products(model, &mut point)?.only_rows()?;
        Some((sample, relation(rows)?))
    });
    let (sample, values) = match found {
        Some((sample, factors)) => {
            // The form has its differentials in the order of their indices.
            let mut order: Vec<usize> = (0..functions.len()).collect();
            order.sort_by_key(|i| functions[*i].0);
            let mut named: Vec<(usize, f64)> = order.into_iter().zip(factors).collect();
            named.sort_by_key(|(i, _)| *i);
            let named = named.into_iter();
            let named =
                named.map(|(i, factor)| (format!("factor of d({})", functions[i].1), factor));
            (Some(sample), named.collect())
        }
        None => (None, Vec::new()),
    };
    Witness {
        reason: "the differentials of the functions are dependent at all states: one function follows from the others; this combination is 0"
            .to_owned(),
        sample,
        values,
        help: "state functions that are independent".to_owned(),
    }
}

/// Factors with which the rows add up to 0, scaled so that the largest absolute value is 1. `None` if the rows are
/// independent.
fn relation(rows: Vec<Vec<f64>>) -> Option<Vec<f64>> {
    /// Fraction of the size of a row below which its remainder counts as rounding.
    const ROUNDING: f64 = 1e-9;
    let size = |row: &[f64]| {
        row.iter()
            .fold(0.0_f64, |size, entry| size.max(entry.abs()))
    };
    let count = rows.len();
    let mut done: Vec<(Vec<f64>, Vec<f64>, usize)> = Vec::new();
    for (i, mut row) in rows.into_iter().enumerate() {
        let before = size(&row);
        let mut factors = vec![0.0; count];
        factors[i] = 1.0;
        for (other, by, pivot) in &done {
            let factor = row[*pivot] / other[*pivot];
            for (entry, value) in row.iter_mut().zip(other) {
                *entry -= factor * value;
            }
            for (entry, value) in factors.iter_mut().zip(by) {
                *entry -= factor * value;
            }
        }
        if size(&row) <= ROUNDING * before {
            let largest = size(&factors);
            return Some(factors.into_iter().map(|factor| factor / largest).collect());
        }
        let pivot = (0..row.len()).max_by(|a, b| row[*a].abs().total_cmp(&row[*b].abs()))?;
        done.push((row, factors, pivot));
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn relations_are_those_of_the_rows() {
        let rows = vec![
            vec![1.0, 2.0, 0.0],
            vec![0.0, 1.0, 1.0],
            vec![2.0, 5.0, 1.0],
        ];
        assert_eq!(relation(rows), Some(vec![-1.0, -0.5, 0.5]));
        assert_eq!(relation(vec![vec![1.0, 0.0], vec![1.0, 1e-3]]), None);
    }
}
