//! `let` and `const`: values, functions, families. Each may use the definitions above it.

use std::collections::{BTreeMap, BTreeSet};

use super::order;
use super::resolve::{Resolver, Scope, Value};
use super::symbols::Meaning;
use crate::diagnostics::Location;
use crate::spec::{self, Index, Scalar, Word};

/// Meaning of a name introduced by `let`.
#[derive(Debug)]
pub(super) enum Definition<'s> {
    /// One value.
    Value(Value),
    /// A function, written out where it is called.
    Function {
        /// The names of its arguments.
        arguments: &'s [Word],
        /// Its value.
        body: &'s Scalar,
    },
    /// The members that were defined so far.
    Family(BTreeMap<i64, Value>),
    /// An error was recorded for the definition. Its uses are not reported as further errors.
    Faulty,
}

impl<'s> Resolver<'s> {
    /// Makes a name known, unless it is taken.
    pub(super) fn declare(&mut self, name: &Word, meaning: Meaning) -> bool {
        if let Some((_, first)) = self.symbols.names.get(&name.text) {
            let first = *first;
            let error = self
                .diagnostics
                .error(name.at, format!("`{}` declared again", name.text));
            error
                .help("choose another name")
                .also(first, format!("`{}` first declared here", name.text));
            return false;
        }
        self.symbols
            .names
            .insert(name.text.clone(), (meaning, name.at));
        true
    }

    /// Resolves all `const` declarations.
    pub(super) fn constants(&mut self) {
        for constant in &self.spec.constants {
            let help = "a `const` is a size or an index; write a number as `let` or as a parameter";
            let value = self.integer_or(&constant.value, &mut Scope::default(), help);
            // A faulty constant stays known, so that its uses are not reported as unknown names.
            self.declare(&constant.name, Meaning::Constant(value.unwrap_or(1)));
        }
    }

    /// Resolves all `let` declarations, in order.
    pub(super) fn all_definitions(&mut self) {
        let spec = self.spec;
        let faulty = self.declare_definitions(spec);
        for (position, definition) in spec.definitions.iter().enumerate() {
            let name = definition.declared.name.text.as_str();
            if faulty.contains(&position) {
                self.definitions.entry(name).or_insert(Definition::Faulty);
            } else if let Some(arguments) = &definition.arguments {
                self.definitions.insert(
                    name,
                    Definition::Function {
                        arguments,
                        body: &definition.value,
                    },
                );
            } else {
                self.define(definition);
            }
        }
    }

    /// Makes the names of all definitions known. Returns the positions of definitions that cannot be resolved.
    fn declare_definitions(&mut self, spec: &'s spec::Spec) -> BTreeSet<usize> {
        let mut faulty = BTreeSet::new();
        let mut families: BTreeSet<&str> = BTreeSet::new();
        for (position, definition) in spec.definitions.iter().enumerate() {
            let name = &definition.declared.name;
            let is_family = definition.declared.index.is_some();
            if is_family && definition.arguments.is_some() {
                self.refuse::<()>(
                    name.at,
                    "a function has no index",
                    "give the index as an argument",
                );
                faulty.insert(position);
            } else if is_family && families.contains(name.text.as_str()) {
                continue;
            } else if !self.declare(name, Meaning::Definition) {
                faulty.insert(position);
            } else if is_family {
                families.insert(&name.text);
            }
        }
        faulty.extend(order::check(self, spec));
        faulty
    }

    fn define(&mut self, definition: &'s spec::Definition) {
        let name = definition.declared.name.text.as_str();
        match &definition.declared.index {
            None => {
                let value = self.resolve(&definition.value, &mut Scope::default());
                self.definitions
                    .insert(name, value.map_or(Definition::Faulty, Definition::Value));
            }
            Some(index) => {
                self.definitions
                    .entry(name)
                    .or_insert_with(|| Definition::Family(BTreeMap::new()));
                self.define_members(definition, index);
            }
        }
    }

    fn define_members(&mut self, definition: &'s spec::Definition, index: &Index) {
        let mut scope = Scope::default();
        match index {
            Index::One(member) => {
                let Some(member) = self.integer(member, &mut scope) else {
                    return self.poison(&definition.declared.name);
                };
                self.define_member(definition, member, &mut scope);
            }
            Index::Each(binder) => {
                let Some(range) = self.range(binder, &mut scope) else {
                    return self.poison(&definition.declared.name);
                };
                for member in range {
                    let value = self.pool.int(member);
                    scope.bind(&binder.name.text, value.into());
                    self.define_member(definition, member, &mut scope);
                    scope.unbind();
                }
            }
        }
    }

    fn define_member(&mut self, definition: &'s spec::Definition, member: i64, scope: &mut Scope) {
        let name = &definition.declared.name;
        let Some(value) = self.resolve(&definition.value, scope) else {
            return self.poison(name);
        };
        let Some(Definition::Family(members)) = self.definitions.get_mut(name.text.as_str()) else {
            return;
        };
        if members.insert(member, value).is_some() {
            self.refuse::<()>(
                name.at,
                format!("`{}[{member}]` declared again", name.text),
                "",
            );
        }
    }

    /// Marks a family with a faulty member, so that its uses are not reported as further errors.
    fn poison(&mut self, name: &'s Word) {
        self.definitions.insert(&name.text, Definition::Faulty);
    }

    /// The value of a definition that is used without arguments or an index.
    pub(super) fn definition(&mut self, name: &str, at: Location) -> Option<Value> {
        match self.definitions.get(name) {
            Some(Definition::Value(value)) => Some(*value),
            Some(Definition::Function { arguments, .. }) => {
                let names: Vec<&str> = arguments
                    .iter()
                    .map(|argument| argument.text.as_str())
                    .collect();
                let help = format!("write `{name}({})`", names.join(", "));
                self.refuse(at, format!("`{name}` is a function"), &help)
            }
            Some(Definition::Family(members)) => {
                let first = members.keys().next().copied().unwrap_or(1);
                self.refuse(
                    at,
                    format!("`{name}` is a family"),
                    &format!("write `{name}[{first}]`"),
                )
            }
            Some(Definition::Faulty) | None => None,
        }
    }

    /// A member of a family of definitions.
    pub(super) fn defined_member(
        &mut self,
        name: &Word,
        index: &Scalar,
        member: i64,
    ) -> Option<Value> {
        match self.definitions.get(name.text.as_str()) {
            Some(Definition::Family(members)) => {
                let value = members.get(&member).copied();
                let known: Vec<String> = members
                    .keys()
                    .take(9)
                    .map(|member| member.to_string())
                    .collect();
                value.or_else(|| {
                    let text = format!("`{}[{member}]` is not defined above", name.text);
                    let help = if known.is_empty() {
                        format!("begin with `let {}[{member}] = ..;`", name.text)
                    } else {
                        format!("members defined so far: {}", known.join(", "))
                    };
                    self.refuse(index.at, text, &help)
                })
            }
            Some(Definition::Faulty) | None => None,
            Some(_) => {
                let text = format!("`{}` is not a family", name.text);
                self.refuse(name.at, text, &format!("write `{}`", name.text))
            }
        }
    }
}
