//! Accumulations of accumulations: points in grooves, and columns of bodies on a floor.

use dalembert::Outcome;
use dalembert_cli::Integrator;
use dalembert_cli::suite::Setting;
use dalembert_stability::course::{Course, End};
use dalembert_stability::text::{Text, set};

/// A point above a groove at `(a, b)`, whose sides have different slopes.
static GROOVE: Text = Text::new(
    "pub Groove {
        coordinates { x; y; }
        parameters { a = 0; b = 0; left > 0 = 1; right > 0 = 1; e in [0, 1] = 0.5; f in [0, 1] = 0.5; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2 - y;
        impacts {
            left_side: y - b + left*(x - a) >= 0 => newton(e);
            right_side: y - b - right*(x - a) >= 0 => newton(f);
        }
    }",
);

/// Bodies above each other on a floor at `h`.
static COLUMN: Text = Text::new(
    "pub Column {
        coordinates { x; y; z; }
        parameters { h = 0; m > 0 = 1; n > 0 = 1; k > 0 = 1; e in [0, 1] = 0.5; }
        lagrangian = m/2*dot(x)^2 + n/2*dot(y)^2 + k/2*dot(z)^2 - m*x - n*y - k*z;
        impacts {
            floor: x >= h => newton(e);
            low: y >= x => newton(e);
            high: z >= y => newton(e);
        }
    }",
);

/// Bodies that stick together where they meet, falling on a floor.
static LUMP: Text = Text::new(
    "pub Lump {
        coordinates { x; y; z; }
        parameters { m > 0 = 1.6; n > 0 = 2.7; k > 0 = 1.7; g = 0.2; }
        lagrangian = m/2*dot(x)^2 + n/2*dot(y)^2 + k/2*dot(z)^2 - g*(m*x + n*y + k*z);
        impacts {
            low: y >= x => impact_plastic;
            high: z >= y => impact_plastic;
            floor: x >= 0 => impact_plastic;
        }
    }",
);

/// Counts runs that end at rest, and refuses all others except those whose order of impacts is unknown.
#[derive(Default)]
struct Rests {
    done: u32,
    all: u32,
}

impl Rests {
    fn add(&mut self, end: &End, place: &[f64], case: &str) {
        self.all += 1;
        match end.outcome {
            Outcome::Ambiguous { .. } => {}
            Outcome::Done => {
                self.done += 1;
                for (q, place) in end.q.iter().zip(place) {
                    assert!((q - place).abs() < 1e-9, "{case}: {:?}", end.q);
                }
            }
            outcome => panic!("{case}: {outcome:?}"),
        }
    }

    /// Fails if the order of impacts was unknown in more than one of thirty runs.
    fn check(&self) {
        assert!(
            30 * (self.all - self.done) <= self.all,
            "{} of {}",
            self.done,
            self.all
        );
    }
}

/// Hops on one side end in sliding, which ends at the other side, and so on. All this ends at the bottom.
fn assert_rest_at_the_bottom([a, b]: [f64; 2]) {
    let mut rests = Rests::default();
    let mut groove = GROOVE.model();
    for [left, right] in [[1.23, 0.59], [1.0, 2.0], [0.88, 0.41]] {
        for [e, f] in [[0.0, 0.0], [0.5, 0.5], [0.5, 0.0]] {
            for &integrator in Integrator::every() {
                let values = [a, b, left, right, e, f];
                for (name, value) in ["a", "b", "left", "right", "e", "f"].iter().zip(values) {
                    set(&mut groove, name, value);
                }
                let start = [a - 0.28, b + 1.0];
                let course = Course::new(&groove, &start, &[0.0, 0.0], 20.0).tol(1e-10);
                let end = course.step(1e-2).resting().run(Setting::free(integrator));
                let case = format!("{}, {values:?}", integrator.name());
                rests.add(&end, &[a, b], &case);
            }
        }
    }
    rests.check();
}

#[test]
fn a_point_comes_to_rest_at_the_bottom_of_a_groove() {
    assert_rest_at_the_bottom([0.0, 0.0]);
}

#[test]
fn a_point_comes_to_rest_at_the_bottom_of_a_groove_beside_the_origin() {
    assert_rest_at_the_bottom([1.3, -0.7]);
}

fn assert_column_comes_to_rest(h: f64) {
    let mut rests = Rests::default();
    let mut column = COLUMN.model();
    for masses in [[1.0, 1.0, 1.0], [1.1, 1.15, 0.46]] {
        for e in [0.0, 0.3, 0.8] {
            for &integrator in Integrator::every() {
                let values = [h, masses[0], masses[1], masses[2], e];
                for (name, value) in ["h", "m", "n", "k", "e"].iter().zip(values) {
                    set(&mut column, name, value);
                }
                let start = [h + 0.43, h + 0.46, h + 1.49];
                let course = Course::new(&column, &start, &[0.0; 3], 20.0).tol(1e-10);
                let end = course.step(1e-2).resting().run(Setting::free(integrator));
                let case = format!("{}, {values:?}", integrator.name());
                rests.add(&end, &[h; 3], &case);
            }
        }
    }
    rests.check();
}

#[test]
fn a_column_of_bodies_comes_to_rest_on_the_floor() {
    assert_column_comes_to_rest(0.0);
}

#[test]
fn a_column_of_bodies_comes_to_rest_on_a_floor_below() {
    assert_column_comes_to_rest(-1.7);
}

/// Nothing presses the bodies together while they fall, but they stay where their centre of mass is.
#[test]
fn bodies_that_fall_together_need_no_force_to_stay_together() {
    let masses = [
        [1.6, 2.7, 1.7],
        [1.0, 1.0, 1.0],
        [0.3, 2.9, 0.7],
        [2.2, 0.4, 1.9],
    ];
    let mut lump = LUMP.model();
    let (start, rates) = ([2.0, 3.0, 4.0], [0.0, -1.0, -1.7]);
    for masses in masses {
        for g in [0.0, 0.2, 0.3] {
            for (name, value) in ["m", "n", "k"].iter().zip(masses) {
                set(&mut lump, name, value);
            }
            set(&mut lump, "g", g);
            let mean = |values: [f64; 3]| {
                let moments = masses.iter().zip(values).map(|(m, value)| m * value);
                moments.sum::<f64>() / masses.iter().sum::<f64>()
            };
            let t = 1.7;
            let right = mean(start) + mean(rates) * t - g / 2.0 * t * t;
            for &integrator in Integrator::every() {
                let course = Course::new(&lump, &start, &rates, t).tol(1e-11);
                let end = course.step(1e-2).resting().run(Setting::free(integrator));
                let case = format!("{}, {masses:?}, {g}: {:?}", integrator.name(), end.q);
                assert_eq!(end.outcome, Outcome::Done, "{case}");
                assert!(
                    end.q.iter().all(|q| (q - right).abs() < 1e-8),
                    "{case}, not {right}"
                );
            }
        }
    }
}
