//! Random declarations: generated code agrees with independent computations, integrators agree, and broken declarations
//! are refused.
//!
//! The quick tests draw from a fixed seed. `PROPTEST_CASES` sets the number of cases, `PROPTEST_RNG_SEED` the seed.
//! After a failure the declaration is shrunk and printed.

mod blows;
mod broken;
mod declaration;
mod dense;
mod emitted;
mod function;
mod interpreted;
mod models;
mod resting;

use proptest::test_runner::{Config, RngSeed};

/// Configuration with this number of cases, unless the environment sets another.
fn config(cases: u32) -> Config {
    let environment = Config::default();
    let asked = std::env::var_os("PROPTEST_CASES").is_some();
    let seeded = matches!(environment.rng_seed, RngSeed::Fixed(_));
    Config {
        cases: if asked { environment.cases } else { cases },
        rng_seed: if seeded {
            environment.rng_seed
        } else {
            RngSeed::Fixed(1743)
        },
        failure_persistence: None,
        max_shrink_iters: 4000,
        ..environment
    }
}
