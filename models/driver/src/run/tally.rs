//! Numbers of impacts and contacts of a run.

use super::Impact;

/// Numbers of impacts and contacts.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct ImpactTally {
    /// Number of impacts on each surface.
    pub per_surface: Vec<u64>,
    /// Number of grazing impacts: rounding may have decided that they happen.
    pub grazing: u64,
    /// Number of impacts at the same time as another.
    pub simultaneous: u64,
    /// Number of times that a surface began to hold the motion.
    pub contacts: u64,
}

impl ImpactTally {
    /// Counts an impact.
    pub fn count<S>(&mut self, impact: &Impact<S>) {
        if self.per_surface.len() <= impact.surface {
            self.per_surface.resize(impact.surface + 1, 0);
        }
        self.per_surface[impact.surface] += 1;
        self.grazing += u64::from(impact.graze);
        self.simultaneous += u64::from(impact.simultaneous);
    }

    /// The number of impacts on one surface.
    pub fn on(&self, surface: usize) -> u64 {
        self.per_surface.get(surface).copied().unwrap_or(0)
    }

    /// The number of all impacts.
    pub fn total(&self) -> u64 {
        self.per_surface.iter().sum()
    }
}
