//! Items that the tests share, such as reference values, the command line inside the process, systems that only tests
//! declare, independent computations by finite differences, and an allocation counter.

/// Makes every Rust block of the language reference a doctest.
#[doc = include_str!("../../docs/language.md")]
#[cfg(doctest)]
struct LanguageReference;

pub mod allocation;
pub mod certified;
pub mod claim;
pub mod command;
pub mod curvature;
pub mod differences;
pub mod divergence;
pub mod flight;
pub mod flow;
pub mod formula;
pub mod golden;
pub mod interpreted;
pub mod line;
pub mod linear;
pub mod numeric;
pub mod obstruction;
pub mod parallel;
pub mod reference;
pub mod sampling;
pub mod symbolic;
pub mod systems;
pub mod verdict;
pub mod verified;
pub mod visible_models;
pub mod volume;
pub mod witness;

/// The Rust examples of the guide.
#[cfg(doctest)]
#[doc = include_str!("../../docs/guide/derivatives.md")]
#[doc = include_str!("../../docs/guide/embedded.md")]
struct Guide;

/// The examples of the README, compiled and run.
#[cfg(doctest)]
#[doc = include_str!("../../README.md")]
struct Readme;
