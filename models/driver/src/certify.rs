//! Certified motion of a model: enclosures of times, positions and velocities, as plain data.
//!
//! The runtime computes the enclosures for an erased system of the largest capacity. Its form needs kernels over
//! intervals, which forms loaded from a text have.

mod start;

use std::ops::ControlFlow;
use std::panic::resume_unwind;
use std::thread;

use dalembert::certified::{CertifiedImpact, CertifiedRun, Lost};
use dalembert::erased;
use dalembert::law::Law;
use dalembert::numbers::{Interval, Row};
use dalembert::{Instance, TaylorField, Variational, VectorField};

use crate::integrator::Form;
use crate::model::Origin;
use crate::owner::Common;
use crate::refusal::{Refusal, Uncertified};

/// Stack size in bytes: four times the need of the longest vectors in unoptimised code.
const STACK: usize = 16 << 20;

/// Request for certified motion from `t = 0` on.
#[derive(Debug, Clone)]
pub struct Certification {
    /// The form of the equations.
    pub form: Form,
    /// The end time.
    pub until: f64,
    /// Stop after this many impacts.
    pub impacts: Option<u64>,
    /// Laws that replace the declared ones, by index of the surface. The last entry for a surface counts.
    pub laws: Vec<(usize, Law)>,
    /// Ranges that replace the values of parameters, by index. Without constraints, they move the values of the origin that
    /// are declared ones. A model with modes starts in the same state for all values of its parameters, and the ranges
    /// below are ignored.
    pub parameters: Vec<(usize, Interval)>,
    /// Ranges that replace the origin's positions, by index of the coordinate.
    pub positions: Vec<(usize, Interval)>,
    /// Ranges that replace velocities, by index: the origin's velocities in the global form of a model without
    /// constraints, quasi-velocities in the reduced form. They are ignored in other cases and if momenta are given.
    pub rates: Vec<(usize, Interval)>,
    /// Marks of the velocities that the origin names, one per coordinate; the others follow from the constraints. Empty
    /// if it names all.
    pub named: Vec<bool>,
}

/// Enclosures of positions and velocities, one range per coordinate. If the velocities may not exist for some state,
/// their ranges are the whole real line. The range of a coordinate that the mode does not have is NaN.
#[derive(Debug, Clone, PartialEq)]
pub struct Ranges {
    /// The name of the mode, for a model with modes.
    pub mode: Option<&'static str>,
    /// Positions.
    pub q: Vec<Interval>,
    /// Velocities.
    pub qdot: Vec<Interval>,
}

/// An impact that every motion from the start makes.
#[derive(Debug, Clone, PartialEq)]
pub struct Strike {
    /// The index of the surface.
    pub surface: usize,
    /// A range that contains the time of the impact for every motion.
    pub time: Interval,
    /// A range of all states before the impact.
    pub before: Ranges,
    /// A range of all states after the impact.
    pub after: Ranges,
}

/// The end of certified motion.
#[derive(Debug, Clone)]
pub struct Certified {
    /// The time up to which the motion is certified; the reported impacts are the only ones before it.
    pub t: f64,
    /// A range of all states at that time.
    pub last: Ranges,
    /// The number of impacts.
    pub impacts: u64,
    /// The number of steps.
    pub steps: u64,
    /// The reason why certification stopped before the requested end.
    pub lost: Option<Lost>,
}

/// A form with values for its parameters.
pub(crate) struct Subject<'a> {
    /// The form, if the model has one.
    pub form: Option<&'a erased::Form>,
    /// The values of all parameters, inputs included.
    pub values: &'a [f64],
    /// The origin.
    pub origin: &'a Origin,
    /// The state of the origin in the requested form.
    pub state: &'a [f64],
}

