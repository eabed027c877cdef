//! The stretch of a step with the first fall of a gap. Undecided stretches are halved until rounding decides. If a
//! stretch is undecided because of the remainder of the last model, a new model is computed.

use super::{Bracket, Fall, Line, Place, Search, Start};
use crate::events::crossing::Signs;
use crate::events::piece::Piece;
use crate::events::resolution::least_on;
use crate::events::stretches::{Region, Stretches};
use crate::numbers::TaylorModel;

/// Maximum number of halvings. The ends of a stretch of `2^-40` of a step decide it.
const DEPTH: u32 = 40;

/// Number of halvings after which the rounding of the gap is evaluated.
const DOUBTFUL: u32 = 3;

/// Maximum number of stretches; the search stops there, and the step is cut.
const STRETCHES: u32 = 4096;

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

/// The gap on a stretch of the step.
#[derive(Debug, Clone, Copy)]
struct View {
    span: [f64; 2],
    model: TaylorModel,
}

impl View {
    fn of(line: &mut Line<'_>, span: [f64; 2]) -> Self {
        Self {
            span,
            model: (line.along)(span),
        }
    }

    fn piece(&self, ends: [f64; 2]) -> Piece {
        Piece::of(&self.model, self.span, ends)
    }

    fn holds(&self, [left, right]: [f64; 2]) -> bool {
        self.span[0] <= left && right <= self.span[1]
    }
}

/// Result of a successful isolation.
pub(super) enum Isolated {
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

/// The stretch that is looked at.
#[derive(Debug, Clone, Copy)]
struct Stretch {
    ends: [f64; 2],
    /// True if the gap starts at 0 at its left end.
    is_at_hand: bool,
    /// Number of halvings of the step.
    depth: u32,
}

impl Stretch {
    /// True if the values of the gap at the ends are worth their evaluation.
    const fn is_doubtful(&self) -> bool {
        self.depth >= DOUBTFUL
    }
}

/// The next action of the search after a stretch.
enum Next {
    Halve,
    Advance,
    End(Result<Isolated, Search>),
}

/// Search for the stretch with the first fall.
pub(super) struct Isolation<'l, 'a> {
    line: &'l mut Line<'a>,
    stretches: Stretches,
    /// The gap on the whole searched part.
    coarse: View,
    /// The gap on the last stretch for which a model was computed.
    fine: View,
    floors: Floors,
    /// True if the motion is on the allowed side.
    above: bool,
    /// True if the gap has risen from 0, or did not start there.
    rose: bool,
    /// The last place known to be above the surface.
    high: Option<Place>,
    /// The last evaluation of the gap.
    known: Option<Place>,
}

impl<'l, 'a> Isolation<'l, 'a> {
    pub(super) fn of(line: &'l mut Line<'a>) -> Self {
        let Start {
            from,
            above,
            slope,
            until,
        } = line.start;
        let limits = [from, until];
        let coarse = match line.whole {
            Some(model) => View {
                span: [0.0, 1.0],
                model,
            },
            None => View::of(line, limits),
        };
        let expected = expected(line, &coarse.piece(limits));
        Self {
            line,
            stretches: Stretches::of(limits, expected),
            coarse,
            fine: coarse,
            floors: Floors(None),
            above,
            rose: slope.is_none(),
            high: None,
            known: None,
        }
    }

    /// Isolates the first fall, stretch by stretch; undecided stretches are halved.
    pub(super) fn run(mut self) -> Result<Isolated, Search> {
        for _ in 0..STRETCHES {
            let ends = self.stretches.ends();
            let stretch = Stretch {
                ends,
                is_at_hand: ends[0] == 0.0 && self.line.start.slope.is_some(),
                depth: self.stretches.depth(),
            };
            let (piece, signs) = self.look(&stretch);
            let next = match signs {
                Signs::Positive | Signs::Rises => self.take_positive(&stretch),
                Signs::Falls => Next::End(Ok(self.take_fall(&stretch, &piece))),
                Signs::Negative => self.take_negative(&stretch),
                Signs::Unclear => self.take_unclear(&stretch, &piece),
            };
            match next {
                Next::Halve => self.stretches.halve(),
                Next::End(result) => return result,
                Next::Advance => {
                    if !self.stretches.advance() {
                        return Err(Search::Clear);
                    }
                }
            }
        }
        Err(Search::Unfinished(self.stretches.ends()[0]))
    }

    /// The gap on a stretch, and its signs there. Computes a new model if its remainder decides.
    fn look(&mut self, stretch: &Stretch) -> (Piece, Signs) {
        let view = match self.fine.holds(stretch.ends) {
            true => self.fine,
            false => self.coarse,
        };
        let piece = view.piece(stretch.ends);
        let signs = self.signs(&piece, stretch);
        if signs != Signs::Unclear
            || view.span == stretch.ends
            || !self.gains_by_a_model(&piece, stretch)
        {
            return (piece, signs);
        }
        self.fine = View::of(self.line, stretch.ends);
        let piece = self.fine.piece(stretch.ends);
        let signs = self.signs(&piece, stretch);
        (piece, signs)
    }

    /// True if a model on the stretch alone may decide it: without a remainder this one would, or the remainder exceeds
    /// the rounding.
    fn gains_by_a_model(&mut self, piece: &Piece, stretch: &Stretch) -> bool {
        if is_clear(&piece.without_remainder(), stretch.is_at_hand) {
            return true;
        }
        let floor = match stretch.is_doubtful() {
            true => self.floor(),
            false => f64::INFINITY,
        };
        !piece.is_sharper_than(floor)
    }

