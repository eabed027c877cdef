//! Location of bifurcations between two members of a branch, as zeros of test functions.

use super::family::{Failure, Node, Unknowns};
use super::indicator::{Test, outside, passing};
use super::trace::{REACH, Tracer};
use super::{Bifurcation, Member};
use crate::linear::norm;

/// Length of a step below which an unexplained change of the stability does not shorten the step further.
const REFINED: f64 = 1e-4;

/// Maximum number of steps to a bifurcation.
const ZOOM: usize = 100;
/// Length of the last step to a bifurcation.
const LOCATED: f64 = 1e-13;

/// Largest distance of the members between which a branch point is interpolated.
const BESIDE: f64 = 1e-3;

/// Distance along the branch below which a fold and a branch point are one bifurcation: a pitchfork.
const SAME: f64 = 1e-4;

/// A bifurcation between two members, at a fraction of the step.
pub(super) struct Located {
    pub fraction: f64,
    pub member: Member,
}

impl Tracer<'_, '_> {
    /// The bifurcations between two members, in order.
    pub(super) fn bifurcations(
        &mut self,
        node: &Node,
        next: &Node,
        length: f64,
    ) -> Result<Vec<Located>, Failure> {
        let mut located: Vec<Located> = Vec::new();
        let mut passed = 0;
        if self.tests.is_empty() {
            return Ok(located);
        }
        for &test in self.tests {
            if let Some(values) = test.change([node, next], self.width, self.precision)? {
                // A sign may change without a bifurcation, for example if the product of two real multipliers passes 1.
                if let Some(found) = self.zero(test, [node, next], values, length)? {
                    passed += test.passing();
                    located.push(found);
                }
            }
        }
        let [_, on_circle] = self.precision.margins();
        let [before, after] =
            [node, next].map(|node| outside(&node.local.member.multipliers, on_circle));
        if before.abs_diff(after) > passed {
            // Several multipliers have crossed the unit circle inside without a change of sign at the ends.
            if length > REFINED {
                return Err(Failure::TooLong);
            }
            // One multiplier that crosses alone changes a sign. Without a change it only comes close to the circle, as where
            // an orbit shrinks to an equilibrium.
            if before.abs_diff(after) > passed + 1 {
                located.extend(self.together([node, next], length)?);
            }
        }
        let is_crossing =
            |located: &Located| located.member.bifurcation == Some(Bifurcation::BranchPoint);
        let crossing = located
            .iter()
            .find(|it| is_crossing(it))
            .map(|it| it.fraction);
        located.retain(|it| {
            let is_fold = it.member.bifurcation == Some(Bifurcation::Fold);
            let distance = crossing.map(|crossing| length * (crossing - it.fraction).abs());
            !(is_fold && distance.is_some_and(|distance| distance < SAME))
        });
        located.sort_by(|one, other| one.fraction.total_cmp(&other.fraction));
        Ok(located)
    }

    /// The member between two others at which a test function is 0; `None` if it is not a bifurcation.
    fn zero(
        &mut self,
        test: Test,
        [node, next]: [&Node; 2],
        values: [f64; 2],
        length: f64,
    ) -> Result<Option<Located>, Failure> {
        let constant = test.constant([node, next], self.precision);
        let mut bracket = Bracket::new(values);
        let (mut fraction, mut best) = (1.0, next.clone());
        for _ in 0..ZOOM {
            fraction = bracket.guess();
            best = match self.on_arc([node, next], fraction, REACH * length) {
                Ok(found) => found,
                Err(failure) if length > REFINED => return Err(failure),
                // Near a crossing, members of the other branch may be closer.
                Err(_) => break,
            };
            let value = test.value(&best, self.width, constant);
            if value.is_nan() {
                return Err(Failure::NotKnown);
            }
            if value == 0.0 || bracket.narrow(fraction, value) * length < LOCATED {
                break;
            }
        }
        if !test.is_met(&best, self.precision) {
            return Ok(None);
        }
        let refined = match test {
            Test::Crossing => self.crossing(fraction, [node, next], length).ok(),
            _ => None,
        };
        let mut member = refined.unwrap_or(best.local.member);
        member.bifurcation = Some(test.bifurcation());
        Ok(Some(Located { fraction, member }))
    }

    /// The member between two others at which several multipliers cross the unit circle at once, as in a system with
    /// equal parts. An even number of crossings does not change the sign of a test function. `None` if no multiplier is
    /// near the circle.
    fn together(
        &mut self,
        [node, next]: [&Node; 2],
        length: f64,
    ) -> Result<Option<Located>, Failure> {
        let precision = self.precision;
        let count = |node: &Node, margin| outside(&node.local.member.multipliers, margin);
        let change = |margin| count(node, margin).abs_diff(count(next, margin));
        // With the narrow margin, rounding may move multipliers that always lie on the circle to either side.
        let [narrow, wide] = precision.margins();
        let margin = if change(narrow) == change(wide) {
            narrow
        } else {
            wide
        };
        let before = count(node, margin);
        let passed = |node: &Node| {
            if count(node, margin) == before {
                -1.0
            } else {
                1.0
            }
        };
        let place = self.place([node, next], length, passed)?;
        let fraction = place.distance / next.distance;
        let mut member = place.local.member;
        member.bifurcation = passing(&member.multipliers, precision);
        Ok(member.bifurcation.map(|_| Located { fraction, member }))
    }

