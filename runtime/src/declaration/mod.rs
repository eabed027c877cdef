//! Facts about a declared model that need no instance: its description, its declared values, its scenes.

mod form;

pub use form::of_mode;

use crate::contract::{Lagrangian, TaylorField};
use crate::describe::{Description, Instance};
use crate::effects::Scene;
use crate::erased::{Form, Shared};
use crate::kernels::{Documentation, Documented, Given, Tables};

/// A declared model. Implemented by `model!` for every model.
///
/// # Examples
///
/// ```
/// use dalembert::Described;
///
/// dalembert::model! {
///     /// A pendulum in a plane.
///     pub Pendulum {
///         coordinates { theta: angle; }
///         parameters { l > 0 = 2; }
///         lagrangian = l^2*dot(theta)^2/2 + l*cos(theta);
///     }
/// }
///
/// let description = Pendulum::DESCRIPTION;
/// assert_eq!(description.name, "pendulum");
/// assert_eq!(description.coordinates[0].name, "theta");
/// assert_eq!(Pendulum::with_defaults().l, 2.0);
/// ```
#[diagnostic::on_unimplemented(
    message = "`{Self}` is not a model declared with `dalembert::model!`"
)]
pub trait Described: Instance {
    /// Names, docs, topology, parameters, surfaces, scenes, source text.
    const DESCRIPTION: &'static Description;

    /// Names of the inputs. In a vector of parameters, the inputs come after the parameters of [`Self::DESCRIPTION`].
    const INPUTS: &'static [&'static str] = &[];

    /// The model as data, for [`Erased`](crate::erased::Erased); `None` for a model that only its own type can run.
    const FORM: Option<&'static Form> = None;

    /// Calls the visitor with the type of each declared scene, in order. The model itself, the scene `all`, is left
    /// out.
    fn visit_scenes<Visitor: SceneVisitor>(visitor: &mut Visitor) {
        let _ = visitor;
    }

    /// The system with declared defaults; a parameter without default is NaN until it is set.
    fn with_defaults() -> Self;
}

/// Receives the types of a model's scenes (see [`Described::visit_scenes`]).
///
/// # Examples
///
/// ```
/// use dalembert::declaration::SceneVisitor;
/// use dalembert::{Described, Lagrangian, Scene, TaylorField};
///
/// dalembert::model! {
///     pub Ball {
///         coordinates { x; }
///         lagrangian = dot(x)^2/2 - x;
///         impacts { floor: x >= 0; }
///         scenes { free; }
///     }
/// }
///
/// struct Names(Vec<&'static str>);
///
/// impl SceneVisitor for Names {
///     fn visit<S>(&mut self, name: &'static str)
///     where
///         S: Described<Global: TaylorField + Lagrangian> + Scene + TaylorField + Lagrangian + 'static,
///     {
///         self.0.push(name);
///     }
/// }
///
/// fn main() {
///     let mut names = Names(Vec::new());
///     Ball::visit_scenes(&mut names);
///     assert_eq!(names.0, ["free"]);
/// }
/// ```
pub trait SceneVisitor {
    /// Visits a scene of this name: the model with the effects that the scene keeps, and the parameters of the model.
    fn visit<S>(&mut self, name: &'static str)
    where
        S: Described<Global: TaylorField + Lagrangian> + Scene + TaylorField + Lagrangian + 'static;
}

/// A form of a declared model or of a scene, as `model!` writes it: everything but the parameter values is constant.
pub trait Emitted: Documented<Kernels: Given, Global: Described> + TaylorField + 'static {
    /// Facts about the form apart from its kernels.
    const TABLES: &'static Tables;

    /// Documentation of the form.
    const DOCUMENTATION: &'static Documentation;

    /// For a model with modes, the forms of the modes and their global forms ([`Form::forms`]).
    const FORMS: &'static [Shared<Form>] = &[];

    /// Implementation of [`Described::with_defaults`].
    fn declared() -> Self;

    /// Implementation of [`Described::visit_scenes`].
    fn show_scenes<Visitor: SceneVisitor>(visitor: &mut Visitor) {
        let _ = visitor;
    }
}

impl<S: Emitted> Described for S {
    const DESCRIPTION: &'static Description = &S::DOCUMENTATION.description;

    const INPUTS: &'static [&'static str] = S::DOCUMENTATION.inputs.value();

    const FORM: Option<&'static Form> = form::of::<S>();

    fn visit_scenes<Visitor: SceneVisitor>(visitor: &mut Visitor) {
        S::show_scenes(visitor);
    }

    fn with_defaults() -> S {
        S::declared()
    }
}
