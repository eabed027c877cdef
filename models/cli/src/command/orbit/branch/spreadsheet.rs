//! A branch, or the curves of its bifurcations, as CSV: one row per point.

use std::io::{self, Write};

use dalembert::describe::Description;
use dalembert_driver::{Branch, Member, Point};

use super::Followed;
use crate::names;
use crate::table::write_rows;

/// Writes the table: the points of the branch or, with a second parameter, the points of the bifurcation curves.
///
/// # Errors
/// An I/O error of the stream.
pub fn write(output: &mut dyn Write, followed: &Followed<'_>, branch: &Branch) -> io::Result<()> {
    let description = followed.finished.model.description();
    write_rows(output, |writer| {
        writer.write_record(head(followed, branch))?;
        if followed.request.across.is_none() {
            let mut rows = branch.points.iter().map(|member| row(description, member));
            return rows.try_for_each(|row| writer.write_record(row));
        }
        for (index, curve) in branch.curves.iter().enumerate() {
            for member in &curve.points {
                let mut row = row(description, member);
                row.insert(0, (index + 1).to_string());
                row.insert(2, format!("{:?}", member.second.unwrap_or(f64::NAN)));
                writer.write_record(row)?;
            }
        }
        Ok(())
    })
}

fn head(followed: &Followed<'_>, branch: &Branch) -> Vec<String> {
    let components = components(followed.finished.model.description());
    let curve = followed.across().map(|_| "curve".to_owned());
    let mut head: Vec<String> = curve.into_iter().collect();
    let parameters = [Some(followed.name()), followed.across()];
    head.extend(
        parameters
            .into_iter()
            .flatten()
            .map(|name| format!("in.{name}")),
    );
    head.push("period".to_owned());
    for side in ["before", "after"] {
        head.extend(components.iter().map(|name| format!("{side}.{name}")));
    }
    let count = branch.points.first().map_or(0, |it| it.multipliers.len());
    for index in 1..=count {
        head.extend(["re", "im"].map(|part| format!("multiplier.{index}.{part}")));
    }
    head.extend(["stability", "bifurcation", "residual"].map(str::to_owned));
    let count = branch.points.first().map_or(0, |it| it.element.len());
    head.extend((1..=count).map(|index| format!("advance.{index}")));
    head
}

fn row(description: &Description, member: &Member) -> Vec<String> {
    let states = [&member.before, &member.after];
    let states = states
        .into_iter()
        .flat_map(|point| values(description, point));
    let numbers = [member.parameter, member.period].into_iter().chain(states);
    let numbers = numbers.chain(member.multipliers.iter().flatten().copied());
    let bifurcation = member.bifurcation.map_or("", |it| it.name());
    let words = [member.stability.name().to_owned(), bifurcation.to_owned()];
    // `Debug` writes the shortest decimal that parses to the same number, with an exponent if that is shorter.
    let mut row: Vec<String> = numbers.map(|number| format!("{number:?}")).collect();
    row.extend(words);
    row.push(format!("{:?}", member.residual));
    row.extend(member.element.iter().map(|factor| format!("{factor:?}")));
    row
}

/// The names of coordinates and, unless the system is of first order, velocities.
pub fn components(description: &Description) -> Vec<String> {
    let coordinates = names::coordinates(description);
    let mut components: Vec<String> = coordinates.clone().map(str::to_owned).collect();
    if !description.is_first_order {
        components.extend(coordinates.map(names::velocity));
    }
    components
}

/// The values of the [`components`] at a point.
pub fn values(description: &Description, point: &Point) -> Vec<f64> {
    let mut values = point.q.clone();
    if !description.is_first_order {
        values.extend(&point.qdot);
    }
    values
}
