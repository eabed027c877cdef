//! Every declaration must be periodic in each angle: unchanged if an angle grows by `2*pi`.
//!
//! An angle that occurs only as an integer multiple inside of `sin`, `cos` and `tan` needs no further test. For any
//! other occurrence, the change of the whole declaration under `theta -> theta + 2*pi` must be proved to be zero.

use dalembert_expr::{ExprId, Function, Node, Pool, Rational, SymbolId};

use super::Topology;
use super::degree::is_zero;
use super::resolve::{Resolver, Scope};
use crate::spec::{Scalar, ScalarKind};

impl Resolver<'_> {
    /// Refuses a declaration that is not periodic in an angle. `expr` is the declared quantity, `written` its source
    /// text.
    pub(super) fn check_periodic(&mut self, written: &[&Scalar], scope: &Scope, expr: ExprId) {
        self.check_turns(written, scope, expr, is_periodic);
    }

    /// Same as [`Resolver::check_periodic`], for an expression that is an angle itself: a turn of an angle may change
    /// it by a whole number of turns.
    pub(super) fn check_periodic_angle(
        &mut self,
        written: &[&Scalar],
        scope: &Scope,
        expr: ExprId,
    ) {
        self.check_turns(written, scope, expr, |pool, expr, angle| {
            let turns = turns(pool, expr, angle);
            let variable = pool.variable(angle);
            let turned = pool.scale(&Rational::from(turns), variable);
            let rest = pool.sub(expr, turned);
            is_periodic(pool, rest, angle)
        });
    }

    /// Same as [`Resolver::check_periodic`], for the derivatives of an expression with respect to `symbols`.
    pub(super) fn check_periodic_derivatives(
        &mut self,
        written: &[&Scalar],
        scope: &Scope,
        expr: ExprId,
        symbols: &[SymbolId],
    ) {
        self.check_turns(written, scope, expr, |pool, expr, angle| {
            symbols.iter().all(|symbol| {
                let slope = pool.diff(expr, *symbol);
                is_periodic(pool, slope, angle)
            })
        });
    }

    fn check_turns(
        &mut self,
        written: &[&Scalar],
        scope: &Scope,
        expr: ExprId,
        holds: impl Fn(&mut Pool, ExprId, SymbolId) -> bool,
    ) {
        let angles = self.angles();
        for angle in bare_symbols(&self.pool, expr, &angles) {
            if holds(&mut self.pool, expr, angle) {
                continue;
            }
            self.refuse_angle(written, scope, angle);
            return;
        }
    }

    fn angles(&self) -> Vec<SymbolId> {
        let coordinates = self.symbols.coordinates.iter();
        coordinates
            .filter(|coordinate| coordinate.topology == Topology::Angle)
            .map(|coordinate| coordinate.q)
            .collect()
    }

    fn refuse_angle(&mut self, written: &[&Scalar], scope: &Scope, angle: SymbolId) {
        let name = self.pool.symbol_name(angle).to_owned();
        let mut whole = scope.clone();
        let is_bare =
            |pool: &mut Pool, expr: ExprId| !bare_symbols(pool, expr, &[angle]).is_empty();
        let Some(side) = written.iter().find(|side| {
            let value = self.expression(side, &mut whole);
            value.is_some_and(|value| is_bare(&mut self.pool, value))
        }) else {
            return;
        };
        let parent = self.last_compound(side, scope, &is_bare);
        let field = name.split('.').next().unwrap_or(&name).to_owned();
        let text = match parent.kind {
            ScalarKind::Name(_) | ScalarKind::Member(..) => {
                format!("`{name}` is an angle and stands outside of `sin`, `cos` and `tan`")
            }
            _ => format!("`{name}` is an angle but `{parent}` is not periodic"),
        };
        let help = format!(
            "declare it as a line: `{field};`, or use it in multiples inside of `sin` and `cos`"
        );
        self.refuse::<()>(parent.at, text, &help);
    }

    /// The smallest subexpression with the error. A name alone is replaced by the product or power that contains it
    /// directly.
    fn last_compound<'a>(
        &mut self,
        written: &'a Scalar,
        scope: &Scope,
        is_bare: &dyn Fn(&mut Pool, ExprId) -> bool,
    ) -> &'a Scalar {
        let smallest = self.culprit(written, scope, is_bare);
        if !matches!(smallest.kind, ScalarKind::Name(_) | ScalarKind::Member(..)) {
            return smallest;
        }
        parent_of(written, smallest).unwrap_or(smallest)
    }
}

