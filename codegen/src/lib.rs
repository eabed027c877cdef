//! Code generator of dalembert: a declared model in, specialised Rust out.
//!
//! ```text
//! TokenStream --spec::parse--> Spec --model::check--> Model --mechanics::derive--> Derivation
//!     --claims::examine--> Examined
//!     --program::lower--> Program --emit::tokens--> TokenStream
//! ```
//!
//! Each stage takes the previous type and returns a new one. The first two can fail, with every mistake of the
//! stage at once, at the user's tokens; so can the claims. The others cannot.

#![forbid(unsafe_code)]

pub mod claims;
pub mod diagnostics;
pub mod emit;
pub mod mechanics;
pub mod model;
pub mod program;
pub mod report;
pub mod spec;

use proc_macro2::TokenStream;

/// The whole pipeline: the body of a `model!` in, Rust items out; on mistakes, compile errors and nothing else.
pub fn expand(input: TokenStream) -> TokenStream {
    match try_expand(input) {
        Ok(items) => items,
        Err(diagnostics) => diagnostics.into_compile_error(),
    }
}

/// The pipeline, with its diagnostics.
///
/// # Errors
/// Every mistake of the first stage that found any.
pub fn try_expand(input: TokenStream) -> Result<TokenStream, diagnostics::Diagnostics> {
    let mut compiled = compile(input)?;
    let findings = compiled.findings.iter().map(claims::Finding::note);
    compiled.model.notes.extend(findings);
    Ok(emit::tokens(
        &compiled.model,
        &compiled.derivation,
        &compiled.programs,
    ))
}

/// A model after all stages but the last.
#[derive(Debug)]
pub struct Compiled {
    /// What was declared.
    pub model: model::Model,
    /// What follows from it.
    pub derivation: mechanics::Derivation,
    /// The verdicts on its claims, in order; all of them accepted.
    pub findings: Vec<claims::Finding>,
    /// What is emitted.
    pub programs: program::Lowered,
}

/// All stages but the last.
///
/// # Errors
/// As [`try_expand`].
pub fn compile(input: TokenStream) -> Result<Compiled, diagnostics::Diagnostics> {
    let spec = spec::parse(input)?;
    let mut model = model::check(&spec)?;
    let derivation = mechanics::derive(&mut model);
    let claims::Examined { findings, volume } = claims::examine(&mut model, &derivation);
    refuse_claims(&spec, &findings)?;
    let programs = program::lower(&model, &derivation, volume.as_ref());
    refuse_oversize(&spec, &programs)?;
    Ok(Compiled {
        model,
        derivation,
        findings,
        programs,
    })
}

/// Refuses claims that are false, and those that stay open without being assumed.
fn refuse_claims(
    spec: &spec::Spec,
    findings: &[claims::Finding],
) -> Result<(), diagnostics::Diagnostics> {
    let mut diagnostics = diagnostics::Diagnostics::new();
    for finding in findings {
        if let Some((text, help)) = finding.refusal() {
            let error = diagnostics.error(spec.location(finding.item), text);
            if !help.is_empty() {
                error.help(help);
            }
        }
    }
    diagnostics.finish(())
}

/// Refuses a model whose code no compiler would finish in reasonable time, rather than handing it over.
fn refuse_oversize(
    spec: &spec::Spec,
    programs: &program::Lowered,
) -> Result<(), diagnostics::Diagnostics> {
    let (longest, limit) = (programs.longest(), program::Program::OPERATIONS);
    let mut diagnostics = diagnostics::Diagnostics::new();
    if longest > limit {
        let text = format!(
            "the equations of `{}` take {longest} operations; the limit is {limit}",
            spec.name.text
        );
        let help = "use fewer coordinates, or coordinates in which the metric has more zeros";
        diagnostics.error(spec.name.at, text).help(help);
    }
    diagnostics.finish(())
}
