//! Pictures of motions between two configurations.

use dalembert_driver::{Connection, Form, Integrator, OffConstraint, Origin, Rates, Settings};

use super::{Finished, summary};
use crate::args::ConnectArgs;
use crate::error::CliError;
use crate::plot::film;
use crate::plot::paths::{self, Path, Sheet};
use crate::plot::quantity::{self, Quantity};

/// The picture of the motions that were found.
///
/// # Errors
/// A motion that cannot be repeated, or an error of the drawing library.
pub(super) fn picture(finished: &Finished<'_>, args: &ConnectArgs) -> Result<String, CliError> {
    let description = finished.model.description();
    let axes = args.axes.as_deref().unwrap_or("t,q");
    let quantities = quantity::parse("--axes", axes, description)?;
    let connections = finished.connected.connections.iter();
    let paths = connections.map(|connection| path(finished, args, connection, &quantities));
    let paths: Vec<Path> = paths.collect::<Result<_, CliError>>()?;
    let envelope = finished.connected.envelope.iter();
    let envelope = envelope.map(|it| {
        let values = quantities
            .iter()
            .map(|axis| axis.value(it.t, &it.at, f64::NAN));
        (it.impacts, values.collect())
    });
    let envelope: Vec<(usize, Vec<f64>)> = envelope.collect();
    let drawn = paths::draw(&Sheet {
        title: &summary::title(finished),
        subtitle: &summary::subtitle(finished),
        names: quantities.iter().map(|it| it.label(description)).collect(),
        width: f64::from(args.plot_width),
        paths: &paths,
        envelope: &envelope,
    });
    drawn.map_err(|reason| CliError::picture(&args.plot, reason))
}

/// The curve of a motion.
fn path(
    finished: &Finished<'_>,
    args: &ConnectArgs,
    connection: &Connection,
    quantities: &[Quantity],
) -> Result<Path, CliError> {
    let (model, boundary) = (finished.model, &finished.boundary);
    let form = Form::choose(model.description(), None, false);
    let settings = Settings {
        form: form.unwrap_or(Form::Global),
        integrator: Integrator::Taylor,
        tol: args.series.tol,
        step: None,
        max_step: None,
        steps: None,
        until: boundary.time,
        impacts: None,
        laws: boundary.laws.clone(),
        policies: boundary.policies,
        projection: None,
    };
    let origin = Origin {
        q: connection.first.q.clone(),
        rates: Rates::Velocities(connection.first.qdot.clone()),
        policy: OffConstraint::Keep,
    };
    Ok(Path {
        impacts: connection.bounces.len(),
        stretches: film::curve(model, &origin, &settings, quantities)?,
    })
}
