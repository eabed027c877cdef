//! Curves of bifurcations over two parameters: zeros of the return map together with a test function.
//!
//! The first parameter is the last component of the state. The derivatives of the map are exact. The derivatives of the
//! test function need second derivatives of the map and are finite differences: they affect the speed of Newton's
//! method, not its result.

use dalembert::contract::Variational;
use dalembert::{Instance, Scene};

use super::family::{Failure, Family, Local};
use super::indicator::Precision;
use super::orbits::Orbits;
use super::trace::{Tracer, Watch, ended};
use super::{Bifurcation, BifurcationCurve, Branch, BranchEnd, Extent, Member};
use crate::linear::{add, determinant, norm};

/// Displacement of finite differences, in the units of the state and in the ranges of the parameters.
const APART: f64 = 1e-5;

/// Imaginary part below which a pair of multipliers is about to meet. It decreases like the square root of the distance
/// from the resonance.
const MEETING: f64 = 1e-3;

/// The plane of two parameters.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Plane {
    pub extents: [Extent; 2],
    /// The value of the second parameter on the branch.
    pub value: f64,
    /// Maximum number of points of a curve in either direction.
    pub points: u32,
}

/// The curves through the bifurcations of a branch.
pub(crate) fn curves<S: Instance + Scene + Variational>(
    orbits: &mut Orbits<'_, S>,
    branch: &Branch,
    plane: Plane,
    watch: Watch<'_>,
    precision: Precision,
) -> Vec<BifurcationCurve> {
    let points = branch.points.iter();
    let mut left: Vec<(&Member, Bifurcation)> = points
        .filter_map(|member| Some((member, member.bifurcation?)))
        .collect();
    let mut curves = Vec::new();
    while !left.is_empty() {
        let (member, bifurcation) = left.remove(0);
        let alike = left.iter().filter(|(_, kind)| *kind == bifurcation);
        let others: Vec<&Member> = alike.map(|(member, _)| *member).collect();
        orbits.begin(member);
        let mut family = Bifurcations {
            orbits,
            plane,
            bifurcation,
            precision,
            unit: 1.0,
        };
        let (curve, met) = family.curve(member, &others, watch);
        let mut met = met.into_iter();
        left.retain(|(_, kind)| *kind != bifurcation || !met.next().unwrap_or(false));
        curves.push(curve);
    }
    curves
}

/// Bifurcations of one kind over two parameters.
struct Bifurcations<'f, 'a, S: Variational> {
    orbits: &'f mut Orbits<'a, S>,
    plane: Plane,
    bifurcation: Bifurcation,
    precision: Precision,
    /// Factor of the test function. With it, the gradient at the first bifurcation has length 1.
    unit: f64,
}

impl<S: Instance + Scene + Variational> Bifurcations<'_, '_, S> {
    /// The curve through the bifurcation `member`. The second value has an entry for each of `others`: true if the curve
    /// passes through it.
    fn curve(
        &mut self,
        member: &Member,
        others: &[&Member],
        watch: Watch<'_>,
    ) -> (BifurcationCurve, Vec<bool>) {
        let Plane {
            extents,
            value,
            points,
        } = self.plane;
        let (bifurcation, precision) = (self.bifurcation, self.precision);
        let start = located(member);
        let none = |end: BranchEnd| BifurcationCurve {
            bifurcation,
            points: Vec::new(),
            ends: [end; 2],
        };
        let failed = |failure: Failure| (none(ended(&failure)), Vec::new());
        if let Err(failure) = self.normalise(&start) {
            return failed(failure);
        }
        let mut watch = |member: &Member| watch(&turned(member, bifurcation));
        let mut tracer = Tracer::new(self, extents[1], points, &mut watch, precision);
        tracer.within(extents[0].limits());
        let states: Vec<Vec<f64>> = others.iter().map(|member| located(member)).collect();
        tracer.seek(&states, value);
        match tracer.branch(&start, value) {
            Err(failure) => failed(failure),
            Ok(branch) => {
                let points = branch.points.iter();
                let ends = [branch.points.first(), branch.points.last()];
                let ends = [0, 1].map(|side| match (branch.ends[side], ends[side]) {
                    // Newton's method may fail before the resonance, because curves of other bifurcations meet this one
                    // there.
                    (BranchEnd::NotConverged, Some(member)) if meets(member) => {
                        BranchEnd::Resonance
                    }
                    (end, _) => end,
                });
                let curve = BifurcationCurve {
                    bifurcation,
                    points: points.map(|member| turned(member, bifurcation)).collect(),
                    ends,
                };
                (curve, tracer.met().collect())
            }
        }
    }

    /// Chooses the unit of the test function.
    fn normalise(&mut self, start: &[f64]) -> Result<(), Failure> {
        let local = self.local(start, self.plane.value)?;
        let columns = local.columns(self.plane.extents[1].width());
        let gradient: Vec<f64> = columns.iter().filter_map(|it| it.last().copied()).collect();
        let unit = 1.0 / norm(&gradient);
        // The derivative of a test function that is 0 for all orbits, as in a family at a constant parameter, is 0 up
        // to rounding.
        match unit.is_finite() && unit < 1.0 / APART {
            true => self.unit = unit,
            false => return Err(Failure::NotKnown),
        }
        Ok(())
    }

