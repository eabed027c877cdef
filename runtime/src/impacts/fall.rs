//! The first fall of one gap along a step: on its polynomial where there is one, on the gap itself where that does not
//! tell.

use super::root::Polynomial;
use super::search::rounding_along;
use super::series::GapSeries;
use crate::contract::Impacting;
use crate::effects::StepView;
use crate::events::crossing::{SAMPLES, Signs};
use crate::events::locate::{Line, Search, Start};
use crate::integrate::Stepper;
use crate::state::StateVector;

/// What is known of the gap of a surface along a step.
pub(super) enum Known<'a, G> {
    /// The polynomials of all gaps, and the signs of its own over the whole step.
    Series(&'a GapSeries<G>, Signs),
    /// Samples.
    Samples([f64; SAMPLES]),
}

/// The first fall of a gap, with its time to the last bits. On a series it is looked for on the polynomial; what is
/// not a plain fall there is left to the gap itself.
pub(super) fn first_fall<Sys: Impacting, Step: Stepper<Sys>>(
    surface: usize,
    step: &mut StepView<'_, Sys, Step>,
    sizes: &Sys::State,
    known: &Known<'_, Sys::Gaps>,
    start: Start,
) -> Search {
    let (mut evaluations, mut more) = (0, 0);
    let mut gap = |part: f64| {
        evaluations += 1;
        step.system
            .gaps(step.time(part), &step.state(part))
            .as_slice()[surface]
    };
    let mut rounding = || rounding_along(surface, step, sizes, &mut more);
    let found = match known {
        Known::Samples(whole) => Line {
            gap: &mut gap,
            rounding: &mut rounding,
            whole,
            start,
        }
        .first_fall(),
        Known::Series(series, signs) => {
            let plain = plain_fall(surface, series, *signs, start, &mut gap);
            plain.unwrap_or_else(|| {
                let whole = &series.samples(surface);
                let found = first_on_series(surface, series, whole, start, &mut rounding, &mut gap);
                found.unwrap_or_else(|| {
                    let line = Line {
                        gap: &mut gap,
                        rounding: &mut rounding,
                        whole,
                        start,
                    };
                    line.first_fall()
                })
            })
        }
    };
    step.counters.event_evaluations += evaluations + more;
    found
}

/// The fall of a polynomial that has one root in the whole step, or in its beginning, corrected on the gap.
fn plain_fall<G: StateVector>(
    surface: usize,
    series: &GapSeries<G>,
    signs: Signs,
    start: Start,
    gap: &mut dyn FnMut(f64) -> f64,
) -> Option<Search> {
    let is_plain = start.from == 0.0 && start.above;
    if !(is_plain && matches!(signs, Signs::Falls | Signs::Unclear)) {
        return None;
    }
    let polynomial = Polynomial::new(series, surface, start.slope.is_some());
    let end = match signs {
        Signs::Falls => 1.0,
        _ => polynomial.first_fall()?,
    };
    if start.until < end && series.is_positive(surface, start.until) {
        return Some(Search::Clear);
    }
    polynomial.fall([0.0, end], gap).map(Search::Falls)
}

/// The first fall of the polynomial of a gap with these samples, corrected on the gap.
fn first_on_series<G: StateVector>(
    surface: usize,
    series: &GapSeries<G>,
    whole: &[f64; SAMPLES],
    start: Start,
    rounding: &mut dyn FnMut() -> f64,
    gap: &mut dyn FnMut(f64) -> f64,
) -> Option<Search> {
    // At the end the gap itself: it may be negative by rounding where the polynomial is not.
    let mut on_series = |part: f64| match part >= 1.0 {
        true => whole[SAMPLES - 1],
        false => series.at(surface, part),
    };
    let line = Line {
        gap: &mut on_series,
        rounding,
        whole,
        start,
    };
    match line.first_interval() {
        Ok(ends) => {
            let fall = Polynomial::new(series, surface, start.slope.is_some()).fall(ends, gap);
            fall.map(Search::Falls)
        }
        Err(Search::Clear) => Some(Search::Clear),
        Err(_) => None,
    }
}
