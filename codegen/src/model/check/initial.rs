//! The declared initial condition.

use dalembert_expr::ExprId;

use super::super::resolve::{Resolver, Scope};
use super::super::{Initial, Topology};
use super::targets::Section;
use crate::diagnostics::Location;
use crate::spec::{Declared, InitialTarget, InitialValue, Scalar};

/// Resolves all initial values, by coordinate.
pub(super) fn resolve(resolver: &mut Resolver<'_>) -> Initial {
    let spec = resolver.spec;
    let count = resolver.symbols.coordinates.len();
    let mut initial = Initial {
        q: vec![None; count],
        qdot: vec![None; count],
        until: None,
    };
    let mut given: Vec<(InitialTarget, usize, Location)> = Vec::new();
    for entry in &spec.initial {
        for (index, scope) in resolver.initial_targets(entry) {
            resolver.given_once(&mut given, entry, index);
            let Some(value) = resolver.initial_value(entry, index, scope) else {
                break;
            };
            match entry.target {
                InitialTarget::Position => initial.q[index] = Some(value),
                InitialTarget::Velocity => initial.qdot[index] = Some(value),
                InitialTarget::Until => initial.until = Some(value),
            }
        }
    }
    initial
}

/// Notes on coordinates whose default 0 lies outside of their interval.
pub(super) fn notes(resolver: &Resolver<'_>, initial: &Initial) -> Vec<String> {
    let coordinates = resolver.symbols.coordinates.iter().zip(&initial.q);
    let outside = coordinates.filter(|(coordinate, value)| {
        value.is_none() && !resolver.is_in_chart(coordinate.topology, resolver.pool.zero())
    });
    outside
        .map(|(coordinate, _)| {
            let name = &coordinate.name.display;
            format!("`{name}` starts at 0, outside of its interval, unless `initial` names it")
        })
        .collect()
}

fn target_text(entry: &InitialValue) -> String {
    let Declared { name, index } = &entry.declared;
    let name = index
        .as_ref()
        .map_or(name.text.clone(), |index| format!("{}{index}", name.text));
    if entry.target == InitialTarget::Velocity {
        format!("dot({name})")
    } else {
        name
    }
}

impl Resolver<'_> {
    /// The coordinates of an entry, each with the value of its index in scope. For `until`, one target whose index is
    /// not used.
    fn initial_targets(&mut self, entry: &InitialValue) -> Vec<(usize, Scope)> {
        match entry.target {
            InitialTarget::Until => vec![(0, Scope::default())],
            _ => self.targets(&entry.declared, &Scope::default(), Section::Initial),
        }
    }

    /// Rejects a second value for the same quantity.
    fn given_once(
        &mut self,
        given: &mut Vec<(InitialTarget, usize, Location)>,
        entry: &InitialValue,
        index: usize,
    ) {
        let at = entry.declared.name.at;
        let first = given
            .iter()
            .find(|(target, other, _)| (*target, *other) == (entry.target, index));
        if let Some((_, _, first)) = first {
            let text = format!("initial value of `{}` given again", target_text(entry));
            let error = self.diagnostics.error(at, text);
            error
                .help("keep one of them")
                .also(*first, "first given here");
        }
        given.push((entry.target, index, at));
    }

    fn initial_value(
        &mut self,
        entry: &InitialValue,
        index: usize,
        mut scope: Scope,
    ) -> Option<ExprId> {
        let written = &entry.value;
        let value = self.parameter_expression(written, &mut scope, "an initial value")?;
        if entry.target == InitialTarget::Until && self.pool.sign(value).is_nonpositive() {
            let text = format!("a run until {written} is empty");
            return self.refuse(written.at, text, "`until` is positive");
        }
        if entry.target == InitialTarget::Position {
            self.check_in_chart(written, index, value)?;
        }
        Some(value)
    }

    /// Rejects a constant value outside of the interval of its coordinate.
    pub(super) fn check_in_chart(
        &mut self,
        written: &Scalar,
        index: usize,
        value: ExprId,
    ) -> Option<()> {
        let coordinate = &self.symbols.coordinates[index];
        if self.is_in_chart(coordinate.topology, value) {
            return Some(());
        }
        let name = &coordinate.name.display;
        let text = format!("`{written}` lies outside of the interval of `{name}`");
        self.refuse(
            written.at,
            text,
            "a chart is open: its ends do not belong to it",
        )
    }

    /// True if a value may lie in the interval of a coordinate. Always true for values that depend on parameters.
    fn is_in_chart(&self, topology: Topology, value: ExprId) -> bool {
        let Topology::Interval { low, high } = topology else {
            return true;
        };
        let value = self.constant_value(value);
        value.is_nan() || (self.constant_value(low) < value && value < self.constant_value(high))
    }
}
