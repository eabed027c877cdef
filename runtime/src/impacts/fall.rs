//! The first fall of one gap along a step: estimated on its polynomial if there is one, and proved to be the first by
//! enclosures.

use super::root::Polynomial;
use super::search::rounding_along;
use super::series::GapSeries;
use crate::contract::Impacting;
use crate::effects::StepView;
use crate::events::crossing::Signs;
use crate::events::locate::{Bracket, Line, Search, Start};
use crate::events::path::Path;
use crate::integrate::Stepper;
use crate::numbers::TaylorModel;
use crate::state::StateVector;

/// Known data of a gap along a step.
#[derive(Debug, Clone, Copy)]
pub(super) struct Known<'a, G> {
    /// The polynomials of all gaps, if the step is a power series.
    pub(super) series: Option<&'a GapSeries<G>>,
    /// The gap at both ends.
    pub(super) ends: [f64; 2],
    /// Taylor model of the gap on the whole step.
    pub(super) whole: Option<TaylorModel>,
}

/// The first fall of a gap, with its time to the last bits. For a series it is searched on the polynomial; enclosures
/// of the gap itself show that none precedes it.
pub(super) fn first_fall<Sys: Impacting, Step: Stepper<Sys>>(
    surface: usize,
    step: &mut StepView<'_, Sys, Step>,
    path: &Path<Sys::State>,
    sizes: &Sys::State,
    Known {
        series,
        ends,
        whole,
    }: Known<'_, Sys::Gaps>,
    start: Start,
) -> Search {
    let (mut evaluations, mut more, mut enclosures) = (0, 0, 0);
    let mut gap = |part: f64| {
        evaluations += 1;
        step.system
            .gaps(step.time(part), &step.state(part))
            .as_slice()[surface]
    };
    let mut along = |part: [f64; 2]| {
        enclosures += 1;
        let component = |i: usize| path.component(i, part);
        step.system
            .gap_along(surface, path.time_model(part), &component)
    };
    let mut rounding = |part: f64| rounding_along(surface, step, part, sizes, &mut more);
    let plain = series.and_then(|series| plain_fall(surface, series, start, &mut gap));
    let line = Line {
        gap: &mut gap,
        along: &mut along,
        whole,
        ends,
        rounding: &mut rounding,
        start,
        known: plain,
    };
    let found = match (plain, line.first_fall()) {
        (Some(plain), Search::Clear) => Search::Falls(plain),
        (_, found) => found,
    };
    step.counters.event_evaluations += evaluations + more;
    step.counters.enclosures += enclosures;
    found
}

/// The fall of a polynomial that has one root in the whole step, or in its beginning, corrected with the gap.
fn plain_fall<G: StateVector>(
    surface: usize,
    series: &GapSeries<G>,
    start: Start,
    gap: &mut dyn FnMut(f64) -> f64,
) -> Option<Bracket> {
    let is_plain = start.from == 0.0 && start.above;
    if !is_plain {
        return None;
    }
    let at_hand = start.slope.is_some();
    let polynomial = Polynomial::new(series, surface, at_hand);
    let end = match series.signs(surface, at_hand) {
        Signs::Falls => 1.0,
        Signs::Unclear => polynomial.first_fall()?,
        _ => return None,
    };
    if start.until < end && series.is_positive(surface, start.until) {
        return None;
    }
    polynomial.fall([0.0, end], gap)
}
