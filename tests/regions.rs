//! Surfaces that count only in a part of space, declared with `when`.

use core::ops::ControlFlow;

use dalembert::{Event, Observer, Outcome, Run, System, VectorField};
use dalembert_cli::Integrator;
use dalembert_stability::course::{Course, state};
use dalembert_stability::text::{Model, Text};

type State = <Model as VectorField>::State;

/// A particle and a slab of thickness `w` at 1.
static SLAB: Text = Text::new(
    "Slab {
        coordinates { x; }
        parameters { m > 0 = 1; w > 0 = 1e-10; }
        lagrangian = m/2*dot(x)^2;
        impacts {
            near: 1 - x >= 0 when x < 1 + w/2;
            far: x - 1 - w >= 0 when x > 1 + w/2;
        }
    }",
);

/// Stadium: two half circles of radius 1 joined by lines of length 2.
static STADIUM: Text = Text::new(
    "Stadium {
        coordinates { x; y; }
        parameters { m > 0 = 1; }
        lagrangian = m/2*(dot(x)^2 + dot(y)^2);
        impacts {
            top: 1 - y >= 0 when x > -1 when x < 1;
            bottom: 1 + y >= 0 when x > -1 when x < 1;
            right: 1 - (x - 1)^2 - y^2 >= 0 when x > 1;
            left: 1 - (x + 1)^2 - y^2 >= 0 when x < -1;
        }
    }",
);

/// A falling ball above a floor that lies less than a rounding error inside the chart.
static BRINK: Text = Text::new(
    "Brink {
        coordinates { y in (0, 9); }
        lagrangian = dot(y)^2/2 - y;
        impacts { floor: y >= 1e-17; }
    }",
);

const RIGHT: usize = 2;
const LEFT: usize = 3;

/// Counts impacts, and asserts that each happens where the condition of its surface holds.
#[derive(Default)]
struct Checked {
    impacts: [usize; 4],
}

impl Observer<Model> for Checked {
    fn event(&mut self, event: &Event<State>) -> ControlFlow<()> {
        let x = event.before.as_ref()[0];
        let counts = match event.surface {
            RIGHT => x >= 1.0 - 1e-12,
            LEFT => x <= -1.0 + 1e-12,
            _ => x.abs() <= 1.0 + 1e-12,
        };
        assert!(counts, "surface {} at x = {x}", event.surface);
        self.impacts[event.surface] += 1;
        ControlFlow::Continue(())
    }
}

/// A run of the particle at the slab.
fn slab(x: f64, v: f64, until: f64) -> Run<State> {
    let slab = SLAB.model();
    Course::from_state(&slab, state(&slab, &[x], &[v]), until)
        .tol(1e-10)
        .observed(Integrator::Dop853, &mut ())
}

#[test]
fn a_fast_particle_does_not_pass_a_thin_slab() {
    let run = slab(0.0, 1e6, 1e-5);
    assert_eq!((run.outcome, run.counters.impacts), (Outcome::Done, 1));
    let x = run.state.as_ref()[0];
    assert!((x + 8.0).abs() < 64.0 * 8.0 * f64::EPSILON, "{x}");
}

#[test]
fn the_far_side_of_the_slab_counts_behind_it_only() {
    let run = slab(3.0, -1.0, 4.0);
    assert_eq!((run.outcome, run.counters.impacts), (Outcome::Done, 1));
    let x = run.state.as_ref()[0];
    assert!((x - 3.0).abs() < 1e-9, "{x}");
}

#[test]
fn a_stadium_keeps_its_particle() {
    let stadium = STADIUM.model();
    let state = state(&stadium, &[0.3, 0.1], &[0.6, 0.8]);
    let mut checked = Checked::default();
    let run = Course::from_state(&stadium, state, 500.0)
        .tol(1e-12)
        .observed(Integrator::Dop853, &mut checked);
    assert_eq!(run.outcome, Outcome::Done);
    assert!(
        checked.impacts.iter().all(|&count| count > 20),
        "{:?}",
        checked.impacts
    );
    let energy = stadium.energy(500.0, &run.state).expect("an energy");
    assert!((energy - 0.5).abs() < 1e-12, "{energy}");
}

/// An impact happens at the time just before or just after the root, whichever has the gap closer to 0, but never
/// outside of the chart.
#[test]
fn an_impact_at_the_end_of_a_chart_is_inside_it() {
    let brink = BRINK.model();
    for start in 1..40 {
        let state = state(&brink, &[f64::from(start) / 7.0], &[0.0]);
        let run = Course::from_state(&brink, state, 100.0)
            .tol(1e-10)
            .observed(Integrator::Dop853, &mut ());
        assert_eq!(run.outcome, Outcome::Done, "from {start}/7 at {}", run.t);
        assert!(run.counters.impacts > 10);
    }
}
