//! Simulates a bouncing ball without the standard library. The exit status is 0 if there are five impacts.

#![no_std]
#![no_main]

use dalembert::{Dop853, Outcome, Scene, Simulation, System, Tolerance};

dalembert::model! {
    /// A ball that bounces on a floor.
    pub Ball {
        coordinates { x; }
        parameters { m > 0 = 1; g > 0 = 1; }
        lagrangian = m/2*dot(x)^2 - m*g*x;
        impacts { floor: x >= 0; }
    }
}

#[link(name = "c")]
unsafe extern "C" {}

#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    loop {}
}

/// The compiled core library refers to this symbol even if panics abort; nothing calls it.
#[unsafe(no_mangle)]
pub extern "C" fn rust_eh_personality() {}

fn bounces() -> Option<u64> {
    let ball = Ball::default();
    let state = ball.state(0.0, &[0.5].into(), &[0.0].into()).ok()?;
    let stepper = Dop853::new(Tolerance::new(1e-12).ok()?);
    let run = Simulation::new(&ball, stepper, ball.effects()).run(0.0, state, 10.0, &mut ()).ok()?;
    (run.outcome == Outcome::Done).then_some(run.counters.impacts)
}

/// The entry point, which the C runtime calls.
#[unsafe(no_mangle)]
pub extern "C" fn main() -> i32 {
    // The impacts are at the times 1, 3, 5, 7, 9.
    i32::from(bounces() != Some(5))
}
