//! Export of the functions of a model to other languages and programs, as a list of lines that each target writes in
//! its own syntax.
//!
//! | file | job |
//! |---|---|
//! | `mod.rs` | the exported data: models and modes with their functions |
//! | `lines.rs` | a function as a list of lines |
//! | `c.rs` | a C header of all functions |
//!
//! The state is that of a run: positions followed by momenta or quasi-velocities, or positions alone for a first-order
//! system.

mod c;
mod lines;

pub use c::header;
pub use lines::{Fault, Line, Lines, Operand};

use dalembert_numbers::Kernel;

use crate::model::Model;
use crate::program::{Form, Function};
use crate::report::{ReportError, declaration};
use crate::spec::{self, Declaration};
use crate::tables::{FormOf, default_value, text_of};
use crate::{compile_modes, compile_spec};

/// A model, one of its scenes, or one of its modes.
#[derive(Debug, Clone, PartialEq)]
pub struct Part {
    /// Name of the model in snake case, followed by that of the mode or scene.
    pub name: String,
    /// Text of the doc comment.
    pub documentation: String,
    /// Names of the coordinates.
    pub coordinates: Vec<String>,
    /// Names of the other components of the state, after the coordinates.
    pub motion: Vec<String>,
    /// Parameters, then inputs, each with its default.
    pub parameters: Vec<(String, Option<f64>)>,
    /// The exported functions.
    pub routines: Vec<Routine>,
}

/// Arguments of a function other than time and parameters.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Takes {
    /// The state.
    State,
    /// Positions and velocities.
    Velocities,
}

/// An exported function.
#[derive(Debug, Clone, PartialEq)]
pub struct Routine {
    /// Name, for example `rate` or `impact_floor`.
    pub name: String,
    /// Description of the results.
    pub about: String,
    /// Its arguments.
    pub takes: Takes,
    /// The lines of its body, with its results.
    pub lines: Lines,
}

/// Exports the model of a declaration, or its scene `scene`. A model with modes gives one part for each mode, or for
/// the mode `scene`. Claims are not examined. `source` is the text of the declaration.
///
/// # Errors
/// [`ReportError`] for a text that does not declare a valid model. `Ok(None)` if there is no scene or mode of this
/// name.
pub fn export(source: &str, scene: Option<&str>) -> Result<Option<Vec<Part>>, ReportError> {
    match declaration(source)?.without_claims() {
        Declaration::Model(spec) => {
            let compiled = compile_spec(&spec, spec::STEPS).map_err(ReportError::Declaration)?;
            let (model, scenes) = (&compiled.model, &compiled.model.scenes);
            let found = match scene {
                None => Some((&compiled, model.snake_name.clone())),
                Some(name) => scenes
                    .iter()
                    .zip(&compiled.scenes)
                    .find(|(scene, _)| scene.name == name)
                    .map(|(_, compiled)| (compiled, format!("{}_{name}", model.snake_name))),
            };
            Ok(found.map(|(compiled, name)| vec![part(&FormOf::all(compiled, scenes)[0], name)]))
        }
        Declaration::Modes(modes) => {
            let compiled = compile_modes(&modes).map_err(ReportError::Declaration)?;
            let modes = compiled.graph.modes.iter().zip(&compiled.modes);
            let modes = modes.filter(|(mode, _)| scene.is_none_or(|name| mode.scene.name == name));
            let parts = modes.map(|(mode, compiled)| {
                let name = format!("{}_{}", compiled.model.snake_name, mode.scene.name);
                part(&FormOf::all(compiled, &[])[0], name)
            });
            let parts: Vec<Part> = parts.collect();
            Ok((!parts.is_empty()).then_some(parts))
        }
    }
}

fn part(form: &FormOf<'_>, name: String) -> Part {
    let model = form.model;
    let coordinates = model.coordinates.iter();
    let coordinates: Vec<String> = coordinates.map(|it| it.name.display.clone()).collect();
    Part {
        name,
        documentation: text_of(&model.documentation),
        motion: match form.program.form {
            Form::Global => coordinates.iter().map(|name| format!("p_{name}")).collect(),
            Form::Reduced => form.quasi_names(),
            Form::FirstOrder => Vec::new(),
        },
        coordinates,
        parameters: model
            .parameters
            .iter()
            .map(|it| (it.name.display.clone(), default_value(model, it)))
            .collect(),
        routines: routines(form),
    }
}

/// The functions that are useful outside of a run. The function of velocities comes first, because others use its
/// results.
fn routines(form: &FormOf<'_>) -> Vec<Routine> {
    let mut kernels = form.program.kernels();
    kernels.sort_by_key(|(kernel, _)| *kernel != Kernel::Velocity);
    let named = kernels
        .into_iter()
        .filter_map(|(kernel, function)| routine(form, kernel, function));
    named.collect()
}

/// Results of functions that give a new place in the motion.
const VELOCITIES: &str = "positions and velocities";

