//! Event location: the first fall of a gap through zero inside a step, and its time to the last bits.
//!
//! The step is searched stretch by stretch from its start. A Taylor model of the gap on the stretch, or on a longer
//! one, decides each stretch. A gap that the model encloses away from zero has no fall there. For a gap whose rates
//! have one sign, the signs at the ends show the fall. Undecided stretches are halved until rounding decides. If a
//! stretch is undecided because of the remainder of the last model, a new model is computed.

use super::crossing::Signs;
use super::piece::Piece;
use super::resolution::least_on;
use super::stretches::{Region, Stretches};
use crate::numbers::TaylorModel;

/// Maximum number of halvings. The ends of a stretch of `2^-40` of a step decide it.
const DEPTH: u32 = 40;

/// Number of halvings after which the rounding of the gap is evaluated.
const DOUBTFUL: u32 = 3;

/// Maximum number of stretches; the search stops there, and the step is cut.
const STRETCHES: u32 = 4096;

/// A change of sign is a pole if the gap next to it exceeds the gap elsewhere in the step by this factor.
const PEAK: f64 = (1 << 10) as f64;

/// Start of a search.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Start {
    /// Fraction of the step at which it begins.
    pub from: f64,
    /// True if the motion comes from the allowed side.
    pub above: bool,
    /// For a motion that starts on the surface, the gap's slope at the start of the step; the root at the start is
    /// divided out.
    pub slope: Option<f64>,
    /// Fraction of the step after which falls are ignored.
    pub until: f64,
}

impl Start {
    /// Start after a fall or a pole, where the gap is negative.
    pub(crate) fn behind(from: f64, until: f64) -> Self {
        Self {
            from,
            above: false,
            slope: None,
            until,
        }
    }
}

/// Two fractions of a step that bracket a fall: the gap is not negative at `before`, and negative at `after`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Bracket {
    pub before: f64,
    pub after: f64,
    /// The end of the bracket with the gap closer to 0.
    pub nearest: f64,
}

/// Result of a search.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Search {
    /// No fall in the searched part of the step.
    Clear,
    /// The first fall, bracketed by neighbouring numbers or nearly so.
    Falls(Bracket),
    /// The gap goes from zero (within rounding) to clearly negative at this fraction; 0 if it never rises from the
    /// surface.
    Sinks(f64),
    /// The gap changes sign at a pole before this fraction.
    Pole(f64),
    /// The search stopped at this fraction.
    Unfinished(f64),
}

/// The gap of one surface along a step.
// NOTE: the functions are behind pointers, so that the long search is compiled once instead of for every system and
// integrator.
pub(crate) struct Line<'a> {
    /// The gap at a fraction of the step.
    pub gap: &'a mut dyn FnMut(f64) -> f64,
    /// A Taylor model of the gap between two fractions of the step.
    pub along: &'a mut dyn FnMut([f64; 2]) -> TaylorModel,
    /// Taylor model on the whole step, if known.
    pub whole: Option<TaylorModel>,
    /// The gap at the start and at the end of the step.
    pub ends: [f64; 2],
    /// Size of the gap's rounding errors at a fraction of the step; evaluated for few fractions.
    pub rounding: &'a mut dyn FnMut(f64) -> f64,
    /// Start of the search.
    pub start: Start,
    /// A known fall. It is the first fall unless another precedes it.
    pub known: Option<Bracket>,
}

/// The region in which the rounding of the gap was last evaluated, and its value there.
struct Floors(Option<(Region, f64)>);

impl Floors {
    /// The rounding somewhere near a stretch. It may be far larger than on the stretch, if the gap is steep elsewhere in
    /// the region: no stretch may be passed over because of it.
    fn near(&mut self, stretches: &Stretches, rounding: &mut dyn FnMut(f64) -> f64) -> f64 {
        let region = stretches.region();
        match self.0 {
            Some((known, floor)) if known == region => floor,
            _ => {
                let [left, right] = stretches.ends();
                let floor = rounding(0.5 * (left + right));
                self.0 = Some((region, floor));
                floor
            }
        }
    }
}

/// A fraction of the step with the gap there.
#[derive(Debug, Clone, Copy)]
struct Place {
    x: f64,
    gap: f64,
}

/// The gap on a stretch of the step.
#[derive(Debug, Clone, Copy)]
struct View {
    span: [f64; 2],
    model: TaylorModel,
}

impl View {
    fn piece(&self, ends: [f64; 2]) -> Piece {
        Piece::of(&self.model, self.span, ends)
    }

