//! Families of surfaces with distances in closed form, and random starts among the surfaces.

use core::f64::consts::{PI, TAU};

use dalembert::math::larger;
use dalembert_stability::course::Random;
use dalembert_stability::text::{Model, Text};
use dalembert_tests::flight::{Flight, direction, point, size, towards};

/// Distances from every surface at a time and a position.
type Distances = Box<dyn Fn(f64, [f64; 2]) -> Vec<f64>>;

/// A model and a flight.
pub struct Case {
    pub model: Model,
    pub flight: Flight,
    pub until: f64,
    /// Bound on the rate of every distance.
    pub fastest: f64,
    /// A time at which the motion has left the surface on which it starts; 0 if it starts on none.
    pub after: f64,
    distances: Distances,
}

impl Case {
    /// The distances along the flight.
    pub fn distances(&self, t: f64) -> Vec<f64> {
        (self.distances)(t, self.flight.at(t))
    }

    /// Scale of the coordinates along the flight.
    pub fn scale(&self) -> f64 {
        self.flight.scale(self.until)
    }

    /// True if the flight is at most 1e-6 away from a surface, or behind it, at the time `after`.
    pub fn is_at_hand(&self) -> bool {
        self.distances(self.after)
            .iter()
            .any(|distance| *distance <= 1e-6)
    }
}

/// All families.
pub const FAMILIES: [fn(&mut Random) -> Case; 9] = [
    disks, pegs, post, diamond, moving, turning, waves, twins, leaving,
];

/// Number of pegs in a row, and of rows.
pub const PEGS: [usize; 2] = [4, 2];

/// Models of three disks whose gaps are functions of the distance with the same sign and zero.
macro_rules! disks {
    ($($gap:literal),*) => {[$(Text::new(concat!(
        "Disks { coordinates { x; y; } parameters { a[3] = 0; b[3] = 0; r[3] > 0 = 1; g = 0; }
        let dist[i in 1..=3] = sqrt((x - a[i])^2 + (y - b[i])^2) - r[i];
        lagrangian = (dot(x)^2 + dot(y)^2)/2 - g*y;
        impacts { disk[i in 1..=3]: ", $gap, " >= 0; } }"
    ))),*]};
}

static DISKS: [Text; 8] = disks![
    "dist[i]",
    "1e-6*dist[i]",
    "1e6*dist[i]",
    "tanh(dist[i])",
    "dist[i]^3 + dist[i]/1000",
    "dist[i]/(1 + dist[i]^2)",
    "atan(3*dist[i])",
    "ln((dist[i] + r[i])/r[i])"
];

static PEGBOARD: Text = Text::new(
    "Pegs { coordinates { x; y; } parameters { s > 0 = 1; r > 0 = 0.1; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2;
        impacts { peg[i in 1..=8]: sqrt((x - s*(i % 4))^2 + (y - s*(i - i % 4)/4)^2) - r >= 0; } }",
);

static DIAMOND: Text = Text::new(
    "Diamond { coordinates { x; y; } parameters { a = 0; b = 0; r > 0 = 1; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2;
        impacts { diamond: abs(x - a) + abs(y - b) - r >= 0; } }",
);

static MOVING: Text = Text::new(
    "Moving { coordinates { x; y; } parameters { A > 0 = 1; w = 1; a = 0; b = 0; u = 0; v = 0; r > 0 = 1; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2;
        impacts {
            wall: x + 3 - A*sin(w*t) >= 0;
            disk: sqrt((x - a - u*t)^2 + (y - b - v*t)^2) - r >= 0;
        } }",
);

static TURNING: Text = Text::new(
    "Turning { coordinates { x; y; } parameters { w = 1; thin > 0 = 0.01; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2;
        impacts { slab: abs(y*cos(w*t) - x*sin(w*t)) - thin >= 0; } }",
);

static WAVES: Text = Text::new(
    "Waves { coordinates { x; y; } parameters { k > 0 = 1; c = 0; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2;
        impacts { corridor: sin(k*x + c) >= 0; fence: y + 1 - cos(40*x)/50 >= 0; } }",
);

static TWINS: Text = Text::new(
    "Twins { coordinates { x; y; } parameters { c = 1; far = 1e-9; slope = 0; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2;
        impacts { first: c - x >= 0; second: c + far - x + slope*y >= 0; } }",
);

