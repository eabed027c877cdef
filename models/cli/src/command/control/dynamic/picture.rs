//! Pictures of dynamic programming: a map with paths on it, or paths over time.

use dalembert_driver::Axis;

use super::path::{Moment, Path};
use super::problem::Problem;
use super::{Finished, summary};
use crate::args::{ControlArgs, Shown};
use crate::error::CliError;
use crate::plot::contour::Window;
use crate::plot::field::{self, Field, Meaning};
use crate::plot::paths::{self, Sheet};
use crate::{names, symbols};

/// Checks the flags of the picture.
///
/// # Errors
/// An unknown quantity of --axes.
pub(super) fn check(problem: &Problem, args: &ControlArgs) -> Result<(), CliError> {
    quantities(problem, args).map(drop)
}

/// The picture.
///
/// # Errors
/// An error of the drawing library.
pub(super) fn draw(finished: &Finished, args: &ControlArgs) -> Result<String, CliError> {
    let quantities = quantities(&finished.problem, args)?;
    let drawn = match quantities {
        Some(quantities) => draw_paths(finished, args, &quantities),
        None => draw_map(finished, args),
    };
    drawn.map_err(|reason| CliError::picture(&args.plot, reason))
}

/// Indices of the quantities of --axes in [`values`]; `None` without --axes.
fn quantities(problem: &Problem, args: &ControlArgs) -> Result<Option<Vec<usize>>, CliError> {
    let Some(axes) = &args.axes else {
        return Ok(None);
    };
    let accepted = ["t"].into_iter().chain(problem.names());
    let find = |name: &str| names::find("--axes", "quantity", name.trim(), accepted.clone());
    let found: Vec<usize> = axes.split(',').map(find).collect::<Result<_, CliError>>()?;
    match found.len() {
        0 | 1 => Err(CliError::value(
            "--axes",
            axes,
            "an abscissa and at least one ordinate, such as t,cost",
        )),
        _ => Ok(Some(found)),
    }
}

/// Time, state, input and cost so far.
fn values(moment: &Moment) -> [f64; 5] {
    let [x, y] = moment.state;
    [moment.t, x, y, moment.input, moment.cost]
}

fn draw_paths(
    finished: &Finished,
    args: &ControlArgs,
    quantities: &[usize],
) -> Result<String, String> {
    let problem = &finished.problem;
    let of = |moment: &Moment| -> Vec<f64> {
        let values = values(moment);
        quantities.iter().map(|&index| values[index]).collect()
    };
    let mut drawn: Vec<paths::Path> = Vec::new();
    for path in &finished.paths {
        let stretches = stretches(path).into_iter();
        drawn.push(paths::Path {
            impacts: path.hits.len(),
            stretches: stretches.map(|it| it.iter().map(of).collect()).collect(),
        });
    }
    drawn.sort_by_key(|path| path.impacts);
    let names: Vec<&str> = ["t"].into_iter().chain(problem.names()).collect();
    paths::draw(&Sheet {
        title: &summary::title(problem),
        subtitle: &summary::grid(problem),
        names: quantities
            .iter()
            .map(|&it| symbols::text(names[it]))
            .collect(),
        width: f64::from(args.plot_width),
        paths: &drawn,
        envelope: &[],
    })
}

/// The moments of a path, divided at its impacts. The states before and after an impact belong to the stretches on
/// either side.
fn stretches(path: &Path) -> Vec<Vec<Moment>> {
    let mut stretches = Vec::new();
    let mut stretch = Vec::new();
    let mut hits = path.hits.iter().peekable();
    for pair in path.moments.chunks(2) {
        let [first, last] = pair else { continue };
        stretch.push(*first);
        while let Some(hit) = hits.next_if(|hit| hit.t <= last.t) {
            let share = (hit.t - first.t) / (last.t - first.t);
            let side = |state| Moment {
                t: hit.t,
                state,
                input: first.input,
                cost: first.cost + share * (last.cost - first.cost),
            };
            stretch.push(side(hit.states[0]));
            stretches.push(std::mem::take(&mut stretch));
            stretch.push(side(hit.states[1]));
        }
        stretch.push(*last);
    }
    stretches.push(stretch);
    stretches
}

fn draw_map(finished: &Finished, args: &ControlArgs) -> Result<String, String> {
    let (problem, solution) = (&finished.problem, &finished.solution);
    let [x, y, input, _] = problem.names();
    let (column, meaning) = match args.dynamic.show {
        Shown::Cost => (0, Meaning::Number("least cost")),
        Shown::Input => (1, Meaning::Number(input)),
        Shown::Impacts => (2, Meaning::Impacts),
    };
    let nodes = 0..problem.lattice.count();
    let values: Vec<f64> = nodes.map(|node| solution.shown(node)[column]).collect();
    let states = finished.paths.iter().map(|path| {
        let stretches = stretches(path).into_iter();
        stretches
            .map(|it| it.iter().map(|moment| moment.state).collect())
            .collect()
    });
    let [columns, rows] = problem.lattice.axes;
    let half = |axis: Axis| {
        let half = 0.5 * axis.step();
        [axis.ends[0] - half, axis.ends[1] + half]
    };
    let time = problem.at(solution.step);
    field::draw(&Field {
        title: &format!("{} at t = {time}", summary::title(problem)),
        subtitle: &summary::grid(problem),
        names: [x, y].map(symbols::text),
        width: f64::from(args.plot_width),
        window: Window {
            x: half(columns),
            y: half(rows),
        },
        counts: [columns.count, rows.count],
        values: &values,
        meaning,
        paths: &states.collect::<Vec<_>>(),
    })
}
