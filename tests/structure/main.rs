//! Integrators on declared systems: their orders, their invariants, and their work.

mod constraints;
mod orders;
mod reversal;
mod work;