/// A free flight among pegs on a square lattice.
pub fn pegs(random: &mut Random) -> Case {
    let s = size(random, 1.0, 1e4);
    let r = s * size(random, 0.01, 0.45);
    let [row, rows] = PEGS;
    let side = row as f64;
    let speed = size(random, 0.1, 10.0);
    let flight = Flight {
        q: [(); 2].map(|()| s * random.between(-1.0, side)),
        v: direction(random, speed),
        g: 0.0,
    };
    let centres = (1..=row * rows).map(|i| [i % row, i / row]);
    let centres: Vec<[f64; 2]> = centres.map(|at| at.map(|k| s * k as f64)).collect();
    Case {
        model: PEGBOARD.with([("s", s), ("r", r)]),
        flight,
        until: 2.0 * side * s / speed,
        fastest: speed,
        after: 0.0,
        distances: Box::new(move |_, [x, y]| {
            let distances = centres.iter().map(|[a, b]| (x - a).hypot(y - b) - r);
            distances.collect()
        }),
    }
}

fn disks(random: &mut Random) -> Case {
    let table = size(random, 1.0, 1e4);
    let [a, b] = [(); 2].map(|()| [(); 3].map(|()| random.between(-table, table)));
    let r = [(); 3].map(|()| size(random, 0.01, 1.0) * table);
    let g = match random.between(0.0, 1.0) < 0.5 {
        true => 0.0,
        false => size(random, 0.1, 10.0),
    };
    let text = &DISKS[random.between(0.0, 8.0) as usize];
    let model = text.with([
        ("a.1", a[0]),
        ("a.2", a[1]),
        ("a.3", a[2]),
        ("b.1", b[0]),
        ("b.2", b[1]),
        ("b.3", b[2]),
        ("r.1", r[0]),
        ("r.2", r[1]),
        ("r.3", r[2]),
        ("g", g),
    ]);
    let q = point(random, table);
    let speed = size(random, 0.1, 10.0);
    let aim = point(random, r[0]);
    let v = match random.between(0.0, 1.0) < 0.5 {
        true => towards([a[0] + aim[0], b[0] + aim[1]], q, speed),
        false => direction(random, speed),
    };
    let until = match g == 0.0 {
        true => 4.0 * table / speed,
        false => 2.0 * (table / g).sqrt() + speed / g,
    };
    let flight = Flight { q, v, g };
    Case {
        model,
        flight,
        until,
        fastest: flight.speed(until),
        after: 0.0,
        distances: Box::new(move |_, [x, y]| {
            (0..3).map(|i| (x - a[i]).hypot(y - b[i]) - r[i]).collect()
        }),
    }
}

fn post(random: &mut Random) -> Case {
    let (far, thin) = (size(random, 1.0, 1e4), size(random, 1e-3, 1.0));
    let angle = random.between(0.0, TAU);
    let place = [far * angle.cos(), far * angle.sin()];
    let thin = thin.min(0.3 * far);
    let away = 1e9;
    let model = DISKS[random.between(0.0, 8.0) as usize].with([
        ("a.1", place[0]),
        ("b.1", place[1]),
        ("r.1", thin),
        ("a.2", away),
        ("b.2", away),
        ("r.2", 1.0),
        ("a.3", -away),
        ("b.3", away),
        ("r.3", 1.0),
    ]);
    let speed = size(random, 0.1, 10.0);
    let aside = 1.5 * thin * random.between(-1.0, 1.0);
    let aim = [
        place[0] - aside * angle.sin(),
        place[1] + aside * angle.cos(),
    ];
    let flight = Flight {
        q: [0.0; 2],
        v: towards(aim, [0.0; 2], speed),
        g: 0.0,
    };
    Case {
        model,
        flight,
        until: 1.5 * far / speed,
        fastest: speed,
        after: 0.0,
        distances: Box::new(move |_, [x, y]| vec![(x - place[0]).hypot(y - place[1]) - thin]),
    }
}

fn diamond(random: &mut Random) -> Case {
    let table = size(random, 1.0, 1e4);
    let ([a, b], r) = (point(random, table), size(random, 1e-3, 1.0) * table);
    let q = point(random, table);
    let aim = point(random, r);
    let speed = size(random, 0.1, 10.0);
    let v = towards([a + aim[0], b + aim[1]], q, speed);
    Case {
        model: DIAMOND.with([("a", a), ("b", b), ("r", r)]),
        flight: Flight { q, v, g: 0.0 },
        until: 4.0 * table / speed,
        fastest: 1.5 * speed,
        after: 0.0,
        distances: Box::new(move |_, [x, y]| vec![(x - a).abs() + (y - b).abs() - r]),
    }
}

