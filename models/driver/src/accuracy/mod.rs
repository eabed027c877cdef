//! The cost of accuracy: measured errors of integrators at several tolerances, with work and time, and the choice of
//! the fastest integrator for a wanted error.
//!
//! Errors are measured, never estimated. The error of a run is the largest relative difference of a position or of the
//! end time from a reference run. Positions are compared at the ends of [`TIMES`] equal intervals and at the end of the
//! run, relative to the largest absolute value of the coordinate at these times (for an angle, at least one radian).
//! The reference is a run of Taylor series at [`FINEST`]; a second run with other steps bounds its accuracy
//! ([`Study::floor`]). Both are audited ([`dalembert::audit`]): the audit proves, independently of event location, that
//! they miss no impact. Without a confirmed reference nothing is measured.
//!
//! ```
//! use dalembert::{System};
//! use dalembert_driver::accuracy::choose;
//!
//! dalembert::model! {
//!     /// A pendulum.
//!     pub Pendulum {
//!         coordinates { theta: angle; }
//!         lagrangian = dot(theta)^2/2 + cos(theta);
//!     }
//! }
//!
//! fn main() -> Result<(), Box<dyn std::error::Error>> {
//!     let pendulum = Pendulum {};
//!     let state = pendulum.state(0.0, &[2.0].into(), &[0.0].into())?;
//!     let choice = choose(&pendulum, &state, 10.0, 1e-6)?;
//!     assert!(choice.error <= 1e-6);
//!     println!("{} at {:e}", choice.integrator.name(), choice.tol);
//!     Ok(())
//! }
//! ```

mod probe;
mod verdict;

use std::time::{Duration, Instant};

use dalembert::audit::Finding;
use dalembert::integrate::{Counters, counted_work};
use dalembert::{Outcome, Policies, Run, SceneEffects, StateVector, TaylorField};
use thiserror::Error;

use crate::integrator::{Form, Integrator};
use crate::refusal::Refusal;
use crate::run::{self, Settings};
use crate::typed::Model;
use probe::{Audited, Probe, Track};
pub use verdict::Verified;
pub(crate) use verdict::verify;

/// Number of equal intervals between the times at which positions are compared.
pub const TIMES: u64 = 64;

/// Longest duration of a run that chooses its steps, over that of a run with a fixed step. Steps that are chosen are seldom
/// slower for the same error, so that other integrators need not be measured as far.
const ADAPTIVE: u32 = 5;

/// Times whose ratio is below this number are equal: two timings of the same case differ by as much.
const EQUAL: f64 = 1.05;

/// The tolerances of the two reference runs. Both are below the unit of rounding, so that the runs differ by rounding only.
pub const FINEST: [f64; 2] = [1e-16, 1e-18];

/// Plan of the measurements.
#[derive(Debug, Clone)]
pub struct Plan {
    /// The end time of the runs, which start at `t = 0`.
    pub until: f64,
    /// The integrators.
    pub integrators: Vec<Integrator>,
    /// The tolerances, from loose to tight. A fixed-step integrator takes a step that suits the tolerance at the start
    /// of the run.
    pub tolerances: Vec<f64>,
    /// Largest number of timings of each case. The cases take turns, so that a slow moment of the machine affects all of
    /// them.
    pub rounds: u32,
    /// Time of all measurements. Once it is used up, a case that has been timed is not timed again.
    pub budget: Duration,
    /// The least duration of one timing. Shorter runs are repeated.
    pub least: Duration,
    /// Longest duration of a run with a fixed step; five times as long for other integrators. An integrator that exceeds
    /// it is not run at tighter tolerances, which take even longer.
    pub patience: Duration,
    /// An error that is small enough: an integrator that reaches it is not run at tighter tolerances.
    pub enough: Option<f64>,
}

