//! Bounds of the terms that are missing in a truncated power series of a gap.
//!
//! Along a step the positions are polynomials `p_i` of its fraction `z`. On the disk `|z| <= R` in the complex plane,
//! the distance `|p_i(z) - p_i(0)|` is at most `r_i = sum_(k>=1) |p_ik| R^k`. Let a gap be analytic on a box of complex
//! positions that contains these disks, and let its imaginary part on the box be at most `h`. Then coefficient `k` of
//! its series along the step is at most `2 h / R^k` ([`ComplexInterval`]), and the sum of all coefficients above order
//! `n` is at most `2 h R^-n / (R - 1)`. If the radii of a step are smaller than those of the box by a factor, the bound
//! `h` is smaller by this factor too.
//!
//! The box serves many steps, and grows with the motion. A step whose radii exceed the imaginary parts of the box gets
//! a box of its own. If this happens often, the shared box is extended. If the shared box gives a poor bound, it is set
//! anew for the present step, but not in every step.

use core::cell::Cell;

use super::path::Path;
use super::room::{Room, place};
use crate::jet::LENGTH;
use crate::numbers::{ComplexInterval, Interval};
use crate::per_surface::PerSurface;
use crate::state::StateVector;

/// Radii of the disks, in step lengths, for series of low and of high order.
const RATIOS: [f64; 2] = [3.0, 4.0];

/// Smallest order that counts as high.
const HIGH: usize = 10;

/// `POWERS[i][k]` is `RATIOS[i]^k`.
const POWERS: [[f64; LENGTH]; 2] = {
    let mut powers = [[1.0; LENGTH]; 2];
    let mut k = 1;
    while k < LENGTH {
        powers[0][k] = powers[0][k - 1] * RATIOS[0];
        powers[1][k] = powers[1][k - 1] * RATIOS[1];
        k += 1;
    }
    powers
};

/// Fractions of the box's imaginary parts with which the rounding of the coefficients is bounded, for both [`RATIOS`].
/// On a disk that is smaller by a factor, polynomials without constant term are smaller by at least this factor.
const PARTS: [f64; 2] = [
    ComplexInterval::LEAST_RATIO / RATIOS[0],
    ComplexInterval::LEAST_RATIO / RATIOS[1],
];

/// Factors of the imaginary parts for which the gaps are bounded. Bounds of functions grow faster than the imaginary
/// parts, so that small boxes give better bounds.
const LEVELS: [f64; 4] = [1.0, 0.5, 0.25, 0.125];

/// Factor by which the imaginary parts of the box exceed those of a step that made it grow.
const GROWTH: f64 = 1.25;

/// A step whose radii exceed the imaginary parts of the box raises the strain by `SHARE`, any other step lowers it by
/// one. Above `MOST_STRAIN` the imaginary parts are extended.
const SHARE: u32 = 32;
const MOST_STRAIN: u32 = 64;

/// Largest useful bound of the missing terms, relative to the terms of the series.
const USEFUL: f64 = 1.0 / (1 << 6) as f64;
/// Largest bound for which no better box is tried, relative to the terms of the series.
const GOOD: f64 = 1.0 / (1 << 10) as f64;

/// Maximum number of steps to wait after a useless bound.
const MOST_PATIENCE: u32 = 256;

/// Largest share of rounding errors in a bound for which they are not bounded better.
const SMALL: f64 = 1.0 / (1 << 4) as f64;

/// Factor that covers the relative rounding errors of the estimate.
const UP: f64 = 1.0 + 64.0 * f64::EPSILON;

/// The gap of a surface as a function of complex time and complex components.
pub(crate) type Gap<'a> =
    &'a dyn Fn(ComplexInterval, &dyn Fn(usize) -> ComplexInterval) -> ComplexInterval;

/// Bounds of the difference between a gap and its truncated series.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Tail {
    /// Bound of the difference of the values, for an exact constant coefficient.
    pub(crate) value: f64,
    /// Bound of the difference of the derivatives with respect to the fraction of the step.
    pub(crate) slope: f64,
    /// Rounding error of the constant coefficient.
    pub(crate) floor: f64,
}

