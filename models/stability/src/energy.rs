//! Section F, second part: the energy over many elastic impacts.

use core::ops::ControlFlow;

use dalembert::math::larger;
use dalembert::{Event, Observer, System, VectorField};
use dalembert_cli::Integrator;
use dalembert_cli::suite::{Case, Report, Run, Setting};

use super::course::{Course, Random, U};
use super::location::FALL;
use super::text::{Model, shipped, value};

const WALK: &str = "rounding errors that add up like a random walk";
const BOUND: &str = "root mean square below 16 u sqrt(n); exponent at most 0.6";

/// Power series, whose steps are exact up to rounding errors.
const SERIES: &[Integrator] = &[Integrator::Taylor];

/// Runge-Kutta methods with an embedded error estimate.
const TABLES: &[Integrator] = &[Integrator::Dop853, Integrator::Dopri5];

/// The cases.
pub const CASES: &[Case] = &[
    Case {
        id: "F04",
        title: "energy of elastic balls from 32 starts over 2^12 impacts",
        right: WALK,
        bound: BOUND,
        run: Run::Chosen(SERIES, |setting, report| balls(setting, report, 12)),
        ..Case::QUICK
    },
    Case {
        id: "F04b",
        title: "energy of elastic balls from 32 starts over 2^20 impacts",
        right: WALK,
        bound: BOUND,
        run: Run::Chosen(SERIES, |setting, report| balls(setting, report, 20)),
        ..Case::NIGHTLY
    },
    Case {
        id: "F04c",
        title: "energy of elastic balls from 32 starts over 2^12 impacts, Runge-Kutta",
        right: WALK,
        bound: BOUND,
        run: Run::Chosen(TABLES, |setting, report| balls(setting, report, 12)),
        ..Case::QUICK
    },
    Case {
        id: "F15",
        title: "energy of the elastic disk from 32 starts over 2^12 impacts",
        right: WALK,
        bound: BOUND,
        run: Run::Chosen(SERIES, |setting, report| disks(setting, report, 12)),
        ..Case::QUICK
    },
    Case {
        id: "F15b",
        title: "energy of the elastic disk from 32 starts over 2^20 impacts",
        right: WALK,
        bound: BOUND,
        run: Run::Chosen(SERIES, |setting, report| disks(setting, report, 20)),
        ..Case::NIGHTLY
    },
];

/// Number of runs.
const STARTS: u32 = 32;

/// Number of impacts from which the exponent of the random walk is fitted.
const FIRST: f64 = 64.0;

fn balls(setting: Setting, report: &mut Report, doublings: u32) {
    let mut random = Random::new(4);
    let mut walk = Walk::new(doublings);
    let ball = FALL.model();
    for _ in 0..STARTS {
        let speed = random.between(0.5, 2.0);
        let course = Course::new(&ball, &[0.0], &[speed], 1e9);
        walk.follow(&ball, course, setting, report);
    }
    walk.judge(report);
}

fn disks(setting: Setting, report: &mut Report, doublings: u32) {
    let mut walk = Walk::new(doublings);
    // The disk rolls and turns in the middle of the table.
    let (disk, upright) = (
        shipped("rolling_disk").model(),
        core::f64::consts::FRAC_PI_2,
    );
    let radius = value(&disk, "R");
    for start in 0..STARTS {
        let roll = 8.0 + 0.125 * f64::from(start);
        let velocity = [
            radius * upright.cos() * roll,
            radius * upright.sin() * roll,
            roll,
            0.2,
        ];
        let course = Course::new(&disk, &[0.0, 0.0, 0.0, upright], &velocity, 1e8).tol(1e-15);
        walk.follow(&disk, course, setting, report);
    }
    walk.judge(report);
}

/// Squares of relative energy errors at impacts 1, 2, 4, .., summed over starts.
struct Walk {
    doublings: u32,
    squares: Vec<f64>,
}

impl Walk {
    fn new(doublings: u32) -> Self {
        Self {
            doublings,
            squares: vec![0.0; doublings as usize + 1],
        }
    }

    fn follow<'a>(
        &mut self,
        system: &'a Model,
        course: Course<'a, Model>,
        setting: Setting,
        report: &mut Report,
    ) {
        let course = course.impacts(1 << self.doublings);
        let mut energies = Energies {
            system,
            start: system.energy(0.0, course.start()).unwrap_or(f64::NAN),
            count: 0,
            squares: &mut self.squares,
        };
        let end = course.follow(setting, &mut energies);
        report.class(&end.outcome, "impact_budget");
    }

    fn judge(self, report: &mut Report) {
        let squares = self.squares.iter().enumerate();
        let mean = |sum: f64| (sum / f64::from(STARTS)).sqrt();
        let points: Vec<[f64; 2]> = squares
            .map(|(power, sum)| [2.0_f64.powi(power as i32), mean(*sum)])
            .collect();
        let share = points
            .iter()
            .map(|[n, error]| error / (16.0 * U * n.sqrt()));
        report.error("worst drift over its bound", share.fold(0.0, larger), 1.0);
        // An error of 0 has no logarithm, and shows no growth.
        let is_late = |[n, error]: &[f64; 2]| *n >= FIRST && *error != 0.0;
        let late: Vec<[f64; 2]> = points.iter().copied().filter(is_late).collect();
        let exponent = dalembert_cli::suite::exponent(&late).unwrap_or(0.0);
        report.error(format!("exponent from {FIRST} impacts on"), exponent, 0.6);
        report.curve(
            "energy",
            ["impacts", "root mean square of the relative error"],
            points,
        );
    }
}

struct Energies<'a> {
    system: &'a Model,
    start: f64,
    count: u64,
    squares: &'a mut [f64],
}

impl Observer<Model> for Energies<'_> {
    fn event(&mut self, event: &Event<<Model as VectorField>::State>) -> ControlFlow<()> {
        self.count += 1;
        if self.count.is_power_of_two() {
            let energy = self
                .system
                .energy(event.t, &event.after)
                .unwrap_or(f64::NAN);
            self.squares[self.count.ilog2() as usize] += (energy / self.start - 1.0).powi(2);
        }
        ControlFlow::Continue(())
    }
}
