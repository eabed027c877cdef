//! Equations of motion that may jump, and the claims that they leave open.
//!
//! A claim about the motion is decided by an identity at states where the equations are smooth. A motion that crosses a
//! place `h = 0` where they jump needs more, because the rate of its state changes by `DX` there, and the derivative of
//! the flow by the factor `1 + DX dh/(dh X)`.
//!
//! - If the metric, a term that is linear in velocities, a constraint or a position equation jumps, the velocities do too,
//!   and every claim stays open. The same holds where such equations are not regular and have kinks:
//!   `x*dot(y) = abs(x)*dot(x)` is solved by `dot(y) = abs(x)/x*dot(x)`. A jump of the potential has no force that would
//!   change the energy, so that claims stay open there too.
//! - If a force jumps, or a rate of a first-order system, the state is continuous. A smooth quantity whose rate is 0 on both
//!   sides is conserved, also by motion that slides along the place. A quantity with kinks may change while motion
//!   slides: `abs(v) + t` under Coulomb friction.
//! - A jump at which `dh X` is continuous keeps volumes with a continuous density, such as a jump of a force at certain
//!   positions. It need not keep other forms. A jump of a force at certain velocities changes volumes.
//! - A kink of the Lagrangian makes forces jump as well. The factor then preserves the symplectic form, as the limit of those
//!   of smooth Lagrangians. It need not preserve other forms.
//! - Jumps of potentials and forces at certain times are harmless: every motion has them at the same time. Where the growth
//!   of volumes jumps, a density may not exist although it exists before and after.
//! - Almost all motions avoid sets of codimension 2, such as a centre of attraction. Claims about volumes and forms hold there.
//! - A symmetry stays open if its flow crosses a jump, or a kink of a Lagrangian that it does not keep: on each side the
//!   Lagrangian gains the derivative of a function, and both functions need not fit. It also stays open if the derivatives of
//!   the field jump, because then so do the velocities that its flow gives.
//! - A density that is infinite somewhere stays open if volumes shrink there at an infinite rate: `dot(x) = -sqrt(x)` with the
//!   density `1/sqrt(x)`. Where the divergence of the rates is finite, a motion reaches no infinite density, because its logarithm
//!   changes at a finite rate. Elsewhere it may, and motions may stay there. The same holds for forms.
//! - An input may jump at any time. A claim about a quantity that depends on it, such as `dot(x)` where it gives that rate,
//!   stays open.
//! - A claim about a surface whose gap jumps stays open: the motion meets a face that the gap does not describe.

use dalembert_expr::{ExprId, SymbolId, Verdict as Zero};

use super::barriers::{cannot_stay, is_avoided};
use super::conserved::{is_constant, jump_unless};
use super::continuity::{WithLogarithms, has_gaps, infinite_slopes, is_smooth, may_bend, poles};
use super::definite::is_regular;
use super::density::factors;
use super::dynamics::Dynamics;
use super::examine::explicit;
use super::finding::Verdict;
use super::kept::stated_or_one;
use super::symmetry::keeps_lagrangian;
use crate::mechanics::{ConstraintForm, Derivation};
use crate::model::{Claim, Existence, ExteriorForm, Model, Statement};

/// The verdict on a claim about the motion, left open if the equations of motion may jump.
pub(super) fn unless_abrupt(
    model: &mut Model,
    derivation: &Derivation,
    parts: &[Dynamics],
    claim: &Claim,
    verdict: Verdict,
    seed: u64,
) -> Verdict {
    let statement = &claim.statement;
    let rests_on_smoothness = match statement {
        // The density that refutes the claim may break at the jump.
        Statement::Conserved { holds: false, .. } | Statement::Existence(Existence::None) => {
            matches!(verdict, Verdict::Refuted(_))
        }
        Statement::Existence(Existence::Local) => !matches!(verdict, Verdict::Undecided(_)),
        _ => matches!(verdict, Verdict::Proved(_)),
    };
    if !rests_on_smoothness {
        return verdict;
    }
    let jump = parts.iter().find_map(|dynamics| {
        let equations = Equations {
            derivation,
            dynamics,
            seed,
        };
        equations.jump(model, statement)
    });
    match jump {
        Some(jump) => Verdict::Undecided(reason(&jump)),
        None => verdict,
    }
}

/// The reason for an open verdict, from the text of a jump.
pub(super) fn reason(jump: &str) -> String {
    format!("it holds where nothing jumps, but {jump}")
}

