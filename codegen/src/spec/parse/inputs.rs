//! `inputs { u; thrust[2]; }`: quantities that the caller supplies as functions of time and state.

use super::super::ast::{Spec, Supplied};
use super::super::cursor::{Cursor, Read};
use super::{declared, documentation};

/// Reads one input.
pub(super) fn input(cursor: &mut Cursor<'_>, spec: &mut Spec) -> Read<()> {
    let documentation = documentation(cursor)?;
    let declared = declared(cursor, "the name of an input")?;
    if !cursor.is_at_end() {
        let help = match cursor.is_word("in") {
            true => "bounds on inputs are not supported; an input has only a name: `u;`",
            false => {
                "an input has only a name: `u;`, `thrust[2];`; its values come from the caller"
            }
        };
        return Err(cursor.unexpected("expected `;`", help));
    }
    let item = spec.item(declared.name.at);
    spec.inputs.push(Supplied {
        declared,
        documentation,
        item,
    });
    Ok(())
}
