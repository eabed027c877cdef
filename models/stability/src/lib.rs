//! Hard cases for the runtime and for generated code: event location, accumulation, impact laws and corners, nearly
//! dependent constraints, scaling, long runs, bad input.
//!
//! The binary of this package is the `dalembert` command with these cases as the subcommand `stability`.
//!
//! The models of cases are texts that are loaded on first use ([`text`]), except for one that runs in extended precision
//! and for systems written by hand ([`by_hand`], [`particle`]).
//!
//! To add a case, copy a [`Case`] and its function in the file of its section. Case numbers are never reused. The
//! correct result is a closed form, an exact count, a class of outcome, or a number that can be computed again with
//! more digits. `u` is half a unit in the last place of 1. **P-LOC** is the bound of [`course::location`] for the time
//! of an impact, from the rounding errors of the gap and its rate. **P-STATE(k)** is a relative error of `k u`.
//!
//! A case that cannot pass yet gives the reason in [`Case::pending`]. It has a function anyway if its declaration can
//! be written. Once it passes, the suite reports the reason as outdated.

mod accumulation;
mod arithmetic;
pub mod by_hand;
mod conditioning;
mod constrained;
mod corners;
pub mod course;
mod crossing;
mod drift;
mod energy;
mod ensembles;
mod horizon;
mod input;
mod laws;
mod location;
mod long;
pub mod particle;
mod scaling;
mod structure;
mod switches;
pub mod tables;
pub mod text;
mod variations;
pub mod varied;
mod zeno;

use dalembert_cli::suite::Case;

/// Every case, in order of sections.
pub fn all() -> Vec<Case> {
    let sections = [
        location::CASES,
        crossing::CASES,
        zeno::CASES,
        accumulation::CASES,
        laws::CASES,
        switches::CASES,
        corners::CASES,
        constrained::CASES,
        drift::CASES,
        conditioning::CASES,
        scaling::CASES,
        arithmetic::CASES,
        long::CASES,
        horizon::CASES,
        energy::CASES,
        structure::CASES,
        variations::CASES,
        ensembles::CASES,
        input::CASES,
    ];
    let mut cases = sections.concat();
    cases.sort_by_key(|case| case.id);
    cases
}

/// The catalogue of the command: every shipped model, the figures of the papers, and the cases.
pub fn catalogue() -> dalembert_cli::Catalogue {
    dalembert_command::catalogue().with_suite(all())
}