/// Bounds of a gap on the box.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Bound {
    height: f64,
    rounding: f64,
    floor: f64,
    /// Upper bound of the degree as a polynomial of positions and time; `None` if the gap is not a polynomial.
    degree: Option<u32>,
    takes: Takes,
    /// True if `rounding` and `floor` were found on a smaller box.
    is_sharp: bool,
}

impl Bound {
    /// The bounds on a box. `ratio` is an index into [`RATIOS`].
    fn new(whole: ComplexInterval, takes: Takes, ratio: usize) -> Self {
        Self {
            height: whole.height,
            // In proportion to the imaginary parts.
            rounding: PARTS[ratio] * whole.rounding,
            floor: whole.floor,
            degree: whole.degree(),
            takes,
            is_sharp: false,
        }
    }

    /// Bounds the rounding errors by the gap on a box that is smaller by the factor [`PARTS`].
    fn sharpen(&mut self, inner: ComplexInterval) {
        (self.rounding, self.floor, self.is_sharp) = (inner.rounding, inner.floor, true);
    }
}

/// Quantities that a gap depends on.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Takes {
    /// The positions, as a bit mask.
    positions: u64,
    time: bool,
}

impl Takes {
    const NOTHING: Self = Self {
        positions: 0,
        time: false,
    };

    const EVERYTHING: Self = Self {
        positions: u64::MAX,
        time: true,
    };
}

/// Results for one surface.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Surface {
    /// The bounds, for each of [`LEVELS`].
    bounds: [Option<Bound>; LEVELS.len()],
    takes: Option<Takes>,
    /// Number of the step from which bounds are tried again.
    resumes: u32,
    /// Number of steps of the wait after the last failure.
    patience: u32,
}

/// The shared box, with the bounds of the gaps on it.
#[derive(Debug, Clone)]
pub(crate) struct Tails<S, G: StateVector> {
    /// Real parts of the box.
    room: Room<S>,
    /// Largest imaginary parts of the positions, and of the time.
    heights: S,
    time_height: f64,
    surfaces: PerSurface<Surface, G>,
    /// Number of the present step.
    number: u32,
    /// Quantities that at least one gap depends on. The box bounds these.
    kept: Takes,
    /// Index into [`RATIOS`]: 0 for low orders, 1 for high ones.
    ratio: usize,
    /// Radii of the disks of the last step, for positions and for time.
    radii: S,
    time_radius: f64,
    /// Degree of the components of the last step.
    degree: u32,
    /// Index into [`LEVELS`] of the smallest level that contains the last step.
    level: usize,
    /// True if the imaginary parts of the box suffice for the last step.
    fits: bool,
    /// True if the box was made for the last step.
    is_new: bool,
    /// Measure of the steps that recently left the box; see [`SHARE`].
    strain: u32,
    /// Number of steps to wait before a better box is tried, and the length of the last such wait.
    wait: u32,
    patience: u32,
}

impl<S: StateVector, G: StateVector> Tails<S, G> {
    /// No box yet. `positions` is the number of positions; `state` and `gaps` give the numbers of components and
    /// surfaces.
    pub(crate) fn new(positions: usize, state: &S, gaps: &G) -> Self {
        let unknown = Surface {
            bounds: [None; LEVELS.len()],
            takes: None,
            resumes: 0,
            patience: 0,
        };
        let zeros = state.zeroed();
        Self {
            room: Room::new(positions, state),
            heights: zeros,
            time_height: 0.0,
            surfaces: PerSurface::all(gaps, unknown),
            number: 0,
            kept: Takes::NOTHING,
            ratio: 0,
            radii: zeros,
            time_radius: 0.0,
            degree: 0,
            level: 0,
            fits: false,
            is_new: false,
            strain: 0,
            wait: 0,
            patience: 0,
        }
    }

