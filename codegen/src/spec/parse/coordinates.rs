//! `coordinates { x; theta: angle; u in (0, pi); theta[N]: angle; }`

use proc_macro2::{Delimiter, Group, TokenTree};

use super::super::ast::{Coordinate, Declared, Scalar, Spec, Topology, Word};
use super::super::cursor::{Cursor, Read, tokens_of};
use super::{declared, documentation};

/// Reads the section, which may not be empty.
pub(super) fn section(keyword: &Word, cursor: &mut Cursor<'_>, spec: &mut Spec) -> Read<()> {
    let errors = cursor.diagnostics.len();
    super::section(keyword, cursor, spec, coordinate)?;
    if spec.coordinates.is_empty() && cursor.diagnostics.len() == errors {
        let help = "write `coordinates { x; theta: angle; }`";
        cursor.refuse(keyword.at, "a model needs at least one coordinate", help);
    }
    Ok(())
}

fn coordinate(cursor: &mut Cursor<'_>, spec: &mut Spec) -> Read<()> {
    let documentation = documentation(cursor)?;
    let declared = declared(cursor, "the name of a coordinate")?;
    let topology = topology(cursor, &declared)?;
    let item = spec.item(declared.name.at);
    spec.coordinates.push(Coordinate {
        declared,
        documentation,
        topology,
        item,
    });
    Ok(())
}

fn topology(cursor: &mut Cursor<'_>, declared: &Declared) -> Read<Topology> {
    const HELP: &str = "a coordinate is written `x;`, `x: angle;` or `x in (a, b);`";
    if cursor.is_at_end() {
        return Ok(Topology::Line);
    }
    if cursor.eat_operator(":").is_some() {
        if cursor.eat_word("angle") {
            check_end_of_angle(cursor, &declared.name)?;
            return Ok(Topology::Angle);
        }
        return Err(cursor.unexpected("expected `angle`", HELP));
    }
    if cursor.eat_word("in") {
        let Some(group) = cursor.eat_group(Delimiter::Parenthesis) else {
            return Err(cursor.unexpected("expected an open interval `(a, b)`", HELP));
        };
        let ends = pair(cursor, group, "the ends of an interval")?;
        return Ok(Topology::Interval(Box::new(ends)));
    }
    if cursor.is_operator(",") || cursor.is_operator(".") {
        return cursor.end().map(|()| Topology::Line);
    }
    let last = cursor.last();
    Err(cursor.refuse(last, "expected `;`", HELP))
}

/// Refuses tokens after `angle`: the size of a family belongs to its name, and an angle has no interval.
fn check_end_of_angle(cursor: &mut Cursor<'_>, name: &Word) -> Read<()> {
    if let Some(TokenTree::Group(group)) = cursor.peek()
        && group.delimiter() == Delimiter::Bracket
    {
        let at = cursor.here();
        let tokens = tokens_of(group.stream());
        let size = cursor.inside(&tokens, group).whole_scalar()?;
        let help = format!("write `{}[{size}]: angle`", name.text);
        return Err(cursor.refuse(at, "the size of a family follows its name", &help));
    }
    if cursor.is_word("in") {
        let help = format!(
            "an angle takes all values on a circle; write `{}: angle;` or `{} in (a, b);`",
            name.text, name.text
        );
        return Err(cursor.unexpected("expected `;`", &help));
    }
    Ok(())
}

/// The two expressions in a group.
pub(super) fn pair(cursor: &mut Cursor<'_>, group: &Group, what: &str) -> Read<[Scalar; 2]> {
    let tokens = tokens_of(group.stream());
    let list = cursor.inside(&tokens, group).list()?;
    let count = list.len();
    <[Scalar; 2]>::try_from(list).map_err(|_| {
        let at = group.span().into();
        cursor.refuse(
            at,
            format!("{what} are two expressions, found {count}"),
            "write `(a, b)`",
        )
    })
}
