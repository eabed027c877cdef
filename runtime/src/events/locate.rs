//! Event location: the first fall of a gap through zero inside a step, and its time to the last bits.
//!
//! The step is searched stretch by stretch from its start. A Taylor model of the gap on the stretch, or on a longer
//! one, decides each stretch. A gap that the model encloses away from zero has no fall there. For a gap whose rates
//! have one sign, the signs at the ends show the fall ([`isolate`]). Then the bracket is narrowed ([`narrow`]).

mod isolate;
mod narrow;

use crate::numbers::TaylorModel;
use isolate::{Isolated, Isolation};

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
    /// The gap changes sign at a pole, or jumps, before the first fraction, and nowhere else before the second.
    Pole(f64, f64),
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

/// A fraction of the step with the gap there.
#[derive(Debug, Clone, Copy)]
struct Place {
    x: f64,
    gap: f64,
}

/// A stretch on which the gap falls once, and an estimate of the fall as a fraction of the stretch.
struct Fall {
    before: Place,
    after: Place,
    guess: f64,
}

impl Line<'_> {
    /// Finds the first fall.
    pub(crate) fn first_fall(mut self) -> Search {
        if self.start.until <= self.start.from {
            return Search::Clear;
        }
        match Isolation::of(&mut self).run() {
            Ok(Isolated::Fall(fall)) => self.narrow(fall),
            Ok(Isolated::Known(bracket)) => Search::Falls(bracket),
            Err(search) => search,
        }
    }
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
        assert!(matches!(found, Search::Pole(..)), "{found:?}");
        // The pole is so close to the boundary of two stretches that those around it are halved to neighbouring
        // numbers.
        assert!(matches!(
            first(
                function!(c | x | c(1.0) / (c(0.25 - 1e-13) - x)),
                FROM_ABOVE
            )
            .0,
            Search::Pole(..)
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
