//! The invariant volume of a declared system, and the divergence of its motion by finite differences.

use dalembert_codegen::claims::{Exactness, Problem, Volume, decide};
use dalembert_codegen::mechanics::{self, Derivation};
use dalembert_codegen::model::{self, Model, Topology};
use dalembert_codegen::program::{self, Function, Input, Program, interpret::interpret};
use dalembert_codegen::spec;
use dalembert_expr::{ExprId, SymbolId};

use crate::linear::{determinant, solve};
use crate::sampling::Random;

/// A system with a volume in closed form, lowered.
#[derive(Debug)]
pub struct WithVolume {
    /// The model.
    pub model: Model,
    /// The derivation of the model.
    pub derivation: Derivation,
    /// The decision on the existence of a density.
    pub exactness: Exactness,
    /// The volume.
    pub volume: Volume,
    /// The program, with the functions of the volume.
    pub program: Program,
}

/// Shifts and weights of one side of the central difference of eighth order.
const STENCIL: [(f64, f64); 4] = [
    (1.0, 4.0 / 5.0),
    (2.0, -1.0 / 5.0),
    (3.0, 4.0 / 105.0),
    (4.0, -1.0 / 280.0),
];
/// Step `h`. The rounding error, about `1e-16/h`, exceeds the truncation error, `h^8/630` times the ninth derivative,
/// unless functions vary over lengths below 0.1.
const STEP: f64 = 4e-3;

impl WithVolume {
    /// The system of a declaration; `None` if no volume in closed form was found.
    ///
    /// # Panics
    /// If the declaration is refused.
    pub fn declared(source: &str) -> Option<Self> {
        Self::with(source, |_, _, found| {
            found.filter(|volume| volume.integral.is_none())
        })
    }

    /// The system of a declaration with `mu_C` itself, which need not be invariant.
    ///
    /// # Panics
    /// Same as [`WithVolume::declared`].
    pub fn natural(source: &str) -> Self {
        let natural = |model: &mut Model, derivation: &Derivation, _| {
            let problem = Problem::of(model, derivation);
            let one = model.pool.one();
            Volume::stated(model, derivation, &problem, one, 1)
        };
        Self::with(source, natural).expect("regular constraints")
    }

    /// The system of a declaration with the volume that `choose` returns when given the volume that was found.
    ///
    /// # Panics
    /// Same as [`WithVolume::declared`].
    pub fn with(
        source: &str,
        choose: impl FnOnce(&mut Model, &Derivation, Option<Volume>) -> Option<Volume>,
    ) -> Option<Self> {
        let spec = spec::parse(source.parse().expect("tokens")).expect(source);
        let mut model = model::check(&spec).expect(source);
        let derivation = mechanics::derive(&mut model);
        let problem = Problem::of(&mut model, &derivation);
        let exactness = decide(&mut model, &problem, 1).ok()?;
        let found = Volume::found(&model, &derivation, &problem, &exactness, 1);
        let volume = choose(&mut model, &derivation, found)?;
        let lowered = program::lower(&model, &derivation, Some(&volume));
        let program = lowered.global.unwrap_or(lowered.main);
        Some(Self {
            model,
            derivation,
            exactness,
            volume,
            program,
        })
    }

    /// A random configuration, away from the ends of charts.
    pub fn configuration(&self, random: &mut Random) -> Vec<f64> {
        let value = |coordinate: &model::Coordinate| match coordinate.topology {
            Topology::Interval { low, high } => {
                let ends = self.model.pool.eval(&[low, high], &|_| f64::NAN);
                ends[0] + (ends[1] - ends[0]) * random.within(0.2, 0.8)
            }
            _ => random.within(0.2, 1.3),
        };
        self.model.coordinates.iter().map(value).collect()
    }

