//! The declared initial condition.

use dalembert_expr::ExprId;

use super::super::Initial;
use super::super::resolve::{Resolver, Scope};
use super::super::symbols::Meaning;
use crate::diagnostics::{Location, nearest};
use crate::spec::{Declared, Index, InitialTarget, InitialValue, Scalar};

/// All initial values by coordinate.
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
        for (index, scope) in resolver.targets(entry) {
            let at = entry.declared.name.at;
            if given
                .iter()
                .any(|(target, other, _)| (*target, *other) == (entry.target, index))
            {
                resolver.refuse::<()>(
                    at,
                    format!("initial value of `{}` given again", target_text(entry)),
                    "keep one of them",
                );
            }
            given.push((entry.target, index, at));
            let Some(value) = resolver.initial_value(&entry.value, entry, scope) else {
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
    fn initial_value(
        &mut self,
        written: &Scalar,
        entry: &InitialValue,
        mut scope: Scope,
    ) -> Option<ExprId> {
        let value = self.parameter_expression(written, &mut scope, "an initial value")?;
        if entry.target == InitialTarget::Until && self.pool.sign(value).is_nonpositive() {
            return self.refuse(
                written.at,
                format!("a run until {written} is empty"),
                "`until` is positive",
            );
        }
        Some(value)
    }

    /// The coordinates that an entry is about, each with what its index stands for; one without meaning for `until`.
    fn targets(&mut self, entry: &InitialValue) -> Vec<(usize, Scope)> {
        if entry.target == InitialTarget::Until {
            return vec![(0, Scope::default())];
        }
        let name = &entry.declared.name;
        match self
            .symbols
            .names
            .get(&name.text)
            .map(|(meaning, _)| *meaning)
        {
            Some(Meaning::Coordinate(index)) => match &entry.declared.index {
                None => vec![(index, Scope::default())],
                Some(_) => self.no_target(
                    name.at,
                    format!("`{}` is not a family", name.text),
                    format!("write `{}`", name.text),
                ),
            },
            Some(Meaning::Coordinates(first, size)) => {
                self.family_targets(&entry.declared, first, size)
            }
            Some(meaning) => {
                let text = format!("`{}` is a {}, not a coordinate", name.text, meaning.noun());
                let help = "parameters take their values from `parameters`".to_owned();
                self.no_target(name.at, text, help)
            }
            None => self.unknown_target(entry),
        }
    }

    fn family_targets(
        &mut self,
        declared: &Declared,
        first: usize,
        size: usize,
    ) -> Vec<(usize, Scope)> {
        let name = &declared.name;
        match &declared.index {
            None => {
                let help = format!(
                    "write `{}[1]`, or `{}[i in 1..={size}]` for all",
                    name.text, name.text
                );
                self.no_target(
                    name.at,
                    format!("`{}` is a family of {size}", name.text),
                    help,
                )
            }
            Some(Index::One(index)) => {
                let member = self.integer(index, &mut Scope::default());
                let offset = member.and_then(|member| self.offset(name, index, member, size));
                offset
                    .map(|offset| (first + offset, Scope::default()))
                    .into_iter()
                    .collect()
            }
            Some(Index::Each(binder)) => {
                let mut targets = Vec::new();
                for member in self
                    .range(binder, &mut Scope::default())
                    .into_iter()
                    .flatten()
                {
                    let Some(offset) = self.offset(name, &binder.high, member, size) else {
                        break;
                    };
                    let value = self.pool.int(member);
                    let mut scope = Scope::default();
                    scope.bind(&binder.name.text, value.into());
                    targets.push((first + offset, scope));
                }
                targets
            }
        }
    }

    fn unknown_target(&mut self, entry: &InitialValue) -> Vec<(usize, Scope)> {
        let name = &entry.declared.name;
        let fields = self
            .symbols
            .coordinates
            .iter()
            .map(|coordinate| coordinate.name.field.as_str());
        let help = match nearest(&name.text, fields.chain(["until"])) {
            Some(near) => format!("did you mean `{near}`?"),
            None => {
                "initial values are given for coordinates, `dot(..)` of coordinates, and `until`"
                    .to_owned()
            }
        };
        self.no_target(name.at, format!("unknown coordinate `{}`", name.text), help)
    }

    fn no_target(&mut self, at: Location, text: String, help: String) -> Vec<(usize, Scope)> {
        self.refuse::<()>(at, text, &help);
        Vec::new()
    }
}
