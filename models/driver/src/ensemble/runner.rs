//! Runs members. Every member has a row, even after a refusal or a panic.

use std::any::Any;
use std::borrow::Cow;
use std::ops::Range;
use std::panic::{AssertUnwindSafe, catch_unwind};

use dalembert::Outcome;
use dalembert::describe::Description;

use super::density::{Density, Sampler, Visits};
use super::members::Members;
use super::row::{Field, Row};
use super::values::Quantity;
use crate::beginning::{Beginning, Component};
use crate::course;
use crate::integrator::Integrator;
use crate::model::{AnyModel, Code, OffConstraint, Origin, Point, Together};
use crate::outcome::{self, Fact};
use crate::refusal::Refusal;
use crate::run::{Contact, Ending, Impact, ImpactTally, Piece, Settings, Watch};
use crate::words::{self, Advice};

/// The outcome of a member whose start the system refuses.
pub const REFUSED: &str = "refused";

/// The outcome of a member whose run panicked.
pub const PANICKED: &str = "panicked";

/// The model and the start that members have in common.
pub trait Common: Sync {
    /// The model, with the parameters that members share.
    ///
    /// # Errors
    /// A text that says why there is none.
    fn model(&self) -> Result<Box<dyn AnyModel>, String>;

    /// The start that members share. `model` may have the parameters of one of them.
    ///
    /// # Errors
    /// A text that says why there is none.
    fn beginning(&self, model: &dyn AnyModel) -> Result<Beginning, String>;

    /// Advice about starts that are refused.
    fn advice(&self) -> &Advice;

    /// True if the runs must stop. Their rows are then discarded.
    fn is_over(&self) -> bool {
        false
    }
}

/// Where the runs of an ensemble end.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum End {
    /// At the end time of the settings.
    Requested,
    /// Where the model says with the parameters of the member, or later for runs that end after a number of impacts or
    /// returns. The end time of the settings is that of the common parameters.
    Declared {
        /// This number.
        counted: Option<u64>,
    },
}

impl End {
    /// The end for a requested end time, if there is one, and a number of impacts or returns.
    pub fn of(until: Option<f64>, counted: Option<u64>) -> Self {
        match until {
            Some(_) => Self::Requested,
            None => Self::Declared { counted },
        }
    }
}

/// Data common to the runs of all members.
#[derive(Clone, Copy)]
pub struct Shared<'a> {
    /// The model and the start.
    pub common: &'a dyn Common,
    /// Policy for starts that violate constraints.
    pub off_constraint: OffConstraint,
    /// The settings of the runs.
    pub settings: &'a Settings,
    /// Where the runs end.
    pub end: End,
    /// The members.
    pub members: &'a Members,
    /// The density, if states are counted.
    pub density: Option<&'a Density>,
    /// Components of the start that are set to outputs of the model, each with the index of the output. The outputs are
    /// evaluated at the start with the other components as given.
    pub starts: &'a [(Component, usize)],
}

/// A finished member.
pub struct Done {
    /// Its row.
    pub row: Row,
    /// Its visits, if a density is counted.
    pub visits: Option<Visits>,
}

/// Runs members on one thread.
pub struct Runner<'a> {
    shared: Shared<'a>,
    model: Box<dyn AnyModel>,
}

impl<'a> Runner<'a> {
    /// A runner with the model of the members.
    ///
    /// # Errors
    /// A text that says why there is no model.
    pub fn new(shared: Shared<'a>) -> Result<Self, String> {
        let model = shared.common.model()?;
        Ok(Self { shared, model })
    }

    /// The model, with the parameters of the member run last.
    pub fn model(&self) -> &dyn AnyModel {
        self.model.as_ref()
    }

    /// True if [`Runner::run`] runs members in SIMD lanes: by power series that are compiled. Machine code for a model
    /// that is loaded from its text has no lanes; its interpreter has, but takes several times as long.
    pub fn is_abreast(&self) -> bool {
        self.shared.settings.integrator == Integrator::Taylor && self.model.code() != Code::Loaded
    }

    /// Runs members, in SIMD lanes if that is faster. Every row is the same as from a single run. If a run panics, all
    /// members are run one by one.
    pub fn run(&mut self, members: Range<u64>) -> Vec<Done> {
        if self.is_abreast() && members.end - members.start > 1 {
            let abreast = || self.abreast(members.clone());
            if let Ok(done) = catch_unwind(AssertUnwindSafe(abreast)) {
                return done;
            }
            self.renew();
        }
        members.map(|member| self.alone(member)).collect()
    }

