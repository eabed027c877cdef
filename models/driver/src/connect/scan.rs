//! Scan of the starts along a ray from rest in the space of unknowns, with every change of their sequence of impacts.

use super::aim::{Aim, Course, Shot};
use crate::linear::norm;

/// A start on a ray.
#[derive(Debug, Clone)]
pub(super) struct Sample {
    /// Its speed: the square root of twice its kinetic energy.
    pub speed: f64,
    pub shot: Shot,
}

impl Sample {
    /// The distance between the end of the motion and the given end.
    pub fn miss(&self) -> f64 {
        norm(&self.shot.misses)
    }
}

/// Density of a scan.
#[derive(Debug, Clone, Copy)]
pub(super) struct Density {
    /// Number of equal intervals up to [`Speeds::first`].
    pub first: usize,
    /// Number of intervals in each doubling of the speed.
    pub doubling: usize,
    /// Maximum number of halvings of an interval at whose ends the sequences of impacts differ.
    pub halvings: u32,
    /// Number of integrator steps after which an open scan no longer doubles the speed.
    pub steps: u64,
}

/// Speeds of a scan.
#[derive(Debug, Clone, Copy)]
pub(super) struct Speeds {
    /// The speed at the end of the equal intervals.
    pub first: f64,
    /// Largest speed.
    pub most: f64,
    /// True if the scan may stop at a lower speed, where faster starts lead away from the end.
    pub is_open: bool,
}

/// The starts along a ray.
#[derive(Debug, Clone, Default)]
pub(super) struct Ray {
    /// The starts in order of speed.
    pub samples: Vec<Sample>,
    /// True if no motion of the fastest starts reaches the end time with few enough impacts, and none was given up.
    pub is_bounded: bool,
}

impl Ray {
    /// Number of starts whose motion was given up.
    pub fn given_up(&self) -> usize {
        count(&self.samples)
    }
}

/// Number of starts whose motion was given up.
fn count(samples: &[Sample]) -> usize {
    let given_up = samples
        .iter()
        .filter(|it| it.shot.course == Course::GivenUp);
    given_up.count()
}

/// Scans the ray of a direction. `units` are the values of the unknowns at speed 1.
pub(super) fn ray(
    aim: &mut dyn Aim,
    direction: &[f64],
    units: &[f64],
    density: Density,
    speeds: Speeds,
) -> Ray {
    let mut scan = Scan {
        aim,
        direction,
        units,
    };
    let mut ray = Ray::default();
    let step = speeds.first / density.first as f64;
    for index in 0..=density.first {
        scan.extend(&mut ray.samples, step * index as f64, density.halvings);
    }
    let mut speed = speeds.first;
    let mut doublings = Doublings::default();
    let begun = scan.aim.steps();
    while speed < speeds.most {
        let is_long = scan.aim.steps() - begun > density.steps;
        if speeds.is_open && (doublings.are_over() || is_long) {
            break;
        }
        let begin = ray.samples.len();
        for index in 1..=density.doubling {
            let next = speed * (1.0 + index as f64 / density.doubling as f64);
            scan.extend(&mut ray.samples, next.min(speeds.most), density.halvings);
            if next >= speeds.most {
                break;
            }
        }
        let (before, made) = ray.samples.split_at(begin);
        let is_last = !made.iter().any(reaches);
        ray.is_bounded = is_last && count(made) == 0;
        if is_last && (before.iter().any(reaches) || doublings.are_in_vain()) {
            break;
        }
        doublings.note(before, made);
        speed *= 2.0;
    }
    ray
}

/// True for a motion that reaches the end time with few enough impacts.
fn reaches(sample: &Sample) -> bool {
    matches!(sample.shot.course, Course::Reached(_))
}

/// Number of successive quiet doublings after which faster starts are assumed to lead away from the end.
const QUIET: u32 = 5;

/// Number of doublings after which a ray without any motion to the end is given up. Slow starts may have too many
/// impacts although fast starts have few, so one doubling is not enough.
const VAIN: u32 = 5;

/// Record of the doublings of the speed along a ray.
#[derive(Debug, Default)]
struct Doublings {
    /// Number of the latest successive doublings along which the sequence of impacts did not change and the miss grew.
    quiet: u32,
    /// Number of all doublings.
    made: u32,
    /// True once the sequence of impacts has changed.
    has_changed: bool,
}

impl Doublings {
    fn note(&mut self, before: &[Sample], made: &[Sample]) {
        let last = before.last().map(|it| &it.shot.course);
        let stays = made.iter().all(|it| Some(&it.shot.course) == last);
        let grows = made.windows(2).all(|pair| pair[0].miss() < pair[1].miss());
        let differs = |pair: &[Sample]| pair[0].shot.course != pair[1].shot.course;
        self.has_changed |= !stays || before.windows(2).any(differs);
        self.quiet = if stays && grows { self.quiet + 1 } else { 0 };
        self.made += 1;
    }

