//! Pseudo-arclength continuation: steps along the branch with orthogonal corrections.
//!
//! Lengths are measured in the units of the state and, for the parameter, in the length of its range. A correction is
//! the shortest Newton step (Moore-Penrose inverse). It needs no additional equation, and also converges where orbits
//! form a family at a constant parameter.

use super::family::{Failure, Family, Local, Node, Unknowns};
use super::indicator::{Precision, Test, is_degenerate};
use super::locate::{Located, arc};
use super::{Branch, BranchEnd, Extent, Member};
use crate::linear::{dot, norm};

/// Length of the first step.
const FIRST: f64 = 0.01;
/// Largest length of a step.
const LONGEST: f64 = 0.2;
/// Smallest length of a step.
const SHORTEST: f64 = 1e-9;

/// Largest change of the parameter in a step, as a fraction of the range.
const WIDEST: f64 = 0.04;

/// Cosine of the largest angle between the directions at both ends of a step (10 degrees).
const TURN: f64 = 0.984_8;
/// Cosine of the angle below which the next step is longer (3 degrees).
const STRAIGHT: f64 = 0.998_6;

/// Largest correction, as a fraction of the step.
pub(super) const REACH: f64 = 0.1;

/// Maximum number of steps with which a branch is followed from a member to a given one.
const RETURNS: usize = 8;
/// Distance below which two members are the same.
const SAME: f64 = 1e-6;

/// Maximum number of Newton steps.
const NEWTON: usize = 12;

/// A branch ends at a grazing orbit if the speed of an arrival, extrapolated linearly, is 0 within this distance.
const GRAZING: f64 = 1e-5;

/// Fraction of the largest rate of the state, and distance of a multiplier from 1, below which an orbit counts as about to
/// become an equilibrium.
///
/// NOTE: closer to the equilibrium, any neighbouring point closes within the rounding of the return map.
const AT_REST: (f64, f64) = (1e-3, 1e-2);

/// Largest decrease of the rate of the state in a step, as a factor.
const SLOWER: f64 = 0.25;

/// Points within this distance of an end inside the range, along the branch, are left out.
const CROWDED: f64 = 1e-3;

/// Largest deviation of a step from the arc of a circle that its directions imply, as a fraction of the arc's height. A
/// member of a neighbouring sheet lies off this arc.
const UNEVEN: f64 = 0.25;
/// Additional deviation, as a fraction of the step.
const CROOKED: f64 = 1e-3;

/// Observer of the points of a branch.
pub(crate) type Watch<'a> = &'a mut dyn FnMut(&Member);

/// State of a continuation.
pub(crate) struct Tracer<'a, 'w> {
    pub(super) family: &'a mut dyn Family,
    extent: Extent,
    /// Maximum number of steps in either direction.
    points: u32,
    /// The unit of the parameter: the length of the range.
    pub(super) width: f64,
    watch: Watch<'w>,
    pub(super) precision: Precision,
    /// The test functions whose zeros are located.
    pub(super) tests: &'static [Test],
    /// The range of the last component of the state, if it is limited.
    window: Option<[f64; 2]>,
    /// Members that may lie on the branch.
    sought: Vec<Sought>,
}

/// A member that may lie on a branch.
struct Sought {
    /// The member; `None` if no member is near the given state.
    local: Option<Local>,
    is_met: bool,
}

impl<'a, 'w> Tracer<'a, 'w> {
    pub fn new(
        family: &'a mut dyn Family,
        extent: Extent,
        points: u32,
        watch: Watch<'w>,
        precision: Precision,
    ) -> Self {
        Self {
            family,
            extent,
            points,
            width: extent.width(),
            watch,
            precision,
            tests: &Test::ALL,
            window: None,
            sought: Vec::new(),
        }
    }

    /// Ends the branch also where the last component of the state leaves this range, and locates no bifurcations.
    pub fn within(&mut self, window: [f64; 2]) {
        self.window = Some(window);
        self.tests = &[];
    }

    /// Records from now on which of the members near these states lie on the branch. All have the same `parameter`.
    pub fn seek(&mut self, states: &[Vec<f64>], parameter: f64) {
        let found = states.iter().map(|state| {
            let local = self.corrected(state, parameter, Unknowns::State, f64::INFINITY);
            Sought {
                local: local.ok(),
                is_met: false,
            }
        });
        self.sought = found.collect();
    }

