//! `initial { phi = pi/2; dot(theta) = 10; theta[i in 1..=N] = 0.1; until = 20; }`

use proc_macro2::{Delimiter, TokenTree};

use super::super::ast::{Declared, InitialTarget, InitialValue, Spec};
use super::super::cursor::{Cursor, Read, tokens_of};
use super::{documentation, index};

const FORM: &str = "`x = 1;`, `dot(x) = 2;` or `until = 10;`";

/// Reads one entry.
pub(super) fn value(cursor: &mut Cursor<'_>, spec: &mut Spec) -> Read<()> {
    documentation(cursor)?;
    let (target, declared) = target(cursor)?;
    if cursor.is_operator(".") {
        return Err(cursor.point());
    }
    if cursor.is_operator("==") {
        return Err(cursor.refuse_operator("==", "expected `=`, found `==`", "write `x = 1;`"));
    }
    cursor.expect_operator("=", "x = 1;")?;
    let value = cursor.scalar()?;
    spec.initial.push(InitialValue {
        target,
        declared,
        value,
    });
    Ok(())
}

fn target(cursor: &mut Cursor<'_>) -> Read<(InitialTarget, Declared)> {
    let is_call = matches!(cursor.peek_second(), Some(TokenTree::Group(group)) if group.delimiter() == Delimiter::Parenthesis);
    let name = cursor.name(&format!("an initial value: {FORM}"))?;
    if name.text == "until" {
        return Ok((InitialTarget::Until, Declared { name, index: None }));
    }
    if !is_call {
        let index = index(cursor)?;
        return Ok((InitialTarget::Position, Declared { name, index }));
    }
    if name.text != "dot" {
        return Err(cursor.refuse(
            name.at,
            format!("`{}` is not an initial value", name.text),
            &format!("write {FORM}"),
        ));
    }
    let Some(group) = cursor.eat_group(Delimiter::Parenthesis) else {
        return Err(cursor.unexpected("expected a coordinate", "write `dot(x) = 2;`"));
    };
    let tokens = tokens_of(group.stream());
    let mut inside = cursor.inside(&tokens, group);
    let name = inside.name("a coordinate")?;
    let index = index(&mut inside)?;
    if !inside.is_at_end() {
        return Err(inside.unexpected("expected one coordinate", "write `dot(x) = 2;`"));
    }
    Ok((InitialTarget::Velocity, Declared { name, index }))
}