    /// The return map at values of both parameters, with its derivative with respect to one of them.
    fn at(&mut self, state: &[f64], values: [f64; 2], along: usize) -> Result<Local, Failure> {
        let [first, second] = self.plane.extents.map(|extent| extent.parameter);
        match along {
            0 => {
                self.orbits.hold(second, values[1]);
                self.orbits.along(state, first, values[0])
            }
            _ => {
                self.orbits.hold(first, values[0]);
                self.orbits.along(state, second, values[1])
            }
        }
    }

    /// The test function, which is 0 at a bifurcation and smooth near it.
    fn test(&self, local: &Local) -> Result<f64, Failure> {
        let mut columns = local.derivative.clone();
        let value = match self.bifurcation {
            Bifurcation::Fold | Bifurcation::BranchPoint => determinant(columns),
            Bifurcation::Flip => {
                for (index, column) in columns.iter_mut().enumerate() {
                    column[index] += 2.0;
                }
                determinant(columns)
            }
            Bifurcation::NeimarkSacker => {
                let excess = |&[re, im]: &[f64; 2]| re * re + im * im - 1.0;
                let complex = local.member.multipliers.iter().filter(|[_, im]| *im > 0.0);
                let excesses = complex.map(excess);
                let nearest = excesses.min_by(|one, other| one.abs().total_cmp(&other.abs()));
                nearest.ok_or(Failure::Real)?
            }
        };
        match value.is_finite() {
            true => Ok(self.unit * value),
            false => Err(Failure::NotKnown),
        }
    }

    /// The derivative of the test function along a change of the state and of the parameters. The difference is
    /// one-sided if the map does not exist on one side.
    fn slope(
        &mut self,
        state: &[f64],
        values: [f64; 2],
        (direction, shift): (&[f64], [f64; 2]),
        here: f64,
    ) -> Result<f64, Failure> {
        let mut beside = |side: f64| {
            let mut state = state.to_vec();
            add(&mut state, side, direction);
            let values = [0, 1].map(|index| values[index] + side * shift[index]);
            let local = self.at(&state, values, 0)?;
            self.test(&local)
        };
        match (beside(APART), beside(-APART)) {
            (Ok(after), Ok(before)) => Ok((after - before) / (2.0 * APART)),
            (Ok(after), Err(_)) => Ok((after - here) / APART),
            (Err(_), Ok(before)) => Ok((here - before) / APART),
            (Err(failure), Err(_)) => Err(failure),
        }
    }
}

impl<S: Instance + Scene + Variational> Family for Bifurcations<'_, '_, S> {
    fn local(&mut self, state: &[f64], parameter: f64) -> Result<Local, Failure> {
        let (first, section) = state.split_last().ok_or(Failure::NotKnown)?;
        let values = [*first, parameter];
        let widths = self.plane.extents.map(|extent| extent.width());
        let along = self.at(section, values, 0)?;
        let mut local = self.at(section, values, 1)?;
        let section = local.member.state.clone();
        let test = self.test(&local)?;
        let scaled = |vector: &[f64], width: f64| -> Vec<f64> {
            vector.iter().map(|entry| width * entry).collect()
        };
        for (direction, column) in local.directions.iter_mut().zip(&mut local.derivative) {
            column.push(self.slope(&section, values, (direction, [0.0; 2]), test)?);
            direction.push(0.0);
        }
        let mut shift = scaled(&along.shift, widths[0]);
        let mut column = scaled(&along.slope, widths[0]);
        column.push(self.slope(&section, values, (&shift, [widths[0], 0.0]), test)?);
        shift.push(widths[0]);
        local.derivative.push(column);
        local.directions.push(shift);
        let shift = scaled(&local.shift, widths[1]);
        let slope = self.slope(&section, values, (&shift, [0.0, widths[1]]), test)?;
        local.slope.push(slope / widths[1]);
        local.shift.push(0.0);
        local.scale.push(widths[0]);
        local.miss.push(test);
        local.is_closed &= test.abs() < self.precision.zero();
        local.member.residual = f64::hypot(local.member.residual, test);
        local.member.state.push(values[0]);
        local.member.second = Some(values[0]);
        Ok(local)
    }

    fn begin(&mut self, member: &Member) {
        self.orbits.begin(member);
    }
}

/// True if two complex multipliers on the unit circle are about to meet.
fn meets(member: &Member) -> bool {
    let mut multipliers = member.multipliers.iter();
    multipliers
        .any(|&[re, im]| im > 0.0 && im < MEETING && (f64::hypot(re, im) - 1.0).abs() < MEETING)
}

/// State and first parameter of a bifurcation on a branch.
fn located(member: &Member) -> Vec<f64> {
    let mut state = member.state.clone();
    state.push(member.parameter);
    state
}

/// A member of a curve with its parameters in the order of the request.
fn turned(member: &Member, bifurcation: Bifurcation) -> Member {
    let mut turned = member.clone();
    turned.second = Some(member.parameter);
    turned.parameter = member.second.unwrap_or(f64::NAN);
    turned.bifurcation = Some(bifurcation);
    turned
}