    /// One value per member that was sought: true if the branch passes through it.
    pub fn met(&self) -> impl Iterator<Item = bool> {
        self.sought.iter().map(|sought| sought.is_met)
    }

    /// The branch through the member near a state.
    pub fn branch(&mut self, state: &[f64], parameter: f64) -> Result<Branch, Failure> {
        let local = self.corrected(state, parameter, Unknowns::State, f64::INFINITY)?;
        let mut rising = vec![0.0; local.member.state.len()];
        rising.push(1.0);
        let start = Node::new(local, self.width, &rising);
        let [low, high] = self.extent.limits();
        let is_outside = start.parameter() < low || start.parameter() > high;
        let start = match is_outside {
            true => match self.approached(start)? {
                Ok(start) => start,
                Err(end) => {
                    return Ok(Branch {
                        points: Vec::new(),
                        ends: [end; 2],
                        curves: Vec::new(),
                    });
                }
            },
            false => start,
        };
        let start = self.shifted(start);
        Ok(self.both_ways(&start))
    }

    /// Follows the branch from a member outside the range to the nearer end of the range. Returns the member there, or
    /// the end of the branch if it does not reach the range.
    fn approached(&mut self, start: Node) -> Result<Result<Node, BranchEnd>, Failure> {
        let [low, high] = self.extent.limits();
        let from = start.parameter();
        // The branch may first move away from the range, at most by its distance from the range.
        let (limits, is_rising) = match from < low {
            true => ([from - (low - from), low], true),
            false => ([high, from + (from - high)], false),
        };
        let start = match is_rising {
            true => start,
            false => start.reversed(),
        };
        let mut last = start.clone();
        let end = self.followed(&start, limits, &mut |_, _, next| last = next.clone());
        let is_there = [low, high].contains(&last.parameter());
        Ok(match end {
            BranchEnd::Range if is_there && is_rising => Ok(last),
            BranchEnd::Range if is_there => Ok(last.reversed()),
            BranchEnd::Range => Err(BranchEnd::Turned),
            end => Err(end),
        })
    }

    /// The member, or a neighbour if the member is a bifurcation: bifurcations are located between two members.
    fn shifted(&mut self, start: Node) -> Node {
        if !is_degenerate(&start, self.tests, self.width, self.precision) {
            return start;
        }
        let is_room = start.parameter() + FIRST * self.width < self.extent.limits()[1];
        let length = if is_room { FIRST } else { -FIRST };
        self.reached(&start, length, None).unwrap_or(start)
    }

    fn both_ways(&mut self, start: &Node) -> Branch {
        let is_rising = self.extent.range[0] < self.extent.range[1];
        let falling = start.reversed();
        let [back, forth] = match is_rising {
            true => [&falling, start],
            false => [start, &falling],
        };
        let (before, first) = self.side(back);
        let (after, last) = match first {
            // The other side is the same closed branch.
            BranchEnd::Closed => (Vec::new(), BranchEnd::Closed),
            _ => self.side(forth),
        };
        let mut points: Vec<Member> = before.into_iter().rev().collect();
        points.push(start.local.member.clone());
        points.extend(after);
        Branch {
            points,
            ends: [first, last],
            curves: Vec::new(),
        }
    }

    /// The branch from a member in its direction, with its bifurcations, and its end.
    fn side(&mut self, start: &Node) -> (Vec<Member>, BranchEnd) {
        let limits = self.extent.limits();
        let mut side: Vec<(Member, f64)> = Vec::new();
        let mut way = 0.0;
        let end = self.followed(start, limits, &mut |tracer, located, next| {
            let before = way;
            way += next.distance;
            for located in located {
                let at = before + located.fraction * next.distance;
                side.push((located.member.clone(), at));
            }
            side.push((next.local.member.clone(), way));
            (tracer.watch)(&next.local.member);
        });
        let last = side.len().saturating_sub(1);
        let is_crowded = |at: f64| end != BranchEnd::Range && at > way - CROWDED;
        let numbered = side.into_iter().enumerate();
        let kept = numbered.filter(|(index, (member, at))| {
            *index == last || member.bifurcation.is_some() || !is_crowded(*at)
        });
        (kept.map(|(_, (member, _))| member).collect(), end)
    }

