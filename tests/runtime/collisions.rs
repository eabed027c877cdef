//! Quantities that a step of fixed size preserves across an impact inside it.
#![allow(missing_docs, clippy::unwrap_used, reason = "tests")]

use core::ops::ControlFlow;

use dalembert::integrate::{ComposedPrinciple, FixedStep, Gauss, Method, MidpointPrinciple};
use dalembert::math::larger;
use dalembert::numbers::{Numbers, TaylorModel};
use dalembert::{
    Contact, Fault, Impacting, Impacts, Lagrangian, Law, Observer, Outcome, ParameterError,
    Segment, Simulation, Stepper, System, Tolerance, VectorField,
};
use nalgebra::SVector;

type Scalar = SVector<f64, 1>;
type Plane = SVector<f64, 2>;

/// A point of mass 1 in the potential `x^4/4 + x^3/5`, with walls at -0.3 and at `far`.
#[derive(Clone, Copy)]
struct Well {
    far: f64,
    drag: f64,
    law: Law,
}

const WELL: Well = Well {
    far: 10.0,
    drag: 0.0,
    law: Law::Elastic,
};

impl Well {
    /// A state between the walls.
    fn start(&self) -> Plane {
        Plane::new(self.far.min(1.0) - 0.05, 0.8)
    }
}

impl VectorField for Well {
    type State = Plane;

    fn rate(&self, _: f64, state: &Plane, rate: &mut Plane) -> Result<(), Fault> {
        let [x, v] = [state[0], state[1]];
        *rate = Plane::new(v, -x * x * x - 0.6 * x * x - self.drag * v);
        Ok(())
    }
}

impl System for Well {
    type Vector = Scalar;
    type Impulse = Scalar;

    fn position(&self, state: &Plane) -> Scalar {
        Scalar::new(state[0])
    }

    fn velocity(&self, _: f64, state: &Plane) -> Result<Scalar, Fault> {
        Ok(Scalar::new(state[1]))
    }

    fn momentum(&self, t: f64, state: &Plane) -> Result<Scalar, Fault> {
        self.velocity(t, state)
    }

    fn state_unchecked(&self, _: f64, q: &Scalar, qdot: &Scalar) -> Result<Plane, Fault> {
        Ok(Plane::new(q[0], qdot[0]))
    }

    fn state_from_momenta(&self, t: f64, q: &Scalar, p: &Scalar) -> Result<Plane, Fault> {
        self.state_unchecked(t, q, p)
    }

    fn energy(&self, _: f64, state: &Plane) -> Result<f64, Fault> {
        let [x, v] = [state[0], state[1]];
        Ok(0.5 * v * v + 0.25 * x.powi(4) + 0.2 * x.powi(3))
    }

    fn conserves_energy(&self) -> bool {
        self.drag == 0.0
    }

    fn kick(&self, state: &mut Plane, size: f64, direction: &Scalar) {
        state[1] += size * direction[0];
    }

    fn check_parameters(&self) -> Result<(), ParameterError> {
        Ok(())
    }
}

impl Lagrangian for Well {
    type Reactions = SVector<f64, 0>;

    fn force(&self, _: f64, q: &Scalar, qdot: &Scalar) -> Scalar {
        let x = q[0];
        Scalar::new(-x * x * x - 0.6 * x * x - self.drag * qdot[0])
    }

    fn reaction_force(&self, _: f64, _: &Scalar, _: &Self::Reactions) -> Scalar {
        Scalar::zeros()
    }

    fn constrained_velocity(
        &self,
        _: f64,
        _: &Scalar,
        p: &Scalar,
    ) -> Result<(Scalar, Self::Reactions), Fault> {
        Ok((*p, SVector::zeros()))
    }
}

impl Impacting for Well {
    type Gaps = Plane;

    fn gaps(&self, _: f64, state: &Plane) -> Plane {
        Plane::new(state[0] + 0.3, self.far - state[0])
    }

    fn gap_along(
        &self,
        surface: usize,
        _: TaylorModel,
        component: &dyn Fn(usize) -> TaylorModel,
    ) -> TaylorModel {
        match surface {
            0 => component(0) + TaylorModel::of(0.3),
            _ => TaylorModel::of(self.far) - component(0),
        }
    }

