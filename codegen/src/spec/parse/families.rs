//! Families of modes: `spoke[i in 1..=N] { .. }`, additions to one member, and names of members.

use proc_macro2::{Group, TokenTree};

use super::super::ast::{Declared, Index, Indices, Scalar, Spec, Word};
use super::super::cursor::{Cursor, Read, Refused, tokens_of};
use super::super::limits::SCENES;
use super::written_out::Bound;
use super::{declarations, index};
use crate::diagnostics::{Diagnostics, listed, nearest};

/// Declarations outside of `modes` that indices may depend on.
pub(super) struct Constants {
    shared: Spec,
    indices: Indices,
    /// True if the declarations were read without error. Otherwise errors in indices may be consequences, and are not
    /// reported.
    is_sound: bool,
}

/// A part of `modes`: `spoke[i in 1..=N] { .. }`
pub(super) struct Entry {
    pub(super) documentation: Vec<String>,
    pub(super) declared: Declared,
    pub(super) block: Group,
}

/// A mode with all declarations in its braces.
pub(super) struct Member {
    /// Name: `rough`, `spoke3`.
    pub(super) name: Word,
    /// Family, and index of the mode in it.
    family: Option<(String, usize)>,
    pub(super) documentation: Vec<String>,
    pub(super) inside: Vec<TokenTree>,
}

/// The modes, in the order of their first appearance.
pub(super) struct Members {
    pub(super) list: Vec<Member>,
    /// True if no mode is missing because of an error. Otherwise an unknown reference may be right.
    is_complete: bool,
}

impl Constants {
    pub(super) fn read(
        header: &Spec,
        shared: &[TokenTree],
        body: &Group,
        indices: Indices,
        diagnostics: &mut Diagnostics,
    ) -> Self {
        let mut spec = header.beginning();
        let mut mistakes = Diagnostics::new();
        declarations(shared, body, &mut spec, &mut mistakes);
        let is_sound = mistakes.is_empty();
        diagnostics.extend_once(mistakes);
        Self {
            shared: spec,
            indices,
            is_sound,
        }
    }

    /// Indices of the members that a name with an index denotes.
    pub(super) fn members(
        &self,
        declared: &Declared,
        diagnostics: &mut Diagnostics,
    ) -> Option<Vec<usize>> {
        let members = (self.indices.members)(&self.shared, declared);
        self.told(members, diagnostics)
    }

    fn value(&self, index: &Scalar, diagnostics: &mut Diagnostics) -> Option<i64> {
        let value = (self.indices.value)(&self.shared, index);
        self.told(value, diagnostics)
    }

    fn told<T>(&self, found: Result<T, Diagnostics>, diagnostics: &mut Diagnostics) -> Option<T> {
        match found {
            Ok(found) => Some(found),
            Err(others) => {
                if self.is_sound {
                    diagnostics.extend_once(others);
                }
                None
            }
        }
    }
}

/// The name of a member: `spoke3`.
pub(super) fn member_word(family: &Word, member: usize) -> Word {
    Word {
        text: format!("{}{member}", family.text),
        at: family.at,
    }
}

/// A member in the notation of declarations: `spoke[3]`.
fn written(family: &str, member: impl std::fmt::Display) -> String {
    format!("{family}[{member}]")
}

impl Member {
    /// Name in the notation of declarations.
    pub(super) fn written(&self) -> String {
        match &self.family {
            Some((family, member)) => written(family, member),
            None => self.name.text.clone(),
        }
    }
}

impl Members {
    /// Expands families into members.
    pub(super) fn of(
        entries: &[Entry],
        constants: &Constants,
        diagnostics: &mut Diagnostics,
    ) -> Self {
        let mut mistakes = Diagnostics::new();
        let mut members = Self {
            list: Vec::new(),
            is_complete: false,
        };
        for entry in entries {
            members.add_entry(entry, constants, &mut mistakes);
        }
        if mistakes.is_empty() {
            members.check_gaps(&mut mistakes);
        }
        members.is_complete = mistakes.is_empty() && constants.is_sound;
        diagnostics.extend(mistakes);
        members
    }

