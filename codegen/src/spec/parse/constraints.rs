//! Named equations and quantities: `constraints { a: left = right; }`, `forces { f: form; }`, `outputs { o: e; }`.

use super::super::ast::{Equation, Quantity, Spec};
use super::super::cursor::{Cursor, Read};
use super::labelled;

/// Reads one constraint.
pub(super) fn constraint(cursor: &mut Cursor<'_>, spec: &mut Spec) -> Read<()> {
    const FORM: &str = "name: d(x) - R*d(theta) = 0;";
    let (documentation, declared) = labelled(cursor, "the name of a constraint", FORM)?;
    let left = cursor.scalar()?;
    if cursor.is_operator("==") {
        return Err(cursor.refuse_operator(
            "==",
            "expected `=`, found `==`",
            &format!("write `{FORM}`"),
        ));
    }
    cursor.expect_operator("=", FORM)?;
    let right = cursor.scalar()?;
    let item = spec.item(left.at.to(right.at));
    spec.constraints.push(Equation {
        declared,
        documentation,
        left,
        right,
        item,
    });
    Ok(())
}

/// Reads one force.
pub(super) fn force(cursor: &mut Cursor<'_>, spec: &mut Spec) -> Read<()> {
    let force = quantity(cursor, spec, "the name of a force", "name: -c*dot(x)*d(x);")?;
    spec.forces.push(force);
    Ok(())
}

/// Reads one output.
pub(super) fn output(cursor: &mut Cursor<'_>, spec: &mut Spec) -> Read<()> {
    let output = quantity(
        cursor,
        spec,
        "the name of an output",
        "name: x + l*sin(theta);",
    )?;
    spec.outputs.push(output);
    Ok(())
}

fn quantity(cursor: &mut Cursor<'_>, spec: &mut Spec, what: &str, form: &str) -> Read<Quantity> {
    let (documentation, declared) = labelled(cursor, what, form)?;
    let value = cursor.scalar()?;
    let item = spec.item(value.at);
    Ok(Quantity {
        declared,
        documentation,
        value,
        item,
    })
}
