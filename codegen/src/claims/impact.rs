//! What impacts do to quantities and to the volume.
//!
//! ```text
//! qdot+ = qdot + eps pi_D grad h,   rho = dh(pi_D grad h)/dh(grad h),   G = dh(qdot) + d_t h
//! elastic, restitution e   eps = -(1 + e) (g(qdot, pi_D grad h) + d_t h)/dh(pi_D grad h)
//! newton e                 eps = -(1 + e) G/dh(pi_D grad h)
//! nonholonomic plastic     eps = -2 rho G/dh(pi_D grad h)
//! impact plastic           eps = -G/dh(pi_D grad h)
//! totally plastic          eps = -rho G/dh(pi_D grad h)
//! ```
//!
//! The Jacobian with respect to `mu_C` is the square of the factor by which G is multiplied, for linear constraints.

use dalembert_expr::{
    Arithmetic, ExpansionPoint, ExprId, JetSpace, Jets, ModularPoint, Rational, RealPoint,
    SymbolId, Verdict as Zero,
};

use super::conserved::with_velocities;
use super::dynamics::{Dynamics, Number};
use super::evidence::{Vanishing, Wording, evidence};
use super::finding::Verdict;
use super::linear::{dot, solve};
use super::sample::{Sample, sample, uses};
use crate::mechanics::Derivation;
use crate::model::{Law, Model};

/// An impact surface with everything that its map is made of.
#[derive(Debug)]
struct Wall {
    /// Metric (N N), forms (M N), dh (N), d_t h, coefficient.
    roots: Vec<ExprId>,
    law: Law,
    gap: ExprId,
    gap_rate: ExprId,
    slope: Vec<ExprId>,
    coordinates: Vec<SymbolId>,
    velocities: Vec<SymbolId>,
    constraints: usize,
    polynomials: Vec<Polynomial>,
}

impl Wall {
    /// The surface of an index.
    fn of(model: &mut Model, derivation: &Derivation, surface: usize) -> Self {
        let own = &derivation.surfaces[surface];
        let law = model.surfaces[surface].law;
        let coefficient = match law {
            Law::Restitution(e) | Law::Newton(e) => e,
            Law::Elastic => model.pool.one(),
            _ => model.pool.zero(),
        };
        let mut roots: Vec<ExprId> = model.lagrangian.metric.iter().flatten().copied().collect();
        roots.extend(derivation.constraints.iter().flat_map(|own| &own.form));
        roots.extend(&own.form);
        roots.extend([own.rate, coefficient]);
        let coordinates: Vec<_> = model.coordinates.iter().map(|own| own.q).collect();
        Self {
            roots,
            law,
            gap: own.gap,
            gap_rate: own.gap_rate,
            slope: own.form.clone(),
            polynomials: polynomials(model, own.gap, &coordinates),
            coordinates,
            velocities: model.coordinates.iter().map(|own| own.qdot).collect(),
            constraints: derivation.constraints.len(),
        }
    }

