//! `scenes { free; billiard: leading_edge, trailing_edge; windy: billiard, drag; }`

use proc_macro2::TokenTree;

use super::super::ast::{Scene, Spec};
use super::super::cursor::{Cursor, Read};
use super::{declared, documentation};

const FORM: &str = "billiard: leading_edge, trailing_edge;";

/// Reads one scene.
pub(super) fn scene(cursor: &mut Cursor<'_>, spec: &mut Spec) -> Read<()> {
    let documentation = documentation(cursor)?;
    let name = cursor.new_name("the name of a scene")?;
    let mut parts = Vec::new();
    if cursor.eat_operator(":").is_some() {
        loop {
            parts.push(declared(cursor, "a force, a surface, a scene or an extra")?);
            if cursor.eat_operator(",").is_none() {
                break;
            }
        }
    }
    if let Some(TokenTree::Ident(_) | TokenTree::Punct(_)) = cursor.peek() {
        let text = match parts.is_empty() {
            true => "expected `:` or `;`",
            false => "expected `,` or `;`",
        };
        return Err(cursor.unexpected(text, &format!("write `{FORM}`")));
    }
    let item = spec.item(name.at);
    spec.scenes.push(Scene {
        name,
        documentation,
        parts,
        item,
    });
    Ok(())
}
