//! A disk that rolls upright without slipping. The macro proves the claims of the model; a run compares the motion with
//! its closed form.
//!
//! `cargo run --release -p dalembert-examples --example rolling_disk`

use std::error::Error;

use dalembert::{Dop853, Simulation, System, Tolerance};

dalembert::model! {
    /// Disk that rolls upright on a plane.
    pub Disk {
        coordinates { x; y; theta: angle; phi: angle; }
        parameters {
            /// Mass.
            m > 0 = 1;
            /// Radius.
            R > 0 = 1/2;
            /// Moment of inertia about the axle.
            I > 0 = 1/8;
            /// Moment of inertia about a diameter.
            J > 0 = 1/16;
        }
        lagrangian = m/2*(dot(x)^2 + dot(y)^2) + I/2*dot(theta)^2 + J/2*dot(phi)^2;
        constraints {
            along_x: dot(x) = R*cos(phi)*dot(theta);
            along_y: dot(y) = R*sin(phi)*dot(theta);
        }
        claims {
            density: exact;
            conserved: energy;
            conserved: dot(theta);
            symmetry: partial(x);
        }
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let disk = Disk {
        R: 0.3,
        ..Disk::default()
    };
    // `state` refuses velocities that violate the constraints. Here x' and y' follow from the two angular velocities.
    let (theta_dot, phi_dot) = (4.0, 1.5);
    let start = disk.state(
        0.0,
        &[0.0, 0.0, 0.0, 0.0].into(),
        &[disk.R * theta_dot, 0.0, theta_dot, phi_dot].into(),
    )?;
    let integrator = Dop853::new(Tolerance::new(1e-12)?);
    // A model without surfaces needs no effects.
    let run = Simulation::new(&disk, integrator, ()).run(0.0, start, 20.0, &mut ())?;

    // The contact point moves along a circle.
    let radius = disk.R * theta_dot / phi_dot;
    let [x, y] = [0, 1].map(|i| disk.position(&run.state)[i]);
    let exact = [
        (phi_dot * run.t).sin() * radius,
        (1.0 - (phi_dot * run.t).cos()) * radius,
    ];
    let error = (x - exact[0]).hypot(y - exact[1]);
    println!("{} at t = {}", run.outcome, run.t);
    println!("place {x:.9} {y:.9}, off by {error:.1e}");
    println!("evaluations of the rate {}", run.counters.rate_evaluations);
    if error > 1e-9 {
        return Err("the disk left its circle".into());
    }
    Ok(())
}
