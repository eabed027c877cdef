//! Pictures of motions between two configurations.

use dalembert_driver::{
    Connection, Contact, Form, Impact, Integrator, OffConstraint, Origin, Piece, Rates, Settings,
    Watch,
};

use super::{Finished, summary};
use crate::args::ConnectArgs;
use crate::error::CliError;
use crate::plot::paths::{self, Path, Sheet};
use crate::plot::quantity::{self, Quantity};
use crate::plot::trace::{Source, Trace};

/// The picture of all motions.
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
        names: quantities.iter().map(|it| it.name(description)).collect(),
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
    let mut camera = Camera {
        trace: Trace::of(Source::Quantities(quantities.to_vec())),
        corners: Vec::new(),
        quantities,
        start: connection.first.energy,
    };
    let ending = model.simulate(&origin, &settings, &mut camera);
    ending.map_err(|refusal| CliError::refused(model, &refusal))?;
    Ok(Path {
        impacts: connection.bounces.len(),
        points: camera
            .trace
            .points()
            .iter()
            .map(|mark| mark.values.clone())
            .collect(),
        corners: camera.corners,
    })
}

/// Keeps the curve of a run and the places of its impacts.
struct Camera<'a> {
    trace: Trace,
    corners: Vec<Vec<f64>>,
    quantities: &'a [Quantity],
    /// The energy at the start.
    start: f64,
}

impl Watch for Camera<'_> {
    fn step(&mut self, piece: &dyn Piece) {
        self.trace.follow(piece);
    }

    fn impact(&mut self, impact: Impact) {
        self.trace.corner(impact.t, &impact.before);
        self.trace.corner(impact.t, &impact.after);
        let quantities = self.quantities.iter();
        let values = quantities.map(|it| it.value(impact.t, &impact.before, self.start));
        self.corners.push(values.collect());
    }

    fn contact(&mut self, contact: Contact) {
        self.trace.corner(contact.t, &contact.at);
    }
}
