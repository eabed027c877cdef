//! The invariant volume: the density form, the density in closed form, the verdict.

use dalembert_expr::{Assumption, ExprId, Function};

use super::density_form::density_form;
use super::equations::Writer;
use super::{Item, Section};
use crate::claims::{Potential, Term, Verdict, examine_volume, potential_text};

/// Largest number of characters of a component that is printed.
const LONGEST: usize = 240;

impl Writer<'_> {
    /// Invariant volumes; empty for a model with neither constraints nor claims.
    pub(super) fn volume(&mut self) -> Section {
        let mut items = Vec::new();
        let is_constrained = !self.derivation.constraints.is_empty();
        if is_constrained || !self.model.claims.is_empty() {
            if is_constrained {
                self.density_form(&mut items);
            }
            self.density(&mut items);
        }
        let equation = [
            "theta = m_ab L_{W^a} eta^b, mu_C = det g/|det A_dep| dq dv, exp(G)*mu_C is invariant iff dG/dt = -div along the motion on D",
            r"\theta = m_{ab} \mathcal{L}_{W^a} \eta^b, \quad \mu_C = \frac{\det g}{|\det A_{\text{dep}}|}\, dq\, dv, \quad
              e^G \mu_C \text{ invariant} \iff \dot G = -\operatorname{div}_{\mu_C} \text{ along the motion on } D",
        ];
        Section {
            title: "Invariant volume",
            equation,
            items,
        }
    }

    fn density_form(&mut self, items: &mut Vec<Item>) {
        let theta = density_form(self.model, self.derivation);
        let is_short = |id: &ExprId| self.model.pool.text(*id).len() <= LONGEST;
        let Some(theta) = theta.filter(|theta| theta.iter().all(is_short)) else {
            let words = "theta is too long to be read; `eval` prints its value at a state";
            items.push(Item::Words(words.to_owned()));
            return;
        };
        if theta.iter().all(|entry| self.is_zero(*entry)) {
            let zero = self.model.pool.zero();
            items.push(self.formula("theta", r"\theta", zero));
        }
        for (i, component) in theta.into_iter().enumerate() {
            if !self.is_zero(component) {
                let [name, latex] = self.coordinate(i);
                let (text, latex) = (format!("theta_{name}"), format!("\\theta_{{{latex}}}"));
                items.push(self.formula(text, latex, component));
            }
        }
    }

    fn density(&mut self, items: &mut Vec<Item>) {
        let (verdict, remarks, volume) = examine_volume(self.model, self.derivation);
        if let Some(volume) = volume {
            let text = potential_text(&self.model.pool, &volume.potential);
            let expression = self.potential(&volume.potential);
            items.push(Item::Formula {
                left: ["G".to_owned(), "G".to_owned()],
                right: [text, self.model.pool.latex(expression)],
            });
        }
        let grounds = match verdict {
            Verdict::Proved(certificate) => certificate.to_string(),
            Verdict::Refuted(witness) => witness.to_string(),
            Verdict::Undecided(reason) => format!("undecided: {reason}"),
        };
        let lines = grounds.lines().map(str::to_owned).chain(remarks);
        items.extend(lines.map(Item::Words));
    }

    /// The logarithm of a density with symbols for the determinants.
    fn potential(&mut self, potential: &Potential) -> ExprId {
        let pool = &mut self.model.pool;
        let mut terms = Vec::new();
        for (coefficient, term) in &potential.terms {
            let mut determinant = |name: &str, latex: &str| {
                let symbol = pool.symbol(name, latex, Assumption::Positive);
                pool.variable(symbol)
            };
            let (inside, is_logarithm) = match term {
                Term::MassDeterminant => (determinant("det m", r"\det m"), true),
                Term::MetricDeterminant => (determinant("det g", r"\det g"), true),
                Term::DependentDeterminant => {
                    let latex = r"|\det A_{\text{dep}}|";
                    (determinant("|det A_dep|", latex), true)
                }
                Term::Logarithm(f) => (pool.call(Function::Abs, *f), true),
                Term::Plain(f) => (*f, false),
            };
            let value = match is_logarithm {
                true => pool.call(Function::Ln, inside),
                false => inside,
            };
            terms.push(pool.mul(*coefficient, value));
        }
        pool.sum(&terms)
    }
}
