//! The functions of a model for other languages and programs, as lines that each of them writes in its own words.
//!
//! | file | job |
//! |---|---|
//! | `mod.rs` | what is exported: models and modes with their functions |
//! | `lines.rs` | a function as lines |
//! | `c.rs` | all of it as a header of C |
//!
//! The state is that in which the model is run: positions with momenta, with quasi-velocities, or alone.

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
    /// The name in snake case; that of a mode or a scene behind it.
    pub name: String,
    /// Doc comment.
    pub documentation: String,
    /// Names of the coordinates.
    pub coordinates: Vec<String>,
    /// Names of the rest of the state.
    pub motion: Vec<String>,
    /// The parameters with their defaults, then the inputs.
    pub parameters: Vec<(String, Option<f64>)>,
    /// The functions.
    pub routines: Vec<Routine>,
}

/// Arguments of a function besides time and parameters.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Takes {
    /// The state.
    State,
    /// Positions and velocities.
    Velocities,
}

/// A function.
#[derive(Debug, Clone, PartialEq)]
pub struct Routine {
    /// The name: `rate`, `impact_floor`.
    pub name: String,
    /// The meaning of its results.
    pub about: String,
    /// Its arguments.
    pub takes: Takes,
    /// The lines.
    pub lines: Lines,
}

/// The model of a text, a scene of it, or all of its modes. Its claims are not examined.
///
/// # Errors
/// [`ReportError`] for a text that declares no model; `Ok(None)` without such a scene.
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

/// The functions that make sense outside of a run. Those of velocities come first: others read them.
fn routines(form: &FormOf<'_>) -> Vec<Routine> {
    let mut kernels = form.program.kernels();
    kernels.sort_by_key(|(kernel, _)| *kernel != Kernel::Velocity);
    let named = kernels
        .into_iter()
        .filter_map(|(kernel, function)| routine(form, kernel, function));
    named.collect()
}

/// A function under its exported name; `None` for one that stays inside.
fn routine(form: &FormOf<'_>, kernel: Kernel, function: &Function) -> Option<Routine> {
    let model = form.model;
    let surface = |s: usize| {
        let name = &model.surfaces.get(s)?.name;
        Some((name.display.clone(), name.display.replace('.', "_")))
    };
    let velocities = "positions and velocities";
    let (name, about, takes) = match kernel {
        Kernel::Velocity => ("velocity".into(), "the velocities".into(), Takes::State),
        Kernel::Rate => ("rate".into(), "the rates of the state".into(), Takes::State),
        Kernel::Energy => ("energy".into(), "the energy".into(), Takes::State),
        Kernel::Motion => ("motion".into(), motion(form), Takes::Velocities),
        Kernel::Initial => {
            let about = format!("the declared initial {velocities}, 0 where none are");
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
        Kernel::Blow(s) => {
            let (shown, plain) = surface(s)?;
            (
                format!("impact_{plain}"),
                format!("the state after an impact on {shown} by its law"),
                Takes::State,
            )
        }
        Kernel::Reset(s) => {
            let (shown, plain) = surface(s)?;
            (
                format!("reset_{plain}"),
                format!("{velocities} after the reset at {shown}"),
                Takes::State,
            )
        }
        Kernel::Entry(s) => {
            let (shown, plain) = surface(s)?;
            (
                format!("entry_{plain}"),
                format!("{velocities} in the mode that is entered at {shown}"),
                Takes::State,
            )
        }
        _ => return None,
    };
    let mut lines = Lines::of(function, form.dimension())?;
    if matches!(kernel, Kernel::Blow(_)) {
        strike(&mut lines, form);
    }
    Some(Routine {
        name,
        about,
        takes,
        lines,
    })
}

/// The result of `motion`.
fn motion(form: &FormOf<'_>) -> String {
    match form.program.form {
        Form::Reduced => "the quasi-velocities of the state".into(),
        Form::Global | Form::FirstOrder => "the momenta of the state".into(),
    }
}

fn surfaces(model: &Model) -> Vec<&String> {
    model.surfaces.iter().map(|it| &it.name.display).collect()
}

/// Words with the names that the results have.
fn list(model: &Model, about: &str, names: impl Fn(&Model) -> Vec<&String>) -> String {
    let names: Vec<&str> = names(model).into_iter().map(String::as_str).collect();
    format!("{about}: {}", names.join(", "))
}

/// The declared outputs by name; of an integral along a run, the integrand.
fn outputs(model: &Model) -> String {
    let names = model.outputs.iter().map(|output| match output.is_integral {
        true => format!("the integrand of {}", output.name.display),
        false => output.name.display.clone(),
    });
    let names: Vec<String> = names.collect();
    format!("the declared outputs: {}", names.join(", "))
}

/// The state after a blow, whose results are its size, its share and its direction.
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
