//! Graph of the modes. Nodes are modes. Edges are the surfaces that lead from a mode to another, with maps of the form
//! `q -> entry`, `v -> factor v`.

use dalembert_expr::{ExprId, Interval, SymbolId};

use super::{Decided, Reasoned};
use crate::model::{Assumption, Beside, Law, Model, Reset, Surface, Topology, Transition};

/// A mode with values or ranges of its parameters.
pub(super) struct Node {
    pub(super) model: Model,
    /// Ranges of the parameters; points for given values.
    parameters: Vec<(SymbolId, Interval)>,
}

impl Node {
    pub(super) fn of(model: Model, parameters: &[(&str, f64)]) -> Self {
        let value = |name: &str| parameters.iter().find(|(known, _)| *known == name);
        let known = model.parameters.iter().map(|parameter| {
            let range = match value(&parameter.name.display) {
                Some((_, value)) => Interval::point(*value),
                None => match parameter.assumption {
                    Assumption::Positive | Assumption::NonNegative => {
                        Interval::new(0.0, f64::INFINITY)
                    }
                    _ => Interval::WHOLE,
                },
            };
            (parameter.symbol, range)
        });
        Self {
            parameters: known.collect(),
            model,
        }
    }

    /// True if the mode is a first-order system.
    pub(super) fn is_first_order(&self) -> bool {
        self.model.is_first_order()
    }

    /// The range of an expression for symbols in the ranges `at`; `None` if the expression may be undefined there.
    pub(super) fn range(&self, expr: ExprId, at: &[(SymbolId, Interval)]) -> Option<Interval> {
        let mut domain = self.parameters.clone();
        domain.extend_from_slice(at);
        let pool = &self.model.pool;
        let is_given = |symbol: &SymbolId| domain.iter().any(|(known, _)| known == symbol);
        if !pool.symbols(expr).iter().all(is_given) {
            return None;
        }
        pool.enclose(&pool.reachable(&[expr]), &domain)[expr.index()]
    }

    /// Coordinate and velocity of a mode with one coordinate.
    pub(super) fn symbols(&self) -> Option<[SymbolId; 2]> {
        match &self.model.coordinates[..] {
            [coordinate] if !self.is_first_order() => Some([coordinate.q, coordinate.qdot]),
            _ => None,
        }
    }

    /// The zero of an expression that is affine in a symbol, and its slope.
    fn zero_of(&mut self, expr: ExprId, symbol: SymbolId) -> Option<[Interval; 2]> {
        let pool = &mut self.model.pool;
        let slope = pool.diff(expr, symbol);
        let slope = pool.simplify(slope);
        if pool.depends_on(slope, symbol) {
            return None;
        }
        let zero = pool.zero();
        let rest = pool.substitute(expr, &[(symbol, zero)]);
        let quotient = pool.div(rest, slope);
        let root = pool.neg(quotient);
        let root = pool.simplify(root);
        Some([self.range(root, &[])?, self.range(slope, &[])?])
    }

    /// All expressions of the declaration that the motion depends on.
    fn expressions(&self) -> Vec<ExprId> {
        let model = &self.model;
        let mut found = vec![model.lagrangian.whole];
        found.extend(model.field.iter().flatten());
        found.extend(model.forces.iter().flat_map(|force| &force.form));
        found.extend(model.constraints.iter().map(|constraint| constraint.affine));
        found.extend(
            model
                .constraints
                .iter()
                .flat_map(|constraint| &constraint.form),
        );
        for surface in &model.surfaces {
            found.push(surface.gap);
            found.extend(surface.conditions.iter().map(|condition| condition.margin));
            found.extend(surface.law.coefficient());
            found.extend(surface.reset.iter().flat_map(Reset::expressions));
            found.extend(surface.transition.iter().flat_map(Transition::expressions));
        }
        found
    }
}

/// A surface that leads from a mode to another one, or back to the same mode.
pub(super) struct Edge {
    pub(super) from: usize,
    pub(super) to: usize,
    pub(super) name: String,
    /// Coordinate of the surface, coordinate after it, and factor of the velocity; or the reason why they are not
    /// known.
    pub(super) passage: Result<Passage, String>,
    /// Derivative of the map along the surface.
    slope: Slope,
}

/// Jump of a mode with one coordinate at a surface: from `exit` to `entry`, with the velocity times `factor`.
#[derive(Debug, Clone, Copy)]
pub(super) struct Passage {
    pub(super) exit: Interval,
    pub(super) entry: Interval,
    pub(super) factor: Interval,
    /// Slope of the gap at the surface.
    pub(super) slope: Interval,
}

/// Derivative of the map of a surface along that surface.
enum Slope {
    /// Range of the derivative.
    Within(Interval),
    /// The derivative is not known, for this reason.
    Unknown(String),
}

