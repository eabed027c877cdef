//! Header of a model: `/// documentation #[global] pub(crate) Name { .. }`

use proc_macro2::{Delimiter, Group};

use super::super::ast::{Spec, Word};
use super::super::cursor::{Cursor, Read, Refused};
use super::super::keyword::{SECTIONS, is_rust_keyword};
use super::{Attributes, attributes, source};

const FORM: &str = "a model is written `pub Name { coordinates { .. } lagrangian = ..; }`";

/// Reads documentation, visibility and name. Returns the empty model, and the group with its declarations.
pub(super) fn read(cursor: &mut Cursor<'_>) -> Read<(Spec, Group)> {
    let Attributes {
        documentation,
        global,
    } = attributes(cursor)?;
    let visibility = visibility(cursor);
    let (name, snake_name) = name(cursor)?;
    let Some(body) = cursor.eat_group(Delimiter::Brace) else {
        return Err(cursor.unexpected("expected `{ .. }` after the name of the model", FORM));
    };
    if !cursor.is_at_end() {
        return Err(cursor.unexpected(
            "expected nothing after the model",
            "declare one model in each `model!`",
        ));
    }
    let mut spec = Spec::new(name, snake_name);
    spec.seed = source::hash(&spec.name.text, body);
    spec.source = source::text(&documentation, &visibility, &spec.name.text, body);
    spec.documentation = documentation;
    spec.global = global;
    spec.visibility = visibility;
    Ok((spec, body.clone()))
}

/// Reads `pub`, `pub(crate)` or nothing.
fn visibility(cursor: &mut Cursor<'_>) -> String {
    if !cursor.eat_word("pub") {
        return String::new();
    }
    match cursor.eat_group(Delimiter::Parenthesis) {
        Some(scope) => format!("pub({})", scope.stream()),
        None => "pub".to_owned(),
    }
}

/// Reads the name of the type. Returns it with the name of its module. Rust must accept both side by side.
fn name(cursor: &mut Cursor<'_>) -> Read<(Word, String)> {
    if cursor.peek().is_none() {
        return Err(cursor.unexpected("expected the name of a model", FORM));
    }
    let name = cursor.name("the name of a model")?;
    // The name is missing, or follows a word that is not part of the syntax.
    let is_other = matches!(name.text.as_str(), "struct" | "enum" | "model" | "mod");
    if is_other || SECTIONS.contains(&name.text.as_str()) {
        let text = format!("expected the name of a model, found `{}`", name.text);
        return Err(cursor.refuse(name.at, text, FORM));
    }
    let snake = snake_case(&name.text);
    if is_rust_keyword(&name.text) || name.text.starts_with("r#") || name.text == "_" {
        let help = "choose another name in camel case, like `RollingDisk`";
        cursor.refuse(
            name.at,
            format!("`{}` is a keyword of Rust", name.text),
            help,
        );
    } else if snake == name.text {
        refuse_snake_case(cursor, &name);
    } else if is_rust_keyword(&snake) {
        let text = format!(
            "the module of `{}` cannot be called `{snake}`, a keyword of Rust",
            name.text
        );
        let help = format!("choose another name, for example `{}Model`", name.text);
        cursor.refuse(name.at, text, &help);
    }
    Ok((name, snake))
}

fn refuse_snake_case(cursor: &mut Cursor<'_>, name: &Word) -> Refused {
    let text = format!("`{}` would name both the type and its module", name.text);
    let camel = camel_case(&name.text);
    let help = if snake_case(&camel) == camel {
        "write the type in camel case, like `RollingDisk`".to_owned()
    } else {
        format!("write the type in camel case: `{camel}`")
    };
    cursor.refuse(name.at, text, &help)
}

/// Converts `RollingDisk` to `rolling_disk`.
fn snake_case(name: &str) -> String {
    let mut snake = String::new();
    let characters: Vec<char> = name.chars().collect();
    for (index, character) in characters.iter().enumerate() {
        let after_lower = index > 0
            && (characters[index - 1].is_lowercase() || characters[index - 1].is_ascii_digit());
        let before_lower = index > 0
            && characters[index - 1].is_uppercase()
            && characters
                .get(index + 1)
                .is_some_and(|next| next.is_lowercase());
        if character.is_uppercase() && (after_lower || before_lower) {
            snake.push('_');
        }
        snake.extend(character.to_lowercase());
    }
    snake
}

/// Converts `rolling_disk` to `RollingDisk`.
pub fn camel_case(name: &str) -> String {
    let capitalised = |word: &str| {
        let mut letters = word.chars();
        let first = letters.next().into_iter().flat_map(char::to_uppercase);
        first.chain(letters).collect::<String>()
    };
    name.split('_').map(capitalised).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn type_names_become_snake_case() {
        assert_eq!(snake_case("RollingDisk"), "rolling_disk");
        assert_eq!(snake_case("Pendulum"), "pendulum");
        assert_eq!(snake_case("BallOnTable2D"), "ball_on_table2_d");
        assert_eq!(snake_case("LChain"), "l_chain");
    }

    #[test]
    fn names_of_modules_become_camel_case() {
        assert_eq!(camel_case("rolling_disk"), "RollingDisk");
        assert_eq!(camel_case("pendulum"), "Pendulum");
        assert_eq!(camel_case("__"), "");
    }
}
