//! Pictures of extremals, and rows along one of them. The runs of the extremals are repeated for both.

use dalembert_driver::{
    Contact, Extremal, Impact, OffConstraint, Origin, Piece, Point, Rates, Watch,
};

use super::{Finished, summary};
use crate::args::ControlArgs;
use crate::error::CliError;
use crate::plot::film;
use crate::plot::paths::{self, Path, Sheet};
use crate::plot::quantity;

/// The picture of the extremals that were found.
///
/// # Errors
/// An extremal that cannot be repeated, or an error of the drawing library.
pub(super) fn picture(finished: &Finished<'_>, args: &ControlArgs) -> Result<String, CliError> {
    let description = finished.description();
    let usual = || {
        let all = finished.states().chain(finished.inputs());
        ["t"]
            .into_iter()
            .chain(all)
            .collect::<Vec<&str>>()
            .join(",")
    };
    let axes = args.axes.clone().unwrap_or_else(usual);
    let quantities = quantity::parse("--axes", &axes, description)?;
    let settings = finished.settings();
    let path = |extremal: &Extremal| {
        let origin = origin(finished, extremal);
        Ok(Path {
            impacts: extremal.kicks.len(),
            stretches: film::curve(finished.model, &origin, &settings, &quantities)?,
        })
    };
    let extremals = finished.controlled.extremals.iter();
    let paths: Vec<Path> = extremals.map(path).collect::<Result<_, CliError>>()?;
    let drawn = paths::draw(&Sheet {
        title: &summary::title(finished),
        subtitle: &summary::subtitle(finished),
        names: quantities.iter().map(|it| it.label(description)).collect(),
        width: f64::from(args.plot_width),
        paths: &paths,
        envelope: &[],
    });
    drawn.map_err(|reason| CliError::picture(&args.plot, reason))
}

fn origin(finished: &Finished<'_>, extremal: &Extremal) -> Origin {
    let first = &extremal.first;
    let mut q = [&*first.state, &*first.costate].concat();
    q.push(0.0);
    Origin {
        rates: Rates::Velocities(vec![0.0; finished.description().coordinates.len()]),
        q,
        policy: OffConstraint::Keep,
    }
}

/// Times and states of the extremal of least cost: evenly in time, and on both sides of impacts.
///
/// # Errors
/// A run that cannot be repeated.
pub(super) fn rows(finished: &Finished<'_>, samples: u32) -> Result<Vec<(f64, Point)>, CliError> {
    let Some(extremal) = finished.controlled.extremals.first() else {
        return Ok(Vec::new());
    };
    let end = finished.task.time;
    let time = |index: u32| match index + 1 == samples {
        true => end,
        false => end * f64::from(index) / f64::from(samples - 1),
    };
    let mut sampler = Sampler {
        times: (0..samples).map(time).collect(),
        next: 0,
        rows: Vec::new(),
    };
    let origin = origin(finished, extremal);
    let ending = finished
        .model
        .simulate(&origin, &finished.settings(), &mut sampler);
    ending.map_err(|refusal| CliError::refused(finished.model, &refusal))?;
    Ok(sampler.rows)
}

/// Keeps the states at given times and at impacts.
struct Sampler {
    times: Vec<f64>,
    next: usize,
    rows: Vec<(f64, Point)>,
}

impl Watch for Sampler {
    fn step(&mut self, piece: &dyn Piece) {
        let (_, end) = piece.span();
        while let Some(&t) = self.times.get(self.next).filter(|t| **t <= end) {
            self.rows.push((t, piece.at(t)));
            self.next += 1;
        }
    }

    fn impact(&mut self, impact: Impact) {
        self.rows.push((impact.t, impact.before));
        self.rows.push((impact.t, impact.after));
    }

    fn contact(&mut self, _contact: Contact) {}
}
