//! Order of definitions: a definition may use only earlier ones. Finds cycles, uses before the definition, and unknown
//! names in function definitions.

use std::collections::{BTreeMap, BTreeSet};

use super::resolve::{Resolver, Scope};
use crate::diagnostics::Location;
use crate::spec::{Definition, Index, Scalar, ScalarKind, Spec};

/// A name used in the value of a definition.
struct Use<'s> {
    name: &'s str,
    at: Location,
    is_call: bool,
}

/// Reports every use of a definition that is not declared above. Returns the positions of the definitions with such
/// uses.
pub(super) fn check<'s>(resolver: &mut Resolver<'s>, spec: &'s Spec) -> BTreeSet<usize> {
    let mut first: BTreeMap<&str, usize> = BTreeMap::new();
    for (position, definition) in spec.definitions.iter().enumerate() {
        first
            .entry(&definition.declared.name.text)
            .or_insert(position);
    }
    let uses: Vec<Vec<Use<'s>>> = spec.definitions.iter().map(uses).collect();
    let mut faulty = BTreeSet::new();
    for (position, definition) in spec.definitions.iter().enumerate() {
        check_known(resolver, definition, &uses[position]);
        let own_family = definition
            .declared
            .index
            .is_some()
            .then_some(definition.declared.name.text.as_str());
        for used in &uses[position] {
            let Some(target) = first.get(used.name).copied() else {
                continue;
            };
            if target < position || own_family == Some(used.name) {
                continue;
            }
            refuse_use(resolver, spec, &uses, &first, position, used);
            faulty.insert(position);
        }
    }
    faulty
}

/// Refuses the use of a later definition, or of the definition itself.
fn refuse_use(
    resolver: &mut Resolver<'_>,
    spec: &Spec,
    uses: &[Vec<Use<'_>>],
    first: &BTreeMap<&str, usize>,
    position: usize,
    used: &Use<'_>,
) {
    let start = spec.definitions[position].declared.name.text.as_str();
    let target = first.get(used.name).copied().unwrap_or(position);
    match path(uses, first, target, position) {
        Some(between) => {
            let names: Vec<&str> = between
                .iter()
                .map(|step| spec.definitions[*step].declared.name.text.as_str())
                .collect();
            let text = format!(
                "defined in terms of itself: {start} -> {}",
                names.join(" -> ")
            );
            resolver.refuse::<()>(used.at, text, "a definition uses only what stands above it");
        }
        None => {
            let help = format!("move `let {}` above `let {start}`", used.name);
            resolver.refuse::<()>(
                used.at,
                format!("`{}` is used before it is defined", used.name),
                &help,
            );
        }
    }
}

/// The chain of definitions from `from` to `to`, both included; `None` if `from` does not use `to`.
fn path(
    uses: &[Vec<Use<'_>>],
    first: &BTreeMap<&str, usize>,
    from: usize,
    to: usize,
) -> Option<Vec<usize>> {
    let mut reached_from: BTreeMap<usize, usize> = BTreeMap::new();
    let mut pending = vec![from];
    while let Some(step) = pending.pop() {
        if step == to {
            let mut way = vec![to];
            let mut current = to;
            while current != from {
                current = *reached_from.get(&current)?;
                way.push(current);
            }
            way.reverse();
            return Some(way);
        }
        for used in &uses[step] {
            let Some(next) = first.get(used.name).copied() else {
                continue;
            };
            if next != from && !reached_from.contains_key(&next) {
                reached_from.insert(next, step);
                pending.push(next);
            }
        }
    }
    None
}

/// Checks the names in a function definition. Its value is resolved at calls only, so this finds errors without a call.
fn check_known(resolver: &mut Resolver<'_>, definition: &Definition, uses: &[Use<'_>]) {
    if definition.arguments.is_none() {
        return;
    }
    for used in uses.iter().filter(|used| !used.is_call) {
        let built_in = matches!(used.name, "t" | "pi" | "energy");
        if !built_in && !resolver.symbols.names.contains_key(used.name) {
            resolver.unknown_name(used.name, used.at, &Scope::default());
        }
    }
}

/// The names in the value of a definition, without its arguments and indices.
fn uses(definition: &Definition) -> Vec<Use<'_>> {
    let mut bound: Vec<&str> = Vec::new();
    if let Some(arguments) = &definition.arguments {
        bound.extend(arguments.iter().map(|argument| argument.text.as_str()));
    }
    if let Some(Index::Each(binder)) = &definition.declared.index {
        bound.push(&binder.name.text);
    }
    let mut uses = Vec::new();
    collect(&definition.value, &mut bound, &mut uses);
    uses
}

fn collect<'s>(scalar: &'s Scalar, bound: &mut Vec<&'s str>, uses: &mut Vec<Use<'s>>) {
    let mut record = |name: &'s str, at, is_call| {
        if !bound.contains(&name) {
            uses.push(Use { name, at, is_call });
        }
    };
    match &scalar.kind {
        ScalarKind::Number(..) => {}
        ScalarKind::Name(name) => record(name, scalar.at, false),
        ScalarKind::Member(name, index) => {
            record(&name.text, name.at, false);
            collect(index, bound, uses);
        }
        ScalarKind::Negative(inner) => collect(inner, bound, uses),
        ScalarKind::Sum(terms) => terms
            .iter()
            .for_each(|(_, term)| collect(term, bound, uses)),
        ScalarKind::Product(factors) => factors
            .iter()
            .for_each(|(_, factor)| collect(factor, bound, uses)),
        ScalarKind::Power(base, exponent) => {
            collect(base, bound, uses);
            collect(exponent, bound, uses);
        }
        ScalarKind::Call(function, arguments) => {
            record(&function.text, function.at, true);
            // The argument of `multiplier` is the name of a constraint.
            if function.text != "multiplier" {
                arguments
                    .iter()
                    .for_each(|argument| collect(argument, bound, uses));
            }
        }
        ScalarKind::SumOver(binder, body) => {
            collect(&binder.low, bound, uses);
            collect(&binder.high, bound, uses);
            bound.push(&binder.name.text);
            collect(body, bound, uses);
            bound.pop();
        }
    }
}
