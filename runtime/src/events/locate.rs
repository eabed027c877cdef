//! The first fall of a gap through zero inside a step, and its time to the last bits.

use super::crossing::{NODES, SAMPLES, Signs, signs};

/// Halvings before the samples themselves decide: `2^-40` of a step.
const DEPTH: u32 = 40;

/// Halvings after which the rounding of the gap is asked for.
const DOUBTFUL: u32 = 3;

/// Stretches looked at before the search stops where it is; the step is cut there.
const STRETCHES: u32 = 4096;

/// A gap this many times larger next to a change of sign than anywhere else in the step belongs to a pole.
const PEAK: f64 = (1 << 10) as f64;

/// Where a search begins.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Start {
    /// Part of the step at which it begins.
    pub from: f64,
    /// Whether the motion comes from the allowed side.
    pub above: bool,
    /// On the surface, at the start of the step: the gap's slope there. The root at the start is divided out.
    pub slope: Option<f64>,
    /// Part of the step after which falls are of no interest.
    pub until: f64,
}

impl Start {
    /// Behind a fall or a pole, with the function negative there.
    pub(crate) fn behind(from: f64, until: f64) -> Self {
        Self {
            from,
            above: false,
            slope: None,
            until,
        }
    }
}

/// Two parts of a step between which the gap falls: not negative at `before`, negative at `after`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Bracket {
    pub before: f64,
    pub after: f64,
    /// The one of the two at which the gap is closer to 0.
    pub nearest: f64,
}

/// What a search found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Search {
    /// No fall in what is of interest of the step.
    Clear,
    /// The first fall, narrowed to neighbouring numbers or close to it.
    Falls(Bracket),
    /// The gap went from zero within rounding to clearly negative, here; at 0 if it never rose from the surface.
    Sinks(f64),
    /// A change of sign through a pole, which ends here.
    Pole(f64),
    /// Looked at up to here, and no further.
    Unfinished(f64),
}

/// The gap of one surface along a step.
// NOTE: functions behind pointers: the search is long, and compiled once instead of for every system and integrator.
pub(crate) struct Line<'a> {
    /// The gap at a part of the step.
    pub gap: &'a mut dyn FnMut(f64) -> f64,
    /// The size of its rounding errors; asked for once or twice.
    pub rounding: &'a mut dyn FnMut() -> f64,
    /// Its samples over the whole step.
    pub whole: &'a [f64; SAMPLES],
    /// Where to begin.
    pub start: Start,
}