/// All surfaces after which the motion continues.
pub(super) fn edges(nodes: &mut [Node]) -> Vec<Edge> {
    let mut edges = Vec::new();
    for from in 0..nodes.len() {
        let surfaces = nodes[from].model.surfaces.clone();
        for surface in surfaces.iter().filter(|surface| surface.law.goes_on()) {
            let to = surface.transition.as_ref().map_or(from, |it| it.enters);
            let map = match (&surface.transition, &surface.reset) {
                (Some(transition), _) => {
                    (transition.map.as_ref()).map(|map| (map.q.clone(), map.qdot.clone()))
                }
                (None, Some(reset)) => Some(filled(&mut nodes[from], reset)),
                (None, None) => None,
            };
            let is_alone = surface.conditions.is_empty() && surface.beside == Beside::Independent;
            let node = &mut nodes[from];
            let passage = match (&map, is_alone) {
                (_, false) => Err(format!("`{}` has conditions", surface.name.display)),
                (None, _) => Err(format!("`{}` is no reset", surface.name.display)),
                (Some(map), true) => passage(node, surface.gap, map)
                    .ok_or_else(|| format!("`{}` does not lead from one position to one position with a multiple of the velocity", surface.name.display)),
            };
            let slope = match (&map, surface.law) {
                (Some(map), _) => slope(node, surface.gap, map),
                (None, law) => of_law(node, law, surface),
            };
            edges.push(Edge {
                from,
                to,
                name: surface.name.display.clone(),
                passage,
                slope,
            });
        }
    }
    edges
}

/// The complete map of a reset: components that it does not name keep their values.
fn filled(node: &mut Node, reset: &Reset) -> (Vec<ExprId>, Vec<ExprId>) {
    let coordinates = node.model.coordinates.clone();
    let pool = &mut node.model.pool;
    let mut all = |values: &[Option<ExprId>], symbol: fn(&crate::model::Coordinate) -> SymbolId| {
        let pairs = values.iter().zip(&coordinates);
        pairs
            .map(|(value, coordinate)| value.unwrap_or_else(|| pool.variable(symbol(coordinate))))
            .collect()
    };
    let q = all(&reset.q, |coordinate| coordinate.q);
    let qdot = all(&reset.qdot, |coordinate| coordinate.qdot);
    (q, qdot)
}

/// The passage at a surface of a mode with one coordinate; `None` if the map does not have that form.
fn passage(
    node: &mut Node,
    gap: ExprId,
    (q, qdot): &(Vec<ExprId>, Vec<ExprId>),
) -> Option<Passage> {
    let [position, velocity] = node.symbols()?;
    let (&[entry], &[after]) = (&q[..], &qdot[..]) else {
        return None;
    };
    let [exit, slope] = node.zero_of(gap, position)?;
    let pool = &mut node.model.pool;
    let factor = pool.diff(after, velocity);
    let factor = pool.simplify(factor);
    let zero = pool.zero();
    let rest = pool.substitute(after, &[(velocity, zero)]);
    let rest = pool.simplify(rest);
    let is_known = !pool.depends_on(entry, velocity)
        && !pool.depends_on(factor, velocity)
        && pool.is_syntactic_zero(rest);
    if !is_known {
        return None;
    }
    let at = [(position, exit)];
    Some(Passage {
        exit,
        entry: node.range(entry, &at)?,
        factor: node.range(factor, &at)?,
        slope,
    })
}

/// The derivative of the map of a surface along that surface.
fn slope(node: &mut Node, gap: ExprId, (q, qdot): &(Vec<ExprId>, Vec<ExprId>)) -> Slope {
    let unknown = |why: &str| Slope::Unknown(why.to_owned());
    let coordinates: Vec<SymbolId> = node.model.coordinates.iter().map(|it| it.q).collect();
    // The surface fixes one component of the state, so it is a line. The other component is a parameter along the line.
    let (across, along, images) = match (node.symbols(), &coordinates[..]) {
        (Some([position, velocity]), _) => (position, velocity, [&q[..], &qdot[..]].concat()),
        (None, &[x, y]) if node.is_first_order() => {
            let pool = &node.model.pool;
            match (pool.depends_on(gap, x), pool.depends_on(gap, y)) {
                (true, false) => (x, y, q.clone()),
                (false, true) => (y, x, q.clone()),
                _ => return unknown("the surface is no line of one coordinate"),
            }
        }
        _ => return unknown("Q.1 is not established"),
    };
    let Some([place, _]) = node.zero_of(gap, across) else {
        return unknown("the surface is no line");
    };
    let mut is_constant = true;
    for image in images {
        let pool = &mut node.model.pool;
        let slope = pool.diff(image, along);
        let slope = pool.simplify(slope);
        is_constant &= node.model.pool.is_syntactic_zero(slope);
        let at = [(across, place), (along, Interval::WHOLE)];
        let range = node.range(slope, &at);
        if let Some(range) = range.filter(|range| range.excludes_zero()) {
            return Slope::Within(range);
        }
    }
    match is_constant {
        true => Slope::Within(Interval::ZERO),
        false => unknown("no component of the image is shown to be monotone along the surface"),
    }
}