    /// Follows the branch from a member until it ends. Calls `take` after each step, with the bifurcations in the step and
    /// the member at the end of the step.
    fn followed(
        &mut self,
        start: &Node,
        limits: [f64; 2],
        take: &mut dyn FnMut(&mut Self, &[Located], &Node),
    ) -> BranchEnd {
        self.family.begin(&start.local.member);
        let mut node = start.clone();
        let mut before = start.clone();
        let (mut length, mut made) = (FIRST, 0);
        let mut failures = Vec::new();
        let mut fastest = 0.0;
        while made < self.points {
            if self.leaves(&node, limits) {
                return BranchEnd::Range;
            }
            fastest = f64::max(fastest, node.local.pace);
            if is_at_rest(&node.local, fastest) {
                return BranchEnd::Equilibrium {
                    parameter: rest(&before, &node),
                };
            }
            let (next, located) = match self.stride(&node, length, limits) {
                Ok(made) => made,
                Err(_) if length < SHORTEST => {
                    return diagnosed([&before, &node], &failures);
                }
                Err(failure) => {
                    failures.push(failure);
                    length *= 0.5;
                    continue;
                }
            };
            failures.clear();
            made += 1;
            take(self, &located, &next);
            self.meet(&next, length);
            if made > 5 && self.is_back(&next, start, length) {
                return BranchEnd::Closed;
            }
            if dot(&node.heading, &next.heading) > STRAIGHT {
                length = f64::min(1.5 * length, LONGEST);
            }
            length = f64::min(length, WIDEST / next.rise().abs());
            before = std::mem::replace(&mut node, next);
        }
        match self.leaves(&node, limits) {
            true => BranchEnd::Range,
            false => BranchEnd::Points,
        }
    }

    /// True if the branch leads from a member, within a step, to the first member, and has the same direction there.
    fn is_back(&mut self, node: &Node, start: &Node, length: f64) -> bool {
        dot(&node.heading, &start.heading) > TURN && self.leads(node, &start.local, length)
    }

    /// True if the branch leads from a member, within a step, to another given member, and not to a neighbouring sheet.
    fn leads(&mut self, node: &Node, to: &Local, length: f64) -> bool {
        let width = self.width;
        let way = |node: &Node| to.change_to(width, &node.local.member.state, node.parameter());
        if norm(&way(node)) >= length {
            return false;
        }
        let mut near = node.clone();
        for _ in 0..RETURNS {
            let way = way(&near);
            if norm(&way) < SAME {
                return true;
            }
            match self.reached(&near, -dot(&way, &near.heading), None) {
                Ok(nearer) => near = nearer,
                Err(_) => return false,
            }
        }
        norm(&way(&near)) < SAME
    }

    /// Records the members that are sought and lie on the branch within a step of this one.
    fn meet(&mut self, node: &Node, length: f64) {
        for index in 0..self.sought.len() {
            let sought = &self.sought[index];
            let Some(local) = sought.local.clone().filter(|_| !sought.is_met) else {
                continue;
            };
            self.sought[index].is_met = self.leads(node, &local, length);
        }
    }

    /// True if the branch leaves the limits of the parameter, or the window, at this member.
    fn leaves(&self, node: &Node, limits: [f64; 2]) -> bool {
        let is_leaving = |at: f64, rate: f64, [low, high]: [f64; 2]| {
            (at >= high && rate > 0.0) || (at <= low && rate < 0.0)
        };
        let beyond = self.window.is_some_and(|window| {
            let rate = node.heading[node.heading.len() - 2];
            is_leaving(node.last(), rate, window)
        });
        beyond || is_leaving(node.parameter(), node.rise(), limits)
    }

