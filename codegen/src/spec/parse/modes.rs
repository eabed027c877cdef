//! `modes { rough { .. } smooth { .. } }` and `transitions { enter: smooth -> rough when x >= 0; }`
//!
//! A mode is read as a model of its own: the declarations outside of `modes`, then those in its braces, then the
//! transitions that leave it, as surfaces. Shared declarations are read once for each mode. Families of modes and of
//! transitions are expanded before that, as tokens.

use proc_macro2::{Delimiter, Group, TokenTree};

use super::super::ast::{Indices, Mode, Modes, Spec, Word};
use super::super::cursor::{Cursor, Read, Refused, tokens_of};
use super::families::{Constants, Entry, Members};
use super::transitions::Transitions;
use super::{declarations, declared, documentation, documentation_length, split};
use crate::diagnostics::{Diagnostics, Location};

const MODE: &str = "modes { slow { .. } fast { .. } }";

/// Declarations that a mode must not contain, each with advice.
const SHARED: [(&str, &str); 5] = [
    (
        "const",
        "declare it outside of `modes`: all modes share constants",
    ),
    (
        "parameters",
        "declare them outside of `modes`: all modes share the parameters of the model",
    ),
    (
        "inputs",
        "declare them outside of `modes`: all modes share the inputs of the model",
    ),
    ("cost", "declare the model of one mode by itself"),
    (
        "scenes",
        "leave them out: a mode declares only the parts that it uses",
    ),
];

/// The parts of a model with modes, as tokens.
#[derive(Default)]
struct Parts {
    /// Tokens outside of `modes` and `transitions`.
    shared: Vec<TokenTree>,
    /// Entries of `modes`.
    entries: Vec<Entry>,
    /// The braces of `transitions`.
    transitions: Vec<Group>,
    /// The first of the words `modes` and `transitions`.
    first: Option<Word>,
}

/// True if the tokens declare modes or transitions.
pub(super) fn are_declared(tokens: &[TokenTree]) -> bool {
    split(tokens).any(|declaration| {
        matches!(
            keyword(declaration).as_deref(),
            Some("modes" | "transitions")
        )
    })
}

/// Refuses modes inside of a mode.
pub(super) fn refuse_nested(word: &Word, cursor: &mut Cursor<'_>) -> Refused {
    let text = format!("`{}` is not allowed inside a mode", word.text);
    let help = format!("write `{}` beside the other declarations", word.text);
    cursor.refuse(word.at, text, &help)
}

/// Reads a model with modes; `header` is the model with only its name, its visibility and its documentation.
///
/// # Errors
/// Every mistake of syntax, each at its token.
pub(super) fn read(
    header: &Spec,
    tokens: &[TokenTree],
    body: &Group,
    indices: Indices,
) -> Result<Modes, Diagnostics> {
    let mut diagnostics = Diagnostics::new();
    let parts = take_apart(tokens, body, &mut diagnostics);
    if let (Some(first), [], true) = (&parts.first, &*parts.entries, diagnostics.is_empty()) {
        let text = format!("`{}` needs at least one mode", first.text);
        let help = format!("write `{MODE}`");
        diagnostics.error(first.at, text).help(help);
    }
    let constants = Constants::read(header, &parts.shared, body, indices, &mut diagnostics);
    let members = Members::of(&parts.entries, &constants, &mut diagnostics);
    let written = Transitions::of(&parts.transitions, &constants, &mut diagnostics);
    let mut read = Modes {
        modes: Vec::new(),
        transitions: Vec::new(),
    };
    let readers = written.readers(&members, &constants);
    let mut transitions = Vec::new();
    for (mode, member) in members.list.iter().enumerate() {
        let mut mistakes = Diagnostics::new();
        refuse_shared(&member.inside, &mut mistakes);
        let mut spec = header.beginning();
        let together = [&*parts.shared, &*member.inside].concat();
        declarations(&together, body, &mut spec, &mut mistakes);
        let place = (mode, &*readers);
        transitions.extend(written.read(&members, &constants, place, &mut spec, &mut mistakes));
        diagnostics.extend_once(mistakes);
        read.modes.push(Mode {
            name: member.name.clone(),
            written: member.written(),
            documentation: member.documentation.clone(),
            spec,
        });
    }
    transitions.sort_by_key(|(number, _)| *number);
    read.transitions = transitions
        .into_iter()
        .map(|(_, transition)| transition)
        .collect();
    diagnostics.finish(read)
}

