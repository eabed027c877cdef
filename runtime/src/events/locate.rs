//! The first fall of a gap through zero inside a step, and its time to the last bits.

use super::crossing::{NODES, SAMPLES, Signs, signs};

/// Halvings before the samples themselves decide: `2^-40` of a step.
const DEPTH: u32 = 40;

/// Halvings after which the rounding of the gap is asked for.
const DOUBTFUL: u32 = 3;

/// Stretches looked at before the search stops where it is; the step is cut there.
const STRETCHES: u32 = 4096;

/// Where a search begins.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Start {
    /// Part of the step at which it begins.
    pub from: f64,
    /// Whether the motion comes from the allowed side.
    pub above: bool,
    /// On the surface, at the start of the step: the gap's slope there. The root at the start is divided out.
    pub slope: Option<f64>,
}

/// Two parts of a step between which the gap falls: not negative at `before`, negative at `after`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Bracket {
    pub before: f64,
    pub after: f64,
}

/// What a search found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Search {
    /// No fall up to the end of the step.
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
pub(crate) struct Line<'a, G, R> {
    /// The gap at a part of the step.
    pub gap: G,
    /// The size of its rounding errors; asked for at most once.
    pub rounding: R,
    /// Its samples over the whole step.
    pub whole: &'a [f64; SAMPLES],
    /// Where to begin.
    pub start: Start,
}

impl<G: FnMut(f64) -> f64, R: FnMut() -> f64> Line<'_, G, R> {
    /// Finds the first fall, stretch after stretch; unclear stretches are halved.
    pub(crate) fn first_fall(mut self) -> Search {
        let (mut above, mut rose) = (self.start.above, self.start.slope.is_none());
        let mut floor = None;
        // The stretch number `index` of those of length `(1 - from) / 2^depth`.
        let (mut index, mut depth) = (0_u64, 0_u32);
        for _ in 0..STRETCHES {
            let [left, right] = stretch(self.start.from, index, depth);
            let samples = self.samples(left, right);
            let values = deflate(&samples, right, self.start.slope.filter(|_| left == 0.0));
            match signs(&values) {
                Signs::Positive | Signs::Rises => (above, rose) = (true, true),
                Signs::Negative if above => return Search::Sinks(if rose { left } else { 0.0 }),
                Signs::Negative => {}
                Signs::Falls => return self.narrow(first_drop(&values, left, right), [left, right]),
                Signs::Unclear => {
                    let known = depth >= DOUBTFUL;
                    let floor = if known { *floor.get_or_insert_with(&mut self.rounding) } else { -1.0 };
                    let flat = samples.iter().all(|gap| gap.abs() <= floor);
                    if !flat && depth < DEPTH {
                        (index, depth) = (2 * index, depth + 1);
                        continue;
                    }
                    let drop = first_drop(&values, left, right);
                    if !flat && drop.is_some() {
                        return self.narrow(drop, [left, right]);
                    }
                }
            }
            index += 1;
            while index % 2 == 0 && depth > 0 {
                (index, depth) = (index / 2, depth - 1);
            }
            if depth == 0 {
                return Search::Clear;
            }
        }
        Search::Unfinished(stretch(self.start.from, index, depth)[0])
    }

    /// Narrows a bracket, or else the whole stretch.
    fn narrow(&mut self, bracket: Option<Bracket>, [left, right]: [f64; 2]) -> Search {
        let Bracket { before, after } = bracket.unwrap_or(Bracket { before: left, after: right });
        let slope = self.start.slope.filter(|_| before == 0.0);
        let mut value = |theta: f64| match slope {
            Some(slope) if theta == 0.0 => slope,
            Some(_) => (self.gap)(theta) / theta,
            None => (self.gap)(theta),
        };
        let ends = [value(before), value(after)];
        narrow(&mut value, [before, after], ends).map_or(Search::Pole(after), Search::Falls)
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
    let end = |index: u64| if index as f64 == count { 1.0 } else { from + (1.0 - from) * (index as f64 / count) };
    [end(index), end(index + 1)]
}

/// The point at part `node` of a stretch, exact at both ends.
fn inside(left: f64, right: f64, node: f64) -> f64 {
    if node >= 1.0 { right } else { left + (right - left) * node }
}

/// The samples over a stretch that starts at 0, divided by the part of the step they lie at.
fn deflate(samples: &[f64; SAMPLES], right: f64, slope: Option<f64>) -> [f64; SAMPLES] {
    let Some(slope) = slope else { return *samples };
    let mut quotients = *samples;
    quotients[0] = slope;
    for j in 1..SAMPLES {
        quotients[j] = samples[j] / (right * NODES[j]);
    }
    quotients
}

/// The first value that is negative after one that is not.
fn first_drop(values: &[f64; SAMPLES], left: f64, right: f64) -> Option<Bracket> {
    let mut before = None;
    for (value, node) in values.iter().zip(NODES) {
        let theta = inside(left, right, node);
        match before {
            Some(before) if *value < 0.0 => return Some(Bracket { before, after: theta }),
            _ if *value >= 0.0 => before = Some(theta),
            _ => {}
        }
    }
    None
}

/// Chandrupatla's method: inverse quadratic interpolation where it is safe, else bisection.
///
/// The values at the two ends have signs `>= 0` and `< 0`. A pole is told from a root by values that grew.
fn narrow(value: &mut impl FnMut(f64) -> f64, ends: [f64; 2], values: [f64; 2]) -> Option<Bracket> {
    // `x[0]`, the newest point, and `x[1]` enclose the root; `x[2]` is the point before.
    let mut x = [ends[1], ends[0], ends[0]];
    let mut f = [values[1], values[0], values[0]];
    let mut part = f[0] / (f[0] - f[1]);
    // Bisection alone ends within 64 halvings, but for roots next to 0.
    for _ in 0..200 {
        let best = if f[0].abs() < f[1].abs() { x[0] } else { x[1] };
        let width = (x[1] - x[0]).abs();
        let resolution = 2.0 * f64::EPSILON * best.abs();
        if width <= resolution || f[0] == 0.0 {
            break;
        }
        let margin = (resolution / width).min(0.5);
        let trial = x[0] + part.clamp(margin, 1.0 - margin) * (x[1] - x[0]);
        if trial == x[0] || trial == x[1] {
            break;
        }
        let at_trial = value(trial);
        if (at_trial >= 0.0) == (f[0] >= 0.0) {
            (x[2], f[2]) = (x[0], f[0]);
        } else {
            (x[2], f[2]) = (x[1], f[1]);
            (x[1], f[1]) = (x[0], f[0]);
        }
        (x[0], f[0]) = (trial, at_trial);
        part = next_part(x, f);
    }
    let grown = f[0].abs().max(f[1].abs()) > values[0].abs().max(values[1].abs());
    let [before, after] = if f[0] >= 0.0 { [x[0], x[1]] } else { [x[1], x[0]] };
    (!grown).then_some(Bracket { before, after })
}

/// Where to go next between `x[0]` and `x[1]`.
fn next_part(x: [f64; 3], f: [f64; 3]) -> f64 {
    let xi = (x[0] - x[1]) / (x[2] - x[1]);
    let phi = (f[0] - f[1]) / (f[2] - f[1]);
    if phi * phi < xi && (1.0 - phi) * (1.0 - phi) < 1.0 - xi {
        let part = f[0] / (f[1] - f[0]) * (f[2] / (f[1] - f[2]))
            + (x[2] - x[0]) / (x[1] - x[0]) * (f[0] / (f[2] - f[0])) * (f[1] / (f[2] - f[1]));
        if part.is_finite() {
            return part;
        }
    }
    0.5
}
