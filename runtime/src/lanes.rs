//! Many runs of one scene with Taylor series, several in parallel in SIMD lanes.
//!
//! Each lane of a vector computes the series of one of eight motions. Impacts and other effects are computed for one
//! motion after the other. A lane whose run has ended takes the next run. Every run has the same bits as when it is run
//! alone.

use arrayvec::ArrayVec;
use wide::f64x8;

use crate::contract::{System, TaylorField};
use crate::effects::Effect;
use crate::integrate::lanes::{Abreast, MOST, Walker};
use crate::integrate::{Chosen, Counters, Stepper, Taylor};
use crate::outcome::{Outcome, StartError};
use crate::record::Observer;
use crate::run::Run;
use crate::simulation::{Course, Next, Progress, STEP_BUDGET, Simulation, check_start};

/// Largest number of motions that make their steps one by one. With more motions, vector steps are faster.
const FEW: usize = 2;

/// Largest storage, in bytes, for the series of all lanes. The storage lies on the stack, and access to data that
/// exceeds every cache is slow.
const LARGEST: usize = 1 << 18;

/// A run to be computed.
pub struct Member<'a, Sys: TaylorField, Effects, O> {
    tag: usize,
    system: &'a Sys,
    stepper: Taylor<Sys>,
    effects: Effects,
    observer: O,
    t: f64,
    state: Sys::State,
    t_end: f64,
    step_budget: u64,
    looks_inside: bool,
}

impl<'a, Sys: TaylorField, Effects, O> Member<'a, Sys, Effects, O> {
    /// A run of a system from `state` at `t` to `t_end`, as computed by [`Simulation::run`](crate::Simulation::run).
    /// `tag` identifies it to the caller. A run with an integrator of another order than the first lane makes its steps
    /// alone.
    pub fn new(
        tag: usize,
        system: &'a Sys,
        stepper: Taylor<Sys>,
        effects: Effects,
        observer: O,
        (t, state): (f64, Sys::State),
        t_end: f64,
    ) -> Self {
        Self {
            tag,
            system,
            stepper,
            effects,
            observer,
            t,
            state,
            t_end,
            step_budget: STEP_BUDGET,
            looks_inside: false,
        }
    }

    /// Sets the number of accepted steps after which the run ends, instead of [`STEP_BUDGET`].
    #[must_use]
    pub fn with_step_budget(mut self, budget: u64) -> Self {
        self.step_budget = budget;
        self
    }

    /// Declares that the observer evaluates states inside steps. Without it the observer may still do so, at the cost
    /// of computing the series of that step again.
    #[must_use]
    pub fn with_look_inside(mut self, looks_inside: bool) -> Self {
        self.looks_inside = looks_inside;
        self
    }
}

/// Computes the runs `members`. Calls `finished` with the tag and the result of each run, in the order in which they
/// end. Systems whose series take more than 256 KiB in eight lanes make their runs one after the other.
pub fn run_abreast<'a, Sys, Effects, O>(
    members: impl IntoIterator<Item = Member<'a, Sys, Effects, O>>,
    mut finished: impl FnMut(usize, Result<Run<Sys::State>, StartError>),
) where
    Sys: System + TaylorField + 'a,
    Effects: Effect<Sys>,
    O: Observer<Sys>,
{
    let members = members.into_iter();
    match size_of::<Abreast<Sys, f64x8>>() <= LARGEST {
        true => run_in_lanes(members, &mut finished),
        false => run_in_turn(members, &mut finished),
    }
}

#[inline(never)]
fn run_in_turn<'a, Sys, Effects, O>(
    members: impl Iterator<Item = Member<'a, Sys, Effects, O>>,
    finished: &mut impl FnMut(usize, Result<Run<Sys::State>, StartError>),
) where
    Sys: System + TaylorField + 'a,
    Effects: Effect<Sys>,
    O: Observer<Sys>,
{
    for member in members {
        let Member {
            tag,
            system,
            mut stepper,
            effects,
            mut observer,
            t,
            state,
            t_end,
            step_budget,
            looks_inside: _,
        } = member;
        let stepper = Chosen::new(&mut stepper);
        let mut simulation =
            Simulation::new(system, stepper, effects).with_step_budget(step_budget);
        finished(tag, simulation.run(t, state, t_end, &mut observer));
    }
}

#[inline(never)]
fn run_in_lanes<'a, Sys, Effects, O>(
    mut members: impl Iterator<Item = Member<'a, Sys, Effects, O>>,
    finished: &mut impl FnMut(usize, Result<Run<Sys::State>, StartError>),
) where
    Sys: System + TaylorField + 'a,
    Effects: Effect<Sys>,
    O: Observer<Sys>,
{
    let mut lanes: ArrayVec<Lane<'a, Sys, Effects, O>, MOST> = ArrayVec::new();
    let mut abreast: Option<Abreast<Sys, f64x8>> = None;
    loop {
        let mut is_new = false;
        let mut place = 0;
        while place < MOST {
            let Some(lane) = lanes.get_mut(place) else {
                let Some(member) = members.next() else { break };
                match Lane::begin(member) {
                    Ok(lane) => lanes.push(lane),
                    Err((tag, error)) => finished(tag, Err(error)),
                }
                continue;
            };
            match lane.reach_step() {
                Ok(was_ready) => {
                    is_new |= !was_ready;
                    place += 1;
                }
                Err(outcome) => {
                    let Lane {
                        member, progress, ..
                    } = lanes.swap_remove(place);
                    finished(member.tag, Ok(progress.ended(outcome)));
                    is_new = true;
                }
            }
        }
        if lanes.is_empty() {
            return;
        }
        let mut made = [false; MOST];
        if lanes.len() > FEW {
            let systems: ArrayVec<&Sys, MOST> =
                lanes.iter().map(|lane| lane.member.system).collect();
            is_new |= abreast.is_none();
            let abreast = abreast.get_or_insert_with(|| Abreast::new(systems[0]));
            if is_new {
                abreast.set_parameters(&systems);
            }
            made = abreast.step(&mut lanes);
        }
        for (lane, made) in lanes.iter_mut().zip(made) {
            lane.after_step(made);
        }
    }
}

