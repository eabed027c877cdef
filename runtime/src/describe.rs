//! Interface of a model to tools: names, documentation, parameters, and the view.
//!
//! `model!` implements it for every model, so that a tool can list models, set their parameters and report the
//! quantities derived at a state.

pub use dalembert_numbers::description::{
    Assumption, ConstraintInfo, CoordinateInfo, Description, ModeInfo, ParameterInfo, SurfaceInfo,
    Topology, ViewInfo,
};

use crate::contract::{System, Variational};
use crate::effects::Scene;
use crate::error::Fault;

/// A declared model with values of its parameters. It describes itself and its states to tools.
///
/// # Examples
///
/// ```
/// use dalembert::Instance;
///
/// dalembert::model! {
///     pub Pendulum {
///         coordinates { theta: angle; }
///         parameters { l > 0 = 2; }
///         lagrangian = l^2*dot(theta)^2/2 + l*cos(theta);
///         initial { theta = 1/4; until = 10; }
///         outputs { height: -l*cos(theta); }
///     }
/// }
///
/// let mut pendulum = Pendulum::default();
/// pendulum.set_parameter(0, 3.0);
/// assert_eq!(pendulum.l, 3.0);
/// let initial = pendulum.initial();
/// assert_eq!((initial.q[0], initial.until), (0.25, Some(10.0)));
/// ```
#[diagnostic::on_unimplemented(
    message = "`{Self}` is not a model declared with `dalembert::model!`"
)]
pub trait Instance: System + Clone {
    /// Names, documentation, topology, parameters, surfaces, scenes, source text.
    fn description(&self) -> &Description;

    /// The inputs. Their values follow the parameters of the description.
    fn inputs(&self) -> &[&'static str] {
        &[]
    }

    /// Calls the visitor with the system if its runs have variations: the model itself, and scenes with `variations`.
    fn visit_variational<Visitor: VariationalVisitor>(
        &self,
        visitor: Visitor,
    ) -> Option<Visitor::Output> {
        let _ = visitor;
        None
    }

    /// The same system in its global form, with the state (q, p) on T*Q, defined off the constraints as well. `Self`
    /// for a model that has no form reduced to D.
    type Global: Instance<Vector = Self::Vector, Global = Self::Global> + Scene;

    /// The system in its global form. `None` for a reduced model whose declaration does not ask for this form with
    /// `#[global]`. Models without a reduced form, modes, and models loaded from a text always have it.
    fn global(&self) -> Option<Self::Global>;

    /// Value of parameter `index` in [`Description::parameters`]; NaN past the end.
    fn parameter(&self, index: usize) -> f64;

    /// Sets parameter `index` of [`Description::parameters`] to `value`. An index past the end changes nothing.
    fn set_parameter(&mut self, index: usize, value: f64);

    /// Selects the mode, by number, of new states and of the beginning of a run. A number past the end changes nothing,
    /// and neither does any number in a system without modes.
    fn set_mode(&mut self, mode: usize) {
        let _ = mode;
    }

    /// The declared `initial`, at the values of the parameters.
    fn initial(&self) -> Initial<Self::Vector>;

    /// Writes the declared outputs at a state, in order. The length of `values` must be their number.
    ///
    /// # Errors
    /// A [`Fault`] where an output needs the equations of motion and these do not exist.
    fn outputs(&self, t: f64, state: &Self::State, values: &mut [f64]) -> Result<(), Fault>;

    /// The point of the declared view in the plane; `None` without a view.
    fn view_path(&self, t: f64, state: &Self::State) -> Option<[f64; 2]>;

    /// Value of the declared region's function, positive where motion is allowed; `None` without a region.
    fn view_region(&self, t: f64, q: &Self::Vector) -> Option<f64>;

