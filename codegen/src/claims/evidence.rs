//! Evidence on whether a quantity vanishes at all states: residues at random states, and values at real states.

use dalembert_expr::{
    Arithmetic, Ball, BallPoint, ExpansionPoint, ExprId, ModularPoint, Node, Pool, RangePoint,
    RealPoint, SymbolId,
};

use super::admissible::{is_admissible, is_completed};
use super::dynamics::{Dynamics, Number};
use super::finding::{Certificate, Verdict, Witness, digits};
use super::locus::Locus;
use super::residues::{Residues, residues};
use super::sample::{self, Sample};
use super::undecided::Undecided;
use crate::model::Model;

/// Number of real states that are tried. More are tried if the sum has a value at none of them.
const WITNESSES: usize = 48;
/// Number of states at which a sum is enclosed with more digits, whatever its value in doubles.
const ENCLOSED: usize = 12;
/// Fraction of its scale that a sum in doubles must exceed before later states are enclosed.
const VISIBLE: f64 = 1e-10;
/// Fraction of its scale beyond which a sum in doubles is more than rounding error. If no enclosure excludes 0 at such a
/// state, the sum is not proved to vanish.
const SUSPECT: f64 = 1e-6;
/// Fraction of its scale below which a sum in doubles has lost digits that a message shows.
const VISIBLE_DIGITS: f64 = 1e-3;
/// Size below which a computed double may have lost digits to underflow.
const LEAST: f64 = 1e-200;

/// A sum of terms that may vanish at all states.
pub(super) trait Vanishing {
    /// Expressions to be evaluated.
    fn roots(&self) -> Vec<ExprId>;

    /// True if the states relate quantities that residues treat as independent. A sum may then vanish at all states
    /// although its residues do not.
    fn hides_relations(&self, model: &Model) -> bool {
        let _ = model;
        false
    }

    /// The motion on D, if states have to satisfy the constraints; `None` if any point is a state.
    fn dynamics(&self) -> Option<&Dynamics>;

    /// The positions of the states. `None` if any position is one.
    fn positions(&self) -> Option<&Locus> {
        self.dynamics().map(Dynamics::positions)
    }

    /// Moves a random point with the position of a state to that state; `None` if that fails there.
    fn settle(&self, model: &Model, point: &mut ModularPoint) -> Option<()> {
        match self.dynamics() {
            None => Some(()),
            Some(dynamics) => dynamics.motion(&model.pool, point, None).map(|_| ()),
        }
    }

    /// A real state with short coordinates and its point.
    fn sample(&self, model: &Model, attempt: usize) -> Option<(Sample, RealPoint)> {
        match self.dynamics() {
            None => {
                let roots = self.roots();
                let sample = sample::sample(model, attempt, sample::uses(&model.pool, &roots));
                let point = sample.point();
                Some((sample, point))
            }
            Some(dynamics) => sample::state_on_d(model, dynamics, &self.roots(), attempt),
        }
    }

    /// The terms at a state.
    fn terms<P: ExpansionPoint>(&self, model: &Model, point: &mut P) -> Option<Vec<Number<P>>>;

    /// True if a real state with these terms belongs to the question.
    fn wants(&self, terms: &[f64]) -> bool {
        let _ = terms;
        true
    }

    /// Size of the terms' ingredients at a real state. Rounding errors are about `1e-16` times this, or larger if the
    /// metric or the constraints are ill-conditioned.
    fn scale(&self, model: &Model, point: &mut RealPoint) -> Option<f64>;

    /// Ranges that contain a state close to a real one, so that printed values are exact. `None` if the existence of
    /// such a state is not certain. The dependent coordinates and velocities follow from the other values.
    fn enclosed(&self, model: &Model, point: &RealPoint) -> Option<BallPoint> {
        let mut point = BallPoint::of(point);
        if let Some(dynamics) = self.dynamics() {
            dynamics.positions().enclose(model, &mut point)?;
            dynamics.motion(&model.pool, &mut point, None)?;
        }
        Some(point)
    }

    /// Values that illustrate at a real state that the terms cancel; none if there is nothing to show.
    fn balance(&self, model: &Model, terms: &[f64]) -> Vec<(String, f64)> {
        let _ = (model, terms);
        Vec::new()
    }

    /// Values shown to the user at a real state, given the terms and their sum.
    fn shown(&self, model: &Model, terms: &[f64], sum: f64) -> Vec<(String, f64)>;
}

