//! Times inside a step at which a coordinate leaves the interval of its chart, from enclosures of the coordinate along
//! the step.

use crate::contract::{Chart, System};
use crate::effects::StepView;
use crate::events::first::{Onset, onset};
use crate::events::path::Path;
use crate::integrate::Stepper;
use crate::outcome::Outcome;
use crate::state::StateVector;

/// Margin of the cubic through the ends of a step whose inner rates are unknown, as a multiple of the cubic's range.
const NEAR: f64 = 4.0;

/// Exit of a coordinate from the interval of its chart, inside a step.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Exit {
    /// The last fraction of the step inside the chart, and the first outside.
    pub onset: Onset,
    /// Index of the coordinate that leaves.
    pub coordinate: usize,
}

/// The first fraction of the step in `[0, reach]` at which a coordinate is outside its chart.
///
/// # Errors
/// Faults of the dense output.
pub(crate) fn exit<Sys: System, Step: Stepper<Sys>>(
    step: &mut StepView<'_, Sys, Step>,
    reach: f64,
) -> Result<Option<Exit>, Outcome> {
    let system = step.system;
    let start = *step.start();
    let charts = || (0..).map_while(|number| system.chart(&start, number));
    if charts().next().is_none() || !step.stepper.dense_ready() && stays_inside(step, charts()) {
        return Ok(None);
    }
    let mut path = Path::new(&start);
    path.refine(step)?;
    path.enclose();
    let is_inside = |part: [f64; 2]| {
        let mut charts = charts();
        charts.all(|Chart { coordinate, ends }| {
            let range = path.component(coordinate, part).range();
            ends[0] < range.lo && range.hi < ends[1]
        })
    };
    let found = onset(reach, is_inside, |part| outside(step, part).is_some());
    Ok(found.and_then(|onset| {
        let coordinate = outside(step, onset.after)?;
        Some(Exit { onset, coordinate })
    }))
}

/// The coordinate that is outside its chart at a fraction of a step with dense output.
pub(crate) fn outside<Sys: System, Step: Stepper<Sys>>(
    step: &StepView<'_, Sys, Step>,
    part: f64,
) -> Option<usize> {
    step.system.outside_chart(&step.state(part))
}

/// True if the cubics through the ends of the step, widened by the deviation of the inner rates, stay inside all
/// charts.
fn stays_inside<Sys: System, Step: Stepper<Sys>>(
    step: &StepView<'_, Sys, Step>,
    mut charts: impl Iterator<Item = Chart>,
) -> bool {
    let mut sway = None;
    charts.all(|Chart { coordinate, ends }| {
        let at = |state: &Sys::State| state.as_slice()[coordinate];
        let (first, last) = (at(step.start()), at(step.end()));
        let thirds = step.rates().map(|rate| step.length() * at(rate) / 3.0);
        let hull = [first, first + thirds[0], last - thirds[1], last];
        let lowest = hull.into_iter().fold(f64::INFINITY, f64::min);
        let highest = hull.into_iter().fold(f64::NEG_INFINITY, f64::max);
        let apart = match sway.get_or_insert_with(|| step.stepper.sway()) {
            Some(sway) => at(sway),
            None => NEAR * (highest - lowest),
        };
        ends[0] < lowest - apart && highest + apart < ends[1]
    })
}
