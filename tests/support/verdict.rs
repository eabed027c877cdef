//! Models with verdicts on their invariant densities.

use dalembert_codegen::claims::{
    Dynamics, Exactness, Geometry, Global, Problem, Term, Undecided, decide, geometry_at,
    potential_text,
};
use dalembert_codegen::mechanics::{self, Derivation};
use dalembert_codegen::model::{self, Model};
use dalembert_codegen::spec;
use dalembert_emit::try_expand;
use dalembert_expr::SymbolId;
use serde_json::Value;

use crate::reference::number;

/// A model with the decision on densities that depend on the configuration.
#[derive(Debug)]
pub struct Decided {
    /// The model.
    pub model: Model,
    /// Its equations.
    pub derivation: Derivation,
    /// The motion on D.
    pub dynamics: Dynamics,
    /// The equations for the density.
    pub problem: Problem,
    /// The verdict.
    pub exactness: Result<Exactness, Undecided>,
}

/// The verdict as one of five cases.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Existence {
    /// A density exists on all of Q.
    Global,
    /// A density exists locally, but none on all of Q.
    Local,
    /// A density exists locally; the question stays open for all of Q.
    LocalAtLeast,
    /// No density exists.
    None,
    /// The question stays open.
    Open,
}

impl Decided {
    /// The model of a declaration, decided at random points with this seed.
    ///
    /// # Panics
    /// If the declaration is refused.
    pub fn with_seed(source: &str, seed: u64) -> Self {
        let spec = spec::parse(source.parse().expect("tokens"))
            .unwrap_or_else(|refused| panic!("{source}\n{refused:?}"));
        let mut model =
            model::check(&spec).unwrap_or_else(|refused| panic!("{source}\n{refused:?}"));
        let derivation = mechanics::derive(&mut model);
        let problem = Problem::of(&mut model, &derivation);
        let dynamics = Dynamics::of(&mut model, &derivation);
        let exactness = decide(&mut model, &problem, seed);
        Self {
            model,
            derivation,
            dynamics,
            problem,
            exactness,
        }
    }

    /// Same as [`Decided::with_seed`], with the seed 1.
    ///
    /// # Panics
    /// If the declaration is refused.
    pub fn of(source: &str) -> Self {
        Self::with_seed(source, 1)
    }

    /// The verdict.
    ///
    /// # Panics
    /// If the question stays open.
    pub fn exactness(&self) -> &Exactness {
        self.exactness.as_ref().expect("a verdict")
    }

    /// The verdict as one of five cases.
    pub fn existence(&self) -> Existence {
        match &self.exactness {
            Err(_) => Existence::Open,
            Ok(found) => match &found.global {
                None => Existence::None,
                Some(Global::Exists) => Existence::Global,
                Some(Global::Many { .. }) => Existence::Local,
                Some(Global::Undecided(_)) => Existence::LocalAtLeast,
            },
        }
    }

    /// The logarithm `G` of the density, if it was found in closed form.
    pub fn potential(&self) -> Option<String> {
        let (potential, _) = self.exactness.as_ref().ok()?.density.as_ref()?;
        Some(potential_text(&self.model.pool, potential))
    }

    /// The value of `G` at a point with this geometry, if `G` was found in closed form.
    pub fn log_density(&self, values: &[(SymbolId, f64)], geometry: &Geometry) -> Option<f64> {
        let (potential, _) = self.exactness.as_ref().ok()?.density.as_ref()?;
        let value = |symbol: SymbolId| {
            let found = values.iter().find(|(known, _)| *known == symbol);
            found.map_or(f64::NAN, |(_, value)| *value)
        };
        let number = |id| self.model.pool.eval(&[id], &value)[0];
        let term = |term: &Term| match term {
            Term::MassDeterminant => geometry.mass_determinant.ln(),
            Term::MetricDeterminant => geometry.metric_determinant.ln(),
            Term::DependentDeterminant => geometry.dependent_determinant.abs().ln(),
            Term::Logarithm(f) => number(*f).abs().ln(),
            Term::Plain(f) => number(*f),
        };
        let terms = potential.terms.iter();
        Some(terms.map(|(k, factor)| number(*k) * term(factor)).sum())
    }

    /// Same as [`Decided::log_density`], with the geometry of the point for the generator's dependent velocities.
    pub fn log_density_at(&self, values: &[(SymbolId, f64)]) -> Option<f64> {
        let geometry = geometry_at(&self.model.pool, &self.problem, values, None)?;
        self.log_density(values, &geometry)
    }