/// Evidence from residues and real numbers about a quantity that is claimed to vanish.
pub(super) struct Evidence {
    /// True if all residues are 0; `None` if there were too few.
    pub(super) vanishes: Option<bool>,
    /// The number of random points.
    pub(super) points: usize,
    /// The primes.
    pub(super) primes: Vec<u64>,
    /// An upper bound of the probability of error.
    pub(super) error: f64,
    /// A certified real state at which a reader can follow that terms cancel.
    pub(super) balance: Option<(Sample, Vec<(String, f64)>)>,
    /// A real point at which an enclosure excludes 0, with the values to show there.
    pub(super) witness: Option<(Sample, Vec<(String, f64)>)>,
    /// True if the quantity has a value at any of the real points tried.
    pub(super) is_real: bool,
    /// True if doubles are far from 0 at a point where no enclosure excludes 0.
    pub(super) is_suspect: bool,
    /// Reason to give if the question stays open.
    pub(super) open: Undecided,
}

/// The two answers to a claim that a quantity vanishes, or does not.
#[derive(Debug, Default)]
pub(super) struct Wording {
    /// Sentence if the quantity vanishes.
    pub(super) vanishes: String,
    /// Sentence if it does not.
    pub(super) differs: String,
    /// Advice if the claim that it vanishes is refuted, and if the claim that it does not vanish is refuted.
    pub(super) help: [String; 2],
}

impl Evidence {
    /// Combines the evidence on two parts of the states.
    pub(super) fn and(mut self, other: Self) -> Self {
        self.primes.extend(&other.primes);
        self.primes.sort_unstable();
        self.primes.dedup();
        Self {
            vanishes: match (self.vanishes, other.vanishes) {
                (Some(true), Some(true)) => Some(true),
                (Some(false), _) | (_, Some(false)) => Some(false),
                _ => None,
            },
            points: self.points + other.points,
            primes: self.primes,
            error: self.error + other.error,
            balance: self.balance.or(other.balance),
            witness: self.witness.or(other.witness),
            is_real: self.is_real || other.is_real,
            is_suspect: self.is_suspect || other.is_suspect,
            open: self.open,
        }
    }

    /// True if the sum is 0 at all states, and states exist.
    pub(super) fn shows_that_it_vanishes(&self) -> bool {
        self.is_real && self.vanishes == Some(true) && self.witness.is_none() && !self.is_suspect
    }

    /// The verdict on the claim that the quantity vanishes, or that it does not.
    pub(super) fn verdict(self, holds: bool, wording: Wording, seed: u64) -> Verdict {
        let certificate = |shown: String, error: f64| Certificate {
            shown,
            points: self.points,
            primes: self.primes.clone(),
            error,
            seed,
            at: None,
        };
        if !self.is_real {
            let text = "it has no value at any of the real points that were tried";
            return Verdict::Undecided(text.to_owned());
        }
        // A point that satisfies every declared inequality is needed: residues know no inequality.
        let differs = self.witness.is_some();
        let vanishes = self.shows_that_it_vanishes();
        match (holds, vanishes, differs) {
            (true, true, _) => Verdict::Proved(certificate(wording.vanishes, self.error)),
            (false, _, true) => {
                let at = match &self.witness {
                    Some((sample, values)) => format!(": {}", sentence(sample, values)),
                    None => String::new(),
                };
                // A value that is not 0 needs no further points.
                let points = if at.is_empty() { self.points } else { 0 };
                let shown = format!("{}{at}", wording.differs);
                Verdict::Proved(Certificate {
                    points,
                    at: self.witness.as_ref().map(|(sample, _)| sample.clone()),
                    ..certificate(shown, 0.0)
                })
            }
            (true, _, true) => {
                let (sample, values) = self.witness.unzip();
                Verdict::Refuted(Witness {
                    reason: wording.differs,
                    sample,
                    values: values.unwrap_or_default(),
                    help: wording.help[0].clone(),
                })
            }
            (false, true, _) => Verdict::Refuted(Witness {
                reason: match &self.balance {
                    Some((sample, values)) => format!(
                        "{}\nfor example {}",
                        certificate(wording.vanishes, self.error),
                        sentence(sample, values)
                    ),
                    None => certificate(wording.vanishes, self.error).to_string(),
                },
                sample: None,
                values: Vec::new(),
                help: wording.help[1].clone(),
            }),
            _ => Verdict::Undecided(self.open.to_string()),
        }
    }
}

fn sentence(sample: &Sample, values: &[(String, f64)]) -> String {
    let values: Vec<String> = values
        .iter()
        .map(|(name, value)| format!("{name} = {}", digits(*value)))
        .collect();
    format!("{} at {}", values.join(", "), sample.text())
}

