//! The costate after an impact: `p+ = a + eps w` with `a = p.Delta_*^{-1}` and `w = dh.Delta_*^{-1}`.
//!
//! If inputs do not act along `w`, `H*` is linear in `eps` at the state after the impact, `H*+ = H*(a) + eps w.f+`, and
//! `eps = (H*- - H*(a) + a.d_t Delta)/(w.(f+ - d_t Delta) + d_t h)`.

use dalembert_expr::{Assumption, ExprId, Pool, SymbolId, Verdict};

use super::principle::Principle;
use super::system::{Back, Impact, System, dot};
use super::{Jump, Uncontrolled};
use crate::model::Model;

/// The jumps of all surfaces.
pub(super) fn derive(
    model: &mut Model,
    system: &System,
    principle: &Principle,
) -> Result<Vec<Jump>, Uncontrolled> {
    let mut jumps = Vec::new();
    for (index, impact) in system.impacts.iter().enumerate() {
        let time = model.time;
        let landing = Landing::of(&mut model.pool, system, principle, impact);
        if let Some(input) = landing.acting(&mut model.pool, system, principle) {
            let surface = &model.surfaces[index];
            let text = format!(
                "`{input}` acts on the gap of `{}` itself: the jump of the costate is not known in closed form",
                surface.name.display
            );
            let help =
                "let inputs act on velocities, so that the rate of the gap is known at an impact";
            return Err(Uncontrolled::at(surface.item, text, help));
        }
        jumps.push(landing.jump(&mut model.pool, time, principle));
    }
    Ok(jumps)
}

/// The costate after an impact as a function of `eps`, which is not yet known.
struct Landing<'a> {
    impact: &'a Impact,
    /// Symbols of the state, with their values after the impact.
    after: Vec<(SymbolId, ExprId)>,
    /// `a`
    base: Vec<ExprId>,
    /// `w`
    direction: Vec<ExprId>,
}

impl<'a> Landing<'a> {
    fn of(pool: &mut Pool, system: &System, principle: &Principle, impact: &'a Impact) -> Self {
        let costates: Vec<ExprId> = principle
            .costates
            .iter()
            .map(|p| pool.variable(*p))
            .collect();
        Self {
            after: system
                .states
                .iter()
                .copied()
                .zip(impact.map.iter().copied())
                .collect(),
            base: back(pool, &impact.back, &impact.form, &costates),
            direction: back(pool, &impact.back, &impact.form, &impact.form),
            impact,
        }
    }

    /// An input that may act along `w` after the impact.
    fn acting(&self, pool: &mut Pool, system: &System, principle: &Principle) -> Option<String> {
        for (input, column) in system.inputs.iter().zip(&principle.actuation) {
            let column = pool.substitute_all(column, &self.after);
            let along = dot(pool, &self.direction, &column);
            if pool.zero_test(along) != Verdict::Proved {
                return Some(pool.symbol_name(*input).to_owned());
            }
        }
        None
    }

    fn jump(&self, pool: &mut Pool, time: SymbolId, principle: &Principle) -> Jump {
        let moved: Vec<ExprId> = self
            .impact
            .map
            .iter()
            .map(|it| pool.diff(*it, time))
            .collect();
        let mut landed = self.after.clone();
        landed.extend(
            principle
                .costates
                .iter()
                .copied()
                .zip(self.base.iter().copied()),
        );
        let after = pool.substitute(principle.hamiltonian, &landed);
        let carried = dot(pool, &self.base, &moved);
        let difference = pool.sub(principle.hamiltonian, after);
        let difference = pool.sum(&[difference, carried]);
        let drift = pool.substitute_all(&principle.drift, &self.after);
        let relative: Vec<ExprId> = (drift.iter().zip(&moved))
            .map(|(drift, moved)| pool.sub(*drift, *moved))
            .collect();
        let rate = dot(pool, &self.direction, &relative);
        let rate = pool.sum(&[rate, self.impact.form_rate]);
        let epsilon = pool.div(difference, rate);
        let multiplier = pool.symbol("eps", r"\epsilon", Assumption::None);
        let strength = pool.variable(multiplier);
        let costate = self
            .base
            .iter()
            .zip(&self.direction)
            .map(|(base, direction)| {
                if pool.is_syntactic_zero(*direction) {
                    return *base;
                }
                let change = pool.mul(strength, *direction);
                pool.sum(&[*base, change])
            });
        Jump {
            costate: costate.collect(),
            state: self.impact.map.clone(),
            multiplier,
            epsilon,
        }
    }
}

/// `covector . Delta_*^{-1}`
fn back(pool: &mut Pool, back: &Back, form: &[ExprId], covector: &[ExprId]) -> Vec<ExprId> {
    let (factor, direction, turned) = match back {
        Back::Matrix(inverse) => {
            let column = |j: usize| inverse.iter().map(|row| row[j]).collect::<Vec<_>>();
            let columns: Vec<Vec<ExprId>> = (0..covector.len()).map(column).collect();
            return columns
                .iter()
                .map(|column| dot(pool, covector, column))
                .collect();
        }
        Back::Impulse {
            factor,
            direction,
            turned,
        } => (*factor, direction, turned),
    };
    let (positions, velocities) = covector.split_at(direction.len());
    let along = dot(pool, velocities, direction);
    let mut after = velocities.to_vec();
    if !pool.is_syntactic_zero(along) {
        let strength = pool.mul(factor, along);
        for (velocity, form) in after.iter_mut().zip(form) {
            if !pool.is_syntactic_zero(*form) {
                let change = pool.mul(strength, *form);
                *velocity = pool.sub(*velocity, change);
            }
        }
    }
    let mut whole = Vec::new();
    for (index, position) in positions.iter().enumerate() {
        let column: Vec<ExprId> = turned.iter().map(|row| row[index]).collect();
        let change = dot(pool, &after, &column);
        whole.push(pool.sub(*position, change));
    }
    whole.extend(after);
    whole
}