/// A jump that may change the volume of the configuration, as text.
pub(super) fn breaks_volume(
    model: &mut Model,
    derivation: &Derivation,
    dynamics: &Dynamics,
    seed: u64,
) -> Option<String> {
    let equations = Equations {
        derivation,
        dynamics,
        seed,
    };
    equations.jump(model, &Statement::Existence(Existence::Global))
}

/// Places at which a jump leaves a claim intact.
#[derive(Clone, Copy)]
struct Harmless<'h> {
    /// Certain times.
    at_times: bool,
    /// Certain times and positions.
    at_positions: bool,
    /// Sets of codimension 2 in the states, which almost all motions avoid.
    at_thin_sets: bool,
    /// Places that the flow of this field does not cross.
    along: Option<&'h [ExprId]>,
    /// Places that a motion with these rates crosses at a rate `dh X` that does not jump.
    across: Option<&'h [ExprId]>,
}

impl Harmless<'_> {
    const NOWHERE: Self = Self {
        at_times: false,
        at_positions: false,
        at_thin_sets: false,
        along: None,
        across: None,
    };
    const AT_THIN_SETS: Self = Self {
        at_thin_sets: true,
        ..Self::NOWHERE
    };
    const AT_TIMES: Self = Self {
        at_times: true,
        ..Self::AT_THIN_SETS
    };
    const AT_POSITIONS: Self = Self {
        at_positions: true,
        ..Self::AT_TIMES
    };

    /// True if an expression whose zeros are the place of a jump makes it harmless.
    fn allows(&self, model: &mut Model, part: ExprId) -> bool {
        let positions = model.coordinates.iter().map(|it| it.q);
        let velocities: Vec<SymbolId> = model.coordinates.iter().map(|it| it.qdot).collect();
        let states: Vec<SymbolId> = positions.chain(velocities.iter().copied()).collect();
        let is_free = |symbols: &[SymbolId]| !model.pool.depends_on_any(part, symbols);
        if is_free(&states) && (self.at_times || is_free(&[model.time]))
            || self.at_positions && is_free(&velocities)
        {
            return true;
        }
        if let Some(field) = self.along {
            let positions = model.coordinates.iter().map(|it| it.q);
            let flow: Vec<(SymbolId, ExprId)> = positions.zip(field.iter().copied()).collect();
            let change = model.pool.derivative_along(part, &flow);
            return model.pool.zero_test(change) == Zero::Proved;
        }
        if let Some(rates) = self.across {
            let positions = model.coordinates.iter().map(|it| it.q);
            let mut motion: Vec<(SymbolId, ExprId)> =
                positions.zip(rates.iter().copied()).collect();
            motion.push((model.time, model.pool.one()));
            let crossing = model.pool.derivative_along(part, &motion);
            if !may_bend(model, crossing, &mut |_, _| false) {
                return true;
            }
        }
        self.at_thin_sets && is_avoided(model, part)
    }
}

/// The equations of motion of a model.
struct Equations<'e> {
    derivation: &'e Derivation,
    dynamics: &'e Dynamics,
    seed: u64,
}