impl Line<'_> {
    /// Finds the first fall.
    pub(crate) fn first_fall(mut self) -> Search {
        match self.isolate() {
            Ok(drop) => self.narrow(drop),
            Err(search) => search,
        }
    }

    /// The ends of an interval in which the first fall lies, alone; what else was found where there is none.
    pub(crate) fn first_interval(mut self) -> Result<[f64; 2], Search> {
        self.isolate().map(|drop| {
            let Bracket { before, after, .. } = drop.bracket();
            [before, after]
        })
    }

    /// Looks for the first fall stretch after stretch; unclear stretches are halved.
    fn isolate(&mut self) -> Result<Drop, Search> {
        let (mut above, mut rose) = (self.start.above, self.start.slope.is_none());
        let (mut floor, mut high) = (None, None);
        // The stretch number `index` of those of length `(1 - from) / 2^depth`.
        let (mut index, mut depth) = (0_u64, 0_u32);
        for _ in 0..STRETCHES {
            let [left, right] = stretch(self.start.from, index, depth);
            if left > self.start.until {
                return Err(Search::Clear);
            }
            let samples = self.samples(left, right);
            let values = deflate(&samples, [left, right], self.start.slope);
            match signs(&values) {
                Signs::Positive | Signs::Rises => {
                    (above, rose) = (true, true);
                    high = Some(High::of(&samples, &values, [left, right]));
                }
                Signs::Negative if above => {
                    let floor = *floor.get_or_insert_with(&mut self.rounding);
                    if let Some(low) = samples.iter().position(|gap| *gap < -floor) {
                        return match high.filter(|high| high.gap > floor) {
                            // It fell where two stretches meet, or where it is flat.
                            Some(high) => {
                                self.of_interest(high.drop_to(low, &values, [left, right]))
                            }
                            None => Err(Search::Sinks(if rose { left } else { 0.0 })),
                        };
                    }
                }
                Signs::Negative => {}
                Signs::Falls => match first_drop(&values, [left, right]) {
                    Some(drop) => return self.of_interest(drop),
                    None => above = false,
                },
                Signs::Unclear => {
                    let known = depth >= DOUBTFUL;
                    let floor = if known {
                        *floor.get_or_insert_with(&mut self.rounding)
                    } else {
                        -1.0
                    };
                    let flat = samples.iter().all(|gap| gap.abs() <= floor);
                    if !flat && depth < DEPTH {
                        (index, depth) = (2 * index, depth + 1);
                        continue;
                    }
                    if !flat && let Some(drop) = first_drop(&values, [left, right]) {
                        return self.of_interest(drop);
                    }
                }
            }
            index += 1;
            while index % 2 == 0 && depth > 0 {
                (index, depth) = (index / 2, depth - 1);
            }
            if depth == 0 {
                return Err(Search::Clear);
            }
        }
        Err(Search::Unfinished(
            stretch(self.start.from, index, depth)[0],
        ))
    }

    /// A fall, unless it lies where nothing is of interest.
    fn of_interest(&self, drop: Drop) -> Result<Drop, Search> {
        match drop.bracket().before > self.start.until {
            true => Err(Search::Clear),
            false => Ok(drop),
        }
    }

    /// Narrows the interval in which the gap falls.
    fn narrow(&mut self, drop: Drop) -> Search {
        let Bracket { after, .. } = drop.bracket();
        let slope = self.start.slope;
        let narrowed = narrow(drop, |theta| deflated((self.gap)(theta), theta, slope));
        // A pole is told from a root by gaps that grow towards it: from the ends of the interval, or, where that was
        // narrow already, from what they are elsewhere in the step.
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
        let largest = self
            .whole
            .iter()
            .fold(0.0_f64, |most, gap| most.max(gap.abs()));
        let grown = size(&narrowed);
        let mut is_peak = || grown > PEAK * largest && grown > PEAK * (self.rounding)();
        if grown > size(&drop) || is_peak() {
            Search::Pole(after)
        } else {
            Search::Falls(narrowed.bracket())
        }
    }

    fn samples(&mut self, left: f64, right: f64) -> [f64; SAMPLES] {
        if left == 0.0 && right == 1.0 {
            return *self.whole;
        }
        NODES.map(|node| (self.gap)(inside(left, right, node)))
    }
}

/// The ends of a stretch.
fn stretch(from: f64, index: u64, depth: u32) -> [f64; 2] {
    let count = (1_u64 << depth) as f64;
    let end = |index: u64| {
        if index as f64 == count {
            1.0
        } else {
            from + (1.0 - from) * (index as f64 / count)
        }
    };
    [end(index), end(index + 1)]
}

/// The point at part `node` of a stretch, exact at both ends.
fn inside(left: f64, right: f64, node: f64) -> f64 {
    if node >= 1.0 {
        right
    } else {
        left + (right - left) * node
    }
}

/// A gap divided by the part of the step it is taken at, over a surface just left; its limit is the slope.
///
/// Besides the root at the start this takes out most of the bend of a flight, which saves iterations.
fn deflated(gap: f64, theta: f64, slope: Option<f64>) -> f64 {
    match slope {
        Some(slope) if theta == 0.0 => slope,
        Some(_) => gap / theta,
        None => gap,
    }
}

