//! Section F, third part: the energy over many steps of fixed length. Structure-preserving integrators keep it near its
//! initial value in the cases that theory covers; the curves of the last case show its growth in others.

use dalembert::integrate::Chosen;
use dalembert::math::larger;
use dalembert::{
    Dla2, Dla4, Gauss4, Gauss6, Instance, Projection, Rk4, Scene, Stepper, System, Tolerance,
    VectorField,
};
use dalembert_cli::suite::{Case, Report, Run};
use dalembert_driver::drift::{Request, Series, follow};

use super::course::vector;
use super::text::{Model, Text, shipped};

/// A knife edge in a quadratic potential, steered by a pendulum. `c` couples the steering to the position; `b` is a
/// magnetic field.
static STEERED_EDGE: Text = Text::new(
    "SteeredEdge {
        coordinates { x; y; phi: angle; }
        parameters { k > 0 = 2; s = 0.4; c = 0; b = 0; }
        lagrangian = (dot(x)^2 + dot(y)^2 + dot(phi)^2)/2 + b*(x*dot(y) - y*dot(x))/2
            - (x^2 + k*y^2)/2 + s*cos(phi) + c*x*sin(phi);
        constraints { edge: sin(phi)*d(x) - cos(phi)*d(y) = 0; }
    }",
);

/// The nonholonomic particle in a non-separable potential.
static HELD_PARTICLE: Text = Text::new(
    "HeldParticle {
        coordinates { x; y; z; }
        lagrangian = (dot(x)^2 + dot(y)^2 + dot(z)^2)/2 - (x^2 + y^2 + z^2 + x^2*z^2)/2;
        constraints { contact: d(z) - y*d(x) = 0; }
    }",
);

/// Numbers of steps of the quick and of the long cases.
const QUICK: u64 = 20_000;
const LONG: u64 = 1_000_000;

/// The cases.
pub const CASES: &[Case] = &[
    Case {
        id: "F16",
        title: "energy of regular motion over 2e4 steps of Gauss's methods",
        right: "bounded, without drift",
        bound: "the error that was measured over 1e6 steps",
        run: Run::Once(|report| symplectic(report, QUICK)),
        ..Case::QUICK
    },
    Case {
        id: "F16b",
        title: "energy of regular motion over 1e6 steps of Gauss's methods",
        right: "bounded, without drift: exponent below 0.1",
        bound: "4e-8 and 2e-11 of the double pendulum at steps of 0.02; RK4 drifts with exponent 1",
        run: Run::Once(|report| symplectic(report, LONG)),
        ..Case::NIGHTLY
    },
    Case {
        id: "F17",
        title: "energy of regular reversible motion over 2e4 steps of the discrete principle",
        right: "bounded, without drift",
        bound: "the error that was measured over 1e6 steps",
        run: Run::Once(|report| nonholonomic(report, QUICK)),
        ..Case::QUICK
    },
    Case {
        id: "F17b",
        title: "energy of regular reversible motion over 1e6 steps of the discrete principle",
        right: "bounded, without drift: exponent below 0.1",
        bound: "5e-4 and 4e-8 of the knife edge at steps of 0.05",
        run: Run::Once(|report| nonholonomic(report, LONG)),
        ..Case::NIGHTLY
    },
    Case {
        id: "F18b",
        title: "energy over 1e6 steps where no invariant bounds it",
        right: "it grows: chaotic motion in a magnetic field; Gauss's method in global form, which leaves D",
        bound: "exponents above 0.2 and 1.5; bounded in the form reduced to D",
        run: Run::Once(growing),
        ..Case::NIGHTLY
    },
];

/// A run of fixed steps.
struct Long<'a> {
    report: &'a mut Report,
    steps: u64,
}

impl Long<'_> {
    /// The energy in a hundred windows; adds its curve to the report.
    fn energy(
        &mut self,
        system: &Model,
        [q, qdot]: [&[f64]; 2],
        h: f64,
        (stepper, effects): (Chosen<'_, Model>, <Model as Scene>::Effects),
    ) -> Series {
        let state = system
            .state_projected(0.0, &vector(q), &vector(qdot))
            .expect("a state");
        let request = Request {
            until: self.steps as f64 * h,
            windows: 100,
            quantity: |t: f64, state: &<Model as VectorField>::State| {
                system.energy(t, state).unwrap_or(f64::NAN)
            },
        };
        let model = system.description().name;
        let name = format!("{model}, {}, step {h}", stepper.name());
        let series = follow(system, state, (stepper, effects), request).expect("a start");
        self.report.class(&series.outcome, "done");
        self.report
            .equal(format!("{name}: steps"), series.steps, self.steps);
        let mut worst = 0.0_f64;
        let largest = series.windows.iter().map(|window| {
            worst = larger(worst, window.largest);
            [window.t, worst]
        });
        let axes = ["time", "largest error of the energy so far"];
        self.report.curve(name, axes, largest.collect());
        series
    }

    fn below(&mut self, series: &Series, bound: f64) {
        self.report
            .error(format!("energy, of {bound:.0e}"), series.largest(), bound);
    }

    /// Checks that the energy error is at most `largest`, and in long cases that its drift is at most `drift`.
    fn bounded(&mut self, series: &Series, largest: f64, drift: f64) {
        self.below(series, largest);
        if self.steps == LONG {
            self.report.error(
                format!("drift, of {drift:.0e}"),
                series.drift().abs(),
                drift,
            );
            self.report
                .error("exponent", series.exponent().max(0.0), 0.1);
        }
    }

    fn grows(&mut self, series: &Series, exponent: f64) {
        if self.steps == LONG {
            self.report
                .error("least exponent over exponent", exponent, series.exponent());
        }
    }
}

