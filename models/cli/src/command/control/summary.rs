//! Text summary of the extremals.

use std::io::{self, Write};

use dalembert_driver::{Extremal, SecondOrder};

use super::Finished;
use crate::{ends, error, names};

/// Writes the summary.
pub(super) fn write(output: &mut dyn Write, finished: &Finished<'_>) -> io::Result<()> {
    let controlled = &finished.controlled;
    writeln!(output, "{}", title(finished))?;
    writeln!(output, "  from        {}", start(finished))?;
    writeln!(output, "  to          {}", end(finished))?;
    let directions = error::counted(controlled.directions, "direction");
    let runs = error::counted(controlled.runs as usize, "run");
    writeln!(output, "  search      {directions}, {runs}")?;
    writeln!(output, "  coverage    {}", doubt(finished))?;
    writeln!(
        output,
        "  found       {}",
        counted(controlled.extremals.iter())
    )?;
    for (index, extremal) in controlled.extremals.iter().enumerate() {
        writeln!(output)?;
        write_extremal(output, finished, index + 1, extremal)?;
    }
    Ok(())
}

/// The model and its scene.
pub(super) fn title(finished: &Finished<'_>) -> String {
    names::titled(finished.description(), finished.scene)
}

/// Subtitle: the start and the end of the task.
pub(super) fn subtitle(finished: &Finished<'_>) -> String {
    format!("from {} to {}", start(finished), end(finished))
}

fn start(finished: &Finished<'_>) -> String {
    assignments(finished.states(), &finished.task.from)
}

/// The end of the task: its given components and its time.
pub(super) fn end(finished: &Finished<'_>) -> String {
    let task = &finished.task;
    let given = finished.states().zip(&task.to);
    let given = given.filter_map(|(name, to)| to.map(|to| format!("{name} = {to:?}")));
    let given: Vec<String> = given.collect();
    let state = match given.is_empty() {
        true => "a free end".to_owned(),
        false => given.join(", "),
    };
    format!("{state} at t = {}", task.time)
}

/// Number of extremals, in total and by number of impacts.
pub(super) fn counted<'a>(extremals: impl Iterator<Item = &'a Extremal>) -> String {
    let mut counts: Vec<usize> = extremals.map(|it| it.kicks.len()).collect();
    counts.sort_unstable();
    let groups = counts.chunk_by(|left, right| left == right);
    let groups = groups.map(|group| {
        let impacts = error::counted(group[0], "impact");
        format!("{} with {impacts}", group.len())
    });
    match counts.len() {
        0 => "no extremal".to_owned(),
        count => {
            let groups: Vec<String> = groups.collect();
            let all = error::counted(count, "extremal");
            format!("{all}: {}", groups.join(", "))
        }
    }
}

/// Reasons why the search is not exhaustive.
fn doubt(finished: &Finished<'_>) -> String {
    let controlled = &finished.controlled;
    let mut doubts = ends::doubts(controlled.unresolved, controlled.given_up);
    if controlled.is_out_of_reach() {
        let moved = controlled.rounding;
        doubts += &format!(
            "; rounding of the costate moves the end by {moved:.0e} of its size: use a shorter --until"
        );
    }
    format!("a scan samples costates, so extremals may be missed{doubts}")
}

/// Result of the second-order test: a keyword and a sentence.
pub(super) fn verdict(extremal: &Extremal) -> (&'static str, String) {
    match extremal.second_order {
        SecondOrder::Minimum => (
            "minimum",
            "minimum: neighbouring motions with these impacts cost more".to_owned(),
        ),
        SecondOrder::Fails { t } => (
            "fails",
            format!("fails near t = {t:.4}: some neighbouring motions cost less"),
        ),
        SecondOrder::Open => ("open", "open".to_owned()),
    }
}

fn write_extremal(
    output: &mut dyn Write,
    finished: &Finished<'_>,
    number: usize,
    extremal: &Extremal,
) -> io::Result<()> {
    let impacts = error::counted(extremal.kicks.len(), "impact");
    let cost = extremal.cost;
    writeln!(output, "  extremal {number}  {impacts}, cost {cost:?}")?;
    let costate = assignments(finished.states(), &extremal.first.costate);
    writeln!(output, "    costate   {costate}")?;
    let state = assignments(finished.states(), &extremal.last.state);
    writeln!(output, "    end       {state}")?;
    for kick in &extremal.kicks {
        let surface = names::surfaces(finished.description()).nth(kick.surface);
        let surface = surface.unwrap_or_default();
        writeln!(output, "    impact    t = {:?}, {surface}", kick.before.t)?;
    }
    writeln!(output, "    residual  {:.1e}", extremal.residual)?;
    writeln!(output, "    second    {}", verdict(extremal).1)
}

/// Values with their names: `x = 1.0, y = 2.0`.
fn assignments(names: impl Iterator<Item = &'static str>, values: &[f64]) -> String {
    let pairs = names.zip(values);
    let parts: Vec<String> = pairs
        .map(|(name, value)| format!("{name} = {value:?}"))
        .collect();
    parts.join(", ")
}
