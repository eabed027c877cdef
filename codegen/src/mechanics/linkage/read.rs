//! Reads a Lagrangian as a sum of squares of linear forms in the velocities, and each form as the nearest of the earlier ones
//! plus a few terms.

use std::collections::{BTreeMap, HashMap};

use dalembert_expr::{ExprId, Node, Pool, Rational, SymbolId};

use super::Part;

/// Number of derived velocities, the last ones, that are tried as neighbours whose coefficients have to be subtracted.
const NEAR: usize = 4;

/// A Lagrangian `1/2 sum_s c_s x_s^2 + rest`.
pub(super) struct Written {
    /// The derived velocities, as forms in the velocities and by their definitions.
    pub derived: Vec<(Form, Vec<(Part, ExprId)>)>,
    /// `x_s` and `c_s`.
    pub squares: Vec<(Part, ExprId)>,
    /// The terms that are linear in the velocities, or independent of them.
    pub rest: ExprId,
}

/// Coefficients of a linear form by the index of the velocity.
pub(super) type Form = BTreeMap<usize, ExprId>;

/// Reads a Lagrangian; `None` if a quadratic term is no square of a homogeneous linear form, or if there are more than `most`
/// squares.
pub(super) fn read(
    pool: &mut Pool,
    qdot: &[SymbolId],
    lagrangian: ExprId,
    most: usize,
) -> Option<Written> {
    let mut reader = Reader {
        pool,
        qdot,
        squares: Vec::new(),
        rest: Vec::new(),
    };
    let one = reader.pool.one();
    reader.summand(lagrangian, one)?;
    let Reader { squares, rest, .. } = reader;
    if squares.len() > most {
        return None;
    }
    let rest = pool.sum(&rest);
    let mut forms = Forms {
        pool,
        velocities: qdot.len(),
        derived: Vec::new(),
        known: HashMap::new(),
    };
    let mut weights: BTreeMap<Part, Vec<ExprId>> = BTreeMap::new();
    for (form, weight) in squares {
        let part = forms.part(form);
        weights.entry(part).or_default().push(weight);
    }
    let derived = forms.derived;
    let weights = weights.into_iter();
    Some(Written {
        derived,
        squares: weights
            .map(|(part, weights)| (part, pool.sum(&weights)))
            .collect(),
        rest,
    })
}

struct Reader<'a> {
    pool: &'a mut Pool,
    qdot: &'a [SymbolId],
    /// Forms and twice their weights in the Lagrangian.
    squares: Vec<(Form, ExprId)>,
    rest: Vec<ExprId>,
}

impl Reader<'_> {
    fn moves(&self, id: ExprId) -> bool {
        self.pool.depends_on_any(id, self.qdot)
    }

    /// Reads the summand `weight * id`.
    fn summand(&mut self, id: ExprId, weight: ExprId) -> Option<()> {
        if !self.moves(id) || self.is_velocity(id).is_some() {
            let product = self.pool.mul(weight, id);
            self.rest.push(product);
            return Some(());
        }
        match self.pool.node(id).clone() {
            Node::Sum { constant, terms } => {
                let constant = self.pool.number(constant);
                self.summand(constant, weight)?;
                for (coefficient, term) in terms {
                    let weight = self.pool.scale(&coefficient, weight);
                    self.summand(term, weight)?;
                }
                Some(())
            }
            Node::Product(factors) => self.product(&factors, weight),
            _ => None,
        }
    }

    /// The only factor that depends on velocities, its exponent, and the product of `weight` and the others.
    fn moving_factor(
        &mut self,
        factors: &[(ExprId, Rational)],
        weight: ExprId,
    ) -> Option<(ExprId, Rational, ExprId)> {
        let (mut moving, still): (Vec<_>, Vec<_>) = factors
            .iter()
            .cloned()
            .partition(|(base, _)| self.moves(*base));
        let (base, exponent) = moving.pop()?;
        if !moving.is_empty() {
            return None;
        }
        let still = self.pool.power_product(&still);
        Some((base, exponent, self.pool.mul(weight, still)))
    }

    fn product(&mut self, factors: &[(ExprId, Rational)], weight: ExprId) -> Option<()> {
        let (base, exponent, weight) = self.moving_factor(factors, weight)?;
        match exponent.to_i64() {
            Some(1) => self.summand(base, weight),
            Some(2) => {
                let form = self.form(base)?;
                let doubled = self.pool.scale(&Rational::from(2), weight);
                self.squares.push((form, doubled));
                Some(())
            }
            _ => None,
        }
    }

    fn is_velocity(&self, id: ExprId) -> Option<usize> {
        match self.pool.node(id) {
            Node::Symbol(symbol) => self.qdot.iter().position(|velocity| velocity == symbol),
            _ => None,
        }
    }

    /// A homogeneous linear form in the velocities.
    fn form(&mut self, id: ExprId) -> Option<Form> {
        let mut parts: BTreeMap<usize, Vec<ExprId>> = BTreeMap::new();
        let one = self.pool.one();
        let mut pending = vec![(id, one)];
        while let Some((id, weight)) = pending.pop() {
            if let Some(i) = self.is_velocity(id) {
                parts.entry(i).or_default().push(weight);
                continue;
            }
            match self.pool.node(id).clone() {
                Node::Sum { constant, terms } if constant.is_zero() => {
                    for (coefficient, term) in terms {
                        pending.push((term, self.pool.scale(&coefficient, weight)));
                    }
                }
                Node::Product(factors) => {
                    let (base, exponent, weight) = self.moving_factor(&factors, weight)?;
                    if !exponent.is_one() {
                        return None;
                    }
                    pending.push((base, weight));
                }
                _ => return None,
            }
        }
        let parts = parts.into_iter();
        let form: Form = parts.map(|(i, terms)| (i, self.pool.sum(&terms))).collect();
        (!form.is_empty()).then_some(form)
    }
}

