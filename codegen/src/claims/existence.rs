//! `density: exact`, `locally_exact`, `none`: the verdict on the existence of a density, with its text.

use dalembert_expr::{Node, Pool, Verdict as Zero};

use super::contraction::real_step;
use super::exactness::Exactness;
use super::finding::{Certificate, Verdict, Witness, digits};
use super::fit::Certified;
use super::global::Global;
use super::obstruction::{Obstruction, find_obstruction};
use super::potential::{Potential, potential_text};
use super::problem::Problem;
use super::sample::Sample;
use super::undecided::Undecided;
use crate::model::{Existence, Model};

/// Result on densities, or the reason why it is undecided.
pub type Decision = Result<Exactness, Undecided>;

/// The verdict on a claim of existence.
pub(super) fn check_existence(
    model: &Model,
    problem: &Problem,
    decision: &Decision,
    claimed: Existence,
    seed: u64,
) -> Verdict {
    if let Some(curved) = problem.curved() {
        return curved_forces(model, curved, claimed, seed);
    }
    let exactness = match decision {
        Ok(exactness) => exactness,
        Err(undecided) => return Verdict::Undecided(undecided.to_string()),
    };
    let writer = Writer {
        model,
        problem,
        exactness,
        seed,
    };
    match (&exactness.global, claimed) {
        (None, Existence::None) => writer.proved_absent(),
        (None, _) => writer.obstructed(),
        (Some(_), Existence::None) => writer.refuted_by_existence("a density exists"),
        (Some(Global::Exists), Existence::Global)
        | (Some(Global::Many { .. }), Existence::Local) => Verdict::Proved(writer.existence()),
        (Some(Global::Exists), Existence::Local) => {
            writer.refuted_by_existence("a density exists on all of Q")
        }
        (Some(Global::Many { .. }), Existence::Global) => writer.many_valued(),
        (Some(Global::Undecided(reason)), _) => {
            Verdict::Undecided(format!("a density exists locally; on all of Q, {reason}"))
        }
    }
}

/// Reason why forces whose divergence is not linear in the velocities exclude a density of the configuration.
const CURVED: &str = "no density depends on q alone: the forces change volumes at a rate that is not linear in the velocities";

/// Verdict for forces that change volumes at a rate that no function of the configuration balances. Equidistant states
/// on a line of velocities show it.
fn curved_forces(
    model: &Model,
    (sample, values): (&Sample, &[(String, f64)]),
    claimed: Existence,
    seed: u64,
) -> Verdict {
    let steps: Vec<String> = model
        .coordinates
        .iter()
        .enumerate()
        .map(|(i, coordinate)| format!("dot({}) {:+}", coordinate.name.display, real_step(i)))
        .collect();
    let steps = format!(
        "a step is {}, where these are independent",
        steps.join(", ")
    );
    if claimed != Existence::None {
        return Verdict::Refuted(Witness {
            reason: format!("{CURVED}; {steps}"),
            sample: Some(sample.clone()),
            values: values.to_vec(),
            help: "write `density: none;`".to_owned(),
        });
    }
    let values: Vec<String> = values
        .iter()
        .map(|(name, value)| format!("{name} = {}", digits(*value)))
        .collect();
    let place = format!("{} at {}; {steps}", values.join(", "), sample.text());
    Verdict::Proved(Certificate {
        shown: format!("{CURVED}: {place}"),
        points: 0,
        primes: Vec::new(),
        error: 0.0,
        seed,
        at: Some(sample.clone()),
    })
}

struct Writer<'w> {
    model: &'w Model,
    problem: &'w Problem,
    exactness: &'w Exactness,
    seed: u64,
}

