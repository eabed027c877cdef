//! Checks of the names of a section: each is declared once, and families have no gaps, so that an index finds a member.

use super::super::Name;
use super::super::resolve::{Resolver, Scope};
use super::super::symbols::member_name;
use crate::diagnostics::Location;
use crate::spec::{Declared, Index, Scalar, Word};

/// The names of a section in the order in which they are read.
pub(super) struct Names {
    noun: &'static str,
    met: Vec<(Name, Location)>,
    /// Number of errors before the section.
    errors: usize,
}

impl Names {
    /// Names of a section whose entries are called `noun`.
    pub(super) fn new(resolver: &Resolver<'_>, noun: &'static str) -> Self {
        Self {
            noun,
            met: Vec::new(),
            errors: resolver.diagnostics.len(),
        }
    }

    /// Adds a name. Reports an error if the name is taken.
    pub(super) fn add(&mut self, resolver: &mut Resolver<'_>, name: &Name, written: &Word) {
        let first = self.met.iter().find(|(first, _)| {
            let both_alone_and_family = first.member.is_some() != name.member.is_some();
            first.field == name.field && (both_alone_and_family || first.member == name.member)
        });
        let Some((first, at)) = first else {
            self.met.push((name.clone(), written.at));
            return;
        };
        let text = if first.member == name.member {
            format!("{} `{}` declared again", self.noun, name.display)
        } else {
            format!(
                "{} `{}` declared alone and as a family",
                self.noun, name.field
            )
        };
        let error = resolver.diagnostics.error(written.at, text);
        error
            .help("choose another name")
            .also(*at, format!("`{}` first declared here", first.display));
    }

    /// Refuses families in which a member before the last is missing. Members may stand in any order, with other
    /// entries between them.
    pub(super) fn check_families(&self, resolver: &mut Resolver<'_>) {
        // An entry that was refused may be the one that is missing.
        if resolver.diagnostics.len() > self.errors {
            return;
        }
        for (name, at) in &self.met {
            let Some(member) = name.member.filter(|member| *member > 1) else {
                continue;
            };
            let before = (name.field.as_str(), Some(member - 1));
            let is_there =
                |(other, _): &(Name, Location)| (other.field.as_str(), other.member) == before;
            if self.met.iter().any(is_there) {
                continue;
            }
            let text = format!(
                "{} `{}[{}]` is not declared",
                self.noun,
                name.field,
                member - 1
            );
            let help = format!(
                "the members of `{}` are counted from 1 without a gap",
                name.field
            );
            resolver.refuse::<()>(*at, text, &help);
        }
    }
}

impl Resolver<'_> {
    /// Refuses a coordinate, a parameter or an input with the name that the velocity or the momentum of a coordinate has
    /// in tables and flags.
    pub(super) fn check_columns(&mut self) {
        let coordinates = &self.symbols.coordinates;
        let is_first_order = self.spec.field.is_some();
        let meaning = |name: &str| {
            coordinates.iter().find_map(|coordinate| {
                let of = coordinate.name.display.as_str();
                if coordinate.name.velocity() == name {
                    Some(format!("the velocity of `{of}`"))
                } else if !is_first_order && coordinate.name.momentum() == name {
                    Some(format!("the momentum of `{of}`"))
                } else {
                    None
                }
            })
        };
        let named = coordinates.iter().map(|it| (&it.name.display, it.item));
        let parameters = self.symbols.parameters.iter();
        let mut named = named.chain(parameters.map(|it| (&it.name.display, it.item)));
        let taken = named.find_map(|(name, item)| {
            let text = format!(
                "`{name}` is the name of {} in tables and flags",
                meaning(name)?
            );
            Some((item, text))
        });
        if let Some((item, text)) = taken {
            let at = self.spec.location(item);
            self.refuse::<()>(at, text, "choose another name");
        }
    }

    /// The members of a declaration, each with a scope that holds the value of its index.
    pub(in crate::model) fn members(&mut self, declared: &Declared) -> Vec<(Name, Scope)> {
        self.members_within(declared, &Scope::default())
    }

    /// Same as [`Resolver::members`], inside a declaration whose index has its value in `outer`.
    pub(super) fn members_within(
        &mut self,
        declared: &Declared,
        outer: &Scope,
    ) -> Vec<(Name, Scope)> {
        let field = &declared.name.text;
        let mut scope = outer.clone();
        match &declared.index {
            None => vec![(member_name(field, None), scope)],
            Some(Index::One(index)) => {
                let member = self
                    .integer(index, &mut scope)
                    .and_then(|member| self.member_index(index, member));
                member
                    .map(|member| (member_name(field, Some(member)), scope))
                    .into_iter()
                    .collect()
            }
            Some(Index::Each(binder)) => {
                let mut members = Vec::new();
                for member in self.range(binder, &mut scope).into_iter().flatten() {
                    let Some(index) = self.member_index(&binder.low, member) else {
                        break;
                    };
                    let value = self.pool.int(member);
                    let mut scope = outer.clone();
                    scope.bind(&binder.name.text, value.into());
                    members.push((member_name(field, Some(index)), scope));
                }
                members
            }
        }
    }

    fn member_index(&mut self, written: &Scalar, member: i64) -> Option<usize> {
        match usize::try_from(member) {
            Ok(index) if index > 0 => Some(index),
            _ => self.refuse(
                written.at,
                format!("members are counted from 1, found {member}"),
                "write `[i in 1..=N]`",
            ),
        }
    }
}