/// All samples of a stretch, deflated.
fn deflate(
    samples: &[f64; SAMPLES],
    [left, right]: [f64; 2],
    slope: Option<f64>,
) -> [f64; SAMPLES] {
    let mut values = *samples;
    if slope.is_some() {
        for (value, node) in values.iter_mut().zip(NODES) {
            *value = deflated(*value, inside(left, right, node), slope);
        }
    }
    values
}

/// The highest sample of a stretch: its gap, where it is, and its value.
#[derive(Debug, Clone, Copy)]
struct High {
    gap: f64,
    x: f64,
    value: f64,
}

impl High {
    fn of(samples: &[f64; SAMPLES], values: &[f64; SAMPLES], [left, right]: [f64; 2]) -> Self {
        let highest = (1..SAMPLES).fold(0, |best, j| match samples[j] > samples[best] {
            true => j,
            false => best,
        });
        Self {
            gap: samples[highest],
            x: inside(left, right, NODES[highest]),
            value: values[highest],
        }
    }

    /// The fall from here to a sample of a later stretch.
    fn drop_to(self, low: usize, values: &[f64; SAMPLES], [left, right]: [f64; 2]) -> Drop {
        let beside = if low + 1 < SAMPLES { low + 1 } else { low - 1 };
        let [at, next] = [low, beside].map(|j| inside(left, right, NODES[j]));
        Drop {
            x: [at, self.x, next],
            f: [values[low], self.value, values[beside]],
        }
    }
}

/// A fall between two samples, and a third sample beside them: positions and values. The newest point comes first;
/// it and the second enclose the root.
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

/// The first value that is negative after one that is not.
fn first_drop(values: &[f64; SAMPLES], [left, right]: [f64; 2]) -> Option<Drop> {
    let j = (1..SAMPLES).find(|&j| values[j - 1] >= 0.0 && values[j] < 0.0)?;
    let beside = if j + 1 < SAMPLES { j + 1 } else { j - 2 };
    let at = [j, j - 1, beside];
    Some(Drop {
        x: at.map(|j| inside(left, right, NODES[j])),
        f: at.map(|j| values[j]),
    })
}

