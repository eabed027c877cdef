//! Systems written by hand, so that the command line is tested without the generator: a ball on a floor, an oscillator
//! with a view of the plane, a bead that a constraint holds on a line, and systems with an unsure event search.
//!
//! All but the last have the metric `m` times the identity.

mod particle;
mod unsure;

use dalembert::declaration::Described;
use dalembert::describe::{
    Assumption, ConstraintInfo, CoordinateInfo, Description, Initial, Instance, ParameterInfo,
    Report, SurfaceInfo, Topology, ViewInfo,
};
use dalembert::erased::Held;
use dalembert::error::ParameterError;
use dalembert::jet::LENGTH;
use dalembert::law::{Contact, Law};
use dalembert::numbers::{Bent, Numbers, TaylorModel};
use dalembert::{
    Fault, Impacting, Impacts, Lagrangian, Scene, StateError, System, TaylorField, VectorField,
};
use nalgebra::SVector;

use particle::{Particle, field, free, particle, system};
pub use unsure::Unsure;

/// Quantities that every model reports.
fn inspect_common<S: System>(
    system: &S,
    t: f64,
    state: &S::State,
    report: &mut dyn Report,
) -> Result<(), Fault>
where
    S::Vector: AsRef<[f64]>,
{
    report.vector("q", system.position(state).as_ref());
    report.vector("qdot", system.velocity(t, state)?.as_ref());
    report.vector("p", system.momentum(t, state)?.as_ref());
    report.scalar("energy", system.energy(t, state)?);
    Ok(())
}

/// Entries of a description.
#[derive(Clone, Copy)]
struct Facts {
    type_name: &'static str,
    name: &'static str,
    documentation: &'static str,
    source: &'static str,
    coordinates: &'static [CoordinateInfo],
    parameters: &'static [ParameterInfo],
    constraints: &'static [ConstraintInfo],
    surfaces: &'static [SurfaceInfo],
    outputs: &'static [&'static str],
    /// The axis labels of a region in the plane of the first two coordinates.
    region: Option<[&'static str; 2]>,
}

const NOTHING: Facts = Facts {
    type_name: "",
    name: "",
    documentation: "",
    source: "",
    coordinates: &[],
    parameters: &[],
    constraints: &[],
    surfaces: &[],
    outputs: &[],
    region: None,
};

impl Facts {
    const fn described(self) -> Description {
        Description {
            type_name: self.type_name,
            name: self.name,
            documentation: Held::Static(self.documentation),
            source: Held::Static(self.source),
            is_first_order: false,
            coordinates: Held::Static(self.coordinates),
            parameters: Held::Static(self.parameters),
            constraints: Held::Static(self.constraints),
            quasi_velocities: Held::Static(&[]),
            forces: Held::Static(&[]),
            surfaces: Held::Static(self.surfaces),
            outputs: Held::Static(self.outputs),
            integrals: Held::Static(&[]),
            scenes: Held::Static(&["all"]),
            modes: Held::Static(&[]),
            view: match self.region {
                Some([x, y]) => Some(ViewInfo {
                    labels: [Held::Static(x), Held::Static(y)],
                    plane: Some([0, 1]),
                    region: true,
                }),
                None => None,
            },
        }
    }
}

const fn line(name: &'static str) -> CoordinateInfo {
    CoordinateInfo {
        name,
        topology: Topology::Line,
    }
}

const fn positive(name: &'static str, default: Option<f64>) -> ParameterInfo {
    ParameterInfo {
        name,
        assumption: Assumption::Positive,
        default,
    }
}

/// A ball above a floor.
#[derive(Debug, Clone)]
pub struct BouncingBall {
    m: f64,
    g: f64,
}

impl Particle<1> for BouncingBall {
    fn mass(&self) -> f64 {
        self.m
    }

    fn force(&self, _q: &[f64; 1]) -> [f64; 1] {
        [-self.m * self.g]
    }

    fn potential(&self, q: &[f64; 1]) -> f64 {
        self.m * self.g * q[0]
    }
}

particle!(BouncingBall, 1, 2, {});

free!(BouncingBall, 1);

impl Impacting for BouncingBall {
    type Gaps = SVector<f64, 1>;

