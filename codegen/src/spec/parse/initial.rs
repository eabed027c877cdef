//! `initial { phi = pi/2; dot(theta) = 10; theta[i in 1..=N] = 0.1; until = 20; }`

use super::super::ast::{Declared, InitialTarget, InitialValue, Spec};
use super::super::cursor::{Cursor, Read};
use super::target::{equals, inside_dot, is_call};
use super::{documentation, index};

const FORM: &str = "`x = 1;`, `dot(x) = 2;` or `until = 10;`";

/// Reads one entry.
pub(super) fn value(cursor: &mut Cursor<'_>, spec: &mut Spec) -> Read<()> {
    documentation(cursor)?;
    let (target, declared) = target(cursor)?;
    equals(cursor, "x = 1;")?;
    let value = cursor.scalar()?;
    spec.initial.push(InitialValue {
        target,
        declared,
        value,
    });
    Ok(())
}

fn target(cursor: &mut Cursor<'_>) -> Read<(InitialTarget, Declared)> {
    let is_call = is_call(cursor);
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
    let declared = inside_dot(cursor, "dot(x) = 2;")?;
    Ok((InitialTarget::Velocity, declared))
}