/// Chandrupatla's method: inverse quadratic interpolation where it is safe, else bisection.
fn narrow(drop: Drop, mut value: impl FnMut(f64) -> f64) -> Drop {
    let Drop { mut x, mut f } = drop;
    let mut reach = 1.0;
    // Bisection alone ends within 64 halvings, but for roots next to 0.
    for _ in 0..200 {
        let best = if f[0].abs() < f[1].abs() { x[0] } else { x[1] };
        let width = (x[1] - x[0]).abs();
        let resolution = 2.0 * f64::EPSILON * best.abs();
        if width <= resolution {
            break;
        }
        // Trials keep off the ends so that both close in on the root; one that keeps close to an end and finds no
        // change of sign there, for all is rounding, reaches further the next time.
        let part = next_part(x, f);
        let margin = (reach * resolution / width).min(0.5);
        let trial = if part >= 1.0 - margin {
            x[1] - margin * (x[1] - x[0])
        } else {
            x[0] + part.max(margin) * (x[1] - x[0])
        };
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

/// Where to go next between `x[0]` and `x[1]`.
fn next_part(x: [f64; 3], f: [f64; 3]) -> f64 {
    let xi = (x[0] - x[1]) / (x[2] - x[1]);
    let phi = (f[0] - f[1]) / (f[2] - f[1]);
    // A third point outside the enclosing ones is only met at first; interpolation is safe there if the three
    // values are in order.
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

    /// The first fall of a function, and how often it was evaluated.
    fn first(function: impl Fn(f64) -> f64, start: Start) -> (Search, u32) {
        let whole = NODES.map(&function);
        let mut evaluations = 0;
        let mut gap = |theta: f64| {
            evaluations += 1;
            function(theta)
        };
        let found = Line {
            gap: &mut gap,
            rounding: &mut || 1e-15,
            whole: &whole,
            start,
        }
        .first_fall();
        (found, evaluations)
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
        let (found, evaluations) = first(|x| 0.3 - x * x, FROM_ABOVE);
        assert_falls_at(found, 0.3_f64.sqrt());
        assert!(evaluations <= 9, "{evaluations}");
        let (found, evaluations) = first(|x| (0.7 - x).sinh(), FROM_ABOVE);
        assert_falls_at(found, 0.7);
        assert!(evaluations <= 9, "{evaluations}");
    }

    #[test]
    fn roots_where_stretches_meet_are_found_to_the_last_bits() {
        // A gap that is rounded to multiples of this, and said to err by far more.
        let unit = 1.0 / (1_u64 << 40) as f64;
        for part in [0.25, 0.125] {
            for eighths in -8..=8 {
                let root = part + f64::from(eighths) / 8.0 * unit;
                // It rises from the surface at the start.
                let turns = core::f64::consts::PI * (1.0 - 4.0 * unit) / root;
                let gap = |x: f64| ((turns * (root - x)).sin() / unit).round() * unit;
                let line = Line {
                    gap: &mut { gap },
                    rounding: &mut || 64.0 * unit,
                    whole: &NODES.map(gap),
                    start: FROM_ABOVE,
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
        for root in [0.9, 1e-3, 1e-9] {
            let start = Start {
                slope: Some(root),
                ..FROM_ABOVE
            };
            let (found, evaluations) = first(|x| x * (root - x), start);
            assert_falls_at(found, root);
            assert!(evaluations <= 8, "{evaluations}");
        }
    }

    #[test]
    fn first_of_two_close_roots_is_found() {
        for distance in [1e-1, 1e-3, 1e-6] {
            let (found, _) = first(|x| (x - 0.4) * (x - 0.4 - distance), FROM_ABOVE);
            let Search::Falls(bracket) = found else {
                panic!("{distance}: {found:?}")
            };
            assert!(
                (bracket.before - 0.4).abs() < 1e-9,
                "{distance}: {bracket:?}"
            );
        }
        let (found, _) = first(|x| (x - 0.4) * (x - 0.4) + 1e-12, FROM_ABOVE);
        assert_eq!(found, Search::Clear);
    }

    #[test]
    fn from_below_only_the_second_root_is_a_fall() {
        let start = Start {
            above: false,
            ..FROM_ABOVE
        };
        let (found, _) = first(|x| (x - 0.25) * (0.625 - x), start);
        assert_falls_at(found, 0.625);
        assert_eq!(first(|x| x - 0.3, start).0, Search::Clear);
    }

    #[test]
    fn fast_oscillations_are_resolved_from_the_left() {
        let (found, _) = first(|x| 1.2 + (500.0 * x).cos() - x, FROM_ABOVE);
        let Search::Falls(bracket) = found else {
            panic!("{found:?}")
        };
        // Falls before the third minimum at 5 pi / 500; the level 1.2 - x first meets the minima there or later.
        let mut x = 0.0;
        while 1.2 + (500.0_f64 * x).cos() - x >= 0.0 {
            x += 1e-6;
        }
        assert!((bracket.before - x).abs() < 2e-6, "{bracket:?} for {x}");
    }

    #[test]
    fn pole_and_rest_are_told_from_roots() {
        assert!(matches!(
            first(|x| 1.0 / (0.3 - x), FROM_ABOVE).0,
            Search::Pole(_)
        ));
        // So close to a sample that the stretches around it are halved to neighbouring numbers.
        assert!(matches!(
            first(|x| 1.0 / (NODES[3] - 1e-13 - x), FROM_ABOVE).0,
            Search::Pole(_)
        ));
        let resting = Start {
            slope: Some(0.0),
            ..FROM_ABOVE
        };
        assert_eq!(first(|x| -x * x, resting).0, Search::Sinks(0.0));
        assert_eq!(first(|x| x * x, resting).0, Search::Clear);
        assert_eq!(first(|_| 0.0, resting).0, Search::Clear);
    }
}