    /// The next member, at this distance or at a limit of the parameter, and the bifurcations in between.
    fn stride(
        &mut self,
        node: &Node,
        length: f64,
        limits: [f64; 2],
    ) -> Result<(Node, Vec<Located>), Failure> {
        let crossed = |to: f64| {
            let ends = [node.parameter(), to];
            let is_between = |limit: &f64| (ends[0] - limit) * (ends[1] - limit) < 0.0;
            limits.into_iter().find(is_between)
        };
        let predicted = node.parameter() + self.width * length * node.rise();
        let next = match crossed(predicted) {
            Some(limit) => {
                let share = (limit - node.parameter()) / (predicted - node.parameter());
                self.reached(node, share * length, Some(limit))?
            }
            None => {
                let next = self.reached(node, length, None)?;
                match crossed(next.parameter()) {
                    Some(limit) => self.cut(node, &next, length, limit)?,
                    None => next,
                }
            }
        };
        let next = self.inside(node, next, length)?;
        if next.local.pace < SLOWER * node.local.pace {
            return Err(Failure::TooLong);
        }
        let located = self.bifurcations(node, &next, length)?;
        Ok((next, located))
    }

    /// The next member, or the member in between at which the last component of the state leaves its window.
    fn inside(&mut self, node: &Node, next: Node, length: f64) -> Result<Node, Failure> {
        let at = next.last();
        let mut window = self.window.into_iter().flatten();
        let Some(limit) = window.find(|limit| (node.last() - limit) * (at - limit) < 0.0) else {
            return Ok(next);
        };
        let mut place = self.place([node, &next], length, |node| node.last() - limit)?;
        if let Some(last) = place.local.member.state.last_mut() {
            *last = limit;
        }
        place.local.member.second = Some(limit);
        Ok(place)
    }

    /// The member near the end of a step of this length from another member, along its direction. If a value of the
    /// parameter is given, the member has this value.
    fn reached(
        &mut self,
        node: &Node,
        length: f64,
        parameter: Option<f64>,
    ) -> Result<Node, Failure> {
        let step: Vec<f64> = node.tangent.iter().map(|entry| length * entry).collect();
        let (state, along) = node.local.moved(self.width, &step);
        let (along, unknowns) = match parameter {
            Some(parameter) => (parameter, Unknowns::State),
            None => (along, Unknowns::All),
        };
        self.neighbour(node, (&state, along), unknowns, length)
    }

    /// The member between two others at a value of the parameter.
    fn cut(&mut self, node: &Node, next: &Node, length: f64, limit: f64) -> Result<Node, Failure> {
        let share = (limit - node.parameter()) / (next.parameter() - node.parameter());
        let (state, _) = arc([node, next], share, self.width);
        self.neighbour(node, (&state, limit), Unknowns::State, length)
    }

    /// The member near a predicted state and parameter, if it continues the branch.
    fn neighbour(
        &mut self,
        node: &Node,
        (state, parameter): (&[f64], f64),
        unknowns: Unknowns,
        length: f64,
    ) -> Result<Node, Failure> {
        let reach = REACH * length.abs();
        let local = match self.corrected(state, parameter, unknowns, reach) {
            Err(Failure::Diverged) => {
                // Beyond a grazing orbit the map has no smooth continuation, so that Newton's method fails.
                let local = self.family.local(state, parameter)?;
                let other = other_surface(&node.local, &local);
                return Err(other.map_or(Failure::Diverged, Failure::Itinerary));
            }
            corrected => corrected?,
        };
        if let Some(surface) = other_surface(&node.local, &local) {
            return Err(Failure::Itinerary(surface));
        }
        let mut next = Node::new(local, self.width, &node.heading);
        let way = node
            .local
            .change_to(self.width, &next.local.member.state, next.parameter());
        next.distance = norm(&way);
        match dot(&node.heading, &next.heading) >= TURN && bends_evenly(&way, node, &next) {
            true => Ok(next),
            false => Err(Failure::TooLong),
        }
    }

    /// The member near a state and a parameter, at a distance of at most `reach`, by Newton's method.
    pub(super) fn corrected(
        &mut self,
        state: &[f64],
        parameter: f64,
        unknowns: Unknowns,
        reach: f64,
    ) -> Result<Local, Failure> {
        let mut local = self.family.local(state, parameter)?;
        for _ in 0..NEWTON {
            let was_closed = local.is_closed;
            if local.member.residual == 0.0 {
                break;
            }
            let step = local.newton(self.width, unknowns);
            if norm(&step) > 2.0 * reach {
                return Err(Failure::Diverged);
            }
            let (to, along) = local.moved(self.width, &step);
            let along = match unknowns {
                Unknowns::All => along,
                Unknowns::State => parameter,
            };
            let better = self.family.local(&to, along)?;
            // One step after convergence reduces the residual to rounding.
            let is_better = better.member.residual < local.member.residual;
            if is_better || !was_closed {
                local = better;
            }
            if was_closed {
                break;
            }
        }
        let strayed = norm(&local.change_to(self.width, state, parameter)) > f64::max(reach, 1e-10);
        match local.is_closed && !strayed {
            true => Ok(local),
            false => Err(Failure::Diverged),
        }
    }
}