    fn gaps(&self, _t: f64, state: &Self::State) -> Self::Gaps {
        SVector::from([state[0]])
    }

    fn gap_along(
        &self,
        _surface: usize,
        _t: TaylorModel,
        component: &dyn Fn(usize) -> TaylorModel,
    ) -> TaylorModel {
        component(0)
    }

    fn gap_about(&self, _surface: usize, _t: Bent, component: &dyn Fn(usize) -> Bent) -> Bent {
        component(0)
    }

    fn gap_rates(&self, _t: f64, state: &Self::State) -> Result<Self::Gaps, Fault> {
        Ok(SVector::from([state[1] / self.m]))
    }

    fn law(&self, _surface: usize) -> Law {
        Law::Elastic
    }

    fn contact(
        &self,
        _surface: usize,
        _t: f64,
        state: &Self::State,
    ) -> Result<Contact<Self::Vector>, Fault> {
        let gap_rate = state[1] / self.m;
        Ok(Contact {
            gap_rate,
            constrained_rate: gap_rate,
            surface_rate: 0.0,
            constrained_compliance: 1.0 / self.m,
            free_compliance: 1.0 / self.m,
            direction: SVector::from([1.0]),
        })
    }
}

impl Scene for BouncingBall {
    type Effects = (Impacts<Self>,);

    fn effects(&self) -> Self::Effects {
        (Impacts::declared(self),)
    }
}

impl Described for BouncingBall {
    const DESCRIPTION: &'static Description = &Facts {
        type_name: "BouncingBall",
        name: "bouncing_ball",
        documentation: " A ball above a floor.\n It bounces.",
        source: "pub BouncingBall {
            coordinates { x; }
            parameters { m > 0 = 1; g > 0 = 1; }
            lagrangian = m/2*dot(x)^2 - m*g*x;
            impacts { floor: x >= 0; }
            claims { conserved: energy; not conserved under floor: dot(x); assume conserved: sin(asin(x)) - x; }
        }",
        coordinates: &[line("x")],
        parameters: &[positive("m", Some(1.0)), positive("g", Some(1.0))],
        surfaces: &[SurfaceInfo {
            name: "floor",
            law: Held::Static("elastic"),
        }],
        ..NOTHING
    }
    .described();

    fn with_defaults() -> Self {
        Self { m: 1.0, g: 1.0 }
    }
}

impl Instance for BouncingBall {
    type Global = Self;

    fn global(&self) -> Self {
        self.clone()
    }

    fn parameter(&self, index: usize) -> f64 {
        [self.m, self.g].get(index).copied().unwrap_or(f64::NAN)
    }

    fn set_parameter(&mut self, index: usize, value: f64) {
        match index {
            0 => self.m = value,
            1 => self.g = value,
            _ => {}
        }
    }

    fn initial(&self) -> Initial<Self::Vector> {
        let [q, qdot, named] = [1.0, 0.0, 1.0].map(|value| SVector::from([value]));
        Initial {
            q,
            qdot,
            placed: SVector::repeat(1.0),
            named,
            until: None,
        }
    }

    fn outputs(&self, _t: f64, _state: &Self::State, _values: &mut [f64]) -> Result<(), Fault> {
        Ok(())
    }

    fn view_path(&self, _t: f64, _state: &Self::State) -> Option<[f64; 2]> {
        None
    }

    fn view_region(&self, _t: f64, _q: &Self::Vector) -> Option<f64> {
        None
    }

    fn inspect(&self, t: f64, state: &Self::State, report: &mut dyn Report) -> Result<(), Fault> {
        inspect_common(self, t, state, report)?;
        report.vector("pdot", &[-self.m * self.g]);
        report.vector("acceleration", &[-self.g]);
        report.vector("multipliers", &[]);
        report.matrix("metric", 1, 1, &[self.m]);
        report.matrix("W", 0, 1, &[]);
        let contact = self.contact(0, t, state)?;
        report.scalar("impacts.floor.gap", state[0]);
        report.scalar("impacts.floor.gap_rate", contact.gap_rate);
        report.scalar("impacts.floor.constrained_rate", contact.constrained_rate);
        report.scalar("impacts.floor.surface_rate", contact.surface_rate);
        report.scalar(
            "impacts.floor.constrained_compliance",
            contact.constrained_compliance,
        );
        report.scalar("impacts.floor.free_compliance", contact.free_compliance);
        report.vector("impacts.floor.direction", contact.direction.as_slice());
        report.vector("impacts.floor.velocity_direction", &[1.0 / self.m]);
        Ok(())
    }

