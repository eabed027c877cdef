//! Target of an assignment: a coordinate, or `dot(..)` of one.

use proc_macro2::{Delimiter, TokenTree};

use super::super::ast::Declared;
use super::super::cursor::{Cursor, Read, tokens_of};
use super::index;

/// True if the next word is followed by parentheses.
pub(super) fn is_call(cursor: &Cursor<'_>) -> bool {
    matches!(cursor.peek_second(), Some(TokenTree::Group(group)) if group.delimiter() == Delimiter::Parenthesis)
}

/// The coordinate in the parentheses behind `dot`; `form` is an example of an entry.
pub(super) fn inside_dot(cursor: &mut Cursor<'_>, form: &str) -> Read<Declared> {
    let Some(group) = cursor.eat_group(Delimiter::Parenthesis) else {
        return Err(cursor.unexpected("expected a coordinate", &format!("write `{form}`")));
    };
    let tokens = tokens_of(group.stream());
    let mut inside = cursor.inside(&tokens, group);
    let name = inside.name("a coordinate")?;
    let index = index(&mut inside)?;
    match inside.is_at_end() {
        true => Ok(Declared { name, index }),
        false => Err(inside.unexpected("expected one coordinate", &format!("write `{form}`"))),
    }
}

/// Takes the `=` of an entry.
pub(super) fn equals(cursor: &mut Cursor<'_>, form: &str) -> Read<()> {
    if cursor.is_operator(".") {
        return Err(cursor.point());
    }
    if cursor.is_operator("==") {
        let help = format!("write `{form}`");
        return Err(cursor.refuse_operator("==", "expected `=`, found `==`", &help));
    }
    cursor.expect_operator("=", form)?;
    Ok(())
}