impl Equations<'_> {
    /// A jump that leaves the statement open, as text.
    fn jump(&self, model: &mut Model, statement: &Statement) -> Option<String> {
        if let Some(input) = supplied(model, statement) {
            return Some(format!(
                "the claimed quantity may jump with the input `{input}`"
            ));
        }
        let surfaces = model.acting_surfaces();
        match statement {
            Statement::Conserved {
                under: Some(surface),
                ..
            }
            | Statement::Factor { under: surface, .. }
            | Statement::EnergyNotIncreasing(surface) => {
                self.on_surfaces(model, &[*surface], Harmless::NOWHERE)
            }
            Statement::Conserved { value, .. } => self
                .on_values(model, &[*value])
                .or_else(|| self.merge(model, &[*value])),
            Statement::Integrable(functions) => {
                let values: Vec<ExprId> = functions.iter().map(|it| it.value).collect();
                self.on_values(model, &values)
                    .or_else(|| self.merge(model, &values))
                    .or_else(|| self.on_surfaces(model, &surfaces, Harmless::NOWHERE))
            }
            Statement::Density(value) => self.of_density(model, Some(*value)),
            Statement::VolumeKept => {
                let stated = stated_or_one(model);
                let is_stated = stated.written.is_some() || model.is_first_order();
                let motion = match is_stated {
                    true => self.of_density(model, stated.value),
                    false => self.of_existence(model),
                };
                motion.or_else(|| self.on_surfaces(model, &surfaces, Harmless::NOWHERE))
            }
            Statement::Existence(_) => self.of_existence(model),
            Statement::Symplectic => {
                let forces = forces(model);
                self.on_states(model, Harmless::AT_THIN_SETS)
                    .or_else(|| self.among(model, &forces, Harmless::AT_TIMES))
                    .or_else(|| self.on_surfaces(model, &surfaces, Harmless::NOWHERE))
            }
            Statement::Invariant(form) => {
                let terms = self.terms(model);
                let expressions = statement.expressions();
                let slopes = slopes_of_differentials(model, form);
                let coefficients = written_out(model, &[expressions.clone(), slopes].concat());
                self.on_states(model, Harmless::AT_THIN_SETS)
                    .or_else(|| self.among(model, &terms, Harmless::AT_TIMES))
                    .or_else(|| self.on_surfaces(model, &surfaces, Harmless::NOWHERE))
                    .or_else(|| self.collapse(model, &coefficients, &terms))
                    .or_else(|| self.merge(model, &expressions))
            }
            Statement::Symmetry(field) => {
                let along = Harmless {
                    along: Some(field),
                    ..Harmless::NOWHERE
                };
                self.of_symmetry(model, field, along)
                    .or_else(|| self.on_surfaces(model, &surfaces, along))
            }
            Statement::Involution(_) => None,
        }
    }

    /// A jump that leaves a symmetry open, as text.
    fn of_symmetry(
        &self,
        model: &mut Model,
        field: &[ExprId],
        along: Harmless<'_>,
    ) -> Option<String> {
        if model.is_first_order() {
            let rates = forces(model);
            return self.among(model, &rates, along);
        }
        let whole = model.lagrangian.whole;
        let values = [self.kinematic(model), vec![whole]].concat();
        if let Some(jump) = self.among(model, &values, along) {
            return Some(jump);
        }
        let positions: Vec<SymbolId> = model.coordinates.iter().map(|it| it.q).collect();
        if !keeps_lagrangian(model, field, self.seed) {
            let slopes: Vec<ExprId> = (positions.iter())
                .map(|q| model.pool.diff(whole, *q))
                .collect();
            if let Some(jump) = self.among(model, &slopes, along) {
                return Some(jump);
            }
        }
        let time = model.time;
        let slopes: Vec<ExprId> = (field.iter())
            .flat_map(|component| positions.iter().chain([&time]).map(|by| (*component, *by)))
            .map(|(component, by)| model.pool.diff(component, by))
            .collect();
        let mut places = (slopes.iter()).map(|slope| self.place(model, *slope, Harmless::NOWHERE));
        let place = places.find_map(|place| place)?;
        Some(format!("the derivatives of the field may jump {place}"))
    }

    /// A jump that leaves a stated density open, as text.
    fn of_density(&self, model: &mut Model, value: Option<ExprId>) -> Option<String> {
        let forces = forces(model);
        let values: Vec<ExprId> = value.into_iter().collect();
        let whole = written_out(model, &values);
        let values = (whole.iter()).flat_map(|value| factors(&model.pool, *value));
        let values: Vec<ExprId> = values.collect();
        // Where a density of mechanics jumps by itself was tested with its balance.
        if model.is_first_order()
            && let Some(jump) = self.among(model, &values, Harmless::NOWHERE)
        {
            return Some(jump);
        }
        let harmless = match model.is_first_order() {
            true => Harmless {
                across: Some(&forces),
                ..Harmless::AT_TIMES
            },
            false => Harmless::AT_POSITIONS,
        };
        self.on_states(model, Harmless::AT_THIN_SETS)
            .or_else(|| self.among(model, &forces, harmless))
            .or_else(|| {
                let terms = match model.constraints.is_empty() {
                    true => forces,
                    false => self.terms(model),
                };
                self.collapse(model, &whole, &terms)
            })
    }

    /// A place where a density or the coefficients of a form are infinite, if motions may reach it, as text. `terms` are
    /// those of the equations of motion whose derivatives give the rates of these values.
    fn collapse(&self, model: &mut Model, values: &[ExprId], terms: &[ExprId]) -> Option<String> {
        let parts = model.pool.reachable(values);
        let infinite = poles(&mut model.pool, &parts, WithLogarithms(true));
        let infinite = self.possible_zeros(model, infinite);
        let place = *infinite.first()?;
        let parts = model.pool.reachable(terms);
        let mut unbounded = poles(&mut model.pool, &parts, WithLogarithms(true));
        unbounded.extend(infinite_slopes(&mut model.pool, &parts));
        if self.possible_zeros(model, unbounded).is_empty() {
            return None;
        }
        Some(may_stay(&model.pool.text(place)))
    }

    /// A place where motions may stay because a root gives a velocity on which these values depend, as text. The rate of the
    /// values rests on the derivative of the root, which does not exist there: `dot(x) = -sqrt(x)` reaches `x = 0` and
    /// stays, so that `dot(x) - t/2` changes.
    fn merge(&self, model: &mut Model, values: &[ExprId]) -> Option<String> {
        let is_affine = self
            .derivation
            .constraints
            .iter()
            .any(|constraint| model.pool.zero_test(constraint.affine) != Zero::Proved);
        // The power balance of the energy has no derivative of a constraint that does no work.
        let energy = model.pool.variable(model.derived.energy);
        if values == [energy] && !model.is_first_order() && !is_affine {
            return None;
        }
        let values: Vec<ExprId> = values.iter().map(|it| explicit(model, *it)).collect();
        for (velocities, terms) in self.equations_of_velocities(model) {
            let mut dependent = values.iter();
            if !dependent.any(|value| model.pool.depends_on_any(*value, &velocities)) {
                continue;
            }
            let parts = model.pool.reachable(&terms);
            let mut roots = infinite_slopes(&mut model.pool, &parts);
            roots.retain(|root| !cannot_stay(model, *root));
            if let Some(place) = self.possible_zeros(model, roots).first() {
                let text = model.pool.text(*place);
                return Some(may_stay(&text));
            }
        }
        None
    }

    /// The equations that determine velocities: their velocities, and the terms of each.
    fn equations_of_velocities(&self, model: &Model) -> Vec<(Vec<SymbolId>, Vec<ExprId>)> {
        let velocities: Vec<SymbolId> = model.coordinates.iter().map(|it| it.qdot).collect();
        if let Some(rates) = &model.field {
            let pairs = velocities.into_iter().zip(rates);
            return pairs.map(|(by, rate)| (vec![by], vec![*rate])).collect();
        }
        let constraints = self.derivation.constraints.iter();
        let equation = |constraint: &ConstraintForm| {
            let entries = velocities.iter().zip(&constraint.form);
            let restricted = entries.filter(|(_, entry)| !model.pool.is_syntactic_zero(**entry));
            let terms = constraint.form.iter().chain([&constraint.affine]);
            (
                restricted.map(|(by, _)| *by).collect(),
                terms.copied().collect(),
            )
        };
        constraints.map(equation).collect()
    }

    /// Those of the expressions that may be 0 in some state, and along a motion.
    fn possible_zeros(&self, model: &mut Model, expressions: Vec<ExprId>) -> Vec<ExprId> {
        let coordinates = model.coordinates.iter();
        let states: Vec<SymbolId> = coordinates.flat_map(|it| [it.q, it.qdot]).collect();
        let may_be_zero = |id: &ExprId| {
            model.pool.depends_on_any(*id, &states)
                && (!model.pool.sign(*id).is_nonzero() || has_gaps(model, *id))
                && !is_constant(model, self.dynamics, *id, self.seed)
        };
        expressions.into_iter().filter(may_be_zero).collect()
    }

    /// A jump that leaves a density that is looked for open, as text: it need not be continuous where the derivatives of its logarithm
    /// jump.
    fn of_existence(&self, model: &mut Model) -> Option<String> {
        if let Some(place) = self.of_density(model, None) {
            return Some(place);
        }
        // The growth of a volume may not even jump at certain times: the density is continuous along motions, and need
        // not be able to follow.
        let growth = self.growth(model);
        let is_constrained = !model.constraints.is_empty();
        self.among(model, &growth, Harmless::AT_THIN_SETS)
            .or_else(|| {
                let terms = is_constrained.then(|| self.terms(model))?;
                self.among(model, &terms, Harmless::AT_TIMES)
            })
    }

    /// The terms of the growth of volumes: slopes of the forces, and of what constraints add, by velocities; for a first-order
    /// system the divergence.
    fn growth(&self, model: &mut Model) -> Vec<ExprId> {
        if let Some(rates) = model.field.clone() {
            let positions = model.coordinates.iter().map(|it| it.q);
            let pairs: Vec<(ExprId, SymbolId)> = rates.into_iter().zip(positions).collect();
            let slopes = pairs
                .into_iter()
                .map(|(rate, by)| model.pool.diff(rate, by));
            let slopes: Vec<ExprId> = slopes.collect();
            return vec![model.pool.sum(&slopes)];
        }
        let terms = match model.constraints.is_empty() {
            true => forces(model),
            false => self.terms(model),
        };
        let velocities: Vec<SymbolId> = model.coordinates.iter().map(|it| it.qdot).collect();
        let pairs = terms
            .iter()
            .flat_map(|term| velocities.iter().map(move |by| (*term, *by)));
        pairs.map(|(term, by)| model.pool.diff(term, by)).collect()
    }

    /// A jump that leaves the conservation of these values open, as text.
    fn on_values(&self, model: &mut Model, values: &[ExprId]) -> Option<String> {
        if let Some(place) = self.on_states(model, Harmless::NOWHERE) {
            return Some(place);
        }
        let values = written_out(model, values);
        let is_smooth = |value: &ExprId| is_smooth(model, *value);
        if values.iter().all(is_smooth) {
            return None;
        }
        let forces = forces(model);
        let at_times = Harmless {
            at_thin_sets: false,
            ..Harmless::AT_TIMES
        };
        self.among(model, &values, Harmless::NOWHERE)
            .or_else(|| self.among(model, &forces, at_times))
    }

    /// A jump that leaves the motion open, as text: the Lagrangian, a constraint or a position equation jumps, or has a kink and
    /// is not regular. At jumps of the potential the velocities are continuous.
    fn on_states(&self, model: &mut Model, kinematic: Harmless<'_>) -> Option<String> {
        if model.is_first_order() {
            return None;
        }
        let values = self.kinematic(model);
        let potential = [model.lagrangian.potential];
        if let Some(place) = self
            .among(model, &values, kinematic)
            .or_else(|| self.among(model, &potential, Harmless::AT_TIMES))
        {
            return Some(place);
        }
        let metric = model.lagrangian.metric.clone();
        if self.bends(model, &metric) && !is_regular(model, &metric) {
            return Some(motion_jumps("where the metric is singular"));
        }
        let forms: Vec<Vec<ExprId>> = (self.derivation.constraints.iter())
            .map(|constraint| constraint.form.clone())
            .collect();
        let is_open = self.bends(model, &forms) && !are_independent(model, forms);
        is_open.then(|| motion_jumps("where the constraints are not independent"))
    }

    /// A jump of one of these gaps, as text.
    fn on_surfaces(
        &self,
        model: &mut Model,
        surfaces: &[usize],
        harmless: Harmless<'_>,
    ) -> Option<String> {
        surfaces.iter().find_map(|surface| {
            let gap = model.surfaces[*surface].gap;
            let place = self.place(model, gap, harmless)?;
            let name = &model.surfaces[*surface].name.display;
            Some(format!("the gap of `{name}` may jump {place}"))
        })
    }

    /// The expressions that relate velocities and momenta: the metric, the terms of the Lagrangian that are linear in the
    /// velocities, the constraints and the position equations.
    fn kinematic(&self, model: &Model) -> Vec<ExprId> {
        let lagrangian = &model.lagrangian;
        let mut values: Vec<ExprId> = lagrangian.metric.iter().flatten().copied().collect();
        values.extend(&lagrangian.linear);
        for constraint in &self.derivation.constraints {
            values.extend(&constraint.form);
            values.push(constraint.affine);
        }
        values.extend(model.constraints.iter().filter_map(|it| it.level));
        values
    }

    /// True if some entry may have a kink along a motion.
    fn bends(&self, model: &mut Model, rows: &[Vec<ExprId>]) -> bool {
        let entries: Vec<ExprId> = rows.iter().flatten().copied().collect();
        entries.into_iter().any(|entry| {
            may_bend(model, entry, &mut |model, part| {
                is_constant(model, self.dynamics, part, self.seed)
            })
        })
    }

    /// Forces, derivatives of the Lagrangian, and curvatures of the constraints; for a first-order system its rates.
    fn terms(&self, model: &mut Model) -> Vec<ExprId> {
        let mut terms = forces(model);
        if !model.is_first_order() {
            let [_, motion] = self.dynamics.equations();
            terms.extend(motion.iter().flatten());
        }
        terms
    }

    /// A jump of one of these terms, as text, unless it is harmless.
    fn among(&self, model: &mut Model, terms: &[ExprId], harmless: Harmless<'_>) -> Option<String> {
        let mut places = terms.iter().map(|term| self.place(model, *term, harmless));
        let place = places.find_map(|place| place)?;
        Some(motion_jumps(&place))
    }

    /// A place where an expression may jump, unless that is harmless.
    fn place(&self, model: &mut Model, term: ExprId, harmless: Harmless<'_>) -> Option<String> {
        jump_unless(model, self.dynamics, term, self.seed, &|model, part| {
            harmless.allows(model, part)
        })
    }
}

