//! Steps of several motions in SIMD lanes. Each motion has the same bits as in a run of its own.
//!
//! The series and the sums over them, which dominate the cost of a step, are computed in lanes. The decisions about a
//! step (its length, its acceptance) are made for one motion after the other. A motion that needs special treatment,
//! for example a shorter step, makes its step alone, from the same start.

use super::expansion::{Expansion, sum};
use super::{LONGEST, Taylor, not_finite};
use crate::contract::TaylorField;
use crate::error::Fault;
use crate::integrate::controller::landing_within;
use crate::integrate::instant::Instant;
use crate::integrate::stats::Counters;
use crate::numbers::{Numbers, Row};
use crate::state::StateVector;

/// Storage for the steps of as many motions as `L` has lanes.
pub(crate) struct Abreast<F: TaylorField, L: Numbers> {
    parameters: F::Parameters<L>,
    expansion: Expansion<F, L>,
    end: F::Row<L>,
    rests: F::Row<L>,
    slope: F::Row<L>,
}

/// A motion in a lane.
pub(crate) trait Walker<F: TaylorField> {
    /// The integrator.
    fn taylor(&self) -> &Taylor<F>;

    /// The integrator and the work counters, mutable.
    fn at_work(&mut self) -> (&mut Taylor<F>, &mut Counters);

    /// The system.
    fn field(&self) -> &F;

    /// End of the run.
    fn t_end(&self) -> f64;

    /// True if states inside every step will be requested.
    fn looks_inside(&self) -> bool;
}

/// Planned step of a lane.
#[derive(Clone, Copy, Default)]
struct Plan {
    reach: f64,
    arrival: Instant,
    made: f64,
    next_unit: f64,
}

impl<F: TaylorField, L: Numbers> Abreast<F, L> {
    /// Storage for the steps of systems like this one.
    pub(crate) fn new(field: &F) -> Self {
        let components = field.state_len();
        Self {
            parameters: F::Parameters::<L>::zeros(field.parameters().as_slice().len()),
            expansion: Expansion::of(field),
            end: F::Row::<L>::zeros(components),
            rests: F::Row::<L>::zeros(components),
            slope: F::Row::<L>::zeros(components),
        }
    }

    /// Sets the parameters of the system in each lane.
    pub(crate) fn set_parameters(&mut self, fields: &[&F]) {
        let mut of_lanes = [fields[0].parameters(); MOST];
        for (lane, parameters) in of_lanes.iter_mut().enumerate() {
            *parameters = fields[lane.min(fields.len() - 1)].parameters();
        }
        gather(&mut self.parameters, |lane, i| of_lanes[lane].as_slice()[i]);
    }

    /// Makes the next step of every motion whose integrator has the order of the first one. True for each step that was
    /// made. Every other motion must make its step alone.
    pub(crate) fn step(&mut self, walkers: &mut [impl Walker<F>]) -> [bool; MOST] {
        let order = walkers[0].taylor().order;
        for walker in walkers.iter_mut() {
            walker.at_work().0.set_out();
        }
        self.expand(walkers, order);
        let plans = self.plan(walkers, order);
        if self.arrive(walkers, &plans, order).is_err() {
            return [false; MOST];
        }
        let mut made = [false; MOST];
        for (lane, walker) in walkers.iter_mut().enumerate() {
            made[lane] =
                walker.taylor().order == order && self.hand_over(lane, walker, plans[lane], order);
            if made[lane] {
                let is_wanted = walker.looks_inside() || !self.expansion.begun_gaps().is_empty();
                let (taylor, _) = walker.at_work();
                taylor.is_expanded = is_wanted;
                if taylor.is_expanded {
                    self.hand_over_coefficients(lane, taylor);
                }
            }
        }
        made
    }

    fn expand(&mut self, walkers: &[impl Walker<F>], order: usize) {
        let mut start = self.end.zeroed();
        gather(&mut start, |lane, i| {
            of(walkers, lane).ends.start.value.as_slice()[i]
        });
        gather(&mut self.rests, |lane, i| {
            of(walkers, lane).ends.start.rest.as_slice()[i]
        });
        gather(&mut self.expansion.firsts, |lane, i| {
            of(walkers, lane).expansion.firsts.as_slice()[i]
        });
        let unit = L::gathered(|lane| of(walkers, lane).unit);
        let field = walkers[0].field();
        self.expansion
            .advance(field, &self.parameters, unit, order, &start);
    }

    fn plan(&self, walkers: &[impl Walker<F>], order: usize) -> [Plan; MOST] {
        let mut factors = self.end.zeroed();
        gather(&mut factors, |lane, i| {
            let taylor = of(walkers, lane);
            taylor
                .weights
                .allowed(i, &taylor.ends.start.value, &taylor.ends.start.value)
        });
        for factor in factors.as_mut_slice() {
            *factor = L::of(1.0) / *factor;
        }
        let sizes = self.expansion.sizes(order, &factors);
        let mut plans = [Plan::default(); MOST];
        for (lane, (plan, walker)) in plans.iter_mut().zip(walkers).enumerate() {
            let taylor = walker.taylor();
            let reach = taylor.reach_of(sizes.map(|size| size.lane(lane)));
            let reach = reach.min(LONGEST) * taylor.unit;
            let (length, t_end) = (taylor.length(reach), walker.t_end());
            let (made, arrival) = landing_within(taylor.max_step, taylor.ends.t[0], length, t_end);
            *plan = Plan {
                reach,
                arrival,
                made,
                next_unit: taylor.unit_after(length, t_end),
            };
        }
        plans
    }

