//! Hard cases with stored values of 50 or more digits: whispering galleries, grazes, accumulations, small inertia, a
//! glancing wall, long runs of the disk.

use dalembert::law::Law;
use dalembert::numbers::{Numbers, TaylorModel};
use dalembert::{Constrained, Impacting, Instance, StateVector, System};
use dalembert_cli::suite::{Setting, every_integrator};
use dalembert_stability::by_hand::{Gap, Point, Reset};
use dalembert_stability::course::{Course, End, vector};
use dalembert_stability::tables::elliptic_table;
use dalembert_stability::text::{Text, shipped, value};
use dalembert_tests::numeric::assert_near;
use dalembert_tests::reference::{number, numbers, read};
use serde_json::Value;

/// A free point outside the unit disk.
static DISK_OBSTACLE: Text = Text::new(
    "DiskObstacle {
        coordinates { x; y; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2;
        impacts { disk: x^2 + y^2 - 1 >= 0; }
    }",
);

/// A knife edge before a wall at y = 0.
static KNIFE_EDGE: Text = Text::new(
    "KnifeEdge {
        coordinates { x; y; theta; }
        lagrangian = (dot(x)^2 + dot(y)^2)/2 + dot(theta)^2/6;
        constraints { edge: sin(theta)*d(x) - cos(theta)*d(y) = 0; }
        impacts { wall: -y >= 0; }
    }",
);

fn settings() -> impl Iterator<Item = Setting> {
    every_integrator().iter().copied().map(Setting::free)
}

fn cases(document: &Value, name: &str) -> Vec<Value> {
    document[name]
        .as_array()
        .unwrap_or_else(|| panic!("no {name}"))
        .clone()
}

#[test]
fn whispering_galleries_keep_their_angle() {
    let table = elliptic_table(1.0, 1.0);
    for case in cases(&read("hard_cases"), "circle_whispering_gallery_R=1") {
        let count = case["impact_n"].as_u64().expect("a count");
        let angle = number(&case["angle_with_tangent"]);
        for setting in settings() {
            let start = numbers(&case["qdot0"]);
            let end = Course::new(&table, &[1.0, 0.0], &start, 1e6)
                .impacts(count)
                .run(setting);
            // Rounding errors give the angle with the tangent a relative error of `EPSILON/angle`. A chord adds twice
            // this angle to the polar angle.
            let bound = 256.0 * f64::EPSILON * count as f64 / angle;
            assert_eq!(end.hits.len() as u64, count, "{}", setting.words());
            assert_near("t", &[end.t], &[number(&case["t_n"])], bound);
            assert_near("q", &end.q, &numbers(&case["q_n"]), bound);
            assert_near("v", &end.qdot, &numbers(&case["qdot_plus_n"]), bound);
        }
    }
}

#[test]
fn grazes_of_a_disk_are_impacts_or_not_as_their_offset_says() {
    let obstacle = DISK_OBSTACLE.model();
    for case in cases(&read("hard_cases"), "grazing_disk_obstacle") {
        let offset = number(&case["offset"]);
        for setting in settings() {
            let end = Course::new(
                &obstacle,
                &numbers(&case["q0"]),
                &numbers(&case["qdot0"]),
                4.0,
            )
            .run(setting);
            let label = format!("{offset}, {}", setting.words());
            assert!(end.outcome.is_done(), "{label}: {}", end.outcome);
            if offset != 0.0 {
                assert_eq!(
                    end.hits.len() as u64,
                    case["impacts"].as_u64().expect("a count"),
                    "{label}"
                );
            }
            // The normal speed at the wall is the root of twice the offset. Its error is the rounding error of the gap
            // divided by the speed.
            let bound = 64.0 * f64::EPSILON / (2.0 * offset.abs()).sqrt().max(1e-8);
            assert_near(&label, &end.q, &numbers(&case["q_at_t=4"]), 2.0 * bound);
            if let (Some(hit), Some(t)) = (end.hits.first(), case.get("t")) {
                assert_near(&label, &[hit.t], &[number(t)], bound);
            }
        }
    }
}

#[test]
fn an_inelastic_ball_accumulates_where_and_after_how_many_impacts_it_must() {
    for case in cases(&read("hard_cases"), "inelastic_ball_zeno") {
        let ball = shipped("bouncing_ball").with([("m", 1.0), ("g", number(&case["g"]))]);
        let (e, limit) = (number(&case["e"]), number(&case["zeno_time"]));
        for setting in settings() {
            let end = Course::new(&ball, &[0.0], &[1.0], 2.0 * limit)
                .law(0, Law::Restitution(e))
                .run(setting);
            let dalembert::Outcome::Zeno { t, .. } = end.outcome else {
                panic!("e = {e}: {}", end.outcome)
            };
            assert_near("t", &[t], &[limit], 1e-10 * limit);
            let before = end.hits.iter().filter(|hit| hit.t < limit - 1e-6).count() as u64;
            let right = case["impacts_completed_before_zeno_minus_1e-6"]
                .as_u64()
                .expect("a count");
            // For e = 0.999 a flight at this time takes 1e-9, and the rounding errors of all flights add up to three
            // times that.
            let spread = if e > 0.99 { 8 } else { 0 };
            assert!(
                before.abs_diff(right) <= spread,
                "e = {e}: {before} impacts for {right}"
            );
            assert_near(
                "energy",
                &[end.energy],
                &[0.5 - number(&case["energy_lost_m=1"])],
                1e-12,
            );
        }
    }
}