    /// The velocities after an impact with the point's velocities; `None` at a singular point.
    fn after<P: ExpansionPoint>(&self, model: &Model, point: &mut P) -> Option<Vec<Number<P>>> {
        let (n, m) = (self.coordinates.len(), self.constraints);
        let field = point.field();
        let values = point.values(&model.pool, &model.pool.reachable(&self.roots))?;
        let space = JetSpace::new(0, 0, 1)?;
        let jets = Jets::new(field, &space);
        let mut entries = self
            .roots
            .iter()
            .map(|root| jets.constant(values[root.index()]));
        let mut rows = |count: usize| -> Vec<Vec<_>> {
            (0..count)
                .map(|_| entries.by_ref().take(n).collect())
                .collect()
        };
        let (metric, forms, slope) = (rows(n), rows(m), rows(1).pop()?);
        let rest: Vec<_> = entries.map(|own| jets.value(&own)).collect();
        let [rate, coefficient] = rest.as_slice() else {
            return None;
        };
        let right = (0..n)
            .map(|i| {
                let mut row: Vec<_> = forms.iter().map(|form| form[i].clone()).collect();
                row.push(slope[i].clone());
                row
            })
            .collect();
        let raised = solve(&jets, metric.clone(), right)?.unknowns;
        let column = |j: usize| -> Vec<_> { raised.iter().map(|row| row[j].clone()).collect() };
        let gradient = column(m);
        let duals: Vec<Vec<_>> = (0..m).map(column).collect();
        let mass = forms
            .iter()
            .map(|form| duals.iter().map(|dual| dot(&jets, form, dual)).collect())
            .collect();
        let along = forms
            .iter()
            .map(|form| vec![dot(&jets, form, &gradient)])
            .collect();
        let share = solve(&jets, mass, along)?.unknowns;
        let mut projected = gradient.clone();
        for (part, dual) in share.iter().zip(&duals) {
            for (own, w) in projected.iter_mut().zip(dual) {
                *own = jets.sub(own, &jets.mul(&part[0], w));
            }
        }
        let velocity: Vec<_> = self
            .velocities
            .iter()
            .map(|own| jets.constant(point.symbol(&model.pool, *own)))
            .collect();
        let number = |series: Vec<Number<P>>| jets.value(&series);
        let steep = number(dot(&jets, &slope, &projected));
        let gap_rate = field.add(number(dot(&jets, &slope, &velocity)), *rate);
        let lowered: Vec<_> = metric
            .iter()
            .map(|row| dot(&jets, row, &projected))
            .collect();
        let momentum = field.add(number(dot(&jets, &velocity, &lowered)), *rate);
        let ratio = || Some(field.mul(steep, field.inv(number(dot(&jets, &slope, &gradient)))?));
        let one = field.integer(1);
        let factor = match self.law {
            Law::Elastic | Law::Restitution(_) => field.mul(field.add(one, *coefficient), momentum),
            Law::Newton(_) => field.mul(field.add(one, *coefficient), gap_rate),
            Law::NonholonomicPlastic => field.mul(field.mul(field.integer(2), ratio()?), gap_rate),
            Law::ImpactPlastic => gap_rate,
            Law::TotallyPlastic => field.mul(ratio()?, gap_rate),
        };
        let impulse = field.neg(field.mul(factor, field.inv(steep)?));
        let after = |(own, along): (&Vec<Number<P>>, &Vec<Number<P>>)| {
            field.add(jets.value(own), field.mul(impulse, jets.value(along)))
        };
        Some(velocity.iter().zip(&projected).map(after).collect())
    }

    /// Moves a point onto the surface by solving for one coordinate in which the gap is a polynomial of degree 1 or 2.
    fn settle(&self, model: &Model, point: &mut ModularPoint) -> Option<()> {
        self.polynomials.iter().find_map(|polynomial| {
            let field = point.modulus();
            let mut trial = point.clone();
            trial.set(polynomial.symbol, 0);
            let values = model
                .pool
                .modular_eval(&polynomial.coefficients, &mut trial)
                .ok()?;
            let [c, b, a] = values.as_slice() else {
                return None;
            };
            let root = if *a == 0 {
                field.mul(field.neg(*c), field.inv(*b)?)
            } else {
                // a s^2 + b s + c = 0
                let four = field.integer(4);
                let square = field.sub(field.mul(*b, *b), field.mul(four, field.mul(*a, *c)));
                let root = field.sqrt(square)?;
                let twice = field.inv(field.mul(field.integer(2), *a))?;
                field.mul(field.sub(root, *b), twice)
            };
            point.set(polynomial.symbol, root);
            Some(())
        })
    }

    /// Moves a real sample onto the surface by Newton's method in the coordinate in which the gap is steepest.
    fn settle_sample(&self, model: &Model, sample: &mut Sample) -> Option<()> {
        for _ in 0..60 {
            let at = |symbol: SymbolId| sample.value(symbol).unwrap_or(0.0);
            let gap = model.pool.eval(&[self.gap], &at)[0];
            let slopes = model.pool.eval(&self.slope, &at);
            let (steepest, slope) = slopes
                .iter()
                .enumerate()
                .max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))?;
            let step = gap / slope;
            if !step.is_finite() {
                return None;
            }
            let symbol = self.coordinates[steepest];
            let value = at(symbol);
            if step.abs() <= 1e-15 * (1.0 + value.abs()) {
                return Some(());
            }
            sample.set(symbol, value - step.clamp(-0.5, 0.5));
        }
        None
    }
}

