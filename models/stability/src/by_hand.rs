//! A point of mass 1 in the plane, written by hand, with surfaces and resets that a declaration does not offer.

use dalembert::jet::LENGTH;
use dalembert::law::{Contact, Law};
use dalembert::numbers::{Numbers, TaylorModel};
use dalembert::{
    Fault, Impacting, Impacts, ParameterError, Scene, System, TaylorField, VectorField,
};
use nalgebra::SVector;

type Pair = SVector<f64, 2>;
type State = SVector<f64, 4>;

/// A surface.
#[derive(Clone, Copy)]
pub struct Gap {
    /// Gap and gradient at a point.
    pub at: fn([f64; 2]) -> (f64, [f64; 2]),
    /// The gap along a part of the motion.
    pub along: fn([TaylorModel; 2]) -> TaylorModel,
}

/// The velocity after an impact, as a function of the velocity before it.
pub type Reset = fn([f64; 2]) -> [f64; 2];

/// The point, with a constant acceleration, between surfaces that have a reset each.
#[derive(Clone)]
pub struct Point<const S: usize> {
    /// The acceleration.
    pub acceleration: [f64; 2],
    /// The surfaces.
    pub surfaces: [(Gap, Reset); S],
}

impl<const S: usize> VectorField for Point<S> {
    type State = State;

    fn rate(&self, _t: f64, state: &State, rate: &mut State) -> Result<(), Fault> {
        let [ax, ay] = self.acceleration;
        *rate = State::new(state[2], state[3], ax, ay);
        Ok(())
    }
}

impl<const S: usize> TaylorField for Point<S> {
    type Parameters<L: Numbers> = [L; 2];
    type Row<L: Numbers> = [L; 4];
    type Gaps<L: Numbers> = [L; 0];
    type Firsts<L: Numbers> = [L; 4];
    type Jets<L: Numbers> = [[L; LENGTH]; 0];

    fn parameters(&self) -> [f64; 2] {
        self.acceleration
    }

    fn begin<L: Numbers>(
        &self,
        [ax, ay]: &[L; 2],
        _t: L,
        [_, _, vx, vy]: &[L; 4],
        firsts: &mut [L; 4],
    ) -> Result<(), Fault> {
        *firsts = [*vx, *vy, *ax, *ay];
        Ok(())
    }

    fn advance<L: Numbers>(
        &self,
        _parameters: &[L; 2],
        unit: L,
        order: usize,
        firsts: &[L; 4],
        coefficients: &mut [[L; 4]; LENGTH],
        _gaps: &mut [[L; 0]; LENGTH],
        _jets: &mut Self::Jets<L>,
    ) {
        let [vx, vy, ax, ay] = firsts.map(|rate| unit * rate);
        let half = L::of(0.5) * unit;
        coefficients[1..=order].fill([L::ZERO; 4]);
        coefficients[1] = [vx, vy, ax, ay];
        if order > 1 {
            coefficients[2] = [half * ax, half * ay, L::ZERO, L::ZERO];
        }
    }
}

impl<const S: usize> System for Point<S> {
    type Vector = Pair;
    type Impulse = Pair;

    fn position(&self, state: &State) -> Pair {
        Pair::new(state[0], state[1])
    }

    fn velocity(&self, _t: f64, state: &State) -> Result<Pair, Fault> {
        Ok(Pair::new(state[2], state[3]))
    }

    fn momentum(&self, t: f64, state: &State) -> Result<Pair, Fault> {
        self.velocity(t, state)
    }

    fn state_unchecked(&self, _t: f64, q: &Pair, qdot: &Pair) -> Result<State, Fault> {
        Ok(State::new(q[0], q[1], qdot[0], qdot[1]))
    }

    fn state_from_momenta(&self, t: f64, q: &Pair, p: &Pair) -> Result<State, Fault> {
        self.state_unchecked(t, q, p)
    }

    fn energy(&self, _t: f64, state: &State) -> Result<f64, Fault> {
        let [ax, ay] = self.acceleration;
        Ok(0.5 * (state[2] * state[2] + state[3] * state[3]) - ax * state[0] - ay * state[1])
    }

    fn kick(&self, state: &mut State, size: f64, direction: &Pair) {
        state[2] += size * direction[0];
        state[3] += size * direction[1];
    }

    fn check_parameters(&self) -> Result<(), ParameterError> {
        Ok(())
    }
}

impl<const S: usize> Impacting for Point<S> {
    type Gaps = SVector<f64, S>;

    fn gaps(&self, _t: f64, state: &State) -> Self::Gaps {
        let gap = |surface: usize, _| (self.surfaces[surface].0.at)([state[0], state[1]]).0;
        Self::Gaps::from_fn(gap)
    }

    fn gap_along(
        &self,
        surface: usize,
        _t: TaylorModel,
        component: &dyn Fn(usize) -> TaylorModel,
    ) -> TaylorModel {
        (self.surfaces[surface].0.along)([component(0), component(1)])
    }

    fn gap_rates(&self, _t: f64, state: &State) -> Result<Self::Gaps, Fault> {
        let rate = |surface: usize, _| {
            let (_, [hx, hy]) = (self.surfaces[surface].0.at)([state[0], state[1]]);
            hx * state[2] + hy * state[3]
        };
        Ok(Self::Gaps::from_fn(rate))
    }

    /// The law's impulse is `-2 constrained_rate / constrained_compliance`. The values of `contact` make it 1.
    fn law(&self, _surface: usize) -> Law {
        Law::Elastic
    }

    fn contact(&self, surface: usize, _t: f64, state: &State) -> Result<Contact<Pair>, Fault> {
        let (Gap { at: gap, .. }, reset) = self.surfaces[surface];
        let (_, [hx, hy]) = gap([state[0], state[1]]);
        let [vx, vy] = reset([state[2], state[3]]);
        let gap_rate = hx * state[2] + hy * state[3];
        let compliance = hx * vx + hy * vy - gap_rate;
        if compliance == 0.0 {
            return Err(Fault::SingularSurface { surface });
        }
        Ok(Contact {
            gap_rate,
            constrained_rate: -0.5 * compliance,
            surface_rate: 0.0,
            constrained_compliance: compliance,
            free_compliance: compliance,
            direction: Pair::new(vx - state[2], vy - state[3]),
        })
    }
}

impl<const S: usize> Scene for Point<S> {
    type Effects = Impacts<Self>;

    fn effects(&self) -> Impacts<Self> {
        Impacts::declared(self)
    }
}
