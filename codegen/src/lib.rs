//! Generator of dalembert: compiles a declared model to straight-line programs. `dalembert-emit` writes them as Rust,
//! `dalembert-jit` runs them.
//!
//! ```text
//! TokenStream --spec::parse--> Spec --model::check--> Model --mechanics::derive--> Derivation
//!     --claims::examine--> Examined
//!     --program::lower--> Program
//! ```
//!
//! Each stage takes the previous type and returns a new one. The first two and the claims can fail. They report all
//! mistakes of the stage at once, located at the user's tokens. Between the other stages, a model is refused if its
//! algebra or its code is too large, or if a reset leaves the constraints.

#![forbid(unsafe_code)]

pub mod claims;
pub mod diagnostics;
pub mod export;
pub mod mechanics;
pub mod model;
pub mod program;
pub mod report;
pub mod spec;
pub mod tables;

use proc_macro2::{Delimiter, TokenStream, TokenTree};

/// The tokens of each model of a text. A model ends with its block in braces. Tokens behind the last block form one
/// more model.
pub fn models_of(tokens: TokenStream) -> Vec<TokenStream> {
    let mut models: Vec<Vec<TokenTree>> = Vec::new();
    let mut open = Vec::new();
    for token in tokens {
        let ends =
            matches!(&token, TokenTree::Group(group) if group.delimiter() == Delimiter::Brace);
        open.push(token);
        if ends {
            models.push(core::mem::take(&mut open));
        }
    }
    if !open.is_empty() {
        models.push(open);
    }
    models.into_iter().map(TokenStream::from_iter).collect()
}

/// The first stage: a declaration as it was written, with its families of modes written out.
///
/// # Errors
/// Every mistake of syntax.
pub fn read(input: TokenStream) -> Result<spec::Declaration, diagnostics::Diagnostics> {
    spec::read(input, model::INDICES)
}

/// A model with modes after all stages.
#[derive(Debug)]
pub struct CompiledModes {
    /// Checked declaration.
    pub graph: model::ModeGraph,
    /// Each mode as a model of its own, in order.
    pub modes: Vec<Compiled>,
}

/// All stages of a model with modes.
///
/// # Errors
/// Same as [`compile`].
pub fn compile_modes(declared: &spec::Modes) -> Result<CompiledModes, diagnostics::Diagnostics> {
    let graph = model::check_modes(declared)?;
    let mut mistakes = diagnostics::Diagnostics::new();
    let mut modes = Vec::new();
    let all: Vec<&model::Model> = graph.modes.iter().map(|mode| &mode.model).collect();
    for (written, mode) in declared.modes.iter().zip(&graph.modes) {
        let examine = |model: &mut model::Model, derivation: &mechanics::Derivation| {
            claims::examine_mode(model, derivation, &all)
        };
        match compile_checked(&written.spec, mode.model.clone(), examine) {
            Ok(compiled) => modes.push(compiled),
            Err(others) => mistakes.extend_once(others),
        }
    }
    mistakes.finish(CompiledModes { graph, modes })
}

/// A model after all stages.
#[derive(Debug)]
pub struct Compiled {
    /// Checked declaration.
    pub model: model::Model,
    /// Derived equations.
    pub derivation: mechanics::Derivation,
    /// The verdicts on its claims, in order; all of them accepted.
    pub findings: Vec<claims::Finding>,
    /// Lowered program.
    pub programs: program::Lowered,
    /// Its scenes, in order; each is a model of its own, without scenes.
    pub scenes: Vec<Compiled>,
}

impl Compiled {
    /// Adds the findings to the notes of the model.
    pub fn note_findings(&mut self) {
        let findings = self.findings.iter().map(claims::Finding::note);
        self.model.notes.extend(findings);
    }
}

/// All stages of a model without modes.
///
/// # Errors
/// Every mistake of the first stage that found any.
pub fn compile(input: TokenStream) -> Result<Compiled, diagnostics::Diagnostics> {
    compile_spec(&spec::parse(input)?, spec::STEPS)
}