/// The derived velocities found so far.
struct Forms<'a> {
    pool: &'a mut Pool,
    velocities: usize,
    /// Each as a form in the velocities, and by its definition.
    derived: Vec<(Form, Vec<(Part, ExprId)>)>,
    known: HashMap<Vec<(usize, ExprId)>, Part>,
}

impl Forms<'_> {
    /// The velocity with this form. It is defined if it is new.
    fn part(&mut self, form: Form) -> Part {
        let one = self.pool.one();
        let key: Vec<(usize, ExprId)> = form.iter().map(|(&i, &value)| (i, value)).collect();
        if let [(i, value)] = key[..]
            && value == one
        {
            return i;
        }
        if let Some(&part) = self.known.get(&key) {
            return part;
        }
        let (mut terms, difference) = match self.nearest(&form) {
            Some((part, difference)) => (vec![(part, one)], difference),
            None => (Vec::new(), form.clone()),
        };
        // Velocities with the same factor are added up first: a rod turns with the sum of the angles before it.
        let mut alike: Vec<(ExprId, Vec<usize>)> = Vec::new();
        for (i, factor) in difference {
            match alike
                .iter_mut()
                .find(|(known, _)| *known == factor && factor != one)
            {
                Some((_, velocities)) => velocities.push(i),
                None => alike.push((factor, vec![i])),
            }
        }
        for (factor, velocities) in alike {
            let part = self.part(velocities.into_iter().map(|i| (i, one)).collect());
            terms.push((part, factor));
        }
        let part = self.velocities + self.derived.len();
        self.derived.push((form, terms));
        self.known.insert(key, part);
        part
    }

    /// The derived velocity from which a form differs in the fewest velocities, and the difference.
    fn nearest(&mut self, form: &Form) -> Option<(Part, Form)> {
        let unequal = |other: &Form| {
            let shared = form
                .iter()
                .filter(|(i, value)| other.get(i) == Some(value))
                .count();
            form.len() + other.len() - 2 * shared
        };
        let count = self.derived.len();
        let closest = (0..count).min_by_key(|&w| (unequal(&self.derived[w].0), count - w));
        let near = count.saturating_sub(NEAR)..count;
        let mut best: Option<(usize, Part, Form)> = None;
        for w in near.rev().chain(closest) {
            let difference = self.difference(form, w);
            let terms = self.terms(&difference);
            if best.as_ref().is_none_or(|(least, ..)| terms < *least) {
                best = Some((terms, w, difference));
            }
        }
        let (terms, w, difference) = best?;
        (terms + 1 < self.terms(form)).then_some((self.velocities + w, difference))
    }

    /// Number of terms of the definition of a form, without neighbours.
    fn terms(&self, form: &Form) -> usize {
        let one = self.pool.one();
        let ones = form.values().filter(|value| **value == one).count();
        let mut others: Vec<ExprId> = form
            .values()
            .copied()
            .filter(|&value| value != one)
            .collect();
        others.sort_unstable();
        others.dedup();
        ones + others.len()
    }

    fn difference(&mut self, form: &Form, w: usize) -> Form {
        let zero = self.pool.zero();
        let mut difference = form.clone();
        for (&i, &value) in &self.derived[w].0 {
            let coefficient = difference.get(&i).copied().unwrap_or(zero);
            let rest = match coefficient == value {
                true => zero,
                false => self.pool.sub(coefficient, value),
            };
            difference.insert(i, rest);
        }
        difference.retain(|_, value| !self.pool.is_syntactic_zero(*value));
        difference
    }
}
