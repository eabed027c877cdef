//! Integrators of fixed step on declared systems: their orders, what they preserve, and the work they take.

mod constraints;
mod long_runs;
mod orders;
mod reversal;
mod work;