/// The word that a declaration begins with.
fn keyword(declaration: &[TokenTree]) -> Option<String> {
    match declaration.get(documentation_length(declaration))? {
        TokenTree::Ident(word) => Some(word.to_string()),
        _ => None,
    }
}

fn take_apart(tokens: &[TokenTree], body: &Group, diagnostics: &mut Diagnostics) -> Parts {
    let mut parts = Parts::default();
    let mut before = Location::opening(body);
    for declaration in split(tokens) {
        let word = keyword(declaration);
        if let Some("modes" | "transitions") = word.as_deref() {
            let mut cursor = Cursor::new(declaration, before, diagnostics);
            // The mistake was recorded; the next declaration may be right.
            let _ = part(&mut cursor, &mut parts);
        } else {
            parts.shared.extend(declaration.iter().cloned());
            if matches!(word.as_deref(), Some("cost" | "scenes")) {
                refuse_shared(declaration, diagnostics);
            }
        }
        before = declaration.last().map_or(before, Location::of);
    }
    parts
}

/// `modes { .. }` or `transitions { .. }`
fn part(cursor: &mut Cursor<'_>, parts: &mut Parts) -> Read<()> {
    documentation(cursor)?;
    let word = cursor.name("a declaration")?;
    let Some(group) = cursor.eat_group(Delimiter::Brace) else {
        let text = format!("expected `{{ .. }}` after `{}`", word.text);
        return Err(cursor.unexpected(&text, &format!("write `{} {{ .. }}`", word.text)));
    };
    let is_modes = word.text == "modes";
    parts.first.get_or_insert(word);
    if !is_modes {
        parts.transitions.push(group.clone());
        return cursor.end();
    }
    let tokens = tokens_of(group.stream());
    let mut inside = cursor.inside(&tokens, group);
    while !inside.is_at_end() {
        mode(&mut inside, parts)?;
    }
    Ok(())
}

/// `slow { .. }`, `spoke[i in 1..=N] { .. }`
fn mode(cursor: &mut Cursor<'_>, parts: &mut Parts) -> Read<()> {
    let documentation = documentation(cursor)?;
    if cursor.eat_operator(";").is_some() {
        return Ok(());
    }
    let declared = declared(cursor, "the name of a mode")?;
    let Some(block) = cursor.eat_group(Delimiter::Brace) else {
        let text = format!(
            "expected `{{ .. }}` after the mode `{}`",
            declared.name.text
        );
        return Err(cursor.unexpected(&text, &format!("write `{MODE}`")));
    };
    parts.entries.push(Entry {
        documentation,
        declared,
        block: block.clone(),
    });
    Ok(())
}

/// Refuses declarations that a mode must not contain.
fn refuse_shared(tokens: &[TokenTree], diagnostics: &mut Diagnostics) {
    for declaration in split(tokens) {
        let Some(word) = keyword(declaration) else {
            continue;
        };
        if let Some((_, help)) = SHARED.iter().find(|(shared, _)| *shared == word) {
            let at = Location::of(&declaration[documentation_length(declaration)]);
            let text = match word.as_str() {
                "cost" | "scenes" => format!("a model with modes has no `{word}`"),
                word => format!("`{word}` belongs outside of `modes`"),
            };
            diagnostics.error(at, text).help(help);
        }
    }
}