    fn description(&self) -> &'static Description {
        <Self as Described>::DESCRIPTION
    }
}

/// Two springs of different strength, with a disk as the region of the view.
#[derive(Debug, Clone)]
pub struct Oscillator {
    pub k: f64,
}

impl Particle<2> for Oscillator {
    fn mass(&self) -> f64 {
        1.0
    }

    fn force(&self, q: &[f64; 2]) -> [f64; 2] {
        assert!(self.k != 13.0, "unlucky");
        [-q[0], -self.k * q[1]]
    }

    fn potential(&self, q: &[f64; 2]) -> f64 {
        0.5 * (q[0] * q[0] + self.k * q[1] * q[1])
    }
}

particle!(Oscillator, 2, 4, {});
free!(Oscillator, 2);

impl Scene for Oscillator {
    type Effects = ();

    fn effects(&self) -> Self::Effects {}
}

impl Described for Oscillator {
    const DESCRIPTION: &'static Description = &Facts {
        type_name: "Oscillator",
        name: "oscillator",
        documentation: " Two springs of different strength.",
        coordinates: &[line("x.1"), line("x.2")],
        parameters: &[positive("k", None)],
        outputs: &["radius"],
        region: Some(["x[1]", "x[2]"]),
        ..NOTHING
    }
    .described();

    fn with_defaults() -> Self {
        Self { k: f64::NAN }
    }
}

impl Instance for Oscillator {
    type Global = Self;

    fn global(&self) -> Self {
        self.clone()
    }

    fn parameter(&self, index: usize) -> f64 {
        if index == 0 { self.k } else { f64::NAN }
    }

    fn set_parameter(&mut self, index: usize, value: f64) {
        if index == 0 {
            self.k = value;
        }
    }

    fn initial(&self) -> Initial<Self::Vector> {
        let [q, qdot, named] = [[1.0, 0.0], [0.0, 0.5], [0.0, 1.0]].map(SVector::from);
        Initial {
            q,
            qdot,
            placed: SVector::repeat(1.0),
            named,
            until: Some(20.0),
        }
    }

    fn outputs(&self, _t: f64, state: &Self::State, values: &mut [f64]) -> Result<(), Fault> {
        values[0] = state[0].hypot(state[1]);
        Ok(())
    }

    fn view_path(&self, _t: f64, state: &Self::State) -> Option<[f64; 2]> {
        Some([state[0], state[1]])
    }

    fn view_region(&self, _t: f64, q: &Self::Vector) -> Option<f64> {
        Some(2.0 - q[0] * q[0] - q[1] * q[1])
    }

    fn inspect(&self, t: f64, state: &Self::State, report: &mut dyn Report) -> Result<(), Fault> {
        if state[0] == 7.0 {
            return Err(Fault::MetricNotPositive {
                pivot: 1,
                value: 0.0,
            });
        }
        inspect_common(self, t, state, report)?;
        report.matrix("metric", 2, 2, &[1.0, 0.0, 0.0, 1.0]);
        report.vector("stiffness", &[1.0, self.k]);
        Ok(())
    }

    fn description(&self) -> &'static Description {
        <Self as Described>::DESCRIPTION
    }
}

/// A bead on the line through the origin at 45 degrees, between the ends of an interval.
#[derive(Debug, Clone)]
pub struct Bead;

impl Particle<2> for Bead {
    fn mass(&self) -> f64 {
        1.0
    }

    fn force(&self, _q: &[f64; 2]) -> [f64; 2] {
        [0.0, 0.0]
    }

    fn potential(&self, _q: &[f64; 2]) -> f64 {
        0.0
    }
}

