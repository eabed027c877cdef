//! The gait of a rimless wheel. Newton's method on the return map finds the limit cycle and its Floquet multiplier.
//!
//! `cargo run --release -p dalembert-examples --example limit_cycle`

use std::error::Error;

use dalembert::variations::orbit::ITERATIONS;
use dalembert::{Scene, Section, System, Taylor, Tolerance};

dalembert::model! {
    /// A wheel of spokes without a rim rolls down a slope. At every step the next spoke strikes the ground.
    pub Wheel {
        coordinates { theta; }
        parameters {
            /// Slope.
            slope = 0.1;
            /// Half the angle between spokes.
            half > 0 = 0.3;
        }
        lagrangian = dot(theta)^2/2 - cos(theta + slope);
        impacts {
            step: half - theta >= 0 => reset { theta = theta - 2*half; dot(theta) = cos(2*half)*dot(theta); };
        }
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let wheel = Wheel::default();
    let start = wheel.state(0.0, &[-wheel.half].into(), &[0.6].into())?;
    let integrator = Taylor::new(Tolerance::new(1e-13)?);
    let mut section = Section::new(&wheel, integrator, wheel.effects(), 0, 100.0);
    let first = section.arrive(&start, &mut [])?;
    let cycle = section.periodic(&first.before, ITERATIONS)?;

    // Each step gains the energy of the descent; each impact keeps the fraction cos^2(2 half) of the kinetic energy.
    let kept = (2.0 * wheel.half).cos().powi(2);
    let gained = 2.0 * ((wheel.slope - wheel.half).cos() - (wheel.slope + wheel.half).cos());
    let arrival = wheel.velocity(0.0, &cycle.point.before)?[0];
    let exact = (gained / (1.0 - kept)).sqrt();
    let [multiplier, _] = cycle.multipliers.iter().next().ok_or("no multiplier")?;
    println!("a step takes {:.12}", cycle.point.time);
    println!("angular velocity before a step {arrival:.12}, exactly {exact:.12}");
    println!("multiplier {:.12}, exactly {kept:.12}", multiplier);
    if (arrival - exact).abs() > 1e-9 || (multiplier - kept).abs() > 1e-9 {
        return Err("the search found another cycle".into());
    }
    Ok(())
}