/// A function under its exported name; `None` for an internal function.
fn routine(form: &FormOf<'_>, kernel: Kernel, function: &Function) -> Option<Routine> {
    let model = form.model;
    let (name, about, takes) = match kernel {
        Kernel::Velocity => ("velocity".into(), "the velocities".into(), Takes::State),
        Kernel::Rate => ("rate".into(), "the rates of the state".into(), Takes::State),
        Kernel::Energy => ("energy".into(), "the energy".into(), Takes::State),
        Kernel::Motion => ("motion".into(), motion(form), Takes::Velocities),
        Kernel::Initial => {
            let about = format!("the declared initial {VELOCITIES}, 0 where none is declared");
            ("initial".into(), about, Takes::State)
        }
        Kernel::Multipliers => (
            "multipliers".into(),
            list(model, "the multipliers of the constraints", |model| {
                model
                    .constraints
                    .iter()
                    .map(|it| &it.name.display)
                    .collect()
            }),
            Takes::State,
        ),
        Kernel::Outputs => ("outputs".into(), outputs(model), Takes::State),
        Kernel::Gaps => (
            "gaps".into(),
            list(
                model,
                "the gaps, positive where motion is allowed",
                surfaces,
            ),
            Takes::State,
        ),
        Kernel::GapRates => (
            "gap_rates".into(),
            list(model, "the rates of the gaps", surfaces),
            Takes::State,
        ),
        Kernel::Blow(_) | Kernel::Focus(_) | Kernel::Reset(_) | Kernel::Entry(_) => {
            let (name, about) = of_surface(form, kernel)?;
            (name, about, Takes::State)
        }
        _ => return None,
    };
    let mut lines = Lines::of(function, form.dimension())?;
    match kernel {
        Kernel::Blow(_) => strike(&mut lines, form),
        Kernel::Focus(_) => push(&mut lines, form),
        _ => {}
    }
    lines.drop_unused();
    Some(Routine {
        name,
        about,
        takes,
        lines,
    })
}

/// Name and description of a function of a surface; `None` for any other.
fn of_surface(form: &FormOf<'_>, kernel: Kernel) -> Option<(String, String)> {
    let named = |s: usize| {
        let shown = &form.model.surfaces.get(s)?.name.display;
        Some((shown, shown.replace('.', "_")))
    };
    Some(match kernel {
        Kernel::Blow(s) => {
            let (shown, plain) = named(s)?;
            let mut kernels = form.program.kernels().into_iter();
            let from = match kernels.any(|(kernel, _)| kernel == Kernel::Focus(s)) {
                true => format!(", which begins at the result of focus_{plain}"),
                false => String::new(),
            };
            let about = format!("the state after an impact on {shown} by its law{from}");
            (format!("impact_{plain}"), about)
        }
        Kernel::Focus(s) => {
            let (shown, plain) = named(s)?;
            let about =
                format!("the state that satisfies the instantaneous constraints of {shown}");
            (format!("focus_{plain}"), about)
        }
        Kernel::Reset(s) => {
            let (shown, plain) = named(s)?;
            (
                format!("reset_{plain}"),
                format!("{VELOCITIES} after the reset at {shown}"),
            )
        }
        Kernel::Entry(s) => {
            let (shown, plain) = named(s)?;
            let about = format!("{VELOCITIES} in the mode that is entered at {shown}");
            (format!("entry_{plain}"), about)
        }
        _ => return None,
    })
}

/// Description of the result of `motion`.
fn motion(form: &FormOf<'_>) -> String {
    match form.program.form {
        Form::Reduced => "the quasi-velocities of the state".into(),
        Form::Global | Form::FirstOrder => "the momenta of the state".into(),
    }
}

fn surfaces(model: &Model) -> Vec<&String> {
    model.surfaces.iter().map(|it| &it.name.display).collect()
}

/// The description `about`, followed by the names of the results.
fn list(model: &Model, about: &str, names: impl Fn(&Model) -> Vec<&String>) -> String {
    let names: Vec<&str> = names(model).into_iter().map(String::as_str).collect();
    format!("{about}: {}", names.join(", "))
}

/// Description of the declared outputs. For an integral along a run the function gives the integrand.
fn outputs(model: &Model) -> String {
    let names = model.outputs.iter().map(|output| match output.is_integral {
        true => format!("the integrand of {}", output.name.display),
        false => output.name.display.clone(),
    });
    let names: Vec<String> = names.collect();
    format!("the declared outputs: {}", names.join(", "))
}

/// Replaces an impulse by the state after it.
fn push(lines: &mut Lines, form: &FormOf<'_>) {
    let n = form.dimension();
    let impulse = core::mem::take(&mut lines.outputs);
    let mut after: Vec<Operand> = (0..n).map(Operand::State).collect();
    for (place, &change) in impulse.iter().enumerate() {
        after.push(lines.add("+", vec![Operand::State(n + place), change]));
    }
    lines.outputs = after;
}

/// Replaces the results of an impact law (size, share and direction of its impulse) by the state after the impact.
fn strike(lines: &mut Lines, form: &FormOf<'_>) {
    let n = form.dimension();
    let blow = core::mem::take(&mut lines.outputs);
    let mut after: Vec<Operand> = (0..n).map(Operand::State).collect();
    let size = blow.first().copied();
    for (place, &direction) in blow.iter().skip(2).enumerate() {
        let Some(size) = size else { break };
        let change = lines.add("*", vec![size, direction]);
        after.push(lines.add("+", vec![Operand::State(n + place), change]));
    }
    lines.outputs = after;
}
