//! A forward invariant set between two energies, for modes of one degree of freedom that follow each other in a cycle
//! (W. Clark, thesis, (4.13) to (4.15)).
//!
//! `E` is the kinetic energy after an impact. In a mode the motion gains the kinetic energy `P = V(entry) - V(exit)`.
//! It needs the kinetic energy `R = max V - V(entry)` at its entry to reach the exit. The impact at the exit keeps the
//! fraction `K` of the kinetic energy: `eta(E) = K (E + P)`. Start with the largest `R` and apply `eta` of each mode in
//! turn: every result must exceed the `R` of the next mode.

use dalembert_expr::{Interval, SymbolId};

use super::graph::{Edge, Node, Passage};
use super::{Decided, Reasoned, shown};
use crate::model::Topology;

/// Largest number of subintervals for the bound of a potential.
const PARTS: usize = 4096;

/// Relative width of the bound of a potential at which the subdivision ends.
const CLOSE: f64 = 1e-10;

/// One mode of the cycle.
#[derive(Debug, Clone, PartialEq)]
pub struct Step {
    /// Index of the mode.
    pub mode: usize,
    /// Name of the surface at its exit.
    pub surface: String,
    /// Coordinates of entry and exit.
    pub places: [Interval; 2],
    /// `R`: the kinetic energy at the entry that the motion needs to reach the exit.
    pub needed: Interval,
    /// `P`: the kinetic energy gained between entry and exit.
    pub gained: Interval,
    /// `K`: the fraction of the kinetic energy that the impact keeps.
    pub kept: Interval,
    /// The kinetic energy after the impact, for a motion that enters the first mode of the cycle with its `R`, the
    /// largest one.
    pub reached: Interval,
    /// `R` of the next mode.
    pub next: Interval,
}

impl Step {
    /// True if the inequality (4.13) holds; `None` if the intervals overlap.
    pub fn holds(&self) -> Option<bool> {
        match (
            self.reached.lo > self.next.hi,
            self.reached.hi <= self.next.lo,
        ) {
            (true, _) => Some(true),
            (_, true) => Some(false),
            _ => None,
        }
    }
}

/// The energies of one cycle through the modes.
#[derive(Debug, Clone, PartialEq)]
pub struct Cascade {
    /// The steps, starting with the mode that has the largest `R`.
    pub steps: Vec<Step>,
    /// The product of all `K`: the multiplier of the periodic orbit.
    pub multiplier: Interval,
    /// The kinetic energy of the periodic orbit after the impact into the first mode, if it is known.
    pub energy: Option<Interval>,
}

/// The energies of the cycle of modes, or the reason why there are none.
pub(super) fn cascade(nodes: &[Node], edges: &[Edge]) -> Result<Cascade, String> {
    let cycle = cycle(nodes.len(), edges)?;
    let mut passages = Vec::new();
    for edge in &cycle {
        passages.push(edge.passage.clone()?);
    }
    let count = cycle.len();
    let mut steps = Vec::new();
    let mut signs = Vec::new();
    for (index, edge) in cycle.iter().enumerate() {
        let entry = passages[(index + count - 1) % count].entry;
        let [from, to] = [edge.from, edge.to].map(|mode| &nodes[mode]);
        let (step, sign) = step(from, to, edge, entry, &passages[index])?;
        signs.push((sign, passages[index].factor));
        steps.push(step);
    }
    for (index, (sign, factor)) in signs.iter().enumerate() {
        let (next, _) = signs[(index + 1) % count];
        let turned = match (factor.lo > 0.0, factor.hi < 0.0) {
            (true, _) => *sign,
            (_, true) => !*sign,
            _ => return Err(format!("`{}` may stop the motion", steps[index].surface)),
        };
        if turned != next {
            let text = "after it the motion leads away from the next surface";
            return Err(format!("`{}`: {text}", steps[index].surface));
        }
    }
    Ok(run_through(steps))
}

