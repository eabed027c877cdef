//! Search for roots, which are starts whose motion ends as given.
//!
//! With one unknown, both rays of starts are scanned, and every stretch with one sequence of impacts is searched by
//! brackets ([`line`](super::line)). With more unknowns, rays in many directions are scanned. Newton's method continues
//! from the starts of each stretch that come closest to the end. With two unknowns, the angle between directions is
//! halved where their sequences of impacts differ. With three unknowns or more, the search also tries starts that the
//! problem itself guesses ([`Aim::guess`]). Finally, known roots are divided out, and the closest starts are tried
//! again.

use super::Stage;
use super::aim::{Aim, Course};
use super::directions;
use super::line;
use super::newton::{Arrival, Newton, is_same};
use super::scan::{self, Density, Ray, Sample, Speeds, windows};
use super::units::Units;
use crate::linear::norm;

/// [`Speeds::first`] in multiples of the speed that the problem suggests.
const FIRST: f64 = 4.0;

/// Largest speed of a scan in multiples of the first, with and without surfaces. It is larger with surfaces, because
/// faster starts may meet them.
const MOST: [f64; 2] = [65_536.0, 4.0];

/// Largest miss of a root, in multiples of the size of the coordinates.
const NEAR: f64 = 1e-9;

/// Maximum number of halvings of the angle between neighbouring directions in the plane.
const TURNS: u32 = 3;

/// Maximum number of starts per sequence of impacts that are tried again with known roots divided out.
const AGAIN: usize = 6;

/// Maximum number of starts per sequence of impacts from which Newton's method starts.
const TRIED: usize = 240;

/// Number of integrator steps after which no further direction is scanned, and after which no further start is tried.
/// This limit holds only if the problem has guesses and no surfaces: with surfaces, the scan is needed to find the
/// sequences of impacts.
const SPENT: u64 = 50_000;

/// Extent of a search.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Plan {
    /// Least number of impacts.
    pub least: usize,
    /// Number of directions, for two unknowns or more. The default depends on the number of unknowns.
    pub directions: Option<usize>,
    /// Seed of the directions.
    pub seed: u64,
    /// Half the square of the largest speed. By default the scan determines it.
    pub kinetic: Option<f64>,
    /// Number of starts of an envelope in each direction.
    pub envelope: usize,
}

/// A root of the search.
#[derive(Debug, Clone)]
pub(crate) struct Root {
    /// The unknowns.
    pub w: Vec<f64>,
    /// The unknowns, each divided by its unit.
    y: Vec<f64>,
}

/// Result of a search.
#[derive(Debug, Clone, Default)]
pub(crate) struct Found {
    pub roots: Vec<Root>,
    /// Unknowns of the starts of an envelope.
    pub fan: Vec<Vec<f64>>,
    pub directions: usize,
    pub kinetic: f64,
    pub is_bounded: bool,
    pub unresolved: usize,
    /// Number of starts whose motion was given up.
    pub given_up: usize,
    /// Largest miss that rounding alone may cause on the way of Newton's method from unknowns of 0.
    pub rounding: f64,
}

/// A start for Newton's method.
#[derive(Debug, Clone)]
struct Candidate {
    course: Course,
    miss: f64,
    y: Vec<f64>,
}

/// A search.
pub(crate) struct Search<'a> {
    aim: &'a mut dyn Aim,
    plan: &'a Plan,
    units: Units,
    unknowns: usize,
    tell: &'a mut dyn FnMut(Stage),
    found: Found,
}

impl<'a> Search<'a> {
    /// A search over the motions of a problem, with the units of its unknowns.
    pub fn of(
        aim: &'a mut dyn Aim,
        plan: &'a Plan,
        units: Units,
        tell: &'a mut dyn FnMut(Stage),
    ) -> Self {
        Self {
            unknowns: units.unknowns.len(),
            units,
            aim,
            plan,
            tell,
            found: Found {
                is_bounded: true,
                ..Found::default()
            },
        }
    }

