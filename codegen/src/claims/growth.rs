//! Growth of `G` along a loop: as a sum over points, for the search, and as an enclosure, for the proof.
//!
//! The tangent of a loop in a leaf of the hull of D is a combination of the hull's elements. `dG` of the tangent is the
//! same combination of the values of `dG` that the elements demand. The enclosure divides the loop into cells, on which
//! the coordinates are intervals, and bisects cells until the sum over them excludes 0. The elements belong to a frame
//! of D, which may have poles on the loop. Another frame replaces it there.

use std::f64::consts::TAU;

use dalembert_expr::{
    Arithmetic, Ball, BallPoint, Domain, EnclosedPoint, Enclosures, ExpansionPoint, ExprId,
    Interval, JetSpace, Jets, RangePoint, Reals, Series,
};

use super::admissible::is_admissible;
use super::contraction::real_step;
use super::exactness::{Local, decide_local_in};
use super::frame::{choose_dependent, frame};
use super::linear::{Matrix, solve};
use super::obstruction::elements_in;
use super::problem::Problem;
use super::sample::{self, Sample};
use crate::model::Model;

/// Smallest and largest number of points of the trapezoidal rule, which converges geometrically for analytic periodic
/// functions. The number is doubled until the growth changes by at most the fraction [`CONVERGED`] of the integral of
/// the absolute value.
const POINTS: (usize, usize) = (32, 1024);
const CONVERGED: f64 = 1e-10;
/// Fraction of the integral of the absolute value below which a growth in doubles loses some of the printed digits.
const CANCELLED: f64 = 1e-2;
/// Absolute change of the growth that is allowed in addition, for loops along which all terms vanish.
const ROUNDING: f64 = 1e-12;
/// Offset of the points, as a fraction of the step.
const SHIFT: f64 = 0.382;
/// Number of cells of the first enclosure, and number of enclosures after which the question stays open.
const CELLS: usize = 32;
const ENCLOSURES: usize = 1024;
/// Orders of the series in cells. The second order is tried where the growth is small relative to the variation of `G`.
const ORDERS: [usize; 2] = [2, 8];
/// Number of monomials beyond which a series is not computed.
const MONOMIALS: usize = 2000;
/// Seed for the hull in other frames.
const SEED: u64 = 7;
/// Number of frames among which a regular one is sought.
const FRAMES: usize = 4;

/// A loop: some coordinates turn around their circles.
pub(super) struct Loop<'l> {
    model: &'l Model,
    problem: &'l Problem,
    /// The coordinates and their numbers of turns.
    turns: &'l [(usize, i64)],
    /// The hull in frames that are regular on parts of the loop.
    frames: Vec<Local>,
    /// Subexpressions of the velocity-linear part, the potential and the forces. A motion exists where all of them have
    /// values.
    defined: Vec<ExprId>,
}

/// Reason why the growth along a loop is not certified to differ from 0.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Uncertain {
    /// The loop may leave the domain of the declaration.
    Leaves,
    /// The growth is too small relative to the variation of `G`, or its sum does not converge.
    Small,
}

/// A part of a loop, with its contribution to the growth. `ends` are fractions of the loop.
struct Cell {
    ends: [f64; 2],
    part: Option<Interval>,
}

/// A box around a part of a loop, and one around its middle.
struct Places {
    whole: EnclosedPoint,
    middle: EnclosedPoint,
    /// The middle, as a fraction of the loop.
    fraction: f64,
    /// The length of the part; the whole loop has length 2 pi.
    length: Interval,
}

impl<'l> Loop<'l> {
    /// A loop in a leaf of the hull of `local`. `turns`: coordinates and their numbers of turns.
    pub(super) fn new(
        model: &'l Model,
        problem: &'l Problem,
        local: &Local,
        turns: &'l [(usize, i64)],
    ) -> Self {
        let mut roots = model.lagrangian.linear.clone();
        roots.push(model.lagrangian.potential);
        roots.extend(model.forces.iter().flat_map(|force| &force.form));
        Self {
            model,
            problem,
            turns,
            frames: vec![local.clone()],
            defined: model.pool.reachable(&roots),
        }
    }