/// The surfaces of the cycle that is reached from the first mode.
fn cycle(count: usize, edges: &[Edge]) -> Result<Vec<&Edge>, String> {
    let mut seen: Vec<(usize, &Edge)> = Vec::new();
    let mut mode = 0;
    for _ in 0..=count {
        let mut out = edges.iter().filter(|edge| edge.from == mode);
        let (Some(edge), None) = (out.next(), out.next()) else {
            return Err("a mode is left through no surface, or through several".to_owned());
        };
        if let Some(start) = seen.iter().position(|(known, _)| *known == mode) {
            return Ok(seen[start..].iter().map(|(_, edge)| *edge).collect());
        }
        seen.push((mode, edge));
        mode = edge.to;
    }
    Err("the modes do not form a cycle".to_owned())
}

/// The energies of one mode, and true if the coordinate increases during the motion.
fn step(
    from: &Node,
    to: &Node,
    edge: &Edge,
    entry: Interval,
    passage: &Passage,
) -> Result<(Step, bool), String> {
    let model = &from.model;
    let Some([position, _]) = from.symbols() else {
        return Err("the energies of a first-order system are not known".to_owned());
    };
    if !model.forces.is_empty() {
        return Err("forces act, so that the energy between impacts is not known".to_owned());
    }
    let places = [entry, passage.exit];
    let goes_up = match (entry.hi < passage.exit.lo, passage.exit.hi < entry.lo) {
        (true, _) => true,
        (_, true) => false,
        _ => {
            let text = "is entered where it ends, so that no motion passes through it";
            return Err(format!("the mode before `{}` {text}", edge.name));
        }
    };
    let toward = match goes_up {
        true => passage.slope.hi < 0.0,
        false => passage.slope.lo > 0.0,
    };
    if !toward {
        return Err(format!(
            "the gap of `{}` does not fall on the way to it",
            edge.name
        ));
    }
    let unknown = || format!("the energies before `{}` may have no value", edge.name);
    let potential = |place: Interval| {
        let range = from.range(model.lagrangian.potential, &[(position, place)]);
        range.filter(|range| range.lo.is_finite() && range.hi.is_finite())
    };
    let mass = |node: &Node, place: Interval| {
        let [position, _] = node.symbols()?;
        let mass = node.range(node.model.lagrangian.metric[0][0], &[(position, place)]);
        mass.filter(|mass| mass.lo > 0.0 && mass.hi.is_finite())
    };
    let hull = Interval::new(entry.lo.min(passage.exit.lo), entry.hi.max(passage.exit.hi));
    mass(from, hull).ok_or_else(unknown)?;
    stays(from, position, hull)?;
    let ends = places.map(potential);
    let [Some(first), Some(last)] = ends else {
        return Err(unknown());
    };
    let highest = highest(hull, &potential).ok_or_else(unknown)?;
    let needed = highest + -first;
    let masses = [mass(from, passage.exit), mass(to, passage.entry)];
    let [Some(before), Some(after)] = masses else {
        return Err(unknown());
    };
    let inverse = before.inverse().ok_or_else(unknown)?;
    let square = passage.factor.abs();
    let step = Step {
        mode: edge.from,
        surface: edge.name.clone(),
        places,
        needed: Interval::new(needed.lo.max(0.0), needed.hi.max(0.0)),
        gained: first + -last,
        kept: after * square * square * inverse,
        reached: Interval::WHOLE,
        next: Interval::WHOLE,
    };
    Ok((step, goes_up))
}

/// Checks that no surface ends the motion before the exit, and that the coordinate stays in its declared interval.
fn stays(node: &Node, position: SymbolId, hull: Interval) -> Result<(), String> {
    let model = &node.model;
    for surface in model
        .surfaces
        .iter()
        .filter(|surface| !surface.law.goes_on())
    {
        let gap = node.range(surface.gap, &[(position, hull)]);
        if !gap.is_some_and(|gap| gap.lo > 0.0) {
            let name = &surface.name.display;
            return Err(format!("`{name}` may end the motion before the exit"));
        }
    }
    for coordinate in &model.coordinates {
        if let Topology::Interval { low, high } = coordinate.topology {
            let ends = [low, high].map(|end| node.range(end, &[]));
            let [Some(low), Some(high)] = ends else {
                return Err(format!(
                    "the interval of `{}` is not known",
                    coordinate.name.display
                ));
            };
            if low.hi >= hull.lo || hull.hi >= high.lo {
                return Err(format!(
                    "the interval of `{}` does not contain the motion from entry to exit",
                    coordinate.name.display
                ));
            }
        }
    }
    Ok(())
}

