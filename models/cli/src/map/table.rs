//! The table of a map: its columns, and the row of a cell.

use std::borrow::Cow;

use super::cell::{Cell, FAILED, RETURNED};
use super::orbits::Orbits;
use super::request::{Colours, Request};
use dalembert_driver::ensemble::Members;
use dalembert_driver::ensemble::row::{Columns, Field, INPUT, Kind, Row};

/// The column of a coordinate or a velocity at the end.
pub fn end(name: &str) -> String {
    format!("end.{name}")
}

/// The column of an expression of `--output`.
pub fn output(name: &str) -> String {
    format!("out.{name}")
}

/// The columns of a map.
pub fn columns(request: &Request, members: &Members) -> Columns {
    let mut columns = vec![("member".to_owned(), Kind::Integer)];
    let mut add = |name: String, kind: Kind| columns.push((name, kind));
    for name in members.names() {
        add(format!("{INPUT}{name}"), Kind::Number);
    }
    add("class".to_owned(), Kind::Text);
    add("outcome".to_owned(), Kind::Text);
    for name in ["returns", "period", "orbit"] {
        add(name.to_owned(), Kind::Integer);
    }
    add("t".to_owned(), Kind::Number);
    for name in &request.components.names {
        add(end(name), Kind::Number);
    }
    if request.has_exponent() {
        add("exponent".to_owned(), Kind::Number);
    }
    if matches!(request.colours, Colours::Value(_)) {
        add("value".to_owned(), Kind::Number);
    }
    for (name, _) in &request.outputs {
        add(output(name), Kind::Number);
    }
    for index in 1..=request.contours.len() {
        add(format!("contour.{index}"), Kind::Number);
    }
    add("reason".to_owned(), Kind::Text);
    Columns::new(columns)
}

/// The row of a cell. If its orbit is new, it gets the next number.
pub fn row(members: &Members, member: u64, cell: &Cell, request: &Request, orbits: &Orbits) -> Row {
    let orbit = match cell.cycle.is_empty() || request.is_bifurcating {
        true => 0,
        false => orbits.number(&cell.cycle, &request.components),
    };
    let number = |value: f64| Field::Number(value);
    let mut row = vec![Field::Integer(member)];
    row.extend(members.values(member).into_iter().map(number));
    row.push(Field::Text(Cow::Owned(class(cell, orbit, request))));
    row.push(Field::Text(Cow::Borrowed(cell.outcome)));
    let counts = [cell.returns, cell.cycle.len() as u64, orbit];
    row.extend(counts.map(Field::Integer));
    row.push(number(cell.t));
    row.extend(cell.end.iter().copied().map(number));
    if request.has_exponent() {
        row.push(number(cell.exponent));
    }
    if matches!(request.colours, Colours::Value(_)) {
        row.push(number(cell.value));
    }
    row.extend(cell.outputs.iter().copied().map(number));
    row.extend(cell.contours.iter().copied().map(number));
    row.push(Field::Text(Cow::Owned(cell.reason.clone())));
    row
}

/// The class of a cell.
fn class(cell: &Cell, orbit: u64, request: &Request) -> String {
    match (cell.outcome, cell.cycle.len(), orbit) {
        (RETURNED, 0, _) => "unsettled".to_owned(),
        (RETURNED, period, 0) => format!("period {period}"),
        (RETURNED, period, orbit) => format!("orbit {orbit} (period {period})"),
        (FAILED, ..) if cell.returns == 0 && request.returns.is_some() => {
            "failed at once".to_owned()
        }
        (outcome, ..) => match cell.stop {
            Some(surface) => format!("stopped at {surface}"),
            None => outcome.to_owned(),
        },
    }
}