impl Plan {
    /// Every integrator at tolerances of 1e-3 to 1e-15, in about five seconds.
    pub fn new(until: f64) -> Self {
        Self {
            until,
            integrators: Integrator::every().to_vec(),
            tolerances: (3..=15).map(power_of_ten).collect(),
            rounds: 5,
            budget: Duration::from_secs(5),
            least: Duration::from_millis(2),
            patience: Duration::from_millis(50),
            enough: None,
        }
    }
}

/// `10^-decade`, correctly rounded.
fn power_of_ten(decade: u32) -> f64 {
    format!("1e-{decade}").parse().unwrap_or(f64::NAN)
}

/// An integrator at a tolerance, with its measured error, work and time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    /// The integrator.
    pub integrator: Integrator,
    /// The tolerance.
    pub tol: f64,
    /// Its step, for an integrator of fixed step.
    pub step: Option<f64>,
    /// The measured error.
    pub error: f64,
    /// True if the run meets the same surfaces as the reference and ends for the same reason.
    pub agrees: bool,
    /// The outcome of its run.
    pub outcome: Outcome,
    /// The time at its end.
    pub t: f64,
    /// The work, by kind.
    pub counters: Counters,
    /// The work in multiplications ([`counted_work`]), without the search for impacts; NaN if it is not known for the model.
    pub work: f64,
    /// Microseconds per unit of time of the model, as the median of several timings.
    pub microseconds: f64,
}

/// Results of the measurements.
#[derive(Debug, Clone, PartialEq)]
pub struct Study {
    /// The requested end time of the runs.
    pub until: f64,
    /// Difference between the two reference runs: errors below it cannot be distinguished from 0.
    pub floor: f64,
    /// The reason, in words, why the impacts of the reference are not confirmed. `samples` is then empty.
    pub doubt: Option<String>,
    /// The outcome of the reference.
    pub outcome: Outcome,
    /// The impacts of the reference.
    pub impacts: u64,
    /// The cases, by integrator and from loose to tight.
    pub samples: Vec<Sample>,
    /// Integrators that were left out, each with the reason.
    pub absent: Vec<(Integrator, String)>,
}

/// Reasons why no case can be chosen.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum NoChoice {
    /// The runs did not begin.
    #[error(transparent)]
    Start(#[from] Refusal),
    /// No reference is confirmed, so errors cannot be measured.
    #[error("the impacts of the reference are not confirmed: {0}")]
    Unconfirmed(String),
    /// No measured case is accurate enough.
    #[error(
        "no run has an error below {wanted:e}: the least error is {least:e}, and the accuracy of the reference is {floor:e}"
    )]
    OutOfReach {
        /// The wanted error.
        wanted: f64,
        /// The least error of all.
        least: f64,
        /// Accuracy of the reference ([`Study::floor`]).
        floor: f64,
    },
}

impl Study {
    /// The fastest case with an error of at most `wanted` that agrees with the reference. Of cases that are less than 5 %
    /// slower than the fastest one, it is that with the least counted work.
    ///
    /// # Errors
    /// [`NoChoice::OutOfReach`] if no case reaches the error, or if the reference itself is less accurate;
    /// [`NoChoice::Unconfirmed`] without a confirmed reference.
    pub fn choose(&self, wanted: f64) -> Result<&Sample, NoChoice> {
        if let Some(doubt) = &self.doubt {
            return Err(NoChoice::Unconfirmed(doubt.clone()));
        }
        let reached = self
            .samples
            .iter()
            .filter(|it| it.agrees && it.error <= wanted);
        let fastest = reached
            .clone()
            .map(|it| it.microseconds)
            .fold(f64::INFINITY, f64::min);
        let best = reached
            .filter(|it| it.microseconds <= EQUAL * fastest)
            .min_by(|a, b| {
                let by_time = a.microseconds.total_cmp(&b.microseconds);
                a.work.total_cmp(&b.work).then(by_time)
            });
        let agreeing = self.samples.iter().filter(|it| it.agrees);
        let least = agreeing.map(|it| it.error).fold(f64::INFINITY, f64::min);
        let floor = self.floor;
        best.filter(|_| floor <= wanted)
            .ok_or(NoChoice::OutOfReach {
                wanted,
                least,
                floor,
            })
    }