    fn gap_rates(&self, _: f64, state: &Plane) -> Result<Plane, Fault> {
        Ok(Plane::new(state[1], -state[1]))
    }

    fn law(&self, _: usize) -> Law {
        self.law
    }

    fn contact(&self, surface: usize, _: f64, state: &Plane) -> Result<Contact<Scalar>, Fault> {
        let side = if surface == 0 { 1.0 } else { -1.0 };
        Ok(Contact {
            gap_rate: side * state[1],
            constrained_rate: side * state[1],
            surface_rate: 0.0,
            constrained_compliance: 1.0,
            free_compliance: 1.0,
            direction: Scalar::new(side),
        })
    }
}

fn with_step<M: Method>(h: f64) -> FixedStep<Plane, M> {
    FixedStep::new(Tolerance::new(1e-10).unwrap()).with_step(h)
}

fn end<Step: Stepper<Well>>(well: &Well, stepper: Step, start: Plane, t_end: f64) -> Plane {
    let run = Simulation::new(well, stepper, Impacts::declared(well))
        .run(0.0, start, t_end, &mut ())
        .unwrap();
    assert_eq!(run.outcome, Outcome::Done);
    run.state
}

/// Differences of the energies of a run from its first energy: their sum and number in each tenth of the run, and the
/// largest of their absolute values.
#[derive(Default)]
struct Energies {
    until: f64,
    sums: [(f64, u32); 10],
    first: Option<f64>,
    largest: f64,
}

impl Observer<Well> for Energies {
    fn step(&mut self, segment: &mut Segment<'_, Plane>) -> ControlFlow<()> {
        let energy = WELL.energy(0.0, segment.end()).unwrap();
        let part = ((10.0 * segment.t_end() / self.until) as usize).min(9);
        let first = *self.first.get_or_insert(energy);
        self.sums[part].0 += energy - first;
        self.sums[part].1 += 1;
        self.largest = larger(self.largest, (energy - first).abs());
        ControlFlow::Continue(())
    }
}

impl Energies {
    fn of<M: Method>(well: &Well, h: f64, until: f64) -> Self
    where
        FixedStep<Plane, M>: Stepper<Well>,
    {
        let mut energies = Self {
            until,
            ..Self::default()
        };
        let run = Simulation::new(well, with_step::<M>(h), Impacts::declared(well))
            .run(0.0, well.start(), until, &mut energies)
            .unwrap();
        assert_eq!(run.outcome, Outcome::Done);
        energies
    }

    /// The mean energy over the last tenth minus that over the first.
    fn drift(&self) -> f64 {
        let mean = |part: usize| self.sums[part].0 / f64::from(self.sums[part].1);
        mean(9) - mean(0)
    }
}

/// The determinant of the derivative of the map over one step, by extrapolated differences.
fn determinant<M: Method>(well: &Well, h: f64, start: Plane) -> f64
where
    FixedStep<Plane, M>: Stepper<Well>,
{
    let derivative = |direction: Plane| {
        let mut rows = [Plane::zeros(); 5];
        for (k, row) in rows.iter_mut().enumerate() {
            let size = 0.5_f64.powi(k as i32 + 6);
            let ends = [1.0, -1.0].map(|sign| {
                end(
                    well,
                    with_step::<M>(h),
                    start + direction * (sign * size),
                    h,
                )
            });
            *row = (ends[0] - ends[1]) / (2.0 * size);
        }
        for order in 1..rows.len() {
            let gain = 4.0_f64.powi(order as i32);
            for k in (order..rows.len()).rev() {
                rows[k] = (rows[k] * gain - rows[k - 1]) / (gain - 1.0);
            }
        }
        rows[4]
    };
    let (a, b) = (
        derivative(Plane::new(1.0, 0.0)),
        derivative(Plane::new(0.0, 1.0)),
    );
    a[0] * b[1] - a[1] * b[0]
}

/// Lengths of a step, and starts whose motion meets the wall early or late in this step.
const MEETING: [(f64, [f64; 2]); 4] = [
    (0.4, [-0.15, -0.8]),
    (0.4, [-0.2, -0.8]),
    (0.8, [0.0, -0.9]),
    (0.8, [-0.1, -0.7]),
];

