//! Initial states: positions and velocities are given, then completed and checked.

use dalembert::StateError;

use crate::model::{AnyModel, OffConstraint, Origin, Rates, Start};
use crate::names::{self, Unknown};

/// A coordinate or a velocity, by the index of the coordinate.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Component {
    /// A coordinate.
    Position(usize),
    /// A velocity.
    Velocity(usize),
}

impl Component {
    /// The coordinate or velocity with this name, such as `x` or `x_dot`, in the present mode of a model. Velocities of
    /// first-order systems are not found, because they are not free.
    ///
    /// # Errors
    /// [`Unknown`] if no coordinate or velocity of the mode has this name.
    pub fn find(model: &dyn AnyModel, name: &str) -> Result<Self, Unknown> {
        let (present, found): (Vec<String>, Vec<Self>) = Self::present(model).into_iter().unzip();
        let index = names::find(
            "coordinate or velocity",
            name,
            present.iter().map(String::as_str),
        );
        let index = index.map_err(|unknown| Unknown {
            mode: model.present_mode(),
            ..unknown
        })?;
        Ok(found[index])
    }

    /// The free coordinates and velocities of the present mode of a model, with their names.
    fn present(model: &dyn AnyModel) -> Vec<(String, Self)> {
        let description = model.description();
        let alone = model.mode_alone();
        let of_mode = alone
            .as_ref()
            .map_or(description, |mode| mode.description());
        let is_present =
            |(_, name): &(usize, &str)| names::coordinates(of_mode).any(|other| other == *name);
        let coordinates = names::coordinates(description).enumerate();
        let coordinates: Vec<(usize, &str)> = coordinates.filter(is_present).collect();
        let moving = match description.is_first_order {
            true => &[],
            false => coordinates.as_slice(),
        };
        let positions = coordinates.iter();
        let positions = positions.map(|(index, name)| (name.to_string(), Self::Position(*index)));
        let velocities = moving.iter();
        let velocities =
            velocities.map(|(index, name)| (names::velocity(name), Self::Velocity(*index)));
        positions.chain(velocities).collect()
    }
}

/// A state before its checks; single components can still be changed.
#[derive(Debug, Clone)]
pub enum Beginning {
    /// The model's `initial` with changes; the constraints determine the components that are not named.
    Named(Start),
    /// All components are given.
    Given {
        /// Positions.
        q: Vec<f64>,
        /// Velocities or momenta.
        rates: Rates,
    },
}

impl Beginning {
    /// Sets a coordinate or a velocity.
    pub fn set(&mut self, component: Component, value: f64) {
        match component {
            Component::Position(index) => self.set_position(index, value),
            Component::Velocity(index) => self.set_velocity(index, value),
        }
    }

    /// Sets a coordinate.
    pub fn set_position(&mut self, index: usize, value: f64) {
        match self {
            Self::Named(start) => {
                start.q[index] = value;
                start.placed[index] = true;
            }
            Self::Given { q, .. } => q[index] = value,
        }
    }

    /// Sets a velocity. No effect if momenta are given.
    pub fn set_velocity(&mut self, index: usize, value: f64) {
        match self {
            Self::Named(start) => {
                start.qdot[index] = value;
                start.named[index] = true;
            }
            Self::Given {
                rates: Rates::Velocities(qdot),
                ..
            } => qdot[index] = value,
            Self::Given { .. } => {}
        }
    }

    /// True if momenta are given.
    pub fn has_momenta(&self) -> bool {
        matches!(
            self,
            Self::Given {
                rates: Rates::Momenta(_),
                ..
            }
        )
    }

    /// Completes and checks the state. `policy` decides on a state that violates the constraints.
    ///
    /// # Errors
    /// [`StateError`] if the system refuses the state.
    pub fn settle(
        &self,
        model: &dyn AnyModel,
        policy: OffConstraint,
    ) -> Result<Origin, StateError> {
        let (q, rates, policy) = match self {
            Self::Given { q, rates } => (q.clone(), rates.clone(), policy),
            Self::Named(start) => {
                let q = Self::placed(model, start, policy)?;
                let completed = model.complete_velocity(&q, &start.qdot, &start.named);
                let (qdot, policy) = match completed {
                    // Completed velocities satisfy the constraints. The conversion through the momenta leaves a
                    // residual of rounding errors, which is kept: it may be larger than the terms of a constraint.
                    Ok(qdot) => (qdot, OffConstraint::Keep),
                    Err(error) if policy == OffConstraint::Error => return Err(error),
                    // The named velocities contradict the constraints; the policy decides.
                    Err(_) => (start.qdot.clone(), policy),
                };
                (q, Rates::Velocities(qdot), policy)
            }
        };
        let origin = Origin { q, rates, policy };
        model.state(0.0, &origin).map(|_| origin)
    }

    /// The positions of a start. Those that are not given are solved from the constraints. If given positions violate
    /// the constraints, `Keep` leaves them and `Project` solves for all positions.
    fn placed(
        model: &dyn AnyModel,
        start: &Start,
        policy: OffConstraint,
    ) -> Result<Vec<f64>, StateError> {
        match (model.complete_position(&start.q, &start.placed), policy) {
            (Err(StateError::OffPosition { .. }), OffConstraint::Keep) => Ok(start.q.clone()),
            (Err(StateError::OffPosition { .. }), OffConstraint::Project) => {
                model.complete_position(&start.q, &vec![false; start.q.len()])
            }
            (placed, _) => placed,
        }
    }
}