impl Subject<'_> {
    /// Encloses the motion on a thread with a large stack, and reports its impacts.
    pub(crate) fn certify(
        &self,
        request: &Certification,
        observer: &mut (dyn FnMut(&Strike) + Send),
    ) -> Result<Certified, Refusal> {
        thread::scope(|scope| {
            let work = || self.certify_here(request, observer);
            let thread = thread::Builder::new().stack_size(STACK);
            match thread.spawn_scoped(scope, work) {
                Ok(thread) => thread.join().unwrap_or_else(|panic| resume_unwind(panic)),
                Err(_) => Err(Uncertified::NoThread.into()),
            }
        })
    }

    /// Encloses the motion on the current thread.
    fn certify_here(
        &self,
        request: &Certification,
        observer: &mut dyn FnMut(&Strike),
    ) -> Result<Certified, Refusal> {
        let form = self.form.ok_or(Uncertified::Compiled)?;
        let mut system = Common::of(form)?;
        for (index, value) in self.values.iter().enumerate() {
            system.set_parameter(index, *value);
        }
        let declared = system.form();
        if request.form == Form::Global {
            system = system.global().ok_or(Uncertified::Compiled)?;
        }
        let form = system.form();
        // For a model with modes, the form of its first mode.
        let known = form.forms.first().map_or(form, |first| first);
        if known.kernels::<Interval>().is_none() {
            let why = match (form.tables.varies, declared.tables.varies) {
                (true, _) => Uncertified::Compiled,
                (false, true) => Uncertified::OnlyReduced,
                (false, false) => Uncertified::WithoutVariations,
            };
            return Err(why.into());
        }
        let parameters = start::parameters(&system, &request.parameters);
        let start = start::ranges(self, &system, request)?;
        let shown = Shown {
            system: &system,
            parameters,
        };
        let mut run = CertifiedRun::new(&system, 0.0, |i| start[i]);
        for &(index, range) in &request.parameters {
            run = run.with_parameter(index, range);
        }
        for &(surface, law) in &request.laws {
            run = run.with_law(surface, law);
        }
        let mut count = 0;
        let ended = run.run(request.until, |impact| {
            observer(&shown.strike(impact));
            count += 1;
            match request.impacts.is_some_and(|most| count >= most) {
                true => ControlFlow::Break(()),
                false => ControlFlow::Continue(()),
            }
        });
        let t = run.t();
        Ok(Certified {
            t,
            last: shown.ranges(Interval::point(t), |i| run.component(i)),
            impacts: run.impacts(),
            steps: run.steps(),
            lost: ended.err(),
        })
    }
}

/// A system with ranges for its parameters.
struct Shown<'a> {
    system: &'a Common<'a>,
    parameters: <Common<'a> as TaylorField>::Parameters<Interval>,
}

impl Shown<'_> {
    fn strike(&self, impact: &CertifiedImpact<Common<'_>>) -> Strike {
        Strike {
            surface: impact.surface,
            time: impact.time,
            before: self.ranges(impact.time, |i| impact.before(i)),
            after: self.ranges(impact.time, |i| impact.after(i)),
        }
    }

    /// Positions and velocities of all states of a box.
    fn ranges(&self, times: Interval, component: impl Fn(usize) -> Interval) -> Ranges {
        let mut state =
            <Common<'_> as TaylorField>::Row::<Interval>::zeros(self.system.state_len());
        for (i, entry) in state.as_mut_slice().iter_mut().enumerate() {
            *entry = component(i);
        }
        let n = self.system.form().tables.dimensions.coordinates;
        let velocities = self.system.velocities(&self.parameters, times, &state);
        let qdot = match velocities {
            Ok(velocities) => velocities.as_slice().to_vec(),
            Err(_) => vec![Interval::WHOLE; n],
        };
        let modes = &self.system.description().modes;
        let number = state.as_slice().last().map_or(0.0, |last| last.middle());
        let Some(mode) = modes.get((number + 0.5) as usize) else {
            let q = state.as_slice()[..n].to_vec();
            let mode = None;
            return Ranges { mode, q, qdot };
        };
        let absent = Interval::new(f64::NAN, f64::NAN);
        let mut ranges = Ranges {
            mode: Some(mode.name),
            q: vec![absent; n],
            qdot: vec![absent; n],
        };
        for (range, &place) in state.as_slice().iter().zip(&mode.coordinates) {
            ranges.q[place] = *range;
            ranges.qdot[place] = qdot[place];
        }
        ranges
    }
}