    /// The member between two others at which a number along the branch is 0.
    pub(super) fn place(
        &mut self,
        [node, next]: [&Node; 2],
        length: f64,
        number: impl Fn(&Node) -> f64,
    ) -> Result<Node, Failure> {
        let mut bracket = Bracket::new([node, next].map(&number));
        for _ in 0..ZOOM {
            let fraction = bracket.guess();
            let mut found = self.on_arc([node, next], fraction, REACH * length)?;
            let value = number(&found);
            if value == 0.0 || bracket.narrow(fraction, value) * length < LOCATED {
                let state = &found.local.member.state;
                found.distance = norm(&node.local.change_to(self.width, state, found.parameter()));
                return Ok(found);
            }
        }
        Err(Failure::Diverged)
    }

    /// The crossing with another branch, interpolated from members on both sides. Closer to the crossing, members of
    /// both branches differ by rounding only, and a test function has half of its digits.
    fn crossing(
        &mut self,
        near: f64,
        [node, next]: [&Node; 2],
        length: f64,
    ) -> Result<Member, Failure> {
        let distance = f64::min(BESIDE, 0.25 * length);
        let reach = f64::max(REACH * length, distance);
        let unit = distance / length;
        let sides = SIDES.map(|side| self.on_arc([node, next], near + side * unit, reach));
        let [a, b, c, d] = sides;
        let sides = [a?, b?, c?, d?];
        let place = self.root(&sides);
        let components = 0..node.local.member.state.len();
        let state: Vec<f64> = components
            .map(|index| interpolated(place, |k| sides[k].local.member.state[index]))
            .collect();
        let parameter = interpolated(place, |k| sides[k].parameter());
        Ok(self.family.local(&state, parameter)?.member)
    }

    /// The place of the zero of the determinant, in the units of [`SIDES`], interpolated from members on both sides.
    fn root(&self, sides: &[Node]) -> f64 {
        let values = sides
            .iter()
            .map(|side| Test::Crossing.value(side, self.width, 0));
        let values: Vec<f64> = values.collect();
        let at = |place: f64| interpolated(place, |k| values[k]);
        let mut bracket = Bracket::new([at(-1.0), at(1.0)]);
        let mut place = 0.0;
        for _ in 0..ZOOM {
            let fraction = bracket.guess();
            place = 2.0 * fraction - 1.0;
            if bracket.narrow(fraction, at(place)) < f64::EPSILON {
                break;
            }
        }
        place
    }

    /// The member closest to a fraction of the arc between two others.
    fn on_arc(&mut self, ends: [&Node; 2], fraction: f64, reach: f64) -> Result<Node, Failure> {
        let (state, along) = arc(ends, fraction, self.width);
        let local = self.corrected(&state, along, Unknowns::All, reach)?;
        Ok(Node::new(local, self.width, &ends[0].heading))
    }
}

/// State and parameter on the cubic Hermite arc between two members. Near a crossing, a point of the chord may be closer
/// to the other branch.
pub(super) fn arc([node, next]: [&Node; 2], fraction: f64, width: f64) -> (Vec<f64>, f64) {
    let rest = 1.0 - fraction;
    let ends = [
        rest * rest * (1.0 + 2.0 * fraction),
        fraction * fraction * (1.0 + 2.0 * rest),
    ];
    let slopes = [fraction * rest * rest, -fraction * fraction * rest];
    let at = |values: [f64; 2], headings: [f64; 2], scales: [f64; 2]| -> f64 {
        let parts = [0, 1]
            .map(|k| ends[k] * values[k] + slopes[k] * next.distance * headings[k] * scales[k]);
        parts[0] + parts[1]
    };
    let members = [node, next];
    let state = (0..node.local.member.state.len()).map(|index| {
        at(
            members.map(|it| it.local.member.state[index]),
            members.map(|it| it.heading[index]),
            members.map(|it| it.local.scale[index]),
        )
    });
    let headings = members.map(|it| it.heading.last().copied().unwrap_or(0.0));
    let parameter = at(members.map(Node::parameter), headings, [width; 2]);
    (state.collect(), parameter)
}

/// Places of members on both sides of a crossing, in units of the distance of the inner members.
const SIDES: [f64; 4] = [-2.0, -1.0, 1.0, 2.0];

/// The polynomial through the values at these places.
fn interpolated(at: f64, value: impl Fn(usize) -> f64) -> f64 {
    let weight = |k: usize| {
        let others = SIDES.iter().enumerate().filter(|(other, _)| *other != k);
        let factors = others.map(|(_, place)| (at - place) / (SIDES[k] - place));
        factors.product::<f64>()
    };
    (0..SIDES.len()).map(|k| weight(k) * value(k)).sum()
}

/// A bracket of a zero in a step, for the Illinois variant of false position.
struct Bracket {
    /// Fraction and value at both ends.
    ends: [(f64, f64); 2],
    /// The end that was moved last.
    moved: Option<usize>,
}

impl Bracket {
    fn new([first, last]: [f64; 2]) -> Self {
        Self {
            ends: [(0.0, first), (1.0, last)],
            moved: None,
        }
    }

    /// The next fraction: the zero of the secant, or the middle if the zero lies outside.
    fn guess(&self) -> f64 {
        let [low, high] = self.ends;
        let secant = (low.0 * high.1 - high.0 * low.1) / (high.1 - low.1);
        match secant > low.0 && secant < high.0 {
            true => secant,
            false => 0.5 * (low.0 + high.0),
        }
    }

    /// Moves the end whose value has the same sign. Returns the distance of the move, or the new length of the bracket
    /// if that is less.
    fn narrow(&mut self, fraction: f64, value: f64) -> f64 {
        let is_first = value.is_sign_negative() == self.ends[0].1.is_sign_negative();
        let end = usize::from(!is_first);
        let moved = (fraction - self.ends[end].0).abs();
        self.ends[end] = (fraction, value);
        if self.moved == Some(end) {
            self.ends[1 - end].1 *= 0.5;
        }
        self.moved = Some(end);
        f64::min(moved, self.ends[1].0 - self.ends[0].0)
    }
}
