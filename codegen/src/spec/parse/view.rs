//! `view { path: (x, y); region: h >= 0; }`

use proc_macro2::Delimiter;

use super::super::ast::Spec;
use super::super::cursor::{Cursor, Read};
use super::coordinates::pair;
use super::documentation;
use super::impacts::{Strictness, comparison};

/// Reads one entry.
pub(super) fn entry(cursor: &mut Cursor<'_>, spec: &mut Spec) -> Read<()> {
    const HELP: &str = "a view is written `path: (x, y);` and `region: h >= 0;`";
    documentation(cursor)?;
    let key = cursor.name("`path` or `region`")?;
    cursor.expect_operator(":", "path: (x, y);")?;
    let again = match key.text.as_str() {
        "path" => {
            let Some(group) = cursor.eat_group(Delimiter::Parenthesis) else {
                return Err(cursor.unexpected("expected a pair `(x, y)`", HELP));
            };
            let path = pair(cursor, group, "the components of a path")?;
            spec.view.path.replace(path).is_some()
        }
        "region" => spec
            .view
            .region
            .replace(comparison(cursor, Strictness::Weak, "region: h >= 0;")?)
            .is_some(),
        _ => {
            return Err(cursor.refuse(
                key.at,
                format!("unknown entry `{}` of `view`", key.text),
                HELP,
            ));
        }
    };
    if again {
        cursor.refuse(
            key.at,
            format!("`{}` declared again", key.text),
            "keep one of the two",
        );
    }
    Ok(())
}