    fn holds(&self, [left, right]: [f64; 2]) -> bool {
        self.span[0] <= left && right <= self.span[1]
    }
}

/// A stretch on which the gap falls once, and an estimate of the fall as a fraction of the stretch.
struct Fall {
    before: Place,
    after: Place,
    guess: f64,
}

/// Result of a successful isolation.
enum Isolated {
    Fall(Fall),
    /// The known fall.
    Known(Bracket),
}

impl Fall {
    fn between(before: Place, after: Place) -> Self {
        let part = match before.gap > 0.0 && before.gap - after.gap < f64::INFINITY {
            true => before.gap / (before.gap - after.gap),
            false => 0.5,
        };
        Self {
            before,
            after,
            guess: part,
        }
    }
}

impl Line<'_> {
    /// Finds the first fall.
    pub(crate) fn first_fall(mut self) -> Search {
        match self.isolate() {
            Ok(Isolated::Fall(fall)) => self.narrow(fall),
            Ok(Isolated::Known(bracket)) => Search::Falls(bracket),
            Err(search) => search,
        }
    }

    /// Isolates the first fall, stretch by stretch; undecided stretches are halved.
    fn isolate(&mut self) -> Result<Isolated, Search> {
        let mut above = self.start.above;
        let mut rose = self.start.slope.is_none();
        let mut floors = Floors(None);
        let mut high: Option<Place> = None;
        let mut known: Option<Place> = None;
        let limits = [self.start.from, self.start.until];
        if limits[1] <= limits[0] {
            return Err(Search::Clear);
        }
        let coarse = match self.whole {
            Some(model) => View {
                span: [0.0, 1.0],
                model,
            },
            None => self.view(limits),
        };
        let mut fine = coarse;
        let mut stretches = Stretches::of(limits, self.expected(&coarse.piece(limits)));
        for _ in 0..STRETCHES {
            let ends = stretches.ends();
            let depth = stretches.depth();
            let [left, right] = ends;
            let is_at_hand = left == 0.0 && self.start.slope.is_some();
            let view = match fine.holds(ends) {
                true => fine,
                false => coarse,
            };
            let mut piece = view.piece(ends);
            let is_doubtful = depth >= DOUBTFUL;
            let mut signs = self.signs(&piece, ends, is_at_hand, is_doubtful, &mut known);
            if signs == Signs::Unclear
                && view.span != ends
                && (is_clear(&piece.without_remainder(), is_at_hand)
                    || !piece.is_sharper_than(match is_doubtful {
                        true => floors.near(&stretches, self.rounding),
                        false => f64::INFINITY,
                    }))
            {
                fine = self.view(ends);
                piece = fine.piece(ends);
                signs = self.signs(&piece, ends, is_at_hand, is_doubtful, &mut known);
            }
            match signs {
                Signs::Positive | Signs::Rises => {
                    (above, rose) = (true, true);
                    high = known
                        .filter(|place| place.x == right && place.gap > 0.0)
                        .or(high);
                }
                Signs::Falls => {
                    if let Some(bracket) = self.known
                        && left < bracket.before
                        && bracket.after < right
                    {
                        return Ok(Isolated::Known(bracket));
                    }
                    let before = self.place_at(left, &mut known);
                    let after = self.place_at(right, &mut known);
                    return Ok(Isolated::Fall(Fall {
                        guess: piece.fall(),
                        before,
                        after,
                    }));
                }
                Signs::Negative => {
                    if above {
                        let low = self.place_at(right, &mut known);
                        let mut floor = floors.near(&stretches, self.rounding);
                        if low.gap >= -floor {
                            floor = least_on(ends, &mut *self.rounding);
                        }
                        if low.gap < -floor {
                            return Self::sunk(
                                ends,
                                rose,
                                high.filter(|high| high.gap > floor),
                                low,
                            );
                        }
                    }
                }
                Signs::Unclear => {
                    if !is_doubtful {
                        stretches.halve();
                        continue;
                    }
                    let mut floor = floors.near(&stretches, self.rounding);
                    // A gap that rises from zero beyond rounding is not flat, however soon it falls.
                    let rises = is_at_hand && self.start.slope.is_some_and(|slope| slope > floor);
                    if rises && depth < DEPTH {
                        stretches.halve();
                        continue;
                    }
                    let before = self.place_at(left, &mut known);
                    let after = self.place_at(right, &mut known);
                    let gaps = [if is_at_hand { 0.0 } else { before.gap }, after.gap];
                    let mut is_flat = match rises {
                        true => None,
                        false => is_within(floor, &piece, gaps),
                    };
                    if is_flat.is_some() {
                        floor = least_on(ends, &mut *self.rounding);
                        is_flat = is_within(floor, &piece, gaps);
                    }
                    match is_flat {
                        // The gap leaves zero, upwards or downwards, without an excursion to the other side.
                        Some(Signs::Positive) => {
                            (above, rose) = (true, true);
                            high = Some(after);
                        }
                        Some(Signs::Negative) if above => {
                            return Self::sunk(
                                ends,
                                rose,
                                high.filter(|high| high.gap > floor),
                                after,
                            );
                        }
                        Some(_) => {}
                        None if depth < DEPTH => {
                            stretches.halve();
                            continue;
                        }
                        // The gap rises and falls within the resolution of the fractions of a step.
                        None if is_at_hand && after.gap < 0.0 => {
                            return Err(Search::Sinks(right));
                        }
                        None if above && before.gap >= 0.0 && after.gap < 0.0 => {
                            return Ok(Isolated::Fall(Fall::between(before, after)));
                        }
                        None => {}
                    }
                }
            }
            if !stretches.advance() {
                return Err(Search::Clear);
            }
        }
        Err(Search::Unfinished(stretches.ends()[0]))
    }

    /// Estimate of the first fall from the gap's cubic.
    fn expected(&self, piece: &Piece) -> Option<f64> {
        let Start {
            from, above, until, ..
        } = self.start;
        if let Some(bracket) = self.known {
            return Some(bracket.nearest);
        }
        let is_at_hand = from == 0.0 && self.start.slope.is_some();
        let part = match is_at_hand {
            true => piece.fall_from_zero(),
            false => piece.first_fall(),
        };
        part.filter(|_| above)
            .map(|part| from + part * (until - from))
    }

    fn view(&mut self, span: [f64; 2]) -> View {
        View {
            span,
            model: (self.along)(span),
        }
    }

    /// The signs of the gap on a stretch. Evaluates the gap at its ends if they may decide.
    fn signs(
        &mut self,
        piece: &Piece,
        [left, right]: [f64; 2],
        is_at_hand: bool,
        is_doubtful: bool,
        known: &mut Option<Place>,
    ) -> Signs {
        if is_at_hand {
            return piece.signs_from_zero();
        }
        match piece.signs() {
            Signs::Unclear if is_doubtful || is_clear(piece, false) => {
                let before = self.place_at(left, known);
                let after = self.place_at(right, known);
                piece.signs_between([before.gap, after.gap])
            }
            signs => signs,
        }
    }

    /// The gap at a fraction of the step; `known` keeps the last evaluation.
    fn place_at(&mut self, x: f64, known: &mut Option<Place>) -> Place {
        match *known {
            Some(place) if place.x == x => place,
            _ => {
                let gap = match x {
                    0.0 => self.ends[0],
                    1.0 => self.ends[1],
                    _ => (self.gap)(x),
                };
                *known.insert(Place { x, gap })
            }
        }
    }

    /// Result for a gap that is negative beyond rounding at `low` although no stretch shows the fall: the gap fell
    /// between two stretches or where it is flat, or it never rose.
    fn sunk(
        [left, _]: [f64; 2],
        rose: bool,
        high: Option<Place>,
        low: Place,
    ) -> Result<Isolated, Search> {
        match high {
            Some(high) => Ok(Isolated::Fall(Fall::between(high, low))),
            None => Err(Search::Sinks(if rose { left } else { 0.0 })),
        }
    }

    /// Narrows the bracket of the fall.
    fn narrow(
        &mut self,
        Fall {
            before,
            after,
            guess,
        }: Fall,
    ) -> Search {
        let slope = self.start.slope;
        let mut value = |theta: f64| deflated((self.gap)(theta), theta, slope);
        let [first, last] = [before, after].map(|place| deflated(place.gap, place.x, slope));
        const NEAREST: f64 = 1.0 / 64.0;
        let trial = before.x + guess.clamp(NEAREST, 1.0 - NEAREST) * (after.x - before.x);
        let at_trial = value(trial);
        // The first two points are the newest one and one on the other side of the root.
        let drop = match at_trial >= 0.0 {
            true => Drop {
                x: [trial, after.x, before.x],
                f: [at_trial, last, first],
            },
            false => Drop {
                x: [trial, before.x, after.x],
                f: [at_trial, first, last],
            },
        };
        let narrowed = narrow(drop, value);
        // Towards a pole the gap grows. It is compared with its values at the ends of the first bracket or, if that
        // bracket was narrow already, with its values elsewhere in the step.
        let size = |drop: &Drop| {
            let gap = |i: usize| {
                if slope.is_some() {
                    drop.f[i] * drop.x[i]
                } else {
                    drop.f[i]
                }
            };
            gap(0).abs().max(gap(1).abs())
        };
        let grown = size(&narrowed);
        let nearby = before.gap.abs().max(after.gap.abs());
        let mut is_peak = || {
            let inside = [0.25, 0.5, 0.75].map(|x| (self.gap)(x));
            let sizes = inside.into_iter().chain(self.ends).map(f64::abs);
            let largest = sizes.fold(0.0_f64, f64::max);
            grown > PEAK * largest && grown > PEAK * (self.rounding)(trial)
        };
        if grown > nearby || (PEAK * grown > nearby && is_peak()) {
            Search::Pole(after.x.max(narrowed.bracket().after))
        } else {
            Search::Falls(narrowed.bracket())
        }
    }
}