    /// Computes the ends of all steps, with the rates and gaps there.
    fn arrive(
        &mut self,
        walkers: &[impl Walker<F>],
        plans: &[Plan; MOST],
        order: usize,
    ) -> Result<(), Fault> {
        let [change, slope] = self.expansion.change(order, theta(walkers, plans));
        self.slope = slope;
        for (i, change) in change.as_slice().iter().enumerate() {
            let start = self.expansion.coefficients[0].as_slice()[i];
            let rest = &mut self.rests.as_mut_slice()[i];
            [self.end.as_mut_slice()[i], *rest] = sum(start, *change, *rest);
        }
        let arrival = L::gathered(|lane| plans[lane.min(walkers.len() - 1)].arrival.t);
        let field = walkers[0].field();
        self.expansion
            .begin(field, &self.parameters, arrival, &self.end)
    }

    /// Passes the end of a lane's step to its integrator. True if the step is accepted.
    fn hand_over(
        &self,
        lane: usize,
        walker: &mut impl Walker<F>,
        plan: Plan,
        order: usize,
    ) -> bool {
        let is_whole = |row: &F::Row<L>| row.as_slice().iter().all(|x| x.lane(lane).is_finite());
        let [last, before] = [order, order - 1].map(|k| &self.expansion.coefficients[k]);
        if !(is_whole(last) && is_whole(before) && is_whole(&self.end)) {
            return false;
        }
        let (taylor, counters) = walker.at_work();
        let mut slope = taylor.expansion.coefficients[0].zeroed();
        scatter(&mut slope, &self.slope, lane);
        let firsts = self.expansion.firsts.as_slice();
        for i in 0..self.end.as_slice().len() {
            taylor.ends.end.value.as_mut_slice()[i] = self.end.as_slice()[i].lane(lane);
            taylor.ends.end.rest.as_mut_slice()[i] = self.rests.as_slice()[i].lane(lane);
            taylor.rates[1].as_mut_slice()[i] = firsts[i].lane(lane);
        }
        let is_finite = not_finite(taylor.rates[1].as_slice()).is_none();
        if !(is_finite && taylor.is_motion(plan.made / taylor.unit, &slope)) {
            taylor.ends.end = taylor.ends.start;
            taylor.rates[1] = taylor.rates[0];
            return false;
        }
        taylor.ends.t[1] = plan.arrival;
        taylor.next_unit = plan.next_unit;
        scatter(&mut taylor.expansion.firsts, &self.expansion.firsts, lane);
        let rows = taylor.expansion.gaps.iter_mut().zip(&self.expansion.gaps);
        for (target, row) in rows.take(order + 1) {
            scatter(target, row, lane);
        }
        counters.expansions += 1;
        counters.coefficients += order as u64;
        counters.rate_evaluations += 1;
        taylor.accept(plan.made, plan.reach, counters);
        true
    }

    fn hand_over_coefficients(&self, lane: usize, taylor: &mut Taylor<F>) {
        let rows = taylor.expansion.coefficients.iter_mut();
        let rows = rows.zip(&self.expansion.coefficients);
        for (target, row) in rows.take(taylor.order + 1) {
            scatter(target, row, lane);
        }
    }
}

/// Largest number of lanes.
pub(crate) const MOST: usize = 8;

/// Integrator of a lane. Unused lanes repeat the last motion.
#[inline(always)]
fn of<F: TaylorField>(walkers: &[impl Walker<F>], lane: usize) -> &Taylor<F> {
    walkers[lane.min(walkers.len() - 1)].taylor()
}

/// Lengths of the steps, in units of time of the series.
#[inline(always)]
fn theta<F: TaylorField, L: Numbers>(walkers: &[impl Walker<F>], plans: &[Plan; MOST]) -> L {
    L::gathered(|lane| {
        let lane = lane.min(walkers.len() - 1);
        plans[lane].made / walkers[lane].taylor().unit
    })
}

#[inline(always)]
fn gather<L: Numbers>(row: &mut impl Row<L>, of_lane: impl Fn(usize, usize) -> f64) {
    for (i, entry) in row.as_mut_slice().iter_mut().enumerate() {
        *entry = L::gathered(|lane| of_lane(lane, i));
    }
}

#[inline(always)]
fn scatter<L: Numbers>(target: &mut impl Row<f64>, row: &impl Row<L>, lane: usize) {
    for (entry, lanes) in target.as_mut_slice().iter_mut().zip(row.as_slice()) {
        *entry = lanes.lane(lane);
    }
}