/// The evidence on a sum of terms. A sum that vanishes at all positions vanishes at those of the states. Otherwise every
/// component of the positions of the states is examined.
pub(super) fn evidence(model: &Model, question: &impl Vanishing, seed: u64) -> Evidence {
    let roots = question.roots();
    let profile = model.pool.profile_of(&roots);
    let (roots, positions) = (roots.as_slice(), question.positions());
    let asked = |choice| residues(model, question, (roots, &profile), choice, seed);
    let mut residues = asked(None);
    let mut is_exact = profile.is_exact() && !question.hides_relations(model);
    if let Some(positions) = positions.filter(|positions| !positions.is_everything())
        && residues.vanishes != Some(true)
    {
        is_exact &= !positions.hides(&model.pool, roots);
        let parts = positions.choices().into_iter().map(asked);
        residues = match positions.is_solved() {
            true => parts.reduce(Residues::and).unwrap_or(residues),
            false => Residues::open(Undecided::Positions),
        };
    }
    let real = match is_exact && residues.vanishes == Some(true) {
        true => real_evidence(model, question, Search::Value),
        false => real_evidence(model, question, Search::Difference),
    };
    Evidence {
        vanishes: residues.vanishes,
        points: residues.points,
        primes: residues.primes,
        error: residues.error,
        balance: real.balance,
        witness: real.witness,
        is_real: real.is_real,
        is_suspect: real.is_suspect,
        open: residues.open,
    }
}

/// Target of the search at real points.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Search {
    /// A point where the sum has a value.
    Value,
    /// A point where it is not 0.
    Difference,
}

/// Observations at real points.
#[derive(Default)]
struct Real {
    /// A point that illustrates that terms cancel, and the values to show there.
    balance: Option<(Sample, Vec<(String, f64)>)>,
    /// A point where the sum is certainly not 0, and the values to show there.
    witness: Option<(Sample, Vec<(String, f64)>)>,
    /// True if the sum has a value at any point.
    is_real: bool,
    /// True if doubles are far from 0 at a point where no enclosure excludes 0.
    is_suspect: bool,
}

fn real_evidence(model: &Model, question: &impl Vanishing, search: Search) -> Real {
    let mut seen = Real::default();
    for attempt in 0..sample::ATTEMPTS {
        if seen.is_real && (attempt >= WITNESSES || search == Search::Value) {
            break;
        }
        let Some((sample, point)) = question.sample(model, attempt) else {
            continue;
        };
        // Questions about impacts change their point.
        let Some(terms) = question.terms(model, &mut point.clone()) else {
            continue;
        };
        if !question.wants(&terms) {
            continue;
        }
        seen.is_real = true;
        let Some(scale) = question.scale(model, &mut point.clone()) else {
            continue;
        };
        if seen.balance.is_none() && sample.is_allowed(model) {
            let values = question.balance(model, &terms);
            let is_shown = !values.is_empty() && is_state(model, question, &point);
            seen.balance = is_shown.then(|| (sample.clone(), values));
        }
        if search == Search::Value || !sample.is_allowed(model) {
            continue;
        }
        let sum: f64 = terms.iter().sum();
        let size = if is_regular(sum) { sum.abs() } else { 0.0 };
        let found = if size > VISIBLE_DIGITS * scale {
            // The doubles have enough digits for a message.
            difference(model, question, &sample, &point).map(|_| (terms.clone(), sum))
        } else if attempt < ENCLOSED || size > VISIBLE * scale {
            difference(model, question, &sample, &point)
        } else {
            None
        };
        if let Some((terms, sum)) = found {
            let values = question.shown(model, &terms, sum);
            seen.witness = Some((sample, values));
            return seen;
        }
        seen.is_suspect |= size > SUSPECT * scale && is_admissible(model, &sample);
    }
    seen
}

/// True if a real point is certified to be next to a state of the question, for example one that meets a wall.
fn is_state(model: &Model, question: &impl Vanishing, point: &RealPoint) -> bool {
    question.enclosed(model, point).is_some()
}

/// The terms of a sum and the sum at a real state, if an enclosure proves that the sum is not 0.
fn difference(
    model: &Model,
    question: &impl Vanishing,
    sample: &Sample,
    point: &RealPoint,
) -> Option<(Vec<f64>, f64)> {
    let mut state = question.enclosed(model, point)?;
    let field = state.field();
    let terms = question.terms(model, &mut state.clone())?;
    let add = |sum, term: &Ball| field.add(sum, *term);
    let sum = terms.iter().fold(field.integer(0), add);
    sum.sign()?;
    let shown = terms.iter().map(|term| term.nearest()).collect();
    is_completed(model, sample, &mut state).then(|| (shown, sum.nearest()))
}

/// True if the argument of a function depends on one of the symbols.
pub(super) fn in_arguments(pool: &Pool, roots: &[ExprId], symbols: &[SymbolId]) -> bool {
    let ties = |id: ExprId| pool.depends_on_any(id, symbols);
    let nodes = pool.reachable(roots).into_iter();
    nodes.map(|id| pool.node(id)).any(|node| match node {
        Node::Call(_, argument) => ties(*argument),
        Node::Atan2(y, x) => ties(*y) || ties(*x),
        _ => false,
    })
}

/// True if the number is finite and lost no digits to underflow.
pub(super) fn is_regular(sum: f64) -> bool {
    sum.is_finite() && sum.abs() > LEAST
}

