//! What accuracy costs: the measured error of integrators over tolerances, with the work and the time they take, and
//! which of them is the cheapest for an error that is wanted.
//!
//! An error is measured, never estimated: it is the largest difference of a position from a reference run at
//! [`TIMES`] equally spaced times and at the end, as a share of the largest absolute value that this coordinate takes
//! there (of an angle, at least one radian). The reference is a run of Taylor series at [`FINEST`]; a second one with
//! other steps shows how far it can be trusted, which is the [`Study::floor`]. Both are audited ([`dalembert::audit`]): that they
//! miss no impact is shown without the search that finds impacts. Nothing is measured by a reference that is not confirmed.
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

use dalembert::integrate::Counters;
use dalembert::{Outcome, Policies, SceneEffects};
use thiserror::Error;

use crate::integrator::{Form, Integrator};
use crate::refusal::Refusal;
use crate::run::{self, Settings};
use crate::typed::Model;
use probe::{Audited, Probe, Track};
pub use verdict::Verified;
pub(crate) use verdict::verify;

/// Equally spaced times at which positions are compared.
pub const TIMES: u64 = 64;

/// The tolerances of the two reference runs: below rounding, so that their steps differ and nothing else does.
pub const FINEST: [f64; 2] = [1e-16, 1e-18];

/// What is measured.
#[derive(Debug, Clone)]
pub struct Plan {
    /// How long the runs are, from `t = 0`.
    pub until: f64,
    /// The integrators.
    pub integrators: Vec<Integrator>,
    /// The tolerances, from loose to tight. An integrator of fixed step takes the step that suits one where the run
    /// starts.
    pub tolerances: Vec<f64>,
    /// How often each case is timed; the cases take turns, so that a slow moment of the machine meets all of them.
    pub rounds: u32,
    /// The least time of one timing: shorter runs are repeated.
    pub least: Duration,
    /// A run that takes longer is the last of its integrator: tighter tolerances take longer still.
    pub patience: Duration,
    /// So is one whose error is at most this, if that is enough.
    pub enough: Option<f64>,
}

impl Plan {
    /// Every integrator at tolerances of 1e-3 to 1e-15.
    pub fn new(until: f64) -> Self {
        Self {
            until,
            integrators: Integrator::every().to_vec(),
            tolerances: (3..=15).map(power_of_ten).collect(),
            rounds: 5,
            least: Duration::from_millis(2),
            patience: Duration::from_secs(1),
            enough: None,
        }
    }
}

/// `10^-decade`, correctly rounded.
fn power_of_ten(decade: u32) -> f64 {
    format!("1e-{decade}").parse().unwrap_or(f64::NAN)
}

/// An integrator at a tolerance, and what it reached.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    /// The integrator.
    pub integrator: Integrator,
    /// The tolerance.
    pub tol: f64,
    /// Its step, if it keeps one.
    pub step: Option<f64>,
    /// The measured error.
    pub error: f64,
    /// True if it met the same surfaces as the reference, and ended as it did.
    pub agrees: bool,
    /// How it ended.
    pub outcome: Outcome,
    /// When.
    pub t: f64,
    /// The work.
    pub counters: Counters,
    /// Microseconds per unit of time of the model, the median of several.
    pub microseconds: f64,
}

/// What was measured.
#[derive(Debug, Clone, PartialEq)]
pub struct Study {
    /// How long the runs were meant to be.
    pub until: f64,
    /// What two reference runs differ by: smaller errors are not told from 0.
    pub floor: f64,
    /// Why the impacts of the reference are not confirmed, in words; there are no cases then.
    pub doubt: Option<String>,
    /// How the reference ended.
    pub outcome: Outcome,
    /// The impacts of the reference.
    pub impacts: u64,
    /// The cases, by integrator and from loose to tight.
    pub samples: Vec<Sample>,
    /// Integrators that were left out, and why.
    pub absent: Vec<(Integrator, String)>,
}

/// Why there is no choice.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum NoChoice {
    /// The runs did not begin.
    #[error(transparent)]
    Start(#[from] Refusal),
    /// There is no reference to measure errors by.
    #[error("the reference is not confirmed: {0}")]
    Unconfirmed(String),
    /// Nothing that was measured is as accurate.
    #[error(
        "no run has an error below {wanted:e}; the least is {least:e}, and the reference is known to {floor:e}"
    )]
    OutOfReach {
        /// What was wanted.
        wanted: f64,
        /// The least error of all.
        least: f64,
        /// How far the reference can be trusted.
        floor: f64,
    },
}