    /// The gap is positive on the stretch, or rises from negative to positive values.
    fn take_positive(&mut self, stretch: &Stretch) -> Next {
        (self.above, self.rose) = (true, true);
        let is_end = |place: &Place| place.x == stretch.ends[1] && place.gap > 0.0;
        self.high = self.known.filter(is_end).or(self.high);
        Next::Advance
    }

    /// The gap falls once on the stretch.
    fn take_fall(&mut self, stretch: &Stretch, piece: &Piece) -> Isolated {
        let [left, right] = stretch.ends;
        if let Some(bracket) = self.line.known
            && left < bracket.before
            && bracket.after < right
        {
            return Isolated::Known(bracket);
        }
        let [before, after] = self.both_ends(stretch);
        Isolated::Fall(Fall {
            guess: piece.fall(),
            before,
            after,
        })
    }

    /// The gap is negative on the stretch.
    fn take_negative(&mut self, stretch: &Stretch) -> Next {
        if !self.above {
            return Next::Advance;
        }
        let low = self.place_at(stretch.ends[1]);
        let mut floor = self.floor();
        if low.gap >= -floor {
            floor = least_on(stretch.ends, &mut *self.line.rounding);
        }
        match low.gap < -floor {
            true => Next::End(self.sunk(stretch, floor, low)),
            false => Next::Advance,
        }
    }

    /// The model does not decide the stretch: it is halved, unless rounding or the resolution of fractions decides.
    fn take_unclear(&mut self, stretch: &Stretch, piece: &Piece) -> Next {
        if !stretch.is_doubtful() {
            return Next::Halve;
        }
        let mut floor = self.floor();
        let slope = self.line.start.slope.filter(|_| stretch.is_at_hand);
        // A gap that rises from zero beyond rounding is not flat, however soon it falls.
        let rises = slope.is_some_and(|slope| slope > floor);
        if rises && stretch.depth < DEPTH {
            return Next::Halve;
        }
        let [before, after] = self.both_ends(stretch);
        let first = if stretch.is_at_hand { 0.0 } else { before.gap };
        let gaps = [first, after.gap];
        let mut is_flat = match rises {
            true => None,
            false => is_within(floor, piece, gaps),
        };
        if is_flat.is_some() {
            floor = least_on(stretch.ends, &mut *self.line.rounding);
            is_flat = is_within(floor, piece, gaps);
        }
        match is_flat {
            // The gap leaves zero, upwards or downwards, without an excursion to the other side.
            Some(Signs::Positive) => {
                (self.above, self.rose) = (true, true);
                self.high = Some(after);
            }
            Some(Signs::Negative) if self.above => {
                return Next::End(self.sunk(stretch, floor, after));
            }
            Some(_) => {}
            None if stretch.depth < DEPTH => return Next::Halve,
            // The gap rises and falls within the resolution of the fractions of a step.
            None if stretch.is_at_hand && after.gap < 0.0 => {
                return Next::End(Err(Search::Sinks(stretch.ends[1])));
            }
            None if self.above && before.gap >= 0.0 && after.gap < 0.0 => {
                return Next::End(Ok(Isolated::Fall(Fall::between(before, after))));
            }
            None => {}
        }
        Next::Advance
    }

    /// Result for a gap that is negative beyond rounding at `low` although no stretch shows the fall: the gap fell
    /// between two stretches or where it is flat, or it never rose.
    fn sunk(&self, stretch: &Stretch, floor: f64, low: Place) -> Result<Isolated, Search> {
        match self.high.filter(|high| high.gap > floor) {
            Some(high) => Ok(Isolated::Fall(Fall::between(high, low))),
            None => Err(Search::Sinks(if self.rose { stretch.ends[0] } else { 0.0 })),
        }
    }

    /// The signs of the gap on a stretch. Evaluates the gap at its ends if they may decide.
    fn signs(&mut self, piece: &Piece, stretch: &Stretch) -> Signs {
        if stretch.is_at_hand {
            return piece.signs_from_zero();
        }
        match piece.signs() {
            Signs::Unclear if stretch.is_doubtful() || is_clear(piece, false) => {
                let ends = self.both_ends(stretch);
                piece.signs_between(ends.map(|place| place.gap))
            }
            signs => signs,
        }
    }

    fn both_ends(&mut self, stretch: &Stretch) -> [Place; 2] {
        stretch.ends.map(|x| self.place_at(x))
    }

    /// The gap at a fraction of the step.
    fn place_at(&mut self, x: f64) -> Place {
        match self.known {
            Some(place) if place.x == x => place,
            _ => {
                let gap = match x {
                    0.0 => self.line.ends[0],
                    1.0 => self.line.ends[1],
                    _ => (self.line.gap)(x),
                };
                *self.known.insert(Place { x, gap })
            }
        }
    }

    fn floor(&mut self) -> f64 {
        self.floors.near(&self.stretches, self.line.rounding)
    }
}

/// Estimate of the first fall from the gap's cubic.
fn expected(line: &Line<'_>, piece: &Piece) -> Option<f64> {
    let Start {
        from, above, until, ..
    } = line.start;
    if let Some(bracket) = line.known {
        return Some(bracket.nearest);
    }
    let is_at_hand = from == 0.0 && line.start.slope.is_some();
    let part = match is_at_hand {
        true => piece.fall_from_zero(),
        false => piece.first_fall(),
    };
    part.filter(|_| above)
        .map(|part| from + part * (until - from))
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