/// Enclosure of the maximum of a potential on an interval, by bisection.
fn highest(hull: Interval, potential: &dyn Fn(Interval) -> Option<Interval>) -> Option<Interval> {
    let mut parts = vec![(hull, potential(hull)?)];
    let mut low = f64::NEG_INFINITY;
    for _ in 0..PARTS {
        let widest = parts.iter().enumerate();
        let (index, &(part, range)) = widest.max_by(|(_, a), (_, b)| a.1.hi.total_cmp(&b.1.hi))?;
        let middle = 0.5 * part.lo + 0.5 * part.hi;
        low = low.max(potential(Interval::point(middle))?.lo);
        let is_close = range.hi - low <= CLOSE * range.hi.abs().max(low.abs());
        if is_close || middle <= part.lo || middle >= part.hi {
            break;
        }
        parts.swap_remove(index);
        for half in [
            Interval::new(part.lo, middle),
            Interval::new(middle, part.hi),
        ] {
            parts.push((half, potential(half)?));
        }
    }
    let high = parts.iter().map(|(_, range)| range.hi);
    Some(Interval::new(low, high.fold(low, f64::max)))
}

/// The cascade of a cycle that starts with the largest `R`.
fn run_through(mut steps: Vec<Step>) -> Cascade {
    let largest =
        (0..steps.len()).max_by(|&a, &b| steps[a].needed.hi.total_cmp(&steps[b].needed.hi));
    steps.rotate_left(largest.unwrap_or(0));
    let mut energy = steps.first().map_or(Interval::ZERO, |step| step.needed);
    let (mut multiplier, mut offset) = (Interval::point(1.0), Interval::ZERO);
    let needed: Vec<Interval> = steps.iter().map(|step| step.needed).collect();
    for (index, step) in steps.iter_mut().enumerate() {
        energy = step.kept * (energy + step.gained);
        offset = step.kept * (offset + step.gained);
        multiplier = multiplier * step.kept;
        step.reached = energy;
        step.next = needed[(index + 1) % needed.len()];
    }
    let missing = Interval::point(1.0) + -multiplier;
    let inverse = (missing.lo > 0.0).then(|| missing.inverse()).flatten();
    Cascade {
        energy: inverse.map(|inverse| offset * inverse),
        multiplier,
        steps,
    }
}

/// The verdict on Q.3.
pub(super) fn invariant(cascade: &Result<Cascade, String>) -> Reasoned {
    let cascade = match cascade {
        Ok(cascade) => cascade,
        Err(reason) => {
            return (
                Decided::Open,
                format!("no invariant set is known: {reason}"),
            );
        }
    };
    for step in &cascade.steps {
        let reached = format!(
            "from the largest R on, the energy after `{}` is {} where {} is needed",
            step.surface,
            shown(step.reached),
            shown(step.next)
        );
        match step.holds() {
            Some(true) => {}
            Some(false) => return (Decided::Open, format!("(4.13) fails: {reached}")),
            None => return (Decided::Open, format!("(4.13) is not decided: {reached}")),
        }
    }
    match cascade.multiplier.hi < 1.0 {
        true => {
            let text = "the energy stays above the largest R by (4.13), and below a bound, because impacts keep less than they receive";
            (Decided::Holds, text.to_owned())
        }
        false => {
            let text = "the energy is not bounded: impacts do not reduce it";
            (Decided::Open, text.to_owned())
        }
    }
}

/// The verdict on Q.5.
pub(super) fn interval(cascade: &Result<Cascade, String>) -> Reasoned {
    follows(
        cascade,
        "the set lies between two energies, and its surface is a line at one position",
    )
}

/// The verdict on Q.6.
pub(super) fn transverse(cascade: &Result<Cascade, String>) -> Reasoned {
    follows(
        cascade,
        "no velocity of the set is 0, and surfaces and images are lines at one position each",
    )
}

/// The verdict on a hypothesis that follows from the invariant set.
fn follows(cascade: &Result<Cascade, String>, reason: &str) -> Reasoned {
    match invariant(cascade) {
        (Decided::Holds, _) => (Decided::Holds, reason.to_owned()),
        _ => (Decided::Open, "no invariant set is known".to_owned()),
    }
}