#[test]
fn the_sleigh_keeps_its_digits_for_small_inertia() {
    for case in cases(&read("hard_cases"), "sleigh_small_I") {
        let inertia = number(&case["I"]);
        let values = [("m", 1.0), ("I", inertia), ("a", 0.2)];
        let sleigh = shipped("chaplygin_sleigh").with(values);
        let [q, qdot] = ["q", "qdot"].map(|name| vector(&numbers(&case[name])));
        let state = sleigh.state(0.0, &q, &qdot).expect("a state");
        // On D the multiplier is a difference of forces of size 1 and has their rounding errors.
        let reduced = sleigh.multipliers(0.0, &state).expect("multipliers");
        let reduced = reduced.as_slice()[0];
        let sleigh = sleigh.global().expect("the global form");
        let state = sleigh.state(0.0, &q, &qdot).expect("a state");
        let multiplier = sleigh.multipliers(0.0, &state).expect("multipliers");
        let multiplier = multiplier.as_slice()[0];
        assert!(
            (reduced - multiplier).abs() < 1e-15,
            "I = {inertia}: {reduced}"
        );
        let right = numbers(&case["multipliers"])[0];
        let share = multiplier / right - 1.0;
        // The angular velocity is a difference of momenta of size 1 divided by the inertia.
        let bound = 1e-12 + 1e-16 / inertia;
        assert!(
            share.abs() < bound,
            "I = {inertia}: {multiplier} for {right}"
        );
        assert_near(
            "energy",
            &[sleigh.energy(0.0, &state).expect("an energy")],
            &[number(&case["energy"])],
            1e-14,
        );
    }
}

#[test]
fn a_knife_edge_hits_a_glancing_wall_by_every_law() {
    let edge = KNIFE_EDGE.model();
    for case in cases(&read("hard_cases"), "knife_edge_glancing_wall") {
        let [q, qdot] = ["q", "qdot_minus"].map(|name| vector(&numbers(&case[name])));
        let state = edge.state(0.0, &q, &qdot).expect("a state");
        let contact = edge.contact(0, 0.0, &state).expect("a contact");
        // Momenta of size 1 have a normal component of size theta. Impulses of size 2/theta carry rounding errors.
        let bound =
            1e-14 * (1.0 + 100.0 * f64::EPSILON.sqrt() / number(&case["theta"]).powi(2).max(1e-16));
        let rho = number(&case["geometry"]["ratio_r"]);
        assert!(
            (contact.rho() / rho - 1.0).abs() < 1e-12,
            "rho {} for {rho}",
            contact.rho()
        );
        for (name, coefficient) in [
            ("elastic", f64::NAN),
            ("nonholonomic_plastic", f64::NAN),
            ("impact_plastic", f64::NAN),
            ("totally_plastic", f64::NAN),
            ("elastic_family_e=0.5", 0.5),
        ] {
            let law = Law::from_name(name, coefficient).unwrap_or(Law::Restitution(coefficient));
            let mut after = state;
            edge.kick(&mut after, contact.impulse(law), &contact.direction);
            let found = edge.velocity(0.0, &after).expect("a velocity");
            assert_near(
                name,
                found.as_slice(),
                &numbers(&case["laws"][name]["qdot_plus"]),
                bound,
            );
        }
    }
}

