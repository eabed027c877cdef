//! Interpreted impulses of the declared laws of random surfaces.

use dalembert_codegen::model::Law;
use dalembert_codegen::program::Program;
use proptest::prelude::*;

use super::interpreted::{Comparison, same_within};

/// Compares the impulse of each declared law with the impulse that the contact gives for this law.
pub fn check_blows(comparison: &Comparison<'_>, program: &Program) -> Result<(), TestCaseError> {
    if let Some(functions) = &program.impacting {
        for (s, blow) in functions.blows.iter().enumerate() {
            let Some(blow) = blow else { continue };
            let coefficient = functions.coefficients[s].as_ref();
            let coefficient = coefficient.map_or(0.0, |function| comparison.run(function)[0]);
            let contact = comparison.run(&functions.contacts[s]);
            let [gap_rate, momentum, surface_rate, constrained, free] = contact[..5] else {
                continue;
            };
            let elastic = momentum + surface_rate;
            let taken = match comparison.compiled.model.surfaces[s].law {
                Law::Elastic => 2.0 * elastic,
                Law::Restitution(_) => (1.0 + coefficient) * elastic,
                Law::Newton(_) => (1.0 + coefficient) * gap_rate,
                Law::NonholonomicPlastic => 2.0 * constrained / free * gap_rate,
                Law::ImpactPlastic => gap_rate,
                Law::TotallyPlastic => constrained / free * gap_rate,
                Law::Reset | Law::Stop | Law::Transition => f64::NAN,
            };
            let scaled = |size: f64, direction: &[f64]| -> Vec<f64> {
                direction.iter().map(|component| size * component).collect()
            };
            let expected = scaled(-taken / constrained, &contact[5..]);
            let blow = comparison.run(blow);
            let tolerance = comparison.tolerance.max(1e-9);
            same_within("blow", &scaled(blow[0], &blow[2..]), &expected, tolerance)?;
            same_within("share", &[blow[1] * gap_rate], &[taken], tolerance)?;
        }
    }
    Ok(())
}
