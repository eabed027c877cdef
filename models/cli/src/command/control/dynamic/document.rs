//! Dynamic programming as one JSON document.

use std::io::{self, Write};

use dalembert_driver::Axis;
use serde_json::{Value, json};

use super::Finished;
use super::path::{Compared, Path};
use super::problem::Problem;
use crate::json::{Document, named, number};
use crate::names;

/// Writes the document.
pub(super) fn write(output: &mut dyn Write, finished: &Finished) -> io::Result<()> {
    let Finished {
        problem,
        solution,
        paths,
    } = finished;
    let model = problem.model.as_ref();
    let mut document = Document::of_model(output, model, &problem.scene)?;
    document.field("time", number(problem.time))?;
    document.field("steps", problem.steps)?;
    let axes = problem.lattice.axes.into_iter().chain([problem.inputs]);
    let axes = problem.names().into_iter().zip(axes);
    document.rows("axes", axes.map(|(name, axis)| of_axis(name, axis)))?;
    let [motions, lost] = solution.motions;
    document.field("motions", json!({ "made": motions, "lost": lost }))?;
    document.rows("paths", paths.iter().map(|path| of_path(problem, path)))?;
    document.field("at", number(problem.at(solution.step)))?;
    let nodes = (0..problem.lattice.count()).map(|node| {
        let [x, y] = problem.lattice.node(node);
        let [cost, input, impacts] = solution.shown(node);
        let values = [x, y, cost, input, impacts];
        Value::from(values.map(number).to_vec())
    });
    document.rows("nodes", nodes)?;
    document.end()
}

fn of_axis(name: &str, axis: Axis) -> Value {
    json!({
        "name": name,
        "first": number(axis.ends[0]),
        "last": number(axis.ends[1]),
        "count": axis.count,
    })
}

fn of_path(problem: &Problem, path: &Path) -> Value {
    let of_state = |state: [f64; 2]| named(problem.names().into_iter().take(2), &state);
    let surface = |index| names::surfaces(problem.model.description()).nth(index);
    let impacts = path.hits.iter().map(|hit| {
        json!({
            "t": number(hit.t),
            "surface": surface(hit.surface),
            "before": of_state(hit.states[0]),
            "after": of_state(hit.states[1]),
        })
    });
    let extremal = match &path.compared {
        Compared::Best(extremal) => json!({
            "cost": number(extremal.cost),
            "impacts": extremal.kicks.len(),
        }),
        Compared::None(reason) => json!({ "reason": reason }),
        Compared::Not => Value::Null,
    };
    json!({
        "start": path.moments.first().map(|it| of_state(it.state)),
        "cost": number(path.cost),
        "by_grid": number(path.expected),
        "end": path.end().map(of_state),
        "left": path.left,
        "impacts": impacts.collect::<Vec<_>>(),
        "extremal": extremal,
    })
}