    /// Runs the search.
    pub fn found(mut self) -> Found {
        if self.unknowns > 0 {
            self.start_at_rest();
        }
        match self.unknowns {
            0 => self.fixed(),
            1 => self.on_a_line(),
            2 => self.in_the_plane(),
            _ => self.in_space(),
        }
        self.found
    }

    fn speeds(&self) -> Speeds {
        let first = FIRST * self.units.speed;
        match self.plan.kinetic {
            Some(kinetic) => {
                let most = (2.0 * kinetic).sqrt();
                Speeds {
                    first: first.min(most),
                    most,
                    is_open: false,
                }
            }
            None => Speeds {
                first,
                most: first * MOST[usize::from(!self.units.has_surfaces)],
                is_open: true,
            },
        }
    }

    fn near(&self) -> f64 {
        NEAR * self.units.size
    }

    /// True for a motion to the end with enough impacts.
    fn counts(&self, course: &Course) -> bool {
        matches!(course, Course::Reached(surfaces) if surfaces.len() >= self.plan.least)
    }

    /// The search without unknowns: there is one motion.
    fn fixed(&mut self) {
        let shot = self.aim.shoot(&[], false);
        let is_near = shot.misses.iter().all(|miss| miss.abs() <= self.near());
        if is_near && self.counts(&shot.course) {
            self.keep(&[]);
        }
    }

    /// Newton's method from unknowns of 0. Where the end depends linearly on the unknowns, its first step leads to the
    /// only root, however far away.
    fn start_at_rest(&mut self) {
        let zeros = vec![0.0; self.unknowns];
        let shot = self.aim.shoot(&zeros, true);
        if !self.counts(&shot.course) {
            return;
        }
        let is_open = self.plan.kinetic.is_none();
        let mut newton = self.newton(&shot.course);
        if is_open {
            newton.most = newton.most.max(newton.length(&shot));
        }
        let arrival = newton.search(&zeros, &[], false);
        self.found.rounding = newton.rounding;
        if let Arrival::Root(y) = arrival {
            self.keep(&y);
        }
    }

    /// Scans a ray, and records its extent.
    fn scan(&mut self, direction: &[f64], density: Density) -> Ray {
        let speeds = self.speeds();
        let ray = scan::ray(self.aim, direction, &self.units.unknowns, density, speeds);
        self.found.directions += 1;
        self.found.is_bounded &= ray.is_bounded;
        self.found.given_up += ray.given_up();
        let last = ray.samples.last().map_or(0.0, |sample| sample.speed);
        self.found.kinetic = self.found.kinetic.max(0.5 * last * last);
        ray
    }

    fn on_a_line(&mut self) {
        let density = Density {
            first: 160,
            doubling: 24,
            halvings: 40,
            steps: 200_000,
        };
        for (done, side) in [1.0, -1.0].into_iter().enumerate() {
            let ray = self.scan(&[side], density);
            let unit = side * self.units.unknowns[0];
            for window in windows(&ray.samples, self.plan.least) {
                for equation in 0..window[0].shot.misses.len() {
                    self.solve(window, unit, equation);
                }
            }
            self.spread(&ray, unit);
            self.note(done + 1, 2);
        }
    }

    /// Solves one of the equations on a stretch, and keeps the solutions that satisfy all equations.
    fn solve(&mut self, window: &[Sample], unit: f64, equation: usize) {
        let near = self.near();
        let (roots, unresolved) = line::roots(self.aim, window, unit, near, equation);
        self.found.unresolved += unresolved;
        for w in roots {
            let shot = self.aim.shoot(&[w], true);
            let near = shot.near(near);
            if shot.misses.iter().all(|miss| miss.abs() <= near) {
                self.keep(&[w / self.units.unknowns[0]]);
            }
        }
    }