/// The absolute value of the derivative for an impulsive law. In a mode with one coordinate, the law multiplies
/// velocity and gap rate by the same factor.
fn of_law(node: &Node, law: Law, surface: &Surface) -> Slope {
    let within = |range: Option<Interval>| match range {
        Some(range) => Slope::Within(range),
        None => Slope::Unknown("the coefficient is not known".to_owned()),
    };
    match law {
        // Without a map, the state does not change.
        _ if node.is_first_order() => within(Some(Interval::point(1.0))),
        _ if node.symbols().is_none() => Slope::Unknown("Q.1 is not established".to_owned()),
        _ if !surface.instantaneous.is_empty() => {
            Slope::Unknown("it has instantaneous constraints".to_owned())
        }
        // Without constraints, the nonholonomic plastic law equals the elastic law.
        Law::Elastic | Law::NonholonomicPlastic => within(Some(Interval::point(1.0))),
        Law::Restitution(e) | Law::Newton(e) => within(node.range(e, &[])),
        Law::ImpactPlastic | Law::TotallyPlastic => within(Some(Interval::ZERO)),
        Law::Transition => Slope::Unknown("it is a refraction".to_owned()),
        Law::Reset | Law::Stop => Slope::Unknown("no map is known".to_owned()),
    }
}

/// The verdict on Q.1.
pub(super) fn plane(nodes: &[Node]) -> Reasoned {
    for node in nodes {
        let model = &node.model;
        let count = model.coordinates.len();
        let dimension = match node.is_first_order() {
            true => count,
            false => 2 * count - model.constraints.len().min(2 * count),
        };
        if model
            .constraints
            .iter()
            .any(|constraint| constraint.level.is_some())
        {
            let text = "integrable constraints reduce the states to a surface, whose topology is not decided";
            return (Decided::Open, text.to_owned());
        }
        if dimension != 2 {
            let text = format!("the states of `{}` have {dimension} dimensions", model.name);
            return (Decided::Fails, text);
        }
        if count != 1 && !node.is_first_order() {
            let text = "constraints leave two dimensions, whose topology is not decided";
            return (Decided::Open, text.to_owned());
        }
        let declared = node.expressions();
        let names = |symbol: SymbolId| {
            declared
                .iter()
                .any(|expr| model.pool.depends_on(*expr, symbol))
        };
        if names(model.time) {
            let text = "the declaration depends on time, which is a third dimension";
            return (Decided::Fails, text.to_owned());
        }
        let mut inputs = model.inputs().map(|(_, input)| input);
        if let Some(input) = inputs.find(|input| names(input.symbol)) {
            let text = format!("the input `{}` is free", input.name.display);
            return (Decided::Open, text);
        }
        let turning = model.coordinates.iter();
        let turning = turning.filter(|coordinate| coordinate.topology == Topology::Angle);
        if let Some(angle) = turning.into_iter().next() {
            let text = format!(
                "`{}` is an angle: the states are a cylinder; declare it without `: angle` if it never turns over",
                angle.name.display
            );
            return (Decided::Fails, text);
        }
    }
    let text = match nodes.len() {
        1 => "one mode of two dimensions".to_owned(),
        count => format!("{count} modes of two dimensions"),
    };
    (Decided::Holds, text)
}

/// The verdict on Q.2.
pub(super) fn injective(edges: &[Edge]) -> Reasoned {
    for edge in edges {
        match &edge.slope {
            Slope::Within(range) if range.excludes_zero() => {}
            Slope::Within(range) if range.lo == 0.0 && range.hi == 0.0 => {
                let text = format!("`{}` maps its surface to a single point", edge.name);
                return (Decided::Fails, text);
            }
            Slope::Within(_) => {
                let text = format!("the derivative of the map at `{}` may vanish", edge.name);
                return (Decided::Open, text);
            }
            Slope::Unknown(reason) => return (Decided::Open, format!("`{}`: {reason}", edge.name)),
        }
    }
    let text = "along its surface the derivative of every map has one sign";
    (Decided::Holds, text.to_owned())
}

/// The verdict on Q.4.
pub(super) fn ways_out(nodes: &[Node], edges: &[Edge]) -> Reasoned {
    let out = |node: usize| edges.iter().filter(|edge| edge.from == node).count();
    match (0..nodes.len()).map(out).find(|&count| count != 1) {
        None => (
            Decided::Holds,
            "every mode is left through one surface".to_owned(),
        ),
        Some(0) => (
            Decided::Open,
            "a mode is left through no surface".to_owned(),
        ),
        Some(count) => {
            let text = format!(
                "a mode is left through {count} surfaces, and no partition of its states is searched"
            );
            (Decided::Open, text)
        }
    }
}