    /// The fastest case for each error `10^-1` to `10^-16` that a case reaches, from loose to tight.
    pub fn cheapest(&self) -> Vec<(f64, &Sample)> {
        let decades = (1..=16).map(power_of_ten);
        decades
            .filter_map(|decade| Some((decade, self.choose(decade).ok()?)))
            .collect()
    }
}

/// Chooses integrator and tolerance for a wanted error over a horizon by measuring all of them.
///
/// `state` is a state of `scene`.
///
/// # Errors
/// [`NoChoice`] if the runs do not start, the reference is not confirmed, or no case reaches the error.
pub fn choose<M: Model>(
    scene: &M,
    state: &M::State,
    horizon: f64,
    wanted: f64,
) -> Result<Sample, NoChoice> {
    let plan = Plan {
        enough: Some(wanted),
        ..Plan::new(horizon)
    };
    let study = measure(scene, state, &plan)?;
    study.choose(wanted).copied()
}

/// Makes the measurements of a plan.
///
/// # Errors
/// [`Refusal`] if the reference does not start.
pub fn measure<M: Model>(scene: &M, state: &M::State, plan: &Plan) -> Result<Study, Refusal> {
    let base = Settings {
        form: Form::Reduced,
        integrator: Integrator::Taylor,
        tol: FINEST[0],
        step: None,
        max_step: None,
        steps: None,
        until: plan.until,
        impacts: None,
        laws: Vec::new(),
        policies: Policies::default(),
        projection: None,
    };
    study(scene, state, &base, plan, &mut |_| {})
}

/// A case before it is timed.
struct Case {
    sample: Sample,
    settings: Settings,
    repeats: u32,
    times: Vec<f64>,
}

/// Makes the measurements of a plan. All settings except integrator and tolerance come from `base`. Calls `tell` before
/// each measurement.
pub(crate) fn study<M: Model>(
    model: &M,
    state: &M::State,
    base: &Settings,
    plan: &Plan,
    tell: &mut dyn FnMut(&str),
) -> Result<Study, Refusal> {
    let begun = Instant::now();
    tell("reference");
    let reference = reference(model, state, base)?;
    let mut cases: Vec<Case> = Vec::new();
    let mut absent = Vec::new();
    let integrators = match reference.doubt {
        None => plan.integrators.as_slice(),
        Some(_) => &[],
    };
    for &integrator in integrators {
        let mut ladder = Ladder::new(plan, &reference);
        let end = ladder.climb(model, state, base, integrator, tell);
        cases.append(&mut ladder.cases);
        absent.extend(end.err().map(|reason| (integrator, reason)));
    }
    let rounds = if cases.is_empty() { 0 } else { plan.rounds };
    for round in 0..rounds {
        if round > 0 && begun.elapsed() >= plan.budget {
            break;
        }
        tell(&format!("timing, round {} of {}", round + 1, plan.rounds));
        for case in &mut cases {
            if case.times.is_empty() || begun.elapsed() < plan.budget {
                case.time(model, state)?;
            }
        }
    }
    Ok(Study {
        until: plan.until,
        floor: reference.floor,
        doubt: reference.doubt,
        outcome: reference.track.outcome,
        impacts: reference.track.counters.impacts,
        samples: cases.into_iter().map(Case::timed).collect(),
        absent,
    })
}

/// The cases of one integrator, from loose to tight.
struct Ladder<'a> {
    plan: &'a Plan,
    reference: &'a Reference,
    cases: Vec<Case>,
}

impl<'a> Ladder<'a> {
    fn new(plan: &'a Plan, reference: &'a Reference) -> Self {
        Self {
            plan,
            reference,
            cases: Vec::new(),
        }
    }