    /// Discards the box, after a change of surfaces, parameters or mode.
    pub(crate) fn forget(&mut self) {
        self.room.forget();
        self.kept = Takes::NOTHING;
        for surface in self.surfaces.iter_mut() {
            surface.takes = None;
        }
    }

    /// Counts a step.
    #[inline]
    pub(crate) fn count(&mut self) {
        self.number = self.number.wrapping_add(1);
    }

    /// True if the last bounds of a surface were useless, so that this step does not try again.
    #[inline]
    pub(crate) fn skips(&self, surface: usize) -> bool {
        let left = self.surfaces[surface].resumes.wrapping_sub(self.number);
        // Once the step `resumes` has passed, the difference wraps around.
        left != 0 && left <= MOST_PATIENCE
    }

    /// True if no surface is skipped.
    #[inline]
    pub(crate) fn is_useful(&self) -> bool {
        (0..self.surfaces.count()).all(|surface| !self.skips(surface))
    }

    /// Records a step and extends the box to contain it. The imaginary parts are extended only if steps exceed them
    /// often.
    pub(crate) fn follow(&mut self, path: &Path<S>) {
        self.wait = self.wait.saturating_sub(1);
        self.is_new = false;
        self.measure(path);
        if !self.room.is_known() {
            return self.surround(path);
        }
        self.choose_level();
        match self.fits {
            true => self.strain = self.strain.saturating_sub(1),
            false => {
                self.strain += SHARE;
                if self.strain <= MOST_STRAIN {
                    return;
                }
                self.rise();
            }
        }
        let Self { room, radii, .. } = self;
        let range = |i: usize| disk(path, radii, i);
        let times = times(path, self.time_radius);
        if !room.holds_box(range, times) {
            room.extend_box(range, times);
            self.discard_bounds();
        }
    }

    /// Computes the radii of the disks of a step, and the degree of its components.
    #[inline]
    fn measure(&mut self, path: &Path<S>) {
        let terms = path.coefficients();
        let ratio = usize::from(terms.len() > HIGH);
        if ratio != self.ratio {
            self.ratio = ratio;
            self.room.forget();
        }
        let mut radii = self.radii.zeroed();
        for (coefficient, power) in terms.iter().zip(&POWERS[ratio]).skip(1) {
            coefficient.for_each_place(|i| {
                radii.padded_mut()[i] += power * coefficient.padded()[i].abs();
            });
        }
        for radius in radii.as_mut_slice() {
            *radius *= UP;
        }
        self.radii = radii;
        let is_zero = |component: &f64| *component == 0.0;
        let last = terms
            .iter()
            .rposition(|term| !term.as_slice().iter().all(is_zero));
        self.degree = last.map_or(1, |k| k.max(1) as u32);
        self.time_radius = RATIOS[ratio] * path.length() * UP;
    }