/// True if a piece decides the signs of the gap, provided that the gap equals the cubic at the ends.
fn is_clear(piece: &Piece, is_at_hand: bool) -> bool {
    let signs = match is_at_hand {
        true => piece.signs_from_zero(),
        false => match piece.signs() {
            Signs::Unclear => piece.signs_between(piece.ends()),
            signs => signs,
        },
    };
    signs != Signs::Unclear
}

/// Test for a stretch on which a gap is zero within rounding, or leaves zero to one side only. Returns the sign of
/// that side, or `Unclear` for a flat gap.
fn is_within(floor: f64, piece: &Piece, [first, last]: [f64; 2]) -> Option<Signs> {
    let [lowest, highest] = piece.bounds_from(first);
    match (lowest >= -floor, highest <= floor) {
        (true, true) => Some(Signs::Unclear),
        (true, false) if last > floor && first <= floor => Some(Signs::Positive),
        (false, true) if last < -floor && first >= -floor => Some(Signs::Negative),
        _ => None,
    }
}

/// A gap divided by the fraction of the step, for a surface just left; its limit at 0 is the slope.
///
/// The division removes the root at the start and most of the curvature of a flight, which saves iterations.
fn deflated(gap: f64, theta: f64, slope: Option<f64>) -> f64 {
    match slope {
        Some(slope) if theta == 0.0 => slope,
        Some(_) => gap / theta,
        None => gap,
    }
}