/// The power or product of which `part` is an operand.
fn parent_of<'a>(whole: &'a Scalar, part: &Scalar) -> Option<&'a Scalar> {
    let parts: Vec<&Scalar> = match &whole.kind {
        ScalarKind::Negative(inner) | ScalarKind::SumOver(_, inner) => vec![inner],
        ScalarKind::Sum(terms) => terms.iter().map(|(_, term)| term).collect(),
        ScalarKind::Product(factors) => factors.iter().map(|(_, factor)| factor).collect(),
        ScalarKind::Power(base, _) => vec![base],
        _ => Vec::new(),
    };
    let is_direct = parts.iter().any(|candidate| std::ptr::eq(*candidate, part));
    if is_direct && matches!(whole.kind, ScalarKind::Power(..) | ScalarKind::Product(_)) {
        return Some(whole);
    }
    parts
        .into_iter()
        .find_map(|candidate| parent_of(candidate, part))
}

/// Members of `angles` with an occurrence that is not an integer multiple inside of `sin`, `cos` or `tan`.
fn bare_symbols(pool: &Pool, expr: ExprId, angles: &[SymbolId]) -> Vec<SymbolId> {
    let mut bare = Vec::new();
    if !pool.depends_on_any(expr, angles) {
        return bare;
    }
    let order = pool.reachable(&[expr]);
    let mut visible = vec![false; order.len()];
    let mark = |id: ExprId, visible: &mut Vec<bool>| {
        if let Ok(index) = order.binary_search(&id) {
            visible[index] = true;
        }
    };
    mark(expr, &mut visible);
    // Operands precede their users. In reverse order, every user is visited before its operands.
    for index in (0..order.len()).rev() {
        if !visible[index] {
            continue;
        }
        match pool.node(order[index]) {
            Node::Symbol(symbol) if angles.contains(symbol) => bare.push(*symbol),
            Node::Call(Function::Sin | Function::Cos | Function::Tan, argument) => {
                for operand in not_periodic_terms(pool, *argument, angles) {
                    mark(operand, &mut visible);
                }
            }
            node => node.for_each_operand(|operand| mark(operand, &mut visible)),
        }
    }
    bare.sort();
    bare
}

/// The terms of the argument of a trigonometric function that are not integer multiples of an angle.
fn not_periodic_terms(pool: &Pool, argument: ExprId, angles: &[SymbolId]) -> Vec<ExprId> {
    let is_angle =
        |id: ExprId| matches!(pool.node(id), Node::Symbol(symbol) if angles.contains(symbol));
    let (_, terms) = pool.linear_form(argument);
    let others = terms
        .into_iter()
        .filter(|(factor, term)| !(factor.is_integer() && is_angle(*term)));
    others.map(|(_, term)| term).collect()
}

/// `expr` with `angle` replaced by `angle + 2*pi`.
fn after_a_turn(pool: &mut Pool, expr: ExprId, angle: SymbolId) -> ExprId {
    let variable = pool.variable(angle);
    let two = pool.int(2);
    let pi = pool.pi();
    let turn = pool.mul(two, pi);
    let turned = pool.add(variable, turn);
    pool.substitute(expr, &[(angle, turned)])
}

/// Number of turns of `expr` in one turn of `angle`, guessed from its values at a point; [`is_periodic`] checks it.
fn turns(pool: &mut Pool, expr: ExprId, angle: SymbolId) -> i64 {
    let after = after_a_turn(pool, expr, angle);
    let values = pool.eval(&[after, expr], &|symbol| point(symbol));
    // An undefined value counts as 0 turns.
    ((values[0] - values[1]) / core::f64::consts::TAU).round() as i64
}

/// True if `expr` is proved to be unchanged when `angle` grows by `2*pi`.
fn is_periodic(pool: &mut Pool, expr: ExprId, angle: SymbolId) -> bool {
    let after = after_a_turn(pool, expr, angle);
    let change = pool.sub(after, expr);
    is_zero(pool, change)
}

/// A number in `[0.3, 1.3)` for each symbol.
fn point(symbol: SymbolId) -> f64 {
    0.3 + (0.618_033_988_749_894_9 + symbol.index() as f64 * 0.414_213_562_373_095_1).fract()
}
