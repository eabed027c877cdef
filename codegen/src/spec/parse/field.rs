//! `field { dot(x) = y; dot(theta[i in 1..=N]) = omega[i]; }`

use super::super::ast::{Field, Rate, Spec, Word};
use super::super::cursor::{Cursor, Read};
use super::documentation;
use super::target::{equals, inside_dot};

const FORM: &str = "dot(x) = ..;";

/// Records that a field is declared, even if it is empty.
pub(super) fn begin(keyword: &Word, spec: &mut Spec) {
    if spec.field.is_none() {
        let item = spec.item(keyword.at);
        let rates = Vec::new();
        spec.field = Some(Field { rates, item });
    }
}

/// Reads one rate.
pub(super) fn rate(cursor: &mut Cursor<'_>, spec: &mut Spec) -> Read<()> {
    documentation(cursor)?;
    let name = cursor.name(&format!("a rate: `{FORM}`"))?;
    if name.text != "dot" {
        let text = format!("`{}` is not a rate", name.text);
        return Err(cursor.refuse(name.at, text, &format!("write `{FORM}`")));
    }
    let declared = inside_dot(cursor, FORM)?;
    equals(cursor, FORM)?;
    let value = cursor.scalar()?;
    if let Some(field) = &mut spec.field {
        field.rates.push(Rate { declared, value });
    }
    Ok(())
}