    fn add_entry(&mut self, entry: &Entry, constants: &Constants, diagnostics: &mut Diagnostics) {
        let name = &entry.declared.name;
        let inside = tokens_of(entry.block.stream());
        let Some(index) = &entry.declared.index else {
            self.add(entry, None, inside, diagnostics);
            return;
        };
        let Some(members) = constants.members(&entry.declared, diagnostics) else {
            return;
        };
        if let (Index::Each(binder), true) = (index, members.is_empty()) {
            let at = binder.low.at.to(binder.high.at);
            let error = diagnostics.error(at, format!("`{binder}` takes no value"));
            error.help("a family of modes has at least one member");
        }
        for member in members {
            let inside = match index {
                Index::One(_) => inside.clone(),
                Index::Each(binder) => {
                    Bound::new(name, binder, member).declarations(&inside, diagnostics)
                }
            };
            if !self.add(entry, Some(member), inside, diagnostics) {
                return;
            }
        }
    }

    /// Adds declarations to a mode, and the mode if it is new. False if the mode is refused.
    fn add(
        &mut self,
        entry: &Entry,
        member: Option<usize>,
        inside: Vec<TokenTree>,
        diagnostics: &mut Diagnostics,
    ) -> bool {
        let base = &entry.declared.name;
        let family = member.map(|member| (base.text.clone(), member));
        let name = member.map_or_else(|| base.clone(), |member| member_word(base, member));
        let same = |member: &&mut Member| family.is_some() && member.family == family;
        if let Some(known) = self.list.iter_mut().find(same) {
            known
                .documentation
                .extend(entry.documentation.iter().cloned());
            known.inside.extend(inside);
            return true;
        }
        if self.is_taken(base, &name, member, diagnostics) {
            return false;
        }
        if self.list.len() == SCENES {
            let text = format!("more than {SCENES} modes");
            diagnostics.error_once(base.at, text, "split the model");
            return false;
        }
        self.list.push(Member {
            name,
            family,
            documentation: entry.documentation.clone(),
            inside,
        });
        true
    }

    /// Refuses the name of an existing mode. True if there is one.
    fn is_taken(
        &self,
        base: &Word,
        name: &Word,
        member: Option<usize>,
        diagnostics: &mut Diagnostics,
    ) -> bool {
        let is_alone_and_family = |earlier: &Member| match (&earlier.family, member) {
            (Some((family, _)), None) => *family == base.text,
            (None, Some(_)) => earlier.name.text == base.text,
            _ => false,
        };
        let is_taken =
            |member: &&Member| member.name.text == name.text || is_alone_and_family(member);
        let Some(first) = self.list.iter().find(is_taken) else {
            return false;
        };
        let (text, called) = if is_alone_and_family(first) {
            let text = format!("mode `{}` declared alone and as a family", base.text);
            (text, None)
        } else {
            let text = format!("mode `{}` declared again", name.text);
            let shown = member.map(|member| written(&base.text, member));
            (
                text,
                shown.or_else(|| first.family.is_some().then(|| first.written())),
            )
        };
        let help = match called {
            Some(member) => format!("`{member}` has this name; choose another name"),
            None => "choose another name".to_owned(),
        };
        let error = diagnostics.error(base.at, text);
        let first_text = format!("`{}` first declared here", first.written());
        error.help(help).also(first.name.at, first_text);
        true
    }

    /// Refuses families with a missing member before the last.
    fn check_gaps(&self, diagnostics: &mut Diagnostics) {
        for mode in &self.list {
            let Some((family, member)) = &mode.family else {
                continue;
            };
            let before = Some((family.clone(), member - 1));
            if *member > 1 && !self.list.iter().any(|other| other.family == before) {
                let text = format!("mode `{}` is not declared", written(family, member - 1));
                let help = format!("the members of `{family}` are counted from 1 without a gap");
                diagnostics.error_once(mode.name.at, text, help);
            }
        }
    }