/// A run in a lane.
struct Lane<'a, Sys: System + TaylorField, Effects, O> {
    member: Member<'a, Sys, Effects, O>,
    progress: Progress<Sys::State>,
    stage: Stage,
}

/// Next action of a run.
enum Stage {
    /// The actions before the first step.
    Begin,
    /// Restart the integrator.
    SetOff,
    /// A step.
    Step,
    /// The run has ended.
    Over(Outcome),
}

impl<'a, Sys, Effects, O> Lane<'a, Sys, Effects, O>
where
    Sys: System + TaylorField,
    Effects: Effect<Sys>,
    O: Observer<Sys>,
{
    fn begin(member: Member<'a, Sys, Effects, O>) -> Result<Self, (usize, StartError)> {
        match check_start(member.system, member.t, member.t_end) {
            Ok(()) => Ok(Self {
                progress: Progress::new(member.t, member.state),
                member,
                stage: Stage::Begin,
            }),
            Err(error) => Err((member.tag, error)),
        }
    }

    /// Advances the run until its next action is a step. True if it was a step already. The end of the run is an error.
    fn reach_step(&mut self) -> Result<bool, Outcome> {
        let was_ready = matches!(self.stage, Stage::Step);
        let (stepper, rest) = self.split();
        match Sys::IS_BEHIND_POINTERS {
            true => rest.reach_step(&mut Chosen::new(stepper)),
            false => rest.reach_step(stepper),
        }?;
        Ok(was_ready)
    }

    /// Processes a step and sets the next action. Makes the step first if the vector step did not include it.
    fn after_step(&mut self, was_made: bool) {
        let (stepper, rest) = self.split();
        match Sys::IS_BEHIND_POINTERS {
            true => rest.after_step(&mut Chosen::new(stepper), was_made),
            false => rest.after_step(stepper, was_made),
        }
    }

    /// The integrator, and the lane without it.
    fn split(&mut self) -> (&mut Taylor<Sys>, Rest<'_, Sys, Effects, O>) {
        let rest = Rest {
            system: self.member.system,
            effects: &mut self.member.effects,
            observer: &mut self.member.observer,
            t_end: self.member.t_end,
            budget: self.member.step_budget,
            progress: &mut self.progress,
            stage: &mut self.stage,
        };
        (&mut self.member.stepper, rest)
    }
}

/// A lane without its integrator.
struct Rest<'a, Sys: System, Effects, O> {
    system: &'a Sys,
    effects: &'a mut Effects,
    observer: &'a mut O,
    t_end: f64,
    budget: u64,
    progress: &'a mut Progress<Sys::State>,
    stage: &'a mut Stage,
}

impl<Sys: System, Effects: Effect<Sys>, O: Observer<Sys>> Rest<'_, Sys, Effects, O> {
    fn reach_step<Step: Stepper<Sys>>(self, stepper: &mut Step) -> Result<(), Outcome> {
        let Self {
            observer,
            t_end,
            stage,
            ..
        } = self;
        let mut course = Course {
            system: self.system,
            stepper,
            effects: self.effects,
            budget: self.budget,
            progress: self.progress,
        };
        loop {
            match stage {
                Stage::Over(outcome) => return Err(*outcome),
                Stage::Begin => course.begin(observer)?,
                Stage::SetOff | Stage::Step => {}
            }
            if course.progress.t >= t_end {
                return Err(Outcome::Done);
            }
            if let Some(forces) = course.effects.forces() {
                course.drive_under(forces, t_end, observer)?;
                *stage = Stage::SetOff;
                continue;
            }
            if !matches!(stage, Stage::Step) {
                course.set_off(t_end)?;
                *stage = Stage::Step;
            }
            return course.check_budget();
        }
    }

    fn after_step<Step: Stepper<Sys>>(self, stepper: &mut Step, was_made: bool) {
        let mut course = Course {
            system: self.system,
            stepper,
            effects: self.effects,
            budget: self.budget,
            progress: self.progress,
        };
        if !was_made {
            let counters = &mut course.progress.counters;
            let step = course.stepper.step(self.system, self.t_end, counters);
            if let Err(failure) = step {
                *self.stage = Stage::Over(failure.into());
                return;
            }
        }
        *self.stage = match course.go_on(&None, self.observer) {
            Ok(Next::Step) => Stage::Step,
            Ok(Next::Forces) => Stage::SetOff,
            Err(outcome) => Stage::Over(outcome),
        };
    }
}

impl<Sys: System + TaylorField, Effects, O> Walker<Sys> for Lane<'_, Sys, Effects, O> {
    fn taylor(&self) -> &Taylor<Sys> {
        &self.member.stepper
    }

    fn at_work(&mut self) -> (&mut Taylor<Sys>, &mut Counters) {
        (&mut self.member.stepper, &mut self.progress.counters)
    }

    fn field(&self) -> &Sys {
        self.member.system
    }

    fn t_end(&self) -> f64 {
        self.member.t_end
    }

    fn looks_inside(&self) -> bool {
        self.member.looks_inside
    }
}
