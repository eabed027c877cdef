//! `=> LAW, instantaneous { slip: dot(y) = 0; .. }`: constraints that hold at an impact and during the contact after
//! it.

use proc_macro2::Delimiter;

use super::super::ast::{Equation, Law, Spec};
use super::super::cursor::{Cursor, Read, tokens_of};
use super::super::keyword::{INSTANTANEOUS, STOP};
use super::constraints::equation;
use super::entry_length;

const FORM: &str = "=> LAW, instantaneous { name: dot(y) = 0; }";

/// Reads the constraints behind the comma after a law; none without a comma.
pub(super) fn equations(
    cursor: &mut Cursor<'_>,
    spec: &mut Spec,
    law: Option<&Law>,
) -> Read<Vec<Equation>> {
    let Some(law) = law.filter(|_| cursor.eat_operator(",").is_some()) else {
        return Ok(Vec::new());
    };
    if !cursor.is_word(INSTANTANEOUS) {
        let help = format!("write `{FORM}`");
        return Err(cursor.unexpected("expected `instantaneous { .. }`", &help));
    }
    let word = cursor.name("a word")?;
    if law.assignments.is_some() {
        let text = "a reset takes no instantaneous constraints";
        let help = "a reset gives positions and velocities after the impact";
        return Err(cursor.refuse(word.at, text, help));
    }
    if law.name.text == STOP {
        let text = "`stop` takes no instantaneous constraints";
        return Err(cursor.refuse(word.at, text, "the motion ends there"));
    }
    let Some(group) = cursor.eat_group(Delimiter::Brace) else {
        let text = "expected `{ .. }` after `instantaneous`";
        return Err(cursor.unexpected(text, &format!("write `{FORM}`")));
    };
    let tokens = tokens_of(group.stream());
    let mut inside = cursor.inside(&tokens, group);
    let mut equations = Vec::new();
    while !inside.is_at_end() {
        let length = entry_length(inside.remaining());
        let (tokens, ended) = inside.take(length);
        let mut entry = inside.inside(tokens, group);
        if entry.is_at_end() {
            continue;
        }
        equations.push(equation(&mut entry, spec, "an instantaneous constraint")?);
        entry.end()?;
        if !ended {
            let at = entry.last();
            return Err(entry.refuse(at, "expected `;`", "end the constraint with `;`"));
        }
    }
    if equations.is_empty() {
        return Err(cursor.refuse(
            word.at,
            "no instantaneous constraint",
            "leave the braces out",
        ));
    }
    Ok(equations)
}
