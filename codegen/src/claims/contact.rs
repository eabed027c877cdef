//! The motion behind an impact whose law does not reverse the gap rate: free, or held by the surface.
//!
//! ```text
//! hdot+ > 0, or hdot+ = 0 and hddot > 0     the motion is free
//! hdot+ = 0 and hddot < 0                   the motion is held: qddot + c W with hddot = 0,    W = -(qdot+ - qdot-)/hdot-
//! ```
//!
//! In the conditions, `hddot` is that of the free motion; `c` gives the held motion `hddot = 0`. The case can be decided
//! at a single state, where the enclosure of the rate that decides excludes 0, but not for all states at once. The rate
//! `hdot+` is 0 after `impact_plastic` and `newton(0)`. After `restitution(0)` it is 0 unless constraints are affine:
//! this law stops the velocity across the surface, and leaves the rate prescribed by affine constraints.

use std::cmp::Ordering;

use dalembert_expr::{Arithmetic, ExprId, Pool, SymbolId};

use super::expansion::inner;
use super::wall::Wall;
use crate::model::{Law, Model};

/// One of the two motions.
pub(super) struct Contact {
    rate: ExprId,
    /// Derivatives of the gap rate with respect to positions, velocities and time.
    slopes: Vec<ExprId>,
    /// True if the gap rate is 0 after each impact.
    pub(super) is_stopped: bool,
    pub(super) is_held: bool,
}

impl Contact {
    /// The possible motions behind a surface; empty if the law reverses the gap rate.
    pub(super) fn all(model: &mut Model, surface: usize, wall: &Wall) -> Vec<Self> {
        if !may_hold(model, surface) {
            return Vec::new();
        }
        let is_stopped = stops(model, surface);
        // With instantaneous constraints, the held motion also satisfies these constraints. It is not examined.
        let is_alone = model.surfaces[surface].instantaneous.is_empty();
        let held = [false, true].into_iter();
        let held = held.filter(|is_held| !is_held || (is_stopped && is_alone));
        let held: Vec<bool> = held.collect();
        let positions = model.coordinates.iter().map(|coordinate| coordinate.q);
        let velocities = model.coordinates.iter().map(|coordinate| coordinate.qdot);
        let variables: Vec<SymbolId> = positions.chain(velocities).chain([model.time]).collect();
        let pool = &mut model.pool;
        let slopes = variables.iter().map(|by| pool.diff(wall.gap_rate, *by));
        let slopes: Vec<ExprId> = slopes.collect();
        let of = |is_held| Self {
            rate: wall.gap_rate,
            slopes: slopes.clone(),
            is_stopped,
            is_held,
        };
        held.into_iter().map(of).collect()
    }

    /// Description of the motion, to be appended to the description of the surface.
    pub(super) fn text(&self) -> &'static str {
        match self.is_held {
            true => "; the motion behind it is held",
            false => "; the motion behind it goes on freely",
        }
    }

    pub(super) fn roots(&self) -> impl Iterator<Item = ExprId> + '_ {
        self.slopes.iter().copied().chain([self.rate])
    }

    /// Replaces a coordinate by its value on the surface.
    pub(super) fn restrict(&mut self, pool: &mut Pool, solution: (SymbolId, ExprId)) {
        self.rate = pool.substitute(self.rate, &[solution]);
        self.slopes = pool.substitute_all(&self.slopes, &[solution]);
    }

    /// Gap rate behind the surface, and its derivative along the free motion with rates `outgoing`.
    pub(super) fn rates<A: Arithmetic>(
        &self,
        field: A,
        values: &[A::Scalar],
        outgoing: &[A::Scalar],
    ) -> [A::Scalar; 2] {
        let (slopes, time) = self.slopes.split_at(outgoing.len());
        let slopes = slopes.iter().map(|slope| values[slope.index()]);
        let along = inner(field, slopes, outgoing);
        let along = time
            .iter()
            .fold(along, |sum, slope| field.add(sum, values[slope.index()]));
        [values[self.rate.index()], along]
    }

    /// True if the signs of gap rate and derivative are those of this motion.
    pub(super) fn is_it(&self, [rate, along]: [Option<Ordering>; 2]) -> bool {
        match (self.is_stopped, self.is_held) {
            (true, true) => along == Some(Ordering::Less),
            (true, false) => along == Some(Ordering::Greater),
            (false, _) => rate == Some(Ordering::Greater),
        }
    }

    /// Adds the force of the surface to the rates of the free motion. `along` is the derivative of the gap rate along
    /// it, `lost` the gap rate before the impact.
    pub(super) fn hold<A: Arithmetic>(
        &self,
        field: A,
        outgoing: &mut [A::Scalar],
        velocities: [&[A::Scalar]; 2],
        (along, lost): (A::Scalar, A::Scalar),
    ) -> Option<()> {
        let size = field.mul(along, field.inv(lost)?);
        let [before, after] = velocities;
        let accelerations = outgoing.iter_mut().skip(after.len());
        for (entry, (before, after)) in accelerations.zip(before.iter().zip(after)) {
            let change = field.sub(*after, *before);
            *entry = field.add(*entry, field.mul(size, change));
        }
        Some(())
    }
}