#[test]
fn the_step_across_an_impact_keeps_areas() {
    for (h, [x, v]) in MEETING {
        let start = Plane::new(x, v);
        let defects = [
            determinant::<Gauss<2>>(&WELL, h, start) - 1.0,
            determinant::<Gauss<3>>(&WELL, h, start) - 1.0,
        ];
        assert!(
            defects.iter().all(|defect| defect.abs() <= 1e-12),
            "{h} {x}: {defects:?}"
        );
    }
}

#[test]
fn energy_stays_over_impacts() {
    for far in [10.0, 1.0 + 1e-9] {
        let well = Well { far, ..WELL };
        let four = Energies::of::<Gauss<2>>(&well, 0.05, 4e3);
        assert!(four.largest < 3e-7, "{far}: {}", four.largest);
        assert!(four.drift().abs() < 1e-9, "{far}: {}", four.drift());
        let six = Energies::of::<Gauss<3>>(&well, 0.05, 4e3);
        assert!(six.largest < 1e-10, "{far}: {}", six.largest);
        assert!(six.drift().abs() < 1e-11, "{far}: {}", six.drift());
    }
}

#[test]
#[ignore = "nightly: 1e6 units of time take a minute"]
fn energy_stays_over_a_million_units_of_time() {
    let four = Energies::of::<Gauss<2>>(&WELL, 0.05, 1e6);
    assert!(
        four.largest < 3e-7 && four.drift().abs() < 1e-9,
        "{} {}",
        four.largest,
        four.drift()
    );
    let six = Energies::of::<Gauss<3>>(&WELL, 0.05, 1e6);
    assert!(
        six.largest < 1e-10 && six.drift().abs() < 1e-11,
        "{} {}",
        six.largest,
        six.drift()
    );
}

#[test]
fn the_discrete_principle_keeps_energy_over_impacts() {
    let two = Energies::of::<MidpointPrinciple>(&WELL, 0.05, 4e3);
    assert!(
        two.largest < 3e-3 && two.drift().abs() < 1e-6,
        "{} {}",
        two.largest,
        two.drift()
    );
    let four = Energies::of::<ComposedPrinciple>(&WELL, 0.05, 4e3);
    assert!(
        four.largest < 3e-5 && four.drift().abs() < 1e-9,
        "{} {}",
        four.largest,
        four.drift()
    );
}

#[test]
fn several_impacts_in_one_step_keep_the_energy_near() {
    // The walls are 0.1 apart; the point crosses this distance in less than half a step.
    let well = Well { far: -0.2, ..WELL };
    let run = Energies::of::<Gauss<2>>(&well, 0.3, 3e3);
    assert!(run.largest < 1e-4, "{}", run.largest);
}

#[test]
fn steps_after_an_impact_are_those_of_the_grid() {
    struct Grid(Vec<f64>);
    impl Observer<Well> for Grid {
        fn step(&mut self, segment: &mut Segment<'_, Plane>) -> ControlFlow<()> {
            self.0.push(segment.t_end());
            ControlFlow::Continue(())
        }
    }
    let mut ends = Grid(Vec::new());
    let run = Simulation::new(
        &WELL,
        with_step::<Gauss<2>>(0.0625),
        Impacts::declared(&WELL),
    )
    .run(0.0, Plane::new(1.0, 0.5), 100.0, &mut ends)
    .unwrap();
    assert!(run.counters.impacts > 10);
    let beside = ends.0.iter().filter(|t| (*t / 0.0625).fract() != 0.0);
    assert_eq!(beside.count() as u64, run.counters.impacts);
    assert_eq!(ends.0.len() as u64, 1600 + run.counters.impacts);
}

#[test]
fn errors_across_impacts_fall_with_the_order() {
    for (drag, law) in [
        (0.0, Law::Elastic),
        (0.05, Law::Elastic),
        (0.0, Law::Restitution(0.9)),
    ] {
        let well = Well { drag, law, ..WELL };
        let start = Plane::new(1.0, 0.5);
        let truth = end(&well, with_step::<Gauss<3>>(1.0 / 512.0), start, 8.0);
        let error = |h: f64| (end(&well, with_step::<Gauss<2>>(h), start, 8.0) - truth).amax();
        let [coarse, fine] = [error(0.125), error(0.03125)];
        assert!(
            coarse > 150.0 * fine && coarse < 1e-3,
            "{drag}: {coarse:e} {fine:e}"
        );
    }
}
