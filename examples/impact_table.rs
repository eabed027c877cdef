//! A table of the first impacts of a ball that bounces lower and lower, until infinitely many impacts accumulate.
//!
//! `cargo run --release -p dalembert-examples --example impact_table`

use core::ops::ControlFlow;
use std::error::Error;

use dalembert::{
    Event, Observer, Outcome, Scene, Simulation, System, Taylor, Tolerance, VectorField,
};

dalembert::model! {
    /// A ball above a floor.
    pub Ball {
        coordinates { x; }
        parameters { g > 0 = 9.81; e in [0, 1] = 0.7; }
        lagrangian = dot(x)^2/2 - g*x;
        impacts { floor: x >= 0 => restitution(e); }
    }
}

type State = <Ball as VectorField>::State;

/// Prints the first five impacts and counts all.
struct Table<'a> {
    ball: &'a Ball,
    impacts: usize,
}

impl Observer<Ball> for Table<'_> {
    fn event(&mut self, event: &Event<State>) -> ControlFlow<()> {
        self.impacts += 1;
        if self.impacts <= 5 {
            let [before, after] = [&event.before, &event.after].map(|state| {
                self.ball
                    .velocity(event.t, state)
                    .map_or(f64::NAN, |v| v[0])
            });
            println!(
                "{:>3}  t = {:.12}  {before:+.9} -> {after:+.9}",
                self.impacts, event.t
            );
        }
        ControlFlow::Continue(())
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let ball = Ball::default();
    let height: f64 = 1.0;
    let start = ball.state(0.0, &[height].into(), &[0.0].into())?;
    let mut table = Table {
        ball: &ball,
        impacts: 0,
    };
    let integrator = Taylor::new(Tolerance::new(1e-13)?);
    let run =
        Simulation::new(&ball, integrator, ball.effects()).run(0.0, start, 10.0, &mut table)?;

    // The ball falls; then each flight is shorter than the last by the factor e.
    let fall = (2.0 * height / ball.g).sqrt();
    let limit = fall * (1.0 + ball.e) / (1.0 - ball.e);
    println!(
        "{} after {} impacts at t = {:.12}",
        run.outcome, table.impacts, run.t
    );
    println!("accumulation at {limit:.12}");
    if !matches!(run.outcome, Outcome::Zeno { .. }) || (run.t - limit).abs() > 1e-9 {
        return Err("the impacts accumulate elsewhere".into());
    }
    Ok(())
}
