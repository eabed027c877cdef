//! Dynamic programming in a few lines of text.

use std::io::{self, Write};

use super::Finished;
use super::path::{Compared, Path};
use super::problem::Problem;
use crate::error::counted;
use crate::names;

/// Writes the summary.
pub(super) fn write(output: &mut dyn Write, finished: &Finished) -> io::Result<()> {
    let Finished {
        problem,
        solution,
        paths,
    } = finished;
    writeln!(output, "{}", title(problem))?;
    writeln!(output, "  grid        {}", grid(problem))?;
    let [motions, lost] = solution.motions;
    let motions = counted(motions, "motion");
    writeln!(
        output,
        "  motions     {motions} over a step, {lost} of them do not reach its end"
    )?;
    let nodes = counted(problem.lattice.count(), "node");
    writeln!(
        output,
        "  known       {} of {nodes} at t = 0",
        solution.known()
    )?;
    for (index, path) in paths.iter().enumerate() {
        writeln!(output)?;
        write_path(output, problem, index + 1, path)?;
    }
    Ok(())
}

/// The model and its scene.
pub(super) fn title(problem: &Problem) -> String {
    names::titled(problem.model.description(), &problem.scene)
}

/// The axes and the steps.
pub(super) fn grid(problem: &Problem) -> String {
    let axes = problem.lattice.axes.iter().chain([&problem.inputs]);
    let axes = problem.names().into_iter().zip(axes);
    let axes: Vec<String> = axes
        .map(|(name, axis)| {
            let [first, last] = axis.ends;
            format!("{name} = {first}..{last}:{}", axis.count)
        })
        .collect();
    let steps = counted(problem.steps, "step");
    format!("{}; {steps} to t = {}", axes.join(", "), problem.time)
}

/// The numbers of impacts of the paths.
pub(super) fn outcome(finished: &Finished) -> String {
    let paths = finished.paths.iter();
    let ends = paths.map(|path| match path.left {
        Some(_) => "left the grid".to_owned(),
        None => counted(path.hits.len(), "impact"),
    });
    let ends: Vec<String> = ends.collect();
    format!("{}: {}", counted(ends.len(), "path"), ends.join(", "))
}

/// A state.
pub(super) fn state(problem: &Problem, state: [f64; 2]) -> String {
    let [x, y, ..] = problem.names();
    format!("{x} = {:?}, {y} = {:?}", state[0], state[1])
}

fn write_path(
    output: &mut dyn Write,
    problem: &Problem,
    number: usize,
    path: &Path,
) -> io::Result<()> {
    let Some(first) = path.moments.first() else {
        return writeln!(
            output,
            "  path {number}      no motion from its start stays on the grid"
        );
    };
    writeln!(
        output,
        "  path {number}      from {}",
        state(problem, first.state)
    )?;
    if let Some(t) = path.left {
        return writeln!(output, "    left      the grid at t = {t:?}");
    }
    let impacts = counted(path.hits.len(), "impact");
    writeln!(output, "    cost      {:?}, {impacts}", path.cost)?;
    writeln!(output, "    by grid   {:?}", path.expected)?;
    if let Some(end) = path.end() {
        writeln!(output, "    end       {}", state(problem, end))?;
    }
    match &path.compared {
        Compared::Not => Ok(()),
        Compared::None(reason) => writeln!(output, "    extremal  none: {reason}"),
        Compared::Best(extremal) => {
            let impacts = counted(extremal.kicks.len(), "impact");
            let more = path.cost - extremal.cost;
            writeln!(
                output,
                "    extremal  {:?}, {impacts}: the cheapest of --impacts {}; the path costs {more:.1e} more",
                extremal.cost, problem.impacts
            )
        }
    }
}
