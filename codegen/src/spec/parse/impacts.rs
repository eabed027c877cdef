//! `impacts { wall: h >= 0 when g > 0 => restitution(0.8); }`

use proc_macro2::{Delimiter, TokenTree};

use super::super::ast::{Comparison, Law, Scalar, Spec, Surface, Word};
use super::super::cursor::{Cursor, Read, Refused, tokens_of};
use super::super::keyword::{LAWS, OTHERWISE, RESET};
use super::{instantaneous, labelled, reset};
use crate::diagnostics::listed;

const FORM: &str = "name: h >= 0 when g > 0 => LAW;";

/// Reads one surface.
pub(super) fn surface(cursor: &mut Cursor<'_>, spec: &mut Spec) -> Read<()> {
    let (documentation, declared) = labelled(cursor, "a surface", FORM)?;
    let gap = comparison(cursor, Strictness::Weak, FORM)?;
    let (conditions, is_otherwise) = conditions(cursor, FORM)?;
    let law = law(cursor, spec, FORM)?;
    let instantaneous = instantaneous::equations(cursor, spec, law.as_ref())?;
    let item = spec.item(gap.at);
    spec.surfaces.push(Surface {
        declared,
        documentation,
        gap,
        conditions,
        is_otherwise,
        law,
        enters: None,
        instantaneous,
        item,
    });
    Ok(())
}

/// Reads `when a > 0 when b > 0` or `otherwise`, or nothing. True for `otherwise`.
pub(super) fn conditions(cursor: &mut Cursor<'_>, form: &str) -> Read<(Vec<Comparison>, bool)> {
    const ALONE: &str = "`otherwise` is the only condition: the surface counts where no other surface with the same gap counts";
    let mut conditions = Vec::new();
    if cursor.eat_word(OTHERWISE) {
        if cursor.is_word("when") {
            return Err(cursor.unexpected("expected `=>` or `;`", ALONE));
        }
        return Ok((conditions, true));
    }
    while cursor.eat_word("when") {
        if cursor.is_word(OTHERWISE) {
            return Err(
                cursor.unexpected("expected a comparison", "write `otherwise` without `when`")
            );
        }
        conditions.push(comparison(cursor, Strictness::Either, form)?);
        if cursor.is_word(OTHERWISE) {
            return Err(cursor.unexpected("expected `=>` or `;`", ALONE));
        }
        if cursor.is_operator("&&") || cursor.is_operator(",") {
            return Err(cursor.unexpected("expected `when`", "write `when a > 0 when b > 0`"));
        }
    }
    Ok((conditions, false))
}

/// Operators that a comparison may have.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Strictness {
    /// `>=`, `<=`
    Weak,
    /// `>`, `<`, `>=`, `<=`
    Either,
}

/// Reads `a >= b` or `a <= b`, or the strict forms if they are allowed. `form` is the form of the whole entry, for
/// messages.
pub(super) fn comparison(
    cursor: &mut Cursor<'_>,
    strictness: Strictness,
    form: &str,
) -> Read<Comparison> {
    let (signs, wrong): (&[&str], &[&str]) = match strictness {
        Strictness::Weak => (&[">=", "<="], &[">", "<", "==", "!=", "=>", "=<", "="]),
        Strictness::Either => (&[">=", "<=", ">", "<"], &["==", "!=", "=>", "=<", "="]),
    };
    let left = cursor.scalar()?;
    let expected = listed_with_or(signs);
    if let Some(sign) = wrong.iter().find(|sign| cursor.is_operator(sign)) {
        let text = format!("expected {expected}, found `{sign}`");
        return Err(cursor.refuse_operator(sign, text, &format!("write `{form}`")));
    }
    let Some(sign) = signs
        .iter()
        .find(|sign| cursor.eat_operator(sign).is_some())
    else {
        let text = format!("expected {expected}");
        return Err(cursor.unexpected(&text, &format!("write `{form}`")));
    };
    let right = cursor.scalar()?;
    if let Some(second) = cursor.comparison() {
        return Err(chained(cursor, [&left, &right], second, sign, strictness));
    }
    Ok(oriented(left, right, sign))
}

