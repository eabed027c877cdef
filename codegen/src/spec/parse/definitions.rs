//! `const N = 8;`, `let a = e;`, `let f(u, v) = e;`, `let X[0] = e;`, `let X[i in 1..=N] = e;`

use proc_macro2::Delimiter;

use super::super::ast::{Constant, Definition, Spec, Word};
use super::super::cursor::{Cursor, Read, tokens_of};
use super::{declared, end_of_declaration};

/// Reads a constant after the word `const`.
pub(super) fn constant(cursor: &mut Cursor<'_>, spec: &mut Spec) -> Read<()> {
    let name = cursor.new_name("the name of a constant")?;
    cursor.expect_operator("=", "const N = 8;")?;
    let value = cursor.scalar()?;
    end_of_declaration(cursor)?;
    spec.constants.push(Constant { name, value });
    Ok(())
}

/// Reads a definition after the word `let`.
pub(super) fn definition(cursor: &mut Cursor<'_>, spec: &mut Spec) -> Read<()> {
    let declared = declared(cursor, "the name of a definition")?;
    let arguments = arguments(cursor)?;
    cursor.expect_operator("=", "let name = ..;")?;
    if cursor.is_operator("|") {
        let help = "a function is written `let f(u) = ..;`, the absolute value `abs(x)`";
        return Err(cursor.unexpected("expected an expression", help));
    }
    let value = cursor.scalar()?;
    end_of_declaration(cursor)?;
    spec.definitions.push(Definition {
        declared,
        arguments,
        value,
    });
    Ok(())
}

/// `(u, v)` or nothing.
fn arguments(cursor: &mut Cursor<'_>) -> Read<Option<Vec<Word>>> {
    let Some(group) = cursor.eat_group(Delimiter::Parenthesis) else {
        return Ok(None);
    };
    let tokens = tokens_of(group.stream());
    let mut inside = cursor.inside(&tokens, group);
    let mut names: Vec<Word> = Vec::new();
    while !inside.is_at_end() {
        let name = inside.new_name("the name of an argument")?;
        if names.iter().any(|other| other.text == name.text) {
            inside.refuse(
                name.at,
                format!("argument `{}` declared again", name.text),
                "choose another name",
            );
        }
        names.push(name);
        if inside.eat_operator(",").is_none() && !inside.is_at_end() {
            return Err(inside.unexpected("expected `,`", "write `let name(u, v) = ..;`"));
        }
    }
    if names.is_empty() {
        let at = group.span().into();
        return Err(cursor.refuse(
            at,
            "a function has at least one argument",
            "write `let name = ..;`",
        ));
    }
    Ok(Some(names))
}
