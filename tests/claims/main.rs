//! Verdicts on claims, compared with values and computations that share no code with the generator's decision.
//!
//! | file | subject |
//! |---|---|
//! | `golden_verdicts.rs`, `reference.rs` | verdicts, frames, obstructions, densities of the reference files |
//! | `gauge.rs` | symmetries of the equations that change the Lagrangian |
//! | `systems.rs`, `drift.rs`, `topology.rs`, `conditions.rs`, `momentum.rs` | existence of a density on many systems |
//! | `invariance.rs`, `atoms.rs` | independence of verdicts from the notation; functions and their relations |
//! | `visible.rs`, `contradicted.rs`, `impacts.rs` | true and false claims of models; impacts |
//! | `positions.rs` | models with position equations |
//! | `soundness.rs`, `soundness_models.rs`, `proved_means_proved.rs`, `abrupt.rs` | nothing is proved by accident |
//! | `volumes.rs`, `emitted_volumes.rs`, `singular_volumes.rs` | densities that are found, emitted, kept by motions |

mod abrupt;
mod atoms;
mod conditions;
mod contradicted;
mod drift;
mod emitted_volumes;
mod gauge;
mod golden_verdicts;
mod impacts;
mod invariance;
mod momentum;
mod positions;
mod proved_means_proved;
mod reference;
mod singular_volumes;
mod soundness;
mod soundness_models;
mod systems;
mod topology;
mod visible;
mod volumes;