/// True if the law of a surface may leave the gap rate 0.
fn may_hold(model: &Model, surface: usize) -> bool {
    let declared = &model.surfaces[surface];
    let has_constraints = !(model.constraints.is_empty() && declared.instantaneous.is_empty());
    match declared.law {
        // Without constraints this law is elastic.
        Law::NonholonomicPlastic => has_constraints,
        Law::TotallyPlastic => true,
        _ => loses_volumes(model, surface),
    }
}

/// True if the gap rate is 0 after every impact.
fn stops(model: &Model, surface: usize) -> bool {
    let declared = &model.surfaces[surface];
    let constraints = model.constraints.iter().chain(&declared.instantaneous);
    let mut affine = constraints.map(|constraint| constraint.affine);
    let is_linear = affine.all(|rest| model.pool.is_syntactic_zero(rest));
    loses_volumes(model, surface) && (is_linear || !matches!(declared.law, Law::Restitution(_)))
}

/// True if every impact makes the velocity across the surface 0. States are then mapped to fewer dimensions, whichever
/// motion follows.
pub(super) fn loses_volumes(model: &Model, surface: usize) -> bool {
    match model.surfaces[surface].law {
        Law::ImpactPlastic => true,
        Law::Restitution(e) | Law::Newton(e) => model.pool.is_syntactic_zero(e),
        _ => false,
    }
}

#[cfg(test)]
mod tests {
    use dalembert_expr::Reals;

    use super::*;

    #[test]
    fn what_is_held_stays_at_the_surface() {
        let pool = Pool::new();
        let (zero, one) = (pool.zero(), pool.one());
        let mut values = vec![0.0; zero.index().max(one.index()) + 1];
        values[one.index()] = 1.0;
        // The gap y of a point (x, y); its rate is dot(y).
        let contact = Contact {
            rate: zero,
            slopes: vec![zero, zero, zero, one, zero],
            is_stopped: true,
            is_held: true,
        };
        let mut outgoing = [0.5, 0.0, 0.3, -2.0];
        let [rate, along] = contact.rates(Reals, &values, &outgoing);
        assert_eq!([rate, along], [0.0, -2.0]);
        let order = |value: f64| value.partial_cmp(&0.0);
        assert!(contact.is_it([order(rate), order(along)]));
        let velocities = [[0.5, -0.75], [0.5, 0.0]];
        let [before, after] = velocities.each_ref().map(|row| row.as_slice());
        let held = contact.hold(Reals, &mut outgoing, [before, after], (along, -0.75));
        assert!(held.is_some());
        assert_eq!(outgoing, [0.5, 0.0, 0.3, 0.0]);
        let [_, along] = contact.rates(Reals, &values, &outgoing);
        assert_eq!(along, 0.0);
    }
}
