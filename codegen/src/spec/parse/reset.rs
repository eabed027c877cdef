//! `reset { theta = theta + 2*delta; dot(theta[i in 1..=N]) = -dot(theta[i]); }`

use proc_macro2::{Delimiter, TokenTree};

use super::super::ast::{Assignment, AssignmentTarget, Declared};
use super::super::cursor::{Cursor, Read, tokens_of};
use super::target::{equals, inside_dot, is_call};
use super::{entry_length, index};

const FORM: &str = "reset { x = ..; dot(x) = ..; }";

/// Reads the braces after the word `reset`.
pub(super) fn assignments(cursor: &mut Cursor<'_>) -> Read<Vec<Assignment>> {
    let Some(group) = cursor.eat_group(Delimiter::Brace) else {
        let help = format!("write `{FORM}`; `reset {{ }}` changes nothing");
        return Err(cursor.unexpected("expected `{ .. }` after `reset`", &help));
    };
    let tokens = tokens_of(group.stream());
    let mut inside = cursor.inside(&tokens, group);
    let mut assignments = Vec::new();
    while !inside.is_at_end() {
        let length = entry_length(inside.remaining());
        let (tokens, ended) = inside.take(length);
        let mut entry = inside.inside(tokens, group);
        if entry.is_at_end() {
            continue;
        }
        assignments.push(assignment(&mut entry)?);
        entry.end()?;
        if !ended {
            let at = entry.last();
            return Err(entry.refuse(at, "expected `;`", "end the assignment with `;`"));
        }
    }
    Ok(assignments)
}

fn assignment(cursor: &mut Cursor<'_>) -> Read<Assignment> {
    let (target, declared) = target(cursor)?;
    equals(cursor, "x = ..;")?;
    let value = cursor.scalar()?;
    Ok(Assignment {
        target,
        declared,
        value,
    })
}

fn target(cursor: &mut Cursor<'_>) -> Read<(AssignmentTarget, Declared)> {
    const HELP: &str = "a reset sets coordinates and their velocities: `x = ..;`, `dot(x) = ..;`";
    let is_call = is_call(cursor);
    if !matches!(cursor.peek(), Some(TokenTree::Ident(_))) {
        return Err(cursor.unexpected("expected a coordinate or `dot(..)` of one", HELP));
    }
    let name = cursor.name("a coordinate")?;
    if !is_call {
        let index = index(cursor)?;
        return Ok((AssignmentTarget::Position, Declared { name, index }));
    }
    if name.text != "dot" {
        let text = format!("`{}(..)` cannot be reset", name.text);
        return Err(cursor.refuse(name.at, text, HELP));
    }
    let declared = inside_dot(cursor, "dot(x) = ..;")?;
    Ok((AssignmentTarget::Velocity, declared))
}