    /// The place of the mode with this name.
    pub(super) fn position(&self, name: &Word) -> Option<usize> {
        self.list
            .iter()
            .position(|mode| mode.name.text == name.text)
    }

    /// Number of members of a family.
    fn size(&self, family: &str) -> usize {
        let is_of =
            |member: &&Member| matches!(&member.family, Some((other, _)) if other == family);
        self.list.iter().filter(is_of).count()
    }

    /// Reads a reference to a mode: `rough`, `spoke[i % N + 1]`.
    pub(super) fn reference(
        &self,
        cursor: &mut Cursor<'_>,
        what: &str,
        constants: &Constants,
    ) -> Read<Word> {
        let name = cursor.name(what)?;
        let index = index(cursor)?;
        if !self.is_complete {
            return Ok(name);
        }
        match index {
            None => self.alone(name, cursor),
            Some(Index::One(index)) => self.member(&name, &index, constants, cursor),
            Some(Index::Each(binder)) => {
                let text = format!("a transition connects one mode with another, found `{binder}`");
                let help = "the range follows the name of the transition: `name[i in 1..=N]: slow[i] -> fast[i] ..`";
                let at = binder.name.at.to(binder.high.at);
                Err(cursor.refuse(at, text, help))
            }
        }
    }

    /// A reference by name, without an index. The check of the modes finds out if the mode exists.
    fn alone(&self, name: Word, cursor: &mut Cursor<'_>) -> Read<Word> {
        let size = self.size(&name.text);
        if size > 0 {
            let text = format!("`{}` is a family of {size}", name.text);
            let help = format!("write `{}`", written(&name.text, 1));
            return Err(cursor.refuse(name.at, text, &help));
        }
        let mut others = self.list.iter();
        let found = others.find(|other| other.name.text == name.text);
        let Some((family, member)) = found.and_then(|mode| mode.family.as_ref()) else {
            return Ok(name);
        };
        let text = format!("unknown mode `{}`", name.text);
        let member = written(family, member);
        let help = format!("a member of `{family}` is written `{member}`");
        Err(cursor.refuse(name.at, text, &help))
    }

    fn member(
        &self,
        name: &Word,
        index: &Scalar,
        constants: &Constants,
        cursor: &mut Cursor<'_>,
    ) -> Read<Word> {
        let Some(member) = constants.value(index, cursor.diagnostics) else {
            return Err(Refused);
        };
        let number = usize::try_from(member).unwrap_or(0);
        let wanted = Some((name.text.clone(), number));
        if let Some(found) = self.list.iter().find(|found| found.family == wanted) {
            let (text, at) = (found.name.text.clone(), name.at.to(cursor.last()));
            return Ok(Word { text, at });
        }
        let size = self.size(&name.text);
        if size > 0 {
            let text = format!("`{}` does not exist", written(&name.text, member));
            let help = format!("`{}` has the members 1 to {size}", name.text);
            return Err(cursor.refuse(index.at, text, &help));
        }
        if self.list.iter().any(|other| other.name.text == name.text) {
            let text = format!("`{}` is not a family", name.text);
            return Err(cursor.refuse(name.at, text, &format!("write `{}`", name.text)));
        }
        let names: Vec<String> = self.list.iter().map(Member::written).collect();
        let text = format!("unknown mode `{}`", name.text);
        Err(cursor.refuse(name.at, text, &mode_help(&name.text, &names)))
    }
}

/// Advice on an unknown mode. `names` are the modes in the notation of declarations.
pub fn mode_help(name: &str, names: &[String]) -> String {
    let names = || names.iter().map(String::as_str);
    let bases = names().map(|name| name.split('[').next().unwrap_or(name));
    match nearest(name, bases) {
        Some(near) => format!("did you mean `{near}`?"),
        None => format!("the modes are {}", listed(names())),
    }
}