impl Study {
    /// The fastest of the cases that reach an error, and end as the reference does.
    ///
    /// # Errors
    /// [`NoChoice::OutOfReach`] if there is none, or the reference itself is not known as well as that;
    /// [`NoChoice::Unconfirmed`] without a reference.
    pub fn choose(&self, wanted: f64) -> Result<&Sample, NoChoice> {
        if let Some(doubt) = &self.doubt {
            return Err(NoChoice::Unconfirmed(doubt.clone()));
        }
        let reached = self
            .samples
            .iter()
            .filter(|it| it.agrees && it.error <= wanted);
        let best = reached.min_by(|a, b| a.microseconds.total_cmp(&b.microseconds));
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

    /// The fastest case of each decade of errors that one reaches, from loose to tight.
    pub fn cheapest(&self) -> Vec<(f64, &Sample)> {
        let decades = (1..=16).map(power_of_ten);
        decades
            .filter_map(|decade| Some((decade, self.choose(decade).ok()?)))
            .collect()
    }
}

/// The integrator and the tolerance to take for a wanted error over a horizon, by measuring all of them.
///
/// The state is one of the scene; both stay as they are.
///
/// # Errors
/// [`NoChoice`].
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

/// Measures what a plan asks for.
///
/// # Errors
/// Why the reference does not begin.
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

/// Measures, with everything but integrator and tolerance taken from `base`; tells what it is about to do.
pub(crate) fn study<M: Model>(
    model: &M,
    state: &M::State,
    base: &Settings,
    plan: &Plan,
    tell: &mut dyn FnMut(&str),
) -> Result<Study, Refusal> {
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
        tell(&format!("timing, round {} of {}", round + 1, plan.rounds));
        for case in &mut cases {
            case.time(model, state)?;
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

    /// Makes them, up to the first that is accurate enough or takes too long; why there are no more.
    fn climb<M: Model>(
        &mut self,
        model: &M,
        state: &M::State,
        base: &Settings,
        integrator: Integrator,
        tell: &mut dyn FnMut(&str),
    ) -> Result<(), String> {
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
            // Steps are halved or doubled to suit a tolerance: two of them may suit the same.
            let last = self.cases.last().and_then(|case| case.sample.step);
            if track.step.is_some() && track.step == last {
                continue;
            }
            let case = case(track, settings, self.reference, once, self.plan);
            let Sample { agrees, error, .. } = case.sample;
            self.cases.push(case);
            if self
                .plan
                .enough
                .is_some_and(|enough| agrees && error <= enough)
            {
                break;
            }
            if once > self.plan.patience {
                return Err(format!(
                    "tolerances below {tol:e} take more than {once:.0?} a run"
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
    once: Duration,
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
        // Of a run that ends where it begins, the time of the run.
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

/// A run that others are measured by.
struct Reference {
    track: Track,
    floor: f64,
    /// Why its impacts are not confirmed.
    doubt: Option<String>,
}

fn reference<M: Model>(model: &M, state: &M::State, base: &Settings) -> Result<Reference, Refusal> {
    let [first, second] = FINEST.map(|tol| {
        let settings = Settings {
            integrator: Integrator::Taylor,
            tol,
            step: None,
            steps: None,
            ..base.clone()
        };
        audited(model, state, &settings, base.until)
    });
    let (track, second) = (first?, second?);
    let names = ["the reference", "one with other steps"];
    let of_track = |track: &Track, name: &str| Some(format!("{name}: {}", track.doubt()?));
    let doubt = of_track(&track, names[0])
        .or_else(|| of_track(&second, names[1]))
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

fn track<M: Model>(model: &M, state: &M::State, settings: &Settings) -> Result<Track, Refusal> {
    let mut probe = Probe::new(model, settings.until);
    let solved = run::solve(model, state, settings, &mut probe)?;
    Ok(probe.track(&solved, Audited::Not))
}

/// The track of a run, with positions up to a time, under an audit of its impacts.
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
        let result = match audit.finding() {
            None => Audited::Confirmed,
            Some(finding) => Audited::Doubted(finding),
        };
        audited = Some(solved.map(|solved| probe.track(&solved, result)));
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