/// `` `a`, `b` or `c` ``
fn listed_with_or(signs: &[&str]) -> String {
    let quoted: Vec<String> = signs.iter().map(|sign| format!("`{sign}`")).collect();
    match quoted.split_last() {
        Some((last, others)) if !others.is_empty() => format!("{} or {last}", others.join(", ")),
        _ => quoted.concat(),
    }
}

/// Refuses a second comparison after the first: `0 <= x <= 1`, or two joined comparisons.
fn chained(
    cursor: &mut Cursor<'_>,
    [left, middle]: [&Scalar; 2],
    second: &str,
    first: &str,
    strictness: Strictness,
) -> Refused {
    let at = cursor.here();
    if cursor.eat_operator(second).is_none() {
        return Refused;
    }
    let at = at.to(cursor.last());
    if matches!(second, "&&" | "||" | "&" | "|") {
        let help = match strictness {
            Strictness::Weak => "write a surface for each, or a condition: `x >= 0 when y > 0`",
            Strictness::Either => "several conditions are written `when a > 0 when b > 0`",
        };
        return cursor.refuse(
            at,
            format!("comparisons are not joined with `{second}`"),
            help,
        );
    }
    let Ok(right) = cursor.scalar() else {
        return Refused;
    };
    let help = match strictness {
        Strictness::Weak => {
            format!("write two surfaces, `{left} {first} {middle}` and `{middle} {second} {right}`")
        }
        Strictness::Either => {
            format!("write `when {left} {first} {middle} when {middle} {second} {right}`")
        }
    };
    cursor.refuse(at, "one comparison is expected, found two", &help)
}

fn oriented(left: Scalar, right: Scalar, sign: &str) -> Comparison {
    let at = left.at.to(right.at);
    let (greater, less) = match sign.starts_with('<') {
        true => (right, left),
        false => (left, right),
    };
    Comparison {
        greater,
        less,
        is_closed: sign.ends_with('='),
        at,
    }
}

/// Reads `=> LAW`, or nothing. `form` is the form of the whole entry, for messages.
pub(super) fn law(cursor: &mut Cursor<'_>, spec: &mut Spec, form: &str) -> Read<Option<Law>> {
    if let Some(sign) = ["->", ",", ":"]
        .into_iter()
        .find(|sign| cursor.is_operator(sign))
    {
        let text = format!("expected `=>`, found `{sign}`");
        return Err(cursor.refuse_operator(sign, text, &format!("write `{form}`")));
    }
    if cursor.eat_operator("=>").is_none() {
        return Ok(None);
    }
    if !matches!(cursor.peek(), Some(TokenTree::Ident(_))) {
        let help = match cursor.peek() {
            Some(TokenTree::Group(group)) if group.delimiter() == Delimiter::Brace => {
                "a map of the state is written `=> reset { dot(x) = -dot(x); }`".to_owned()
            }
            _ => format!("the laws are {}", listed(LAWS.map(|(law, _)| law))),
        };
        return Err(cursor.unexpected("expected an impact law", &help));
    }
    let name = cursor.name("an impact law")?;
    let (arguments, assignments) = match name.text == RESET {
        true => (Vec::new(), Some(reset::assignments(cursor)?)),
        false => (arguments(cursor, &name)?, None),
    };
    if cursor.is_word("when") {
        return Err(cursor.unexpected(
            "expected `;`",
            &format!("conditions stand before the law: `{form}`"),
        ));
    }
    let item = spec.item(name.at);
    Ok(Some(Law {
        name,
        arguments,
        assignments,
        item,
    }))
}

/// The coefficients of a law.
fn arguments(cursor: &mut Cursor<'_>, law: &Word) -> Read<Vec<Scalar>> {
    if let Some(group) = cursor.eat_group(Delimiter::Parenthesis) {
        let tokens = tokens_of(group.stream());
        return cursor.inside(&tokens, group).list();
    }
    let takes_one = LAWS.contains(&(law.text.as_str(), 1));
    let goes_on = !cursor.is_at_end() && !cursor.is_operator(",") && !cursor.is_word("when");
    if takes_one && goes_on {
        let coefficient = match cursor.peek() {
            Some(TokenTree::Literal(written)) => written.to_string(),
            _ => "0.8".to_owned(),
        };
        let text = "the coefficient of a law stands in parentheses";
        let help = format!("write `{}({coefficient})`", law.text);
        return Err(cursor.refuse(cursor.here(), text, &help));
    }
    Ok(Vec::new())
}
