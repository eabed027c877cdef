//! Proofs that periodic orbits exist. The enclosures contain references of many digits; where no proof is possible, the
//! reason is reported.
#![allow(missing_docs, clippy::unwrap_used, reason = "tests")]

use core::ops::ControlFlow;
use std::time::Instant;

use dalembert::certified::{CertifiedRun, CertifiedSection, NotProved};
use dalembert::math::larger;
use dalembert::numbers::Interval;
use dalembert_stability::text::Text;
use dalembert_tests::certified::{WALKER, about, digits, follow, holds, periodic};

/// A conveyor: `x` falls from 1 to 0 in one unit of time, while `y` grows by the factor `e^k`.
static CONVEYOR: Text = Text::new(
    "Conveyor {
        coordinates { x; y; }
        parameters { k = 1/2; }
        field { dot(x) = -1; dot(y) = k*y; }
        impacts { end: x >= 0 => reset { x = 1; y = y; }; }
    }",
);

/// The conveyor with a rate of `y` that depends on time.
static DRIVEN: Text = Text::new(
    "Driven {
        coordinates { x; y; }
        field { dot(x) = -1; dot(y) = sin(t) - y/2; }
        impacts { end: x >= 0 => reset { x = 1; y = y; }; }
    }",
);

/// Values from `walker_orbits.json`: the fixed point after the step, the period, and the derivative of the return map
/// in the last two components.
const POINT: [&str; 3] = [
    "0.4",
    "-0.902057449429909744803474157606",
    "0.991308369223558488691152728714",
];
const PERIOD: &str = "1.54496586406140337334630114218";
const DERIVATIVE: [[&str; 2]; 2] = [
    ["0.139944460399612839852821", "-0.291146549873031763103688"],
    ["-0.173354661929623761889794", "0.388121570702451501829324"],
];
const MULTIPLIER: f64 = 0.520_683_714_448_936_2;

#[test]
fn a_walkers_cycle_exists_and_attracts() {
    let walker = WALKER.model();
    let near = POINT.map(|digits| digits.parse::<f64>().unwrap());
    for radius in [1e-4, 1e-6, 1e-10] {
        let begun = Instant::now();
        let section = CertifiedSection::new(&walker, 0, 10.0)
            .with_parameter(2, about("0.4"))
            .with_parameter(3, about("0.4"));
        let orbit = periodic(&section, &near, radius).unwrap();
        let width = (0..3).map(|i| orbit.point(i).width()).fold(0.0, larger);
        println!(
            "radius {radius}: width {width:.1e}, period {:?}, multipliers below {} in {:.1?}",
            orbit.period,
            orbit.largest_multiplier,
            begun.elapsed()
        );
        for i in 0..3 {
            let (found, exact) = (orbit.point(i), digits(POINT[i]));
            assert!(holds(found, exact), "{i}: {found:?}");
        }
        assert!(holds(orbit.period, digits(PERIOD)), "{:?}", orbit.period);
        for i in 0..2 {
            for j in 0..2 {
                let (found, exact) = (orbit.derivative(i + 1, j + 1), DERIVATIVE[i][j]);
                assert!(holds(found, digits(exact)), "{i}, {j}: {found:?}, {exact}");
            }
        }
        assert!(orbit.largest_multiplier > MULTIPLIER && orbit.largest_multiplier < 0.53);
        assert!(width < 1e-12, "{width:e}");
    }
}

/// The first return of every motion from the box lies outside the box, so that the box contains no orbit of one return.
#[test]
fn no_orbit_is_proved_in_a_box_without_one() {
    const RADIUS: f64 = 1e-4;
    let walker = WALKER.model();
    let near = [0.4, -0.95, 1.05];
    let section = CertifiedSection::new(&walker, 0, 10.0);
    let found = periodic(&section, &near, RADIUS);
    assert_eq!(found.err(), Some(NotProved::NotContained));
    let start = near.map(|value| Interval::point(value).widened(RADIUS));
    let mut returned = None;
    let mut run = CertifiedRun::new(&walker, 0.0, |i| start[i]);
    follow(&mut run, 10.0, &mut |impact| {
        returned = Some([0, 1, 2].map(|i| impact.after(i)));
        ControlFlow::Break(())
    })
    .unwrap();
    let returned = returned.expect("a return");
    for i in [1, 2] {
        let common = returned[i].intersection(start[i]);
        assert!(common.is_none(), "{i}: {returned:?} from {start:?}");
    }
}

#[test]
fn a_cycle_of_two_returns_is_one_of_one() {
    let walker = WALKER.model();
    let near = POINT.map(|digits| digits.parse::<f64>().unwrap());
    let [once, twice] = [1, 2].map(|returns| {
        let section = CertifiedSection::new(&walker, 0, 10.0).with_returns(returns);
        periodic(&section, &near, 1e-8).unwrap()
    });
    assert!(
        twice
            .period
            .contains(Interval::point(2.0 * once.period.middle()))
    );
    assert!(twice.largest_multiplier < once.largest_multiplier * once.largest_multiplier * 1.01);
}

#[test]
fn motion_that_depends_on_time_has_no_cycle() {
    let driven = DRIVEN.model();
    let found = periodic(&CertifiedSection::new(&driven, 0, 20.0), &[1.0, 0.0], 1e-3);
    assert_eq!(found.err(), Some(NotProved::DependsOnTime));
}

#[test]
fn multipliers_of_a_cycle_are_bounded_whether_it_attracts_or_not() {
    for k in [-0.5_f64, 0.5] {
        let conveyor = CONVEYOR.with([("k", k)]);
        let section = CertifiedSection::new(&conveyor, 0, 20.0);
        let orbit = periodic(&section, &[1.0, 1e-4], 1e-3).unwrap();
        assert!(orbit.point(1).contains(Interval::point(0.0)) && orbit.point(1).width() < 1e-12);
        assert!(orbit.period.contains(Interval::point(1.0)) && orbit.period.width() < 1e-12);
        let exact = k.exp();
        assert!(
            orbit
                .derivative(1, 1)
                .widened(1e-15)
                .contains(Interval::point(exact))
        );
        assert!(
            orbit.largest_multiplier >= exact && orbit.largest_multiplier < 1.01 * exact,
            "{} beside {exact}",
            orbit.largest_multiplier
        );
    }
    // With k = 0 every y belongs to a periodic orbit.
    let conveyor = CONVEYOR.with([("k", 0.0)]);
    let found = periodic(
        &CertifiedSection::new(&conveyor, 0, 20.0),
        &[1.0, 0.0],
        1e-3,
    );
    assert_eq!(found.err(), Some(NotProved::Singular));
}

#[test]
fn a_section_that_is_not_met_again_proves_nothing() {
    let conveyor = CONVEYOR.model();
    let section = CertifiedSection::new(&conveyor, 0, 0.5);
    let found = periodic(&section, &[1.0, 0.0], 1e-3);
    assert_eq!(found.err(), Some(NotProved::NotMet));
}
