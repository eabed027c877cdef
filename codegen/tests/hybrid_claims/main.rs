//! Claims about impacts, resets and transitions: volumes, the symplectic form, energy and other quantities.
//!
//! | file | subject |
//! |---|---|
//! | `systems.rs` | declarations with a place for a claim |
//! | `volume.rs`, `factor.rs`, `forms.rs`, `symplectic.rs`, `energy.rs`, `quantities.rs` | true claims, false ones and near misses, by kind |
//! | `densities.rs`, `conserved.rs` | densities of the motion; quantities, under impulses and resets too, and symmetries |
//! | `instantaneous.rs` | forms and quantities after instantaneous constraints |
//! | `shipped.rs` | the shipped models |
//! | `brackets.rs`, `involution.rs`, `integrable.rs` | brackets by differences and as they are printed; claims about functions |
//! | `reduction.rs` | reduction by groups: equations are compared with the full motion, connections and jumps with their definitions |
//! | `values.rs` | numbers of a model at a state |
//! | `corollaries.rs` | accumulation of impacts and recurrence, where a volume is kept |
//! | `symmetries.rs` | symmetries of the motion, the surfaces and their maps together, also in first-order systems |
//! | `qualified.rs`, `momenta.rs` | remarks on impacts in proofs of densities, and in proofs of symmetries on their momenta |
//! | `sliding.rs` | volumes where first-order motion slides along a surface, or goes on behind it |
//! | `stops.rs` | surfaces at which the motion ends |
//! | `numbers.rs` | numbers of the sources: returns of a walker, an impact off D, the matrix of a ball |
//! | `differences.rs`, `carried.rs` | factors and forms by differences of motions through an impact |

mod brackets;
mod carried;
mod conserved;
mod corollaries;
mod densities;
mod differences;
mod energy;
mod factor;
mod forms;
mod instantaneous;
mod integrable;
mod involution;
mod momenta;
mod numbers;
mod qualified;
mod quantities;
mod reduction;
mod shipped;
mod sliding;
mod stops;
mod symmetries;
mod symplectic;
mod systems;
mod values;
mod volume;

use dalembert_codegen::claims::{Finding, Verdict, examine, examine_mode};
use dalembert_codegen::mechanics::Derivation;
use dalembert_codegen::{mechanics, model, read, spec};

/// Expected verdict on a claim.
#[derive(Debug, Clone, Copy)]
enum Expected {
    /// Proved.
    True,
    /// Refuted at a state, with this in the message.
    False(&'static str),
    /// Refuted by a reason that needs no state, with this in it.
    Barred(&'static str),
    /// Refuted at a state, with this number as the value of this name.
    Shown(&'static str, f64),
    /// Open, with this in the reason.
    Open(&'static str),
}

/// The findings on all claims of a declaration, mode by mode.
///
/// # Panics
/// If it is refused before its claims are examined.
fn findings(source: &str) -> Vec<Finding> {
    let refused = |errors: &dalembert_codegen::diagnostics::Diagnostics| -> ! {
        let texts: Vec<&str> = errors.iter().map(|error| error.message()).collect();
        panic!("{texts:?}\n{source}");
    };
    match read(source.parse().expect("tokens")) {
        Err(errors) => refused(&errors),
        Ok(spec::Declaration::Model(spec)) => {
            let mut model = model::check(&spec).unwrap_or_else(|errors| refused(&errors));
            let derivation = mechanics::derive(&mut model);
            examine(&mut model, &derivation).findings
        }
        Ok(spec::Declaration::Modes(modes)) => {
            let graph = model::check_modes(&modes).unwrap_or_else(|errors| refused(&errors));
            let all: Vec<&model::Model> = graph.modes.iter().map(|mode| &mode.model).collect();
            let each = graph.modes.iter().flat_map(|mode| {
                let mut model = mode.model.clone();
                let derivation = mechanics::derive(&mut model);
                examine_mode(&mut model, &derivation, &all).findings
            });
            each.collect()
        }
    }
}

/// Checks the verdict on a claim at the place `CLAIM` of a declaration, in every mode that has it.
#[track_caller]
fn check(declaration: &str, claim: &str, expected: Expected) {
    let source = declaration.replace("CLAIM", &format!("claims {{ {claim}; }}"));
    // A density that is stated for the sake of another claim is not checked.
    let is_density = |claim: &str| claim.starts_with("density = ") && !claim.contains(';');
    let mut found = findings(&source);
    found.retain(|finding| is_density(claim) || !is_density(&finding.claim));
    assert!(!found.is_empty(), "{source}");
    for finding in found {
        let matches = match (&finding.verdict, expected) {
            (Verdict::Proved(_), Expected::True) => true,
            (Verdict::Refuted(witness), Expected::False(text)) => {
                witness.sample.is_some() && witness.to_string().contains(text)
            }
            (Verdict::Refuted(witness), Expected::Barred(text)) => {
                witness.sample.is_none() && witness.to_string().contains(text)
            }
            (Verdict::Refuted(witness), Expected::Shown(name, value)) => {
                let mut values = witness.values.iter();
                let is_it = |(known, shown): &(String, f64)| {
                    known == name && (shown - value).abs() <= 1e-12 * value.abs()
                };
                witness.sample.is_some() && values.any(is_it)
            }
            (Verdict::Undecided(reason), Expected::Open(text)) => reason.contains(text),
            _ => false,
        };
        assert!(
            matches,
            "{claim}: expected {expected:?}, found {}",
            finding.note()
        );
    }
}

/// A model without modes, with its equations.
///
/// # Panics
/// If it is refused.
fn derived(source: &str) -> (model::Model, Derivation) {
    let spec::Declaration::Model(spec) = read(source.parse().expect("tokens")).expect("syntax")
    else {
        panic!("a model with modes");
    };
    let mut model = model::check(&spec).expect("a model");
    let derivation = mechanics::derive(&mut model);
    (model, derivation)
}
