//! Drift of a conserved quantity over a long run: a series of deviations, and their growth.

use core::ops::ControlFlow;

use dalembert::math::larger;
use dalembert::{
    Effect, Observer, Outcome, Segment, Simulation, StartError, Stepper, System, VectorField,
};

/// A window of a run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Window {
    /// The time at its end.
    pub t: f64,
    /// The largest absolute deviation from the value at the start of the run, at the ends of the steps in this window.
    pub largest: f64,
    /// The mean deviation at the same states.
    pub mean: f64,
}

/// The deviations of a quantity over a run, in windows of equal length.
#[derive(Debug, Clone, PartialEq)]
pub struct Series {
    /// The value at the start.
    pub start: f64,
    /// The windows, in order; windows without a step are left out.
    pub windows: Vec<Window>,
    /// The outcome of the run.
    pub outcome: Outcome,
    /// Number of accepted steps.
    pub steps: u64,
}

/// Request for a series.
#[derive(Debug, Clone, Copy)]
pub struct Request<Q> {
    /// The end time of the run, which starts at `t = 0`.
    pub until: f64,
    /// Number of windows.
    pub windows: usize,
    /// The quantity, as a function of time and state.
    pub quantity: Q,
}

/// Follows a quantity along a run.
///
/// # Errors
/// [`StartError`] if the runtime refuses to start.
pub fn follow<S, Step, E, Q>(
    system: &S,
    state: S::State,
    (stepper, effects): (Step, E),
    request: Request<Q>,
) -> Result<Series, StartError>
where
    S: System,
    Step: Stepper<S>,
    E: Effect<S>,
    Q: Fn(f64, &S::State) -> f64,
{
    let start = (request.quantity)(0.0, &state);
    let mut collector = Collector {
        request: &request,
        start,
        sums: vec![Sum::default(); request.windows.max(1)],
    };
    let run =
        Simulation::new(system, stepper, effects).run(0.0, state, request.until, &mut collector)?;
    let length = request.until / collector.sums.len() as f64;
    let windows = collector.sums.iter().enumerate();
    Ok(Series {
        start,
        windows: windows
            .filter(|(_, sum)| sum.count > 0.0)
            .map(|(k, sum)| Window {
                t: (k + 1) as f64 * length,
                largest: sum.largest,
                mean: sum.total / sum.count,
            })
            .collect(),
        outcome: run.outcome,
        steps: run.counters.accepted,
    })
}

impl Series {
    /// The largest deviation of all.
    pub fn largest(&self) -> f64 {
        let largest = self.windows.iter().map(|window| window.largest);
        largest.fold(0.0, larger)
    }

    /// The drift. A straight line is fitted to the means of the windows, in which oscillations cancel; the drift is its
    /// increase over the run.
    pub fn drift(&self) -> f64 {
        let points: Vec<_> = self.windows.iter().map(|it| (it.t, it.mean)).collect();
        let span = self.windows.last().map_or(0.0, |last| last.t);
        slope(&points) * span
    }

    /// The exponent `k` in the growth `t^k` of the running maximum of the deviation: about 0 if it is bounded, 1/2 for
    /// a random walk of rounding errors, 1 for a steady drift. NaN if every deviation is 0.
    pub fn exponent(&self) -> f64 {
        let mut so_far = 0.0_f64;
        let points: Vec<_> = self
            .windows
            .iter()
            .map(|window| {
                so_far = so_far.max(window.largest);
                (window.t.ln(), so_far.ln())
            })
            .filter(|(_, size)| size.is_finite())
            .collect();
        slope(&points)
    }
}

/// Least-squares slope of the straight line through points.
fn slope(points: &[(f64, f64)]) -> f64 {
    let count = points.len() as f64;
    let mean = |of: fn(&(f64, f64)) -> f64| points.iter().map(of).sum::<f64>() / count;
    let (x, y) = (mean(|point| point.0), mean(|point| point.1));
    let joint: f64 = points.iter().map(|(u, v)| (u - x) * (v - y)).sum();
    let square: f64 = points.iter().map(|(u, _)| (u - x) * (u - x)).sum();
    joint / square
}

#[derive(Debug, Clone, Copy, Default)]
struct Sum {
    count: f64,
    total: f64,
    largest: f64,
}

struct Collector<'a, Q> {
    request: &'a Request<Q>,
    start: f64,
    sums: Vec<Sum>,
}

impl<S: System, Q: Fn(f64, &<S as VectorField>::State) -> f64> Observer<S> for Collector<'_, Q> {
    fn step(&mut self, segment: &mut Segment<'_, S::State>) -> ControlFlow<()> {
        let t = segment.t_end();
        let deviation = (self.request.quantity)(t, segment.end()) - self.start;
        let last = self.sums.len() - 1;
        let part = t / self.request.until * self.sums.len() as f64;
        let sum = &mut self.sums[(part as usize).min(last)];
        sum.count += 1.0;
        sum.total += deviation;
        sum.largest = larger(sum.largest, deviation.abs());
        ControlFlow::Continue(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn series(deviation: impl Fn(f64) -> f64) -> Series {
        let windows = (1..=100).map(|k| {
            let t = f64::from(k);
            let mean = deviation(t);
            Window {
                t,
                largest: mean.abs(),
                mean,
            }
        });
        Series {
            start: 0.0,
            windows: windows.collect(),
            outcome: Outcome::Done,
            steps: 100,
        }
    }

    #[test]
    fn growth_is_told_from_oscillation() {
        let steady = series(|t| 3e-9 * t);
        assert!((steady.exponent() - 1.0).abs() < 1e-12);
        assert!((steady.drift() - 3e-7).abs() < 1e-18);
        let bounded = series(|t| 1e-6 * t.sin());
        assert!(bounded.exponent().abs() < 0.05 && bounded.drift().abs() < 2e-7);
        assert!((series(|t| t.sqrt()).exponent() - 0.5).abs() < 1e-12);
        assert!(series(|_| 0.0).exponent().is_nan());
    }
}
