//! Integrators of fixed step on declared systems: their orders, what they preserve, and the work they take.

mod constraints;
mod orders;
mod reversal;
mod work;
