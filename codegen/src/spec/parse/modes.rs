//! `modes { rough { .. } smooth { .. } }` and `transitions { enter: smooth -> rough when x >= 0; }`
//!
//! A mode is read as a model of its own: the declarations outside of `modes`, then those in its braces, then as surfaces
//! the transitions that leave it. What modes share is so read once for each of them.

use proc_macro2::{Delimiter, Group, TokenTree};

use super::super::ast::{Comparison, Mode, Modes, Spec, Surface, Transition, Word};
use super::super::cursor::{Cursor, Read, Refused, tokens_of};
use super::impacts::{Strictness, comparison, conditions, law};
use super::{
    declaration_length, declarations, documentation, documentation_length, entry_length, labelled,
};
use crate::diagnostics::{Diagnostics, Location};

const MODE: &str = "modes { slow { .. } fast { .. } }";
const TRANSITION: &str = "name: slow -> fast when x >= 0 when y > 0 => LAW;";

/// Declarations that stand outside of `modes`, each with the reason.
const SHARED: [(&str, &str); 4] = [
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
        "declare a parameter in its place, and set it between runs",
    ),
    (
        "scenes",
        "leave them out: what a scene would leave out, a mode need not declare",
    ),
];

/// The parts of a model with modes, as tokens.
#[derive(Default)]
struct Parts {
    /// What stands outside of `modes` and `transitions`.
    shared: Vec<TokenTree>,
    /// Documentation, name and braces of each mode.
    modes: Vec<(Vec<String>, Word, Group)>,
    /// The braces of `transitions`.
    transitions: Vec<Group>,
    /// The first of the words `modes` and `transitions`.
    first: Option<Word>,
}

/// Whether a declaration is one of modes.
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
    let text = format!("`{}` stands inside of a mode", word.text);
    let help = format!("write `{}` beside the other declarations", word.text);
    cursor.refuse(word.at, text, &help)
}

/// Reads a model with modes; `header` is the model of which only the name is known.
///
/// # Errors
/// Every mistake of syntax, each at its token.
pub(super) fn read(
    header: &Spec,
    tokens: &[TokenTree],
    body: &Group,
) -> Result<Modes, Diagnostics> {
    let mut diagnostics = Diagnostics::new();
    let parts = take_apart(tokens, body, &mut diagnostics);
    if parts.modes.is_empty() {
        return Err(without_modes(&parts, header, body, diagnostics));
    }
    let mut declared = Modes {
        modes: Vec::new(),
        transitions: Vec::new(),
    };
    for (documentation, name, block) in &parts.modes {
        let mut own = Diagnostics::new();
        let inside = tokens_of(block.stream());
        refuse_shared(&inside, &mut own);
        let mut spec = header.beginning();
        let together = [parts.shared.clone(), inside].concat();
        declarations(&together, body, &mut spec, &mut own);
        declared.transitions = transitions(&parts.transitions, &name.text, &mut spec, &mut own);
        diagnostics.extend_once(own);
        declared.modes.push(Mode {
            name: name.clone(),
            documentation: documentation.clone(),
            spec,
        });
    }
    diagnostics.finish(declared)
}

/// What is wrong with a model that has `modes` or `transitions` and no mode: that, and whatever else is.
fn without_modes(
    parts: &Parts,
    header: &Spec,
    body: &Group,
    mut diagnostics: Diagnostics,
) -> Diagnostics {
    if let (Some(first), true) = (&parts.first, diagnostics.is_empty()) {
        let text = format!("`{}` without a mode", first.text);
        let help = format!("write `{MODE}`");
        diagnostics.error(first.at, text).help(help);
    }
    declarations(
        &parts.shared,
        body,
        &mut header.beginning(),
        &mut diagnostics,
    );
    diagnostics
}

