//! `coordinates { x; theta: angle; u in (0, pi); theta[N]: angle; }`

use proc_macro2::{Delimiter, Group};

use super::super::ast::{Coordinate, Scalar, Spec, Topology, Word};
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
    let topology = topology(cursor)?;
    let item = spec.item(declared.name.at);
    spec.coordinates.push(Coordinate {
        declared,
        documentation,
        topology,
        item,
    });
    Ok(())
}

fn topology(cursor: &mut Cursor<'_>) -> Read<Topology> {
    const HELP: &str = "a coordinate is written `x;`, `x: angle;` or `x in (a, b);`";
    if cursor.is_at_end() {
        return Ok(Topology::Line);
    }
    if cursor.eat_operator(":").is_some() {
        if cursor.eat_word("angle") {
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
    let last = cursor.last();
    Err(cursor.refuse(last, "expected `;`", HELP))
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
