//! Impacts: the laws, and the effect that carries them out.

pub mod law;
