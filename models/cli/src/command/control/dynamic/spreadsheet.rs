//! Dynamic programming as CSV: a row for each node, and the first path.

use std::io::{self, Write};

use super::Finished;
use crate::table;

/// Writes state, least cost, best input and number of impacts of each node.
pub(super) fn write(output: &mut dyn Write, finished: &Finished) -> io::Result<()> {
    let (problem, solution) = (&finished.problem, &finished.solution);
    let [x, y, input, cost] = problem.names();
    table::write_rows(output, |writer| {
        writer.write_record([x, y, cost, input, "impacts"])?;
        for node in 0..problem.lattice.count() {
            let [x, y] = problem.lattice.node(node);
            let [cost, input, impacts] = solution.shown(node);
            let values = [x, y, cost, input, impacts];
            writer.write_record(values.map(number))?;
        }
        Ok(())
    })
}

/// Writes time, state, input and cost so far at both ends of each step of the first path.
pub(super) fn write_path(output: &mut dyn Write, finished: &Finished) -> io::Result<()> {
    let [x, y, input, cost] = finished.problem.names();
    let moments = finished.paths.first().map_or(&[][..], |path| &path.moments);
    table::write_rows(output, |writer| {
        writer.write_record(["t", x, y, cost, input])?;
        for moment in moments {
            let [x, y] = moment.state;
            let values = [moment.t, x, y, moment.cost, moment.input];
            writer.write_record(values.map(number))?;
        }
        Ok(())
    })
}

/// A number; an unknown one is empty.
fn number(value: f64) -> String {
    match value.is_nan() {
        true => String::new(),
        false => format!("{value:?}"),
    }
}