    /// Bounds for the truncated series of a surface's gap. `order` is the order of the series, `size` the sum of the
    /// absolute values of its terms. `None` if there is no useful bound.
    pub(crate) fn of(
        &mut self,
        surface: usize,
        (order, size): (usize, f64),
        at @ (_, path): (Gap<'_>, &Path<S>),
        evaluations: &mut u64,
    ) -> Option<Tail> {
        let mut tail = match self.fits {
            true => self.estimate(surface, order, at, evaluations),
            false => self.estimate_alone(order, at, evaluations),
        };
        // This form of the comparison is false for NaN.
        let is_good = tail.value <= GOOD * size;
        if !is_good && self.fits && !self.is_new && self.wait == 0 {
            self.surround(path);
            self.patience = (2 * self.patience + 1).min(MOST_PATIENCE);
            self.wait = self.patience;
            tail = self.estimate(surface, order, at, evaluations);
        }
        let useful =
            |tail: &Tail| tail.value <= USEFUL * size && tail.slope + tail.floor < f64::INFINITY;
        let is_useful = useful(&tail);
        match is_useful {
            true => self.surfaces[surface].patience = 0,
            false => self.postpone(surface),
        }
        is_useful.then_some(tail)
    }

    /// Makes later steps wait before bounds for a surface are tried again.
    pub(crate) fn postpone(&mut self, surface: usize) {
        let known = &mut self.surfaces[surface];
        known.patience = (4 * known.patience + 3).min(MOST_PATIENCE);
        known.resumes = self.number.wrapping_add(known.patience);
    }

    /// The estimate with the present box.
    fn estimate(
        &mut self,
        surface: usize,
        order: usize,
        at: (Gap<'_>, &Path<S>),
        evaluations: &mut u64,
    ) -> Tail {
        let bound = match self.surfaces[surface].bounds[self.level] {
            Some(bound) if self.suffices(&bound, order) => bound,
            known => self.bound(surface, (known, order), at, evaluations),
        };
        self.tail(&bound, self.scale(bound.takes) / LEVELS[self.level], order)
    }

    /// The estimate with a box made for this step alone.
    #[cold]
    fn estimate_alone(
        &self,
        order: usize,
        (gap, path): (Gap<'_>, &Path<S>),
        evaluations: &mut u64,
    ) -> Tail {
        let mut bounded = |part: f64| {
            *evaluations += 1;
            let varying =
                |real: Interval, radius: f64| ComplexInterval::varying(real, part * radius);
            let component = |i: usize| match i < self.room.positions() {
                true => varying(disk(path, &self.radii, i), self.radii.as_slice()[i]),
                false => ComplexInterval::steady(path.value(i)),
            };
            let time = varying(times(path, self.time_radius), self.time_radius);
            gap(time, &component)
        };
        let mut bound = Bound::new(bounded(1.0), Takes::EVERYTHING, self.ratio);
        if !self.suffices(&bound, order) {
            bound.sharpen(bounded(PARTS[self.ratio]));
        }
        self.tail(&bound, 1.0, order)
    }

    /// Bound of the missing terms of a step whose radii are those of the box of `bound`.
    #[inline]
    fn missing(&self, bound: &Bound, order: usize) -> f64 {
        let is_whole = bound
            .degree
            .and_then(|degree| degree.checked_mul(self.degree))
            .is_some_and(|degree| degree as usize <= order);
        match is_whole {
            true => 0.0,
            false => 2.0 * bound.height / (POWERS[self.ratio][order] * self.beyond()),
        }
    }

    /// True if the rounding errors are bounded well, or small beside the missing terms.
    #[inline]
    fn suffices(&self, bound: &Bound, order: usize) -> bool {
        bound.is_sharp || bound.rounding + bound.floor <= SMALL * self.missing(bound, order)
    }

    /// Distance of the disk from the step, in step lengths.
    #[inline]
    fn beyond(&self) -> f64 {
        RATIOS[self.ratio] - 1.0
    }

    /// Bounds for a step whose radii are `scale` times those of the box of `bound`.
    #[inline]
    fn tail(&self, bound: &Bound, scale: f64, order: usize) -> Tail {
        let value = scale * self.missing(bound, order);
        let rounding = scale * bound.rounding;
        let terms = order as f64;
        Tail {
            value: (value + rounding) * UP,
            slope: (value * (terms + 1.0 + 1.0 / self.beyond()) + rounding * terms) * UP,
            floor: bound.floor,
        }
    }

    /// Bounds of a gap on the box that suffice for a series of this order, from those that are known. If the gap
    /// depends on positions that the box did not bound, the box is set anew.
    #[cold]
    fn bound(
        &mut self,
        surface: usize,
        (known, order): (Option<Bound>, usize),
        (gap, path): (Gap<'_>, &Path<S>),
        evaluations: &mut u64,
    ) -> Bound {
        let takes = match self.surfaces[surface].takes {
            Some(takes) => takes,
            None => {
                let takes = taken(gap, path);
                let all = Takes {
                    positions: self.kept.positions | takes.positions,
                    time: self.kept.time || takes.time,
                };
                if all != self.kept {
                    self.kept = all;
                    self.room.keep(all.positions);
                    self.surround(path);
                }
                takes
            }
        };
        let mut bounded = |part: f64| {
            *evaluations += 1;
            let varying =
                |real: Interval, height: f64| ComplexInterval::varying(real, part * height);
            let component = |i: usize| match i < self.room.positions() {
                true => varying(self.room.range(i), self.heights.as_slice()[i]),
                false => ComplexInterval::steady(path.value(i)),
            };
            let time = varying(self.room.times(), self.time_height);
            gap(time, &component)
        };
        let level = LEVELS[self.level];
        let mut bound = known.unwrap_or_else(|| Bound::new(bounded(level), takes, self.ratio));
        if !self.suffices(&bound, order) {
            bound.sharpen(bounded(PARTS[self.ratio] * level));
        }
        let kept = &mut self.surfaces[surface];
        (kept.takes, kept.bounds[self.level]) = (Some(takes), Some(bound));
        bound
    }

    /// Largest ratio of a radius of the step to the imaginary part of the box, over the quantities in `takes`.
    #[inline]
    fn scale(&self, takes: Takes) -> f64 {
        let mut scale = match takes.time {
            true => self.time_radius / self.time_height,
            false => 0.0,
        };
        let heights = self.heights.as_slice()[..self.room.positions()].iter();
        for (i, (height, radius)) in heights.zip(self.radii.as_slice()).enumerate() {
            if takes.positions & place(i) != 0 && *radius > scale * height {
                scale = radius / height;
            }
        }
        scale * UP
    }

    /// Finds the smallest level that contains the step.
    #[inline]
    fn choose_level(&mut self) {
        let scale = self.scale(self.kept);
        let level = LEVELS.iter().rposition(|&level| scale <= level);
        (self.level, self.fits) = (level.unwrap_or(0), level.is_some());
    }

    /// Extends the imaginary parts of the box to contain the step.
    fn rise(&mut self) {
        let heights = self.heights.as_mut_slice().iter_mut();
        for (height, radius) in heights.zip(self.radii.as_slice()) {
            if radius > height {
                *height = GROWTH * radius;
            }
        }
        if self.time_radius > self.time_height {
            self.time_height = GROWTH * self.time_radius;
        }
        (self.strain, self.level, self.fits) = (0, 0, true);
        self.discard_bounds();
    }

    /// Sets the box to that of the step.
    fn surround(&mut self, path: &Path<S>) {
        let Self { room, radii, .. } = self;
        room.surround_box(|i| disk(path, radii, i), times(path, self.time_radius));
        (self.heights, self.time_height) = (self.radii, self.time_radius);
        (self.strain, self.level) = (0, 0);
        (self.fits, self.is_new) = (true, true);
        self.discard_bounds();
    }

    fn discard_bounds(&mut self) {
        for surface in self.surfaces.iter_mut() {
            surface.bounds = [None; LEVELS.len()];
        }
    }
}

/// The quantities that a gap depends on, found by one evaluation.
fn taken<S: StateVector>(gap: Gap<'_>, path: &Path<S>) -> Takes {
    let positions = Cell::new(0_u64);
    let component = |i: usize| {
        positions.set(positions.get() | place(i));
        ComplexInterval::steady(path.value(i))
    };
    let gap = gap(ComplexInterval::ANYTHING, &component);
    Takes {
        positions: positions.get(),
        time: gap == ComplexInterval::ANYTHING,
    }
}

/// Interval of the real parts of component `i` on the disk.
#[inline]
fn disk<S: StateVector>(path: &Path<S>, radii: &S, i: usize) -> Interval {
    path.value(i).widened(radii.as_slice()[i])
}

/// Interval of the real parts of time on the disk.
#[inline]
fn times<S: StateVector>(path: &Path<S>, radius: f64) -> Interval {
    path.time([0.0, 0.0]).value.widened(radius)
}

#[cfg(test)]
mod tests;
