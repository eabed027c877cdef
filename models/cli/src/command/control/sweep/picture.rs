//! Costs of extremals over a varied quantity: for each number of impacts a line of the least cost, and dots for all
//! extremals.

use super::summary::subtitle;
use super::{Sweep, cheapest};
use crate::args::ControlArgs;
use crate::error::{self, CliError};
use crate::plot::curves::{self, Chart, Curve};
use crate::symbols;

/// Draws the costs.
///
/// # Errors
/// An error of the drawing library.
pub(super) fn draw(sweep: &Sweep<'_>, args: &ControlArgs) -> Result<String, CliError> {
    let values: Vec<f64> = sweep.members.iter().map(|member| member.value).collect();
    let mut made = sweep.made();
    let title = made
        .next()
        .map(|(_, finished)| super::super::summary::title(finished));
    let chart = Chart {
        title: &title.unwrap_or_default(),
        subtitle: &subtitle(sweep),
        axes: [&symbols::text(&sweep.name), "cost"],
        values: &values,
        curves: sweep
            .impacts()
            .map(|impacts| curve(sweep, impacts))
            .collect(),
        width: args.plot_width,
    };
    curves::draw(&chart).map_err(|reason| CliError::picture(&args.plot, reason))
}

/// The costs of the extremals with this number of impacts. The line of the least cost is broken at values without such
/// an extremal.
fn curve(sweep: &Sweep<'_>, impacts: usize) -> Curve {
    let mut stretches = vec![Vec::new()];
    for member in &sweep.members {
        let finished = member.found.as_ref().ok();
        let least = finished.and_then(|finished| cheapest(finished, impacts));
        match (least, stretches.last_mut()) {
            (Some(extremal), Some(stretch)) => stretch.push([member.value, extremal.cost]),
            _ => stretches.push(Vec::new()),
        }
    }
    let points = sweep.made().flat_map(|(value, finished)| {
        let extremals = finished.controlled.extremals.iter();
        let with = extremals.filter(|extremal| extremal.kicks.len() == impacts);
        with.map(move |extremal| [value, extremal.cost])
    });
    Curve {
        label: error::counted(impacts, "impact"),
        colour: impacts,
        points: points.collect(),
        stretches,
    }
}
