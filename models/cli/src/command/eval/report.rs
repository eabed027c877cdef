//! Collects the quantities that a model reports at a state.

use std::collections::BTreeMap;

use dalembert::Fault;
use dalembert::describe::Report;
use dalembert_driver::{AnyModel, Contacted, OffConstraint, Origin, Rates};
use serde_json::{Map, Value};

use crate::json;

/// All reported quantities of one state. Quantities whose names begin with `impacts.` belong to the contact with a
/// surface.
#[derive(Default)]
pub struct Collected {
    values: Map<String, Value>,
    contact_scalars: BTreeMap<String, f64>,
    contact_vectors: BTreeMap<String, Vec<f64>>,
}

impl Collected {
    /// Collects the quantities at this state.
    ///
    /// # Errors
    /// [`Fault`] if the equations of motion do not exist there.
    pub fn at(model: &dyn AnyModel, t: f64, state: &[f64]) -> Result<Self, Fault> {
        let mut collected = Self::default();
        model.inspect(t, state, &mut collected)?;
        Ok(collected)
    }

    /// Removes a value and returns it; `null` if the model has none with this name.
    pub fn take(&mut self, name: &str) -> Value {
        self.values.shift_remove(name).unwrap_or_default()
    }

    /// Removes all remaining values and returns them, in the order of the model's report.
    pub fn take_others(&mut self) -> Map<String, Value> {
        std::mem::take(&mut self.values)
    }

    /// A scalar of the contact with a surface.
    pub fn contact_scalar(&self, surface: &str, name: &str) -> Option<f64> {
        self.contact_scalars
            .get(&format!("impacts.{surface}.{name}"))
            .copied()
    }

    /// The impulse on the momenta that enforces the instantaneous constraints of a surface, if it declares some.
    pub fn focus(&self, surface: &str) -> Option<&[f64]> {
        let found = self
            .contact_vectors
            .get(&format!("impacts.{surface}.focus"));
        found.map(Vec::as_slice)
    }

    /// Positions and velocities after the reset of a surface, if it declares one.
    pub fn reset(&self, surface: &str) -> Option<Origin> {
        let vector = |name| {
            let found = self
                .contact_vectors
                .get(&format!("impacts.{surface}.{name}"));
            found.cloned()
        };
        Some(Origin {
            q: vector("reset_q")?,
            rates: Rates::Velocities(vector("reset_qdot")?),
            policy: OffConstraint::Keep,
        })
    }

    /// The contact of a surface, if an impulse can change its gap rate.
    pub fn contact(&self, surface: &str) -> Option<Contacted> {
        let scalar = |name| self.contact_scalar(surface, name);
        let vector = |name| {
            let found = self
                .contact_vectors
                .get(&format!("impacts.{surface}.{name}"));
            found.cloned()
        };
        let contact = Contacted {
            gap_rate: scalar("gap_rate")?,
            constrained_rate: scalar("constrained_rate")?,
            surface_rate: scalar("surface_rate")?,
            constrained_compliance: scalar("constrained_compliance")?,
            free_compliance: scalar("free_compliance")?,
            direction: vector("direction")?,
        };
        (contact.constrained_compliance > 0.0 && contact.constrained_compliance.is_finite())
            .then_some(contact)
    }
}

impl Report for Collected {
    fn scalar(&mut self, name: &str, value: f64) {
        if name.starts_with("impacts.") {
            self.contact_scalars.insert(name.to_owned(), value);
        } else {
            self.values.insert(name.to_owned(), json::number(value));
        }
    }

    fn vector(&mut self, name: &str, values: &[f64]) {
        if name.starts_with("impacts.") {
            self.contact_vectors
                .insert(name.to_owned(), values.to_vec());
        } else {
            self.values.insert(name.to_owned(), json::vector(values));
        }
    }

    fn matrix(&mut self, name: &str, _rows: usize, columns: usize, values: &[f64]) {
        self.values
            .insert(name.to_owned(), json::matrix(columns, values));
    }
}