    /// Runs the cases up to the first that is accurate enough or takes too long. The error says why the remaining
    /// tolerances are left out.
    fn climb<M: Model>(
        &mut self,
        model: &M,
        state: &M::State,
        base: &Settings,
        integrator: Integrator,
        tell: &mut dyn FnMut(&str),
    ) -> Result<(), String> {
        let patience = match integrator.is_adaptive() {
            true => self.plan.patience.saturating_mul(ADAPTIVE),
            false => self.plan.patience,
        };
        for &tol in &self.plan.tolerances {
            tell(&format!("{} at {tol:e}", integrator.name()));
            let settings = Settings {
                integrator,
                tol,
                ..base.clone()
            };
            let begun = Instant::now();
            let track = track(model, state, &settings).map_err(|refusal| refusal.to_string())?;
            let once = begun.elapsed();
            // Automatic steps are powers of two, so that two tolerances may have the same step.
            let last = self.cases.last().and_then(|case| case.sample.step);
            if track.step.is_some() && track.step == last {
                continue;
            }
            let work = TaylorField::work(model);
            let work = work.map_or(f64::NAN, |work| counted_work(&track.counters, work));
            let case = case(track, settings, self.reference, (once, work), self.plan);
            let Sample { agrees, error, .. } = case.sample;
            self.cases.push(case);
            if self
                .plan
                .enough
                .is_some_and(|enough| agrees && error <= enough)
            {
                break;
            }
            if once > patience {
                return Err(format!(
                    "tolerances below {tol:e} are left out, because a run takes more than {once:.0?}"
                ));
            }
        }
        Ok(())
    }
}

fn case(
    track: Track,
    settings: Settings,
    reference: &Reference,
    (once, work): (Duration, f64),
    plan: &Plan,
) -> Case {
    let repeats = (plan.least.as_secs_f64() / once.as_secs_f64().max(1e-9)).ceil();
    Case {
        sample: Sample {
            integrator: settings.integrator,
            tol: settings.tol,
            step: track.step,
            error: track.distance(&reference.track),
            agrees: track.ends_as(&reference.track),
            outcome: track.outcome,
            t: track.t,
            counters: track.counters,
            work,
            microseconds: f64::NAN,
        },
        settings,
        repeats: repeats.max(1.0) as u32,
        times: Vec::new(),
    }
}

impl Case {
    fn time<M: Model>(&mut self, model: &M, state: &M::State) -> Result<(), Refusal> {
        let begun = Instant::now();
        for _ in 0..self.repeats {
            let solved = run::solve(model, state, &self.settings, &mut ())?;
            std::hint::black_box(solved.run.state);
        }
        let seconds = begun.elapsed().as_secs_f64() / f64::from(self.repeats);
        // A run of length 0 counts as one unit of time.
        let length = if self.sample.t > 0.0 {
            self.sample.t
        } else {
            1.0
        };
        self.times.push(seconds * 1e6 / length);
        Ok(())
    }

    fn timed(mut self) -> Sample {
        self.times.sort_by(f64::total_cmp);
        let middle = self.times.get(self.times.len() / 2);
        Sample {
            microseconds: middle.copied().unwrap_or(f64::NAN),
            ..self.sample
        }
    }
}

/// The run against which the others are measured.
struct Reference {
    track: Track,
    floor: f64,
    /// The reason why its impacts are not confirmed.
    doubt: Option<String>,
}