    /// Chooses the starts of an envelope, at equally spaced speeds up to the fastest start that meets a surface.
    fn spread(&mut self, ray: &Ray, unit: f64) {
        let meets = |it: &&Sample| match &it.shot.course {
            Course::Reached(surfaces) => !surfaces.is_empty(),
            Course::Beyond => true,
            Course::GivenUp | Course::Lost => false,
        };
        let fastest = ray.samples.iter().rev().find(meets);
        let fastest = fastest.map_or(self.speeds().first, |it| it.speed);
        let count = self.plan.envelope;
        let at = |index: usize| fastest * (index as f64 + 0.5) / count as f64;
        let fan = (0..count).map(|index| vec![at(index) * unit]);
        self.found.fan.extend(fan);
    }

    /// Keeps a root, given by the unknowns divided by their units, unless it is known. Returns true if it is new.
    fn keep(&mut self, y: &[f64]) -> bool {
        let speed = self.units.speed;
        let is_known = |root: &Root| is_same(&root.y, y, speed);
        if self.found.roots.iter().any(is_known) {
            return false;
        }
        let units = self.units.unknowns.iter();
        let w = y.iter().zip(units).map(|(y, unit)| y * unit).collect();
        self.found.roots.push(Root { w, y: y.to_vec() });
        true
    }

    fn note(&mut self, done: usize, all: usize) {
        let found = self.found.roots.len();
        (self.tell)(Stage { done, all, found });
    }

    fn in_the_plane(&mut self) {
        let count = self.plan.directions.unwrap_or(directions::default_count(2));
        let turn = directions::turn(self.plan.seed);
        let angle = |index: usize| turn + std::f64::consts::TAU * index as f64 / count as f64;
        let mut candidates = Vec::new();
        let mut last = self.fan(angle(0), &mut candidates);
        for index in 1..=count {
            let next = self.fan(angle(index), &mut candidates);
            self.between(
                [angle(index - 1), angle(index)],
                [&last, &next],
                TURNS,
                &mut candidates,
            );
            last = next;
            self.note(index, 2 * count);
        }
        self.pursue(candidates);
    }

    /// Scans the ray at an angle. Returns its sequences of impacts.
    fn fan(&mut self, angle: f64, candidates: &mut Vec<Candidate>) -> Vec<Course> {
        self.gather(&[angle.cos(), angle.sin()], candidates)
    }

    /// Scans between two rays whose sequences of impacts differ.
    fn between(
        &mut self,
        [from, to]: [f64; 2],
        [left, right]: [&Vec<Course>; 2],
        turns: u32,
        candidates: &mut Vec<Candidate>,
    ) {
        if turns == 0 || left == right {
            return;
        }
        let angle = 0.5 * (from + to);
        let middle = self.fan(angle, candidates);
        self.between([from, angle], [left, &middle], turns - 1, candidates);
        self.between([angle, to], [&middle, right], turns - 1, candidates);
    }

    fn in_space(&mut self) {
        let count = directions::default_count(self.unknowns);
        let count = self.plan.directions.unwrap_or(count);
        let mut candidates = Vec::new();
        self.guess(&mut candidates);
        let all = directions::on_sphere(self.unknowns, count, self.plan.seed);
        let begun = self.aim.steps();
        for (index, direction) in all.iter().enumerate() {
            if self.is_spent(begun) {
                self.found.is_bounded = false;
                break;
            }
            self.gather(direction, &mut candidates);
            self.note(count + index + 1, 3 * count);
        }
        self.pursue(candidates);
    }

    /// True if the limit [`SPENT`] applies and more steps than that were made since their number was `begun`.
    fn is_spent(&self, begun: u64) -> bool {
        let relies_on_guesses = self.aim.guesses() > 0 && !self.units.has_surfaces;
        relies_on_guesses && self.aim.steps() - begun > SPENT
    }

