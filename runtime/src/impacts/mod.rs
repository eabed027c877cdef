//! Impacts: the effect that finds them and applies their laws.

mod accumulation;
mod balance;
mod bottom;
mod coincident;
mod corner;
mod departure;
mod fall;
mod glance;
mod growth;
mod held;
mod hits;
mod hops;
mod impulse;
mod instantaneous;
mod kinks;
mod passing;
mod place;
mod pushing;
mod quiet;
mod release;
mod repeats;
mod resting;
mod root;
mod search;
mod series;
mod sides;
mod sizes;
mod sliding;
mod strike;
mod tangency;
mod told;
mod touch;
mod watch;
mod wave;

pub use held::Held;
pub use impulse::{IMPACT_BUDGET, Impacts};