#[cfg(test)]
mod tests {
    use dalembert_expr::Rational;

    use super::*;

    /// A sum of expressions of coordinates, and its scale.
    struct Sum {
        terms: Vec<ExprId>,
        size: f64,
    }

    impl Vanishing for Sum {
        fn roots(&self) -> Vec<ExprId> {
            self.terms.clone()
        }

        fn dynamics(&self) -> Option<&Dynamics> {
            None
        }

        fn terms<P: ExpansionPoint>(&self, model: &Model, point: &mut P) -> Option<Vec<Number<P>>> {
            let values = point.values(&model.pool, &model.pool.reachable(&self.terms))?;
            Some(self.terms.iter().map(|term| values[term.index()]).collect())
        }

        fn scale(&self, _: &Model, _: &mut RealPoint) -> Option<f64> {
            Some(self.size)
        }

        fn shown(&self, _: &Model, _: &[f64], sum: f64) -> Vec<(String, f64)> {
            vec![("sum".to_owned(), sum)]
        }
    }

    /// A model of two coordinates with a potential.
    fn model(potential: &str) -> Model {
        let declaration = format!(
            "pub Sample {{ coordinates {{ x; y; }} lagrangian = (dot(x)^2 + dot(y)^2)/2 - ({potential}); }}"
        );
        crate::claims::derived(&declaration).0
    }

    /// `(x + y)^2 - x^2 - 2 x y - y^2 + part y`
    fn binomial(model: &mut Model, part: &Rational) -> Vec<ExprId> {
        let [x, y] = [0, 1].map(|i| model.pool.variable(model.coordinates[i].q));
        let square = |model: &mut Model, of: ExprId| model.pool.pow(of, Rational::from(2));
        let sum = model.pool.add(x, y);
        let product = model.pool.mul(x, y);
        let [whole, first, second] = [sum, x, y].map(|expr| square(model, expr));
        let minus = Rational::MINUS_ONE;
        vec![
            whole,
            model.pool.scale(&minus, first),
            model.pool.scale(&Rational::from(-2), product),
            model.pool.scale(&minus, second),
            model.pool.scale(part, y),
        ]
    }

    #[test]
    fn rounding_is_never_counted() {
        let mut model = model("0");
        let terms = binomial(&mut model, &Rational::ZERO);
        // With size 0, every rounding error of doubles would count as a difference.
        let question = Sum { terms, size: 0.0 };
        let rounded = (0..WITNESSES).filter(|attempt| {
            let (_, mut point) = question.sample(&model, *attempt).expect("a sample");
            let terms = question.terms(&model, &mut point).expect("values");
            terms.iter().sum::<f64>() != 0.0
        });
        assert!(rounded.count() > 8, "doubles should not be exact here");
        let seen = real_evidence(&model, &question, Search::Difference);
        assert!(seen.witness.is_none() && seen.is_real);
        let found = evidence(&model, &question, 1);
        assert!(found.shows_that_it_vanishes());
    }

    #[test]
    fn small_differences_are_enclosed_away_from_0() {
        for digits in [20, 30, 60] {
            let mut model = model("0");
            let tiny = Rational::from_decimal(&format!("1e-{digits}")).expect("a number");
            let terms = binomial(&mut model, &tiny);
            let question = Sum { terms, size: 1.0 };
            let seen = real_evidence(&model, &question, Search::Difference);
            let (sample, values) = seen.witness.expect("a witness");
            let y = sample.value(model.coordinates[1].q).expect("a value");
            let expected = tiny.to_f64() * y;
            assert!((values[0].1 - expected).abs() < 1e-12 * expected.abs());
        }
    }

    #[test]
    fn a_difference_without_enclosure_prevents_a_proof() {
        let mut model = model("0");
        let terms = binomial(&mut model, &Rational::ZERO);
        let question = Sum { terms, size: 0.0 };
        let seen = real_evidence(&model, &question, Search::Difference);
        assert!(seen.is_suspect);
        let question = Sum {
            size: 1.0,
            ..question
        };
        let seen = real_evidence(&model, &question, Search::Difference);
        assert!(!seen.is_suspect);
    }

    #[test]
    fn states_without_a_lagrangian_show_nothing() {
        // The derivatives of `ln(x)` have values where `ln(x)` has none.
        let mut model = model("ln(x)");
        let x = model.pool.variable(model.coordinates[0].q);
        let size = model.pool.call(dalembert_expr::Function::Abs, x);
        let minus = model.pool.neg(size);
        let terms = vec![x, minus];
        let question = Sum { terms, size: 1.0 };
        let seen = real_evidence(&model, &question, Search::Difference);
        assert!(seen.witness.is_none(), "|x| = x where ln(x) has a value");
        assert!(!seen.is_suspect);
    }
}
