//! Remarks on differences whose terms nearly agree somewhere, and that have a form without cancellation.
//!
//! The check finds `p f(e) - p` with `f(0) = 1`, for the functions in [`safe`], and `sqrt(p^2 + e) - p`. Near `e = 0`
//! the leading digits of the terms cancel, and the rest is rounding.

use std::collections::BTreeMap;

use dalembert_expr::{ExprId, Function, Node, Pool, Rational, Sign};

use super::super::resolve::Resolver;
use super::super::{Constraint, Lagrangian};
use super::Parts;

/// A difference, the expression at whose zeros it loses digits, and the form that keeps them.
struct Cancellation {
    difference: ExprId,
    argument: ExprId,
    safe: ExprId,
}

/// Factors of a product with their exponents.
type Powers = Vec<(ExprId, Rational)>;

/// Difference that may cancel in a sum.
enum Candidate {
    /// `p f(e) - p`
    Call(Function, ExprId),
    /// `root - p`, with `p` the product of a number and a summand; `None` for the summand 1.
    Root {
        root: ExprId,
        radicand: ExprId,
        p: (Rational, Option<ExprId>),
    },
}

/// Notes on the Lagrangian, constraints, forces, gaps and outputs; one for each difference.
pub(super) fn notes(
    resolver: &Resolver<'_>,
    lagrangian: &Lagrangian,
    parts: &Parts,
) -> Vec<String> {
    let mut found = Vec::new();
    for (place, roots) in places(lagrangian, parts) {
        for id in resolver.pool.reachable(&roots) {
            let candidates = candidates(&resolver.pool, id).into_iter();
            found.extend(candidates.map(|candidate| (place, candidate)));
        }
    }
    if found.is_empty() {
        return Vec::new();
    }
    // The other forms are built in a copy: a remark adds nothing to the model.
    let mut pool = resolver.pool.clone();
    let moving = resolver.symbols.moving();
    let mut notes = BTreeMap::new();
    for (place, candidate) in found {
        let Some(cancelled) = cancellation(&mut pool, &candidate) else {
            continue;
        };
        let never = matches!(
            pool.sign(cancelled.argument),
            Sign::Positive | Sign::Negative
        );
        if never || !pool.depends_on_any(cancelled.argument, &moving) {
            continue;
        }
        let [text, zero, safe] =
            [cancelled.difference, cancelled.argument, cancelled.safe].map(|id| pool.text(id));
        notes.entry(cancelled.difference).or_insert_with(|| {
            format!("`{text}` in `{place}` loses its digits near `{zero} = 0`: write `{safe}`")
        });
    }
    if pool.is_exhausted() {
        return Vec::new();
    }
    notes.into_values().collect()
}

/// Declared expressions, by name.
fn places<'a>(
    lagrangian: &Lagrangian,
    parts: &'a Parts,
) -> impl Iterator<Item = (&'a str, Vec<ExprId>)> {
    let form = |constraint: &Constraint| {
        let affine = [constraint.affine];
        constraint.form.iter().copied().chain(affine).collect()
    };
    let constraints = parts.constraints.iter();
    let forces = parts.forces.iter();
    let surfaces = parts.surfaces.iter();
    let outputs = parts.outputs.iter();
    [("lagrangian", vec![lagrangian.whole])]
        .into_iter()
        .chain(
            constraints.map(move |constraint| (constraint.name.display.as_str(), form(constraint))),
        )
        .chain(forces.map(|force| (force.name.display.as_str(), force.form.clone())))
        .chain(surfaces.map(|surface| (surface.name.display.as_str(), vec![surface.gap])))
        .chain(outputs.map(|output| (output.name.display.as_str(), vec![output.value])))
}