/// The end of a branch at whose last member even the shortest step fails. `last` are the last two members, `failures`
/// the failures of all steps from the last one.
fn diagnosed(last: [&Node; 2], failures: &[Failure]) -> BranchEnd {
    let grazed = failures.iter().rev().find_map(|failure| match failure {
        Failure::Itinerary(surface) => Some(*surface),
        Failure::Missed(error) => grazed(error),
        _ => None,
    });
    if let Some(surface) = grazed.or_else(|| slowing(last)) {
        return BranchEnd::Grazing { surface };
    }
    let mut ends = failures.iter().rev().map(ended);
    let told = ends.find(|end| *end != BranchEnd::NotConverged);
    told.unwrap_or(BranchEnd::NotConverged)
}

/// The end of a branch that this failure causes at the shortest step.
pub(super) const fn ended(failure: &Failure) -> BranchEnd {
    match failure {
        Failure::Parameter(error) => BranchEnd::Parameter(*error),
        Failure::Missed(error) => BranchEnd::Missed(*error),
        Failure::NotKnown => BranchEnd::NotKnown,
        Failure::Real => BranchEnd::Resonance,
        Failure::Diverged | Failure::Itinerary(_) | Failure::TooLong => BranchEnd::NotConverged,
    }
}

/// True if an orbit is about to become an equilibrium. The rate of the state also vanishes where an orbit comes to pass a
/// saddle point, but then no multiplier tends to 1.
fn is_at_rest(local: &Local, fastest: f64) -> bool {
    let (part, near) = AT_REST;
    let mut multipliers = local.member.multipliers.iter();
    local.pace < part * fastest && multipliers.any(|&[re, im]| f64::hypot(re - 1.0, im) < near)
}

/// The parameter at which the square of the rate of the state, extrapolated linearly, is 0. The square of the size of an
/// orbit is proportional to the distance from a Hopf bifurcation.
fn rest(before: &Node, last: &Node) -> f64 {
    let squares = [before, last].map(|node| node.local.pace * node.local.pace);
    let way = last.parameter() - before.parameter();
    let rest = last.parameter() + way * squares[1] / (squares[0] - squares[1]);
    if rest.is_finite() {
        rest
    } else {
        last.parameter()
    }
}

/// A surface that two orbits meet a different number of times.
fn other_surface(one: &Local, other: &Local) -> Option<usize> {
    let mut counts = one.arrivals.iter().zip(&other.arrivals);
    counts.position(|(one, other)| one != other)
}

/// The surface at which the speed of the slowest arrival is about to vanish, if there is one.
fn slowing([before, last]: [&Node; 2]) -> Option<usize> {
    let mut speeds = before.local.speeds.iter().zip(&last.local.speeds);
    speeds.position(|(before, speed)| {
        let slope = (before - speed) / last.distance;
        speed.is_finite() && slope > 0.0 && *speed < GRAZING * slope
    })
}

/// The grazed surface, if a grazing impact is the error.
fn grazed(error: &dalembert::OrbitError) -> Option<usize> {
    use dalembert::{OrbitError, SectionError, Undefined};
    match error {
        OrbitError::Section(SectionError::Undefined(Undefined::Graze { surface, .. })) => {
            Some(*surface)
        }
        _ => None,
    }
}

/// True if a step follows an arc of a circle: the angle between the directions at its ends determines its distance from
/// the tangent.
fn bends_evenly(way: &[f64], node: &Node, next: &Node) -> bool {
    let length = norm(way);
    let along = dot(way, &node.heading);
    let height = (length * length - along * along).max(0.0).sqrt();
    let angle = dot(&node.heading, &next.heading).clamp(-1.0, 1.0).acos();
    let expected = 0.5 * length * angle;
    (height - expected).abs() <= UNEVEN * expected + CROOKED * length
}