fn moving(random: &mut Random) -> Case {
    let (swing, w) = (size(random, 1e-3, 1.0), size(random, 0.1, 100.0));
    let ([a, b], [u, v], r) = (
        point(random, 5.0),
        point(random, 3.0),
        size(random, 1e-3, 1.0),
    );
    let q = [random.between(-1.5, 5.0), random.between(-5.0, 5.0)];
    let speed = size(random, 0.1, 10.0);
    let way = direction(random, speed);
    Case {
        model: MOVING.with([
            ("A", swing),
            ("w", w),
            ("a", a),
            ("b", b),
            ("u", u),
            ("v", v),
            ("r", r),
        ]),
        flight: Flight { q, v: way, g: 0.0 },
        until: 8.0 / speed,
        fastest: speed + (swing * w).max(u.hypot(v)),
        after: 0.0,
        distances: Box::new(move |t, [x, y]| {
            vec![
                x + 3.0 - swing * (w * t).sin(),
                (x - a - u * t).hypot(y - b - v * t) - r,
            ]
        }),
    }
}

fn turning(random: &mut Random) -> Case {
    let (w, thin) = (random.between(-20.0, 20.0), size(random, 1e-4, 0.3));
    let q = point(random, 3.0);
    let speed = size(random, 0.1, 10.0);
    let v = direction(random, speed);
    let until = 3.0 / speed.max(0.5);
    let reach = q[0].hypot(q[1]) + speed * until;
    Case {
        model: TURNING.with([("w", w), ("thin", thin)]),
        flight: Flight { q, v, g: 0.0 },
        until,
        fastest: speed + w.abs() * reach,
        after: 0.0,
        distances: Box::new(move |t, [x, y]| {
            let (sine, cosine) = (w * t).sin_cos();
            vec![(y * cosine - x * sine).abs() - thin]
        }),
    }
}

fn waves(random: &mut Random) -> Case {
    let (k, c) = (size(random, 1e-3, 100.0), random.between(-PI, PI));
    // The start lies in the corridor with a phase from 0 to pi.
    let x = (random.between(0.01, PI - 0.01) - c) / k;
    let q = [x, random.between(-0.9, 3.0)];
    let speed = size(random, 0.1, 10.0);
    let v = direction(random, speed);
    Case {
        model: WAVES.with([("k", k), ("c", c)]),
        flight: Flight { q, v, g: 0.0 },
        until: (2.0 * PI / k).min(1e3) / speed,
        fastest: 2.0 * speed,
        after: 0.0,
        distances: Box::new(move |_, [x, y]| {
            let phase = k * x + c;
            vec![phase.min(PI - phase) / k, y + 1.0 - (40.0 * x).cos() / 50.0]
        }),
    }
}

fn twins(random: &mut Random) -> Case {
    let c = size(random, 1.0, 1e3);
    let far = random.between(-1.0, 1.0) * 1e-9 * c;
    let slope = random.between(-1.0, 1.0) * size(random, 1e-12, 1e-6);
    let q = [random.between(-1.0, 0.9), random.between(-1.0, 1.0)];
    let speed = size(random, 0.1, 10.0);
    let angle = random.between(-1.4, 1.4);
    let v = [speed * angle.cos(), speed * angle.sin()];
    Case {
        model: TWINS.with([("c", c), ("far", far), ("slope", slope)]),
        flight: Flight { q, v, g: 0.0 },
        until: 2.0 * (c + 2.0) / v[0],
        fastest: 1.01 * speed,
        after: 0.0,
        distances: Box::new(move |_, [x, y]| vec![c - x, c + far - x + slope * y]),
    }
}

fn leaving(random: &mut Random) -> Case {
    let mut case = disks(random);
    case.flight.g = 0.0;
    // The start lies on the first disk, up to rounding errors.
    let value = |name: &str| dalembert_stability::text::value(&case.model, name);
    let (a, b, r) = (value("a.1"), value("b.1"), value("r.1"));
    let angle = random.between(0.0, TAU);
    let turned = angle + random.between(-1.5, 1.5);
    let speed = size(random, 0.1, 10.0);
    case.flight.q = [a + r * angle.cos(), b + r * angle.sin()];
    case.flight.v = [speed * turned.cos(), speed * turned.sin()];
    let table = [a, b, r]
        .into_iter()
        .fold(1.0, |size: f64, course| larger(size, course.abs()));
    case.until = 4.0 * table / speed;
    case.fastest = speed;
    case.after = 1e-3 * r / speed;
    dalembert_stability::text::set(&mut case.model, "g", 0.0);
    case
}
