//! Targets of an assignment: `theta = ..`, `dot(theta[2]) = ..`, `theta[i in 1..=N] = ..`.

use super::super::resolve::{Resolver, Scope};
use super::super::symbols::Meaning;
use crate::diagnostics::{Location, nearest};
use crate::spec::{Declared, Index, Word};

/// Section that assigns values.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Section {
    /// `initial`.
    Initial,
    /// A law `reset`.
    Reset,
    /// `field`.
    Field,
}

impl Resolver<'_> {
    /// The coordinates that a declared name denotes: their indices, each with the scope in which the assigned value is
    /// resolved.
    pub(super) fn targets(
        &mut self,
        declared: &Declared,
        scope: &Scope,
        section: Section,
    ) -> Vec<(usize, Scope)> {
        let name = &declared.name;
        match self
            .symbols
            .names
            .get(&name.text)
            .map(|(meaning, _)| *meaning)
        {
            Some(Meaning::Coordinate(index)) => match &declared.index {
                None => vec![(index, scope.clone())],
                Some(_) => self.no_target(
                    name.at,
                    format!("`{}` is not a family", name.text),
                    format!("write `{}`", name.text),
                ),
            },
            Some(Meaning::Coordinates(first, size)) => {
                self.family_targets(declared, scope, first, size)
            }
            Some(meaning) => {
                let text = format!("`{}` is a {}, not a coordinate", name.text, meaning.noun());
                let help = match section {
                    Section::Initial => "parameters take their values from `parameters`",
                    Section::Reset => "an impact changes coordinates and velocities only",
                    Section::Field => "parameters do not change along a motion",
                };
                self.no_target(name.at, text, help.to_owned())
            }
            None => self.unknown_target(name, section),
        }
    }

    fn family_targets(
        &mut self,
        declared: &Declared,
        scope: &Scope,
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
                let member = self.integer(index, &mut scope.clone());
                let offset = member.and_then(|member| self.offset(name, index, member, size));
                offset
                    .map(|offset| (first + offset, scope.clone()))
                    .into_iter()
                    .collect()
            }
            Some(Index::Each(binder)) => {
                let mut targets = Vec::new();
                for member in self.range(binder, &mut scope.clone()).into_iter().flatten() {
                    let Some(offset) = self.offset(name, &binder.high, member, size) else {
                        break;
                    };
                    let value = self.pool.int(member);
                    let mut scope = scope.clone();
                    scope.bind(&binder.name.text, value.into());
                    targets.push((first + offset, scope));
                }
                targets
            }
        }
    }

    fn unknown_target(&mut self, name: &Word, section: Section) -> Vec<(usize, Scope)> {
        let fields = self
            .symbols
            .coordinates
            .iter()
            .map(|coordinate| coordinate.name.field.as_str());
        let until = (section == Section::Initial).then_some("until");
        let help = if let Some(help) = self.velocity_help(&name.text) {
            help
        } else if let Some(help) = self.member_help(&name.text) {
            help
        } else if let Some(near) = nearest(&name.text, fields.chain(until)) {
            format!("did you mean `{near}`?")
        } else {
            section.help(&name.text).to_owned()
        };
        self.no_target(name.at, format!("unknown coordinate `{}`", name.text), help)
    }

    fn no_target(&mut self, at: Location, text: String, help: String) -> Vec<(usize, Scope)> {
        self.refuse::<()>(at, text, &help);
        Vec::new()
    }
}

impl Section {
    /// Advice on a name that is unknown everywhere.
    fn help(self, name: &str) -> &'static str {
        match (self, name) {
            (Self::Initial, "t") => "a run starts at time 0",
            (Self::Initial, "T" | "t_end" | "tend" | "t_max" | "tmax" | "end" | "duration") => {
                "the end of a run is written `until = 10;`"
            }
            (Self::Initial, _) => {
                "initial values are given for coordinates, `dot(..)` of coordinates, and `until`"
            }
            (Self::Reset, "t") => "an impact takes no time",
            (Self::Field, "t") => "time runs by itself",
            (Self::Field, _) => "rates are given for coordinates: `dot(x) = ..;`",
            (Self::Reset, _) => {
                "a reset sets coordinates and their velocities: `x = ..;`, `dot(x) = ..;`"
            }
        }
    }
}
