//! A branch in a few lines of text, and its points as a table.

use std::io::{self, Write};

use dalembert_driver::{BifurcationCurve, Branch, Member};

use super::super::summary::{complex, head, tell_missed};
use super::spreadsheet::{components, values};
use super::{Followed, reason};
use crate::error::counted;
use crate::scalar::{full, short};

/// Writes the summary.
///
/// # Errors
/// An I/O error of the stream.
pub fn write(output: &mut dyn Write, followed: &Followed<'_>) -> io::Result<()> {
    head(output, &followed.finished)?;
    let (name, [first, last]) = (followed.name(), followed.request.extent.range);
    writeln!(output, "  continued    {name} from {first} to {last}")?;
    if let (Some(name), Some(across)) = (followed.across(), &followed.request.across) {
        let [first, last] = across.range;
        writeln!(output, "  across       {name} from {first} to {last}")?;
    }
    let branch = match &followed.finished.result {
        Err(missed) => return tell_missed(output, &followed.finished, missed),
        Ok(branch) => branch,
    };
    if branch.points.is_empty() {
        let text = reason(followed, &branch.ends[0]);
        writeln!(output, "  outcome      out_of_reach")?;
        return writeln!(output, "  reason       on the way to the range: {text}");
    }
    let count = counted(branch.points.len(), "point");
    writeln!(output, "  outcome      {count}")?;
    for member in &branch.points {
        if let Some(bifurcation) = member.bifurcation {
            let kind = bifurcation.name();
            writeln!(output, "  {kind:<14} {}", located(followed, member))?;
        }
    }
    let ends = [
        ("first end", branch.points.first()),
        ("last end", branch.points.last()),
    ];
    for ((title, member), end) in ends.into_iter().zip(&branch.ends) {
        let at = member.map_or(f64::NAN, |member| member.parameter);
        let text = reason(followed, end);
        writeln!(output, "  {title:<12} {name} = {at}: {text}")?;
    }
    for (index, curve) in branch.curves.iter().enumerate() {
        write_curve(output, followed, index + 1, curve)?;
    }
    write_table(output, followed, branch)
}

/// Writes a curve of bifurcations: its kind, and its ends in the plane of both parameters.
fn write_curve(
    output: &mut dyn Write,
    followed: &Followed<'_>,
    number: usize,
    curve: &BifurcationCurve,
) -> io::Result<()> {
    let (kind, count) = (
        curve.bifurcation.name(),
        counted(curve.points.len(), "point"),
    );
    writeln!(output, "  curve {number:<6} {kind}, {count}")?;
    let names = [Some(followed.name()), followed.across()].map(Option::unwrap_or_default);
    let ends = [curve.points.first(), curve.points.last()];
    for (member, end) in ends.into_iter().zip(&curve.ends) {
        let at = member.map_or(String::new(), |member| {
            let second = member.second.unwrap_or(f64::NAN);
            format!(
                "{} = {}, {} = {second}: ",
                names[0], member.parameter, names[1]
            )
        });
        writeln!(output, "    end        {at}{}", reason(followed, end))?;
    }
    Ok(())
}

/// `alpha = .., period .., multipliers ..`
fn located(followed: &Followed<'_>, member: &Member) -> String {
    format!(
        "{} = {}, period {}, multipliers {}",
        followed.name(),
        member.parameter,
        member.period,
        multipliers(member, full)
    )
}

fn multipliers(member: &Member, number: impl Fn(f64) -> String + Copy) -> String {
    let told = member.multipliers.iter();
    let told: Vec<String> = told
        .map(|&multiplier| complex(multiplier, number))
        .collect();
    told.join(", ")
}

/// The bifurcations with their values of the parameter.
pub fn bifurcations(followed: &Followed<'_>) -> String {
    let Ok(branch) = &followed.finished.result else {
        return String::new();
    };
    let told = branch.points.iter().filter_map(|member| {
        let kind = member.bifurcation?.name();
        Some(format!(
            "{kind} at {} = {:.9}",
            followed.name(),
            member.parameter
        ))
    });
    let told: Vec<String> = told.collect();
    match told.is_empty() {
        true => "no bifurcation".to_owned(),
        false => told.join("; "),
    }
}

/// Writes a row for each point, under a line of names.
fn write_table(output: &mut dyn Write, followed: &Followed<'_>, branch: &Branch) -> io::Result<()> {
    let description = followed.finished.model.description();
    let mut head = vec![followed.name().to_owned(), "period".to_owned()];
    head.extend(components(description));
    head.extend(["stability", "multipliers", ""].map(str::to_owned));
    let mut rows = vec![head];
    rows.extend(branch.points.iter().map(|member| {
        let numbers = [member.parameter, member.period];
        let numbers = numbers
            .into_iter()
            .chain(values(description, &member.before));
        let mut row: Vec<String> = numbers.map(short).collect();
        row.push(member.stability.name().to_owned());
        row.push(multipliers(member, short));
        row.push(member.bifurcation.map_or("", |it| it.name()).to_owned());
        row
    }));
    let width = |column: usize| rows.iter().map(|row| row[column].chars().count()).max();
    let widths: Vec<usize> = (0..rows[0].len())
        .map(|it| width(it).unwrap_or(0))
        .collect();
    writeln!(output)?;
    for row in &rows {
        let cells = row.iter().zip(&widths);
        let line: Vec<String> = cells
            .map(|(cell, width)| format!("{cell:<width$}"))
            .collect();
        writeln!(output, "  {}", line.join("  ").trim_end())?;
    }
    Ok(())
}