    /// Growth with all printed digits, certified to differ from 0. The certificate holds for all values of the symbols
    /// within their ranges in `ranges`. Symbols without such a range have their values in the sample, up to rounding.
    ///
    /// # Errors
    /// [`Uncertain`] if the growth is not certified.
    pub(super) fn certified(&mut self, sample: &Sample, ranges: &Domain) -> Result<f64, Uncertain> {
        let (growth, size, points) = self.converged_by(sample).ok_or(Uncertain::Small)?;
        let mut domain = sample.ranges();
        let others = sample::sample(self.model, 0, |symbol| sample.value(symbol).is_none());
        domain.extend(others.ranges());
        for (i, coordinate) in self.model.coordinates.iter().enumerate() {
            let velocity = Interval::point(real_step(i));
            domain.push((coordinate.qdot, velocity));
        }
        for (symbol, range) in &mut domain {
            if let Some((_, given)) = ranges.iter().find(|(name, _)| name == symbol) {
                *range = *given;
            }
        }
        if !is_admissible(self.model, sample) {
            return Err(Uncertain::Leaves);
        }
        self.certify(sample, &domain, growth)?;
        match growth.abs() < CANCELLED * size {
            true => self.precise(sample, 2 * points).ok_or(Uncertain::Small),
            false => Ok(growth),
        }
    }

    /// Growth of `G`, and the integral of the absolute values of the terms of its rate; `None` if they do not converge.
    pub(super) fn converged(&self, sample: &Sample) -> Option<(f64, f64)> {
        let (growth, size, _) = self.converged_by(sample)?;
        Some((growth, size))
    }

    /// Growth, integral of the absolute values, and number of points.
    fn converged_by(&self, sample: &Sample) -> Option<(f64, f64, usize)> {
        let mut points = POINTS.0;
        let mut coarse = self.sum(sample, points)?;
        while points < POINTS.1 {
            points *= 2;
            let fine = self.sum(sample, points)?;
            if (fine.0 - coarse.0).abs() <= CONVERGED * fine.1 + ROUNDING {
                return Some((fine.0, fine.1, points));
            }
            coarse = fine;
        }
        None
    }

    /// Growth and integral of the absolute values from a number of points.
    pub(super) fn sum(&self, sample: &Sample, points: usize) -> Option<(f64, f64)> {
        let (mut sum, mut size) = (0.0, 0.0);
        for k in 0..points {
            // NOTE: the points avoid fractions of pi, where frames of D often have poles that the density does not
            // have.
            let turn = (k as f64 + SHIFT) / points as f64;
            let mut point = sample.point();
            for (i, count) in self.turns {
                point.set(self.model.coordinates[*i].q, TAU * turn * *count as f64);
            }
            for part in self.parts(&self.frames[0], 0, &mut point)? {
                let part = part.first().copied().unwrap_or(0.0);
                sum += part;
                size += part.abs();
            }
        }
        let step = TAU / points as f64;
        sum.is_finite().then_some((sum * step, size * step))
    }

    /// The sum by a number of points, computed with 76 digits.
    fn precise(&self, sample: &Sample, points: usize) -> Option<f64> {
        let whole = Ball::pi() * Ball::integer(2);
        let step = Ball::integer(points as i64).inverse()?;
        let mut point = BallPoint::of(&sample.point());
        let mut sum = Ball::ZERO;
        for k in 0..points {
            // NOTE: the sum converges for equidistant points. `k + SHIFT` in doubles are not equidistant.
            let turn = (Ball::integer(k as i64) + Ball::double(SHIFT)) * step;
            for (i, count) in self.turns {
                let angle = whole * turn * Ball::integer(*count);
                point.set_symbol(self.model.coordinates[*i].q, angle);
            }
            for part in self.parts(&self.frames[0], 0, &mut point)? {
                sum = sum + part.first().copied().unwrap_or(Ball::ZERO);
            }
        }
        Some((sum * whole * step).nearest())
    }