    /// Reports all derived quantities at a state, by name (see [`Report`]).
    ///
    /// # Errors
    /// A [`Fault`] where the equations of motion do not exist; [`Fault::NotDerived`] for a system without its
    /// [global form](Instance::global).
    fn inspect(&self, t: f64, state: &Self::State, report: &mut dyn Report) -> Result<(), Fault>;

    /// Reports the quantities that exist only in the frame of D: quasi-velocities and their rates, `X_0`, the rows
    /// `X_i`, `G_D`, and the density of `mu_C` in positions and quasi-velocities. Reports nothing in global form.
    ///
    /// # Errors
    /// A [`Fault`] where the equations of motion do not exist.
    fn inspect_frame(
        &self,
        t: f64,
        state: &Self::State,
        report: &mut dyn Report,
    ) -> Result<(), Fault> {
        let _ = (t, state, report);
        Ok(())
    }
}

/// Receives a system with variations, in its own type (see [`Instance::visit_variational`]).
///
/// # Examples
///
/// ```
/// use dalembert::describe::VariationalVisitor;
/// use dalembert::{Instance, Scene, Variational};
///
/// # dalembert::model! {
/// #     pub Pendulum {
/// #         coordinates { theta: angle; }
/// #         lagrangian = dot(theta)^2/2 + cos(theta);
/// #     }
/// # }
///
/// /// The number of directions that first variations of a state have.
/// struct Directions;
///
/// impl VariationalVisitor for Directions {
///     type Output = usize;
///
///     fn visit<S: Instance + Scene + Variational>(self, _system: &S) -> usize {
///         S::tangents().as_ref().len()
///     }
/// }
///
/// assert_eq!(Pendulum::default().visit_variational(Directions), Some(2));
/// ```
pub trait VariationalVisitor {
    /// Result of the visit.
    type Output;

    /// Visits the system, in its own type.
    fn visit<S: Instance + Scene + Variational>(self, system: &S) -> Self::Output;
}

/// The declared initial condition.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Initial<V> {
    /// Positions; 0 for coordinates without a declared position.
    pub q: V,
    /// Velocities, meaningful where `named` is 1.
    pub qdot: V,
    /// 1 if the position is declared, 0 if holonomic constraints may determine it.
    pub placed: V,
    /// 1 if the velocity is declared, 0 if the constraints may determine it.
    pub named: V,
    /// The declared `until`, if any.
    pub until: Option<f64>,
}

/// Receives named quantities. The names are those of the command line's `eval`.
///
/// # Examples
///
/// ```
/// use dalembert::describe::Report;
/// use dalembert::{Instance, System};
///
/// # dalembert::model! {
/// #     pub Pendulum {
/// #         coordinates { theta: angle; }
/// #         lagrangian = dot(theta)^2/2 + cos(theta);
/// #     }
/// # }
///
/// #[derive(Default)]
/// struct Names(Vec<String>);
///
/// impl Report for Names {
///     fn scalar(&mut self, name: &str, _value: f64) {
///         self.0.push(name.to_owned());
///     }
///     fn vector(&mut self, name: &str, _values: &[f64]) {
///         self.0.push(name.to_owned());
///     }
///     fn matrix(&mut self, name: &str, _rows: usize, _columns: usize, _values: &[f64]) {
///         self.0.push(name.to_owned());
///     }
/// }
///
/// let pendulum = Pendulum::default();
/// let state = pendulum.state(0.0, &[0.5].into(), &[1.0].into())?;
/// let mut names = Names::default();
/// pendulum.inspect(0.0, &state, &mut names)?;
/// assert!(names.0.iter().any(|name| name == "acceleration"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub trait Report {
    /// Receives a number.
    fn scalar(&mut self, name: &str, value: f64);

    /// Receives a vector, in order of declaration.
    fn vector(&mut self, name: &str, values: &[f64]);

    /// Receives a matrix of `rows` by `columns` numbers, stored row by row.
    fn matrix(&mut self, name: &str, rows: usize, columns: usize, values: &[f64]);
}