impl Writer<'_> {
    fn existence(&self) -> Certificate {
        let depends = if self.problem.is_time_dependent() {
            " (of q and t)"
        } else {
            ""
        };
        let cover = match &self.exactness.global {
            Some(Global::Many { turns, period, .. }) => format!(
                "on the universal cover, where it is multiplied by exp({}) {}, ",
                digits(*period),
                self.turns(turns)
            ),
            _ => String::new(),
        };
        match &self.exactness.density {
            Some((potential, certified)) => {
                let text = potential_text(&self.model.pool, potential);
                let place = self.exceptions(potential);
                let shown =
                    format!("{cover}exp(G)*mu_C is invariant{depends} with G = {text}{place}");
                self.certificate(shown, certified)
            }
            None => Certificate {
                shown: format!(
                    "{cover}an invariant exp(G)*mu_C exists{depends}; G was found in no closed form"
                ),
                points: self.exactness.local.points,
                primes: self.exactness.local.primes.clone(),
                error: self.exactness.local.error,
                seed: self.seed,
                at: None,
            },
        }
    }

    /// Text of exceptions such as `, where k != 0`: parameters in denominators of a closed form that may be 0.
    fn exceptions(&self, potential: &Potential) -> String {
        let pool = &self.model.pool;
        let mut divisors = Vec::new();
        for (coefficient, _) in &potential.terms {
            let (_, product) = pool.as_multiple(*coefficient);
            let factors = match pool.node(product) {
                Node::Product(factors) => factors,
                _ => continue,
            };
            for (base, _) in factors.iter().filter(|(_, power)| power.is_negative()) {
                if !pool.sign(*base).is_nonzero() && !divisors.contains(base) {
                    divisors.push(*base);
                }
            }
        }
        let texts: Vec<String> = divisors
            .iter()
            .map(|divisor| format!("{} != 0", pool.text(*divisor)))
            .collect();
        match texts.is_empty() {
            true => String::new(),
            false => format!(", where {}", texts.join(" and ")),
        }
    }

    fn certificate(&self, shown: String, certified: &Certified) -> Certificate {
        Certificate {
            shown,
            points: certified.points,
            primes: certified.primes.clone(),
            error: certified.error,
            seed: self.seed,
            at: None,
        }
    }

    fn proved_absent(&self) -> Verdict {
        let local = &self.exactness.local;
        if local.is_partial {
            let text = "a density exists near some configurations and none near others, as signs of absolute values or roots have it";
            return Verdict::Undecided(text.to_owned());
        }
        let obstruction = find_obstruction(self.model, self.problem, local);
        if obstruction.is_none() && !local.is_proof {
            return self.unconfirmed();
        }
        Verdict::Proved(Certificate {
            shown: format!(
                "no density depends on q alone: the hull of D has rank {}, with the demands {}",
                local.rank, local.extended_rank
            ),
            points: local.points,
            primes: local.primes.clone(),
            error: local.error,
            seed: self.seed,
            at: obstruction.map(|found| found.sample),
        })
    }

    fn unconfirmed(&self) -> Verdict {
        Verdict::Undecided(
            Undecided::Relations(unrelated_atoms(&self.model.pool, self.problem)).to_string(),
        )
    }

    fn obstructed(&self) -> Verdict {
        let local = &self.exactness.local;
        let Some(found) = find_obstruction(self.model, self.problem, local) else {
            return match local.is_proof {
                true => Verdict::Refuted(Witness {
                    reason: format!(
                        "no density depends on q alone (hull of rank {}, with the demands {})",
                        local.rank, local.extended_rank
                    ),
                    sample: None,
                    values: Vec::new(),
                    help: "write `density: none;`".to_owned(),
                }),
                false => self.unconfirmed(),
            };
        };
        Verdict::Refuted(self.obstruction(found))
    }

    fn obstruction(&self, found: Obstruction) -> Witness {
        let frame: Vec<String> = found
            .frame
            .iter()
            .map(|(name, components)| format!("{name} = {}", self.vector(components)))
            .collect();
        let relation = match found.relation.is_empty() {
            true => "0".to_owned(),
            false => found
                .relation
                .iter()
                .map(|(name, value)| format!("{}*{name}", digits(*value)))
                .collect::<Vec<_>>()
                .join(" + "),
        };
        let bracket = &found.bracket;
        let reason = format!(
            "no density depends on q alone\n{bracket} = {relation} as a vector field, \
             but for an invariant exp(G)*mu_C, dG of the two sides would differ by delta\n\
             frame of D there: {}",
            frame.join(", ")
        );
        Witness {
            reason,
            values: vec![("delta".to_owned(), found.delta)],
            sample: Some(found.sample),
            help: "write `density: none;`".to_owned(),
        }
    }

    /// Text of a vector, such as `d_x + 0.41*d_y`.
    fn vector(&self, components: &[f64]) -> String {
        let mut text = String::new();
        for (i, value) in components.iter().enumerate() {
            if *value == 0.0 {
                continue;
            }
            let name = match self.model.coordinates.get(i) {
                Some(coordinate) => coordinate.name.display.as_str(),
                None => "t",
            };
            let size = match value.abs() {
                1.0 => String::new(),
                size => format!("{}*", digits(size)),
            };
            text += match (text.is_empty(), *value < 0.0) {
                (true, false) => "",
                (true, true) => "-",
                (false, false) => " + ",
                (false, true) => " - ",
            };
            text += &format!("{size}d_{name}");
        }
        if text.is_empty() {
            "0".to_owned()
        } else {
            text
        }
    }

    fn refuted_by_existence(&self, what: &str) -> Verdict {
        let certificate = self.existence();
        let help = match &self.exactness.global {
            Some(Global::Exists) => "write `density: exact;`",
            _ => "write `density: locally_exact;`",
        };
        Verdict::Refuted(Witness {
            reason: format!("{what}: {certificate}"),
            sample: None,
            values: Vec::new(),
            help: help.to_owned(),
        })
    }

    fn many_valued(&self) -> Verdict {
        let Some(Global::Many {
            turns,
            period,
            sample,
        }) = &self.exactness.global
        else {
            return self.unconfirmed();
        };
        let names: Vec<&str> = turns
            .iter()
            .map(|(i, _)| self.model.coordinates[*i].name.field.as_str())
            .collect();
        let reason = format!(
            "a density exists locally, but G grows by `period` {}",
            self.turns(turns)
        );
        Verdict::Refuted(Witness {
            reason,
            sample: Some(sample.clone()),
            values: vec![("period".to_owned(), *period)],
            help: format!(
                "write `density: locally_exact;`, or declare {} as a line instead of an angle",
                crate::diagnostics::listed(names)
            ),
        })
    }

    /// Text of a loop, such as `when psi1 makes a turn`.
    fn turns(&self, turns: &[(usize, i64)]) -> String {
        let each: Vec<String> = turns
            .iter()
            .map(|(i, count)| {
                let name = &self.model.coordinates[*i].name.display;
                let back = if *count < 0 { " backwards" } else { "" };
                match count.abs() {
                    1 => format!("{name} makes a turn{back}"),
                    many => format!("{name} makes {many} turns{back}"),
                }
            })
            .collect();
        format!("when {}", each.join(" and "))
    }
}

/// Up to four function calls or roots whose relations to each other are not visible modulo primes.
fn unrelated_atoms(pool: &Pool, problem: &Problem) -> Vec<String> {
    let parts = pool.reachable(&problem.roots());
    let is_atom = |id: &dalembert_expr::ExprId| {
        let profile = pool.profile_of(&[*id]);
        matches!(
            pool.node(*id),
            dalembert_expr::Node::Call(..) | dalembert_expr::Node::Product(_)
        ) && !profile.is_exact()
            && pool.zero_test(*id) != Zero::Proved
    };
    parts
        .into_iter()
        .filter(is_atom)
        .take(4)
        .map(|id| pool.text(id))
        .collect()
}