/// All stages of a parsed model, with a budget of steps for the algebra.
///
/// # Errors
/// Same as [`compile`].
pub fn compile_spec(spec: &spec::Spec, steps: u64) -> Result<Compiled, diagnostics::Diagnostics> {
    let model = model::check_within(spec, steps)?;
    let scenes: Vec<model::Model> = (0..model.scenes.len())
        .map(|scene| model.in_scene(scene))
        .collect();
    let mut compiled = compile_checked(spec, model, claims::examine)?;
    let mut mistakes = diagnostics::Diagnostics::new();
    for scene in scenes {
        match compile_checked(spec, scene, claims::examine_scene) {
            Ok(scene) => compiled.scenes.push(scene),
            Err(others) => mistakes.extend(others),
        }
    }
    refuse_needless_global(spec, &compiled, &mut mistakes);
    mistakes.finish(compiled)
}

/// Refuses `#[global]` where neither the model nor a scene has another form.
fn refuse_needless_global(
    spec: &spec::Spec,
    compiled: &Compiled,
    mistakes: &mut diagnostics::Diagnostics,
) {
    let mut all = core::iter::once(compiled).chain(&compiled.scenes);
    let is_needed = all.any(|compiled| compiled.programs.global.is_some());
    if let Some(at) = spec.global.filter(|_| !is_needed) {
        let text = format!(
            "`{}` has no reduced form: it is in its global form already",
            spec.name.text
        );
        mistakes.error(at, text).help("leave out `#[global]`");
    }
}

/// The extremals of a model with a cost, in one of its scenes, as a first-order model after all stages: see
/// [`mechanics::control`]. The scene `None` is the model itself.
///
/// # Errors
/// Same as [`compile`], an unknown scene, and the first declaration for which no maximum principle is derived.
pub fn compile_control(
    spec: &spec::Spec,
    scene: Option<&str>,
) -> Result<Compiled, diagnostics::Diagnostics> {
    let (model, extremals) = derive_control(spec, scene)?;
    let model = mechanics::control::extremal_model(model, &extremals);
    compile_checked(spec, model, claims::examine)
}

/// A model with a cost whose inputs are held, in one of its scenes, as a first-order model after all stages: see
/// [`mechanics::control::Held`].
#[derive(Debug)]
pub struct CompiledHeld {
    /// The first-order model.
    pub compiled: Compiled,
    /// Number of inputs.
    pub inputs: usize,
    /// True if motion, impacts and running cost do not depend on time. The terminal cost may.
    pub is_autonomous: bool,
}

/// All stages of a model whose inputs are held. The scene `None` is the model itself.
///
/// # Errors
/// Same as [`compile_control`].
pub fn compile_held(
    spec: &spec::Spec,
    scene: Option<&str>,
) -> Result<CompiledHeld, diagnostics::Diagnostics> {
    let held = mechanics::control::held_model(in_scene(spec, scene)?);
    let held = held.map_err(|refused| uncontrolled(spec, refused))?;
    refuse_exhausted(spec, &held.model)?;
    Ok(CompiledHeld {
        compiled: compile_checked(spec, held.model, claims::examine)?,
        inputs: held.inputs,
        is_autonomous: held.is_autonomous,
    })
}

/// A model in one of its scenes, with its maximum principle.
fn derive_control(
    spec: &spec::Spec,
    scene: Option<&str>,
) -> Result<(model::Model, mechanics::control::Extremals), diagnostics::Diagnostics> {
    let mut model = in_scene(spec, scene)?;
    let derived = mechanics::control::derive_extremals(&mut model);
    refuse_exhausted(spec, &model)?;
    derived
        .map(|extremals| (model, extremals))
        .map_err(|refused| uncontrolled(spec, refused))
}

