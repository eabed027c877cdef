//! What the tests share: reference values, the command line inside the process, systems that only tests declare,
//! an allocation counter.

pub mod allocation;
pub mod command;
pub mod reference;
pub mod sampling;
pub mod systems;
