//! Impacts: the laws, and the effect that carries them out.

mod accumulation;
mod glance;
mod hits;
mod impulse;
pub mod law;
mod override_table;
mod reset;
mod series;
mod watch;

pub use impulse::{IMPACT_BUDGET, Impacts};
