//! No impact is stepped over and none is invented. First impacts of random starts are compared with conservative
//! advancement along the exact flight: its steps in time are the gap divided by a bound on the gap rate, so that it
//! never passes a surface.
#![allow(missing_docs, clippy::unwrap_used, reason = "tests")]

use core::f64::consts::TAU;

use dalembert::{EventLog, Outcome, System, VectorField};
use dalembert_cli::Integrator;
use dalembert_stability::course::{Course, Random, vector};
use dalembert_stability::text::{Model, Text};
use dalembert_tests::flight::{Exact, Flight, SHALLOW, first_impact, point, size, towards};

/// A point over a bump that is narrow for small `s`.
static BUMP: Text = Text::new(
    "Bump {
        coordinates { x; y; }
        parameters { s > 0 = 0.1; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2;
        impacts { wall: y - exp(-(x/s)^2) >= 0; }
    }",
);

/// A point among three pegs, under the gravity `g`.
static PEGS: Text = Text::new(
    "Pegs {
        coordinates { x; y; }
        parameters { a[3] = [0, 1, 2]; b[3] = [0, 0, 0]; r[3] > 0 = [1, 1, 1]; g >= 0 = 0; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2 - g*y;
        impacts { peg[i in 1..=3]: sqrt((x - a[i])^2 + (y - b[i])^2) - r[i] >= 0; }
    }",
);

/// A point beside a slab and under a roof. Both gaps contain absolute values.
static SLAB: Text = Text::new(
    "Slab {
        coordinates { x; y; }
        parameters { a = 0; w > 0 = 1; h > 0 = 1; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2;
        impacts { slab: abs(x - a) - w >= 0; roof: h - y + abs(x - 2*a)/4 >= 0; }
    }",
);

/// A point and the tip of a needle that turns about the origin.
static NEEDLE: Text = Text::new(
    "Needle {
        coordinates { x; y; }
        parameters { l > 0 = 1; rho > 0 = 0.01; w = 3; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2;
        impacts { tip: sqrt((x - l*cos(w*t))^2 + (y - l*sin(w*t))^2) - rho >= 0; }
    }",
);

/// Parameters of a model, with its gaps in closed form.
trait Family: core::fmt::Debug {
    fn model(&self) -> Model;

    fn distances(&self, t: f64, point: [f64; 2]) -> Vec<f64>;

    /// Bound on the rate of every gap at this speed.
    fn fastest(&self, speed: f64) -> f64;
}

/// See [`BUMP`].
#[derive(Debug)]
struct Bump {
    s: f64,
}

/// See [`PEGS`].
#[derive(Debug)]
struct Pegs {
    a: [f64; 3],
    b: [f64; 3],
    r: [f64; 3],
    g: f64,
}

/// See [`SLAB`].
#[derive(Debug)]
struct Slab {
    a: f64,
    w: f64,
    h: f64,
}

/// See [`NEEDLE`].
#[derive(Debug)]
struct Needle {
    l: f64,
    rho: f64,
    w: f64,
}

impl Family for Bump {
    fn model(&self) -> Model {
        BUMP.with([("s", self.s)])
    }

    fn distances(&self, _: f64, [x, y]: [f64; 2]) -> Vec<f64> {
        vec![y - (-(x / self.s).powi(2)).exp()]
    }

    fn fastest(&self, speed: f64) -> f64 {
        // The slope of the bump is at most `sqrt(2/e)/s`.
        speed * (1.0 + 0.86 / self.s)
    }
}

impl Family for Pegs {
    fn model(&self) -> Model {
        let [a, b, r] = [self.a, self.b, self.r];
        PEGS.with([
            ("a.1", a[0]),
            ("a.2", a[1]),
            ("a.3", a[2]),
            ("b.1", b[0]),
            ("b.2", b[1]),
            ("b.3", b[2]),
            ("r.1", r[0]),
            ("r.2", r[1]),
            ("r.3", r[2]),
            ("g", self.g),
        ])
    }

    fn distances(&self, _: f64, [x, y]: [f64; 2]) -> Vec<f64> {
        (0..3)
            .map(|i| (x - self.a[i]).hypot(y - self.b[i]) - self.r[i])
            .collect()
    }