/// The name of an input on which a claimed quantity depends, as `dot(x)` does where an input gives that rate.
fn supplied(model: &mut Model, statement: &Statement) -> Option<String> {
    let inputs: Vec<(String, SymbolId)> = (model.inputs())
        .map(|(_, input)| (input.name.display.clone(), input.symbol))
        .collect();
    if inputs.is_empty() {
        return None;
    }
    let values = written_out(model, &statement.expressions());
    let mut pairs = inputs
        .iter()
        .flat_map(|input| values.iter().map(move |value| (input, *value)));
    let found = pairs.find(|((_, symbol), value)| {
        let slope = model.pool.diff(*value, *symbol);
        model.pool.zero_test(slope) != Zero::Proved
    });
    found.map(|((name, _), _)| name.clone())
}

/// Expressions with energy, momenta and, for a first-order system, rates written out.
fn written_out(model: &mut Model, values: &[ExprId]) -> Vec<ExprId> {
    let values: Vec<ExprId> = values.iter().map(|it| explicit(model, *it)).collect();
    let Some(rates) = model.field.clone() else {
        return values;
    };
    let velocities = model.coordinates.iter().map(|it| it.qdot);
    let rates: Vec<(SymbolId, ExprId)> = velocities.zip(rates).collect();
    model.pool.substitute_all(&values, &rates)
}

