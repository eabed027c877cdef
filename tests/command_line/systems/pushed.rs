//! A mass on a line, at rest until a force with impulse 1 acts on it for a short time.

use std::f64::consts::PI;

use super::*;

/// Time and width of the push.
const TIME: f64 = 5.3;
const WIDTH: f64 = 0.1;

/// A mass of 1 under the force `exp(-u^2) / (WIDTH sqrt(pi))`, `u = (t - TIME) / WIDTH`.
#[derive(Debug, Clone)]
pub struct Pushed;

/// `u` and the force.
fn push<L: Numbers>(t: L) -> [L; 2] {
    let u = (t - L::of(TIME)) / L::of(WIDTH);
    [u, (-(u * u)).exp() / L::of(WIDTH * PI.sqrt())]
}

impl Particle<1> for Pushed {
    fn mass(&self) -> f64 {
        1.0
    }

    fn force(&self, _q: &[f64; 1]) -> [f64; 1] {
        [0.0]
    }

    fn potential(&self, _q: &[f64; 1]) -> f64 {
        0.0
    }
}

impl VectorField for Pushed {
    type State = SVector<f64, 2>;

    fn rate(&self, t: f64, state: &Self::State, rate: &mut Self::State) -> Result<(), Fault> {
        (rate[0], rate[1]) = (state[1], push(t)[1]);
        Ok(())
    }
}

impl TaylorField for Pushed {
    type Parameters<L: Numbers> = [L; 0];
    type Row<L: Numbers> = [L; 2];
    type Gaps<L: Numbers> = [L; 0];
    /// The rate, then `u`.
    type Firsts<L: Numbers> = [L; 3];
    type Jets<L: Numbers> = [[L; LENGTH]; 0];

    fn parameters(&self) -> Self::Parameters<f64> {
        []
    }

    fn begin<L: Numbers>(
        &self,
        _parameters: &Self::Parameters<L>,
        t: L,
        state: &Self::Row<L>,
        firsts: &mut Self::Firsts<L>,
    ) -> Result<(), Fault> {
        let [u, force] = push(t);
        *firsts = [state[1], force, u];
        Ok(())
    }

    /// The coefficients follow from `f' = -2 u u' f` with constant `u'`.
    fn advance<L: Numbers>(
        &self,
        _parameters: &Self::Parameters<L>,
        unit: L,
        order: usize,
        firsts: &Self::Firsts<L>,
        coefficients: &mut [Self::Row<L>; LENGTH],
        _gaps: &mut [Self::Gaps<L>; LENGTH],
        _jets: &mut Self::Jets<L>,
    ) {
        let ([p, force, u], pace) = (*firsts, unit / L::of(WIDTH));
        coefficients[1] = [unit * p, unit * force];
        let [mut before, mut last] = [L::of(0.0), force];
        for k in 1..order {
            let next = L::of(-2.0 / k as f64) * pace * (u * last + pace * before);
            (before, last) = (last, next);
            let scale = unit / L::of((k + 1) as f64);
            coefficients[k + 1] = [scale * coefficients[k][1], scale * last];
        }
    }
}

system!(Pushed, 1, 2, {});

impl Lagrangian for Pushed {
    type Reactions = SVector<f64, 0>;

    fn force(&self, t: f64, _q: &Self::Vector, _qdot: &Self::Vector) -> Self::Vector {
        SVector::from([push(t)[1]])
    }

    fn reaction_force(
        &self,
        _t: f64,
        _q: &Self::Vector,
        _reactions: &Self::Reactions,
    ) -> Self::Vector {
        Self::Vector::zeros()
    }

    fn constrained_velocity(
        &self,
        _t: f64,
        _q: &Self::Vector,
        p: &Self::Vector,
    ) -> Result<(Self::Vector, Self::Reactions), Fault> {
        Ok((*p, SVector::zeros()))
    }
}

impl Scene for Pushed {
    type Effects = ();

    fn effects(&self) -> Self::Effects {}
}

impl Described for Pushed {
    const DESCRIPTION: &'static Description = &Facts {
        type_name: "Pushed",
        name: "pushed",
        coordinates: &[line("x")],
        ..NOTHING
    }
    .described();

    fn with_defaults() -> Self {
        Self
    }
}

impl Instance for Pushed {
    type Global = Self;

    fn global(&self) -> Self {
        self.clone()
    }

    fn parameter(&self, _index: usize) -> f64 {
        f64::NAN
    }

    fn set_parameter(&mut self, _index: usize, _value: f64) {}

    fn initial(&self) -> Initial<Self::Vector> {
        let [q, qdot, marks] = [0.0, 0.0, 1.0].map(|value| SVector::from([value]));
        Initial {
            q,
            qdot,
            placed: marks,
            named: marks,
            until: Some(10.0),
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