    /// Adds the starts that the problem itself guesses.
    fn guess(&mut self, candidates: &mut Vec<Candidate>) {
        let count = self.aim.guesses();
        for index in 0..count {
            self.note(index, 3 * count);
            let Some(w) = self.aim.guess(index) else {
                continue;
            };
            let shot = self.aim.shoot(&w, false);
            if self.counts(&shot.course) {
                candidates.push(Candidate {
                    miss: norm(&shot.misses),
                    course: shot.course,
                    y: w.iter()
                        .zip(&self.units.unknowns)
                        .map(|(w, unit)| w / unit)
                        .collect(),
                });
            }
        }
    }

    /// Scans a ray, and adds the local minima of the miss on each stretch. Returns the sequences of impacts.
    fn gather(&mut self, direction: &[f64], candidates: &mut Vec<Candidate>) -> Vec<Course> {
        let density = Density {
            first: 24,
            doubling: 6,
            halvings: 7,
            steps: 3000,
        };
        let ray = self.scan(direction, density);
        let mut courses = Vec::new();
        for window in windows(&ray.samples, self.plan.least) {
            courses.push(window[0].shot.course.clone());
            let misses: Vec<f64> = window.iter().map(Sample::miss).collect();
            for (index, sample) in window.iter().enumerate() {
                let before = index.checked_sub(1).map_or(f64::INFINITY, |it| misses[it]);
                let after = misses.get(index + 1).copied().unwrap_or(f64::INFINITY);
                if misses[index] < before && misses[index] <= after && misses[index].is_finite() {
                    candidates.push(Candidate {
                        course: sample.shot.course.clone(),
                        miss: misses[index],
                        y: direction.iter().map(|part| part * sample.speed).collect(),
                    });
                }
            }
        }
        courses
    }

    /// Runs Newton's method from the candidates of each sequence of impacts, in order of their miss.
    fn pursue(&mut self, mut candidates: Vec<Candidate>) {
        let key = |it: &Candidate| match &it.course {
            Course::Reached(surfaces) => (surfaces.len(), surfaces.clone()),
            Course::Beyond | Course::GivenUp | Course::Lost => (usize::MAX, Vec::new()),
        };
        candidates.sort_by(|left, right| {
            let courses = key(left).cmp(&key(right));
            courses.then(left.miss.total_cmp(&right.miss))
        });
        let groups = || candidates.chunk_by(|left, right| left.course == right.course);
        let all: usize = groups().map(|group| group.len().min(TRIED)).sum();
        let mut done = 0;
        // Stages of a search: guesses (three unknowns or more), the scan, Newton's method.
        let parts = if self.unknowns > 2 { 3 } else { 2 };
        let begun = self.aim.steps();
        for group in groups() {
            let mut known = Vec::new();
            for candidate in group.iter().take(TRIED) {
                if self.is_spent(begun) {
                    break;
                }
                self.try_from(candidate, &mut known, false);
                done += 1;
                self.note((parts - 1) * all + done, parts * all);
            }
            for candidate in group.iter().take(AGAIN) {
                while !known.is_empty()
                    && !self.is_spent(begun)
                    && self.try_from(candidate, &mut known, true)
                {}
            }
        }
    }

    /// Newton's method for motions with this sequence of impacts.
    fn newton<'n>(&'n mut self, course: &'n Course) -> Newton<'n> {
        let (most, near) = (self.speeds().most, self.near());
        Newton {
            aim: self.aim,
            units: &self.units.unknowns,
            course,
            most,
            near,
            least: self.units.speed,
            rounding: 0.0,
        }
    }

    /// Runs Newton's method from a candidate. Returns true if it finds a new root.
    fn try_from(
        &mut self,
        candidate: &Candidate,
        known: &mut Vec<Vec<f64>>,
        deflated: bool,
    ) -> bool {
        let mut newton = self.newton(&candidate.course);
        let Arrival::Root(y) = newton.search(&candidate.y, known, deflated) else {
            return false;
        };
        let is_new = self.keep(&y);
        known.push(y);
        is_new
    }
}