    fn fastest(&self, speed: f64) -> f64 {
        speed
    }
}

impl Family for Slab {
    fn model(&self) -> Model {
        SLAB.with([("a", self.a), ("w", self.w), ("h", self.h)])
    }

    fn distances(&self, _: f64, [x, y]: [f64; 2]) -> Vec<f64> {
        vec![
            (x - self.a).abs() - self.w,
            self.h - y + (x - 2.0 * self.a).abs() / 4.0,
        ]
    }

    fn fastest(&self, speed: f64) -> f64 {
        1.1 * speed
    }
}

impl Family for Needle {
    fn model(&self) -> Model {
        NEEDLE.with([("l", self.l), ("rho", self.rho), ("w", self.w)])
    }

    fn distances(&self, t: f64, [x, y]: [f64; 2]) -> Vec<f64> {
        let (sine, cosine) = (self.w * t).sin_cos();
        vec![(x - self.l * cosine).hypot(y - self.l * sine) - self.rho]
    }

    fn fastest(&self, speed: f64) -> f64 {
        speed + self.l * self.w.abs()
    }
}

/// Numbers of comparisons.
#[derive(Debug, Default)]
struct Tally {
    runs: u64,
    hits: u64,
    grazes: u64,
}

/// Compares the first impact of a run with the exact one.
fn compare(family: &dyn Family, setting: Setting<'_>, flight: &Flight, until: f64, exact: Exact) {
    let Setting {
        model,
        integrator,
        tol,
        step,
    } = setting;
    let [q, v] = [flight.q, flight.v].map(|pair| vector(&pair));
    let state = model.state_unchecked(0.0, &q, &v).unwrap();
    let mut log = EventLog::<<Model as VectorField>::State, 1>::new();
    let course = Course::from_state(model, state, until).tol(tol).impacts(1);
    let run = course.step(step).observed(integrator, &mut log);
    let first = log.iter().next().copied();
    let case = || {
        format!(
            "{}: {family:?} {flight:?} until {until}: {exact:?}, but {} {first:?}",
            integrator.name(),
            run.outcome
        )
    };
    match exact {
        Exact::Hits { t, surface } => {
            let event = first.unwrap_or_else(|| panic!("{}", case()));
            let fastest = family.fastest(flight.speed(until));
            let late = (event.t - t).abs() * fastest * SHALLOW;
            let allowed = 1e-11 * flight.scale(until);
            assert!(late <= allowed && event.surface == surface, "{}", case());
        }
        Exact::Passes => {
            assert_eq!(run.outcome, Outcome::Done, "{}", case());
            assert!(first.is_none(), "{}", case());
        }
        Exact::Grazes => {}
    }
}

/// A model, and the settings of its run.
#[derive(Clone, Copy)]
struct Setting<'a> {
    model: &'a Model,
    integrator: Integrator,
    tol: f64,
    step: f64,
}

/// Runs a flight with every integrator.
fn with_every_integrator(family: &dyn Family, flight: &Flight, until: f64, tally: &mut Tally) {
    let start = family.distances(0.0, flight.q);
    if start.iter().any(|gap| *gap <= 1e-6) {
        return;
    }
    let fastest = family.fastest(flight.speed(until));
    let distances = |t: f64| family.distances(t, flight.at(t));
    let exact = first_impact(flight, [0.0, until], fastest, &distances);
    tally.hits += u64::from(matches!(exact, Exact::Hits { .. }));
    tally.grazes += u64::from(exact == Exact::Grazes);
    let model = &family.model();
    let mut run = |integrator, tol, step| {
        let setting = Setting {
            model,
            integrator,
            tol,
            step,
        };
        compare(family, setting, flight, until, exact);
        tally.runs += 1;
    };
    for &integrator in Integrator::every() {
        match integrator.is_adaptive() {
            true => [1e-3, 1e-8, 1e-13].map(|tol| run(integrator, tol, f64::INFINITY)),
            false => [1.0, 7.0, 64.0].map(|parts| run(integrator, 1e-10, until / parts)),
        };
    }
}