/// Candidates among the summands of an expression.
fn candidates(pool: &Pool, id: ExprId) -> Vec<Candidate> {
    if !matches!(pool.node(id), Node::Sum { .. }) {
        return Vec::new();
    }
    let (constant, terms) = pool.linear_form(id);
    let powers: Vec<Powers> = terms.iter().map(|(_, term)| powers(pool, *term)).collect();
    let of_terms = powers.iter().cloned().zip(&terms);
    let summands: BTreeMap<Powers, (Option<ExprId>, &Rational)> = of_terms
        .map(|(powers, (coefficient, term))| (powers, (Some(*term), coefficient)))
        .chain([(Powers::new(), (None, &constant))])
        .collect();
    let mut found = Vec::new();
    for ((coefficient, term), powers) in terms.iter().zip(&powers) {
        let cancels = |other: &Rational| *other == -coefficient.clone();
        for (index, (base, exponent)) in powers.iter().enumerate() {
            if let Node::Call(function, argument) = pool.node(*base)
                && is_one_at_zero(*function)
                && exponent.is_one()
            {
                let mut others = powers.clone();
                others.remove(index);
                if summands
                    .get(&others)
                    .is_some_and(|(_, other)| cancels(other))
                {
                    found.push(Candidate::Call(*function, *argument));
                }
            }
        }
        if let [(radicand, exponent)] = powers.as_slice()
            && *exponent == Rational::new(1, 2)
        {
            let shares = summands.values().filter_map(|(other, subtracted)| {
                Some((*other, subtracted.checked_div(&-coefficient.clone())?))
            });
            let root = |(other, share)| Candidate::Root {
                root: *term,
                radicand: *radicand,
                p: (share, other),
            };
            found.extend(shares.map(root));
        }
    }
    found
}

/// The factors of a term, with their exponents.
fn powers(pool: &Pool, term: ExprId) -> Powers {
    match pool.node(term) {
        Node::Product(powers) => powers.to_vec(),
        _ => vec![(term, Rational::from(1))],
    }
}

/// True if the function is 1 where its argument is 0, and its difference from 1 has a form without cancellation.
fn is_one_at_zero(function: Function) -> bool {
    matches!(function, Function::Cos | Function::Cosh | Function::Exp)
}

/// The form of a candidate that keeps its digits, if there is one.
fn cancellation(pool: &mut Pool, candidate: &Candidate) -> Option<Cancellation> {
    match candidate {
        Candidate::Call(function, argument) => safe(pool, *function, *argument),
        Candidate::Root {
            root,
            radicand,
            p: (share, other),
        } => {
            let other = other.unwrap_or_else(|| pool.one());
            let p = pool.scale(share, other);
            root_less(pool, *root, *radicand, p)
        }
    }
}

/// The form without cancellation of the difference of 1 and a function with `f(0) = 1`.
fn safe(pool: &mut Pool, function: Function, argument: ExprId) -> Option<Cancellation> {
    let half = pool.scale(&Rational::new(1, 2), argument);
    let (factors, sign) = match function {
        Function::Cos => ([Function::Sin, Function::Sin], -1),
        Function::Cosh => ([Function::Sinh, Function::Sinh], 1),
        Function::Exp => ([Function::Exp, Function::Sinh], 1),
        _ => return None,
    };
    let [one, call] = [pool.one(), pool.call(function, argument)];
    let difference = pool.combine(&[(Rational::from(sign), call), (Rational::from(-sign), one)]);
    let factors = factors.map(|factor| pool.call(factor, half));
    let product = pool.product(&factors);
    Some(Cancellation {
        difference,
        argument,
        safe: pool.scale(&Rational::from(2), product),
    })
}

/// `sqrt(p^2 + e) - p = e/(sqrt(p^2 + e) + p)` for a positive `p`.
fn root_less(pool: &mut Pool, root: ExprId, radicand: ExprId, p: ExprId) -> Option<Cancellation> {
    if pool.sign(p) != Sign::Positive {
        return None;
    }
    let square = pool.mul(p, p);
    let argument = pool.sub(radicand, square);
    if summands(pool, argument) >= summands(pool, radicand) {
        return None;
    }
    let sum = pool.add(root, p);
    Some(Cancellation {
        difference: pool.sub(root, p),
        argument,
        safe: pool.div(argument, sum),
    })
}

/// Number of terms of a sum.
fn summands(pool: &Pool, id: ExprId) -> usize {
    let (constant, terms) = pool.linear_form(id);
    terms.len() + usize::from(constant != Rational::from(0))
}
