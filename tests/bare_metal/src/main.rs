//! A bead with a constraint and a floor, simulated without an operating system.

#![no_std]
#![no_main]

use dalembert::{Dop853, Scene, Simulation, System, Tolerance};

dalembert::model! {
    /// A bead on a circle, over a floor.
    pub Bead {
        coordinates { x; y; }
        parameters { m > 0 = 1; g > 0 = 1; }
        lagrangian = m/2*(dot(x)^2 + dot(y)^2) - m*g*y - sin(x)*exp(y);
        constraints { circle: d(x^2 + y^2) = 0; }
        impacts { floor: y + 1/2 >= 0; }
    }
}

#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    loop {}
}

fn impacts() -> Option<u64> {
    let bead = Bead::default();
    let state = bead.state_projected(0.0, &[0.0, 1.0].into(), &[0.5, 0.0].into()).ok()?;
    let stepper = Dop853::new(Tolerance::new(1e-9).ok()?);
    let run = Simulation::new(&bead, stepper, bead.effects()).run(0.0, state, 10.0, &mut ()).ok()?;
    Some(run.counters.impacts)
}

/// Entry point.
#[unsafe(no_mangle)]
pub extern "C" fn _start() -> ! {
    let mut impacts = impacts();
    core::hint::black_box(&mut impacts);
    loop {}
}