#[test]
fn the_disk_follows_its_reference_for_hundreds_of_impacts() {
    for case in cases(&read("hard_cases"), "long_horizon_disk") {
        let mut disk = shipped("rolling_disk").model();
        let parameters = &shipped("rolling_disk").description().parameters;
        for (index, parameter) in parameters.iter().enumerate() {
            disk.set_parameter(index, number(&case["parameters"][parameter.name]));
        }
        let start = numbers(&case["initial(x,y,theta,phi,thetadot,phidot)"]);
        let (phi, roll) = (start[3], start[4]);
        let [radius, ta, tb] = ["R", "ta", "tb"].map(|name| value(&disk, name));
        let velocity = [
            radius * phi.cos() * roll,
            radius * phi.sin() * roll,
            roll,
            start[5],
        ];
        let is_regular = ta == tb;
        for mark in cases(&case, "marks") {
            let count = mark["n"].as_u64().expect("a count");
            for setting in settings() {
                let end = Course::new(&disk, &start[..4], &velocity, 1e6)
                    .tol(1e-13)
                    .impacts(count)
                    .run(setting);
                let label = format!("{}, impact {count}, {}", case["label"], setting.words());
                let energy = number(&case["energy"]);
                assert!(
                    (end.energy / energy - 1.0).abs() < 1e-12,
                    "{label}: energy {}",
                    end.energy
                );
                assert_eq!(end.hits.len() as u64, count, "{label}");
                // On an ellipse neighbouring motions separate.
                if is_regular {
                    let t = number(&mark["t"]);
                    let (time, place) = match setting.integrator.order() {
                        Some(..8) => (1e-8, 1e-4),
                        _ => (1e-10, 1e-7),
                    };
                    assert!((end.t - t).abs() < time * t, "{label}: {} for {t}", end.t);
                    assert_near(&label, &end.q[..2], &numbers(&mark["q"])[..2], place);
                }
            }
        }
    }
}

/// A point under gravity over the curve of the case `alpha`. An impact reverses the vertical velocity, as on a
/// horizontal tread.
fn treads(alpha: f64) -> Point<1> {
    fn curve<L: Numbers>([a, v0]: [f64; 2], [x, y]: [L; 2]) -> L {
        let (b, slope) = (L::of(a * a), L::of(2.0_f64.sqrt() * v0));
        y - b * x * (slope - b * x)
    }
    fn at(shape: [f64; 2], point: [f64; 2]) -> (f64, [f64; 2]) {
        let ([a, v0], [x, _]) = (shape, point);
        let (b, slope) = (a * a, 2.0_f64.sqrt() * v0);
        (curve(shape, point), [2.0 * b * b * x - b * slope, 1.0])
    }
    let surface = match alpha {
        0.5 => Gap {
            at: |point| at([0.5, 1.0], point),
            along: |point| curve([0.5, 1.0], point),
        },
        _ => Gap {
            at: |point| at([0.75, 1.25], point),
            along: |point| curve([0.75, 1.25], point),
        },
    };
    let reset: Reset = |[vx, vy]| [vx, -vy];
    Point {
        acceleration: [0.0, -1.0],
        surfaces: [(surface, reset)],
    }
}

#[test]
fn rising_treads_are_hit_where_proposition_8_says() {
    for case in cases(&read("accumulations"), "prop8") {
        let (alpha, v0) = (number(&case["alpha"]), number(&case["v0"]));
        for setting in settings() {
            let end = Course::new(&treads(alpha), &[0.0, 0.0], &[1.0, v0], 10.0).run(setting);
            let dalembert::Outcome::Zeno { t, .. } = end.outcome else {
                panic!("alpha = {alpha}: {}", end.outcome)
            };
            assert_near("accumulation", &[t], &[number(&case["zeno_x=t"])], 1e-10);
            assert!(end.hits.len() >= 3, "{} impacts", end.hits.len());
            for (hit, right) in end.hits.iter().zip(cases(&case, "impacts")) {
                // The error of the time is the rounding error of the gap divided by the gap rate, which shrinks with
                // the speed.
                let speed = number(&right["ydot_plus"]);
                let bound = 1e-14 / speed;
                assert_near("t", &[hit.t], &[number(&right["x=t"])], bound);
                assert_near("y", &[hit.q[1]], &[number(&right["y"])], bound);
                assert_near("speed", &[hit.after[1]], &[speed], 4.0 * bound);
            }
        }
    }
}

#[test]
fn super_elastic_walls_are_hit_where_example_4_says() {
    let left = Gap {
        at: |[x, _]| (x, [1.0, 0.0]),
        along: |[x, _]| x,
    };
    let right = Gap {
        at: |[x, _]| (1.0 - x, [-1.0, 0.0]),
        along: |[x, _]| TaylorModel::of(1.0) - x,
    };
    let reset: Reset = |[vx, vy]| [-1.25 * vx, vy];
    let walls = Point {
        acceleration: [0.0; 2],
        surfaces: [(left, reset), (right, reset)],
    };
    for case in cases(&read("accumulations"), "example4") {
        let impacts = cases(&case, "impacts");
        for setting in settings() {
            let end: End = Course::new(&walls, &[0.0, 0.0], &[number(&case["v0"]), 0.0], 10.0)
                .impacts(impacts.len() as u64)
                .run(setting);
            assert_eq!(end.hits.len(), impacts.len());
            for (hit, right) in end.hits.iter().zip(&impacts) {
                let speed = number(&right["speed_plus"]);
                assert_near("t", &[hit.t], &[number(&right["t"])], 1e-13);
                assert_near("speed", &[hit.after[0].abs() / speed], &[1.0], 1e-13);
            }
        }
    }
}
