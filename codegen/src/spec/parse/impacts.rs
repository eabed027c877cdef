//! `impacts { wall: h >= 0 when g > 0 => restitution(0.8); }`

use proc_macro2::Delimiter;

use super::super::ast::{Comparison, Law, Scalar, Spec, Surface};
use super::super::cursor::{Cursor, Read, tokens_of};
use super::{labelled, refused_word};

const FORM: &str = "name: h >= 0 when g > 0 => LAW;";

/// Reads one surface.
pub(super) fn surface(cursor: &mut Cursor<'_>, spec: &mut Spec) -> Read<()> {
    let (documentation, declared) = labelled(cursor, "the name of a surface", FORM)?;
    let gap = comparison(cursor, Strictness::Weak)?;
    let mut conditions = Vec::new();
    while cursor.eat_word("when") {
        conditions.push(comparison(cursor, Strictness::Strict)?);
        if cursor.is_operator("&&") || cursor.is_operator(",") {
            return Err(cursor.unexpected("expected `when`", "write `when a > 0 when b > 0`"));
        }
    }
    let law = law(cursor)?;
    let item = spec.item(gap.at);
    spec.surfaces.push(Surface {
        declared,
        documentation,
        gap,
        conditions,
        law,
        item,
    });
    Ok(())
}

/// Whether equality is allowed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Strictness {
    /// `>=`, `<=`
    Weak,
    /// `>`, `<`
    Strict,
}

/// Reads `a >= b`, `a <= b`, or the same without equality.
pub(super) fn comparison(cursor: &mut Cursor<'_>, strictness: Strictness) -> Read<Comparison> {
    let (greater, less, wrong) = match strictness {
        Strictness::Weak => (">=", "<=", [">", "<", "=="]),
        Strictness::Strict => (">", "<", [">=", "<=", "=="]),
    };
    let left = cursor.scalar()?;
    if let Some(sign) = wrong.into_iter().find(|sign| cursor.is_operator(sign)) {
        let text = format!("expected `{greater}` or `{less}`, found `{sign}`");
        return Err(cursor.refuse_operator(sign, text, &format!("write `{FORM}`")));
    }
    let turned = if cursor.eat_operator(greater).is_some() {
        false
    } else if cursor.eat_operator(less).is_some() {
        true
    } else {
        let text = format!("expected `{greater}` or `{less}`");
        return Err(cursor.unexpected(&text, &format!("write `{FORM}`")));
    };
    let right = cursor.scalar()?;
    Ok(oriented(left, right, turned))
}

fn oriented(left: Scalar, right: Scalar, turned: bool) -> Comparison {
    let at = left.at.to(right.at);
    let (greater, less) = if turned { (right, left) } else { (left, right) };
    Comparison { greater, less, at }
}

/// Reads `=> LAW`, if it is there.
fn law(cursor: &mut Cursor<'_>) -> Read<Option<Law>> {
    if cursor.eat_operator("=>").is_none() {
        return Ok(None);
    }
    refused_word(cursor, &["reset"])?;
    let name = cursor.name("an impact law")?;
    let arguments = match cursor.eat_group(Delimiter::Parenthesis) {
        Some(group) => {
            let tokens = tokens_of(group.stream());
            cursor.inside(&tokens, group).list()?
        }
        None => Vec::new(),
    };
    if cursor.eat_operator(",").is_some() {
        refused_word(cursor, &["instantaneous"])?;
        return Err(cursor.unexpected("expected `;`", FORM));
    }
    if cursor.is_word("when") {
        return Err(cursor.unexpected(
            "expected `;`",
            &format!("conditions stand before the law: `{FORM}`"),
        ));
    }
    Ok(Some(Law { name, arguments }))
}
