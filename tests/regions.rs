//! Surfaces that count in a part of space only: `when`.

use core::ops::ControlFlow;

use dalembert::{Dop853, Event, Observer, Outcome, Scene, Simulation, System, Tolerance};

dalembert::model! {
    /// A particle and a slab of thickness `w` at 1.
    pub Slab {
        coordinates { x; }
        parameters { m > 0 = 1; w > 0 = 1e-10; }
        lagrangian = m/2*dot(x)^2;
        impacts {
            near: 1 - x >= 0 when x < 1 + w/2;
            far: x - 1 - w >= 0 when x > 1 + w/2;
        }
    }
}

dalembert::model! {
    /// Stadium: two half circles of radius 1 joined by lines of length 2.
    pub Stadium {
        coordinates { x; y; }
        parameters { m > 0 = 1; }
        lagrangian = m/2*(dot(x)^2 + dot(y)^2);
        impacts {
            top: 1 - y >= 0 when x > -1 when x < 1;
            bottom: 1 + y >= 0 when x > -1 when x < 1;
            right: 1 - (x - 1)^2 - y^2 >= 0 when x > 1;
            left: 1 - (x + 1)^2 - y^2 >= 0 when x < -1;
        }
    }
}

dalembert::model! {
    /// A falling ball above a floor that lies less than a rounding error inside the chart.
    pub Brink {
        coordinates { y in (0, 9); }
        lagrangian = dot(y)^2/2 - y;
        impacts { floor: y >= 1e-17; }
    }
}

/// Counts impacts and asserts that every one of them happens where its surface counts.
#[derive(Default)]
struct Checked {
    impacts: [usize; 4],
}

impl Observer<Stadium> for Checked {
    fn event(
        &mut self,
        event: &Event<<Stadium as dalembert::VectorField>::State>,
    ) -> ControlFlow<()> {
        let x = event.before[0];
        let counts = match event.surface {
            stadium::surface::right => x >= 1.0 - 1e-12,
            stadium::surface::left => x <= -1.0 + 1e-12,
            _ => x.abs() <= 1.0 + 1e-12,
        };
        assert!(counts, "surface {} at x = {x}", event.surface);
        self.impacts[event.surface] += 1;
        ControlFlow::Continue(())
    }
}

#[test]
fn a_fast_particle_does_not_pass_a_thin_slab() {
    let slab = Slab::default();
    let state = slab
        .state(0.0, &[0.0].into(), &[1e6].into())
        .expect("a state");
    let stepper = Dop853::new(Tolerance::new(1e-10).expect("a tolerance"));
    let run = Simulation::new(&slab, stepper, slab.effects())
        .run(0.0, state, 1e-5, &mut ())
        .expect("a start");
    assert_eq!((run.outcome, run.counters.impacts), (Outcome::Done, 1));
    assert!(
        (run.state[0] + 8.0).abs() < 64.0 * 8.0 * f64::EPSILON,
        "{}",
        run.state[0]
    );
}

#[test]
fn the_far_side_of_the_slab_counts_behind_it_only() {
    let slab = Slab::default();
    let state = slab
        .state(0.0, &[3.0].into(), &[-1.0].into())
        .expect("a state");
    let stepper = Dop853::new(Tolerance::new(1e-10).expect("a tolerance"));
    let run = Simulation::new(&slab, stepper, slab.effects())
        .run(0.0, state, 4.0, &mut ())
        .expect("a start");
    assert_eq!((run.outcome, run.counters.impacts), (Outcome::Done, 1));
    assert!((run.state[0] - 3.0).abs() < 1e-9, "{}", run.state[0]);
}

#[test]
fn a_stadium_keeps_its_particle() {
    let stadium = Stadium::default();
    let state = stadium
        .state(0.0, &[0.3, 0.1].into(), &[0.6, 0.8].into())
        .expect("a state");
    let stepper = Dop853::new(Tolerance::new(1e-12).expect("a tolerance"));
    let mut checked = Checked::default();
    let run = Simulation::new(&stadium, stepper, stadium.effects())
        .run(0.0, state, 500.0, &mut checked)
        .expect("a start");
    assert_eq!(run.outcome, Outcome::Done);
    assert!(
        checked.impacts.iter().all(|&count| count > 20),
        "{:?}",
        checked.impacts
    );
    let energy = stadium.energy(500.0, &run.state).expect("an energy");
    assert!((energy - 0.5).abs() < 1e-12, "{energy}");
}

/// An impact is placed where the gap is closest to 0 on either side, but never where the motion does not exist.
#[test]
fn an_impact_at_the_end_of_a_chart_is_inside_it() {
    let brink = Brink {};
    for start in 1..40 {
        let state = brink
            .state(0.0, &[f64::from(start) / 7.0].into(), &[0.0].into())
            .expect("a state");
        let stepper = Dop853::new(Tolerance::new(1e-10).expect("a tolerance"));
        let run = Simulation::new(&brink, stepper, brink.effects())
            .run(0.0, state, 100.0, &mut ())
            .expect("a start");
        assert_eq!(run.outcome, Outcome::Done, "from {start}/7 at {}", run.t);
        assert!(run.counters.impacts > 10);
    }
}
