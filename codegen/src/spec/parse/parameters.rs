//! `parameters { m > 0 = 0.5; e in [0, 1]; k[N] > 0 = [1, 2, 3]; }`

use proc_macro2::{Delimiter, Group, TokenTree};

use super::super::ast::{Assumption, Parameter, ParameterDefault, Spec};
use super::super::cursor::{Cursor, Read, tokens_of};
use super::coordinates::pair;
use super::{declared, documentation};
use crate::diagnostics::Location;

const HELP: &str =
    "a parameter is written `m;`, `m > 0;`, `m >= 0 = 1;`, `m != 0;` or `m in [a, b] = c;`";

/// Reads one parameter or family.
pub(super) fn parameter(cursor: &mut Cursor<'_>, spec: &mut Spec) -> Read<()> {
    let documentation = documentation(cursor)?;
    if !matches!(cursor.peek(), Some(TokenTree::Ident(_))) {
        return Err(cursor.unexpected("expected the name of a parameter", HELP));
    }
    let declared = declared(cursor, "the name of a parameter")?;
    let assumption = assumption(cursor)?;
    let default = default(cursor)?;
    if !cursor.is_at_end() && default.is_none() {
        let last = cursor.last();
        return Err(cursor.refuse(last, "expected `;`", HELP));
    }
    let item = spec.item(declared.name.at);
    spec.parameters.push(Parameter {
        declared,
        documentation,
        assumption,
        default,
        item,
    });
    Ok(())
}

fn assumption(cursor: &mut Cursor<'_>) -> Read<Assumption> {
    for (operator, assumption) in [
        (">", Assumption::Positive),
        (">=", Assumption::NonNegative),
        ("!=", Assumption::NonZero),
    ] {
        if cursor.eat_operator(operator).is_some() {
            zero(cursor)?;
            return Ok(assumption);
        }
    }
    if cursor.is_operator("<") || cursor.is_operator("<=") || cursor.is_operator(":") {
        return Err(cursor.unexpected("expected an assumption", HELP));
    }
    if !cursor.eat_word("in") {
        return Ok(Assumption::Finite);
    }
    let Some(group) = cursor.eat_group(Delimiter::Bracket) else {
        return Err(cursor.unexpected("expected a closed interval `[a, b]`", HELP));
    };
    let ends = pair(cursor, group, "the ends of an interval")?;
    Ok(Assumption::Within(Box::new(ends)))
}

/// The `0` that an assumption compares with.
fn zero(cursor: &mut Cursor<'_>) -> Read<()> {
    if let Some(TokenTree::Literal(literal)) = cursor.peek()
        && literal.to_string().parse() == Ok(0.0)
    {
        cursor.bump();
        return Ok(());
    }
    Err(cursor.unexpected("`>`, `>=` and `!=` compare a parameter with 0 only", HELP))
}

fn default(cursor: &mut Cursor<'_>) -> Read<Option<ParameterDefault>> {
    if cursor.eat_operator("=").is_none() {
        return Ok(None);
    }
    if let Some(TokenTree::Group(group)) = cursor.peek()
        && group.delimiter() == Delimiter::Parenthesis
        && is_list(group)
    {
        let at = cursor.here();
        let tokens = tokens_of(group.stream());
        let list = cursor.inside(&tokens, group).list()?;
        let list: Vec<String> = list.iter().map(ToString::to_string).collect();
        let help = format!("write `[{}]`", list.join(", "));
        return Err(cursor.refuse(at, "a list of defaults stands in brackets", &help));
    }
    let Some(group) = cursor.eat_group(Delimiter::Bracket) else {
        let value = cursor.scalar()?;
        if cursor.comparison().is_some() {
            return Err(cursor.unexpected("expected `;`", HELP));
        }
        return Ok(Some(ParameterDefault::One(value)));
    };
    let tokens = tokens_of(group.stream());
    let list = cursor.inside(&tokens, group).list()?;
    Ok(Some(ParameterDefault::List(
        list,
        Location::from(group.span()),
    )))
}

/// True if a comma separates the tokens of a group.
fn is_list(group: &Group) -> bool {
    let is_comma =
        |token: &TokenTree| matches!(token, TokenTree::Punct(punct) if punct.as_char() == ',');
    group.stream().into_iter().any(|token| is_comma(&token))
}