/// Three points near a fall, with the values there. The newest point comes first; the first two enclose the root.
#[derive(Debug, Clone, Copy)]
struct Drop {
    x: [f64; 3],
    f: [f64; 3],
}

impl Drop {
    fn bracket(&self) -> Bracket {
        let [before, after] = if self.f[0] >= 0.0 {
            [self.x[0], self.x[1]]
        } else {
            [self.x[1], self.x[0]]
        };
        let nearest = match self.f[0].abs() <= self.f[1].abs() {
            true => self.x[0],
            false => self.x[1],
        };
        Bracket {
            before,
            after,
            nearest,
        }
    }
}

/// Chandrupatla's method: inverse quadratic interpolation where it is safe, otherwise bisection.
fn narrow(drop: Drop, mut value: impl FnMut(f64) -> f64) -> Drop {
    let Drop { mut x, mut f } = drop;
    let mut reach = 1.0;
    // Bisection alone ends within 64 halvings, except for roots next to 0.
    for _ in 0..200 {
        let best = if f[0].abs() < f[1].abs() { x[0] } else { x[1] };
        let width = (x[1] - x[0]).abs();
        let resolution = 2.0 * f64::EPSILON * best.abs();
        if width <= resolution {
            break;
        }
        // Trials keep a distance from the ends so that both ends close in on the root. A trial near an end that finds
        // no change of sign, because rounding decides there, is followed by one further away.
        let part = next_part(x, f);
        let margin = (reach * resolution / width).min(0.5);
        let mut trial = if part >= 1.0 - margin {
            x[1] - margin * (x[1] - x[0])
        } else {
            x[0] + part.max(margin) * (x[1] - x[0])
        };
        if trial == x[1] {
            // The root is so close to 0 that it cannot be told from there as a part of the bracket.
            trial = x[1] + f[1] / (f[1] - f[0]) * (x[0] - x[1]);
        }
        reach *= if part <= margin || part >= 1.0 - margin {
            4.0
        } else {
            1.0
        };
        if trial == x[0] || trial == x[1] {
            break;
        }
        let at_trial = value(trial);
        if (at_trial >= 0.0) == (f[0] >= 0.0) {
            (x[2], f[2]) = (x[0], f[0]);
        } else {
            (x[2], f[2]) = (x[1], f[1]);
            (x[1], f[1]) = (x[0], f[0]);
            reach = 1.0;
        }
        (x[0], f[0]) = (trial, at_trial);
    }
    Drop { x, f }
}

