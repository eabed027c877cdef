//! Random states with a fixed seed.

use std::sync::OnceLock;

use dalembert::{Instance, StateVector, System};
use dalembert_stability::course;
use dalembert_stability::text::{Large, Text, shipped};

use crate::systems;

/// [`course::Random`], extended by numbers and vectors within bounds. The same seed gives the same numbers everywhere.
#[derive(Debug, Clone)]
pub struct Random(course::Random);

impl Random {
    /// A generator with this seed.
    pub const fn new(seed: u64) -> Self {
        Self(course::Random::new(seed))
    }

    /// A number in `[low, high)`.
    pub fn within(&mut self, low: f64, high: f64) -> f64 {
        self.0.between(low, high)
    }

    /// A vector with components in `[low, high)`.
    pub fn vector<V: StateVector>(&mut self, low: f64, high: f64) -> V {
        self.like(&V::zeros(V::CAPACITY), low, high)
    }

    /// A vector as long as another, with components in `[low, high)`.
    pub fn like<V: StateVector>(&mut self, other: &V, low: f64, high: f64) -> V {
        let mut vector = other.zeroed();
        vector
            .as_mut_slice()
            .iter_mut()
            .for_each(|component| *component = self.within(low, high));
        vector
    }
}

/// Random states of a system inside its chart, projected on the constraints.
///
/// # Panics
/// If a state cannot be made.
pub fn states<S: System>(system: &S, count: usize, seed: u64) -> Vec<S::State> {
    let mut random = Random::new(seed);
    (0..count)
        .map(|_| {
            // These ranges lie inside every chart: intervals are (0, pi).
            let zero = system.zero_vector();
            let (q, qdot) = (random.like(&zero, 0.1, 1.4), random.like(&zero, -1.0, 1.0));
            system.state_projected(0.0, &q, &qdot).expect("a state")
        })
        .collect()
}

/// Every shipped second-order model without modes and every system of [`systems`], loaded from their texts, with
/// default parameters.
pub fn every_system() -> &'static [Large] {
    static ALL: OnceLock<Vec<Large>> = OnceLock::new();
    ALL.get_or_init(|| {
        let shipped = dalembert_command::TEXTS
            .iter()
            .map(|(name, _)| shipped(name));
        let texts = shipped.chain(systems::texts());
        let has_mechanics = |text: &&Text| {
            let description = text.description();
            !description.is_first_order && description.modes.is_empty()
        };
        texts.filter(has_mechanics).map(Text::sized).collect()
    })
}

/// The system of [`every_system`] with this name.
///
/// # Panics
/// If there is no system of this name.
pub fn system(name: &str) -> Large {
    let mut systems = every_system().iter();
    let system = systems.find(|system| system.description().name == name);
    *system.unwrap_or_else(|| panic!("no system `{name}`"))
}

/// The number in an environment variable, for nightly tests; `default` if there is none.
pub fn asked(name: &str, default: u64) -> u64 {
    let value = std::env::var(name).ok();
    value.and_then(|text| text.parse().ok()).unwrap_or(default)
}