/// A velocity of any direction and of many magnitudes.
fn velocity(random: &mut Random) -> [f64; 2] {
    let (angle, speed) = (random.between(0.0, TAU), size(random, 0.1, 10.0));
    [speed * angle.cos(), speed * angle.sin()]
}

/// Compares `count` random starts of every family.
fn try_starts(count: u32, seed: u64) {
    let mut random = Random::new(seed);
    let mut tally = Tally::default();
    for _ in 0..count {
        bump(&mut random, &mut tally);
        top(&mut random, &mut tally);
        pegs(&mut random, &mut tally);
        slab(&mut random, &mut tally);
        needle(&mut random, &mut tally);
    }
    println!("{tally:?}");
    assert!(tally.hits > u64::from(count) && tally.grazes < tally.runs / 100);
}

fn bump(random: &mut Random, tally: &mut Tally) {
    let bump = Bump {
        s: size(random, 1e-3, 0.3),
    };
    let flight = Flight {
        q: [-random.between(0.5, 2.0), random.between(0.01, 1.1)],
        v: [size(random, 0.1, 10.0), 0.0],
        g: 0.0,
    };
    let until = 4.0 / flight.v[0];
    with_every_integrator(&bump, &flight, until, tally);
}

/// Flights through the top of a bump that is about as wide as a step.
fn top(random: &mut Random, tally: &mut Tally) {
    let bump = Bump {
        s: size(random, 0.02, 0.5),
    };
    let flight = Flight {
        q: [-random.between(0.8, 2.0), 1.0 - size(random, 1e-4, 0.3)],
        v: [size(random, 0.1, 10.0), 0.0],
        g: 0.0,
    };
    let until = 4.0 / flight.v[0];
    with_every_integrator(&bump, &flight, until, tally);
}

fn pegs(random: &mut Random, tally: &mut Tally) {
    let table = size(random, 1.0, 1e4);
    let centre = |random: &mut Random| [(); 3].map(|()| random.between(-table, table));
    let (a, b) = (centre(random), centre(random));
    let g = match random.between(0.0, 1.0) < 0.5 {
        true => 0.0,
        false => size(random, 0.1, 10.0),
    };
    let pegs = Pegs {
        a,
        b,
        r: [(); 3].map(|()| size(random, 0.05, 1.0) * table.min(size(random, 1.0, 1e4))),
        g,
    };
    // About half of the flights aim at the first peg.
    let q = point(random, table);
    let mut v = velocity(random);
    let (speed, aimed) = (v[0].hypot(v[1]), random.between(0.0, 1.0) < 0.5);
    if aimed {
        let aim = point(random, pegs.r[0]);
        v = towards([a[0] + aim[0], b[0] + aim[1]], q, speed);
    }
    let until = match g == 0.0 {
        true => 4.0 * table / speed,
        false => 2.0 * (table / g).sqrt() + speed / g,
    };
    with_every_integrator(&pegs, &Flight { q, v, g }, until, tally);
}

fn slab(random: &mut Random, tally: &mut Tally) {
    let table = size(random, 1.0, 1e4);
    let slab = Slab {
        a: random.between(-table, table),
        w: size(random, 1e-6, 1.0),
        h: random.between(0.1, 2.0) * table,
    };
    let flight = Flight {
        q: point(random, table),
        v: velocity(random),
        g: 0.0,
    };
    let until = 4.0 * table / flight.speed(0.0);
    with_every_integrator(&slab, &flight, until, tally);
}

fn needle(random: &mut Random, tally: &mut Tally) {
    let needle = Needle {
        l: random.between(0.5, 2.0),
        rho: size(random, 1e-3, 0.3),
        w: random.between(-20.0, 20.0),
    };
    let flight = Flight {
        q: point(random, 3.0),
        v: velocity(random),
        g: 0.0,
    };
    let until = 6.0 / flight.speed(0.0).max(0.5);
    with_every_integrator(&needle, &flight, until, tally);
}

#[test]
fn first_impacts_are_those_of_exact_geometry() {
    try_starts(200, 1);
}

#[test]
#[ignore = "nightly: a hundred thousand starts"]
fn first_impacts_of_a_hundred_thousand_starts_are_those_of_exact_geometry() {
    try_starts(20_000, 2);
}