/// Place of the next trial, as a fraction of the way from `x[0]` to `x[1]`.
fn next_part(x: [f64; 3], f: [f64; 3]) -> f64 {
    let xi = (x[0] - x[1]) / (x[2] - x[1]);
    let phi = (f[0] - f[1]) / (f[2] - f[1]);
    // A third point outside the bracket occurs only at first. Interpolation is safe there if the three values are in
    // order.
    let ordered = if xi <= 1.0 {
        phi * phi < xi && (1.0 - phi) * (1.0 - phi) < 1.0 - xi
    } else {
        (f[0] - f[2]) * (f[1] - f[0]) > 0.0 || (f[0] - f[1]) * (f[1] - f[2]) > 0.0
    };
    if ordered {
        let part = f[0] / (f[1] - f[0]) * (f[2] / (f[1] - f[2]))
            + (x[2] - x[0]) / (x[1] - x[0]) * (f[0] / (f[2] - f[0])) * (f[1] / (f[2] - f[1]));
        if part.is_finite() {
            return part;
        }
    }
    0.5
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::events::sampled;
    use crate::numbers::Numbers;

    /// The first fall of a function, and the number of its evaluations.
    fn first<F>(function: F, start: Start) -> (Search, u32)
    where
        F: Of,
    {
        let mut evaluations = 0;
        let mut gap = |theta: f64| {
            evaluations += 1;
            function.at(theta)
        };
        let found = Line {
            gap: &mut gap,
            along: &mut |ends| function.along(part(ends)),
            whole: None,
            ends: [function.at(0.0), function.at(1.0)],
            rounding: &mut |_| 1e-15,
            start,
            known: None,
        }
        .first_fall();
        (found, evaluations)
    }

    /// The fraction of the step, as a model between two fractions.
    fn part([from, to]: [f64; 2]) -> TaylorModel {
        TaylorModel {
            error: f64::EPSILON * to,
            ..TaylorModel::exact([0.5 * (from + to), 0.5 * (to - from), 0.0, 0.0])
        }
    }

    /// A function of doubles and of enclosures.
    trait Of {
        fn at(&self, x: f64) -> f64;
        fn along(&self, x: TaylorModel) -> TaylorModel;
    }

    struct Function<P, A>(P, A);

    impl<P: Fn(f64) -> f64, A: Fn(TaylorModel) -> TaylorModel> Of for Function<P, A> {
        fn at(&self, x: f64) -> f64 {
            (self.0)(x)
        }

        fn along(&self, x: TaylorModel) -> TaylorModel {
            (self.1)(x)
        }
    }

    /// A function of a place, in which `c` makes constants.
    macro_rules! function {
        ($c:ident |$x:ident| $value:expr) => {
            Function(
                |$x: f64| {
                    #[allow(unused_variables)]
                    let $c = |number: f64| number;
                    $value
                },
                |$x: TaylorModel| {
                    #[allow(unused_variables)]
                    let $c = <TaylorModel as Numbers>::of;
                    $value
                },
            )
        };
    }

    const FROM_ABOVE: Start = Start {
        from: 0.0,
        above: true,
        slope: None,
        until: 1.0,
    };

    fn assert_falls_at(found: Search, root: f64) {
        let Search::Falls(Bracket { before, after, .. }) = found else {
            panic!("{found:?}")
        };
        assert!(before < after && after - before <= 4.0 * f64::EPSILON * root);
        assert!((before - root).abs() <= 1e-15, "{before} for {root}");
    }

    #[test]
    fn simple_roots_take_few_evaluations() {
        let (found, evaluations) = first(function!(c | x | c(0.3) - x * x), FROM_ABOVE);
        assert_falls_at(found, 0.3_f64.sqrt());
        assert!(evaluations <= 9, "{evaluations}");
        let (found, evaluations) = first(function!(c | x | Numbers::sinh(c(0.7) - x)), FROM_ABOVE);
        assert_falls_at(found, 0.7);
        assert!(evaluations <= 9, "{evaluations}");
    }

    #[test]
    fn roots_where_stretches_meet_are_found_to_the_last_bits() {
        // A gap that is rounded to multiples of this unit, with a claimed error that is far larger.
        let unit = 1.0 / (1_u64 << 40) as f64;
        for part in [0.25, 0.125] {
            for eighths in -8..=8 {
                let root = part + f64::from(eighths) / 8.0 * unit;
                // The gap rises from the surface at the start.
                let turns = core::f64::consts::PI * (1.0 - 4.0 * unit) / root;
                let gap = |x: f64| ((turns * (root - x)).sin() / unit).round() * unit;
                let line = Line {
                    gap: &mut { gap },
                    along: &mut |ends| sampled::along(&sampled::nodes(ends).map(gap)),
                    whole: None,
                    ends: [gap(0.0), gap(1.0)],
                    rounding: &mut |_| 64.0 * unit,
                    start: FROM_ABOVE,
                    known: None,
                };
                let found = line.first_fall();
                let Search::Falls(Bracket { nearest, .. }) = found else {
                    panic!("{part} {eighths}: {found:?}")
                };
                assert!((nearest - root).abs() <= 2.0 * unit, "{nearest} for {root}");
            }
        }
    }

    #[test]
    fn root_at_the_start_is_divided_out() {
        for (root, most) in [(0.9, 10), (1e-3, 14), (1e-9, 14)] {
            let start = Start {
                slope: Some(root),
                ..FROM_ABOVE
            };
            let (found, evaluations) = first(function!(c | x | x * (c(root) - x)), start);
            assert_falls_at(found, root);
            assert!(evaluations <= most, "{root}: {evaluations}");
        }
    }

    #[test]
    fn first_of_two_close_roots_is_found() {
        for distance in [1e-1, 1e-3, 1e-6] {
            let (found, _) = first(
                function!(c | x | (x - c(0.4)) * (x - c(0.4) - c(distance))),
                FROM_ABOVE,
            );
            let Search::Falls(bracket) = found else {
                panic!("{distance}: {found:?}")
            };
            assert!(
                (bracket.before - 0.4).abs() < 1e-9,
                "{distance}: {bracket:?}"
            );
        }
        let (found, _) = first(
            function!(c | x | Numbers::square(x - c(0.4)) + c(1e-12)),
            FROM_ABOVE,
        );
        assert_eq!(found, Search::Clear);
    }

    #[test]
    fn from_below_only_the_second_root_is_a_fall() {
        let start = Start {
            above: false,
            ..FROM_ABOVE
        };
        let (found, _) = first(function!(c | x | (x - c(0.25)) * (c(0.625) - x)), start);
        assert_falls_at(found, 0.625);
        assert_eq!(first(function!(c | x | x - c(0.3)), start).0, Search::Clear);
    }

    #[test]
    fn fast_oscillations_are_resolved_from_the_left() {
        let (found, _) = first(
            function!(c | x | c(1.2) + Numbers::cos(c(500.0) * x) - x),
            FROM_ABOVE,
        );
        let Search::Falls(bracket) = found else {
            panic!("{found:?}")
        };
        // The minima have the values `0.2 - x` at `x = (2 k + 1) pi/500`. The first negative one lies at `33 pi/500`.
        let mut x = 0.0;
        while 1.2 + (500.0_f64 * x).cos() - x >= 0.0 {
            x += 1e-6;
        }
        assert!((bracket.before - x).abs() < 2e-6, "{bracket:?} for {x}");
    }

    #[test]
    fn pole_and_rest_are_told_from_roots() {
        let (found, _) = first(function!(c | x | c(1.0) / (c(0.3) - x)), FROM_ABOVE);
        assert!(matches!(found, Search::Pole(_)), "{found:?}");
        // The pole is so close to the boundary of two stretches that those around it are halved to neighbouring
        // numbers.
        assert!(matches!(
            first(
                function!(c | x | c(1.0) / (c(0.25 - 1e-13) - x)),
                FROM_ABOVE
            )
            .0,
            Search::Pole(_)
        ));
        let resting = Start {
            slope: Some(0.0),
            ..FROM_ABOVE
        };
        assert_eq!(
            first(function!(c | x | -x * x), resting).0,
            Search::Sinks(0.0)
        );
        assert_eq!(first(function!(c | x | x * x), resting).0, Search::Clear);
        assert_eq!(
            first(function!(c | x | c(0.0) * x), resting).0,
            Search::Clear
        );
    }
}