    /// The symbol of a coordinate or parameter.
    ///
    /// # Panics
    /// If there is none of this name.
    pub fn symbol(&self, name: &str) -> SymbolId {
        let coordinates = self
            .model
            .coordinates
            .iter()
            .map(|coordinate| (&coordinate.name, coordinate.q));
        let parameters = self
            .model
            .parameters
            .iter()
            .map(|parameter| (&parameter.name, parameter.symbol));
        let mut all = coordinates.chain(parameters);
        let found = all.find(|(known, _)| known.display == name);
        found.unwrap_or_else(|| panic!("no `{name}`")).1
    }

    /// Parameters at their defaults.
    ///
    /// # Panics
    /// If one has no default.
    pub fn defaults(&self) -> Vec<(SymbolId, f64)> {
        let pool = &self.model.pool;
        let value = |parameter: &model::Parameter| {
            let default = parameter.default.expect("a default");
            (parameter.symbol, pool.eval(&[default], &|_| 0.0)[0])
        };
        self.model.parameters.iter().map(value).collect()
    }

    /// The dependent velocities with the largest minor at a point.
    ///
    /// # Panics
    /// If the point is singular.
    pub fn regular_dependent(&self, values: &[(SymbolId, f64)]) -> Vec<usize> {
        let (n, m) = (
            self.model.coordinates.len(),
            self.model.constraints.len() as u32,
        );
        let choices = (0_u32..1 << n).filter(|choice| choice.count_ones() == m);
        let minor = |choice: u32| {
            let dependent: Vec<_> = (0..n).filter(|i| choice >> i & 1 == 1).collect();
            let geometry = geometry_at(&self.model.pool, &self.problem, values, Some(&dependent))?;
            Some((geometry.dependent_determinant.abs(), dependent))
        };
        let largest = choices.filter_map(minor).max_by(|a, b| a.0.total_cmp(&b.0));
        largest.expect("a regular point").1
    }

    /// The coordinates and parameters at which the reference file gives values of a system.
    ///
    /// # Panics
    /// If the file does not have the documented form.
    pub fn golden_point(&self, system: &Value) -> Vec<(SymbolId, f64)> {
        let golden = &system["golden"];
        ["point", "params"]
            .iter()
            .flat_map(|key| golden[key].as_object().expect("values"))
            .map(|(name, value)| (self.symbol(name), number(value)))
            .collect()
    }

    /// The indices of the coordinates whose velocities the reference file takes as dependent.
    ///
    /// # Panics
    /// If the file does not have the documented form.
    pub fn golden_dependent(&self, system: &Value) -> Vec<usize> {
        let names = system["golden"]["dependent"].as_array().expect("names");
        let position = |name: &Value| {
            let mut coordinates = self.model.coordinates.iter();
            coordinates
                .position(|coordinate| coordinate.name.display == *name)
                .expect("a coordinate")
        };
        names.iter().map(position).collect()
    }
}

/// The messages of a declaration that is refused.
///
/// # Panics
/// If it is accepted.
pub fn refusal(source: &str) -> Vec<String> {
    let refused = try_expand(source.parse().expect("tokens")).expect_err(source);
    refused
        .iter()
        .map(|error| error.message().to_owned())
        .collect()
}

/// The answer to a claim.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Answer {
    /// Proved.
    Proved,
    /// Refuted, with the message.
    Refuted(String),
    /// Left open, with the message.
    Undecided(String),
}

/// The answer of the generator to a claim that is added to a declaration without claims.
///
/// # Panics
/// If the declaration is refused for another reason.
pub fn answer(source: &str, claim: &str) -> Answer {
    let body = source.trim_end().strip_suffix('}').expect("a body");
    let source = format!("{body} claims {{ {claim}; }} }}");
    let Err(refused) = try_expand(source.parse().expect("tokens")) else {
        return Answer::Proved;
    };
    let message = refused
        .iter()
        .next()
        .expect("a message")
        .message()
        .to_owned();
    if message.contains(&format!("`{claim}` is refuted")) {
        return Answer::Refuted(message);
    }
    assert!(
        message.contains(&format!("`{claim}` is undecided")),
        "{message}"
    );
    Answer::Undecided(message)
}
