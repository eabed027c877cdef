//! Impacts: the laws, and the effect that carries them out.

mod accumulation;
mod corner;
mod fall;
mod glance;
mod growth;
mod held;
mod hits;
mod impulse;
mod instantaneous;
pub mod law;
pub(crate) mod override_table;
mod place;
pub mod policy;
mod release;
mod reset;
mod resting;
mod root;
mod search;
mod series;
mod sliding;
mod tangency;
mod touch;
mod watch;

pub use held::Held;
pub use impulse::{IMPACT_BUDGET, Impacts};
pub(crate) use reset::after_reset;