/// A coordinate in which a gap is `c + b s + a s^2`: the expressions of which c, b, a are the values at s = 0.
#[derive(Debug)]
struct Polynomial {
    symbol: SymbolId,
    coefficients: [ExprId; 3],
}

/// The coordinates in which a gap is a polynomial of degree 1 or 2.
fn polynomials(model: &mut Model, gap: ExprId, coordinates: &[SymbolId]) -> Vec<Polynomial> {
    let mut found = Vec::new();
    for symbol in coordinates {
        let first = model.pool.diff(gap, *symbol);
        let second = model.pool.diff(first, *symbol);
        let third = model.pool.diff(second, *symbol);
        let is_constant = model.pool.zero_test(first) == Zero::Proved;
        if model.pool.zero_test(third) == Zero::Proved && !is_constant {
            let half = model.pool.scale(&Rational::new(1, 2), second);
            found.push(Polynomial {
                symbol: *symbol,
                coefficients: [gap, first, half],
            });
        }
    }
    found
}

/// The verdict on `conserved under SURFACE: value` or `not conserved under SURFACE: value`.
pub(super) fn check_conserved_under(
    model: &mut Model,
    derivation: &Derivation,
    dynamics: &Dynamics,
    surface: usize,
    (value, written): (ExprId, &str),
    holds: bool,
    seed: u64,
) -> Verdict {
    let name = model.surfaces[surface].name.display.clone();
    let mut jump = Jump {
        wall: Wall::of(model, derivation, surface),
        dynamics,
        slopes: model
            .coordinates
            .iter()
            .map(|own| model.pool.diff(value, own.qdot))
            .collect(),
        value,
        written,
        anywhere: true,
    };
    let wording = || Wording {
        vanishes: format!("`{written}` is the same before and after an impact at `{name}`"),
        differs: format!("`{written}` changes in an impact at `{name}`"),
        help: [
            format!("write `not conserved under {name}: {written};`"),
            format!("write `conserved under {name}: {written};`"),
        ],
    };
    // The map is a formula that makes sense off the surface too; what it keeps there it keeps on the surface.
    let everywhere = evidence(model, &jump, seed);
    if everywhere.vanishes == Some(true) {
        return everywhere.verdict(holds, wording(), seed);
    }
    jump.anywhere = false;
    evidence(model, &jump, seed).verdict(holds, wording(), seed)
}

/// The change of a quantity in an impact.
struct Jump<'j> {
    wall: Wall,
    dynamics: &'j Dynamics,
    value: ExprId,
    /// Its derivatives by the velocities.
    slopes: Vec<ExprId>,
    written: &'j str,
    /// Whether the position is anywhere, or on the surface.
    anywhere: bool,
}

impl Jump<'_> {
    fn slope_by_velocity(&self, model: &Model, point: &mut RealPoint) -> Option<f64> {
        let values = point.values(&model.pool, &model.pool.reachable(&self.slopes))?;
        Some(
            self.slopes
                .iter()
                .map(|slope| values[slope.index()].abs())
                .sum(),
        )
    }

    fn values<P: ExpansionPoint>(
        &self,
        model: &Model,
        point: &mut P,
        velocities: &[Number<P>],
    ) -> Option<Number<P>> {
        for (coordinate, velocity) in model.coordinates.iter().zip(velocities) {
            point.set_symbol(coordinate.qdot, *velocity);
        }
        let values = point.values(&model.pool, &model.pool.reachable(&[self.value]))?;
        Some(values[self.value.index()])
    }
}