/// The checked model, in a scene if one is named.
fn in_scene(
    spec: &spec::Spec,
    scene: Option<&str>,
) -> Result<model::Model, diagnostics::Diagnostics> {
    let model = model::check_within(spec, spec::STEPS)?;
    let Some(scene) = scene else {
        return Ok(model);
    };
    let mut names = model.scenes.iter().map(|it| it.name.as_str());
    if let Some(place) = names.clone().position(|name| name == scene) {
        return Ok(model.in_scene(place));
    }
    let mut mistakes = diagnostics::Diagnostics::new();
    let help = match names.next() {
        None => "the model declares no scenes".to_owned(),
        Some(first) => format!(
            "scenes are {}",
            diagnostics::listed([first].into_iter().chain(names))
        ),
    };
    let text = format!("unknown scene `{scene}`");
    mistakes.error(spec.name.at, text).help(help);
    Err(mistakes)
}

fn uncontrolled(
    spec: &spec::Spec,
    refused: mechanics::control::Uncontrolled,
) -> diagnostics::Diagnostics {
    let mut mistakes = diagnostics::Diagnostics::new();
    let at = refused
        .item
        .map_or(spec.name.at, |item| spec.location(item));
    mistakes.error(at, refused.text).help(refused.help);
    mistakes
}

/// The stages after the first two, of a model or of one of its scenes.
fn compile_checked(
    spec: &spec::Spec,
    mut model: model::Model,
    examine: impl FnOnce(&mut model::Model, &mechanics::Derivation) -> claims::Examined,
) -> Result<Compiled, diagnostics::Diagnostics> {
    let derivation = mechanics::derive(&mut model);
    refuse_exhausted(spec, &model)?;
    refuse_landings(spec, &mut model, &derivation)?;
    let claims::Examined { findings, volume } = examine(&mut model, &derivation);
    refuse_exhausted(spec, &model)?;
    refuse_claims(spec, &findings)?;
    let programs = program::lower(&model, &derivation, volume.as_ref());
    refuse_oversize(spec, &programs)?;
    refuse_numbers(spec, &programs)?;
    // An accepted model is printed without a budget.
    model.pool.lift_budget();
    Ok(Compiled {
        model,
        derivation,
        findings,
        programs,
        scenes: Vec::new(),
    })
}

/// Refuses a model whose algebra was given up: the derived equations are then wrong.
fn refuse_exhausted(
    spec: &spec::Spec,
    model: &model::Model,
) -> Result<(), diagnostics::Diagnostics> {
    match model.pool.is_exhausted() {
        true => Err(diagnostics::too_many_steps(spec.name.at)),
        false => Ok(()),
    }
}

/// Refuses equations with numbers that doubles do not have.
fn refuse_numbers(
    spec: &spec::Spec,
    programs: &program::Lowered,
) -> Result<(), diagnostics::Diagnostics> {
    let mut diagnostics = diagnostics::Diagnostics::new();
    let all = [&programs.main, programs.global()];
    let mut functions = all.into_iter().flat_map(program::Program::functions);
    let is_beyond = |op: &program::Op| match op {
        program::Op::Number(number) => !spec::is_a_double(number),
        _ => false,
    };
    if functions.any(|function| function.ops.iter().any(is_beyond)) {
        let name = &spec.name.text;
        let text = format!("the equations of `{name}` have a number out of the range of doubles");
        let help = "choose units in which the numbers of the model are moderate";
        diagnostics.error(spec.name.at, text).help(help);
    }
    diagnostics.finish(())
}

/// Refuses resets after which the state is off the constraints.
fn refuse_landings(
    spec: &spec::Spec,
    model: &mut model::Model,
    derivation: &mechanics::Derivation,
) -> Result<(), diagnostics::Diagnostics> {
    let mistakes = claims::check_landings(model, derivation);
    refuse_exhausted(spec, model)?;
    let mut diagnostics = diagnostics::Diagnostics::new();
    for (item, text, help) in mistakes {
        diagnostics.error(spec.location(item), text).help(help);
    }
    diagnostics.finish(())
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
            error.refuted_by(finding.counterexample());
        }
    }
    diagnostics.finish(())
}

/// Refuses a model whose code no compiler would finish in reasonable time.
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
