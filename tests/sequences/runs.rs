//! Runs from a start with their impacts, either computed or certified.

use dalembert::Policies;
use dalembert::math::larger;
use dalembert_driver::{
    Certification, Certified, Contact, Ending, Form, Impact, Integrator, Piece, Point, Settings,
    Strike, Watch,
};

use crate::starts::Case;

/// Largest number of impacts of a run.
pub const IMPACTS: u64 = 16;

/// Impacts and end of a run.
pub struct Course {
    pub impacts: Vec<Impact>,
    pub ending: Ending,
}

#[derive(Default)]
struct Log(Vec<Impact>);

impl Watch for Log {
    fn step(&mut self, _: &dyn Piece) {}

    fn impact(&mut self, impact: Impact) {
        self.0.push(impact);
    }

    fn contact(&mut self, _: Contact) {}
}

/// Settings of a run.
#[derive(Debug, Clone, Copy)]
pub struct Way {
    pub integrator: Integrator,
    pub form: Form,
    pub tol: f64,
}

/// Keeps the state at a time, and stops the run there.
struct Moment {
    t: f64,
    point: Option<Point>,
}

impl Watch for Moment {
    fn step(&mut self, piece: &dyn Piece) {
        let (from, to) = piece.span();
        if self.point.is_none() && from <= self.t && self.t <= to {
            self.point = Some(piece.at(self.t));
        }
    }

    fn impact(&mut self, _: Impact) {}

    fn contact(&mut self, _: Contact) {}

    fn is_over(&self) -> bool {
        self.point.is_some()
    }
}

/// Makes a run; `None` if the start is refused.
pub fn run(case: &Case, way: Way, until: f64) -> Option<Course> {
    let mut log = Log::default();
    let ending = watched(case, way, until, &mut log)?;
    Some(Course {
        impacts: log.0,
        ending,
    })
}

/// The state of a run at the time `t`, or at its end if the run ends earlier; preceded by that time. `None` if the
/// start is refused.
pub fn state_at(case: &Case, way: Way, until: f64, t: f64) -> Option<(f64, Point)> {
    let mut moment = Moment { t, point: None };
    let ending = watched(case, way, until, &mut moment)?;
    Some(match moment.point {
        Some(point) => (t, point),
        None => (ending.t, ending.last),
    })
}

fn watched(case: &Case, way: Way, until: f64, watch: &mut dyn Watch) -> Option<Ending> {
    let settings = Settings {
        form: way.form,
        integrator: way.integrator,
        tol: way.tol,
        step: None,
        max_step: None,
        steps: Some(100_000),
        until,
        impacts: Some(IMPACTS),
        laws: Vec::new(),
        policies: Policies::default(),
        projection: None,
    };
    case.model.simulate(&case.origin, &settings, watch).ok()
}

/// Enclosures of the first impacts, as far as the motion is certified; `None` if the model has no certified motion.
pub fn certified(case: &Case, impacts: u64) -> Option<(Vec<Strike>, Certified)> {
    let request = Certification {
        form: Form::Reduced,
        until: case.until,
        impacts: Some(impacts),
        laws: Vec::new(),
        parameters: Vec::new(),
        positions: Vec::new(),
        rates: Vec::new(),
        named: Vec::new(),
    };
    let mut strikes = Vec::new();
    let mut keep = |strike: &Strike| strikes.push(strike.clone());
    let certified = case.model.certify(&case.origin, &request, &mut keep).ok()?;
    Some((strikes, certified))
}

/// The error of an impact compared with the reference: the largest of the error of its time, relative to `until`, and
/// of the errors of the positions and velocities after it, by [`apart`].
pub fn error(impact: &Impact, reference: &Impact, until: f64) -> f64 {
    let time = (impact.t - reference.t).abs() / until;
    let after = (&impact.after, &reference.after);
    time.max(apart(&after.0.q, &after.1.q))
        .max(apart(&after.0.qdot, &after.1.qdot))
}

/// The largest difference of the entries, relative to the largest entry of `a`, or to 1e-3 if that is larger.
/// Coordinates that the mode does not have are left out.
pub fn apart(a: &[f64], b: &[f64]) -> f64 {
    let pairs = || a.iter().zip(b).filter(|(a, b)| !(a.is_nan() && b.is_nan()));
    let largest = pairs().fold(0.0, |most: f64, (a, b)| larger(most, (a - b).abs()));
    let size = pairs().fold(1e-3, |most: f64, (a, _)| larger(most, a.abs()));
    largest / size
}