impl Vanishing for Jump<'_> {
    fn roots(&self) -> Vec<ExprId> {
        let mut roots = self.dynamics.roots();
        roots.extend(&self.wall.roots);
        roots.extend([self.wall.gap, self.wall.gap_rate, self.value]);
        roots
    }

    fn settle(&self, model: &Model, point: &mut ModularPoint) -> Option<()> {
        if !self.anywhere {
            self.wall.settle(model, point)?;
        }
        self.dynamics.motion(&model.pool, point, None).map(|_| ())
    }

    fn sample(&self, model: &Model, attempt: usize) -> Option<(Sample, RealPoint)> {
        let mut sample = sample(model, attempt, uses(&model.pool, &self.roots()));
        self.wall.settle_sample(model, &mut sample)?;
        let (sample, point) = with_velocities(model, self.dynamics, sample, attempt)?;
        let rate = model.pool.eval(&[self.wall.gap_rate], &|s| point.value(s))[0];
        (rate < 0.0).then_some((sample, point))
    }

    fn terms<P: ExpansionPoint>(&self, model: &Model, point: &mut P) -> Option<Vec<Number<P>>> {
        let before: Vec<_> = model
            .coordinates
            .iter()
            .map(|own| point.symbol(&model.pool, own.qdot))
            .collect();
        let after = self.wall.after(model, point)?;
        let new = self.values(model, point, &after)?;
        let old = self.values(model, point, &before)?;
        Some(vec![new, point.field().neg(old)])
    }

    fn scale(&self, model: &Model, point: &mut RealPoint) -> Option<f64> {
        let terms = self.terms(model, point)?;
        let after = self.wall.after(model, point)?;
        let velocity = after.iter().fold(0.0, |size: f64, own| size.max(own.abs()));
        Some(
            terms.iter().map(|term| term.abs()).sum::<f64>()
                + self.slope_by_velocity(model, point)? * velocity,
        )
    }

    fn shown(&self, _: &Model, terms: &[f64]) -> Vec<(String, f64)> {
        let names = [
            format!("{} after", self.written),
            format!("{} before", self.written),
        ];
        names.into_iter().zip([terms[0], -terms[1]]).collect()
    }
}

/// What each surface does to an invariant `exp(G) mu_C`, one sentence each.
pub(super) fn volume_remarks(model: &Model, derivation: &Derivation) -> Vec<String> {
    let is_affine = derivation
        .constraints
        .iter()
        .any(|own| !model.pool.is_syntactic_zero(own.affine));
    let sentence = |(s, surface): (usize, &crate::model::Surface)| {
        let moves = !model.pool.is_syntactic_zero(derivation.surfaces[s].rate);
        let squared = |e: ExprId| match model.pool.as_number(e) {
            Some(number) if number.is_one() => "keeps it".to_owned(),
            Some(number) if number.is_zero() => "maps it to 0".to_owned(),
            _ => format!("multiplies it by ({})^2", model.pool.text(e)),
        };
        let effect = match surface.law {
            Law::Elastic if !is_affine => "keeps it".to_owned(),
            Law::Elastic => "multiplies it by -G+/G-, G the gap rate before and after".to_owned(),
            Law::Restitution(e) if !is_affine => squared(e),
            Law::Restitution(e) => format!(
                "multiplies it by -({})*G+/G-, G the gap rate before and after",
                model.pool.text(e)
            ),
            Law::Newton(e) => squared(e),
            Law::NonholonomicPlastic => {
                "multiplies it by (1 - 2*rho)^2, rho = dh(pi_D grad h)/dh(grad h)".to_owned()
            }
            Law::ImpactPlastic => "maps it to 0".to_owned(),
            Law::TotallyPlastic => {
                "multiplies it by (1 - rho)^2, rho = dh(pi_D grad h)/dh(grad h)".to_owned()
            }
        };
        let moving = if moves { ", which moves," } else { "" };
        format!(
            "an impact at {}{moving} ({}) {effect}",
            surface.name.display,
            law_name(surface.law)
        )
    };
    model.surfaces.iter().enumerate().map(sentence).collect()
}

fn law_name(law: Law) -> &'static str {
    match law {
        Law::Elastic => "elastic",
        Law::Restitution(_) => "restitution",
        Law::Newton(_) => "newton",
        Law::NonholonomicPlastic => "nonholonomic_plastic",
        Law::ImpactPlastic => "impact_plastic",
        Law::TotallyPlastic => "totally_plastic",
    }
}