/// The derivatives of the functions whose differentials occur in a form, by coordinates, velocities and time.
fn slopes_of_differentials(model: &mut Model, form: &ExteriorForm) -> Vec<ExprId> {
    let coordinates = model.coordinates.iter();
    let mut symbols: Vec<SymbolId> = coordinates.flat_map(|it| [it.q, it.qdot]).collect();
    symbols.push(model.time);
    let functions = form.terms.iter().flat_map(|term| &term.differentials);
    let functions: Vec<ExprId> = functions.copied().collect();
    let functions: Vec<ExprId> = functions.iter().map(|it| explicit(model, *it)).collect();
    let pairs = functions
        .iter()
        .flat_map(|function| symbols.iter().map(move |by| (*function, *by)));
    pairs
        .map(|(function, by)| model.pool.diff(function, by))
        .collect()
}

/// Text for a place that motions may reach and not leave.
fn may_stay(place: &str) -> String {
    format!("motions may reach states where `{place}` is 0 and stay there")
}

fn motion_jumps(place: &str) -> String {
    format!("the equations of motion may jump {place}")
}

/// The components of all named forces; for a first-order system its rates.
fn forces(model: &Model) -> Vec<ExprId> {
    match &model.field {
        Some(rates) => rates.clone(),
        None => (model.forces.iter())
            .flat_map(|force| force.form.iter().copied())
            .collect(),
    }
}

/// True if constraints are certain to be independent at all states: one after the other has a component that is never 0,
/// in a coordinate that does not occur in those that are left.
fn are_independent(model: &Model, mut forms: Vec<Vec<ExprId>>) -> bool {
    let is_zero = |entry: ExprId| model.pool.zero_test(entry) == Zero::Proved;
    let is_never_zero = |entry: ExprId| model.pool.sign(entry).is_nonzero();
    while let Some(n) = forms.first().map(Vec::len) {
        let found = (0..n).find_map(|i| {
            let mut rows = (0..forms.len()).filter(|a| !is_zero(forms[*a][i]));
            let row = rows.next().filter(|a| is_never_zero(forms[*a][i]))?;
            rows.next().is_none().then_some(row)
        });
        match found {
            Some(row) => drop(forms.swap_remove(row)),
            None => return false,
        }
    }
    true
}