macro_rules! energy {
    ($long:ident, $method:ident, $h:expr, $system:expr, $start:expr) => {
        energy!($long, $method, $h, $system, $start, Default::default())
    };
    ($long:ident, $method:ident, $h:expr, $system:expr, $start:expr, $effects:expr) => {{
        let stepper = $method::new(Tolerance::new(1e-9).expect("a tolerance"));
        let mut stepper = stepper.with_step($h);
        $long.energy(&$system, $start, $h, (Chosen::new(&mut stepper), $effects))
    }};
}

fn symplectic(report: &mut Report, steps: u64) {
    let mut long = Long { report, steps };
    let oscillator = shipped("harmonic_oscillator").model();
    let start: [&[f64]; 2] = [&[1.0], &[0.0]];
    // Gauss's methods keep quadratic invariants. The only error is a random walk of rounding errors of 1e-16 each.
    let series = energy!(long, Gauss4, 0.1, oscillator, start);
    long.below(&series, 2e-14);
    let series = energy!(long, Gauss6, 0.1, oscillator, start);
    long.below(&series, 2e-14);
    let classical = energy!(long, Rk4, 0.1, oscillator, start);
    long.grows(&classical, 0.95);

    let pendulum = shipped("double_pendulum").model();
    let start: [&[f64]; 2] = [&[0.4, 0.3], &[0.0, 0.0]];
    let series = energy!(long, Gauss4, 0.02, pendulum, start);
    long.bounded(&series, 4e-8, 4e-12);
    // The drift is rounding error only: over eight starts it has either sign and a root mean square of 1.4e-14. The
    // bound is four times as large.
    let series = energy!(long, Gauss6, 0.02, pendulum, start);
    long.bounded(&series, 2e-11, 6e-14);
    // At a quarter of the step, the error of the method equals the rounding error.
    let series = energy!(long, Gauss6, 0.005, pendulum, start);
    long.below(&series, 4e-14);
    let series = energy!(long, Dla2, 0.02, pendulum, start);
    long.bounded(&series, 1e-4, 5e-8);
    let series = energy!(long, Dla4, 0.02, pendulum, start);
    long.bounded(&series, 2e-8, 4e-12);
    let classical = energy!(long, Rk4, 0.02, pendulum, start);
    long.grows(&classical, 0.95);
}

fn nonholonomic(report: &mut Report, steps: u64) {
    let mut long = Long { report, steps };
    let disk = shipped("rolling_disk").model();
    let start: [&[f64]; 2] = [&[0.0, 0.0, 0.0, 0.3], &[0.0, 0.0, 10.0, 0.7]];
    let free = energy!(long, Dla2, 0.02, disk, start);
    long.below(&free, 1e-11 * free.start);

    let edge = STEERED_EDGE.model();
    let start: [&[f64]; 2] = [&[1.0, 0.2, 0.3], &[0.5, 0.0, 0.7]];
    let series = energy!(long, Dla2, 0.05, edge, start);
    long.bounded(&series, 5e-4, 2e-7);
    let series = energy!(long, Dla4, 0.05, edge, start);
    long.bounded(&series, 4e-8, 2e-11);
    let particle = HELD_PARTICLE.model();
    let start: [&[f64]; 2] = [&[1.0, 0.2, 0.3], &[0.5, 0.4, 0.0]];
    let series = energy!(long, Dla2, 0.05, particle, start);
    long.bounded(&series, 6e-4, 2e-6);
    let series = energy!(long, Dla4, 0.05, particle, start);
    long.bounded(&series, 2e-8, 2e-11);
}

fn growing(report: &mut Report) {
    let mut long = Long {
        report,
        steps: LONG,
    };
    let start: [&[f64]; 2] = [&[1.0, 0.2, 0.3], &[0.5, 0.0, 0.7]];
    // The coupling to the position and the magnetic field make the motion chaotic and not reversible. The energy
    // performs a random walk.
    let wild = STEERED_EDGE.with([("c", 0.5), ("b", 0.8)]);
    let second = energy!(long, Dla2, 0.05, wild, start);
    long.grows(&second, 0.3);
    let fourth = energy!(long, Dla4, 0.05, wild, start);
    long.grows(&fourth, 0.2);
    // In global form, Gauss's method leaves D, and the energy drifts. The effect that projects on D is not symmetric.
    // The reduced form needs no projection.
    let reduced = STEERED_EDGE.model();
    let edge = reduced.global().expect("the global form");
    let leaving = energy!(long, Gauss4, 0.05, edge, start);
    long.grows(&leaving, 1.5);
    let projected = (Some(Projection::new()), None, None);
    let returned = energy!(long, Gauss4, 0.05, edge, start, projected);
    long.below(&returned, 1e-5);
    long.grows(&returned, 0.8);
    let series = energy!(long, Gauss4, 0.05, reduced, start);
    long.bounded(&series, 1e-6, 1e-9);
}