    /// Runs members in SIMD lanes.
    fn abreast(&mut self, members: Range<u64>) -> Vec<Done> {
        let mut seen: Vec<Seen<'_>> = members.clone().map(|_| self.unseen()).collect();
        let (mut runs, mut refused) = (Vec::new(), Vec::new());
        for (member, seen) in members.clone().zip(&mut seen) {
            match self.origin(member) {
                // Runs in lanes end together.
                Ok(_) if self.until() != self.shared.settings.until => {
                    return members.map(|member| self.alone(member)).collect();
                }
                Ok(origin) => runs.push(Together {
                    parameters: self.parameters(),
                    origin,
                    watch: seen,
                }),
                Err(reason) => refused.push((member, reason)),
            }
        }
        let looks_inside = self.shared.density.is_some();
        let endings = self
            .model
            .simulate_abreast(runs, self.shared.settings, looks_inside);
        let endings = endings.into_iter();
        let mut endings: Vec<Result<Ending, String>> = endings
            .map(|ending| ending.map_err(|refusal| self.told(&refusal)))
            .collect();
        for (member, reason) in refused {
            endings.insert((member - members.start) as usize, Err(reason));
        }
        let endings = members.zip(endings).zip(seen);
        let endings = endings.map(|((member, ending), seen)| {
            let ended = ending.map_err(|reason| (REFUSED, reason));
            self.done(member, &ended, seen)
        });
        endings.collect()
    }

    /// Runs a member.
    fn alone(&mut self, member: u64) -> Done {
        let mut seen = self.unseen();
        let ended = self.watched(member, &mut seen);
        self.done(member, &ended, seen)
    }

