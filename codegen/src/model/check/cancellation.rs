//! Remarks on differences whose terms nearly agree somewhere, and that have another form in which they do not.
//!
//! Looked for are `p f(e) - p` with `f(0) = 1`, for the functions in [`safe`], and `sqrt(p^2 + e) - p`: near `e = 0` the
//! terms agree in their first digits, and what is left of them is rounding.

use std::collections::BTreeMap;

use dalembert_expr::{ExprId, Function, Node, Pool, Rational, Sign, SymbolId};

use super::super::resolve::Resolver;
use super::super::{Constraint, Lagrangian};
use super::Parts;

/// A difference, what is 0 where it loses its digits, and the form that keeps them.
struct Cancellation {
    difference: ExprId,
    argument: ExprId,
    safe: ExprId,
}

/// Remarks on everything that is evaluated along a run; each difference once.
pub(super) fn notes(
    resolver: &Resolver<'_>,
    lagrangian: &Lagrangian,
    parts: &Parts,
) -> Vec<String> {
    // The other forms are made in a copy: a remark adds nothing to the model.
    let mut pool = resolver.pool.clone();
    let moving = resolver.symbols.moving();
    let mut notes = BTreeMap::new();
    for (place, roots) in places(lagrangian, parts) {
        for id in pool.reachable(&roots) {
            for Cancellation {
                difference,
                argument,
                safe,
            } in cancellations(&mut pool, id, &moving)
            {
                let [text, zero, safe] = [difference, argument, safe].map(|id| pool.text(id));
                notes.entry(difference).or_insert_with(|| {
                    format!(
                        "`{text}` in `{place}` loses its digits near `{zero} = 0`: write `{safe}`"
                    )
                });
            }
        }
    }
    if pool.is_exhausted() {
        return Vec::new();
    }
    notes.into_values().collect()
}

/// What was declared, by name.
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
        .chain(constraints.map(move |own| (own.name.display.as_str(), form(own))))
        .chain(forces.map(|own| (own.name.display.as_str(), own.form.clone())))
        .chain(surfaces.map(|own| (own.name.display.as_str(), vec![own.gap])))
        .chain(outputs.map(|own| (own.name.display.as_str(), vec![own.value])))
}

/// Those among the summands of an expression.
fn cancellations(pool: &mut Pool, id: ExprId, moving: &[SymbolId]) -> Vec<Cancellation> {
    if !matches!(pool.node(id), Node::Sum { .. }) {
        return Vec::new();
    }
    let (constant, terms) = pool.linear_form(id);
    let one = pool.one();
    let mut summands: BTreeMap<ExprId, Rational> = terms
        .iter()
        .map(|(own, term)| (*term, own.clone()))
        .collect();
    summands.insert(one, constant);
    let mut found = Vec::new();
    for (own, term) in &terms {
        for (function, argument, others) in calls(pool, *term) {
            let cancels = summands
                .get(&others)
                .is_some_and(|other| *other == -own.clone());
            if cancels && let Some(form) = safe(pool, function, argument) {
                found.push(form);
            }
        }
        for (other, subtracted) in &summands {
            if let Some(share) = subtracted.checked_div(&-own.clone()) {
                let subtracted = pool.scale(&share, *other);
                found.extend(root_less(pool, *term, subtracted));
            }
        }
    }
    found.retain(|form| {
        let never = matches!(pool.sign(form.argument), Sign::Positive | Sign::Negative);
        !never && pool.depends_on_any(form.argument, moving)
    });
    found
}

/// The calls among the factors of a term, each with the product of the other factors.
fn calls(pool: &mut Pool, term: ExprId) -> Vec<(Function, ExprId, ExprId)> {
    let powers = match pool.node(term) {
        Node::Product(powers) => powers.to_vec(),
        _ => vec![(term, Rational::from(1))],
    };
    let mut calls = Vec::new();
    for (index, (base, exponent)) in powers.iter().enumerate() {
        if let Node::Call(function, argument) = *pool.node(*base)
            && *exponent == Rational::from(1)
        {
            let mut others = powers.clone();
            others.remove(index);
            calls.push((function, argument, pool.power_product(&others)));
        }
    }
    calls
}

/// The other form of the difference of 1 and a function that is 1 where its argument is 0.
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
fn root_less(pool: &mut Pool, root: ExprId, p: ExprId) -> Option<Cancellation> {
    let radicand = match pool.node(root) {
        Node::Product(powers) => match powers.as_ref() {
            [(radicand, exponent)] if *exponent == Rational::new(1, 2) => *radicand,
            _ => return None,
        },
        _ => return None,
    };
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

/// How many terms a sum has.
fn summands(pool: &Pool, id: ExprId) -> usize {
    let (constant, terms) = pool.linear_form(id);
    terms.len() + usize::from(constant != Rational::from(0))
}