/// The declarations one after the other.
fn split(tokens: &[TokenTree]) -> impl Iterator<Item = &[TokenTree]> {
    let mut rest = tokens;
    core::iter::from_fn(move || {
        let (declaration, others) = rest.split_at(declaration_length(rest));
        rest = others;
        (!declaration.is_empty()).then_some(declaration)
    })
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
            // What is wrong was recorded; the next declaration may be right.
            let _ = part(&mut cursor, &mut parts);
        } else {
            parts.shared.extend(declaration.iter().cloned());
            if matches!(word.as_deref(), Some("inputs" | "scenes")) {
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

/// `slow { .. }`
fn mode(cursor: &mut Cursor<'_>, parts: &mut Parts) -> Read<()> {
    let documentation = documentation(cursor)?;
    if cursor.eat_operator(";").is_some() {
        return Ok(());
    }
    let name = cursor.new_name("the name of a mode")?;
    let Some(block) = cursor.eat_group(Delimiter::Brace) else {
        let text = format!("expected `{{ .. }}` after the mode `{}`", name.text);
        return Err(cursor.unexpected(&text, &format!("write `{MODE}`")));
    };
    if let Some((_, first, _)) = parts.modes.iter().find(|(_, own, _)| own.text == name.text) {
        let text = format!("mode `{}` declared again", name.text);
        let error = cursor.diagnostics.error(name.at, text);
        error
            .help("choose another name")
            .also(first.at, "first declared here");
        return Ok(());
    }
    parts.modes.push((documentation, name, block.clone()));
    Ok(())
}

/// Refuses in a mode what all modes share, and scenes.
fn refuse_shared(tokens: &[TokenTree], diagnostics: &mut Diagnostics) {
    for declaration in split(tokens) {
        let Some(word) = keyword(declaration) else {
            continue;
        };
        if let Some((_, help)) = SHARED.iter().find(|(shared, _)| *shared == word) {
            let at = Location::of(&declaration[documentation_length(declaration)]);
            let text = match word.as_str() {
                "inputs" | "scenes" => format!("a model with modes has no `{word}`"),
                word => format!("`{word}` stands outside of `modes`"),
            };
            diagnostics.error(at, text).help(help);
        }
    }
}

/// All transitions; those that leave this mode become surfaces of its model.
fn transitions(
    groups: &[Group],
    mode: &str,
    spec: &mut Spec,
    diagnostics: &mut Diagnostics,
) -> Vec<Transition> {
    let mut transitions = Vec::new();
    for group in groups {
        let tokens = tokens_of(group.stream());
        let mut inside = Cursor::new(&tokens, Location::opening(group), diagnostics);
        while !inside.is_at_end() {
            let length = entry_length(inside.remaining());
            let (tokens, ended) = inside.take(length);
            let mut cursor = inside.inside(tokens, group);
            if cursor.is_at_end() {
                continue;
            }
            let Ok((transition, surface)) = transition(&mut cursor, spec) else {
                continue;
            };
            if cursor.end().is_ok() && !ended {
                let at = cursor.last();
                cursor.refuse(at, "expected `;`", "end the transition with `;`");
            }
            if transition.from.text == mode {
                spec.surfaces.push(surface);
            }
            transitions.push(transition);
        }
    }
    transitions
}

/// `enter: smooth -> rough when x >= 0 when y > 0 => LAW`
fn transition(cursor: &mut Cursor<'_>, spec: &mut Spec) -> Read<(Transition, Surface)> {
    let help = format!("write `{TRANSITION}`");
    let (documentation, declared) = labelled(cursor, "a transition", TRANSITION)?;
    let from = cursor.name("the mode that is left")?;
    if let Some(sign) = ["=>", ","]
        .into_iter()
        .find(|sign| cursor.is_operator(sign))
    {
        let text = format!("expected `->`, found `{sign}`");
        return Err(cursor.refuse_operator(sign, text, &help));
    }
    cursor.expect_operator("->", TRANSITION)?;
    let to = cursor.name("the mode that is entered")?;
    if !cursor.eat_word("when") {
        return Err(cursor.unexpected("expected `when`", &help));
    }
    let Comparison { greater, less, at } = comparison(cursor, Strictness::Weak, TRANSITION)?;
    let conditions = conditions(cursor, TRANSITION)?;
    let law = law(cursor, spec, TRANSITION)?;
    let item = spec.item(at);
    let name = declared.name.clone();
    // A transition happens when what is compared becomes true; the gap of a surface is positive before.
    let gap = Comparison {
        greater: less,
        less: greater,
        at,
    };
    let surface = Surface {
        declared,
        documentation,
        gap,
        conditions,
        law,
        enters: Some(to.clone()),
        instantaneous: Vec::new(),
        item,
    };
    Ok((Transition { name, from, to }, surface))
}
