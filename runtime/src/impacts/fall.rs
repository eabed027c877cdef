//! Location of the first fall of one gap along a step: on its polynomial if that has a bounded error, otherwise by
//! enclosures.

use core::cell::RefCell;

use super::root::Polynomial;
use super::search::{gap_at, rounding_along};
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
pub(super) struct Known<'a, G: StateVector> {
    /// The polynomials of all gaps, if the step is a power series.
    pub(super) series: Option<&'a GapSeries<G>>,
    /// The gap at both ends.
    pub(super) ends: [f64; 2],
    /// Taylor model of the gap on the whole step.
    pub(super) whole: Option<TaylorModel>,
    /// The gap at a start that counts as 0: the gap is measured from there.
    pub(super) offset: f64,
}

/// The largest magnitudes of the components, which give the rounding errors of a gap.
pub(super) enum Sizes<S> {
    Known(S),
    /// Those up to this fraction of the step, for these sizes at its start; computed when they are first needed. The motion
    /// behind a hit does not take place.
    Until(f64, S),
}

impl<S: StateVector> Sizes<S> {
    /// The magnitudes along the path of the step.
    pub(super) fn along(&mut self, path: &mut Path<S>) -> &S {
        if let Self::Until(until, at_start) = *self {
            path.enclose();
            let mut sizes = at_start;
            for (i, size) in sizes.as_mut_slice().iter_mut().enumerate() {
                let range = path.component(i, [0.0, until]).range();
                *size = size.abs().max(range.magnitude());
            }
            *self = Self::Known(sizes);
        }
        let (Self::Known(sizes) | Self::Until(_, sizes)) = self;
        sizes
    }
}

/// The first fall of a gap, with its time to the last bits. If the polynomial of the gap does not show that there is
/// one fall or none, enclosures of the gap decide.
pub(super) fn first_fall<Sys: Impacting, Step: Stepper<Sys>>(
    surface: usize,
    step: &mut StepView<'_, Sys, Step>,
    path: &mut Path<Sys::State>,
    sizes: &mut Sizes<Sys::State>,
    Known {
        series,
        ends,
        whole,
        offset,
    }: Known<'_, Sys::Gaps>,
    start: Start,
) -> Search {
    let (mut evaluations, mut more, mut enclosures) = (0, 0, 0);
    let mut gap = |part: f64| {
        evaluations += 1;
        gap_at(surface, step, part) - offset
    };
    let path = RefCell::new(path);
    let mut along = |part: [f64; 2]| {
        let certain = series.filter(|series| series.is_certain(surface));
        let model = certain.and_then(|series| series.on(surface, part));
        let mut model = model.unwrap_or_else(|| {
            enclosures += 1;
            let mut path = path.borrow_mut();
            path.enclose();
            let component = |i: usize| path.component(i, part);
            step.system
                .gap_along(surface, path.time_model(part), &component)
        });
        model.powers[0] -= offset;
        model
    };
    let mut rounding = |part: f64| {
        let sizes = sizes.along(&mut path.borrow_mut());
        rounding_along(surface, step, part, sizes, &mut more)
    };
    let plain = series.map_or(Plain::Unknown, |series| {
        plain_fall(surface, series, start, &mut gap)
    });
    let known = match plain {
        Plain::Certain(found) => {
            step.counters.event_evaluations += evaluations;
            return found;
        }
        Plain::Likely(bracket) => Some(bracket),
        Plain::Unknown => None,
    };
    let line = Line {
        gap: &mut gap,
        along: &mut along,
        whole,
        ends,
        rounding: &mut rounding,
        start,
        known,
    };
    let found = match (known, line.first_fall()) {
        (Some(known), Search::Clear) => Search::Falls(known),
        (_, found) => found,
    };
    step.counters.event_evaluations += evaluations + more;
    step.counters.enclosures += enclosures;
    found
}

/// Result of the search on a polynomial.
enum Plain {
    Certain(Search),
    /// A fall that may not be the first.
    Likely(Bracket),
    Unknown,
}

/// The fall of a polynomial with one root in the whole step, or in its first part. Values of the gap correct the root.
fn plain_fall<G: StateVector>(
    surface: usize,
    series: &GapSeries<G>,
    start: Start,
    gap: &mut dyn FnMut(f64) -> f64,
) -> Plain {
    let is_certain = series.is_certain(surface);
    let is_plain = start.from == 0.0 && start.above && (is_certain || series.is_close);
    if !is_plain {
        return Plain::Unknown;
    }
    let at_hand = start.slope.is_some();
    let polynomial = Polynomial::new(series, surface, at_hand);
    let end = match series.signs(surface, at_hand) {
        Signs::Falls => Some(1.0),
        Signs::Positive if is_certain => return Plain::Certain(Search::Clear),
        Signs::Unclear => polynomial.first_fall(),
        _ => None,
    };
    let Some(end) = end else {
        return Plain::Unknown;
    };
    if start.until < end && series.is_positive(surface, start.until) {
        return match is_certain {
            true => Plain::Certain(Search::Clear),
            false => Plain::Unknown,
        };
    }
    match polynomial.fall([0.0, end], gap) {
        Some((bracket, true)) if is_certain => Plain::Certain(Search::Falls(bracket)),
        Some((bracket, _)) => Plain::Likely(bracket),
        None => Plain::Unknown,
    }
}