    /// Terms of the derivative of `G` along the loop, as series of order `order`; `None` where the elements of the hull
    /// are dependent.
    fn parts<P: ExpansionPoint>(
        &self,
        local: &Local,
        order: usize,
        point: &mut P,
    ) -> Option<Vec<Series<P::Field>>> {
        let (pool, problem, hull) = (&self.model.pool, self.problem, &local.hull);
        let space = self.space(local, order)?;
        let jets = Jets::new(point.field(), &space);
        let given = Some(local.dependent.as_slice());
        let elements = elements_in(pool, problem, &jets, (hull, given), point)?;
        let width = problem.components();
        let basis = || hull.basis.iter().map(|e| &elements[*e]);
        let vectors: Matrix<P::Field> = basis().map(|element| element[..width].to_vec()).collect();
        // The tangent is a combination of the basis. As many components as basis vectors determine it.
        let components = choose_dependent(&jets, &vectors)?;
        let (mut rows, mut tangent) = (Matrix::<P::Field>::new(), Matrix::<P::Field>::new());
        for i in components {
            rows.push(vectors.iter().map(|vector| vector[i].clone()).collect());
            let turns = self.turns.iter().find(|(turning, _)| *turning == i);
            let count = turns.map_or(0, |(_, count)| *count);
            tangent.push(vec![jets.constant(jets.field.integer(count))]);
        }
        let coefficients = solve(&jets, rows, tangent)?.unknowns;
        let demands = basis().map(|element| &element[width]);
        let parts = demands.zip(&coefficients);
        Some(parts.map(|(demand, c)| jets.mul(demand, &c[0])).collect())
    }

    /// The monomials of series of order `order` after the brackets of a hull, each of which takes one order.
    fn space(&self, local: &Local, order: usize) -> Option<JetSpace> {
        let order = local.hull.growth.len() + order;
        JetSpace::new(self.problem.variables.len(), order, MONOMIALS)
    }

    /// Looks for an enclosure of the growth that excludes 0.
    fn certify(&mut self, sample: &Sample, domain: &Domain, growth: f64) -> Result<(), Uncertain> {
        let mut found = Err(Uncertain::Small);
        for order in ORDERS {
            found = self.certify_by(order, sample, domain, growth);
            if found != Err(Uncertain::Small) {
                break;
            }
        }
        found
    }

    /// Looks for an enclosure that excludes 0, by series of order `order`.
    fn certify_by(
        &mut self,
        order: usize,
        sample: &Sample,
        domain: &Domain,
        growth: f64,
    ) -> Result<(), Uncertain> {
        let ends = |k: usize| [k, k + 1].map(|cell| cell as f64 / CELLS as f64);
        let mut cells: Vec<Cell> = (0..CELLS)
            .map(|k| self.cell(ends(k), order, sample, domain))
            .collect();
        let mut count = CELLS;
        loop {
            let parts: Option<Vec<Interval>> = cells.iter().map(|cell| cell.part).collect();
            let total = parts.map(|parts| parts.into_iter().fold(Interval::ZERO, |a, b| a + b));
            if total.is_some_and(Interval::excludes_zero) {
                return Ok(());
            }
            let width = total.map_or(f64::INFINITY, |total| total.hi - total.lo);
            // NOTE: the width falls like the cell length to the power `order`. `needed` cells make it as small as the
            // growth.
            let excess = (width / growth.abs()).powf(1.0 / order as f64);
            let needed = excess * cells.len() as f64;
            let is_beyond = |count: f64| count > ENCLOSURES as f64;
            if is_beyond((count + cells.len()) as f64) || (width.is_finite() && is_beyond(needed)) {
                return Err(match total {
                    Some(_) => Uncertain::Small,
                    None => Uncertain::Leaves,
                });
            }
            let wide = width / (2 * cells.len()) as f64;
            let mut finer = Vec::with_capacity(2 * cells.len());
            for cell in cells {
                if cell.part.is_some_and(|part| part.hi - part.lo < wide) {
                    finer.push(cell);
                    continue;
                }
                let [start, end] = cell.ends;
                let middle = f64::midpoint(start, end);
                for ends in [[start, middle], [middle, end]] {
                    finer.push(self.cell(ends, order, sample, domain));
                    count += 1;
                }
            }
            cells = finer;
        }
    }