/// Runs the model twice. The second run starts at a state that differs by rounding, and has shorter steps. Otherwise the
/// arithmetic of both would be the same where the motion between impacts is a polynomial in time, and would not show how
/// impacts amplify rounding.
fn reference<M: Model>(model: &M, state: &M::State, base: &Settings) -> Result<Reference, Refusal> {
    let [finest, second] = FINEST.map(|tol| Settings {
        integrator: Integrator::Taylor,
        tol,
        step: None,
        steps: None,
        ..base.clone()
    });
    let track = audited(model, state, &finest, base.until)?;
    let mean = track.t / track.counters.accepted.max(1) as f64;
    let shorter = Settings {
        max_step: match second.max_step {
            Some(step) => Some(step.min(SHORTER * mean)),
            None => Some(SHORTER * mean),
        }
        .filter(|step| *step > 0.0),
        ..second
    };
    // The rounding of impacts, also that of their times, adds up like a random walk.
    let units = 1.0 + (track.counters.impacts as f64).sqrt();
    let other = rounded_otherwise(model, state, units);
    let second = audited(model, &other, &shorter, base.until)?;
    let names = ["the reference", "a second reference, with other rounding,"];
    let doubt = track
        .doubt(names[0])
        .or_else(|| second.doubt(names[1]))
        .or_else(|| track.difference_from(&second, names));
    let floor = match second.ends_as(&track) {
        true => second.distance(&track),
        false => f64::INFINITY,
    };
    Ok(Reference {
        track,
        floor,
        doubt,
    })
}

/// Largest step of the second reference, over the mean step of the first.
const SHORTER: f64 = 0.7;

/// A state whose momenta or quasi-velocities, or for a first-order system whose positions, differ by this number of units of
/// rounding, in turn up and down. Other positions stay, because a start may lie on a surface.
fn rounded_otherwise<M: Model>(model: &M, state: &M::State, units: f64) -> M::State {
    let mut other = *state;
    let components = other.as_mut_slice();
    // The last component of a state with modes is the number of the mode.
    let count = components.len() - usize::from(!model.description().modes.is_empty());
    let positions = model.description().coordinates.len();
    let from = match positions < count {
        true => positions,
        false => 0,
    };
    for (k, component) in components[from..count].iter_mut().enumerate() {
        // The neighbours of 0 are no rounding of it.
        let unit = match *component {
            0.0 => 0.0,
            value => value.next_up() - value,
        };
        *component += match k % 2 {
            0 => units * unit,
            _ => -units * unit,
        };
    }
    other
}

fn track<M: Model>(model: &M, state: &M::State, settings: &Settings) -> Result<Track, Refusal> {
    let mut probe = Probe::new(model, settings.until);
    let solved = run::solve(model, state, settings, &mut probe)?;
    Ok(probe.track(&solved, Audited::Not))
}

/// Relative difference between times up to which a finding or an impact belongs to the end of a run.
const AT_END: f64 = 1e-10;

/// True if an audit found what the run ends with: a surface that begins to count with the motion behind it.
fn is_end<S>(finding: Finding, run: &Run<S>) -> bool {
    match (finding, run.outcome) {
        (Finding::MayBeMet { surface, t }, Outcome::BeginsBehind { surface: ended, .. }) => {
            surface == ended && (t - run.t).abs() <= AT_END * run.t.abs()
        }
        _ => false,
    }
}

/// Runs a model under an audit of its impacts; the track has positions up to the time `until`.
fn audited<M: Model>(
    model: &M,
    state: &M::State,
    settings: &Settings,
    until: f64,
) -> Result<Track, Refusal> {
    let (effects, laws) = run::effects(model, settings);
    let mut audited = None;
    let has_audit = effects.audit(model, &mut |audit| {
        let mut probe = Probe::new(model, until);
        let solved = run::solve(model, state, settings, &mut (&mut probe, &mut *audit));
        let finding = audit.finding();
        audited = Some(solved.map(|solved| {
            let result = match finding {
                Some(finding) if !is_end(finding, &solved.run) => Audited::Doubted(finding),
                _ => Audited::Confirmed,
            };
            probe.track(&solved, result)
        }));
    });
    if let Some(track) = audited.filter(|_| has_audit) {
        return track;
    }
    let mut probe = Probe::new(model, until);
    let solved = run::solve(model, state, settings, &mut probe)?;
    Ok(probe.track(
        &solved,
        match laws.iter().all(Option::is_none) {
            true => Audited::Confirmed,
            false => Audited::Impossible,
        },
    ))
}