particle!(Bead, 2, 4, {
    fn outside_chart(&self, state: &Self::State) -> Option<usize> {
        let inside = state[1] > -1.0 && state[1] < 1.0;
        (!inside).then_some(1)
    }

    fn admit(&self, _t: f64, _q: &Self::Vector, qdot: &Self::Vector) -> Result<(), StateError> {
        let (residual, scale) = (qdot[1] - qdot[0], qdot[1].abs() + qdot[0].abs());
        match residual.abs() <= 1e-9 * scale {
            true => Ok(()),
            false => Err(StateError::OffConstraint {
                constraint: 0,
                residual,
                scale,
            }),
        }
    }

    fn state_nearest(
        &self,
        t: f64,
        q: &Self::Vector,
        qdot: &Self::Vector,
    ) -> Result<Self::State, Fault> {
        let mean = 0.5 * (qdot[0] + qdot[1]);
        self.state_unchecked(t, q, &SVector::from([mean, mean]))
    }

    fn complete_velocity(
        &self,
        _t: f64,
        _q: &Self::Vector,
        qdot: &Self::Vector,
        named: &Self::Vector,
    ) -> Result<Self::Vector, StateError> {
        let (residual, scale) = (qdot[1] - qdot[0], qdot[1].abs() + qdot[0].abs());
        match (named[0] == 1.0, named[1] == 1.0) {
            (true, true) if residual != 0.0 => Err(StateError::OffConstraint {
                constraint: 0,
                residual,
                scale,
            }),
            (true, _) => Ok(SVector::from([qdot[0], qdot[0]])),
            (false, _) => Ok(SVector::from([qdot[1], qdot[1]])),
        }
    }
});

impl Lagrangian for Bead {
    type Reactions = SVector<f64, 1>;

    fn force(&self, _t: f64, _q: &Self::Vector, _qdot: &Self::Vector) -> Self::Vector {
        Self::Vector::zeros()
    }

    fn reaction_force(
        &self,
        _t: f64,
        _q: &Self::Vector,
        reactions: &Self::Reactions,
    ) -> Self::Vector {
        SVector::from([-reactions[0], reactions[0]])
    }

    fn constrained_velocity(
        &self,
        _t: f64,
        _q: &Self::Vector,
        p: &Self::Vector,
    ) -> Result<(Self::Vector, Self::Reactions), Fault> {
        let mean = 0.5 * (p[0] + p[1]);
        Ok(([mean, mean].into(), [mean - p[1]].into()))
    }
}

impl Scene for Bead {
    type Effects = ();

    fn effects(&self) -> Self::Effects {}
}

impl Described for Bead {
    const DESCRIPTION: &'static Description = &Facts {
        type_name: "Bead",
        name: "bead",
        coordinates: &[
            line("x"),
            CoordinateInfo {
                name: "y",
                topology: Topology::Interval {
                    low: -1.0,
                    high: 1.0,
                },
            },
        ],
        constraints: &[ConstraintInfo {
            name: "wire",
            affine: false,
            level: Some(0),
        }],
        ..NOTHING
    }
    .described();

    fn with_defaults() -> Self {
        Self
    }
}

impl Instance for Bead {
    type Global = Self;

    fn global(&self) -> Self {
        self.clone()
    }

    fn parameter(&self, _index: usize) -> f64 {
        f64::NAN
    }

    fn set_parameter(&mut self, _index: usize, _value: f64) {}

    fn initial(&self) -> Initial<Self::Vector> {
        let [q, qdot, named] = [[0.0, 0.0], [0.25, 0.0], [1.0, 0.0]].map(SVector::from);
        Initial {
            q,
            qdot,
            placed: SVector::repeat(1.0),
            named,
            until: Some(2.0),
        }
    }

    fn outputs(&self, _t: f64, _state: &Self::State, _values: &mut [f64]) -> Result<(), Fault> {
        Ok(())
    }

    fn view_path(&self, _t: f64, _state: &Self::State) -> Option<[f64; 2]> {
        None
    }

    fn view_region(&self, _t: f64, _q: &Self::Vector) -> Option<f64> {
        None
    }

    fn inspect(&self, t: f64, state: &Self::State, report: &mut dyn Report) -> Result<(), Fault> {
        inspect_common(self, t, state, report)
    }

    fn description(&self) -> &'static Description {
        <Self as Described>::DESCRIPTION
    }
}