    /// The arguments of a function of the program.
    pub fn input<'a>(
        &'a self,
        t: f64,
        q: &'a [f64],
        qdot: &'a [f64],
        p: &'a [f64],
    ) -> impl Fn(Input) -> f64 + 'a {
        move |input| match input {
            Input::Time => t,
            Input::Coordinate(i) => q[i],
            Input::Velocity(i) => qdot[i],
            Input::Momentum(i) => p[i],
            Input::Quasi(_) => f64::NAN,
            Input::Parameter(k) => self.parameter(k),
            Input::Excess(_) | Input::MotionRate(_) | Input::Multiplier(_) => f64::NAN,
        }
    }

    /// The results of a function of the program.
    ///
    /// # Panics
    /// If a guard does not hold.
    pub fn run(&self, function: &Function, t: f64, q: &[f64], qdot: &[f64], p: &[f64]) -> Vec<f64> {
        interpret(function, &self.input(t, q, qdot, p)).expect("a regular state")
    }

    /// The group of this name among the results of the program's `geometry` function; empty if there is none.
    pub fn reported<'a>(&self, name: &str, values: &'a [f64]) -> &'a [f64] {
        let mut rest = values;
        for group in &self.program.geometry.groups {
            let (values, tail) = rest.split_at(group.shape.count());
            if group.name == name {
                return values;
            }
            rest = tail;
        }
        &[]
    }

    fn parameter(&self, k: usize) -> f64 {
        let default = self.model.parameters[k].default.expect("a default");
        self.model.pool.eval(&[default], &|_| f64::NAN)[0]
    }

    /// `G`
    pub fn log_density(&self, t: f64, q: &[f64]) -> f64 {
        let function = &self.program.volume.as_ref().expect("a volume").log_density;
        self.run(function, t, q, &[], &[])[0]
    }

    /// `G + ln det g - ln |det A_dep|`
    pub fn log_volume(&self, t: f64, q: &[f64]) -> f64 {
        let function = &self.program.volume.as_ref().expect("a volume").log_volume;
        self.run(function, t, q, &[], &[])[0]
    }

    /// Values of expressions at a configuration, evaluated in the pool rather than by the program.
    pub fn evaluate(&self, expressions: &[ExprId], t: f64, q: &[f64]) -> Vec<f64> {
        let value = |symbol| self.value(symbol, t, q);
        self.model.pool.eval(expressions, &value)
    }

    /// The value of time, a coordinate or a parameter.
    ///
    /// # Panics
    /// If the symbol is something else.
    pub fn value(&self, symbol: SymbolId, t: f64, q: &[f64]) -> f64 {
        if symbol == self.model.time {
            return t;
        }
        let is_coordinate = |coordinate: &model::Coordinate| coordinate.q == symbol;
        if let Some(i) = self.model.coordinates.iter().position(is_coordinate) {
            return q[i];
        }
        let is_parameter = |parameter: &model::Parameter| parameter.symbol == symbol;
        let k = self.model.parameters.iter().position(is_parameter);
        self.parameter(k.expect("a parameter"))
    }

    /// The constraint forms by rows, each with its affine part last.
    pub fn forms(&self, t: f64, q: &[f64]) -> Vec<Vec<f64>> {
        let row = |constraint: &mechanics::constraint::ConstraintForm| {
            let entries = [constraint.form.clone(), vec![constraint.affine]].concat();
            self.evaluate(&entries, t, q)
        };
        self.derivation.constraints.iter().map(row).collect()
    }

    /// `det g` and `det m^{ab}`, by elimination with pivots.
    pub fn determinants(&self, t: f64, q: &[f64]) -> [f64; 2] {
        let rows = self.model.lagrangian.metric.iter();
        let metric: Vec<Vec<f64>> = rows.map(|row| self.evaluate(row, t, q)).collect();
        let forms: Vec<Vec<f64>> = self
            .forms(t, q)
            .into_iter()
            .map(|form| form[..q.len()].to_vec())
            .collect();
        let mass = forms.iter().map(|a| {
            let dual = solve(&metric, a);
            let entry = |b: &Vec<f64>| b.iter().zip(&dual).map(|(x, y)| x * y).sum();
            forms.iter().map(entry).collect()
        });
        let mass: Vec<Vec<f64>> = mass.collect();
        [metric, mass].map(|matrix| determinant(&matrix))
    }

    /// All velocities, completed from the independent ones.
    pub fn velocities(&self, t: f64, q: &[f64], independent: &[f64]) -> Vec<f64> {
        let chosen = &self.program.volume.as_ref().expect("a volume").independent;
        let mut qdot = vec![0.0; q.len()];
        for (&i, &v) in chosen.iter().zip(independent) {
            qdot[i] = v;
        }
        let forms = self.forms(t, q);
        let minor: Vec<Vec<f64>> = forms
            .iter()
            .map(|form| self.volume.dependent.iter().map(|&j| form[j]).collect())
            .collect();
        let right: Vec<f64> = forms
            .iter()
            .map(|form| {
                let known: f64 = form.iter().zip(&qdot).map(|(a, v)| a * v).sum();
                -(known + form[q.len()])
            })
            .collect();
        for (&j, v) in self.volume.dependent.iter().zip(solve(&minor, &right)) {
            qdot[j] = v;
        }
        qdot
    }

    /// Rates of the coordinates `(q, v_ind)` of the volume along the motion.
    pub fn motion(&self, t: f64, at: &[f64]) -> Vec<f64> {
        let (q, independent) = at.split_at(self.model.coordinates.len());
        let qdot = self.velocities(t, q, independent);
        let p = self.run(&self.program.momentum, t, q, &qdot, &[]);
        let values = self.run(&self.program.geometry.function, t, q, &qdot, &p);
        let acceleration = self.reported("acceleration", &values);
        let chosen = &self.program.volume.as_ref().expect("a volume").independent;
        let independent = chosen.iter().map(|&i| acceleration[i]);
        qdot.iter().copied().chain(independent).collect()
    }

    /// Same as [`divergence`], for the motion and the volume `exp(log_volume) dq dv_ind` at `(q, v_ind)`.
    pub fn divergence(
        &self,
        t: f64,
        at: &[f64],
        log_volume: impl Fn(f64, &[f64]) -> f64,
    ) -> [f64; 2] {
        divergence(t, at, |t, at| self.motion(t, at), log_volume)
    }
}

/// The divergence `d_t ln rho + (1/rho) d_k (rho F^k)` of a motion `F` with respect to `rho = exp(log_volume)` by
/// finite differences, and the sum of the absolute values of its terms.
pub fn divergence(
    t: f64,
    at: &[f64],
    motion: impl Fn(f64, &[f64]) -> Vec<f64>,
    log_volume: impl Fn(f64, &[f64]) -> f64,
) -> [f64; 2] {
    let base = log_volume(t, at);
    let ratio = |t: f64, at: &[f64]| (log_volume(t, at) - base).exp();
    let by_time = difference(|shift| ratio(t + shift, at));
    let terms = (0..at.len()).map(|k| {
        difference(|shift| {
            let mut moved = at.to_vec();
            moved[k] += shift;
            ratio(t, &moved) * motion(t, &moved)[k]
        })
    });
    let terms: Vec<f64> = terms.chain([by_time]).collect();
    let sizes = terms.iter().map(|term| term.abs());
    [terms.iter().sum(), sizes.sum()]
}

/// The derivative at 0, by the central difference of eighth order.
pub fn difference(f: impl Fn(f64) -> f64) -> f64 {
    let side = |(shift, weight): (f64, f64)| weight * (f(shift * STEP) - f(-shift * STEP));
    STENCIL.into_iter().map(side).sum::<f64>() / STEP
}
