//! `transitions { enter: smooth -> rough when x >= 0; step[i in 1..=N]: spoke[i] -> spoke[i%N + 1] when y <= 0 => LAW; }`

use proc_macro2::{Group, TokenTree};

use super::super::ast::{Comparison, Declared, Index, Spec, Surface, Transition, Word};
use super::super::cursor::{Cursor, Read, Refused, tokens_of};
use super::families::{Constants, Members, member_word};
use super::impacts::{Strictness, comparison, conditions, law};
use super::written_out::Bound;
use super::{documentation_length, entry_length, index, labelled};
use crate::diagnostics::{Diagnostics, Location};

const FORM: &str = "name: slow -> fast when x >= 0 when y > 0 => LAW;";
/// Description of the word before the arrow, for messages.
const LEFT: &str = "the mode that is left";

/// The transitions as tokens, families written out.
pub(super) struct Transitions<'a> {
    entries: Vec<Entry<'a>>,
}

/// `enter: smooth -> rough when x >= 0`
struct Entry<'a> {
    tokens: Vec<TokenTree>,
    /// The braces that contain it.
    group: &'a Group,
    /// True if a `;` follows.
    is_ended: bool,
}

impl<'a> Transitions<'a> {
    /// Reads the transitions and writes out their families.
    pub(super) fn of(
        groups: &'a [Group],
        constants: &Constants,
        diagnostics: &mut Diagnostics,
    ) -> Self {
        let mut entries = Vec::new();
        for group in groups {
            let tokens = tokens_of(group.stream());
            let mut rest = &*tokens;
            while !rest.is_empty() {
                let (tokens, others) = rest.split_at(entry_length(rest));
                let is_ended = !others.is_empty();
                rest = others.get(1..).unwrap_or_default();
                let members = written_out(tokens, group, constants, diagnostics);
                entries.extend(members.into_iter().map(|tokens| Entry {
                    tokens,
                    group,
                    is_ended,
                }));
            }
        }
        Self { entries }
    }

    /// For each transition, the mode in whose model it is read: the mode that it leaves, or the first one if there is no such
    /// mode.
    pub(super) fn readers(&self, members: &Members, constants: &Constants) -> Vec<usize> {
        let left = |entry: &Entry<'_>| {
            let mut mistakes = Diagnostics::new();
            let before = Location::opening(entry.group);
            let mut cursor = Cursor::new(&entry.tokens, before, &mut mistakes);
            labelled(&mut cursor, "a transition", FORM).ok()?;
            let from = members.reference(&mut cursor, LEFT, constants).ok()?;
            members.position(&from)
        };
        let places = self.entries.iter().map(left);
        places.map(|place| place.unwrap_or(0)).collect()
    }

    /// The transitions that are read in this mode, each with its number. Those that leave the mode become surfaces of its
    /// model.
    pub(super) fn read(
        &self,
        members: &Members,
        constants: &Constants,
        (mode, readers): (usize, &[usize]),
        spec: &mut Spec,
        diagnostics: &mut Diagnostics,
    ) -> Vec<(usize, Transition)> {
        let mut transitions = Vec::new();
        for (number, entry) in self.entries.iter().enumerate() {
            if readers[number] != mode || entry.tokens.is_empty() {
                continue;
            }
            let before = Location::opening(entry.group);
            let mut cursor = Cursor::new(&entry.tokens, before, diagnostics);
            let Ok((transition, surface)) = transition(&mut cursor, spec, members, constants)
            else {
                continue;
            };
            if cursor.end().is_ok() && !entry.is_ended {
                let at = cursor.last();
                cursor.refuse(at, "expected `;`", "end the transition with `;`");
            }
            if members.position(&transition.from) == Some(mode) {
                spec.surfaces.push(surface);
            }
            transitions.push((number, transition));
        }
        transitions
    }
}

/// The members of a family, each with its number in the brackets. Other entries stay as they are.
fn written_out(
    tokens: &[TokenTree],
    group: &Group,
    constants: &Constants,
    diagnostics: &mut Diagnostics,
) -> Vec<Vec<TokenTree>> {
    let begin = documentation_length(tokens);
    let Some((TokenTree::Ident(name), rest)) = tokens[begin..].split_first() else {
        return vec![tokens.to_vec()];
    };
    let mut cursor = Cursor::new(rest, Location::opening(group), diagnostics);
    let name = cursor.word(name);
    let (Ok(name), Ok(index)) = (name, index(&mut cursor)) else {
        return Vec::new();
    };
    let (Some(Index::Each(binder)), Some((brackets, rest))) = (&index, rest.split_first()) else {
        return vec![tokens.to_vec()];
    };
    let declared = Declared {
        name: name.clone(),
        index: index.clone(),
    };
    let members = constants
        .members(&declared, diagnostics)
        .unwrap_or_default();
    let written = members.into_iter().map(|member| {
        let bound = Bound::new(&name, binder, member);
        let mut written = tokens[..=begin].to_vec();
        written.push(bound.brackets(brackets));
        written.extend(bound.entry(rest, diagnostics));
        written
    });
    written.collect()
}

/// `enter: smooth -> rough when x >= 0 when y > 0 => LAW`
fn transition(
    cursor: &mut Cursor<'_>,
    spec: &mut Spec,
    members: &Members,
    constants: &Constants,
) -> Read<(Transition, Surface)> {
    let help = format!("write `{FORM}`");
    let (documentation, declared) = labelled(cursor, "a transition", FORM)?;
    let name = name(declared, constants, cursor)?;
    let from = members.reference(cursor, LEFT, constants)?;
    if let Some(sign) = ["=>", ","]
        .into_iter()
        .find(|sign| cursor.is_operator(sign))
    {
        let text = format!("expected `->`, found `{sign}`");
        return Err(cursor.refuse_operator(sign, text, &help));
    }
    cursor.expect_operator("->", FORM)?;
    let to = members.reference(cursor, "the mode that is entered", constants)?;
    if !cursor.eat_word("when") {
        return Err(cursor.unexpected("expected `when`", &help));
    }
    let Comparison {
        greater,
        less,
        is_closed,
        at,
    } = comparison(cursor, Strictness::Weak, FORM)?;
    let (conditions, is_otherwise) = conditions(cursor, FORM)?;
    let law = law(cursor, spec, FORM)?;
    let item = spec.item(at);
    // A transition happens when the comparison becomes true. The gap of its surface is positive before that.
    let gap = Comparison {
        greater: less,
        less: greater,
        is_closed,
        at,
    };
    let surface = Surface {
        declared: Declared {
            name: name.clone(),
            index: None,
        },
        documentation,
        gap,
        conditions,
        is_otherwise,
        law,
        enters: Some(to.clone()),
        instantaneous: Vec::new(),
        item,
    };
    Ok((Transition { name, from, to }, surface))
}

/// The name of a transition: `enter`, or `step3` for a member of a family.
fn name(declared: Declared, constants: &Constants, cursor: &mut Cursor<'_>) -> Read<Word> {
    if declared.index.is_none() {
        return Ok(declared.name);
    }
    let members = constants.members(&declared, cursor.diagnostics);
    match members.as_deref() {
        Some([member]) => Ok(member_word(&declared.name, *member)),
        _ => Err(Refused),
    }
}
