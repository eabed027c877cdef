//! Named equations and quantities: `constraints { a: left = right; }`, `forces { f: form; }`, `frame { v: form; }`,
//! `outputs { o: e; }`.

use super::super::ast::{Equation, Quantity, Spec};
use super::super::cursor::{Cursor, Read};
use super::labelled;

/// Reads one constraint.
pub(super) fn constraint(cursor: &mut Cursor<'_>, spec: &mut Spec) -> Read<()> {
    let equation = equation(cursor, spec, "a constraint")?;
    spec.constraints.push(equation);
    Ok(())
}

/// Reads one equation; error messages call it `entry`.
pub(super) fn equation(cursor: &mut Cursor<'_>, spec: &mut Spec, entry: &str) -> Read<Equation> {
    const FORM: &str = "name: d(x) - R*d(theta) = 0;";
    let (documentation, declared) = labelled(cursor, entry, FORM)?;
    let left = cursor.scalar()?;
    if let Some(sign) = cursor.comparison() {
        let help = match sign {
            "==" => format!("write `{FORM}`"),
            _ => "a constraint is an equation; a wall is declared in `impacts`".to_owned(),
        };
        let text = format!("expected `=`, found `{sign}`");
        return Err(cursor.refuse_operator(sign, text, &help));
    }
    cursor.expect_operator("=", FORM)?;
    let right = cursor.scalar()?;
    let item = spec.item(left.at.to(right.at));
    Ok(Equation {
        declared,
        documentation,
        left,
        right,
        item,
    })
}

/// Reads one force.
pub(super) fn force(cursor: &mut Cursor<'_>, spec: &mut Spec) -> Read<()> {
    let force = quantity(cursor, spec, "a force", "name: -c*dot(x)*d(x);")?;
    spec.forces.push(force);
    Ok(())
}

/// Reads one quasi-velocity.
pub(super) fn quasi_velocity(cursor: &mut Cursor<'_>, spec: &mut Spec) -> Read<()> {
    let form = "name: cos(theta)*d(x) + sin(theta)*d(y);";
    let entry = quantity(cursor, spec, "a quasi-velocity", form)?;
    spec.frame.push(entry);
    Ok(())
}

/// Reads one output.
pub(super) fn output(cursor: &mut Cursor<'_>, spec: &mut Spec) -> Read<()> {
    let output = quantity(cursor, spec, "an output", "name: x + l*sin(theta);")?;
    spec.outputs.push(output);
    Ok(())
}

fn quantity(cursor: &mut Cursor<'_>, spec: &mut Spec, entry: &str, form: &str) -> Read<Quantity> {
    let (documentation, declared) = labelled(cursor, entry, form)?;
    let value = cursor.scalar()?;
    let item = spec.item(value.at);
    Ok(Quantity {
        declared,
        documentation,
        value,
        item,
    })
}