    /// True if a ray without a motion to the end was scanned far enough.
    fn are_in_vain(&self) -> bool {
        self.made >= VAIN
    }

    /// True if faster starts lead away from the end.
    fn are_over(&self) -> bool {
        self.has_changed && self.quiet >= QUIET
    }
}

/// A scan along a direction.
struct Scan<'a> {
    aim: &'a mut dyn Aim,
    direction: &'a [f64],
    units: &'a [f64],
}

impl Scan<'_> {
    fn sample(&mut self, speed: f64) -> Sample {
        let w = unknowns(speed, self.direction, self.units);
        let shot = self.aim.shoot(&w, false);
        Sample { speed, shot }
    }

    /// Adds the start at a speed. If its sequence of impacts differs from that of the last start, first adds starts
    /// between them, by bisection, that locate the change.
    fn extend(&mut self, samples: &mut Vec<Sample>, speed: f64, halvings: u32) {
        let sample = self.sample(speed);
        if let Some(last) = samples.last() {
            let last = last.clone();
            self.halve(&last, &sample, halvings, samples);
        }
        samples.push(sample);
    }

    fn halve(&mut self, left: &Sample, right: &Sample, halvings: u32, samples: &mut Vec<Sample>) {
        if halvings == 0 || left.shot.course == right.shot.course {
            return;
        }
        let middle = self.sample(0.5 * (left.speed + right.speed));
        if middle.speed <= left.speed || middle.speed >= right.speed {
            return;
        }
        self.halve(left, &middle, halvings - 1, samples);
        samples.push(middle.clone());
        self.halve(&middle, right, halvings - 1, samples);
    }
}

/// The unknowns at a speed in a direction.
pub(super) fn unknowns(speed: f64, direction: &[f64], units: &[f64]) -> Vec<f64> {
    let pairs = direction.iter().zip(units);
    pairs.map(|(part, unit)| speed * part * unit).collect()
}

/// The stretches of starts with one sequence of impacts that reach the end with at least `least` impacts.
pub(super) fn windows(samples: &[Sample], least: usize) -> impl Iterator<Item = &[Sample]> {
    let stretches = samples.chunk_by(|left, right| left.shot.course == right.shot.course);
    stretches.filter(move |stretch| match &stretch[0].shot.course {
        Course::Reached(surfaces) => surfaces.len() >= least,
        Course::Beyond | Course::GivenUp | Course::Lost => false,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Motions that reach the end for speeds between two values, and have the given course elsewhere.
    struct Ends(Course, [f64; 2]);

    impl Aim for Ends {
        fn steps(&self) -> u64 {
            0
        }

        fn shoot(&mut self, w: &[f64], _with_slopes: bool) -> Shot {
            let [from, to] = self.1;
            Shot {
                course: match (from..to).contains(&w[0]) {
                    true => Course::Reached(Vec::new()),
                    false => self.0.clone(),
                },
                misses: vec![w[0]],
                slopes: Vec::new(),
                rounding: 0.0,
            }
        }
    }

    fn scanned(beyond: Course, between: [f64; 2]) -> Ray {
        let density = Density {
            first: 4,
            doubling: 4,
            halvings: 3,
            steps: 1000,
        };
        let speeds = Speeds {
            first: 2.0,
            most: 64.0,
            is_open: true,
        };
        ray(&mut Ends(beyond, between), &[1.0], &[1.0], density, speeds)
    }

    #[test]
    fn a_ray_goes_on_where_slow_starts_have_too_many_impacts() {
        let found = scanned(Course::Beyond, [9.0, 20.0]);
        assert!(found.samples.iter().any(reaches));
        assert!(found.is_bounded);
        let none = scanned(Course::Beyond, [1e6, 2e6]);
        assert!(!none.samples.iter().any(reaches) && none.samples.len() < 40);
    }

    #[test]
    fn a_ray_is_bounded_only_if_no_motion_was_given_up() {
        let bounded = scanned(Course::Beyond, [0.0, 1.0]);
        assert!(bounded.is_bounded);
        assert_eq!(bounded.given_up(), 0);
        let open = scanned(Course::GivenUp, [0.0, 1.0]);
        assert!(!open.is_bounded);
        assert!(open.given_up() > 4, "{}", open.given_up());
        let speeds = open.samples.iter().map(|sample| sample.speed);
        assert!(speeds.fold(0.0, f64::max) <= 4.0, "the scan goes on");
    }
}