    fn cell(&mut self, ends: [f64; 2], order: usize, sample: &Sample, domain: &Domain) -> Cell {
        let turn = Interval::pi() * Interval::point(2.0);
        let place = |from: f64, to: f64| {
            let mut place = EnclosedPoint::new(domain.clone());
            for (i, count) in self.turns {
                let angle = turn * Interval::point(*count as f64) * Interval::new(from, to);
                place.set_symbol(self.model.coordinates[*i].q, angle);
            }
            place
        };
        let fraction = f64::midpoint(ends[0], ends[1]);
        let places = Places {
            whole: place(ends[0], ends[1]),
            middle: place(fraction, fraction),
            fraction,
            length: turn * Interval::point(ends[1] - ends[0]),
        };
        let part = match self.is_defined(&places.whole) {
            true => self.integral(&places, order, sample),
            false => None,
        };
        Cell { ends, part }
    }

    /// True if the velocity-linear part, the potential and the forces have values everywhere in a box.
    fn is_defined(&self, place: &EnclosedPoint) -> bool {
        let values = place.clone().values(&self.model.pool, &self.defined);
        values.is_some_and(|values| {
            let mut ranges = self.defined.iter().map(|id| values[id.index()]);
            ranges.all(|range| range.magnitude().is_finite())
        })
    }

    /// The growth along a part of the loop, in the first frame that is regular there.
    fn integral(&mut self, places: &Places, order: usize, sample: &Sample) -> Option<Interval> {
        let mut frames = self.frames.iter();
        let found = frames.find_map(|local| self.integral_in(local, places, order));
        if found.is_some() || self.frames.len() == FRAMES {
            return found;
        }
        let local = self.regular_at(places.fraction, sample)?;
        let found = self.integral_in(&local, places, order);
        self.frames.push(local);
        found
    }

    /// Integral of `r = dG/ds` over a part of length `h`: the intersection of `h r` and Taylor's formula about the
    /// middle, `sum of h^(j+1) / (2^j (j+1)!) r^(j)` over even `j`, with the last derivative anywhere in the part.
    fn integral_in(&self, local: &Local, places: &Places, order: usize) -> Option<Interval> {
        let space = self.space(local, order)?;
        let jets = Jets::new(Enclosures, &space);
        let sum = |place: &EnclosedPoint, order: usize| {
            let parts = self.parts(local, order, &mut place.clone())?.into_iter();
            parts.reduce(|a, b| jets.add(&a, &b))
        };
        let (mut whole, mut middle) = (sum(&places.whole, order)?, sum(&places.middle, order - 2)?);
        let direct = jets.value(&whole) * places.length;
        let mut weight = places.length;
        let mut centred = Interval::ZERO;
        for j in (0..=order).step_by(2) {
            let derivative = if j == order { &whole } else { &middle };
            centred = centred + weight * jets.value(derivative);
            [whole, middle] =
                [whole, middle].map(|series| self.along(&jets, &self.along(&jets, &series)));
            let factorial = Interval::point(((j + 2) * (j + 3) * 4) as f64).inverse()?;
            weight = weight * places.length * places.length * factorial;
        }
        Some(Interval::new(
            direct.lo.max(centred.lo),
            direct.hi.min(centred.hi),
        ))
    }

    /// The derivative of a series along the loop.
    fn along(&self, jets: &Jets<'_, Enclosures>, series: &[Interval]) -> Series<Enclosures> {
        let mut sum = Vec::new();
        for (i, count) in self.turns {
            if let Ok(v) = self.problem.variables.binary_search(i) {
                let turns = Interval::point(*count as f64);
                sum = jets.add_multiple(&sum, turns, &jets.derivative(series, v));
            }
        }
        sum
    }

    /// The hull in a frame that is regular at a fraction of the loop; `None` if this frame is known already.
    fn regular_at(&self, turn: f64, sample: &Sample) -> Option<Local> {
        let mut point = sample.point();
        for (i, count) in self.turns {
            point.set(self.model.coordinates[*i].q, TAU * turn * *count as f64);
        }
        let (pool, problem) = (&self.model.pool, self.problem);
        let space = JetSpace::new(problem.variables.len(), 1, usize::MAX)?;
        let frame = frame(pool, problem, &Jets::new(Reals, &space), &mut point, None)?;
        if self
            .frames
            .iter()
            .any(|known| known.dependent == frame.dependent)
        {
            return None;
        }
        decide_local_in(pool, problem, &frame.dependent, SEED).ok()
    }
}
