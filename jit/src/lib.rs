//! Declarations that run without a compiler.
//!
//! ```text
//! text --source--> tokens --codegen--> Program, tables --form--> Form --dalembert::erased--> a system
//! ```
//!
//! | file | job |
//! |---|---|
//! | `source.rs` | models of a text, and mistakes in it with their lines |
//! | `feedback.rs` | texts whose inputs follow feedback laws |
//! | `form.rs` | forms: tables, and functions that execute programs |
//! | `machine.rs` | a machine with registers: executes a function over any kind of number |
//! | `series.rs` | power series over any kind of number |
//! | `native/` | functions and series over doubles as machine code for x86-64 with AVX and for aarch64; other processors use the two files above, 2 to 10 times slower |
//!
//! Refusals and proofs are those of `model!`. Results are those of the code that `model!` writes, to the bit.
//!
//! ```
//! use dalembert::erased::Erased;
//! use dalembert::{System, Instance};
//!
//! let models = dalembert_jit::load("pendulum.dal", "
//!     Pendulum {
//!         coordinates { theta: angle; }
//!         parameters { g > 0 = 9.81; }
//!         lagrangian = dot(theta)^2/2 + g*cos(theta);
//!         initial { theta = 1/2; }
//!     }
//! ")?;
//! let pendulum = Erased::<4>::of(&models[0].form).expect("room for two numbers");
//! let start = pendulum.initial();
//! let state = pendulum.state(0.0, &start.q, &start.qdot).expect("a state");
//! assert_eq!(pendulum.energy(0.0, &state), Ok(-9.81 * 0.5_f64.cos()));
//! # Ok::<(), dalembert_jit::Refused>(())
//! ```

mod feedback;
mod form;
mod lexical;
mod machine;
#[cfg_attr(
    not(any(target_arch = "x86_64", target_arch = "aarch64")),
    path = "elsewhere.rs"
)]
mod native;
mod series;
mod source;

use std::panic::resume_unwind;
use std::sync::Arc;
use std::thread;

use dalembert::erased::Form;
use dalembert_codegen::diagnostics::Diagnostics;
use dalembert_codegen::spec::Declaration;
use dalembert_codegen::{self as codegen, Compiled};

pub use dalembert_codegen::diagnostics::Counterexample;
pub use feedback::{FeedbackError, close};
pub use source::{Mistake, Refused};

/// A model of a text.
#[derive(Debug, Clone)]
pub struct Loaded {
    /// The name as it is declared: `RollingDisk`.
    pub name: String,
    /// The form of the model itself.
    pub form: Arc<Form>,
    /// Names and forms of its scenes, without `all`, which is the model itself.
    pub scenes: Vec<(String, Arc<Form>)>,
}

/// The models of a text, in the order of the text. `name` is the name of the file, for messages.
///
/// # Errors
/// For each model, all mistakes that the first stage with a mistake finds.
pub fn load(name: &str, text: &str) -> Result<Vec<Loaded>, Refused> {
    load_by(name, text, build)
}

/// Same as [`load`], without the claims of the models. Nothing that follows from a claim is known then, such as an
/// invariant volume.
///
/// # Errors
/// Same as [`load`].
pub fn load_without_claims(name: &str, text: &str) -> Result<Vec<Loaded>, Refused> {
    load_by(name, text, |declaration| {
        build(declaration.without_claims())
    })
}

/// The extremals of a model with a cost as a first-order model: [`compile_control`](codegen::compile_control). `scene`
/// names a scene of the model; `None` is the model itself.
///
/// # Errors
/// All mistakes that the first stage with a mistake finds, in the model or in its extremals.
pub fn load_control(name: &str, text: &str, scene: Option<&str>) -> Result<Vec<Loaded>, Refused> {
    load_by(name, text, |declaration| match declaration {
        Declaration::Model(spec) => {
            let compiled = codegen::compile_control(&spec, scene)?;
            Ok(loaded(spec.name.text.clone(), &compiled))
        }
        modes @ Declaration::Modes(_) => build(modes),
    })
}

/// A model with a cost whose inputs are held.
#[derive(Debug)]
pub struct LoadedHeld {
    /// The first-order model: state, inputs, cost so far.
    pub loaded: Loaded,
    /// Number of inputs.
    pub inputs: usize,
    /// True if rates, impacts and running cost do not depend on time.
    pub is_autonomous: bool,
}

/// A model with a cost whose inputs are held, as a first-order model: [`compile_held`](codegen::compile_held). `scene`
/// names a scene of the model; `None` is the model itself. Models with modes are left out.
///
/// # Errors
/// Same as [`load_control`].
pub fn load_held(name: &str, text: &str, scene: Option<&str>) -> Result<Vec<LoadedHeld>, Refused> {
    let loaded = load_by(name, text, |declaration| match declaration {
        Declaration::Model(spec) => {
            let held = codegen::compile_held(&spec, scene)?;
            Ok(Some(LoadedHeld {
                loaded: loaded(spec.name.text.clone(), &held.compiled),
                inputs: held.inputs,
                is_autonomous: held.is_autonomous,
            }))
        }
        Declaration::Modes(_) => Ok(None),
    })?;
    Ok(loaded.into_iter().flatten().collect())
}

/// Stack size of the thread that loads, in bytes.
const STACK: usize = 64 << 20;

fn load_by<T: Send>(
    name: &str,
    text: &str,
    build: impl Fn(Declaration) -> Result<T, Diagnostics> + Send + Sync,
) -> Result<Vec<T>, Refused> {
    in_thread(|| load_here(name, text, &build))
}

/// Does work in a thread of its own. The copy of the text that `proc_macro2` keeps for places is freed with the thread, and
/// its stack is large enough for the deepest nesting that is accepted.
fn in_thread<T: Send>(work: impl Fn() -> T + Send + Sync) -> T {
    thread::scope(|scope| {
        let thread = thread::Builder::new().stack_size(STACK);
        match thread.spawn_scoped(scope, &work) {
            Ok(thread) => thread.join().unwrap_or_else(|panic| resume_unwind(panic)),
            // No thread could be started.
            Err(_) => work(),
        }
    })
}

fn load_here<T>(
    name: &str,
    text: &str,
    build: &dyn Fn(Declaration) -> Result<T, Diagnostics>,
) -> Result<Vec<T>, Refused> {
    let mut refused = Refused::new(name, text);
    let mut loaded = Vec::new();
    for tokens in source::models(&mut refused)? {
        match codegen::read(tokens).and_then(build) {
            Ok(model) => loaded.push(model),
            Err(diagnostics) => refused.add(&diagnostics),
        }
    }
    refused.or(loaded)
}

fn build(declaration: Declaration) -> Result<Loaded, Diagnostics> {
    match declaration {
        Declaration::Model(spec) => {
            let compiled = codegen::compile_spec(&spec, codegen::spec::STEPS)?;
            Ok(loaded(spec.name.text.clone(), &compiled))
        }
        Declaration::Modes(modes) => {
            let compiled = codegen::compile_modes(&modes)?;
            Ok(Loaded {
                name: modes.modes[0].spec.name.text.clone(),
                form: form::of_modes(&compiled),
                scenes: Vec::new(),
            })
        }
    }
}

fn loaded(name: String, compiled: &Compiled) -> Loaded {
    let scenes = &compiled.model.scenes;
    let of_scenes = scenes.iter().zip(&compiled.scenes);
    Loaded {
        name,
        form: form::of_model(compiled, scenes),
        scenes: of_scenes
            .map(|(scene, compiled)| (scene.name.clone(), form::of_model(compiled, scenes)))
            .collect(),
    }
}
