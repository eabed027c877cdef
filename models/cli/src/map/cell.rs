//! One cell of a map: its run, which is watched at its returns, and its result.

use std::collections::VecDeque;

use dalembert::Outcome;
use dalembert_driver::{
    Contact, Ending, Growth, Impact, OffConstraint, Origin, Piece, Point, Rates, Watch,
};

use super::orbits::{self, Return};
use super::request::{Request, Returns};
use crate::{names, outcome};
use dalembert_driver::ensemble::runner::{Runner, details};

/// Outcome of a run that made all requested returns.
pub const RETURNED: &str = "returned";

/// Outcome of a run that the condition of `--fail` ended.
pub const FAILED: &str = "failed";

/// Result of the run of a cell.
pub struct Cell {
    /// The outcome.
    pub outcome: &'static str,
    /// The surface whose law `stop` ended the motion, if one did.
    pub stop: Option<&'static str>,
    /// Number of returns.
    pub returns: u64,
    /// The time at the end; NaN if there was no run.
    pub t: f64,
    /// The state after the last return if all were made, else at the end.
    pub end: Vec<f64>,
    /// The points of the orbit that the returns repeat, the last return first; empty if they do not repeat.
    pub cycle: Vec<Vec<f64>>,
    /// The Lyapunov exponent; NaN if there is none.
    pub exponent: f64,
    /// At the end, the value of the expression that the colours show; NaN if they show none.
    pub value: f64,
    /// At the end, the values of the expressions of `--output`.
    pub outputs: Vec<f64>,
    /// At the start, the values of the expressions of `--contour`.
    pub contours: Vec<f64>,
    /// Details of the outcome.
    pub reason: String,
}

/// Runs a cell.
pub fn run(runner: &mut Runner<'_>, request: &Request, member: u64) -> Cell {
    let mut seen = Seen::new(request);
    match runner.watched(member, &mut seen) {
        Ok(ending) => finished(runner, request, seen, &ending),
        Err((outcome, reason)) => Cell {
            outcome,
            stop: None,
            returns: seen.returns,
            t: f64::NAN,
            end: vec![f64::NAN; request.components.names.len()],
            cycle: Vec::new(),
            exponent: f64::NAN,
            value: f64::NAN,
            outputs: vec![f64::NAN; request.outputs.len()],
            contours: vec![f64::NAN; request.contours.len()],
            reason: reason.replace(['\n', '\r'], " "),
        },
    }
}

fn finished(runner: &Runner<'_>, request: &Request, seen: Seen<'_>, ending: &Ending) -> Cell {
    let components = &request.components;
    let (outcome, end) = match (&seen.last, seen.has_failed) {
        (_, true) => (FAILED, &ending.last),
        (Some(last), false) if seen.has_returned() => (RETURNED, last),
        _ => (ending.outcome.kind(), &ending.last),
    };
    let returned = request.returns.as_ref();
    let returned = returned.filter(|_| outcome == RETURNED);
    let (mut cycle, mut exponent, mut reason) = (Vec::new(), f64::NAN, String::new());
    if let Some(returns) = returned {
        let recent: Vec<Return> = seen.recent.iter().cloned().collect();
        cycle = orbits::cycle(&recent, returns.period, components);
        match grown(runner, returns, cycle.len(), end) {
            Some(Ok(grown)) => exponent = grown,
            Some(Err(missed)) => reason = missed.replace(['\n', '\r'], " "),
            None => {}
        }
    } else if outcome != FAILED {
        reason = details(runner.model().description(), &ending.outcome);
    }
    let stop = match ending.outcome {
        Outcome::StoppedAt { surface, .. } => {
            names::surfaces(runner.model().description()).nth(surface)
        }
        _ => None,
    };
    Cell {
        outcome,
        stop,
        returns: seen.returns,
        t: ending.t,
        end: components.values(end),
        cycle,
        exponent,
        value: request.colours.value(end),
        outputs: (request.outputs.iter())
            .map(|(_, watched)| watched.value(end))
            .collect(),
        contours: request
            .contours
            .iter()
            .map(|line| line.value(&ending.first))
            .collect(),
        reason,
    }
}

/// The Lyapunov exponent from the last return on, if requested; the error explains why there is none. On an orbit, with a
/// period above 0, it follows from the multipliers.
fn grown(
    runner: &Runner<'_>,
    returns: &Returns,
    period: usize,
    last: &Point,
) -> Option<Result<f64, String>> {
    let mut search = returns.exponent.clone()?;
    let growth = match u32::try_from(period) {
        Ok(period) if period > 0 => {
            search.returns = period;
            Growth::OfOrbit
        }
        _ => Growth::OfDeviation,
    };
    let origin = Origin {
        q: last.q.clone(),
        rates: Rates::Velocities(last.qdot.clone()),
        policy: OffConstraint::Keep,
    };
    Some(match runner.model().exponent(&origin, &search, growth) {
        Ok(Some(Ok(exponent))) => Ok(exponent),
        Ok(Some(Err(error))) => {
            let remarks = outcome::remarks_on_orbit(runner.model().description(), &error);
            let reason = remarks.into_iter().find(|(title, _)| *title == "reason");
            Err(reason.map_or_else(|| error.to_string(), |(_, reason)| reason))
        }
        Ok(None) => Err("the scene has no variations".to_owned()),
        Err(refusal) => Err(refusal.to_string()),
    })
}

/// Watches a run.
struct Seen<'a> {
    request: &'a Request,
    has_begun: bool,
    has_failed: bool,
    returns: u64,
    /// The last returns, twice as many as the longest period has.
    recent: VecDeque<Return>,
    /// The state after the last requested return.
    last: Option<Point>,
    /// The time of the previous return; NaN before the first.
    before: f64,
}

impl<'a> Seen<'a> {
    fn new(request: &'a Request) -> Self {
        Self {
            request,
            has_begun: false,
            has_failed: false,
            returns: 0,
            recent: VecDeque::new(),
            last: None,
            before: f64::NAN,
        }
    }

    fn has_returned(&self) -> bool {
        let returns = self.request.returns.as_ref();
        returns.is_some_and(|wanted| self.returns >= wanted.count)
    }

    fn look(&mut self, point: &Point) {
        if let Some(fail) = &self.request.fail {
            self.has_failed |= fail.holds(point);
        }
    }
}

impl Watch for Seen<'_> {
    fn step(&mut self, piece: &dyn Piece) {
        if self.request.fail.is_none() {
            return;
        }
        let (start, end) = piece.span();
        if !self.has_begun {
            self.has_begun = true;
            self.look(&piece.at(start));
        }
        self.look(&piece.at(end));
    }

    fn impact(&mut self, impact: Impact) {
        self.look(&impact.after);
        let Some(returns) = &self.request.returns else {
            return;
        };
        if impact.surface != returns.surface || self.has_failed {
            return;
        }
        self.returns += 1;
        // Only the last returns are compared, twice as many as the longest period has.
        let left = returns.count.saturating_sub(self.returns);
        if left < 2 * returns.period as u64 {
            self.recent.push_back(Return {
                state: self.request.components.values(&impact.after),
                duration: impact.t - self.before,
            });
        }
        self.before = impact.t;
        if left == 0 {
            self.last = Some(impact.after);
        }
    }

    fn contact(&mut self, _contact: Contact) {}

    fn is_over(&self) -> bool {
        self.has_failed || self.has_returned()
    }
}