    fn unseen(&self) -> Seen<'a> {
        Seen {
            common: self.shared.common,
            tally: ImpactTally::default(),
            sampler: self.shared.density.map(Sampler::new),
        }
    }

    fn done(
        &self,
        member: u64,
        ended: &Result<Ending, (&'static str, String)>,
        seen: Seen<'_>,
    ) -> Done {
        let visits = seen.sampler.map(|sampler| match ended {
            Ok(ending) => sampler.finish(ending.t, &ending.last),
            Err(_) => sampler.finish(
                f64::NEG_INFINITY,
                &Point::undefined(self.model.description()),
            ),
        });
        Done {
            row: self.row(member, ended, &seen.tally),
            visits,
        }
    }

    /// The values of all parameters of the model.
    fn parameters(&self) -> Vec<f64> {
        let count = self.model.description().parameters.len();
        (0..count)
            .map(|index| self.model.parameter(index))
            .collect()
    }

    /// Rebuilds the model after a panic, which may have left it inconsistent.
    fn renew(&mut self) {
        if let Ok(model) = self.shared.common.model() {
            self.model = model;
        }
    }

    /// Runs a member under observation. A member whose start is refused or whose run panics gives an outcome and a
    /// reason instead of an ending.
    pub fn watched(
        &mut self,
        member: u64,
        watch: &mut dyn Watch,
    ) -> Result<Ending, (&'static str, String)> {
        match catch_unwind(AssertUnwindSafe(|| self.attempt(member, watch))) {
            Ok(Ok(ending)) => Ok(ending),
            Ok(Err(reason)) => Err((REFUSED, reason)),
            Err(panic) => {
                self.renew();
                Err((PANICKED, message(panic.as_ref())))
            }
        }
    }

    /// Runs a member. The error says why it does not start.
    fn attempt(&mut self, member: u64, watch: &mut dyn Watch) -> Result<Ending, String> {
        let origin = self.origin(member)?;
        let (until, common) = (self.until(), self.shared.settings);
        if until != common.until && self.shared.density.is_some() {
            return Err(format!(
                "by the model's `until` this member ends at t = {until}; a density counts states of all members up to one time, which has to be given"
            ));
        }
        let settings = match until == common.until {
            true => Cow::Borrowed(common),
            false => Cow::Owned(Settings {
                until,
                ..common.clone()
            }),
        };
        let ended = self.model.simulate(&origin, &settings, watch);
        ended.map_err(|refusal| self.told(&refusal))
    }

    /// The end of the member whose parameters are set.
    fn until(&self) -> f64 {
        let declared = match self.shared.end {
            End::Requested => None,
            End::Declared { counted } => course::horizon(self.model.as_ref(), None, counted),
        };
        declared.unwrap_or(self.shared.settings.until)
    }

    /// The reason why a member does not start, in the model's names.
    fn told(&self, refusal: &Refusal) -> String {
        words::refusal_text(
            self.model.description(),
            refusal,
            self.shared.common.advice(),
        )
    }

    /// Sets the model's parameters to those of a member, and returns its initial state. The error says why there is
    /// none.
    fn origin(&mut self, member: u64) -> Result<Origin, String> {
        let Shared {
            common,
            members,
            off_constraint,
            ..
        } = self.shared;
        let values = members.values(member);
        let pairs = || members.quantities().iter().zip(&values);
        for (quantity, &value) in pairs() {
            if let Quantity::Parameter(index) = *quantity {
                self.model.set_parameter(index, value);
            }
        }
        let model = self.model.as_ref();
        let mut beginning = common.beginning(model)?;
        for (quantity, &value) in pairs() {
            match *quantity {
                Quantity::Position(index) => beginning.set_position(index, value),
                Quantity::Velocity(index) => beginning.set_velocity(index, value),
                Quantity::Parameter(_) => {}
            }
        }
        let told = |error| words::state_text(model.description(), &error, common.advice());
        let settled = beginning.settle(model, off_constraint);
        if self.shared.starts.is_empty() {
            return settled.map_err(told);
        }
        let point = settled
            .and_then(|origin| model.point(&origin))
            .map_err(told)?;
        for &(component, output) in self.shared.starts {
            beginning.set(component, point.outputs[output]);
        }
        beginning.settle(model, off_constraint).map_err(told)
    }

    fn row(
        &self,
        member: u64,
        ended: &Result<Ending, (&'static str, String)>,
        tally: &ImpactTally,
    ) -> Row {
        let description = self.model.description();
        let number = |value: f64| Field::Number(value);
        let mut row = vec![Field::Integer(member)];
        row.extend(self.shared.members.values(member).into_iter().map(number));
        let (kind, reason) = match ended {
            Ok(ending) => (ending.outcome.kind(), details(description, &ending.outcome)),
            Err((kind, reason)) => (*kind, reason.replace(['\n', '\r'], " ")),
        };
        row.push(Field::Text(Cow::Borrowed(kind)));
        let nothing = Point::undefined(description);
        let (t, last, change) = match ended {
            Ok(ending) => {
                let change = ending.last.energy - ending.first.energy;
                (ending.t, &ending.last, change)
            }
            Err(_) => (f64::NAN, &nothing, f64::NAN),
        };
        let state = last.q.iter().chain(&last.qdot).copied();
        let numbers = [t].into_iter().chain(state).chain([last.energy, change]);
        row.extend(numbers.chain(last.outputs.iter().copied()).map(number));
        let surfaces = 0..description.surfaces.len();
        row.extend(surfaces.map(|surface| Field::Integer(tally.on(surface))));
        row.push(Field::Integer(tally.contacts));
        let counters = ended.as_ref().map(|ending| ending.counters);
        let counters = outcome::counters(&counters.unwrap_or_default()).into_iter();
        row.extend(counters.map(|(_, count)| Field::Integer(count)));
        row.push(Field::Text(Cow::Owned(reason)));
        row
    }
}

/// The details of an outcome, as text.
pub fn details(description: &Description, outcome: &Outcome) -> String {
    let details = outcome::details(description, outcome);
    let details: Vec<String> = details
        .iter()
        .map(|(name, fact)| format!("{name} {}", spelt(fact)))
        .collect();
    details.join(", ")
}

/// A fact as text.
fn spelt(fact: &Fact) -> String {
    match fact {
        Fact::Number(number) => format!("{number:?}"),
        Fact::Index(index) => index.to_string(),
        Fact::Flag(flag) => flag.to_string(),
        Fact::Name(name) => (*name).to_owned(),
        Fact::List(facts) => {
            let facts: Vec<String> = facts
                .iter()
                .map(|fact| format!("{:?}", spelt(fact)))
                .collect();
            format!("[{}]", facts.join(","))
        }
    }
}

/// The message of a panic.
fn message(panic: &(dyn Any + Send)) -> String {
    let text = panic.downcast_ref::<&str>().copied();
    let text = text.or_else(|| panic.downcast_ref::<String>().map(String::as_str));
    text.unwrap_or("without a message").to_owned()
}

/// Observes a run for the member's row.
struct Seen<'a> {
    common: &'a dyn Common,
    tally: ImpactTally,
    sampler: Option<Sampler<'a>>,
}

impl Watch for Seen<'_> {
    fn step(&mut self, piece: &dyn Piece) {
        if let Some(sampler) = &mut self.sampler {
            sampler.follow(piece);
        }
    }

    fn hears(&mut self, impact: &Impact<()>) -> bool {
        self.tally.count(impact);
        false
    }

    fn impact(&mut self, _impact: Impact) {}

    fn contact(&mut self, contact: Contact) {
        self.tally.contacts += u64::from(contact.begins);
    }

    fn is_over(&self) -> bool {
        self.common.is_over()
    }
}
